"""Flattens faces: fills holes and removes steps, stains and frayed edges.

The top, the sides and the back of a cabinet or an appliance are whole boards. So are the fronts of doors and
drawers, and the front of a washing machine around its door. A strip along an edge may lie deeper or higher,
where another board overlaps; doors and drawers have panels in their middle, and grips. The front of any other
body consists of rectangles: frame, rails, and the openings between them. A network draws half of a board a
cell deeper than the rest, and leaves corners out.

Every face is redrawn. The cells of each column are evidence for the depth at which the part begins there
(`weigh_depths`). The strips and rectangles with the most evidence are drawn; the rest is the board.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_fill_holes, label

from artigen.kind import Board, find_kind
from artigen.voxels.cleanup.boxes import find_boxes
from artigen.voxels.cleanup.rows import CERTAIN, Owners, note_changes
from artigen.voxels.fields import name_category, name_rows
from artigen.voxels.regions import find_rectangles, is_round

FaceKind = Literal["top", "side", "back", "front", "plate", "panel"]

BOARDS: tuple[Board, ...] = ("top", "side", "back")
"""Faces of a body that are whole boards, where its kind is not known."""
DEPTH = 6
"""Layers of cells in which a face is sought."""
LEAST, SHARE = 12.0, 0.03
"""Least evidence for a strip or rectangle: in certain cells, and per cell of the face; both must hold."""
ON = 1
"""Layers in which cells of other parts lie on the face; deeper ones are seen through a hole."""
HALF = 0.5
"""Least share of a line across a face in which the part is seen for the face to extend over that line."""
BENEATH = ("drawer", "shelf")
"""Labels of parts that give way to a top."""
SEEN = 0.6
"""Least share of the columns in which the part begins within `DEPTH` layers for them to form a face."""
SMALLEST: Mapping[FaceKind, int] = {"front": 4, "panel": 4, "plate": 16, "top": 16, "side": 16, "back": 16}
"""Least width of a face in cells; the low sides of a cooktop are not faces."""
WIDE, NARROW = 0.35, 3
"""Largest width of a strip: a share of the face where doors, plinths or worktops may be, else in cells."""
FILLED = 0.35
"""Largest share of a face that is filled; a face that lacks more was meant to be open."""
CENTRED, SMALL = 0.06, 0.05
"""Shares of a face: largest offset of a panel from the middle across it, and largest area of a grip, which
may lie anywhere."""
SURE, WHOLE = 1.3, 0.7
"""Least evidence per cell of a panel or grip (2 is certain), and least ratio of its area to that of the
connected region which it covers."""
ROUNDS = 2
"""Passes over the candidate depths of a front."""
THICKEST = 3
"""Most cells filled behind a face; fewer where the face is thinner elsewhere."""


class Side(NamedTuple):
    """FaceKind and viewing direction of a face."""

    kind: FaceKind
    """All but ``front`` are boards."""
    axis: int
    """Axis along which the face is seen."""
    end: int
    """End of the axis from which it is seen: 1 the lower, -1 the higher."""


PANEL = Side("panel", 0, 1)
SIDES: Mapping[str, tuple[Side, ...]] = {
    "base": (
        Side("back", 0, -1),
        Side("side", 1, 1),
        Side("side", 1, -1),
        Side("front", 0, 1),
        Side("top", 2, -1),
    ),
    "door": (PANEL,),
    "drawer": (PANEL,),
}
"""Faces to flatten, by part label."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Face:
    """A face of a part, seen along the first axis."""

    kind: FaceKind
    number: int
    """Row of the part in the outline."""
    cells: Owners
    """View of the owners in the part's box, the nearest layer first."""
    mine: Bool[np.ndarray, "D H W"]
    """Cells of the part."""
    free: Bool[np.ndarray, "D H W"]
    """Cells that the part may take: empty ones, and those of parts that give way."""
    weights: Float[np.ndarray, "K H W"]
    """Log-evidence per candidate depth; the last entry means "no surface" (`weigh_depths`)."""
    covered: Bool[np.ndarray, "H W"]
    """Columns that are not redrawn: another part stands there, or the face does not extend that far."""

    @property
    def depths(self) -> Int[np.ndarray, "H W"]:
        """Depth at which the part begins in each column; the number of depths where it begins at none."""
        near = self.mine[: len(self.weights) - 1]
        return np.where(near.any(axis=0), near.argmax(axis=0), len(near))

    @property
    def least(self) -> float:
        """Least evidence for a strip or rectangle of this face."""
        return max(LEAST, SHARE * int((~self.covered).sum()))


