"""Merges and checks a user's request: category, words, counts, lengths and a picture."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from artigen.conditioning.prompt import COLORS, ParsedText, parse_text
from artigen.errors import ArtigenError
from artigen.kind import find_kind
from artigen.shapes.draw import Wish, check_wish
from artigen.sketch.request import (
    MATERIAL_OF,
    ROLES_OF,
    FinishRequest,
    SketchRequest,
    check_category,
)
from artigen.sketch.words import CATEGORIES
from artigen.types import PartLabel

Value = TypeVar("Value")


@dataclass(frozen=True, kw_only=True)
class Request:
    """A user's request; at least one of category, text and picture is needed. Lengths in metres."""

    category: str | None = None
    text: str | None = None
    image: Path | None = None
    wish: Wish = field(default_factory=Wish)


@dataclass(frozen=True, kw_only=True)
class Understood:
    """A request for the sketch network with further information from its words."""

    request: SketchRequest
    stretch: tuple[tuple[str, float], ...] = ()
    """Factors relative to usual sizes for extents that are not given: a tall cabinet."""
    notes: tuple[str, ...] = ()


def understand(request: Request, learned: Sequence[str] = CATEGORIES) -> Understood:
    """Parses the words of a request and merges them with its explicit fields.

    Raises:
        ArtigenError: If the request is empty, names an unknown category or contradicts itself, or its text
            cannot be parsed.
    """
    text = ParsedText() if request.text is None else parse_text(request.text)
    category = _agree("category", request.category, text.category)
    if category is None and request.image is None:
        raise ArtigenError("no category is given: name one, describe the object in words, or give a picture")
    if category is not None:
        check_category(category, learned)
    wish = request.wish
    counts = dict(wish.counts)
    for label, count in text.counts:
        counts[label] = _agree(f"number of {label}s", counts.get(label), count) or 0
    wish = Wish(
        depth=_agree("depth", wish.depth, text.depth),
        width=_agree("width", wish.width, text.width),
        height=_agree("height", wish.height, text.height),
        style=wish.style,
        counts=tuple(sorted(counts.items())),
    )
    check_wish(wish)
    sketch_request = SketchRequest(
        category=category,
        style=wish.style,
        counts=wish.counts,
        depth=wish.depth,
        width=wish.width,
        height=wish.height,
        finishes=find_finishes(text.colors, category),
        some=tuple(label for label, _ in text.colors if label != "base"),
    )
    open_axes = tuple(
        (axis, factor) for axis, factor in text.stretch if getattr(wish, axis) is None
    )  # "tall" is ignored if a height is given
    notes = (f"no meaning was found in: {', '.join(text.unused)}",) if text.unused else ()
    return Understood(request=sketch_request, stretch=open_axes, notes=notes)


def find_finishes(
    colors: tuple[tuple[PartLabel, str], ...], category: str | None = None
) -> tuple[FinishRequest, ...]:
    """The finishes that colour words request; a word for a part overrides that for the whole object.

    Args:
        colors: Colour words by the label they refer to; ``base`` is the whole object.
        category: Category of the object, if known.
    """
    kind = None if category is None else find_kind(category)
    also = () if kind is None else kind.colored
    found: dict[str, FinishRequest] = {}
    for label, word in sorted(colors, key=lambda named: named[0] != "base"):
        for role in (*ROLES_OF[label], *(also if label == "base" else ())):
            found[role] = FinishRequest(role=role, color=COLORS[word], material=MATERIAL_OF.get(word))
    return tuple(found.values())


def _agree(what: str, first: Value | None, second: Value | None) -> Value | None:
    """The value that is given; both must agree if two are given."""
    if first is not None and second is not None and first != second:
        raise ArtigenError(f"{what}: both {first} and {second} are given")
    return second if first is None else first
