"""Collision hulls of a link from its own surface: a cover of the triangles by convex pieces.

The surface is taken apart into connected components, those whose hulls take free space are cut, and pieces
are joined as long as their common hull takes none. So a board becomes one box whatever its faces look like,
closed bodies one hull, and what can be reached stays free. Pieces that are cut keep out of enclosed rooms,
too: a face in the middle of one would be far from anything that can be seen.
"""

import heapq
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from sim_export.collision.compact import compact_hull
from sim_export.collision.decompose import Decomposition
from sim_export.collision.free_space import TAKEN_DEPTH, FreeSpace, find_free_space, is_open_between, look_up
from sim_export.collision.hull_limits import HullLimits, thicken_hull
from sim_export.collision.hulls import convex_hull
from sim_export.collision.surface_pieces import Piece, join_pieces, make_piece, measure_again, split_piece
from sim_export.errors import DegeneratePart
from sim_export.package import Hull

UNLIKE = 0.3
"""Difference of openness from which on a sheet grows to one side only."""


@dataclass(frozen=True, kw_only=True)
class SurfaceConfig:
    """How true to the surface hulls are; lengths are shares of the object's diagonal."""

    bulge: float = 0.004
    """How far hulls may reach from the surface into free space."""
    coarser: float = 1.5
    """Factor by which that grows until there are few enough hulls."""
    coarsest: float = 0.008
    """It grows no further than this for the sake of one part."""
    loosest: float = 0.02
    """It grows no further than this where the whole object has too many hulls."""
    most_pieces: int = 96
    """Pieces into which the surface of a part is cut, at most."""
    taken: float = 0.004
    """Share of its volume that a hull may take of free space beyond."""
    bare: float = 0.005
    """Share of the area of a joint hull that may newly lie in enclosed space, away from the surface."""
    sheet: float = 0.002
    """Thickness (m) of the hulls of sheets."""
    thickest: float = 0.008
    """Thickness to which long thin hulls are thickened rather than divided."""
    most_of_part: int = 80
    """Hulls of a part, at most; a part of a quarter of the object's diagonal gets half of them."""
    most: int = 224
    """Hulls of the whole object, at most; a few less than checked, for what clearance may have to split."""
    limits: HullLimits = field(default_factory=HullLimits)
    """What each hull must be like."""


def cover_parts(
    surfaces: Sequence[Float[np.ndarray, "F 3 3"]],
    owners: Sequence[int],
    passing: Mapping[int, Float[np.ndarray, "N 3"]],
    cfg: SurfaceConfig | None = None,
) -> tuple[Decomposition, ...]:
    """Hulls of all parts of an object from their triangles (m); a part without any gets none.

    Args:
        surfaces: Triangles of every part.
        owners: The part that leads each part's link.
        passing: Where other links are or pass, by the part that leads a link (`find_passing`).
        cfg: How true to the surface, and how many.
    """
    cfg = cfg or SurfaceConfig()
    everything = np.concatenate([surface.reshape(-1, 3) for surface in surfaces])
    diagonal = float(np.linalg.norm(np.ptp(everything, axis=0)))
    shown = {owner: np.zeros((0, 3, 3)) for owner in sorted(set(owners))}
    for surface, owner in zip(surfaces, owners, strict=True):
        shown[owner] = np.concatenate([shown[owner], surface])
    spaces = {
        owner: find_free_space(found, diagonal, passing.get(owner))
        for owner, found in shown.items()
        if len(found)
    }
    out: list[Decomposition] = []
    for surface, owner in zip(surfaces, owners, strict=True):
        size = float(np.linalg.norm(np.ptp(surface.reshape(-1, 3), axis=0))) if len(surface) else 0.0
        most = max(8, int(cfg.most_of_part * min(1.0, 2.0 * size / diagonal)))
        out.append(_cover_part(surface, spaces.get(owner), diagonal, most, cfg))
    while sum(len(found.hulls) for found in out) > cfg.most:
        index = max(range(len(out)), key=lambda index: len(out[index].hulls))
        count = len(out[index].hulls)
        loose = replace(cfg, coarsest=cfg.loosest)
        fewer = _cover_part(surfaces[index], spaces[owners[index]], diagonal, int(0.7 * count), loose)
        if len(fewer.hulls) >= count:
            break
        out[index] = fewer
    return tuple(out)


