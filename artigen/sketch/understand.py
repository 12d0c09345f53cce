"""Merges and checks a user's request: category, words, counts, lengths and a picture."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

from artigen.conditioning.colors import find_color_only, find_stuff
from artigen.conditioning.measures import AXES, Axis
from artigen.conditioning.paints import METALLIC
from artigen.conditioning.read import check_size, read_sentence
from artigen.conditioning.sentence import OBJECT, Placing, Sentence
from artigen.conditioning.vocabulary import OUTLINES, PARTS, Feature
from artigen.errors import ArtigenError
from artigen.kind import find_kind
from artigen.shapes.draw import Wish, check_wish
from artigen.sketch.request import (
    ROLES_OF,
    FinishRequest,
    SketchRequest,
    check_category,
)
from artigen.sketch.words import CATEGORIES

Value = TypeVar("Value")
LEVEL: tuple[Axis, float, Axis] = ("depth", 1.0, "width")
"""The ratio of what is round or square."""
LEVEL_OUTLINES = (OUTLINES["round"], OUTLINES["square"])


@dataclass(frozen=True, kw_only=True)
class Request:
    """A user's request; at least one of category, text, picture and reading is needed. Lengths in metres."""

    category: str | None = None
    text: str | None = None
    image: Path | None = None
    box: tuple[float, float, float, float] | None = None
    """Left, top, right and bottom of the object in a photograph, as shares of width and height."""
    reading: Path | None = None
    """A file with what is read of the photograph, instead of reading it."""
    wish: Wish = field(default_factory=Wish)


@dataclass(frozen=True, kw_only=True)
class Understood:
    """A request for the sketch network with further information from its words."""

    request: SketchRequest
    stretch: tuple[tuple[str, float], ...] = ()
    """Factors relative to usual sizes for extents that are not given: a tall cabinet."""
    usual: tuple[tuple[str, tuple[float, float]], ...] = ()
    """Usual range (m) of extents that are not given, where a noun says more than the kind: a coffee table."""
    ranges: tuple[tuple[Axis, float, float], ...] = ()
    """Least and largest lengths that are allowed."""
    ratios: tuple[tuple[Axis, float, Axis], ...] = ()
    """Lengths as multiples of others."""
    volume: float | None = None
    """What the object holds (m^3), by which the extents that are not given are scaled."""
    said: str = ""
    """What is understood of the words, in one line."""
    features: tuple[Feature, ...] = ()
    """Other properties: part, property, value, such as door, hinged, left. A reading takes them."""
    places: tuple[Placing, ...] = ()
    """Where parts are on the front."""
    objects: int = 1
    """Number of such objects."""
    notes: tuple[str, ...] = ()
    """What is not understood."""


def understand(request: Request, learned: Sequence[str] = CATEGORIES) -> Understood:
    """Reads the words of a request and merges them with its explicit fields.

    Raises:
        ArtigenError: If the request is empty, names an unknown category or contradicts itself, no object of
            the kind has the size, or its text cannot be read.
    """
    shown = request.image is not None or request.reading is not None
    beside = request.category is not None or shown
    said = Sentence() if request.text is None else read_sentence(request.text, whole=not beside)
    category = _agree("category", request.category, said.kind)
    if category is None and not shown:
        raise ArtigenError("no category is given: name one, describe the object in words, or give a picture")
    if category is not None:
        check_category(category, learned)
    wish, size = request.wish, dict(said.size)
    counts = dict(wish.counts)
    said = _loosen_articles(_name_knobs(said, category), category)
    for label, count in said.counts:
        counts[label] = _agree(f"number of {label}s", counts.get(label), count) or 0
    wish = Wish(
        depth=_agree("depth", wish.depth, size.get("depth")),
        width=_agree("width", wish.width, size.get("width")),
        height=_agree("height", wish.height, size.get("height")),
        style=_agree("style", wish.style, said.style),
        counts=tuple(sorted(counts.items())),
    )
    check_wish(wish)
    kind = None if category is None else find_kind(category)
    if kind is not None:
        check_size(kind, {axis: length for axis in AXES if (length := getattr(wish, axis)) is not None})
    sketch_request = SketchRequest(
        category=category,
        style=wish.style,
        counts=wish.counts,
        depth=wish.depth,
        width=wish.width,
        height=wish.height,
        finishes=find_finishes(said, category),
        some=said.some,
    )
    open_axes = tuple(
        (axis, factor) for axis, factor in said.stretch if getattr(wish, axis) is None
    )  # "tall" is ignored if a height is given
    form = kind.forms.get(said.noun or "") if kind is not None else None
    usual = tuple(
        (axis, span)
        for axis, span in zip(AXES, form or (), strict=form is not None)
        if getattr(wish, axis) is None and not shown
    )
    return Understood(
        request=sketch_request,
        usual=usual,
        ranges=said.ranges,
        ratios=(*said.ratios, *((LEVEL,) if any(one in said.features for one in LEVEL_OUTLINES) else ())),
        stretch=open_axes,
        volume=said.volume,
        said="" if request.text is None else said.describe(),
        features=said.features,
        places=said.places,
        objects=said.objects,
        notes=_name_ignored(said),
    )


