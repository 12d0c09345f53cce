"""What a person asks for (category, words, counts, lengths, a picture) as one `StructureCondition`."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from artigen.errors import ArtigenError
from artigen.models.conditions import StructureCondition
from artigen.pictures import MARGIN, read_picture
from artigen.shapes.draw import Wish, categories, check_wish, draw_shape
from artigen.text import COLORS, Color, ParsedText, parse_text
from artigen.types import PART_LABELS, PartLabel

Value = TypeVar("Value")


@dataclass(frozen=True, kw_only=True)
class Request:
    """What is asked for; everything but one of category, text and picture may be left open. Metres."""

    category: str | None = None
    text: str | None = None
    image: Path | None = None
    wish: Wish = field(default_factory=Wish)


@dataclass(frozen=True, kw_only=True, eq=False)
class Asked:
    """The condition that a request amounts to, and what was made of it besides."""

    condition: StructureCondition
    colors: tuple[tuple[PartLabel, Color], ...] = ()
    """Colours that were asked for, by part; that of the object stands at its base."""
    notes: tuple[str, ...] = ()


def read_request(request: Request, seed: int, image_size: int, *, margin: float = MARGIN) -> Asked:
    """One whole condition: what the request leaves open is drawn from the procedural grammar by the seed.

    The grammar knows which sizes and counts go together, so what is drawn is something that exists. A
    picture says more than a draw could; beside one, nothing is added.

    Args:
        request: What is asked for.
        seed: Decides what is left open.
        image_size: Edge of pictures that the model takes, pixels; 0 if it takes none.
        margin: Free border on each side of the object in them, as a share of the edge.

    Raises:
        ArtigenError: If nothing, an unknown category or twice different things are asked for, the text
            cannot be read, the picture neither, or no such object exists.
    """
    text = ParsedText() if request.text is None else parse_text(request.text)
    category = _agree("category", request.category, text.category)
    if category is not None and category not in categories():
        raise ArtigenError(f"category {category!r}: expected one of {', '.join(sorted(categories()))}")
    counts = dict(request.wish.counts)
    for label, count in text.counts:
        counts[label] = _agree(f"number of {label}s", counts.get(label), count) or 0
    wish = request.wish
    depth = _agree("depth", wish.depth, text.depth)
    width = _agree("width", wish.width, text.width)
    height = _agree("height", wish.height, text.height)
    notes = [f"no meaning was found in: {', '.join(text.unused)}"] if text.unused else []
    given = tuple(sorted(counts.items()))
    colors: tuple[tuple[PartLabel, Color], ...] = tuple((label, COLORS[word]) for label, word in text.colors)
    asked = Wish(depth=depth, width=width, height=height, counts=given)
    check_wish(asked)
    if request.image is not None:
        if not image_size:
            raise ArtigenError(f"{request.image}: this model takes no pictures")
        picture = read_picture(request.image, image_size, margin=margin)
        size = None if depth is None or width is None or height is None else (depth, width, height)
        condition = StructureCondition(
            category=category, counts=given, size=size, image=picture.rgba, text=request.text
        )
        return Asked(condition=condition, colors=colors, notes=(*notes, *picture.notes))
    if category is None:
        raise ArtigenError("no category is asked for: name one, in words if you like, or give a picture")
    drawn = draw_shape(category, seed, asked).condition
    factors = dict(text.stretch)  # "tall" says nothing where a height is given
    size = (
        drawn.depth * (factors.get("depth", 1.0) if depth is None else 1.0),
        drawn.width * (factors.get("width", 1.0) if width is None else 1.0),
        drawn.height * (factors.get("height", 1.0) if height is None else 1.0),
    )
    found = dict(drawn.counts)
    whole: tuple[tuple[PartLabel, int], ...] = tuple(  # no doors is a number of doors, too
        (label, found.get(label, 0)) for label in PART_LABELS
    )
    return Asked(
        condition=StructureCondition(category=category, counts=whole, size=size, text=request.text),
        colors=colors,
        notes=tuple(notes),
    )


def _agree(what: str, first: Value | None, second: Value | None) -> Value | None:
    """The one that is given, or either if both are the same."""
    if first is not None and second is not None and first != second:
        raise ArtigenError(f"{what}: both {first} and {second} are asked for")
    return second if first is None else first
