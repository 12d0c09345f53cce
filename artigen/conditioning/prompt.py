"""Parses English into a condition: category, part counts, sizes and colours; rule-based, no model.

"A tall white cabinet with three drawers and two black handles, 80 cm wide" gives category StorageFurniture,
three drawers, two handles, a width of 0.8 m, a larger height than usual, and colours. Words without such a
meaning ("a", "with") are listed as unused. A sentence without any known word is an error.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from artigen.errors import ArtigenError
from artigen.types import PartLabel

NOUNS: dict[str, tuple[str, ...]] = {
    "StorageFurniture": (
        "cabinet", "cupboard", "dresser", "wardrobe", "sideboard", "nightstand", "bookcase",
        "storage furniture", "chest of drawers", "tv stand",
    ),
    "Table": ("table", "desk"),
    "Refrigerator": ("refrigerator", "fridge", "freezer"),
    "Dishwasher": ("dishwasher",),
    "Oven": ("oven", "stove", "range"),
    "WashingMachine": ("washing machine", "washer"),
    "Microwave": ("microwave", "microwave oven"),
    "FilingCabinet": ("filing cabinet", "file cabinet"),
    "TrashCan": ("trash can", "bin", "dustbin", "garbage can", "waste bin"),
    "Box": ("storage box", "carton", "trunk"),
    "ToolBox": ("tool box", "toolbox"),
    "Suitcase": ("suitcase",),
    "ChestFreezer": ("chest freezer",),
    "Laptop": ("laptop", "notebook computer"),
    "Dryer": ("tumble dryer", "dryer"),
    "BreadBox": ("bread box", "bread bin"),
    "Mailbox": ("mailbox", "letterbox"),
    "Printer": ("printer", "copier"),
    "Cart": ("trolley", "cart"),
    "Safe": ("safe",),
    "Window": ("casement window", "sash window", "sliding window"),
    "Door": ("doorway",),
    "Faucet": ("faucet", "tap"),
    "Toilet": ("toilet",),
    "DeskLamp": ("desk lamp",),
    "Pot": ("cooking pot", "saucepan"),
    "Switch": ("light switch",),
    "Toaster": ("toaster",),
}  # fmt: skip
"""Singular nouns of each category; sentences name it by the first."""
CATEGORY_WORDS = {noun: category for category, nouns in NOUNS.items() for noun in nouns}
"""Category of each singular noun."""

PART_WORDS: dict[str, PartLabel] = {
    "drawer": "drawer",
    "door": "door",
    "handle": "handle",
    "knob": "knob",
    "button": "knob",
    "tray": "tray",
    "rack": "tray",
    "shelf": "shelf",
    "wheel": "wheel",
    "castor": "wheel",
    "caster": "wheel",
}
NUMBERS: dict[str, int] = {
    "zero": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8,
    "nine": 9, "ten": 10, "eleven": 11, "twelve": 12,
    "no": 0, "without": 0, "a": 1, "an": 1, "single": 1, "double": 2,
}  # fmt: skip
"""Words for numbers; sentences use the first of each."""
LENGTHS: dict[str, float] = {
    "mm": 0.001, "millimetre": 0.001, "millimeter": 0.001,
    "cm": 0.01, "centimetre": 0.01, "centimeter": 0.01,
    "m": 1.0, "metre": 1.0, "meter": 1.0,
    "in": 0.0254, "inch": 0.0254,
}  # fmt: skip
"""Metres of each unit."""
AXES: dict[str, str] = {
    "wide": "width",
    "width": "width",
    "deep": "depth",
    "depth": "depth",
    "tall": "height",
    "high": "height",
    "height": "height",
}
ADJECTIVES: dict[str, tuple[str, float]] = {
    "tall": ("height", 1.35),
    "high": ("height", 1.35),
    "low": ("height", 0.7),
    "short": ("height", 0.7),
    "wide": ("width", 1.35),
    "narrow": ("width", 0.7),
    "deep": ("depth", 1.25),
    "shallow": ("depth", 0.75),
}
"""Adjectives that scale the category's usual extent along one axis when no length is given."""