def _loosen_articles(said: Sentence, category: str | None) -> Sentence:
    """What is counted by an article is at least one, but for the fronts of furniture: a dryer "with a round
    door" has a lint filter as well."""
    kind = None if category is None else find_kind(category)
    loose = [label for label, count in said.counts if label in said.articles and count == 1]
    if kind is None or kind.laid_out or not loose:
        return said
    return replace(
        said,
        counts=tuple(pair for pair in said.counts if pair[0] not in loose),
        some=tuple(sorted({*said.some, *loose})),
    )


def _name_knobs(said: Sentence, category: str | None) -> Sentence:
    """Knobs of furniture, which has no dials, are handles of that form."""
    kind = None if category is None else find_kind(category)
    named = "knob" in dict(said.counts) or "knob" in said.some
    if kind is None or kind.trade != "furniture" or not named:
        return said
    counts = {("handle" if label == "knob" else label): count for label, count in said.counts}
    some = {"handle" if label == "knob" else label for label in said.some} - set(counts)
    feature = ("handle", "type", "knob")
    known = any(one[:2] == feature[:2] for one in said.features)
    return replace(
        said,
        counts=tuple(sorted(counts.items())),
        some=tuple(sorted(some)),
        features=said.features if known else (*said.features, feature),
    )


def find_finishes(said: Sentence, category: str | None = None) -> tuple[FinishRequest, ...]:
    """The finishes that words request; a word for a part overrides that for the whole object.

    Args:
        said: What is said.
        category: Category of the object, if known.
    """
    kind = None if category is None else find_kind(category)
    also = () if kind is None else kind.colored
    colors, materials = dict(said.colors), dict(said.materials)
    found: dict[str, FinishRequest] = {}
    for target in sorted({*colors, *materials}, key=lambda target: (target != OBJECT, target)):
        stuff = find_stuff(materials.get(target, ""))
        color = find_color_only(colors.get(target, "")) or (None if stuff is None else stuff.color)
        material = METALLIC.get(colors.get(target, "")) if stuff is None else stuff.kind
        for role in _list_roles(target, also):
            part = None if target == OBJECT else target
            found[role] = FinishRequest(role=role, color=color, material=material, part=part)
    return tuple(found.values())


def _list_roles(target: str, also: tuple[str, ...]) -> tuple[str, ...]:
    """Finishes of the whole object, of a part, or of a piece that a word of finishes names."""
    if target == OBJECT:
        return (*ROLES_OF["base"], *also)
    return ROLES_OF[PARTS[target]] if target in PARTS else (target,)


def _name_ignored(said: Sentence) -> tuple[str, ...]:
    return (f"no meaning was found in: {', '.join(said.ignored)}",) if said.ignored else ()


def _agree(what: str, first: Value | None, second: Value | None) -> Value | None:
    """The value that is given; both must agree if two are given."""
    if first is not None and second is not None and first != second:
        raise ArtigenError(f"{what}: both {first} and {second} are given")
    return second if first is None else first
