"""Flattens faces: fills holes and removes steps, stains and frayed edges.

The top, the sides and the back of a cabinet or an appliance are whole boards, and so are the fronts of doors
and drawers, and that of a washing machine around its door. Where others overlap them, at an edge, they lie
deeper or higher in a strip; fronts have panels in their middle, and grips. The front of another body is told
in rectangles: its frame, its rails, and the openings between them. A network draws half of a board a cell
deeper than the rest, and leaves corners out.

Every face is told anew. Of each column of cells, evidence says how deep the part begins there
(`weigh_depths`); the strips and rectangles that most of it speaks for are drawn, all else is the board.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_fill_holes, label

from artigen.voxels.cleanup.boxes import find_boxes
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import DEFAULT_LAYOUT, FieldLayout, name_category, name_rows
from artigen.voxels.regions import find_rectangles, is_round

Kind = Literal["top", "side", "back", "front", "plate", "panel"]


class Side(NamedTuple):
    """Where a face is, and what is told of it."""

    kind: Kind
    """All but ``front`` are boards."""
    axis: int
    """Along which it is looked at."""
    end: int
    """From which end: 1 from the lower one, -1 from the higher one."""


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
"""The sides of parts that have faces, by label."""
PLATED = ("WashingMachine",)
"""Categories whose bodies have a board in front, too."""
OPEN: Mapping[str, tuple[Kind, ...]] = {"Oven": ("top",), "Table": ("side", "back")}
"""Faces that are no boards, by category: burners stand on cooktops, and tables stand on legs."""
CERTAIN = 4.0
"""Logits beyond this count as certain."""
DEPTH = 6
"""Layers of cells that a face is sought in."""
LEAST, SHARE = 12.0, 0.03
"""Evidence of a strip or rectangle, in certain cells, and per cell of the face: at least both."""
ON = 1
"""Layers in which what is not of the part lies on it; deeper, it is seen through a hole."""
HALF = 0.5
"""Share of a line across a face in which the part is seen, at least, for it to reach that far."""
BENEATH = ("drawer", "shelf")
"""What gives way to a top."""
SEEN = 0.6
"""Share of a face in those layers for it to be one."""
SMALLEST: Mapping[Kind, int] = {"front": 4, "panel": 4, "plate": 16, "top": 16, "side": 16, "back": 16}
"""Cells across a face at least: cooktops have no sides to speak of."""
WIDE, NARROW = 0.35, 3
"""Share of a face that a strip takes at most, where doors, plinths or worktops may be; else, in cells."""
FILLED = 0.35
"""Share of a face that is filled at most: what lacks more was meant to be open."""
CENTRED, SMALL = 0.06, 0.05
"""Shares of a face: that a panel is off the middle across it at most, and that a grip has, which may be
anywhere."""
SURE, WHOLE = 1.3, 0.7
"""Evidence per cell of a panel or grip, of which two would be certain; its share of what is at its depth."""
ROUNDS = 2
"""How often the depths of a front take turns."""
THICKEST = 3
"""Cells that are filled behind a face, at most; as many as there are elsewhere."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Face:
    """A face of a part, seen along the first axis."""

    kind: Kind
    number: int
    """The part."""
    cells: Owners
    """A view of the cells of the part's box, the nearest layer first."""
    mine: Bool[np.ndarray, "D H W"]
    """Those of the part."""
    free: Bool[np.ndarray, "D H W"]
    """Those that it may take: nothing is there, or what gives way to it."""
    weights: Float[np.ndarray, "K H W"]
    """What speaks for each depth, and for none (`weigh_depths`)."""
    covered: Bool[np.ndarray, "H W"]
    """What is not told anew: other parts stand there."""

    @property
    def depths(self) -> Int[np.ndarray, "H W"]:
        """How deep the part begins in each column; as many as there are depths where that is no deeper."""
        near = self.mine[: len(self.weights) - 1]
        return np.where(near.any(axis=0), near.argmax(axis=0), len(near))

    @property
    def least(self) -> float:
        """Evidence that a strip or rectangle of it needs."""
        return max(LEAST, SHARE * int((~self.covered).sum()))