def even_faces(
    owners: Owners, logits: Float[np.ndarray, "X Y Z"], rows: Float[np.ndarray, "N C"]
) -> tuple[Owners, tuple[str, ...]]:
    """Flattens the faces of all parts; returns the new owners and a note of how many cells changed."""
    before, owners = owners, owners.copy()
    kind, names = find_kind(name_category(rows) or ""), name_rows(rows)
    boards = BOARDS if kind is None or kind.channel is None else kind.channel.boards
    beneath = np.isin(names, BENEATH)
    for number, name in enumerate(names):
        for side in SIDES.get(name, ()):
            if side.kind in BOARDS and side.kind not in boards:
                continue
            if side.kind == "front" and "plate" in boards:
                side = side._replace(kind="plate")
            face = _read_face(owners, logits, number, side, beneath)
            if face is None:
                continue
            if side.kind == "front":
                _put(face, _draw_rectangles(face), ~face.covered)
            elif side.kind == "panel":
                _lay_panels(face)
            else:
                _lay_board(face)
    return note_changes(before, owners, "cells of holes, stairs and frayed edges of faces were made even")


def weigh_depths(evidence: Float[np.ndarray, "D H W"]) -> Float[np.ndarray, "K H W"]:
    """Log-evidence per candidate depth of a column; the last entry means "no surface".

    A depth means that all cells before it are empty and that its own cell is occupied. Cells behind it may be
    either, so each counts as if it agreed.

    Args:
        evidence: From -1 (certainly empty) to 1 (certainly occupied).
    """
    empty = np.concatenate([np.zeros((1, *evidence.shape[1:])), -evidence.cumsum(axis=0)])
    behind = np.abs(evidence)[::-1].cumsum(axis=0)[::-1]
    behind = np.concatenate([behind[1:], np.zeros((1, *evidence.shape[1:]))])
    return np.concatenate([empty[:-1] + evidence + behind, empty[-1:]])


def _read_face(
    owners: Owners,
    logits: Float[np.ndarray, "X Y Z"],
    number: int,
    side: Side,
    beneath: Bool[np.ndarray, "N"],
) -> Face | None:
    """A face of a part in its box; None if it is round, too small or too open."""
    at = np.argwhere(owners == number)
    if not len(at):
        return None
    kind, axis, end = side
    box = tuple(slice(low, high) for low, high in zip(at.min(axis=0), at.max(axis=0) + 1, strict=True))
    cells, scores = (np.moveaxis(grid[box], axis, 0)[::end] for grid in (owners, logits))
    mine = cells == number
    seen = np.asarray(mine.any(axis=0))
    deep = min(DEPTH, len(cells))
    if min(seen.shape) < SMALLEST[kind] or is_round(seen):
        return None
    if kind not in ("front", "plate") and mine[:deep].any(axis=0).mean() < SEEN:
        return None
    line = tuple(slice(None) if i == axis else there for i, there in enumerate(box))
    lines = np.moveaxis(owners[line], axis, 0)[::end]
    others = (lines >= 0) & (lines != number)
    if kind != "front":  # only parts on the face cover it; a front's openings hold parts at any depth
        first = box[axis].start if end > 0 else len(lines) - box[axis].stop
        near = np.where(seen, mine.argmax(axis=0), ON).clip(max=ON)
        others &= np.arange(len(lines))[:, None, None] < first + near
    covered = np.asarray(others.any(axis=0))
    if kind in ("side", "back"):  # parts seen past the outline stand beside the board
        covered |= ~np.asarray(binary_fill_holes(seen))
    covered |= (seen.mean(axis=1, keepdims=True) < HALF) | (seen.mean(axis=0, keepdims=True) < HALF)
    evidence = (scores[:deep] / CERTAIN).clip(-1.0, 1.0) / 2 + np.where(mine[:deep], 0.5, -0.5)
    return Face(
        kind=kind,
        number=number,
        cells=cells,
        mine=mine,
        free=(cells < 0) | (beneath[cells] & (cells >= 0) & (kind == "top")),
        weights=np.where(covered, 0.0, weigh_depths(evidence)),
        covered=covered,
    )


def _draw_rectangles(face: Face) -> Int[np.ndarray, "H W"]:
    """Depth of each column: rectangles of other depths on the one with the most evidence."""
    mass = face.weights.sum(axis=(1, 2))
    drawn = np.full(face.covered.shape, mass.argmax())
    for _ in range(ROUNDS):
        for depth in np.argsort(-mass, kind="stable"):
            gain = face.weights[depth] - np.take_along_axis(face.weights, drawn[None], axis=0)[0]
            drawn[find_rectangles(gain, face.least)] = depth
    return drawn


def _lay_board(face: Face) -> None:
    """Redraws a face as one board with strips along its edges, in place, unless too much of it is missing."""
    main = int(face.weights[:-1].sum(axis=(1, 2)).argmax())
    drawn, redrawn = _draw_strips(face, main)
    beyond = len(face.weights) - 1
    filled = redrawn & (face.depths == beyond) & (drawn != beyond)
    if filled.sum() <= FILLED * (~face.covered).sum():
        _put(face, drawn, redrawn)


