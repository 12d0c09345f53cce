"""URDF boxes, cylinders and spheres: meshes, and detection in exact hulls."""

from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.shapes.primitives import SEGMENTS, box, cylinder, move, place_vertices
from artigen.transforms import transform_points
from sim_export.errors import PackageError
from sim_export.geometry.hulls import face_planes, hull_length, hull_planes, hull_volume, hull_width
from sim_export.geometry.triangles import area_normals
from sim_export.package import Hull, Mesh

FACET_TURN = np.pi / 32
"""Rotation (radians) of cylinders about their axis. SAPIEN makes 32 facets with an edge in its x direction.
With this rotation, facets coincide with those of our prism, and wheels stand on a facet instead of an
edge."""
PRECISION = 1e-6
"""Distance (m) of corners within which a hull equals a primitive; files have micrometre precision."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PrimitiveShape:
    """A placed box with three edges, or cylinder with radius and length along its own z (m).

    The prism of a cylinder has the middle of a side `FACET_TURN` before its x.
    """

    kind: Literal["box", "cylinder"]
    sizes: tuple[float, ...]
    T_object_shape: Float[np.ndarray, "4 4"]

    @property
    def volume(self) -> float:
        """Volume in cubic metres; of a cylinder, not of its prism."""
        if self.kind == "box":
            return float(np.prod(self.sizes))
        return float(np.pi * self.sizes[0] ** 2 * self.sizes[1])


def primitive_mesh(kind: str, sizes: tuple[float, ...]) -> Mesh:
    """A box (three edges), cylinder (radius, length along z) or sphere (radius) in metres, centred.

    A cylinder is the inscribed prism of `SEGMENTS` sides, rotated by `-FACET_TURN`.

    Raises:
        PackageError: If a size is not positive or the kind is unknown.
    """
    if not (len(sizes) and np.isfinite(sizes).all() and min(sizes) > 0):
        raise PackageError(f"a {kind} has sizes {list(sizes)}, expected positive numbers")
    if kind == "sphere":
        import trimesh

        ball = trimesh.creation.icosphere(subdivisions=2, radius=sizes[0])
        return Mesh(vertices=np.asarray(ball.vertices), faces=np.asarray(ball.faces))
    if kind not in ("box", "cylinder"):
        raise PackageError(f"shape {kind!r}, expected box, cylinder or sphere")
    unit = _unit_mesh(kind)
    edges = sizes if kind == "box" else (sizes[0], sizes[0], sizes[1])
    return Mesh(vertices=unit.vertices * edges, faces=unit.faces)


@cache
def _unit_mesh(kind: Literal["box", "cylinder"]) -> Mesh:
    """A cube of edge 1, or a cylinder of radius 1 and length 1."""
    if kind == "box":
        solid = box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), "")
        return Mesh(vertices=np.asarray(solid.vertices), faces=np.asarray(solid.faces))
    solid = move(cylinder((0.0, 0.0, -0.5), (0.0, 0.0, 0.5), 1.0, ""), turn=-FACET_TURN)
    return Mesh(vertices=place_vertices(solid), faces=solid.faces)


def primitive_hull(shape: PrimitiveShape) -> Hull:
    """Hull of a primitive, for checks and for engines without cylinders."""
    mesh = primitive_mesh(shape.kind, shape.sizes)
    return Hull(vertices=transform_points(shape.T_object_shape, mesh.vertices), faces=mesh.faces)


@lru_cache(maxsize=1024)  # every file of a package queries every hull
def find_primitive(hull: Hull) -> PrimitiveShape | None:
    """The box or cylinder equal to a hull, to the micrometre; None for other hulls."""
    if len(hull.vertices) == 8:
        return _find_box(hull.vertices)
    return _find_cylinder(hull) if len(hull.vertices) == 2 * SEGMENTS else None


def is_box(hull: Hull) -> bool:
    """Whether a hull is a box, to the micrometre."""
    shape = find_primitive(hull)
    return shape is not None and shape.kind == "box"


def _find_box(corners: Float[np.ndarray, "8 3"]) -> PrimitiveShape | None:
    center = corners.mean(axis=0)
    if np.ptp(np.linalg.norm(corners - center, axis=1)) > 4.0 * PRECISION:
        return None  # most hulls of eight corners; those of a box lie on a sphere
    spokes = corners - corners[0]
    reach = np.linalg.norm(spokes, axis=1)
    first, *others = np.argsort(reach, kind="stable")[1:]  # the shortest vector from a corner is an edge
    upright = [k for k in others if abs(spokes[k] @ spokes[first]) <= PRECISION * reach[k]]
    if not upright:
        return None
    axes = np.stack([spokes[first], spokes[upright[0]]]) / reach[[first, upright[0]], None]
    axes = _near_object_axes(np.stack([*axes, np.cross(*axes)]))
    half = np.abs((corners - center) @ axes.T).max(axis=0)
    expected = np.sign((corners - center) @ axes.T) * half
    if not _all_there(expected) or np.abs((corners - center) @ axes.T - expected).max() > PRECISION:
        return None
    return PrimitiveShape(
        kind="box", sizes=tuple(float(edge) for edge in 2 * half), T_object_shape=place_axes(axes, center)
    )


def _all_there(corners: Float[np.ndarray, "8 3"]) -> bool:
    """Whether every combination of signs occurs."""
    return len(np.unique(np.sign(corners), axis=0)) == 8


def _near_object_axes(axes: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "3 3"]:
    """Rows permuted and signed to be closest to the object's axes, right-handed."""
    from itertools import permutations

    order = max(permutations(range(3)), key=lambda rows: float(np.abs(axes[list(rows)]).diagonal().sum()))
    axes = axes[list(order)]
    axes = axes * np.where(axes.diagonal() < 0, -1.0, 1.0)[:, None]
    axes[2] = np.cross(axes[0], axes[1])
    return axes


