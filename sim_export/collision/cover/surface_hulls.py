"""Collision hulls of a surface, that of a source or of a solid: boxes, and convex pieces of what these leave.

Boxes cover the axis-aligned surface (`sim_export.collision.cover.free_space`), or fill a solid
(`sim_export.collision.cover.cuboids`). What is left is taken apart into connected components, or a surface of
revolution into sectors (`sim_export.collision.cover.sectors`). Those whose hulls take free space are cut, and
pieces are joined as long as their common hull takes none, and coarser where there are too many hulls. Only
surface that can be reached counts.
"""

import heapq
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.runtime.budget import Budget
from sim_export.collision.cover.cuboids import fill_with_boxes
from sim_export.collision.cover.exposed import find_exposed, find_uncovered
from sim_export.collision.cover.free_space import FreeSpace, cover_with_boxes, is_open_between
from sim_export.collision.cover.greedy_joining import join_neighbours
from sim_export.collision.cover.piece_hulls import piece_hull
from sim_export.collision.cover.sectors import SAGITTA, Axis, count_sectors, cut_sectors, find_axis
from sim_export.collision.cover.specks import drop_specks
from sim_export.collision.cover.surface_pieces import (
    Piece,
    intrude_together,
    join_pieces,
    make_piece,
    measure_again,
    split_piece,
)
from sim_export.collision.hull_limits import MIN_WIDTH, THICKEST, compact_hull, thicken_hull
from sim_export.geometry.islands import connect_corners, split_groups
from sim_export.geometry.triangles import triangle_areas
from sim_export.package import Hull

MANY_CORNERS = 64
"""Corners of two pieces from which on it is tried on few of them whether their common hull takes too much."""

LEAST_CELLS = 24
"""Cells along the longest edge of a link below which it gets no boxes."""
# Lengths as shares of the object's diagonal, unless in metres.
TAKEN = 0.004
"""Share of its volume that a hull may take of free space beyond."""
TAKEN_OF_ROUND = 1.0
"""The same of sectors of a thin curved wall, whose hulls are little more than what their arcs enclose."""
SHALLOW = 0.15
"""Depth of the arcs of the sectors of a solid, over the mean thickness of its wall."""


@dataclass(frozen=True, kw_only=True)
class Fineness:
    """How true to the surface the hulls of a link are, and how many there may be."""

    bulge: float
    """How far hulls may reach from the surface into free space, over the object's diagonal."""
    most_pieces: int
    """Pieces into which the surface is cut, at most."""
    most: int
    """Hulls of the link, at most; what clearance cuts them to comes on top."""
    most_of_object: int
    """Hulls of the whole object, at most, where this is its finest link."""
    slack: float
    """Surface this near to a box is covered by it, over the object's diagonal."""


