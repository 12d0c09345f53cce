"""Solids of any shape as few convex pieces: cut at concave edges, then join what hardly grows.

Cutting top-down with exact booleans makes small, nearly convex pieces; joining bottom-up measures
concavity as volume, ``hull(A and B) - A - B``, and always takes the pair that adds least. Both
halves are cheap because hulls and half-space cuts of small meshes take fractions of a millisecond.
"""

import heapq
from collections.abc import Sequence
from dataclasses import dataclass

import manifold3d
import numpy as np

from sim_export.solids import solid_arrays

Solid = manifold3d.Manifold
MINOR_PLANE = 0.1
"""Share of a piece's concavity below which a plane is not worth a cut for its own sake."""


@dataclass(frozen=True, kw_only=True)
class PieceConfig:
    """Where cutting and joining stop."""

    max_pieces: int = 72
    """Cutting stops at this many pieces; raise it for parts with fine detail that hulls should follow."""
    max_hulls: int = 32
    """Joining goes on until no more hulls than this are left, whatever it costs."""
    cut_excess: float = 0.03
    """Cutting stops when the pieces' hulls together exceed the solid by this share of its volume."""
    join_excess: float = 0.04
    """Joining goes on while the hulls together exceed the solid by less than this share of its volume."""
    smallest: float = 1e-4
    """Pieces below this share of the solid's volume are joined to a neighbour or, alone, left out."""
    small: float = 5e-3
    """Pieces below this share are joined to a neighbour if that adds no more than their own volume."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Piece:
    """A cluster of solid: its hull, the solid's own volume in it, the hull's volume and bounds."""

    hull: Solid
    volume: float
    outer: float
    bounds: np.ndarray

    @property
    def excess(self) -> float:
        return self.outer - self.volume


def join_pieces(pieces: Sequence[Solid], total: float, cfg: PieceConfig) -> list[Solid]:
    """Joins convex solids, which may overlap, into fewer: those pairs first that add least volume.

    ``total`` is the volume of what the pieces stand for, and the measure of ``cfg.join_excess``,
    which here bounds what joining adds. Largest first.
    """
    joined = _join([_piece(piece, piece.volume()) for piece in pieces], total, cfg, overlap=True)
    return [piece.hull for piece in _largest_first(joined)]


def convex_pieces(solid: Solid, cfg: PieceConfig) -> list[Solid]:
    """Few convex solids that together cover ``solid`` and exceed it little, largest first."""
    total = solid.volume()
    leaves = _cut(solid, cfg)
    pieces = _join([_piece(leaf.hull(), leaf.volume()) for leaf in leaves], total, cfg, overlap=False)
    return [piece.hull for piece in _largest_first(pieces) if piece.volume >= cfg.smallest * total] or [
        solid.hull()
    ]


def _piece(hull: Solid, volume: float) -> _Piece:
    bounds = np.array(hull.bounding_box()).reshape(2, 3)
    return _Piece(hull=hull, volume=volume, outer=hull.volume(), bounds=bounds)


def _largest_first(pieces: list[_Piece]) -> list[_Piece]:
    return sorted(pieces, key=lambda piece: (-piece.outer, *piece.bounds.ravel()))


def _cut(solid: Solid, cfg: PieceConfig) -> list[Solid]:
    """Cuts the least convex piece, again and again."""
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

    for component in solid.decompose():
        excess += push(component)
    while queue and len(queue) + len(done) < cfg.max_pieces and excess > cfg.cut_excess * total:
        over, _, piece = heapq.heappop(queue)
        if -over < 0.1 * cfg.cut_excess * total / cfg.max_pieces:
            done.append(piece)
            continue
        halves = _best_cut(piece)
        if halves is None:
            done.append(piece)
            continue
        excess += over
        for half in halves:
            for component in half.decompose():
                if component.volume() > 1e-9 * total:
                    excess += push(component)
    return done + [piece for _, _, piece in queue]


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
    if not len(weights) or weights[0] < MINOR_PLANE:
        # Curved: no plane stands out, so halving the longest side makes compact pieces.
        planes = np.concatenate([planes, np.column_stack([np.eye(3), (low + high) / 2])])
        weights = np.concatenate([weights, MINOR_PLANE * (high - low) / (high - low).max()])
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


def _concave_planes(vertices: np.ndarray, faces: np.ndarray, most: int = 4) -> tuple[np.ndarray, np.ndarray]:
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
    top = np.argsort(-resolved, kind="stable")[:most]
    return planes[first[top]], resolved[top] / concavity.sum()


def _join(pieces: list[_Piece], total: float, cfg: PieceConfig, *, overlap: bool) -> list[_Piece]:
    """Joins the pair that adds least volume until the budget is used and few enough are left."""
    alive = dict(enumerate(pieces))
    excess = sum(piece.excess for piece in pieces)
    reach = 1e-3 * np.ptp(np.concatenate([piece.bounds for piece in pieces]), axis=0).max()
    queue = [
        _candidate(alive, i, j, overlap=overlap)
        for i in alive
        for j in range(i)
        if _touch(alive[i], alive[j], reach)
    ]
    heapq.heapify(queue)
    serial = len(pieces)
    while len(alive) > 1:
        if not queue:
            if len(alive) <= cfg.max_hulls:
                break
            # Only pieces apart from each other are left, and still too many of them.
            queue = [_candidate(alive, i, j, overlap=overlap) for i in alive for j in alive if j < i]
            heapq.heapify(queue)
        cost, i, j, both = heapq.heappop(queue)
        if i not in alive or j not in alive:
            continue
        lesser = min(alive[i].volume, alive[j].volume)
        tiny = lesser < cfg.small * total and cost <= max(lesser, cfg.smallest * total)
        if len(alive) <= cfg.max_hulls and excess + cost > cfg.join_excess * total and not tiny:
            if cost > cfg.small * total:
                break
            continue
        excess += cost
        del alive[i], alive[j]
        near = [other for other in alive if _touch(both, alive[other], reach)]
        alive[serial] = both
        for other in near:
            heapq.heappush(queue, _candidate(alive, serial, other, overlap=overlap))
        serial += 1
    return list(alive.values())


def _candidate(alive: dict[int, _Piece], i: int, j: int, *, overlap: bool) -> tuple[float, int, int, _Piece]:
    """What joining two pieces costs, and the result; indices make the order unique.

    Pieces of a cut solid share no volume, so only boxes of a cover pay for measuring it.
    """
    a, b = alive[i], alive[j]
    common = (a.hull ^ b.hull).volume() if overlap and _touch(a, b, 0.0) else 0.0
    both = _piece(Solid.batch_hull([a.hull, b.hull]), a.volume + b.volume)
    return both.outer - (a.outer + b.outer - common), i, j, both


def _touch(a: _Piece, b: _Piece, reach: float) -> bool:
    return bool((a.bounds[0] <= b.bounds[1] + reach).all() and (b.bounds[0] <= a.bounds[1] + reach).all())