def _cover_part(
    surface: Float[np.ndarray, "F 3 3"],
    space: FreeSpace | None,
    diagonal: float,
    most: int,
    cfg: SurfaceConfig,
) -> Decomposition:
    started = time.perf_counter()
    hulls: tuple[Hull, ...] = ()
    if len(surface) and space is not None:
        pieces = cover_surface(surface, space, diagonal, most, cfg)
        found = [hull for piece in pieces if (hull := piece_hull(piece, space, cfg)) is not None]
        thickest = cfg.thickest * diagonal
        thick = [thicken_hull(hull, cfg.limits.min_width) for hull in found]
        hulls = tuple(part for hull in thick for part in compact_hull(hull, cfg.limits, thickest))
    seconds = time.perf_counter() - started
    return Decomposition(hulls=hulls, method="surface", volume_error=0.0, kept_cavity=1.0, seconds=seconds)


def cover_surface(
    triangles: Float[np.ndarray, "F 3 3"],
    space: FreeSpace,
    diagonal: float,
    most: int,
    cfg: SurfaceConfig | None = None,
) -> list[Piece]:
    """Convex pieces that together cover a part's triangles (m), few of them and at most about ``most``."""
    cfg = cfg or SurfaceConfig()
    least = cfg.bulge * diagonal
    whole = make_piece(triangles, space, least)
    if _fits(whole, least, cfg):
        return [whole]
    pieces = [make_piece(group, space, least) for group in split_components(triangles)]
    pieces = _cut(_uncovered(pieces, least), space.without_rooms(), least, cfg)
    pieces = [measure_again(piece, space, least) for piece in pieces]
    while True:
        pieces = _join(_uncovered(pieces, least), space, least, cfg)
        if len(pieces) <= most or least >= cfg.coarsest * diagonal:
            return pieces
        least *= cfg.coarser


def split_components(triangles: Float[np.ndarray, "F 3 3"]) -> list[Float[np.ndarray, "G 3 3"]]:
    """The triangles by what they are connected to through common corners."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    size = max(float(np.ptp(triangles.reshape(-1, 3), axis=0).max()), 1e-9)
    keys = np.round(triangles.reshape(-1, 3) / size * 1e5).astype(np.int64)
    _, slot = np.unique(keys, axis=0, return_inverse=True)
    faces = slot.reshape(-1, 3)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    count = int(faces.max()) + 1
    graph = coo_matrix((np.ones(len(edges)), edges.T), shape=(count, count))
    component = connected_components(graph, directed=False)[1][faces[:, 0]]
    order = np.argsort(component, kind="stable")
    starts = np.flatnonzero(np.diff(component[order])) + 1
    return [triangles[rows] for rows in np.split(order, starts)]


def _fits(piece: Piece, least: float, cfg: SurfaceConfig) -> bool:
    """Whether a piece's hull takes next to no free space."""
    return piece.intrusion.volume <= cfg.taken * piece.volume and piece.intrusion.depth <= 2.0 * least


def _uncovered(pieces: Sequence[Piece], least: float) -> list[Piece]:
    """The pieces without those whose surface lies in or near the hulls of larger ones that fit."""
    order = sorted(pieces, key=lambda piece: (-piece.volume, -piece.area))
    kept: list[Piece] = []
    solid: list[Piece] = []
    for piece in order:
        if _is_covered(piece.samples, solid, 0.5 * least):
            continue
        kept.append(piece)
        if len(piece.planes) and piece.intrusion.volume == 0.0:
            solid.append(piece)
    return kept


def _is_covered(points: Float[np.ndarray, "N 3"], pieces: Sequence[Piece], slack: float) -> bool:
    """Whether all points lie in the hulls of pieces, or within ``slack`` (m) of one's faces."""
    left = points
    for piece in pieces:
        bounds = piece.bounds
        if (left.max(axis=0) < bounds[0] - slack).any() or (left.min(axis=0) > bounds[1] + slack).any():
            continue
        left = left[(left @ piece.planes[:, :3].T - piece.planes[:, 3]).max(axis=1) > slack]
        if not len(left):
            return True
    return False