def _lay_panels(face: Face) -> None:
    """Redraws a face as a board with panels and grips, in place, at the depth with the most evidence."""
    boards = [_draw_panels(face, main) for main in range(len(face.weights) - 1)]
    best = max(boards, key=lambda drawn: np.take_along_axis(face.weights, drawn[None], axis=0).sum())
    _put(face, best, ~face.covered)


def _draw_panels(face: Face, main: int) -> Int[np.ndarray, "H W"]:
    """Depth of each column of a board at depth ``main`` with panels in its middle and small grips."""
    drawn = np.full(face.covered.shape, main)
    for depth, weights in enumerate(face.weights):
        gain = weights - np.take_along_axis(face.weights, drawn[None], axis=0)[0]
        pieces: Int[np.ndarray, "H W"] = np.zeros(gain.shape, dtype=np.int64)
        label(gain > 0, output=pieces)
        areas = np.bincount(pieces.ravel())
        for across, up, _ in find_boxes(gain[..., None], face.least):
            inside, piece = gain[across, up], int(np.median(pieces[across, up]))
            off = abs(across.start + across.stop - len(gain)) / 2
            meant = inside.mean() >= SURE and inside.size >= WHOLE * areas[piece]
            if piece and meant and (off <= CENTRED * len(gain) or inside.size <= SMALL * gain.size):
                drawn[across, up] = depth
    return drawn


def _draw_strips(face: Face, main: int) -> tuple[Int[np.ndarray, "H W"], Bool[np.ndarray, "H W"]]:
    """Depth of each column of a board with strips along its edges, and a mask of the columns to redraw.

    The mask leaves out feet and plinths.
    """
    drawn, redrawn = np.full(face.covered.shape, main), ~face.covered
    rest, gains = np.ones_like(redrawn), face.weights - face.weights[main]
    while True:
        best = max(_find_strips(face.kind, gains, main), key=lambda found: found[0], default=None)
        if best is None or best[0] < face.least:
            return drawn, redrawn
        _, strip, depth = best
        if depth is None:
            redrawn[strip] &= ~rest[strip]
        else:
            drawn[strip] = np.where(rest[strip], depth, drawn[strip])
        rest[strip] = False
        gains = np.where(rest, gains, 0.0)


def _find_strips(
    kind: FaceKind, gains: Float[np.ndarray, "K H W"], main: int
) -> Iterator[tuple[float, tuple[slice, slice], int | None]]:
    """Best strip along each edge for each depth that it may have: gain, place and depth.

    The front strip of a side or top may be wide and have no surface, where these end behind doors. The lowest
    strip of a side or back holds feet or plinths, which stay as they are (depth None). The highest may be
    wide, because worktops stand out. All others are narrow.
    """
    beyond = len(gains) - 1
    upright = kind in ("side", "back")
    for axis, start in ((0, True), (0, False), (1, True), (1, False)):
        count = gains.shape[1 + axis]
        wide = int(WIDE * count)
        foremost = axis == 0 and start and kind in ("top", "side")
        lowest, highest = upright and axis == 1 and start, upright and axis == 1 and not start
        found: list[tuple[int | None, Float[np.ndarray, "H W"], int]] = [
            (depth, gains[depth], wide if highest else NARROW) for depth in range(beyond) if depth != main
        ]
        if lowest:
            found = [(None, gains.max(axis=0), wide)]
        elif foremost:
            found.append((beyond, gains[beyond], wide))
        for depth, gain, most in found:
            line = gain.sum(axis=1 - axis)
            sums = (line if start else line[::-1]).cumsum()[: max(most, 1)]
            width = int(sums.argmax()) + 1
            across = slice(0, width) if start else slice(count - width, count)
            yield float(sums[width - 1]), (across, slice(None)) if axis == 0 else (slice(None), across), depth


def _put(face: Face, drawn: Int[np.ndarray, "H W"], redrawn: Bool[np.ndarray, "H W"]) -> None:
    """Makes the part begin at the drawn depths, in place: clears cells before them, fills missing ones."""
    depths = face.depths
    for depth in np.unique(drawn[redrawn & (drawn != depths)]):
        here = redrawn & (drawn == depth) & (depths != depth)
        near = face.cells[: min(depth, len(face.weights) - 1)]
        near[(near == face.number) & here] = -1
        if depth < len(face.weights) - 1:
            thick = slice(depth, depth + _measure_thickness(face, depths == depth, depth))
            face.cells[thick][face.free[thick] & here] = face.number


def _measure_thickness(face: Face, columns: Bool[np.ndarray, "H W"], depth: int) -> int:
    """Thickness in cells of a part where it begins at a depth: the lower quartile over the columns.

    Columns where boards meet are deep and must not set the thickness.
    """
    if not columns.any():
        return 1
    runs = face.mine[depth : depth + THICKEST, columns].cumprod(axis=0).sum(axis=0)
    return int(np.quantile(runs, 0.25, method="nearest"))