Color = tuple[float, float, float]
"""sRGB in [0, 1]."""
COLORS: dict[str, Color] = {
    "white": (0.92, 0.92, 0.91),
    "ivory": (0.93, 0.90, 0.82),
    "cream": (0.91, 0.87, 0.76),
    "beige": (0.83, 0.77, 0.65),
    "silver": (0.76, 0.76, 0.77),
    "steel": (0.72, 0.73, 0.74),
    "grey": (0.53, 0.53, 0.54),
    "gray": (0.53, 0.53, 0.54),
    "anthracite": (0.24, 0.25, 0.27),
    "black": (0.10, 0.10, 0.11),
    "brown": (0.42, 0.28, 0.19),
    "oak": (0.80, 0.66, 0.47),
    "walnut": (0.40, 0.28, 0.20),
    "red": (0.70, 0.16, 0.15),
    "orange": (0.86, 0.48, 0.17),
    "yellow": (0.88, 0.77, 0.32),
    "green": (0.36, 0.50, 0.36),
    "mint": (0.67, 0.82, 0.74),
    "blue": (0.26, 0.38, 0.60),
    "navy": (0.16, 0.21, 0.35),
    "pink": (0.86, 0.63, 0.66),
}
"""sRGB colours of paints and woods."""
BETWEEN = 3
"""Largest number of words between a colour and its noun."""


class TextError(ArtigenError):
    """A sentence that names nothing known, or contradicts itself."""


@dataclass(frozen=True, kw_only=True)
class ParsedText:
    """Content of a sentence. Lengths in metres; ``stretch`` is relative to the usual extent."""

    category: str | None = None
    counts: tuple[tuple[PartLabel, int], ...] = ()
    width: float | None = None
    depth: float | None = None
    height: float | None = None
    stretch: tuple[tuple[str, float], ...] = ()
    colors: tuple[tuple[PartLabel, str], ...] = ()
    """Colour words by part label; ``base`` stands for the whole object."""
    unused: tuple[str, ...] = ()


def parse_text(text: str) -> ParsedText:
    """Parses a sentence.

    Raises:
        TextError: If no word is understood, or the sentence gives two categories, or two values of a count or
            length.
    """
    words = [_singular(word) for word in re.findall(r"\d+(?:\.\d+)?|[a-z]+", text.lower().replace("-", " "))]
    found = ParsedText()
    at = 0
    while at < len(words):
        for read in (_read_length, _read_category, _read_count, _read_adjective, _read_color):
            found, used = read(words[at:], found)
            if used:
                break
        else:
            found = replace(found, unused=(*found.unused, words[at]))
            used = 1
        at += used
    if found == ParsedText(colors=found.colors, unused=found.unused):
        raise TextError(
            f"{text!r}: no word names a category ({', '.join(sorted(CATEGORY_WORDS))}), a part "
            f"({', '.join(sorted(PART_WORDS))}) or a size; for example 'a cabinet with three drawers'"
        )
    return found


def write_text(category: str, counts: Mapping[PartLabel, int]) -> str:
    """A sentence with a category and part counts; the inverse of `parse_text`.

    Args:
        category: A category that has a noun.
        counts: Parts by label; the base and labels with a count of 0 are not named.
    """
    names = {label: noun for noun, label in reversed(PART_WORDS.items())}
    numbers = {number: word for word, number in reversed(NUMBERS.items()) if number > 1}
    parts = []
    for label, count in counts.items():
        if count < 1 or label not in names:
            continue
        noun = "shelves" if count > 1 and label == "shelf" else names[label] + "s" * (count > 1)
        parts.append(f"{numbers.get(count, count) if count > 1 else 'one'} {noun}")
    noun = NOUNS[category][0]
    whole = f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"
    if not parts:
        return whole
    *first, last = parts
    return f"{whole} with {', '.join(first)}{' and ' if first else ''}{last}"


