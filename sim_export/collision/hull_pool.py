"""Candidate hulls of a part: boxes from coarse to fine, convex pieces and their unions.

Pieces are cut at concave edges and joined again as long as their common hull adds little volume.
"""

import heapq
from collections.abc import Sequence
from dataclasses import dataclass

import manifold3d
import numpy as np

from sim_export.collision.cuboids import face_coordinates, fill_between
from sim_export.collision.hull_choice import PooledHull
from sim_export.collision.hull_limits import MAX_ASPECT, comply_hull, thicken_hull, tile_hull
from sim_export.collision.joining import join_neighbours
from sim_export.errors import DegeneratePart
from sim_export.geometry.hulls import box_hull, hull_length
from sim_export.geometry.solids import as_solid, measure_fit, solid_arrays, solid_hull, unite_hulls
from sim_export.package import Hull

Solid = manifold3d.Manifold
MINOR_PLANE = 0.1
"""Share of a piece's concavity below which a plane is not worth a cut for its own sake."""
MOST_PLANES = 4
"""Planes of concave edges that are compared for a cut."""
CUT_EXCESS = 0.02
"""Cutting stops when the pieces' hulls together exceed the solid by this share of its volume."""
MOST_PIECES = 72
"""Cutting stops at this many pieces."""
DETAILS = (1e-2, 3e-3, 1e-3, 2e-4)
"""Least share of the surface that a plane must hold to bound boxes."""
EXACT = 0.01
"""Volume error below which finer boxes are not looked for."""
MOST_BOXES = 96
"""Largest boxes of each detail."""
MOST_JOINED = 64
"""Largest boxes that joining starts from."""
MOST_ADDED = 0.1
"""Share of the solid's volume that joining two hulls may add."""
MANY_TILES = 8
"""Hulls that an oblong one may count as, to be offered as thin as it is."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Piece:
    """A cluster of solid: its hull, the solid's own volume in it, the hull's volume and bounds."""

    hull: Solid
    volume: float
    outer: float
    bounds: np.ndarray


def join_steps(
    hulls: Sequence[Solid], volumes: Sequence[float], most_added: float, *, overlap: bool
) -> list[Solid]:
    """Every hull that joining convex solids pair by pair passes through, those first that add least.

    Args:
        hulls: The convex solids.
        volumes: What of the part each stands for (m^3).
        most_added: Volume (m^3) that no pair may add.
        overlap: Whether the solids may share volume.
    """
    pieces = [_piece(hull, volume) for hull, volume in zip(hulls, volumes, strict=True)]
    if len(pieces) < 2:
        return []

    def join(new: _Piece, other: _Piece) -> tuple[float, _Piece] | None:
        # Only boxes of a cover share volume, which is measured where the joint hull is not too large anyway.
        both = _piece(Solid.batch_hull([new.hull, other.hull]), new.volume + other.volume)
        apart = new.outer + other.outer
        if both.outer - apart > most_added:
            return None
        common = (new.hull ^ other.hull).volume() if overlap else 0.0
        added = both.outer - (apart - common)
        return (added, both) if added <= most_added else None

    reach = 1e-3 * np.ptp(np.concatenate([piece.bounds for piece in pieces]), axis=0).max()
    return [piece.hull for piece in join_neighbours(pieces, reach, join)[1]]


def _piece(hull: Solid, volume: float) -> _Piece:
    bounds = np.array(hull.bounding_box()).reshape(2, 3)
    return _Piece(hull=hull, volume=volume, outer=hull.volume(), bounds=bounds)


def cut_pieces(solid: Solid, most: int = MOST_PIECES) -> list[Solid]:
    """Cuts the least convex piece, again and again; what is left is nearly convex and shares no volume."""
    total = solid.volume()
    queue: list[tuple[float, int, Solid]] = []
    done: list[Solid] = []
    excess, serial = 0.0, 0

    def push(piece: Solid) -> float:
        nonlocal serial
        over = piece.hull().volume() - piece.volume()
        heapq.heappush(queue, (-over, serial, piece))
        serial += 1
        return over

    for component in _components(solid):
        excess += push(component)
    while queue and len(queue) + len(done) < most and excess > CUT_EXCESS * total:
        over, _, piece = heapq.heappop(queue)
        if -over < 0.1 * CUT_EXCESS * total / most:
            done.append(piece)
            continue
        halves = _best_cut(piece)
        if halves is None:
            done.append(piece)
            continue
        excess += over
        for half in halves:
            for component in _components(half):
                if component.volume() > 1e-9 * total:
                    excess += push(component)
    return done + [piece for _, _, piece in queue]


def _components(solid: Solid) -> list[Solid]:
    """Pieces of a solid that are apart; all as one where some enclose a void, which would be one more."""
    found = solid.decompose()
    return found if all(piece.volume() >= 0.0 for piece in found) else [solid]


def _best_cut(piece: Solid) -> tuple[Solid, Solid] | None:
    """The cut through concave edges that resolves most, or one of three through the middle.

    A plane that resolves more than half of all concavity, or clearly more than the next, is taken
    unseen; otherwise what a cut saves in hull volume counts as well.
    """
    vertices, faces = solid_arrays(piece)
    planes, weights = _concave_planes(vertices, faces)
    least = 1e-9 * piece.volume()
    if len(weights) and weights[0] > max(0.5, 2.0 * weights[1:2].sum()):
        halves = piece.split_by_plane(tuple(planes[0, :3]), float(planes[0, 3]))
        if min(half.volume() for half in halves) > least:
            return halves
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    middle = np.column_stack([np.eye(3), (low + high) / 2]), MINOR_PLANE * (high - low) / (high - low).max()
    if not len(weights) or weights[0] < MINOR_PLANE:
        # Curved: no plane stands out, so halving the longest side makes compact pieces.
        planes, weights = np.concatenate([planes, middle[0]]), np.concatenate([weights, middle[1]])
    best = _best_of(piece, planes, weights)
    # Planes of concave edges may touch a piece only along its surface.
    return _best_of(piece, *middle) if best is None else best


def _best_of(piece: Solid, planes: np.ndarray, weights: np.ndarray) -> tuple[Solid, Solid] | None:
    """The cut that scores highest in hull volume saved and weight; None where all leave one side empty."""
    least = 1e-9 * piece.volume()
    before = piece.hull().volume()
    best, best_score = None, -np.inf
    for plane, weight in zip(planes, weights, strict=True):
        halves = piece.split_by_plane(tuple(plane[:3]), float(plane[3]))
        if min(half.volume() for half in halves) <= least:
            continue
        saved = (before - sum(half.hull().volume() for half in halves)) / before
        if saved + weight > best_score:
            best, best_score = halves, saved + weight
    return best


def _concave_planes(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Planes of faces at concave edges ``[K 4]`` and the share of all concavity that each resolves.

    Concavity is edge length times one minus the cosine of the angle by which the edge bends inwards,
    so that real corners outweigh the roughness of a smoothed surface.
    """
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    owner = np.tile(np.arange(len(faces)), 3)
    key = edges.min(axis=1) * len(vertices) + edges.max(axis=1)
    order = np.argsort(key, kind="stable")
    left, right = owner[order[0::2]], owner[order[1::2]]
    start, end = vertices[edges[order[0::2], 0]], vertices[edges[order[0::2], 1]]
    along = end - start
    # The left face runs along the edge counter-clockwise; turning right of it is concave.
    turn = np.einsum("ij,ij->i", np.cross(normals[left], normals[right]), along)
    length = np.linalg.norm(along, axis=1)
    angle = np.arctan2(
        turn / np.maximum(length, 1e-300), np.einsum("ij,ij->i", normals[left], normals[right])
    )
    bent = angle < -0.02
    if not bent.any():
        return np.zeros((0, 4)), np.zeros(0)
    concavity = ((1.0 - np.cos(angle)) * length)[bent]
    normal = np.concatenate([normals[left[bent]], normals[right[bent]]])
    offset = np.einsum("ij,ij->i", normal, np.concatenate([start[bent], start[bent]]))
    size = np.ptp(vertices, axis=0).max()
    # Opposite orientations are the same cut.
    sign = np.where(normal[np.arange(len(normal)), np.abs(normal).argmax(axis=1)] < 0, -1.0, 1.0)
    planes = np.column_stack([normal * sign[:, None], offset * sign])
    rounded = np.round(np.column_stack([planes[:, :3] * 100, planes[:, 3] / size * 1000])).astype(np.int64)
    _, first, slot = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    resolved = np.bincount(slot.ravel(), weights=np.tile(concavity, 2))
    top = np.argsort(-resolved, kind="stable")[:MOST_PLANES]
    return planes[first[top]], resolved[top] / concavity.sum()


