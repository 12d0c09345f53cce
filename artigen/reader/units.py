"""`read_units`: the units along one wall of a kitchen, from a photograph that shows several of them.

Objects that touch have no peaks of their own, but fronts have: those of one wall are on one plane, and what
stands above each other there is a column. Kitchens are built to few heights, and these tell the scale, the
floor, and what each column is."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import torch
from jaxtyping import Float

from artigen.conditioning.image import open_picture
from artigen.errors import SourceError
from artigen.kind import Place, Size, kinds
from artigen.models.precision import native_autocast
from artigen.reader.labels import KINDS
from artigen.reader.layout.plane import Plane, fit_plane, frame_box
from artigen.reader.looks import look_closer
from artigen.reader.model import Reader, load_reader
from artigen.reader.read import KIND_EDGE, read_all
from artigen.reader.reading import Reading, ReadPart
from artigen.weights import READER

if TYPE_CHECKING:
    from PIL import Image

FOCAL = 0.8
"""Focal length of a photograph of a room over its longer edge: that of a phone's main camera."""
TURN = 1.0
"""Growth of a front's height, per width of the picture, from which it is on a wall at an angle to the
picture: about 40 degrees."""
SLANT = 0.25
"""Slope of edges on the plane of the wall, from which a front is on another one."""
CHAINED = 0.35
"""Gap between fronts of one column, as a share of the lower of the two."""
TOUCHED = 0.1
"""Overlap in height at a cut, as a share of the lower front."""
OVER = 0.5
"""Share of the narrower front that is above or below the other one in a column."""
JOINED = 0.12
"""Gap (m) between columns of one unit."""
FREE = 0.15
"""Gap (m) between units from which the wall between them is left free."""
WIDEST = 1.2
"""Width (m) up to which columns are one unit."""
UNEVEN = 0.12
"""Difference in height (m) of the ends of columns up to which they hang as one unit."""
TOE, TOP, HANGS = 0.1, 0.04, 1.45
"""Heights (m) of the lowest fronts above the floor, of what is above the uppermost ones of an object, and of
the undersides of wall cabinets above the floor."""
LOOSE = {
    "base cabinet": 0.08,
    "larder": 0.2,
    "fridge": 0.15,
    "range": 0.08,
    "dishwasher": 0.08,
    "washing machine": 0.08,
}
"""Standard deviation (m) of the heights of fronts' upper edges, by what stands there."""
HUNG = "wall cabinet"
HUNG_LOOSE = (0.12, 0.25)
"""The same of the lower and of the upper edges of what hangs."""
LIFTED = 0.1
"""The same of the lower edges of what stands."""
KIND_WEIGHT, LEAST_SHARE, STRANGE = 2.0, 0.02, 12.0
"""Weight of the kinds that are read against heights, least probability of a kind, and cost from which a
column is none of these."""
WOODEN = 3.0
"""Cost of an appliance of wood."""
SCALES = np.geomspace(0.4, 4.0, 70)
"""Heights (m) of all fronts together that are tried."""
FLOORS = np.linspace(0.0, 0.35, 8)
"""Heights (m) above the floor of the lowest front that are tried."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Unit:
    """One object along a wall."""

    role: str
    """What it is there for, as in the records of kinds."""
    reading: Reading
    start: float
    """Distance (m) of its left end from that of the first unit, as seen."""
    size: Size
    """Depth, width and height (m)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Wall:
    """What stands and hangs along a wall, each from left to right, and what was left out."""

    standing: tuple[Unit, ...]
    hung: tuple[Unit, ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Column:
    """Fronts above each other, on the plane of the wall."""

    parts: tuple[ReadPart, ...]
    bounds: Float[np.ndarray, "4"]
    """Left, top, right and bottom, y down."""
    shares: dict[str, float]
    """Probabilities of the kinds."""


@dataclass(frozen=True, kw_only=True)
class Metre:
    """Lengths of the plane in metres."""

    across: float
    along: float
    """Metres per unit of x and of y."""
    floor: float
    """y of the floor."""

    def height(self, y: float) -> float:
        """Height (m) above the floor."""
        return (self.floor - y) * self.along


def read_units(photo: Path, folder: Path = READER) -> Wall:
    """Reads the wall of a photograph that has the largest fronts.

    Args:
        photo: Any picture that `artigen.conditioning.image.open_picture` opens, of a wall from before it.
        folder: Folder of the reader's weights.

    Raises:
        SourceError: If the picture cannot be opened, or shows no unit that stands on a floor.
    """
    image = open_picture(photo)
    return find_units(image, load_reader(folder), str(photo))


def find_units(image: "Image.Image", reader: Reader, name: str) -> Wall:
    """As `read_units`, of an opened picture; ``name`` is for messages."""
    whole = read_all(image, reader)
    extent = np.array(image.size, dtype=np.float64)
    fronts, elsewhere = choose_wall(whole.fronts, extent)
    notes = [f"{elsewhere} fronts on another wall: left out"] if elsewhere else []
    if not fronts:
        raise SourceError(
            f"{name}: shows no front of a wall; show the fronts of a kitchen's wall from before it"
        )
    plane = fit_plane(list_corners(fronts) * extent, extent)
    stacks = _make_stacks(fronts, plane, image, reader)
    metre, columns, roles = find_roles(stacks, find_aspect(plane, extent))
    strange = sum(role is None for role in roles)
    notes += [f"{strange} columns of fronts that are like no unit of a kitchen: left out"] if strange else []
    units = _group(columns, roles, metre)
    heights = {
        role: _find_height(role, columns, roles, metre) for role in roles if role is not None and role != HUNG
    }
    made = [
        _make_unit(role, held, plane, metre, whole, image, height=heights.get(role)) for role, held in units
    ]
    standing = tuple(unit for unit in made if unit.role != HUNG)
    if not standing:
        raise SourceError(
            f"{name}: no unit that stands on the floor was found; show the wall down to the floor"
        )
    first = min(unit.start for unit in made)
    standing, hung = (
        tuple(replace(unit, start=unit.start - first) for unit in made if (unit.role == HUNG) == hangs)
        for hangs in (False, True)
    )
    return Wall(standing=standing, hung=hung, notes=tuple(notes))


def list_corners(fronts: Sequence[ReadPart]) -> Float[np.ndarray, "N 4 2"]:
    return np.stack([frame_box(part.box) if part.corners is None else part.corners for part in fronts])


def choose_wall(
    fronts: Sequence[ReadPart], extent: Float[np.ndarray, "2"]
) -> tuple[tuple[ReadPart, ...], int]:
    """The fronts on the wall with most of them by area, and the number of others."""
    if not fronts:
        return (), 0
    quads = list_corners(fronts) * extent
    left, right = (np.linalg.norm(quads[:, a] - quads[:, b], axis=1) for a, b in ((3, 0), (2, 1)))
    across = (quads[:, 1:3, 0].mean(axis=1) - quads[:, [0, 3], 0].mean(axis=1)) / extent[0]
    turn = np.log(np.maximum(right, 1.0) / np.maximum(left, 1.0)) / np.maximum(across, 0.05)
    sides = np.digitize(turn, (-TURN, TURN))
    areas = np.prod(np.ptp(quads, axis=1), axis=1)
    chosen = int(np.argmax([areas[sides == side].sum() for side in range(3)]))
    own = np.flatnonzero(sides == chosen)
    placed = fit_plane(quads[own], extent).locate(quads[own] / extent)
    drop = (placed[:, 1, 1] - placed[:, 0, 1] + placed[:, 2, 1] - placed[:, 3, 1]) / 2
    straight = np.abs(drop) <= SLANT * np.ptp(placed[:, :, 0], axis=1)
    kept = tuple(fronts[index] for index in own[straight])
    return kept, len(fronts) - len(kept)


def find_aspect(plane: Plane, extent: Float[np.ndarray, "2"]) -> float:
    """Length of a unit of x over that of a unit of y on a plane, by the focal length."""
    focal = FOCAL * extent.max()
    columns = np.diag([*extent, 1.0]) @ np.linalg.inv(plane.matrix)
    rays = np.array(
        [[1 / focal, 0, -extent[0] / 2 / focal], [0, 1 / focal, -extent[1] / 2 / focal], [0, 0, 1]]
    )
    across, along = np.linalg.norm(rays @ columns[:, :2], axis=0)
    return float(across / along)


def _make_stacks(
    fronts: Sequence[ReadPart], plane: Plane, image: "Image.Image", reader: Reader
) -> list[list[list[Column]]]:
    """Fronts above each other: for each stack of them, ways to cut it into columns."""
    bounds = plane.bound(list_corners(fronts))
    groups: list[list[int]] = []

    def chain(one: int, other: int) -> bool:
        a, b = bounds[one], bounds[other]
        shared = min(a[2], b[2]) - max(a[0], b[0])
        gap = max(a[1], b[1]) - min(a[3], b[3])
        return shared > OVER * min(a[2] - a[0], b[2] - b[0]) and gap < CHAINED * min(a[3] - a[1], b[3] - b[1])

    for index in range(len(fronts)):
        above = [group for group in groups if any(chain(index, other) for other in group)]
        groups = [group for group in groups if not any(group is one for one in above)]
        groups.append([index, *(other for group in above for other in group)])
    stacks = []
    for group in groups:
        ways = [[group], *_cut(group, bounds)]
        stacks.append([[_make_column(own, fronts, bounds, image, reader) for own in way] for way in ways])
    return stacks


def _cut(group: Sequence[int], bounds: Float[np.ndarray, "N 4"]) -> list[list[list[int]]]:
    """Fronts above each other in two, at each height where none goes on."""
    ends = sorted({float(bounds[index, 3]) for index in group})[:-1]
    ways = []
    for end in ends:
        upper = [index for index in group if bounds[index, 3] <= end]
        lower = [index for index in group if bounds[index, 3] > end]
        middles = (bounds[lower, 1] + bounds[lower, 3]) / 2
        if (bounds[lower, 1] > end - TOUCHED * (bounds[lower, 3] - bounds[lower, 1])).all() and (
            middles > end
        ).all():
            ways.append([upper, lower])
    return ways


def _make_column(
    group: Sequence[int],
    fronts: Sequence[ReadPart],
    bounds: Float[np.ndarray, "N 4"],
    image: "Image.Image",
    reader: Reader,
) -> Column:
    parts, held = tuple(fronts[index] for index in group), bounds[list(group)]
    boxes = np.stack([part.box for part in parts])
    return Column(
        parts=parts,
        bounds=np.concatenate([held[:, :2].min(axis=0), held[:, 2:].max(axis=0)]),
        shares=_name_kinds(
            image, np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)]), reader
        ),
    )