def even_faces(
    owners: Owners,
    logits: Float[np.ndarray, "X Y Z"],
    rows: Float[np.ndarray, "N C"],
    layout: FieldLayout = DEFAULT_LAYOUT,
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which faces are even, and a note of how many cells changed.

    Args:
        owners: a row per cell, -1 where nothing is.
        logits: of occupancy, of all cells.
        rows: an outline, the channels after occupancy, one row per part.
        layout: channels.
    """
    before, owners = owners, owners.copy()
    category, names = name_category(rows, layout) or "", name_rows(rows, layout)
    beneath = np.isin(names, BENEATH)
    for number, name in enumerate(names):
        for side in SIDES.get(name, ()):
            if side.kind in OPEN.get(category, ()):
                continue
            if side.kind == "front" and category in PLATED:
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
    changed = int((owners != before).sum())
    if not changed:
        return before, ()
    return owners, (f"{changed} cells of holes, stairs and frayed edges of faces were made even",)


def weigh_depths(evidence: Float[np.ndarray, "D H W"]) -> Float[np.ndarray, "K H W"]:
    """Log-evidence per candidate depth of a column; the last entry means "no surface".

    Nothing is before the first cell, whatever comes behind it: cells there speak for no depth.

    Args:
        evidence: From -1, certainly empty, to 1, certainly not.
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
    """A face of a part in its box; None where it is round, or too small or too open for one."""
    at = np.argwhere(owners == number)
    if not len(at):
        return None
    kind, axis, end = side
    box = tuple(slice(low, high) for low, high in zip(at.min(axis=0), at.max(axis=0) + 1, strict=True))
    cells, said = (np.moveaxis(grid[box], axis, 0)[::end] for grid in (owners, logits))
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
    if kind != "front":  # openings hold other parts, holes show them
        first = box[axis].start if end > 0 else len(lines) - box[axis].stop
        near = np.where(seen, mine.argmax(axis=0), ON).clip(max=ON)
        others &= np.arange(len(lines))[:, None, None] < first + near
    covered = np.asarray(others.any(axis=0))
    if kind in ("side", "back"):  # what one sees past stands beside the board
        covered |= ~np.asarray(binary_fill_holes(seen))
    covered |= (seen.mean(axis=1, keepdims=True) < HALF) | (seen.mean(axis=0, keepdims=True) < HALF)
    evidence = (said[:deep] / CERTAIN).clip(-1.0, 1.0) / 2 + np.where(mine[:deep], 0.5, -0.5)
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
    """Depths in rectangles on that which most speaks for."""
    mass = face.weights.sum(axis=(1, 2))
    drawn = np.full(face.covered.shape, mass.argmax())
    for _ in range(ROUNDS):
        for depth in np.argsort(-mass, kind="stable"):
            gain = face.weights[depth] - np.take_along_axis(face.weights, drawn[None], axis=0)[0]
            drawn[find_rectangles(gain, face.least)] = depth
    return drawn


def _lay_board(face: Face) -> None:
    """Makes a face one board with strips or panels on it, in place, unless it lacks too much."""
    main = int(face.weights[:-1].sum(axis=(1, 2)).argmax())
    drawn, told = _draw_strips(face, main)
    beyond = len(face.weights) - 1
    filled = told & (face.depths == beyond) & (drawn != beyond)
    if filled.sum() <= FILLED * (~face.covered).sum():
        _put(face, drawn, told)


def _lay_panels(face: Face) -> None:
    """Makes a face a board with panels and grips, in place: that which most speaks for, of all depths."""
    boards = [_draw_panels(face, main) for main in range(len(face.weights) - 1)]
    best = max(boards, key=lambda drawn: np.take_along_axis(face.weights, drawn[None], axis=0).sum())
    _put(face, best, ~face.covered)


def _draw_panels(face: Face, main: int) -> Int[np.ndarray, "H W"]:
    """Depths of a board with panels in its middle, and with grips, which are small."""
    drawn = np.full(face.covered.shape, main)
    for depth, weights in enumerate(face.weights):
        gain = weights - np.take_along_axis(face.weights, drawn[None], axis=0)[0]
        pieces: Int[np.ndarray, "H W"] = np.zeros(gain.shape, dtype=np.int64)
        label(gain > 0, output=pieces)
        areas = np.bincount(pieces.ravel())
        for across, up, _ in find_boxes(gain[..., None], face.least):
            told, piece = gain[across, up], int(np.median(pieces[across, up]))
            off = abs(across.start + across.stop - len(gain)) / 2
            meant = told.mean() >= SURE and told.size >= WHOLE * areas[piece]
            if piece and meant and (off <= CENTRED * len(gain) or told.size <= SMALL * gain.size):
                drawn[across, up] = depth
    return drawn


def _draw_strips(face: Face, main: int) -> tuple[Int[np.ndarray, "H W"], Bool[np.ndarray, "H W"]]:
    """Depths of a board with strips along its edges, and which are told: feet and plinths are not."""
    drawn, told = np.full(face.covered.shape, main), ~face.covered
    rest, gains = np.ones_like(told), face.weights - face.weights[main]
    while True:
        best = max(_find_strips(face.kind, gains, main), key=lambda found: found[0], default=None)
        if best is None or best[0] < face.least:
            return drawn, told
        _, strip, depth = best
        if depth is None:
            told[strip] &= ~rest[strip]
        else:
            drawn[strip] = np.where(rest[strip], depth, drawn[strip])
        rest[strip] = False
        gains = np.where(rest, gains, 0.0)


def _find_strips(
    kind: Kind, gains: Float[np.ndarray, "K H W"], main: int
) -> Iterator[tuple[float, tuple[slice, slice], int | None]]:
    """The best strip along each edge at each depth that it may have: its gain, its place and its depth.

    Sides end at their front, behind doors, and tops do; below lie feet and plinths, which stay as they are
    (None for a depth); above, worktops stand out. Elsewhere strips are narrow.
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


def _put(face: Face, drawn: Int[np.ndarray, "H W"], told: Bool[np.ndarray, "H W"]) -> None:
    """Makes the part begin where it is drawn, in place: what stands before goes, what lacks is filled."""
    depths = face.depths
    for depth in np.unique(drawn[told & (drawn != depths)]):
        here = told & (drawn == depth) & (depths != depth)
        near = face.cells[: min(depth, len(face.weights) - 1)]
        near[(near == face.number) & here] = -1
        if depth < len(face.weights) - 1:
            thick = slice(depth, depth + _measure_thickness(face, depths == depth, depth))
            face.cells[thick][face.free[thick] & here] = face.number


def _measure_thickness(face: Face, columns: Bool[np.ndarray, "H W"], depth: int) -> int:
    """How many cells lie behind each other where a part begins at a depth: fewer than in most columns, for
    where boards meet they are deep."""
    if not columns.any():
        return 1
    runs = face.mine[depth : depth + THICKEST, columns].cumprod(axis=0).sum(axis=0)
    return int(np.quantile(runs, 0.25, method="nearest"))