def box_offers(solid: Solid) -> list[PooledHull]:
    """Boxes between the planes of a solid, and what they join to; none where it is not axis-aligned."""
    vertices, faces = solid_arrays(solid)
    hulls: list[Hull] = []
    boxes: list[Hull] = []
    before = 0
    for detail in DETAILS:
        planes = face_coordinates(vertices, faces, detail)
        count = sum(map(len, planes or ()))
        if planes is None or count == before:  # finer detail only adds planes
            continue
        before = count
        boxes = [box_hull(low, high) for low, high in fill_between(vertices, faces, planes, MOST_BOXES)]
        hulls += boxes
        if detail != DETAILS[-1] and measure_fit(unite_hulls(boxes), solid).volume_error < EXACT:
            break
    solids = [as_solid(box) for box in boxes[:MOST_JOINED]]
    volumes = [box.volume() for box in solids]
    hulls += _hulls(join_steps(solids, volumes, MOST_ADDED * solid.volume(), overlap=True))
    return _offer(hulls)


def piece_offers(solid: Solid, max_pieces: int) -> list[PooledHull]:
    """Convex pieces of a solid, what they join to, and one hull of all."""
    leaves = cut_pieces(solid, max_pieces)
    pieces = [leaf.hull() for leaf in leaves]
    volumes = [leaf.volume() for leaf in leaves]
    joined = join_steps(pieces, volumes, MOST_ADDED * solid.volume(), overlap=False)
    return _offer(_hulls([*pieces, *joined, solid.hull()]))


def _hulls(solids: list[Solid]) -> list[Hull]:
    out = []
    for solid in solids:
        try:
            out.append(solid_hull(solid))
        except DegeneratePart:
            continue
    return out


def _offer(hulls: list[Hull]) -> list[PooledHull]:
    """The hulls made to comply, each once, and oblong ones also so thick that they stay whole."""
    seen: set[bytes] = set()
    out = []
    for hull in hulls:
        key = np.round(np.sort(hull.vertices, axis=0), 5).tobytes()
        if key in seen:
            continue
        seen.add(key)
        proper = comply_hull(hull)
        tiles = tile_hull(proper, MANY_TILES)
        choices = [(proper, tiles)]
        if len(tiles) != 1:
            thick = comply_hull(thicken_hull(proper, 1.001 * hull_length(proper)[0] / MAX_ASPECT))
            choices.append((thick, tile_hull(thick, MANY_TILES)))
        out += [PooledHull(hull=whole, tiles=tiles) for whole, tiles in choices if tiles]
    return out
