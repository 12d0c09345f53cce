"""Evenly spread points on the surface of a procedural object, with normal, part and colour.

Surfaces are exact: faces of polytopes, and the round side and flat ends of cylinders.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape
from artigen.shapes.solids import Solids, list_solids, see_points
from artigen.types import SurfaceSamples

_STEP = np.array([0.7548776662466927, 0.5698402909980532])
"""The plastic number's two-dimensional low-discrepancy sequence."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SurfacePoints:
    """Points (m, object frame at rest) on the surfaces of the parts, primitive by primitive."""

    points: Float[np.ndarray, "N 3"]
    normals: Float[np.ndarray, "N 3"]
    owners: Int[np.ndarray, "N"]
    """Index of the primitive, counted through all parts."""
    part_ids: Int[np.ndarray, "N"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Patches:
    """Triangles, and the sides and ends of cylinders: ``p = origin + f(u, v) . (first, second, third)``."""

    owners: Int[np.ndarray, "F"]
    kinds: Int[np.ndarray, "F"]
    """0 triangle, 1 side of a cylinder, 2 end of a cylinder."""
    origin: Float[np.ndarray, "F 3"]
    frame: Float[np.ndarray, "F 3 3"]
    """Rows: two edges and the normal; or two radii and the axis from end to end."""
    areas: Float[np.ndarray, "F"]


def place_points(shape: Shape, spacing: float) -> SurfacePoints:
    """Points on the surface of every part, one per ``spacing`` squared (m).

    Deterministic. A part's surface is that of the union of its primitives.
    """
    if not spacing > 0:
        raise ValueError(f"spacing of {spacing} m, expected above 0")
    solids = list_solids(shape)
    patches = _list_patches(solids)
    total = np.cumsum(patches.areas)
    count = max(1, round(float(total[-1]) / spacing**2))
    at = (np.arange(count) + 0.5) / count * total[-1]
    chosen = np.minimum(np.searchsorted(total, at), len(total) - 1)
    u, v = np.modf(np.arange(1, count + 1)[:, None] * _STEP)[0].T
    points, normals = _map_points(patches, chosen, u, v)
    owners = patches.owners[chosen]
    seen = see_points(solids, points, normals, owners)
    owners = owners[seen]
    return SurfacePoints(
        points=points[seen], normals=normals[seen], owners=owners, part_ids=solids.part_ids[owners]
    )


def sample_shape(shape: Shape, spacing: float) -> SurfaceSamples:
    """Coloured surface samples in the unit cube of the `Asset`, ``spacing`` (m) apart on average."""
    return paint_points(shape, place_points(shape, spacing), footprint=spacing)


def paint_points(shape: Shape, found: SurfacePoints, *, footprint: float) -> SurfaceSamples:
    """Colours points on an object; in the unit cube.

    Patterns finer than ``footprint`` (m) are omitted.
    """
    from artigen.shapes.surfaces.textures import paint_primitives

    colors = paint_primitives(shape, found.owners, found.points, found.normals, footprint=footprint)
    low, high = shape.bounds()
    return SurfaceSamples(
        points=(found.points - (low + high) / 2) / float((high - low).max()),
        normals=found.normals,
        colors=np.rint(255 * colors).astype(np.uint8),
        part_ids=found.part_ids,
    )


def read_clear(shape: Shape, found: SurfacePoints) -> Float[np.ndarray, "N"]:
    """Transparency of the surface at points on an object, 1 - opacity."""
    from artigen.shapes.surfaces.textures import find_rows, make_paint

    table = make_paint(shape)
    return 1.0 - table.opacity[find_rows(table, found.owners, found.normals)]


def _list_patches(solids: Solids) -> _Patches:
    """The patches of every primitive, primitive after primitive."""
    owners, kinds, origins, frames, areas = [], [], [], [], []
    for index, primitive in enumerate(solids.primitives):
        if primitive.kind == "cylinder":
            origin, frame, kind, area = _cylinder_patches(
                primitive.center, primitive.rotation, primitive.size
            )
        else:
            corners = place_vertices(primitive)[primitive.faces]
            a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
            cross = np.cross(a, b)
            length = np.linalg.norm(cross, axis=1)
            proper = length > 0
            unit = cross[proper] / length[proper, None]
            origin, frame = corners[proper, 0], np.stack([a[proper], b[proper], unit], axis=1)
            kind, area = np.zeros(len(origin), dtype=np.int64), length[proper] / 2
        owners.append(np.full(len(origin), index))
        kinds.append(kind)
        origins.append(origin)
        frames.append(frame)
        areas.append(area)
    return _Patches(
        owners=np.concatenate(owners),
        kinds=np.concatenate(kinds),
        origin=np.concatenate(origins),
        frame=np.concatenate(frames),
        areas=np.concatenate(areas),
    )


def _cylinder_patches(
    center: Float[np.ndarray, "3"], rotation: Float[np.ndarray, "3 3"], size: Float[np.ndarray, "3"]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Origin, frame, kind and area of a cylinder's side and its two ends."""
    radius, axis = size[0] / 2, rotation[:, 2] * size[2]
    radii = rotation[:, :2].T * radius
    ends = np.stack([center - axis / 2, center - axis / 2, center + axis / 2])
    frames = np.stack([np.vstack([radii, axis]), np.vstack([radii, -axis]), np.vstack([radii, axis])])
    disc = np.pi * radius**2
    return ends, frames, np.array([1, 2, 2]), np.array([2 * np.pi * radius * size[2], disc, disc])


def _map_points(
    patches: _Patches, chosen: Int[np.ndarray, "N"], u: Float[np.ndarray, "N"], v: Float[np.ndarray, "N"]
) -> tuple[Float[np.ndarray, "N 3"], Float[np.ndarray, "N 3"]]:
    """Points and outward normals of patches at (u, v) in the unit square, with uniform area density."""
    kind, frame = patches.kinds[chosen], patches.frame[chosen]
    over = u + v > 1.0
    weights = np.column_stack([np.where(over, 1.0 - u, u), np.where(over, 1.0 - v, v), np.zeros(len(u))])
    normals = frame[:, 2].copy()
    turn = 2 * np.pi * u
    for patch in (1, 2):
        rows = kind == patch
        if not rows.any():
            continue
        reach = 1.0 if patch == 1 else np.sqrt(v[rows])
        weights[rows, 0], weights[rows, 1] = reach * np.cos(turn[rows]), reach * np.sin(turn[rows])
        weights[rows, 2] = v[rows] if patch == 1 else 0.0
        if patch == 1:
            normals[rows] = np.einsum("ni,nij->nj", weights[rows, :2], frame[rows, :2])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return patches.origin[chosen] + np.einsum("ni,nij->nj", weights, frame), normals
