"""`read_units`: the units along one wall of a kitchen, from a photograph that shows several of them.

Objects that touch have no peaks of their own, but fronts have: those of one wall are on one plane, and what
stands above each other there is a column. Kitchens are built to few heights, and these tell the scale, the
floor, and what each column is."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from artigen.conditioning.image import open_picture
from artigen.errors import SourceError
from artigen.kind import Size
from artigen.reader.layout.plane import Plane, fit_plane, frame_box
from artigen.reader.looks import look_closer
from artigen.reader.model import Reader, load_reader
from artigen.reader.read import read_all
from artigen.reader.reading import Reading
from artigen.reader.wall.columns import Column, make_stacks
from artigen.reader.wall.face import choose_wall, find_aspect, list_corners
from artigen.reader.wall.roles import HUNG, TOE, TOP, Metre, find_place, find_roles
from artigen.weights import READER

if TYPE_CHECKING:
    from PIL import Image

JOINED = 0.12
"""Gap (m) between columns of one unit."""
FREE = 0.15
"""Gap (m) between units from which the wall between them is left free."""
WIDEST = 1.2
"""Width (m) up to which columns are one unit."""
UNEVEN = 0.12
"""Difference in height (m) of the ends of columns up to which they hang as one unit."""


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


def read_units(photo: Path) -> Wall:
    """Reads the wall of a photograph that has the largest fronts.

    Args:
        photo: Any picture that `artigen.conditioning.image.open_picture` opens, of a wall from before it.

    Raises:
        SourceError: If the picture cannot be opened, or shows no unit that stands on a floor.
    """
    image = open_picture(photo)
    return find_units(image, load_reader(READER), str(photo))


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
    stacks = make_stacks(fronts, plane, image, reader)
    metre, columns, roles = find_roles(stacks, find_aspect(plane, extent))
    strange = sum(role is None for role in roles)
    notes += [f"{strange} columns of fronts that are like no unit of a kitchen: left out"] if strange else []
    units = group_columns(columns, roles, metre)
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


def _find_height(role: str, columns: Sequence[Column], roles: Sequence[str | None], metre: Metre) -> float:
    """Height (m) of all objects of a role: that of a worktop is one along a wall."""
    own = [column.bounds for column, other in zip(columns, roles, strict=True) if other == role]
    return float(np.median([metre.height(float(bounds[1])) for bounds in own])) + TOP


def group_columns(
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