@torch.no_grad()
def _name_kinds(image: "Image.Image", box: Float[np.ndarray, "4"], reader: Reader) -> dict[str, float]:
    """Probabilities of the kinds of what is in a box."""
    extent = np.array(image.size)
    middle, side = (box[:2] + box[2:]) / 2 * extent, 1.2 * float(((box[2:] - box[:2]) * extent).max())
    low, high = np.round(middle - side / 2).astype(int), np.round(middle + side / 2).astype(int)
    crop = image.crop((*low.tolist(), *high.tolist())).resize((KIND_EDGE, KIND_EDGE))
    white = np.asarray(crop, dtype=np.uint8)
    alpha = white[..., 3:] / 255.0
    pixels = torch.from_numpy(np.round(alpha * white[..., :3] + 255 * (1 - alpha)).astype(np.uint8))
    with native_autocast(pixels.device):
        shares = reader.kinds(pixels.permute(2, 0, 1)[None]).float()[0, : len(KINDS)].softmax(dim=0)
    return dict(zip(KINDS, shares.tolist(), strict=True))


def find_place(role: str) -> tuple[str, Place]:
    """The first kind that fills a role, and its sizes there."""
    return next((name, place) for name in KINDS for place in kinds()[name].places if place.role == role)


def _usual_height(role: str) -> float:
    _, place = find_place(role)
    return place.draws[0][2] if place.draws else (place.low[2] + place.high[2]) / 2


