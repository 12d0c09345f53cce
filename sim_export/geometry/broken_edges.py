"""Broken edges: sharp edges of convex solids rounded where they are seen, so that they catch the light.

An edge is seen where nothing of its part lies on or beside it. Edges flush with a neighbour stay sharp, so
that pieces of one body show no seams; boards of furniture keep theirs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.shapes.primitives import Primitive, contains, place_vertices, polytope
from artigen.shapes.solids import primitive_bounds
from artigen.shapes.surfaces.finishes import Finish, FinishKind
from sim_export.geometry.distances import triangle_distances
from sim_export.geometry.triangles import find_slivers

WIDTHS: Mapping[FinishKind, float] = {
    "wood": 0.0008, "lacquer": 0.001, "steel": 0.0012, "plastic": 0.002, "glass": 0.001, "rubber": 0.0015,
    "stone": 0.002,
}  # fmt: skip
"""Width (m) of a broken edge on each of its faces, by what is broken."""
STEPS = 2
"""Planes that touch the round of a broken edge between its two faces."""
THIN = 0.2
"""Largest width of a broken edge relative to the thickness of its solid."""
LEAST = 0.0002
"""Width (m) below which an edge stays sharp."""
SHARP = float(np.cos(np.radians(50.0)))
"""Cosine of the angle between the normals of two faces above which the edge between them is round enough."""
PROBE = 0.0002
"""Distance (m) from an edge at which other solids cover it."""
SPOTS = (0.08, 0.29, 0.5, 0.71, 0.92)
"""Places along an edge where it is judged."""
SEEN = 0.6
"""Share of these that must be free."""
SLIVER = 1e-3
"""Ratio of height to length of a triangle below which a solid is better left sharp."""
BOARDS: frozenset[FinishKind] = frozenset({"wood", "lacquer", "stone"})


def edge_width(primitive: Primitive, finish: Finish) -> float:
    """Width (m) to which edges of a solid are broken; 0 where it is too thin."""
    width = min(WIDTHS[finish.kind], THIN * float(primitive.size.min()))
    return width if width >= LEAST else 0.0


def is_box(primitive: Primitive) -> bool:
    """Whether a solid is a box in its own frame."""
    normals = np.abs(primitive.planes[:, :3])
    return (
        len(normals) == 6 and primitive.kind == "polytope" and bool((normals.max(axis=1) > 1 - 1e-12).all())
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Broken:
    """A solid with broken edges, and the largest distance (m) of its surface from the sharp one's."""

    primitive: Primitive
    deviation: float = 0.0


def break_edges(
    primitives: Sequence[Primitive], finishes: Mapping[str, Finish], *, boards: bool
) -> list[Broken]:
    """The polytopes of a part with their seen edges broken; all other solids as they were.

    Args:
        primitives: The solids of the part.
        finishes: Finishes by name.
        boards: Whether boxes of wood, lacquer and stone are boards, with seams between them.
    """
    out = [Broken(primitive=primitive) for primitive in primitives]
    cover = Cover(primitives)
    for index, primitive in enumerate(primitives):
        width = edge_width(primitive, finishes[primitive.finish])
        if primitive.kind != "polytope" or not width:
            continue
        pairs = _sharp_edges(primitive)
        if not len(pairs):
            continue
        board = boards and is_box(primitive) and finishes[primitive.finish].kind in BOARDS
        seen = _seen_edges(primitive, pairs, cover, index, board=board)
        if seen.any():
            out[index] = _cut(primitive, pairs[seen], width)
    return out


class Cover:
    """The solids of a part, asked whether they cover points."""

    def __init__(self, primitives: Sequence[Primitive]) -> None:
        self.primitives = primitives
        self.bounds = np.array([primitive_bounds(primitive) for primitive in primitives])

    def free(self, points: Float[np.ndarray, "N 3"], own: Sequence[int]) -> Bool[np.ndarray, "N"]:
        """Whether points (m) lie in no solid but perhaps the ``own`` ones."""
        low, high = points.min(axis=0), points.max(axis=0)
        near = (self.bounds[:, 0] <= high).all(axis=1) & (self.bounds[:, 1] >= low).all(axis=1)
        near[list(own)] = False
        free = np.ones(len(points), dtype=bool)
        for index in np.flatnonzero(near).tolist():
            free &= ~contains(self.primitives[index], points)
        return free


def _sharp_edges(primitive: Primitive) -> np.ndarray:
    """Rows (plane, plane, vertex, vertex) of the sharp edges of a polytope."""
    owner: dict[tuple[int, int], int] = {}
    rows = []
    for plane, ring in enumerate(primitive.rings.tolist()):
        corners = list(dict.fromkeys(ring))
        for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
            owner[start, end] = plane
    for (start, end), plane in owner.items():
        other = owner.get((end, start))
        if other is not None and plane < other:
            rows.append((plane, other, start, end))
    found = np.array(rows, dtype=np.int64).reshape(-1, 4)
    normals = primitive.planes[:, :3]
    return found[(normals[found[:, 0]] * normals[found[:, 1]]).sum(axis=1) < SHARP]


