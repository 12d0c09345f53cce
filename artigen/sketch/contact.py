"""Exact penetration depths and distances between convex primitives, vectorised over pairs.

A primitive is represented by its closed surface; a cylinder by the prism that approximates it in collision.
Distances use the separating axis theorem: face normals, and edge pairs where two solids overlap. Axis-aligned
boxes have closed-form distances.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.shapes.primitives import Primitive, place_vertices
from artigen.shapes.shape import Shape
from artigen.shapes.solids import primitive_parts
from artigen.shapes.support import measure_overhang

SMALL = (8, 6)
"""Vertices and faces of a box: box pairs are the majority and are measured separately."""
_ALONG = 1.0 - 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class Bodies:
    """All primitives of a shape in padded arrays (metres, object frame); padding repeats the first row.

    Attributes:
        primitives: The primitives, part by part.
        vertices: Their corners.
        planes: Outward unit normals and offsets: ``normal @ point + offset <= 0`` inside.
        low: Lowest corner of each primitive's bounds.
        high: Highest corner.
        upright: Primitives that are axis-aligned boxes and so equal their bounds.
        large: Primitives with more vertices or faces than a box.
        parts: Part of each primitive.
        links: Rigid body of each primitive, identified by its leading part.
    """

    primitives: tuple[Primitive, ...]
    vertices: Float[np.ndarray, "N V 3"]
    planes: Float[np.ndarray, "N K 4"]
    low: Float[np.ndarray, "N 3"]
    high: Float[np.ndarray, "N 3"]
    upright: Bool[np.ndarray, "N"]
    large: Bool[np.ndarray, "N"]
    parts: Int[np.ndarray, "N"]
    links: Int[np.ndarray, "N"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Near:
    """Pairs of primitives that are close at rest, ``first`` before ``second``."""

    first: Int[np.ndarray, "C"]
    second: Int[np.ndarray, "C"]
    distance: Float[np.ndarray, "C"]
    """Metres; negative for penetration depth, the shortest translation that separates the pair."""


def list_bodies(shape: Shape, leaders: Int[np.ndarray, "P"]) -> Bodies:
    """Collects the primitives of all parts; ``leaders`` are the leading parts of their rigid bodies."""
    primitives = tuple(primitive for part in shape.parts for primitive in part.primitives)
    parts = primitive_parts(shape)
    return gather_bodies(primitives, parts, leaders[parts])


def gather_bodies(
    primitives: tuple[Primitive, ...],
    parts: Int[np.ndarray, "N"] | None = None,
    links: Int[np.ndarray, "N"] | None = None,
) -> Bodies:
    """Collects primitives; by default each belongs to part and rigid body 0."""
    zero = np.zeros(len(primitives), dtype=int)
    corners = [place_vertices(primitive) for primitive in primitives]
    sides = [_place_planes(primitive) for primitive in primitives]
    vertices, planes = _pad(corners), _pad(sides)
    counts = np.array([(len(v), len(p)) for v, p in zip(corners, sides, strict=True)])
    return Bodies(
        primitives=primitives,
        vertices=vertices,
        planes=planes,
        low=vertices.min(axis=1),
        high=vertices.max(axis=1),
        upright=_are_aligned(planes) & (counts[:, 1] == SMALL[1]),
        large=np.any(counts > np.array(SMALL), axis=1),
        parts=zero if parts is None else parts,
        links=zero if links is None else links,
    )


def displace(bodies: Bodies, rows: Int[np.ndarray, "M"], T: Float[np.ndarray, "M 4 4"]) -> Bodies:
    """Applies a rigid displacement to each of some primitives."""
    vertices, planes, upright = bodies.vertices.copy(), bodies.planes.copy(), bodies.upright.copy()
    vertices[rows], planes[rows] = _move(vertices[rows], planes[rows], T)
    upright[rows] &= _are_aligned(planes[rows])
    low, high = vertices.min(axis=1), vertices.max(axis=1)
    return replace(bodies, vertices=vertices, planes=planes, low=low, high=high, upright=upright)


def find_near(bodies: Bodies, reach: float) -> Near:
    """Pairs whose bounds are closer than ``reach`` (m), with their distances."""
    gaps = np.maximum(bodies.low[:, None] - bodies.high[None], bodies.low[None] - bodies.high[:, None])
    first, second = np.nonzero(np.triu(gaps.max(axis=2) <= reach, k=1))
    return Near(first=first, second=second, distance=measure_pairs(bodies, first, second))


def measure_pairs(
    bodies: Bodies, first: Int[np.ndarray, "C"], second: Int[np.ndarray, "C"]
) -> Float[np.ndarray, "C"]:
    """Signed distances (m) of pairs; penetration depths are upper bounds except for axis-aligned boxes."""
    gaps = np.maximum(bodies.low[first] - bodies.high[second], bodies.low[second] - bodies.high[first])
    apart = np.linalg.norm(gaps.clip(min=0.0), axis=1)
    distance = np.where(apart > 0, apart, gaps.max(axis=1))
    slanted = np.flatnonzero(~(bodies.upright[first] & bodies.upright[second]))
    if len(slanted):
        across = separate(bodies, first[slanted], second[slanted])
        distance[slanted] = np.maximum(distance[slanted], across)
    return distance


def separate(
    bodies: Bodies,
    first: Int[np.ndarray, "C"],
    second: Int[np.ndarray, "C"],
    T: Float[np.ndarray, "C 4 4"] | None = None,
) -> Float[np.ndarray, "C"]:
    """Largest face separation of each pair (m); negative where no face plane separates the two.

    Args:
        T: Displacement of the first primitive of each pair; by default none.
    """
    out = np.empty(len(first))
    kinds = 2 * bodies.large[first] + bodies.large[second]
    for kind in np.unique(kinds):
        rows = np.flatnonzero(kinds == kind)
        ends = [slice(None) if flag else slice(size) for flag in divmod(int(kind), 2) for size in SMALL]
        one, other = first[rows], second[rows]
        corners, sides = bodies.vertices[one, ends[0]], bodies.planes[one, ends[1]]
        if T is not None:
            corners, sides = _move(corners, sides, T[rows])
        faced = bodies.planes[other, ends[3]]
        out[rows] = np.maximum(_stand_off(sides, bodies.vertices[other, ends[2]]), _stand_off(faced, corners))
    return out


def separate_edges(
    bodies: Bodies, first: int, second: int, T: Float[np.ndarray, "P 4 4"]
) -> Float[np.ndarray, "P"]:
    """Largest separation of two solids (m) along cross products of edges, for each displacement of the
    first."""
    turn, offset = T[:, :3, :3], T[:, :3, 3]
    ours = _edge_directions(bodies, first) @ np.swapaxes(turn, 1, 2)
    axes = np.cross(ours[:, :, None], _edge_directions(bodies, second)[None, None]).reshape(len(T), -1, 3)
    lengths = np.linalg.norm(axes, axis=2)
    axes /= np.maximum(lengths, 1e-12)[..., None]
    moved = bodies.vertices[first] @ np.swapaxes(turn, 1, 2) + offset[:, None]
    here = axes @ np.swapaxes(moved, 1, 2)
    there = axes @ bodies.vertices[second].T
    apart = np.maximum(here.min(axis=2) - there.max(axis=2), there.min(axis=2) - here.max(axis=2))
    return np.where(lengths > 1e-6, apart, -np.inf).max(axis=1)


def penetrate(bodies: Bodies, first: int, second: int, T: Float[np.ndarray, "P 4 4"]) -> float:
    """Greatest penetration depth (m) of two solids over displacements of the first; exact, 0 if disjoint."""
    pair = np.full(len(T), first), np.full(len(T), second)
    depth = -separate(bodies, *pair, T)
    deep = np.flatnonzero(depth > 0)
    if not len(deep):
        return 0.0
    return max(0.0, float(np.minimum(depth[deep], -separate_edges(bodies, first, second, T[deep])).max()))


def find_overlaps(bodies: Bodies, others: Bodies, limit: float) -> Int[np.ndarray, "K"]:
    """Primitives of ``bodies`` that ``others`` penetrate by more than ``limit`` (m), in ascending order."""
    depth = np.minimum(bodies.high[:, None] - others.low, others.high - bodies.low[:, None]).min(axis=2)
    first, second = np.nonzero(depth > limit)
    hit = bodies.upright[first] & others.upright[second]
    if not hit.all():
        rows = np.unique(first)
        both = gather_bodies((*(bodies.primitives[row] for row in rows), *others.primitives))
        one, other = np.searchsorted(rows, first), len(rows) + second
        for k in np.flatnonzero(~hit & (measure_pairs(both, one, other) < -limit)):
            hit[k] = penetrate(both, int(one[k]), int(other[k]), np.eye(4)[None]) > limit
    return np.unique(first[hit])


def measure_thickness(bodies: Bodies) -> Float[np.ndarray, "N"]:
    """Thickness of each solid: smallest distance (m) between a face plane and its farthest corner."""
    heights = bodies.planes[:, :, :3] @ np.swapaxes(bodies.vertices, 1, 2) + bodies.planes[:, :, 3:]
    return -heights.min(axis=2).max(axis=1)


def find_overhang(bodies: Bodies, band: float) -> float:
    """Distance (m) of the centre of volume from the support polygon in plan; negative inside.

    Args:
        band: Height (m) above the lowest point within which corners count as support.
    """
    corners = bodies.vertices.reshape(-1, 3)
    feet = corners[corners[:, 2] < corners[:, 2].min() + band, :2]
    volumes, middles = _weigh(bodies)
    middle = volumes @ middles[:, :2] / volumes.sum()
    return measure_overhang(feet, middle)


def _weigh(bodies: Bodies) -> tuple[Float[np.ndarray, "N"], Float[np.ndarray, "N 3"]]:
    """Volumes (m^3) and centres (m) of solids."""
    faces = [primitive.faces for primitive in bodies.primitives]
    rows = np.repeat(np.arange(len(faces)), [len(found) for found in faces])
    inner = bodies.vertices.mean(axis=1)
    a, b, c = np.moveaxis(bodies.vertices[rows[:, None], np.concatenate(faces)] - inner[rows, None], 1, 0)
    shares = np.einsum("fi,fi->f", np.cross(a, b), c) / 6
    volumes = np.bincount(rows, weights=shares)
    moments = [np.bincount(rows, weights=shares * (a + b + c)[:, k] / 4) for k in range(3)]
    return volumes, inner + np.stack(moments, axis=1) / volumes[:, None]


def _place_planes(primitive: Primitive) -> Float[np.ndarray, "K 4"]:
    normals = primitive.planes[:, :3] @ primitive.rotation.T
    return np.column_stack([normals, primitive.planes[:, 3] - normals @ primitive.center])


def _are_aligned(planes: Float[np.ndarray, "N K 4"]) -> Bool[np.ndarray, "N"]:
    """Whether all normals of a solid are along axes."""
    return (np.abs(planes[:, :, :3]).max(axis=2) > _ALONG).all(axis=1)


def _pad(rows: list[np.ndarray]) -> Float[np.ndarray, "N M D"]:
    """Stacks arrays of different lengths; short ones repeat their first row."""
    lengths = np.array([len(row) for row in rows])
    starts = np.cumsum(lengths) - lengths
    column = np.arange(lengths.max())
    return np.concatenate(rows)[starts[:, None] + np.where(column < lengths[:, None], column, 0)]


def _move(
    corners: Float[np.ndarray, "C V 3"], sides: Float[np.ndarray, "C K 4"], T: Float[np.ndarray, "C 4 4"]
) -> tuple[Float[np.ndarray, "C V 3"], Float[np.ndarray, "C K 4"]]:
    turn, offset = np.swapaxes(T[:, :3, :3], 1, 2), T[:, :3, 3]
    normals = sides[:, :, :3] @ turn
    shifted = sides[:, :, 3:] - normals @ offset[:, :, None]
    return corners @ turn + offset[:, None], np.concatenate([normals, shifted], axis=2)


def _stand_off(
    sides: Float[np.ndarray, "C K 4"], corners: Float[np.ndarray, "C V 3"]
) -> Float[np.ndarray, "C"]:
    """Smallest signed distance of the corners from a plane, maximised over the planes."""
    heights = sides[:, :, :3] @ np.swapaxes(corners, 1, 2)
    return (heights.min(axis=2) + sides[:, :, 3]).max(axis=1)


def _edge_directions(bodies: Bodies, row: int) -> Float[np.ndarray, "E 3"]:
    """Unique edge directions of a solid, ignoring sign."""
    rings = bodies.primitives[row].rings
    corners = bodies.vertices[row]
    edges = (corners[np.roll(rings, -1, axis=1)] - corners[rings]).reshape(-1, 3)
    lengths = np.linalg.norm(edges, axis=1)
    edges = edges[lengths > 1e-9] / lengths[lengths > 1e-9, None]
    turned = np.sign(np.round(edges, 6) @ np.array([1e6, 1e3, 1.0]))
    return np.unique(np.round(edges * turned[:, None], 6), axis=0)
