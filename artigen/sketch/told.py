"""`draw_told`: draws an object with the hinges, panes, stands, handles and places that words describe.

The fronts of kinds that divide their front are laid out where they belong. For other kinds, and for what a
layout does not decide, objects of the grammar are drawn until one is as described.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np

from artigen.conditioning.sentence import Placing
from artigen.conditioning.vocabulary import BARE, GLAZED, GLOSSES, LEVEL, STYLES, Feature
from artigen.errors import ArtigenError
from artigen.kind import kinds, name_kind
from artigen.reader.correct import FRONTS, Side, correct_reading
from artigen.reader.layout.build import build_from_reading
from artigen.reader.reading import Reading, ReadPart, Stand
from artigen.shapes.draw import Outline, ShapeError, Wish, draw_shape
from artigen.shapes.fittings.handles import HANDLE_KINDS, HandleKind
from artigen.shapes.fittings.legs import LEG_KINDS, LegKind
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape
from artigen.sketch.arrange import add_shelves, arrange_fronts
from artigen.sketch.described import count_narrow, list_undescribed, read_front
from artigen.sketch.request import SketchRequest
from artigen.types import PartLabel

DRAWS = 48
"""Objects that are drawn for what a layout does not decide."""
STREAM = 78
"""Number of the random stream of these draws."""
FEW = 16
"""Draws after which the best one is taken if a layout decides what is left."""
LAID = (*FRONTS, "handle")
"""Parts whose number a layout decides."""
WHOLE = (0.03, 0.05, 0.97, 0.95)
"""Left, top, right and bottom of all fronts, as shares of an object that has none yet."""
STANDS: dict[str, Stand] = {
    "legs": "legs", "feet": "legs", "plinth": "flat", "floor": "flat", "castor": "wheels", "wheel": "wheels",
}  # fmt: skip
"""What an object stands on, by words for it."""
GLOSS = {"matte": 0.06, "satin": 0.25, "glossy": 0.6}
"""Gloss (`artigen.shapes.surfaces.finishes.Finish`) by words for surfaces."""
FLOOR = 0.005
"""Height (m) up to which something stands on the floor."""
LAID_OUT = {
    ("wheel", "type"),
    ("door", "hinged"),
    ("door", "material"),
    ("stand", "type"),
    ("handle", "type"),
}
"""What the layout of a front decides, besides places, rows and columns."""


@dataclass(frozen=True, kw_only=True)
class Told:
    """What words say beyond counts, sizes and finishes."""

    features: tuple[Feature, ...] = ()
    places: tuple[Placing, ...] = ()

    def _find(self, part: str, what: str) -> str | None:
        """The first that is said of a property."""
        return next((value for *named, value in self.features if named == [part, what]), None)

    @property
    def hinge(self) -> Side | None:
        """The side of the hinges of all doors."""
        return next((side for side in get_args(Side) if ("door", "hinged", side) in self.features), None)

    @property
    def handles(self) -> tuple[HandleKind, ...]:
        """The kind of handles: the first that is said."""
        said = self._find("handle", "type")
        return tuple(kind for kind in HANDLE_KINDS if kind == said)

    @property
    def legs(self) -> LegKind | None:
        """The kind of legs."""
        said = self._find("leg", "type")
        return next((kind for kind in LEG_KINDS if kind == said), None)

    @property
    def stand(self) -> Stand | None:
        """What the object stands on."""
        said = next(
            (one[2] for one in self.features if one[:2] in (("stand", "type"), ("wheel", "type"))), ""
        )
        return STANDS.get(said)

    @property
    def pane(self) -> bool | None:
        """Whether all doors are glazed; None if nothing is said."""
        return True if GLAZED in self.features else None

    @property
    def outline(self) -> Outline | None:
        """The outline of the object's top, from above."""
        said = self._find("object", "outline")
        return next((outline for outline in get_args(Outline) if outline == said), None)

    @property
    def gloss(self) -> float | None:
        """The gloss of the object's paint, wood and plastic; None if nothing is said."""
        said = self._find("object", "surface")
        return None if said is None else GLOSS[said]

    @property
    def spots(self) -> set[str]:
        """All places that are said."""
        return {place.at for place in self.places}

    def is_beyond(self, style: str | None) -> bool:
        """Whether anything is said that the sketch network, which knows styles, cannot be asked for."""
        known = {feature for feature in self.features if style is not None and STYLES.get(feature) == style}
        return bool(self.places) or bool(set(self.features) - known - {BARE, *GLOSSES.values()})

    def list_lost(self, shape: Shape, seen: Reading | None = None) -> list[str]:
        """What is not so in an object, of which ``seen`` is the front if that is known."""
        handles = [one for one in self.features if one[:2] == ("handle", "type")]
        lost = [" ".join(one) for one in handles[1:]]  # an object has one kind of them
        return lost + list_undescribed(shape, self.features, self.places, seen)