def _find_cylinder(hull: Hull) -> PrimitiveShape | None:
    axis = _find_caps(hull)
    if axis is None:
        return None
    center = hull.vertices.mean(axis=0)
    spokes = hull.vertices - center
    heights = spokes @ axis
    half = float(np.abs(heights).max())
    # A corner's angle, less half a step, gives x; choose the equivalent rotation closest to an object axis.
    helper = np.eye(3)[int(np.argmax(np.abs(axis)) == 0)]
    x = helper - axis * (helper @ axis)
    x /= np.linalg.norm(x)
    y = np.cross(axis, x)
    angles = np.arctan2(spokes @ y, spokes @ x)
    step = 2 * np.pi / SEGMENTS
    turn = float(np.angle(np.exp(1j * SEGMENTS * (angles - step / 2)).mean())) / SEGMENTS + FACET_TURN
    x, y = np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x
    radius = float(np.hypot(spokes @ x, spokes @ y).mean())
    shape = PrimitiveShape(
        kind="cylinder", sizes=(radius, 2 * half), T_object_shape=place_axes(np.stack([x, y, axis]), center)
    )
    apart = hull.vertices[:, None] - primitive_hull(shape).vertices
    nearest = np.linalg.norm(apart, axis=2)
    matched = nearest.argmin(axis=1)
    fits = len(set(matched.tolist())) == len(matched) and nearest.min(axis=1).max() <= PRECISION
    return shape if fits else None


def _find_caps(hull: Hull) -> Float[np.ndarray, "3"] | None:
    """The normal, towards higher coordinates, shared by the triangles of two polygons of `SEGMENTS` sides."""
    corners = hull.vertices[hull.faces]
    normals = area_normals(corners)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)
    alike = np.abs(normals @ normals.T) > 1.0 - 1e-6
    best = int(alike.sum(axis=1).argmax())
    if alike[best].sum() != 2 * (SEGMENTS - 2):
        return None
    axis = normals[best]
    return axis * np.sign(axis[np.argmax(np.abs(axis))])


def place_axes(axes: Float[np.ndarray, "3 3"], center: Float[np.ndarray, "3"]) -> Float[np.ndarray, "4 4"]:
    """Pose of a shape with the rows of ``axes`` (in object axes) as its axes, centred at ``center`` (m)."""
    T = np.eye(4)
    T[:3, :3] = axes.T
    T[:3, 3] = center
    return T


def place_along(axis: Float[np.ndarray, "3"], center: Float[np.ndarray, "3"]) -> Float[np.ndarray, "4 4"]:
    """Pose of a shape with its z along a unit vector (object axes), centred at ``center`` (m)."""
    x = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
    x /= np.linalg.norm(x)
    return place_axes(np.stack([x, np.cross(axis, x), axis]), center)


def forget_hulls() -> None:
    """Drops what was found out about hulls, which are kept with it."""
    for measure in (find_primitive, hull_volume, hull_planes, face_planes, hull_width, hull_length):
        measure.cache_clear()