def _cut(pieces: Sequence[Piece], space: FreeSpace, least: float, cfg: SurfaceConfig) -> list[Piece]:
    """Cuts the pieces that take most free space, until all fit or there are many."""
    done = [piece for piece in pieces if _fits(piece, least, cfg)]
    queue = [
        (-piece.intrusion.volume, n, piece) for n, piece in enumerate(pieces) if not _fits(piece, least, cfg)
    ]
    heapq.heapify(queue)
    serial = len(pieces)
    most = max(cfg.most_pieces, len(pieces) + cfg.most_pieces // 2)
    while queue and len(queue) + len(done) < most:
        _, _, piece = heapq.heappop(queue)
        halves = split_piece(piece, space, least)
        if halves is None:
            done.append(piece)
            continue
        for half in halves:
            if _fits(half, least, cfg):
                done.append(half)
            else:
                serial += 1
                heapq.heappush(queue, (-half.intrusion.volume, serial, half))
    return done + [piece for _, _, piece in queue]


def _join(pieces: Sequence[Piece], space: FreeSpace, least: float, cfg: SurfaceConfig) -> list[Piece]:
    """Joins pairs of pieces, those first whose hull grows least, while the common hulls fit."""
    alive = dict(enumerate(pieces))
    queue: list[tuple[float, int, int, Piece]] = []

    def offer(i: int, others: Sequence[int]) -> None:
        bounds = alive[i].bounds
        for j in others:
            beside = alive[j].bounds
            if (beside[0] > bounds[1] + 3.0 * least).any() or (beside[1] < bounds[0] - 3.0 * least).any():
                continue
            if is_open_between(alive[i].corners[:16], alive[j].corners[:16], space, 2.0 * least):
                continue
            both = join_pieces(alive[i], alive[j], space, least)
            before = alive[i].intrusion.volume + alive[j].intrusion.volume
            fits = _fits(both, least, cfg) or (
                both.intrusion.volume <= before and both.intrusion.depth <= 2.0 * least
            )
            if fits and both.bare <= both.most_bare + cfg.bare * both.area:
                grown = both.volume - alive[i].volume - alive[j].volume
                heapq.heappush(queue, (grown, i, j, both))

    for i in alive:
        offer(i, [j for j in alive if j < i])
    serial = len(alive)
    while queue:
        _, i, j, both = heapq.heappop(queue)
        if i not in alive or j not in alive:
            continue
        del alive[i], alive[j]
        alive[serial] = both
        offer(serial, [k for k in alive if k != serial])
        serial += 1
    return list(alive.values())


def piece_hull(piece: Piece, space: FreeSpace, cfg: SurfaceConfig) -> Hull | None:
    """The hull of a piece; a sheet gets its thickness on the side that is enclosed, or on both."""
    if len(piece.planes):
        try:
            return convex_hull(piece.corners)
        except DegeneratePart:
            pass
    middle = piece.corners.mean(axis=0)
    axes = np.linalg.svd(piece.corners - middle, full_matrices=False)[2]
    if len(axes) < 3:
        return None
    normal = axes[2]
    free = [_openness(piece.samples, side * normal, space) for side in (1.0, -1.0)]
    first, last = (
        (-0.5, 0.5) if abs(free[0] - free[1]) < UNLIKE else (0.0, 1.0) if free[0] < free[1] else (-1.0, 0.0)
    )
    points = np.concatenate([piece.corners + end * cfg.sheet * normal for end in (first, last)])
    try:
        return convex_hull(points)
    except DegeneratePart:
        return None


def _openness(points: Float[np.ndarray, "N 3"], side: Float[np.ndarray, "3"], space: FreeSpace) -> float:
    """How little a sheet should grow to one side: the share of free cells there, taken ones thrice."""
    depth = look_up(points + 1.5 * space.grid.cell * side, space.depth, space.grid)
    return float((depth > 0).mean() + 2.0 * (depth >= TAKEN_DEPTH).mean())