def _read_length(words: list[str], found: ParsedText) -> tuple[ParsedText, int]:
    """Parses a number, a unit and an axis: "80 cm wide"."""
    if len(words) < 3 or not _is_number(words[0]) or words[1] not in LENGTHS:
        return found, 0
    used = 4 if words[2] == "in" and len(words) > 3 else 3
    axis = AXES.get(words[used - 1])
    if axis is None:
        return found, 0
    length = float(words[0]) * LENGTHS[words[1]]
    known = getattr(found, axis)
    if known is not None and known != length:
        raise TextError(f"{axis} is {known:g} m and {length:g} m; give it once")
    if length <= 0:
        raise TextError(f"{axis} is {length:g} m, expected more than 0")
    return replace(found, **{axis: length}), used


def _read_category(words: list[str], found: ParsedText) -> tuple[ParsedText, int]:
    """Parses the longest noun phrase that names a category."""
    phrases = {tuple(map(_singular, phrase.split())): named for phrase, named in CATEGORY_WORDS.items()}
    for size in (3, 2, 1):
        category = phrases.get(tuple(words[:size])) if len(words) >= size else None
        if category is None:
            continue
        if found.category not in (None, category):
            raise TextError(f"both {found.category} and {category} are named; give one category")
        return replace(found, category=category), size
    return found, 0


def _read_count(words: list[str], found: ParsedText) -> tuple[ParsedText, int]:
    """Parses a number and a part, with at most two words between them: "three wide oak drawers"."""
    number = int(float(words[0])) if _is_number(words[0]) else NUMBERS.get(words[0])
    if number is None:
        return found, 0
    for used in range(2, min(5, len(words) + 1)):
        label = PART_WORDS.get(words[used - 1])
        if label is not None:
            known = dict(found.counts)
            if known.get(label, number) != number:
                raise TextError(
                    f"{known[label]} and {number} parts called {label} are asked for; give one number"
                )
            for at in range(1, used - 1):  # "three wide oak drawers"
                found, _ = _read_color(words[at:], found)
            return replace(found, counts=tuple(sorted({**known, label: number}.items()))), used
        if words[used - 1] in NUMBERS or _is_number(words[used - 1]):
            break
    return found, 0


def _read_adjective(words: list[str], found: ParsedText) -> tuple[ParsedText, int]:
    if words[0] not in ADJECTIVES:
        return found, 0
    axis, factor = ADJECTIVES[words[0]]
    known = dict(found.stretch)
    if known.get(axis, factor) != factor:
        raise TextError(f"{words[0]!r} contradicts an earlier word about the {axis}")
    return replace(found, stretch=tuple(sorted({**known, axis: factor}.items()))), 1


def _read_color(words: list[str], found: ParsedText) -> tuple[ParsedText, int]:
    """Parses a colour and the noun soon after it, a part or the object."""
    if words[0] not in COLORS:
        return found, 0
    for at in range(1, min(BETWEEN + 2, len(words))):
        label = PART_WORDS.get(words[at])
        if label is None and _read_category(words[at:], ParsedText())[1]:
            label = "base"
        if label is None:
            continue
        known = dict(found.colors)
        if known.get(label, words[0]) != words[0]:
            named = "the object" if label == "base" else f"parts called {label}"
            raise TextError(f"{known[label]} and {words[0]} are asked for, both of {named}; name one")
        return replace(found, colors=tuple(sorted({**known, label: words[0]}.items()))), 1
    return found, 0


def _singular(word: str) -> str:
    if word == "shelves":
        return "shelf"
    if word == "inches":
        return "inch"
    known = {*PART_WORDS, *LENGTHS, *(part for phrase in CATEGORY_WORDS for part in phrase.split())}
    return word[:-1] if word.endswith("s") and word[:-1] in known else word


def _is_number(word: str) -> bool:
    return word[0].isdigit()
