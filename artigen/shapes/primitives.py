"""Convex primitives in metres, of which every part of a procedural object consists.

A primitive is a convex solid in its own frame, placed rigidly in the object frame at rest (z up, front -x).
The solid is exact: a polytope given by planes, or a cylinder. Its vertices describe the closed surface; for a
cylinder that of the inscribed prism of `SEGMENTS` sides.
"""

from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.shapes.ranges import Range
from artigen.types import frozen_array

PrimitiveKind = Literal["polytope", "cylinder"]
SEGMENTS = 16
"""Sides of the prism that represents a cylinder in meshes and hulls."""
ROUND = float(np.cos(np.pi / SEGMENTS))
"""Ratio of the extent of that prism to the cylinder's."""
Vector = tuple[float, float, float]
UP: Vector = (0.0, 0.0, 1.0)
DOWN: Vector = (0.0, 0.0, -1.0)
FRONT: Vector = (-1.0, 0.0, 0.0)
BACK: Vector = (1.0, 0.0, 0.0)
LEFT: Vector = (0.0, 1.0, 0.0)
RIGHT: Vector = (0.0, -1.0, 0.0)
"""Directions; left and right are those of a viewer in front of the object."""

_ARRAYS: dict[str, tuple[type, tuple[int | None, ...]]] = {
    "center": (np.float64, (3,)),
    "rotation": (np.float64, (3, 3)),
    "size": (np.float64, (3,)),
    "planes": (np.float64, (None, 4)),
    "vertices": (np.float64, (None, 3)),
    "faces": (np.int64, (None, 3)),
    "rings": (np.int64, (None, None)),
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Primitive:
    """A convex solid of one finish, possibly lined on one side.

    ``rotation`` has the own axes as columns, in object axes. A cylinder stands along its own z with ``size``
    (diameter, diameter, length). A polytope is ``{p : planes @ (p, 1) <= 0}`` in its own frame, with rows
    (unit normal, offset) and its extent ``size``. ``finish`` names an entry of `Shape.finishes`. Where the
    outward normal lies within 60 degrees of ``lined_side`` (object axes at rest), the surface has ``lining``
    instead: the white inside of a wooden carcass.
    """

    kind: PrimitiveKind
    center: Float[np.ndarray, "3"]
    rotation: Float[np.ndarray, "3 3"]
    size: Float[np.ndarray, "3"]
    planes: Float[np.ndarray, "K 4"]
    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    rings: Int[np.ndarray, "K M"]
    """Vertices around the face on each plane, counterclockwise from outside; short rings repeat their last
    vertex."""
    finish: str
    lining: str | None = None
    lined_side: Vector | None = None

    def __post_init__(self) -> None:
        for name, (dtype, shape) in _ARRAYS.items():
            value = getattr(self, name)
            if not _is_frozen(value, dtype):  # fields of another primitive were checked there
                object.__setattr__(self, name, frozen_array(value, dtype, shape, f"primitive {name}"))
        if not (self.size > 0).all():
            raise ValueError(f"a {self.kind} has size {self.size.tolist()}, expected positive edges")
        if (self.lining is None) != (self.lined_side is None):
            raise ValueError("a primitive needs both a lining and a lined side, or neither")


def box(low: Vector, high: Vector, finish: str) -> Primitive:
    """An axis-aligned box from its lowest to its highest corner (m)."""
    return rounded_box(low, high, 0.0, finish)


def block(x: Range, y: Range, z: Range, finish: str, bevel: float = 0.0) -> Primitive:
    """An axis-aligned box over three ranges (m), its edges and corners cut off by ``bevel`` (m)."""
    return rounded_box((x[0], y[0], z[0]), (x[1], y[1], z[1]), bevel, finish)


def rounded_box(low: Vector, high: Vector, bevel: float, finish: str) -> Primitive:
    """A box whose twelve edges and eight corners are cut off by planes, ``bevel`` (m) wide on each face."""
    bottom, top = np.array(low, dtype=float), np.array(high, dtype=float)
    half = (top - bottom) / 2
    if not (half > bevel).all() or bevel < 0:
        raise ValueError(f"box from {low} to {high} with bevel {bevel}: edges must be longer than two bevels")
    return _alike(_unit_box(bevel > 0), _box_corners(half, bevel), finish, (bottom + top) / 2)


def cylinder(start: Vector, end: Vector, radius: float, finish: str) -> Primitive:
    """A round rod from the centre of one end to the centre of the other (m)."""
    ends = np.array([start, end], dtype=float)
    length = float(np.linalg.norm(ends[1] - ends[0]))
    if not (length > 0 and radius > 0):
        raise ValueError(f"cylinder from {start} to {end} with radius {radius}: both must be positive")
    size = np.array([2 * radius, 2 * radius, length])
    solid = _alike(_unit_cylinder(), _unit_cylinder().vertices * size, finish, ends.mean(axis=0))
    return replace(solid, kind="cylinder", rotation=_frame_along((ends[1] - ends[0]) / length), size=size)


def prism(
    profile: Float[np.ndarray, "K 2"], start: Vector, end: Vector, finish: str, *, taper: float = 1.0
) -> Primitive:
    """A convex polygon swept from ``start`` to ``end`` (m) and scaled linearly to ``taper`` of its size.

    The polygon's plane is perpendicular to the sweep: for a vertical sweep its axes are the object's x and y,
    for one along x they are y and z, for one along y they are z and x.
    """
    ends = np.array([start, end], dtype=float)
    length = float(np.linalg.norm(ends[1] - ends[0]))
    if not (length > 0 and taper > 0):
        raise ValueError(f"prism from {start} to {end} with taper {taper}: both must be positive")
    flat = np.asarray(profile, dtype=float)
    corners = np.concatenate(
        [
            np.column_stack([flat, np.full(len(flat), -length / 2)]),
            np.column_stack([flat * taper, np.full(len(flat), length / 2)]),
        ]
    )
    rotation = _frame_along((ends[1] - ends[0]) / length)
    solid = polytope(corners, finish)
    return replace(solid, center=rotation @ solid.center + ends.mean(axis=0), rotation=rotation)


def polytope(
    corners: Float[np.ndarray, "N 3"], finish: str, *, center: Vector = (0.0, 0.0, 0.0)
) -> Primitive:
    """Convex hull of points given relative to ``center`` (m); its own frame is centred on its box.

    Raises:
        ValueError: If the points span no volume.
    """
    from scipy.spatial import ConvexHull, QhullError

    points = np.asarray(corners, dtype=float)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    points = points - middle
    try:
        hull = ConvexHull(points)
    except QhullError as error:
        raise ValueError(
            f"{len(points)} points with extent {np.ptp(points, axis=0).tolist()} span no volume"
        ) from error
    faces = hull.simplices.copy()
    a, b, c = (points[faces[:, k]] for k in range(3))
    inward = np.einsum("fi,fi->f", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    faces[inward] = faces[inward][:, ::-1]
    used, faces = np.unique(faces, return_inverse=True)  # drops interior points, keeps the order
    planes, rings = _find_rings(points[used], hull.equations)
    return Primitive(
        kind="polytope",
        center=np.asarray(center, dtype=float) + middle,
        rotation=np.eye(3),
        size=np.ptp(points, axis=0),
        planes=planes,
        vertices=points[used],
        faces=faces.reshape(-1, 3),
        rings=rings,
        finish=finish,
    )


def line(primitive: Primitive, lining: str, side: Vector) -> Primitive:
    """Adds a lining to the side that faces ``side`` (object axes at rest)."""
    return replace(primitive, lining=lining, lined_side=side)


def move(
    primitive: Primitive,
    offset: Vector = (0.0, 0.0, 0.0),
    *,
    turn: float = 0.0,
    about: Vector = (0.0, 0.0, 1.0),
) -> Primitive:
    """Rotates a solid by ``turn`` radians about an axis through the object's origin, then translates it
    (m)."""
    from scipy.spatial.transform import Rotation

    axis = np.array(about, dtype=float)
    spin = Rotation.from_rotvec(turn * axis / np.linalg.norm(axis)).as_matrix()
    side = (
        None
        if primitive.lined_side is None
        else tuple(float(v) for v in spin @ np.array(primitive.lined_side))
    )
    return replace(
        primitive,
        center=spin @ primitive.center + np.array(offset),
        rotation=spin @ primitive.rotation,
        lined_side=side,
    )


def place_vertices(primitive: Primitive) -> Float[np.ndarray, "V 3"]:
    """Vertices of the closed surface in the object frame at rest (m)."""
    return primitive.vertices @ primitive.rotation.T + primitive.center


def contains(
    primitive: Primitive, points: Float[np.ndarray, "N 3"], margin: float = 0.0
) -> Bool[np.ndarray, "N"]:
    """Whether points (m, object frame) lie inside the exact solid by more than ``margin``."""
    own = (points - primitive.center) @ primitive.rotation
    if primitive.kind == "cylinder":
        radius, half = primitive.size[0] / 2, primitive.size[2] / 2
        return (np.hypot(own[:, 0], own[:, 1]) < radius - margin) & (np.abs(own[:, 2]) < half - margin)
    return np.all(own @ primitive.planes[:, :3].T + primitive.planes[:, 3] < -margin, axis=1)


def as_vector(values: Float[np.ndarray, "3"]) -> Vector:
    """An array as a vector."""
    x, y, z = values.tolist()
    return x, y, z


def _is_frozen(value: object, dtype: type) -> bool:
    return (
        isinstance(value, np.ndarray)
        and value.dtype == dtype
        and value.base is None
        and not value.flags.writeable
    )


def _find_rings(
    vertices: Float[np.ndarray, "V 3"], equations: Float[np.ndarray, "F 4"]
) -> tuple[Float[np.ndarray, "K 4"], Int[np.ndarray, "K M"]]:
    """The distinct planes of a hull, and the vertices around the face on each."""
    reach = 1e-9 * float(np.ptp(vertices, axis=0).max())
    on = np.abs(equations[:, :3] @ vertices.T + equations[:, 3:]) < reach
    first = {row.tobytes(): index for index, row in reversed(list(enumerate(on)))}
    chosen = sorted(first.values())
    planes, on = equations[chosen], on[chosen]
    counts = on.sum(axis=1)
    spokes = vertices[None] - ((on @ vertices) / counts[:, None])[:, None]
    start = spokes[np.arange(len(on)), on.argmax(axis=1)]
    ahead = np.einsum("kvi,ki->kv", spokes, start)
    aside = np.einsum("kvi,ki->kv", spokes, np.cross(planes[:, :3], start))
    order = np.argsort(np.where(on, np.arctan2(aside, ahead), np.inf), axis=1)
    column = np.minimum(np.arange(counts.max()), counts[:, None] - 1)
    return planes, np.take_along_axis(order, column, axis=1)


def _box_corners(half: Float[np.ndarray, "3"], bevel: float) -> Float[np.ndarray, "V 3"]:
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    if bevel == 0.0:
        return signs * half
    return np.concatenate([signs * np.where(np.arange(3) == axis, half, half - bevel) for axis in range(3)])


@cache
def _unit_box(bevelled: bool) -> Primitive:  # noqa: FBT001 - the two topologies a box can have
    return polytope(_box_corners(np.full(3, 0.5), 0.1 if bevelled else 0.0), "")


def polygon(sides: int = SEGMENTS) -> Float[np.ndarray, "N 2"]:
    """Corners of a regular polygon in the unit circle, the first one half a side from the x axis."""
    turns = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    return np.column_stack([np.cos(turns), np.sin(turns)])


@cache
def _unit_cylinder() -> Primitive:
    rim = 0.5 * polygon()
    return polytope(np.concatenate([np.column_stack([rim, np.full(SEGMENTS, z)]) for z in (-0.5, 0.5)]), "")


def _alike(
    like: Primitive, vertices: Float[np.ndarray, "V 3"], finish: str, center: Float[np.ndarray, "3"]
) -> Primitive:
    """A polytope that reuses the faces and plane normals of another one, because computing hulls is slow."""
    normals = like.planes[:, :3]
    planes = np.column_stack([normals, -(vertices @ normals.T).max(axis=0)])
    size = np.ptp(vertices, axis=0)
    return replace(like, center=center, vertices=vertices, planes=planes, size=size, finish=finish)


def _frame_along(direction: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """A right-handed frame with z along ``direction``; x is y for a sweep along x, z for one along y."""
    helper = np.roll(np.eye(3)[int(np.argmax(np.abs(direction)))], 1)
    x = helper - direction * (helper @ direction)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(direction, x), direction])