def _seen_edges(
    primitive: Primitive, pairs: np.ndarray, cover: Cover, index: int, *, board: bool
) -> Bool[np.ndarray, "E"]:
    points = place_vertices(primitive)
    normals = primitive.planes[:, :3] @ primitive.rotation.T
    spots = np.array(SPOTS)[None, :, None]
    along = points[pairs[:, 2], None] * (1 - spots) + points[pairs[:, 3], None] * spots  # E S 3
    first, second = normals[pairs[:, 0], None] * PROBE, normals[pairs[:, 1], None] * PROBE
    probes = np.stack([along + first + second, along + first - 2 * second, along + second - 2 * first])
    free = cover.free(probes.reshape(-1, 3), [index]).reshape(probes.shape[:3])
    open_ = free[0] & ((free[1] | free[2]) if board else (free[1] & free[2]))
    return open_.mean(axis=1) >= SEEN


def _cut(primitive: Primitive, pairs: np.ndarray, width: float) -> Broken:
    """The solid without its edges; for boxes from a table of all ways to break their twelve edges."""
    if is_box(primitive):
        normals = primitive.planes[:, :3]
        sides = np.rint(normals).astype(int)
        axis, sign = np.abs(sides).argmax(axis=1), sides.sum(axis=1)
        code = frozenset(
            tuple(sorted([(int(axis[a]), int(sign[a])), (int(axis[b]), int(sign[b]))]))
            for a, b in pairs[:, :2].tolist()
        )
        like, signs, steps, lost = _unit_cut(code)
        half = primitive.size / 2
        vertices = signs * (half - steps * width)
        made = replace(primitive, vertices=vertices, faces=like.faces, planes=like.planes, rings=like.rings)
        return Broken(primitive=made, deviation=lost * width)
    normals = primitive.planes[:, :3]
    sides = normals[pairs[:, :2]]
    sharp = np.linalg.norm(sides.sum(axis=1), axis=1) > 0.2  # else nearly back to back: a blade
    pairs, sides = pairs[sharp], sides[sharp]
    if not len(pairs):
        return Broken(primitive=primitive)
    planes = np.concatenate([primitive.planes, _round_edges(sides, primitive.vertices[pairs[:, 2]], width)])
    made = polytope(_corners(planes, primitive.vertices.mean(axis=0)), primitive.finish)
    if find_slivers(made.vertices[made.faces], SLIVER).any():
        return Broken(primitive=primitive)
    lost = _far_corner(primitive.vertices, made.vertices + made.center, made.faces)
    turned = primitive.rotation @ made.center + primitive.center
    made = replace(
        made,
        center=turned,
        rotation=primitive.rotation,
        lining=primitive.lining,
        lined_side=primitive.lined_side,
    )
    return Broken(primitive=made, deviation=lost)


def _far_corner(
    corners: Float[np.ndarray, "N 3"], vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]
) -> float:
    """Largest distance of the corners of a convex solid from another one inside of it: of all its points."""
    triangles = np.tile(vertices[faces], (len(corners), 1, 1))
    every = triangle_distances(np.repeat(corners, len(faces), axis=0), triangles)
    return float(every.reshape(len(corners), -1).min(axis=1).max())


def _round_edges(
    sides: Float[np.ndarray, "E 2 3"], at: Float[np.ndarray, "E 3"], width: float
) -> Float[np.ndarray, "K 4"]:
    """Planes that round edges between faces of normals ``sides`` through ``at``; faces lose ``width``."""
    angle = np.arccos((sides[:, 0] * sides[:, 1]).sum(axis=1))
    radius = width / (np.tan(angle / 2) - np.tan(angle / (2 * STEPS + 2)))
    rows = []
    for share in np.arange(1, STEPS + 1) / (STEPS + 1):
        weights = np.sin(np.stack([(1 - share) * angle, share * angle], axis=1)) / np.sin(angle)[:, None]
        normal = (weights[:, :, None] * sides).sum(axis=1)
        depth = radius * (np.cos(angle * (share - 0.5)) / np.cos(angle / 2) - 1)
        rows.append(np.column_stack([normal, depth - (normal * at).sum(axis=1)]))
    return np.concatenate(rows)


def _corners(planes: Float[np.ndarray, "K 4"], inside: Float[np.ndarray, "3"]) -> Float[np.ndarray, "N 3"]:
    from scipy.spatial import HalfspaceIntersection

    found = HalfspaceIntersection(planes, inside).intersections
    return np.unique(np.round(found, 9), axis=0)


@cache
def _unit_cut(
    edges: frozenset[tuple[tuple[int, int], ...]],
) -> tuple[Primitive, Float[np.ndarray, "V 3"], Float[np.ndarray, "V 3"], float]:
    """The cube [-1, 1]^3 without these edges, the signs of its corners, how many widths they recede, and how
    many the surface is away from the cube's at most."""
    width = 0.2
    faces = np.column_stack([np.vstack([np.eye(3), -np.eye(3)]), np.full(6, -1.0)])
    sides = np.array([[sign * np.eye(3)[axis] for axis, sign in edge] for edge in sorted(edges)])
    planes = np.concatenate([faces, _round_edges(sides, sides.sum(axis=1), width)])
    like = polytope(_corners(planes, np.zeros(3)), "")
    cube = np.array(list(product((-1.0, 1.0), repeat=3)))
    lost = _far_corner(cube, like.vertices, like.faces) / width
    return like, np.sign(like.vertices), np.round((1.0 - np.abs(like.vertices)) / width, 6), lost