def draw_told(told: Told, request: SketchRequest, seed: int) -> tuple[Shape, tuple[str, ...]] | None:
    """Draws an object of the grammar that is as described, or the nearest one.

    Args:
        told: What is said beyond counts, sizes and finishes.
        request: The kind, counts, sizes and style.
        seed: The same arguments give the same object.

    Returns:
        The object, in finishes of its own, and what of the words could not be met; None if the grammar found
        no object with the counts.
    """
    assert request.category is not None
    kind = kinds()[request.category]
    inside = [one for one in told.features if kind.laid_out and _is_laid_out(one)]
    outside = Told(
        features=tuple(one for one in told.features if one not in inside),
        places=() if kind.laid_out else told.places,
    )
    hidden = [one for one in told.features if one[1] == "type" and one[0] in ("stand", "handle")]
    named = {label for label, _ in request.counts} & set(FRONTS)
    divide = kind.laid_out and bool(inside or told.places or (named and not outside.features))
    best: tuple[tuple[int, int, int], Shape, list[str]] | None = None
    for draw in range(DRAWS):
        own = int(np.random.SeedSequence([seed, STREAM, draw]).generate_state(1)[0])
        first = not told.places and draw == 0
        shape = _draw(request, told, own) if first or not divide else None
        if shape is None and not divide and draw > 0 and best is None:
            return None
        if shape is None and divide:  # the layout gives the fronts their numbers
            shape = _draw(replace(request, counts=_leave_out(request.counts)), told, own)
        if shape is None:
            continue
        laid = _lay_out(shape, told, request, own) if divide else None
        for found, unseen in ((shape, hidden), (laid, [])):
            if found is None or not _has_counts(found, request):
                continue
            seen = read_front(found)
            lost = told.list_lost(found, seen)
            lost += [" ".join(one) for one in unseen if one[2] != "none" and not _stands(found, one)]
            lost += _list_uncounted(found, told, request) + list_unworn(found, request)
            narrow = count_narrow(seen) if request.width is None and kind.laid_out else 0
            rank = (len(outside.list_lost(found, seen)), len(lost), narrow)
            if best is None or rank < best[0]:
                best = rank, replace(found, seed=seed), lost
        if best is not None and (not any(best[0]) or (draw >= FEW and best[0][0] == 0)):
            break
    if best is None:
        return None
    lost = best[2]
    return best[1], (f"understood, but no {kind.name} was found with: {', '.join(lost)}",) if lost else ()


def _list_uncounted(shape: Shape, told: Told, request: SketchRequest) -> list[str]:
    """Parts that are asked for in another number; a shelf with a place is an open compartment."""
    placed = {"shelf"} & {place.label for place in told.places}
    held = dict(shape.condition.counts)
    return [
        f"{count} {label}"
        for label, count in request.counts
        if held.get(label, 0) != count and label not in placed
    ]


def list_unworn(shape: Shape, request: SketchRequest) -> list[str]:
    """Parts and pieces of which a finish is asked for, and of which an object has none."""
    worn = {solid.finish for part in shape.parts for solid in part.primitives}
    asked = {finish.part: worn & {one.role for one in request.finishes if one.part == finish.part}
             for finish in request.finishes if finish.part is not None}  # fmt: skip
    return [f"{part} of its own" for part, roles in asked.items() if not roles]