def find_roles(
    stacks: Sequence[Sequence[Sequence[Column]]], aspect: float
) -> tuple[Metre, list[Column], list[str | None]]:
    """The scale at which all columns have the heights of a kitchen, the columns from left to right, and what
    each of them is."""
    bounds = np.stack([column.bounds for stack in stacks for column in stack[0]])
    whole = float(bounds[:, 3].max() - bounds[:, 1].min())
    roles = (*LOOSE, HUNG)
    said = {
        id(column): np.array([_cost_kind(column, role) for role in roles])
        for stack in stacks
        for way in stack
        for column in way
    }
    best: tuple[float, Metre, list[tuple[Column, Float[np.ndarray, "R"]]]] | None = None
    for scale in SCALES:
        for lift in FLOORS:
            along = scale / whole
            metre = Metre(across=along * aspect, along=along, floor=float(bounds[:, 3].max() + lift / along))
            total, chosen = 0.0, []
            for stack in stacks:
                rated = []
                for way in stack:
                    held = [
                        (one, said[id(one)] + np.array([_cost_height(one, role, metre) for role in roles]))
                        for one in way
                    ]
                    rated.append((sum(_weigh(one) * min(STRANGE, row.min()) for one, row in held), held))
                cost, held = min(rated, key=lambda one: one[0])
                total, chosen = total + cost, [*chosen, *held]
            if best is None or total < best[0]:
                best = total, metre, chosen
    assert best is not None
    _, metre, chosen = best
    chosen = sorted(chosen, key=lambda one: float(one[0].bounds[0]))
    return (
        metre,
        [column for column, _ in chosen],
        [roles[int(row.argmin())] if row.min() < STRANGE else None for _, row in chosen],
    )


def _weigh(column: Column) -> float:
    """Area of a column."""
    return float((column.bounds[2:] - column.bounds[:2]).prod())