USUAL = Fineness(bulge=0.004, most_pieces=96, most=72, most_of_object=192, slack=0.006)
FINER = Fineness(bulge=0.002, most_pieces=160, most=90, most_of_object=240, slack=0.003)
"""Smaller hulls for links whose details the usual ones miss, and more of them beside boxes, which thin walls
need; slower to make and to simulate."""
DIVIDED = replace(FINER, slack=0.006)
"""The usual hulls in smaller pieces."""
LEVELS = (USUAL, FINER, DIVIDED)
"""In the order in which they are tried."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Cover:
    """What covers a link's surface: boxes, and pieces that reach ``least`` (m) into free space at most, with
    a share ``taken`` of their volume. ``cut`` are the pieces before they were joined."""

    space: FreeSpace
    boxes: tuple[Hull, ...]
    pieces: tuple[Piece, ...]
    least: float
    taken: float = TAKEN
    cut: tuple[Piece, ...] = ()
    hulls: tuple[Hull, ...] = ()


def cover_surface(
    triangles: Float[np.ndarray, "F 3 3"],
    space: FreeSpace,
    diagonal: float,
    fineness: Fineness = USUAL,
    budget: Budget | None = None,
) -> Cover:
    """Hulls that together cover what can be reached of a link's triangles (m).

    When the budget ends, pieces stay as they are, so that their hulls take more free space.
    """
    budget = budget or Budget()
    least = fineness.bulge * diagonal
    whole = make_piece(triangles, space, least)
    if _fits(whole, least, TAKEN):
        return _finish(Cover(space=space, boxes=(), pieces=(whole,), least=least), diagonal)
    exposed = find_exposed(triangles, space)
    axis = find_axis(exposed)
    if axis is not None:
        return _cover_round(triangles, exposed, axis, space, diagonal, fineness, budget)
    if space.solid:
        boxes = fill_with_boxes(triangles)
    else:
        large = np.ptp(triangles.reshape(-1, 3), axis=0).max() >= LEAST_CELLS * space.grid.cell
        boxes = cover_with_boxes(exposed, space) if large else ()
    return _cover_rest(exposed, boxes, space, diagonal, fineness, budget)


def _cover_rest(
    exposed: Float[np.ndarray, "G 3 3"],
    boxes: tuple[Hull, ...],
    space: FreeSpace,
    diagonal: float,
    fineness: Fineness,
    budget: Budget,
) -> Cover:
    """A cover of boxes and of pieces of the surface that these leave."""
    left = find_uncovered(exposed, boxes, fineness.slack * diagonal)
    groups = split_components(left) if len(left) else []
    pieces = [make_piece(group, space, fineness.bulge * diagonal) for group in groups]
    return _cut_and_join(boxes, pieces, space, diagonal, fineness, budget)


def _cover_round(
    triangles: Float[np.ndarray, "F 3 3"],
    exposed: Float[np.ndarray, "G 3 3"],
    axis: Axis,
    space: FreeSpace,
    diagonal: float,
    fineness: Fineness,
    budget: Budget,
) -> Cover:
    """A cover of a surface of revolution by sectors, whose arcs are shallow against the wall of a solid."""
    depth = SAGITTA * diagonal
    if space.solid:
        depth = min(depth, SHALLOW * _mean_thickness(triangles))
        fineness = replace(fineness, bulge=min(fineness.bulge, depth / diagonal / 2.0))
    groups = cut_sectors(exposed, axis, count_sectors(axis.radius, depth))
    pieces = [make_piece(group, space, fineness.bulge * diagonal) for group in groups]
    return _cut_and_join((), pieces, space, diagonal, fineness, budget, TAKEN_OF_ROUND)


def _mean_thickness(triangles: Float[np.ndarray, "F 3 3"]) -> float:
    """Twice the volume of a closed surface over its area (m)."""
    a, b, c = triangles.swapaxes(0, 1)
    volume = float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0
    return 2.0 * volume / float(triangle_areas(triangles).sum())


def refine_cover(
    cover: Cover,
    triangles: Float[np.ndarray, "F 3 3"],
    diagonal: float,
    fineness: Fineness,
    budget: Budget | None = None,
) -> Cover:
    """A cover of the same triangles (m) with smaller hulls: its pieces are cut further, or more surface is
    covered beside its boxes."""
    budget = budget or Budget()
    if not cover.cut:  # one hull was enough
        return cover_surface(triangles, cover.space, diagonal, fineness, budget)
    if cover.boxes and fineness.slack < USUAL.slack:
        exposed = find_exposed(triangles, cover.space)
        return _cover_rest(exposed, cover.boxes, cover.space, diagonal, fineness, budget)
    fineness = replace(fineness, bulge=min(fineness.bulge, cover.least / diagonal))
    pieces = [measure_again(piece, cover.space, fineness.bulge * diagonal) for piece in cover.cut]
    return _cut_and_join(cover.boxes, pieces, cover.space, diagonal, fineness, budget, cover.taken)


def _cut_and_join(
    boxes: tuple[Hull, ...],
    pieces: Sequence[Piece],
    space: FreeSpace,
    diagonal: float,
    fineness: Fineness,
    budget: Budget,
    taken: float = TAKEN,
) -> Cover:
    """A cover of boxes and of pieces, which are cut until their hulls fit, and joined."""
    least = fineness.bulge * diagonal
    cut = tuple(_cut(_uncovered(pieces, least), space, least, taken, fineness.most_pieces, budget))
    cover = Cover(space=space, boxes=boxes, pieces=cut, least=least, taken=taken, cut=cut)
    return join_again(cover, least, diagonal)


def join_again(cover: Cover, least: float, diagonal: float) -> Cover:
    """A cover whose pieces are joined as far as they may take ``least`` (m) of free space."""
    pieces = _join(_uncovered(cover.pieces, least), cover.space, least, cover.taken)
    return _finish(replace(cover, pieces=tuple(pieces), least=least), diagonal)


def _finish(cover: Cover, diagonal: float) -> Cover:
    """A cover with its hulls, within the limits of engines."""
    found = [hull for piece in cover.pieces if (hull := piece_hull(piece, cover.space)) is not None]
    thick = [thicken_hull(hull, MIN_WIDTH) for hull in found]
    proper = [
        part
        for hull in thick
        for part in compact_hull(hull, THICKEST * diagonal, reach=2.0 * cover.least, lost=2.0 * cover.least)
    ]
    return replace(cover, hulls=drop_specks((*cover.boxes, *proper), diagonal))


def split_components(triangles: Float[np.ndarray, "F 3 3"]) -> list[Float[np.ndarray, "G 3 3"]]:
    """The triangles by what they are connected to through common corners."""
    size = max(float(np.ptp(triangles.reshape(-1, 3), axis=0).max()), 1e-9)
    places = np.round(triangles.reshape(-1, 3) / size * 1e5).astype(np.int64)
    return split_groups(triangles, connect_corners(places))


def _fits(piece: Piece, least: float, taken: float) -> bool:
    """Whether a piece's hull takes next to no free space."""
    return piece.intrusion.volume <= taken * piece.volume and piece.intrusion.depth <= 2.0 * least


