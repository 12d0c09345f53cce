"""Words of a sentence, and the numbers and lengths among them."""

import re
from fractions import Fraction

from artigen.conditioning.vocabulary import GROUPS, NUMBERS, UNITS

_SIGNS = {"½": " 1/2 ", "¼": " 1/4 ", "¾": " 3/4 ", "\u00d7": " x ", "\u2019": "'", "\u201d": '"', "-": " "}
_WORD = re.compile(r"\d+/\d+|\d+(?:\.\d+)?|[a-z]+|,")


def split_words(text: str) -> tuple[str, ...]:
    """Words, numbers and commas in lower case; a comma between digits is a decimal or thousands sign."""
    text = text.lower()
    for sign, spelled in _SIGNS.items():
        text = text.replace(sign, spelled)
    text = re.sub(r"(\d),(\d{3})(?=\s*(?:mm|millim))", r"\1\2", text)
    text = re.sub(r"(\d),(\d)", r"\1.\2", text)
    text = re.sub(r'(\d)\s*"', r"\1 inch ", re.sub(r"(\d)\s*'(?!\w*[a-z])", r"\1 foot ", text))
    return tuple(_WORD.findall(text.replace(";", ",").replace(":", " ")))


def read_number(words: tuple[str, ...], at: int) -> tuple[float, int] | None:
    """A number from a position on, and how many words it takes: "2", "1 1/2", "half a", "two dozen"."""
    rest = words[at:]
    if not rest:
        return None
    if rest[0] == "half" or rest[:2] == ("a", "quarter") or rest[0] == "quarter":
        return _read_share(rest)
    first = _read_plain(rest[0])
    if first is None:
        return None
    used = 1
    if (
        first in (20, 30, 40, 50, 60, 70, 80, 90)
        and rest[1:2]
        and 0 < NUMBERS.get(rest[1], 0) < 10
        and rest[1] not in ("a", "an", "single", "double", "twin", "triple", "both")
    ):
        first, used = first + NUMBERS[rest[1]], 2
    if rest[used : used + 1] == ("hundred",) and first < 10:
        first, used = 100 * first, used + 1
    if rest[used : used + 1] and (rest[used] in GROUPS or rest[used].removesuffix("s") in GROUPS):
        first, used = first * GROUPS[rest[used].removesuffix("s")], used + 1
        used += rest[used : used + 1] == ("of",)
    elif rest[used : used + 1] in (("quarters",), ("quarter",)) and first > 1:
        return _after_share(rest, first / 4, used + 1)
    elif rest[used : used + 3] == ("and", "a", "half"):
        first, used = first + 0.5, used + 3
    elif "/" in (rest[used] if len(rest) > used else "") and rest[0].isdigit():
        first, used = first + float(Fraction(rest[used])), used + 1
    return float(first), used


def read_length(words: tuple[str, ...], at: int) -> tuple[float, int] | None:
    """A length (m) from a position on, and how many words it takes: "80 cm", "half a metre", "6 ft 2 in"."""
    number = read_number(words, at)
    if number is None:
        return None
    value, used = number
    end = at + used
    if end >= len(words) or words[end] not in UNITS:
        return None
    unit = words[end]
    length, end = value * UNITS[unit], end + 1
    if tuple(words[end : end + 3]) == ("and", "a", "half"):
        return length + 0.5 * UNITS[unit], end + 3 - at
    more = read_number(words, end)
    if more is not None and words[end][0].isdigit():
        after = end + more[1]
        next_unit = words[after] if after < len(words) else ""
        if unit in ("m", "metre", "metres", "meter", "meters") and next_unit == "cm":
            return length + 0.01 * more[0], after + 1 - at
        if unit == "m" and more[0] < 100 and next_unit not in (*UNITS, "x", "by") and len(words[end]) == 2:
            return length + 0.01 * more[0], after - at
        if unit in ("ft", "foot", "feet") and next_unit in ("in", "inch", "inches"):
            return length + UNITS["in"] * more[0], after + 1 - at
    return length, end - at


def _read_plain(word: str) -> float | None:
    if word[0].isdigit():
        return float(Fraction(word))
    return NUMBERS.get(word)


def _read_share(rest: tuple[str, ...]) -> tuple[float, int]:
    """ "half a dozen", "half a metre", "a quarter of a metre"."""
    share, used = (0.5, 1) if rest[0] == "half" else (0.25, 2 if rest[0] == "a" else 1)
    if tuple(rest[used : used + 2]) == ("a", "dozen"):
        return 12 * share, used + 2
    return _after_share(rest, share, used)


def _after_share(rest: tuple[str, ...], share: float, used: int) -> tuple[float, int]:
    used += tuple(rest[used : used + 1]) == ("of",)
    used += tuple(rest[used : used + 1]) in (("a",), ("an",))
    return share, used