def _find_height(role: str, columns: Sequence[Column], roles: Sequence[str | None], metre: Metre) -> float:
    """Height (m) of all objects of a role: that of a worktop is one along a wall."""
    own = [column.bounds for column, other in zip(columns, roles, strict=True) if other == role]
    return float(np.median([metre.height(float(bounds[1])) for bounds in own])) + TOP


def _cost_kind(column: Column, role: str) -> float:
    """Cost of what a column looks like: appliances by their kind, furniture by that of none of these."""
    appliances = {find_place(name)[0] for name in LOOSE} - {find_place("base cabinet")[0]}
    own = find_place(role)[0]
    share = column.shares[own] if own in appliances else 1.0 - sum(column.shares[name] for name in appliances)
    wooden = np.mean([part.material == "wood" for part in column.parts]) > 0.5
    return WOODEN * (own in appliances and wooden) - KIND_WEIGHT * float(np.log(max(share, LEAST_SHARE)))


def _cost_height(column: Column, role: str, metre: Metre) -> float:
    """Squared differences from usual heights, in standard deviations."""
    low, high = metre.height(float(column.bounds[3])), metre.height(float(column.bounds[1]))
    if role == HUNG:
        top = HANGS + _usual_height(role)
        return ((low - HANGS) / HUNG_LOOSE[0]) ** 2 + ((high - top) / HUNG_LOOSE[1]) ** 2
    return ((low - TOE) / LIFTED) ** 2 + ((high - _usual_height(role) + TOP) / LOOSE[role]) ** 2


def _group(
    columns: Sequence[Column], roles: Sequence[str | None], metre: Metre
) -> list[tuple[str, list[Column]]]:
    """Neighbouring columns of cabinets as units; appliances each by itself."""
    out: list[tuple[str, list[Column]]] = []
    for role in dict.fromkeys(role for role in roles if role is not None):
        furniture = find_place(role)[0] == find_place(HUNG)[0]
        run: list[Column] = []
        for column in (column for column, own in zip(columns, roles, strict=True) if own == role):
            start = float((run or [column])[0].bounds[0])
            end = max((float(one.bounds[2]) for one in run), default=start)
            near = (float(column.bounds[0]) - end) * metre.across < JOINED
            narrow = (float(column.bounds[2]) - start) * metre.across <= WIDEST
            level = role != HUNG or _is_level(run, column, metre)
            if run and not (furniture and near and narrow and level):
                out.append((role, run))
                run = []
            run = [*run, column]
        out.append((role, run))
    return sorted(out, key=lambda unit: float(unit[1][0].bounds[0]))


def _is_level(run: Sequence[Column], column: Column, metre: Metre) -> bool:
    """Whether a column begins and ends at the heights of others."""
    return all(
        float(np.abs(one.bounds[[1, 3]] - column.bounds[[1, 3]]).max()) * metre.along < UNEVEN for one in run
    )


def _make_unit(
    role: str,
    columns: Sequence[Column],
    plane: Plane,
    metre: Metre,
    whole: Reading,
    image: "Image.Image",
    *,
    height: float | None,
) -> Unit:
    """A unit with its own reading; ``height`` (m) is that of what stands on the floor, None of what hangs."""
    kind, place = find_place(role)
    bounds = np.stack([column.bounds for column in columns])
    x0, x1 = float(bounds[:, 0].min()), float(bounds[:, 2].max())
    low, high = (metre.height(float(y)) for y in (bounds[:, 3].max(), bounds[:, 1].min()))
    depth = place.draws[0][0] if place.draws else (place.low[0] + place.high[0]) / 2
    above, below = (0.0, 0.0) if height is None else (TOP / metre.along, TOE / metre.along)
    size = np.clip(
        (depth, (x1 - x0) * metre.across, high - low if height is None else height),
        np.add(place.low, 0.02),
        np.subtract(place.high, 0.02),
    )
    face = np.array([x0, bounds[:, 1].min() - above, x1, bounds[:, 3].max() + below])
    ends = plane.show(frame_box(face))
    box = np.clip(np.concatenate([ends.min(axis=0), ends.max(axis=0)]), 0.0, 1.0)
    fronts = [part for column in columns for part in column.parts]
    others = [
        part
        for part in whole.parts
        if part.label in ("handle", "knob") and _holds(box, (part.box[:2] + part.box[2:]) / 2)
    ]
    depth, width, height = (float(length) for length in size)
    reading = replace(
        whole, kind=kind, kinds=((kind, 1.0),), box=box, parts=(*fronts, *others), size=(width, depth, height)
    )
    return Unit(
        role=role,
        reading=replace(look_closer(reading, image), box=box, stand="flat"),
        start=x0 * metre.across,
        size=(depth, width, height),
    )


def _holds(box: Float[np.ndarray, "4"], point: Float[np.ndarray, "2"]) -> bool:
    return bool((point >= box[:2]).all() and (point <= box[2:]).all())