def _uncovered(pieces: Sequence[Piece], least: float) -> list[Piece]:
    """The pieces without those whose surface, if any, lies in or near the hulls of larger ones that fit."""
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
        if not len(left):
            break
        bounds = piece.bounds
        if (left.max(axis=0) < bounds[0] - slack).any() or (left.min(axis=0) > bounds[1] + slack).any():
            continue
        left = left[(left @ piece.planes[:, :3].T - piece.planes[:, 3]).max(axis=1) > slack]
    return not len(left)


def _cut(
    pieces: Sequence[Piece], space: FreeSpace, least: float, taken: float, most_pieces: int, budget: Budget
) -> list[Piece]:
    """Cuts the pieces that take most free space, until all fit, there are many, or the budget ends."""
    done = [piece for piece in pieces if _fits(piece, least, taken)]
    queue = [
        (-piece.intrusion.volume, n, piece)
        for n, piece in enumerate(pieces)
        if not _fits(piece, least, taken)
    ]
    heapq.heapify(queue)
    serial = len(pieces)
    most = max(most_pieces, len(pieces) + most_pieces // 2)
    while queue and len(queue) + len(done) < most and not budget.is_over():
        _, _, piece = heapq.heappop(queue)
        halves = split_piece(piece, space, least)
        if halves is None:
            done.append(piece)
            continue
        for half in halves:
            if _fits(half, least, taken):
                done.append(half)
            else:
                serial += 1
                heapq.heappush(queue, (-half.intrusion.volume, serial, half))
    return done + [piece for _, _, piece in queue]


def _join(pieces: Sequence[Piece], space: FreeSpace, least: float, taken: float) -> list[Piece]:
    """Joins pairs of pieces, those first whose hull grows least, while the common hulls fit."""

    def join(new: Piece, other: Piece) -> tuple[float, Piece] | None:
        if is_open_between(new.corners[:16], other.corners[:16], space, 2.0 * least):
            return None
        before = new.intrusion.volume + other.intrusion.volume
        if len(new.corners) + len(other.corners) > MANY_CORNERS:
            some = intrude_together(new, other, space, least)
            if some.depth > 2.0 * least:
                return None
        both = join_pieces(new, other, space, least)
        fits = _fits(both, least, taken) or (
            both.intrusion.volume <= before and both.intrusion.depth <= 2.0 * least
        )
        return (both.volume - new.volume - other.volume, both) if fits else None

    return join_neighbours(pieces, 3.0 * least, join)