def _stands(shape: Shape, feature: Feature) -> bool:
    """Whether a feature is the stand of a shape."""
    return feature[0] == "stand" and STANDS.get(feature[2]) == find_stand(shape)


def _leave_out(counts: Sequence[tuple[PartLabel, int]]) -> tuple[tuple[PartLabel, int], ...]:
    return tuple(pair for pair in counts if pair[0] not in LAID)


def _draw(request: SketchRequest, told: Told, seed: int) -> Shape | None:
    """A draw of the grammar with what is asked for; None if it has no such object."""
    wish = Wish(
        width=request.width, depth=request.depth, height=request.height, style=request.style,
        counts=request.counts, handles=told.handles, legs=told.legs, outline=told.outline,
    )  # fmt: skip
    try:
        return draw_shape(str(request.category), seed, wish)
    except ShapeError:
        return None


def _has_counts(shape: Shape, request: SketchRequest) -> bool:
    held = dict(shape.condition.counts)
    return all(held.get(label, 0) == count for label, count in request.counts if label in FRONTS) and all(
        held.get(label, 0)
        for label in request.some
        if label != "shelf"  # which may be an open compartment
    )


def _is_laid_out(feature: Feature) -> bool:
    return feature[:2] in LAID_OUT or feature[1] in ("rows", "columns") or feature == LEVEL


def _lay_out(shape: Shape, told: Told, request: SketchRequest, seed: int) -> Shape | None:
    """The object with its front divided as it is said; None where that cannot be built."""
    reading = replace(read_front(shape), stand=told.stand or find_stand(shape))
    size = reading.size
    if not reading.fronts:
        front = ReadPart(label="drawer", score=0.0, box=np.array(WHOLE))
        reading = replace(reading, parts=(front, *reading.parts))
    held = {label: reading.counts[label] for label in FRONTS}
    reading = correct_reading(reading, counts=_count_fronts(reading, told, request))
    grids = [one for one in told.features if one[1] in ("rows", "columns")]
    grids += [("door", "rows", "1")] if LEVEL in told.features else []
    if told.places or grids or held != {label: reading.counts[label] for label in FRONTS}:
        desk = shape.category == name_kind("table") and bool({"left", "right", "sides"} & told.spots)
        reading = arrange_fronts(reading, told.places, grids, lowest=WHOLE[3] if desk else 0.0)
    shelves = dict(request.counts).get("shelf", 0)
    if shelves and not any(place.label == "shelf" for place in told.places):
        reading = add_shelves(reading, shelves)
    reading = correct_reading(reading, hinge=told.hinge, pane=told.pane)
    wish = Wish(
        width=size[0], depth=request.depth or size[1], height=size[2], style=shape.style,
        handles=told.handles, legs=told.legs,
    )  # fmt: skip
    try:
        built, _ = build_from_reading(reading, seed, wish)
    except ArtigenError:
        return None
    return built if built.category == shape.category else None


def _count_fronts(reading: Reading, told: Told, request: SketchRequest) -> dict[str, int]:
    """Numbers of fronts: as said, at least one of what is named without a number, and nothing else if
    something is named; without a word about them those of the reading."""
    asked = dict(request.counts)
    named = {place.label for place in told.places} | set(request.some) | set(asked)
    if not named & set(FRONTS):
        return {label: asked[label] for label in ("handle",) if label in asked}
    spread = {place.label for place in told.places if place.at == "sides"}
    return {
        label: asked.get(label, max(reading.counts[label], 1 + (label in spread)) if label in named else 0)
        for label in FRONTS
    } | {label: 0 for label in ("handle",) if asked.get(label) == 0}


def find_stand(shape: Shape) -> Stand:
    """What an object stands on, by its wheels and by what reaches the floor in the finish of legs."""
    if any(part.label == "wheel" for part in shape.parts):
        return "wheels"
    floor = float(shape.bounds()[0, 2])
    legs = any(
        solid.finish == "leg" and float(place_vertices(solid)[:, 2].min()) < floor + FLOOR
        for part in shape.parts
        for solid in part.primitives
    )
    return "legs" if legs else "flat"
