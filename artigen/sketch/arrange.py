"""`arrange_fronts`: doors and drawers in the places that words give them, as if they had been read there.

A front is divided like a page: a band of what is at the top, columns of what is at the left, in the middle
and at the right, and a band of what is at the bottom. What has no place takes the rest.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from artigen.conditioning.sentence import Placing
from artigen.conditioning.vocabulary import Feature, Spot
from artigen.reader.reading import Reading, ReadPart

ROW = 0.18
"""Height (m) of a row of drawers above or below doors."""
MOST_ROWS = 0.5
"""Share of the height that rows of drawers take at most where there are doors."""
NARROWEST = 0.3
"""Width (m) from which drawers lie beside each other above or below doors."""
SHAPELY = 2.5
"""Width over height of a drawer if nothing is said of its rows and columns."""
MOST_DOORS = 4
"""Doors that always stand beside each other; more of them, as of lockers, lie above each other, too."""
NARROW_DOOR = 0.3
"""Width (m) of such doors."""
MOST_ABOVE, TALL = 3, 1.3
"""Drawers that lie above doors if nothing is said of their place, and the height (m) of objects from which
they lie below them."""
MARGIN = 0.1
"""Most of the width, on either side, that no front takes."""
WORKTOP, PLINTH = 0.06, 0.12
"""Most of the height that no front takes at the top, and at the bottom of what stands on no legs."""
SHELF = 0.12
"""Least distance (m) of shelves."""
ALONE = 0.42
"""Share of the height that doors above or below an open compartment take."""
PEDESTAL = 0.3
"""Share of the width that fronts at one side take where nothing is beside them, as at a desk."""
GAP = 0.003
"""Distance (m) of fronts."""
Box = tuple[float, float, float, float]


@dataclass(frozen=True, kw_only=True)
class Block:
    """Equal fronts, or an open cell, in rows and columns."""

    label: str
    count: int
    grid: tuple[int, int] | None = None
    """Rows and columns; None for those that make them shapely."""
    pane: bool | None = None
    """Whether they are glazed; None where nothing is said."""


def arrange_fronts(
    reading: Reading, places: Sequence[Placing], features: Sequence[Feature], *, lowest: float = 0.0
) -> Reading:
    """The reading with its fronts where they are said to be; their numbers stay.

    Args:
        reading: What is seen from straight ahead.
        places: Where fronts, or an open shelf, are.
        features: Rows and columns of labels; everything else is passed over.
        lowest: Share of the height that the fronts reach down to at least.
    """
    fronts = reading.fronts
    scale = (reading.size[0], reading.size[2])
    left, top, right, bottom = find_area(reading, lowest=lowest)
    area = (left * scale[0], top * scale[1], right * scale[0], bottom * scale[1])
    blocks = _sort_blocks(reading, places, features)
    boxes = _divide(area, blocks)
    held: list[ReadPart] = []
    for label in ("door", "drawer"):
        own = [front for front in fronts if front.label == label]
        wanted = [(block.pane, box) for block, box in boxes if block.label == label]
        held += [
            replace(
                front, box=np.array(box) / np.tile(scale, 2), hinge=None,
                pane=front.pane if pane is None else pane,
            )
            for front, (pane, box) in zip(own, wanted, strict=True)
        ]  # fmt: skip
    held.sort(key=lambda front: (round(float(front.box[1]), 2), float(front.box[0])))
    others = [part for part in reading.parts if part.label not in ("door", "drawer", "handle")]
    handles = [part for part in reading.parts if part.label == "handle"]
    grips = [_put_on(handles[0], front) for front in held] if handles else []
    return replace(reading, parts=(*held, *grips, *others))


def add_shelves(reading: Reading, count: int) -> Reading:
    """The reading with shelves at equal distances in the highest gap between its fronts, if there is room."""
    edges = sorted((float(front.box[1]), float(front.box[3])) for front in reading.fronts)
    gaps, end = [], WORKTOP
    for top, bottom in [*edges, (1.0 - PLINTH, 1.0)]:
        gaps.append((top - end, end, top))
        end = max(end, bottom)
    high, top, _ = max(gaps)
    if high * reading.size[2] < SHELF * (count + 1):
        return reading
    middles = top + high * (np.arange(count) + 1) / (count + 1)
    shelves = [
        ReadPart(label="shelf", score=1.0, box=np.array([0.1, y - 0.005, 0.9, y + 0.005])) for y in middles
    ]
    return replace(reading, parts=(*reading.parts, *shelves))


def find_area(reading: Reading, *, lowest: float = 0.0) -> Box:
    """What fronts may take, as shares of the object's width and height: as far on either side as the fronts
    that there are on one."""
    boxes = np.array([front.box for front in reading.fronts]).reshape(-1, 4)
    left, top, right, bottom = (*boxes[:, :2].min(axis=0), *boxes[:, 2:].max(axis=0))
    side = float(np.clip(min(left, 1.0 - right), 0.0, MARGIN))
    least = lowest if reading.stand != "flat" else max(lowest, 1.0 - PLINTH)
    return side, min(float(top), WORKTOP), 1.0 - side, max(float(bottom), least)


def _sort_blocks(
    reading: Reading, places: Sequence[Placing], features: Sequence[Feature]
) -> Mapping[Spot, list[Block]]:
    """What is at each place; what has none is in the middle."""
    left = {label: sum(front.label == label for front in reading.fronts) for label in ("drawer", "door")}
    grids = {(part, what): int(value) for part, what, value in features if what in ("rows", "columns")}
    found: dict[Spot, list[Block]] = {}
    divided = any(place.pane for place in places)
    for place in sorted(places, key=lambda place: place.count is None):
        if place.label == "shelf":
            found.setdefault(place.at, []).append(Block(label="shelf", count=1))
        if left.get(place.label, 0) == 0:
            continue
        count = min(left[place.label], place.count or left[place.label])
        left[place.label] -= count
        block = _make_block(place.label, count, grids)
        found.setdefault(place.at, []).append(replace(block, pane=place.pane if divided else None))
    spare = {label: _make_block(label, count, grids) for label, count in left.items() if count}
    spare = {label: replace(block, pane=False if divided else None) for label, block in spare.items()}
    if not found and len(spare) == 2:  # few drawers lie above doors, in tall objects below, many beside them
        many = left["drawer"] > MOST_ABOVE
        low = reading.size[2] > TALL
        found["bottom" if low else "left" if many else "top"] = [spare.pop("drawer")]
        found["right" if many and not low else "middle"] = [spare.pop("door")]
    if spare:
        between = set(found) == {"middle"} and all(block.label == "shelf" for block in found["middle"])
        pairs = all(block.count % 2 == 0 for block in spare.values())
        found.setdefault("sides" if between and pairs else "middle", []).extend(spare.values())
    return found


def _make_block(label: str, count: int, grids: Mapping[tuple[str, str], int]) -> Block:
    columns, rows = grids.get((label, "columns")), grids.get((label, "rows"))
    if columns is None and rows is None:
        return Block(label=label, count=count)
    columns = columns or -(-count // (rows or 1))
    return Block(label=label, count=count, grid=(-(-count // columns), columns))


def _divide(area: Box, blocks: Mapping[Spot, list[Block]]) -> list[tuple[Block, Box]]:
    """Blocks of the fronts, and boxes (m, y down) of each."""
    left, top, right, bottom = area
    width, height = right - left, bottom - top
    above, below = blocks.get("top", []), blocks.get("bottom", [])
    aside = bool(blocks.get("left") or blocks.get("right"))
    columns = [
        blocks.get(at, [])
        for at in ("left", "middle", "right")
        if blocks.get(at) or (at != "middle" and aside and not blocks.get("middle"))
    ]
    if blocks.get("sides"):
        halves = [_halve(block) for block in blocks["sides"]]
        left_ones, right_ones = ([half for half in side if half.count] for side in zip(*halves, strict=True))
        columns = [left_ones, blocks.get("middle", []), right_ones]
    everything = [*above, *below, *(block for column in columns for block in column)]
    rest = any(columns)
    doors = sum(block.count for block in everything if block.label == "door")
    stacked = bool(above) and not doors  # drawers below drawers are the large ones
    above = [_shape_drawers(block, width / len(above), doors) for block in above]
    below = [_shape_drawers(block, width / len(below), doors, stacked=stacked) for block in below]
    heights = [_measure_band(band) for band in (above, below)]
    if not rest and not (above and below):  # what is said leaves an open compartment
        heights = [ALONE * height if high is None else min(high, MOST_ROWS * height) for high in heights]
    free = sum(high is None for high in heights) + rest
    taken = sum(high or 0.0 for high in heights)
    most = MOST_ROWS * height if free else height
    share = 1.0 if taken == 0.0 else most / taken if taken > most or (above and below and not free) else 1.0
    spare = (height - taken * share) / max(free, 1)
    found: list[tuple[Block, Box]] = []
    at = top
    if above:
        end = at + (spare if heights[0] is None else heights[0] * share)
        found += _divide_row((left, at, right, end), above)
        at = end
    if rest:
        found += _divide_columns((left, at, right, at + spare), columns)
    if below:
        high = spare if heights[1] is None else heights[1] * share
        found += _divide_row((left, bottom - high, right, bottom), below)
    return found


def _shape_drawers(block: Block, width: float, doors: int, *, stacked: bool = False) -> Block:
    """A block of drawers above or below others with its rows and columns; other blocks as they are.

    Args:
        block: What is in a band.
        width: Its width (m).
        doors: Number of doors of the object: drawers stand in line with them.
        stacked: Whether the drawers lie above each other if nothing else is said.
    """
    if block.label != "drawer" or block.grid is not None:
        return block
    if doors and block.count % doors == 0 and width / doors >= NARROWEST:
        return replace(block, grid=(block.count // doors, doors))
    beside = not stacked and width / block.count >= NARROWEST
    return replace(block, grid=(1, block.count) if beside else (block.count, 1))


def _measure_band(band: Sequence[Block]) -> float | None:
    """Height (m) of a band, 0 for none; None for one with other blocks than drawers, which takes the rest."""
    if any(block.label != "drawer" for block in band):
        return None
    return max((ROW * block.grid[0] for block in band if block.grid is not None), default=0.0)


def _grid(block: Block, width: float, height: float) -> tuple[int, int]:
    """Rows and columns of a block in a width and a height (m)."""
    if block.grid is not None:
        return block.grid
    if block.label == "door":
        fit = max(1, min(block.count, int(width / NARROW_DOOR)))
        columns = block.count if block.count <= MOST_DOORS else fit
        return -(-block.count // columns), columns
    even = [columns for columns in range(1, block.count + 1) if block.count % columns == 0]
    grids = [(block.count // columns, columns) for columns in even]
    return min(grids, key=lambda grid: abs(np.log(width / grid[1] / (height / grid[0]) / SHAPELY)))


def _divide_row(area: Box, band: Sequence[Block]) -> list[tuple[Block, Box]]:
    """Blocks beside each other, each as wide as the others."""
    left, top, right, bottom = area
    wide = (right - left) / len(band)
    found: list[tuple[Block, Box]] = []
    for index, block in enumerate(band):
        found += _fill((left + index * wide, top, left + (index + 1) * wide, bottom), block)
    return found


def _divide_columns(area: Box, columns: Sequence[Sequence[Block]]) -> list[tuple[Block, Box]]:
    """Columns, by the number of doors in each; an empty one is open."""
    left, top, right, bottom = area
    if not all(columns) and len(columns) == 2:
        weights = [PEDESTAL if column else 1.0 - PEDESTAL for column in columns]
    elif not all(columns):
        weights = [PEDESTAL if column else 1.0 - PEDESTAL * sum(map(bool, columns)) for column in columns]
    else:
        weights = [
            max((block.count if block.label == "door" else 1) for block in column) for column in columns
        ]
    ends = left + (right - left) * np.concatenate([[0.0], np.cumsum(weights) / np.sum(weights)])
    found: list[tuple[Block, Box]] = []
    for column, start, end in zip(columns, ends[:-1], ends[1:], strict=True):
        high = (bottom - top) / max(len(column), 1)
        for index, block in enumerate(column):
            found += _fill((float(start), top + index * high, float(end), top + (index + 1) * high), block)
    return found


def _fill(area: Box, block: Block) -> list[tuple[Block, Box]]:
    """The fronts of a block, from the upper left."""
    left, top, right, bottom = area
    rows, columns = _grid(block, right - left, bottom - top)
    wide, high = (right - left) / columns, (bottom - top) / rows
    cells = [(row, column) for row in range(rows) for column in range(columns)][: block.count]
    half = GAP / 2
    return [
        (
            block,
            (
                left + column * wide + half,
                top + row * high + half,
                left + (column + 1) * wide - half,
                top + (row + 1) * high - half,
            ),
        )
        for row, column in cells
    ]


def _halve(block: Block) -> tuple[Block, Block]:
    first = -(-block.count // 2)
    return replace(block, count=first), replace(block, count=block.count - first)


def _put_on(handle: ReadPart, front: ReadPart) -> ReadPart:
    """A handle in the middle of a front."""
    middle, half = (front.box[:2] + front.box[2:]) / 2, (handle.box[2:] - handle.box[:2]) / 2
    half = np.minimum(half, 0.4 * (front.box[2:] - front.box[:2]))
    return replace(handle, box=np.concatenate([middle - half, middle + half]))
