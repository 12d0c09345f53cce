"""Words of a sentence, and the numbers and lengths among them."""

import math
import re
from dataclasses import dataclass
from fractions import Fraction

from artigen.conditioning.measures import BODY, DIRECTIONS, GROUPS, LIMITS, NUMBERS, SIDES, UNITS
from artigen.conditioning.vocabulary import count_longest

_PLAIN = (
    ("½", " 1/2 "), ("¼", " 1/4 "), ("¾", " 3/4 "), ("\u00d7", " x "), ("\u2019", "'"),
    ("\u201d", '"'), ("\u2013", "-"),
    (r"\bdraws\b", "drawers"), (r"\bshelfs\b", "shelves"), (r"pull[- ](out|down)", r"pull\1"),
    (r"\bw/o\b", "without"),
    (r"\bw/", " with "), (r"(?<=[a-z])/(?=[a-z])", " or "),
    (r"(?<=[a-z])'(?:s|d|m|ll|re|ve)\b", ""), (r"\bcan(?:no|')t\b", "can not"), (r"n't\b", " not"),
    (r"\bdo(?:es)? not (?:want|need|have)\b(?: any\b)?", "without"),
    (r"(?<!\bin)(?<!\bft)(?<!\bcm)(?<!\bmm)(?<!\bapprox)[.!?]\s+", ", "),
    (r"(\d)\s*-\s*(?=\d)", r"\1 to "), ("-", " "),
    (r"(\d),(\d{3})(?=\s*(?:mm|millim))", r"\1\2"), (r"(\d),(\d)", r"\1.\2"),
    (r"(\d)\s*'(?!\w*[a-z])", r"\1 foot "), (r'(\d)\s*"', r"\1 inch "),
    (r"\bmake (?:it|them) ([^,.;]+) instead\b", r", no, make it \1"), (";", ","), (r":(?!\s*\d)", ","),
)  # fmt: skip
"""Signs, contractions and ends of sentences, and what they are in words; "doors: 2" is a number of doors."""
_WORD = re.compile(r"\d+/\d+|\d+(?:\.\d+)?|[a-z]+|,")

LARGE = frozenset({"m", "metre", "metres", "meter", "meters"})
"""Units after which a bare number counts hundredths."""
LONGEST_LIMIT = count_longest(LIMITS)
"""Words of the longest phrase before a number."""


@dataclass(frozen=True, kw_only=True)
class Length:
    """A length (m), or a range of them, and how many words it takes."""

    low: float
    high: float
    words: int

    @property
    def metres(self) -> float:
        """The length, the middle of a range, or the end of one that has no other."""
        ends = [end for end in (self.low, self.high) if 0 < end < math.inf]
        return sum(ends) / max(len(ends), 1)


def split_words(text: str) -> tuple[str, ...]:
    """Words, numbers and commas in lower case; a comma between digits is a decimal or thousands sign."""
    text = text.lower()
    for sign, spelled in _PLAIN:
        text = re.sub(sign, spelled, text)
    return tuple(_WORD.findall(text))


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


def crosses(words: tuple[str, ...], at: int) -> bool:
    """Whether a number is multiplied by the next one: "60 x 55", "2 by 3"."""
    return at < len(words) and words[at] in ("x", "by")


def read_limit(words: tuple[str, ...], at: int) -> tuple[int, int, int]:
    """On which side of the number after "at most" or "more than" others are (1 above, -1 below, 0 none), how
    far the nearest whole one is, and how many words the phrase takes; no words without one."""
    for count in range(LONGEST_LIMIT, 0, -1):
        limit = LIMITS.get(" ".join(words[at : at + count]))
        if limit is not None:
            return *limit, count
    return 0, 0, 0


def read_count(words: tuple[str, ...], at: int) -> tuple[int, int] | None:
    """A whole number from a position on, and how many words it takes: "three", "at least two", "four to six".

    Of a range it is the middle, rounded down; "more than two" is three.
    """
    _, step, skipped = read_limit(words, at)
    span = _read_span(words, at + skipped)
    if span is None or any(end != int(end) for end in span[:2]):
        return None
    return max(0, int(span[0] + span[1]) // 2 + step), skipped + span[2]


def _read_span(words: tuple[str, ...], at: int) -> tuple[float, float, int] | None:
    """Both ends of "between four and six", "4 to 6" or "two or three", and how many words it takes; a single
    number is both ends."""
    between = tuple(words[at : at + 1]) == ("between",)
    first = read_number(words, at + between)
    if first is None:
        return None
    link = at + between + first[1]
    links = (("and",), ("to",)) if between else (("to",), ("or",))
    last = read_number(words, link + 1) if tuple(words[link : link + 1]) in links else None
    if last is None or last[0] < first[0]:
        return None if between else (first[0], first[0], first[1])
    return first[0], last[0], link + 1 + last[1] - at


def read_length(words: tuple[str, ...], at: int) -> Length | None:
    """A length from a position on: "80 cm", "half a metre", "6 ft 2 in", "60 to 80 cm", "under 70 cm"."""
    side, _, skipped = read_limit(words, at)
    if at < len(words) and words[at] in SIDES:
        side, skipped = SIDES[words[at]], 1
    span = _read_span(words, at + skipped)
    end = at + skipped + span[2] if span is not None else 0
    if span is not None and span[0] < span[1]:
        unit = UNITS.get(words[end]) if end < len(words) else None
        return None if unit is None else Length(low=span[0] * unit, high=span[1] * unit, words=end + 1 - at)
    plain = _read_plain_length(words, at + skipped)
    if plain is None:
        return None
    low, high = 0.0 if side < 0 else plain[0], math.inf if side > 0 else plain[0]
    return Length(low=low, high=high, words=plain[1] + skipped)


def _read_plain_length(words: tuple[str, ...], at: int) -> tuple[float, int] | None:
    if words[at : at + 1] and words[at] in BODY and words[at + 1 : at + 2] in (("high",), ("height",)):
        return BODY[words[at]], 1
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
    after = end + more[1] if more is not None else len(words)
    directed = after < len(words) and words[after] in DIRECTIONS
    if more is not None and unit in LARGE and 10 <= more[0] < 100 and directed:
        return length + 0.01 * more[0], after - at  # "one metre forty wide"
    if more is not None and words[end][0].isdigit():
        after = end + more[1]
        next_unit = words[after] if after < len(words) else ""
        if unit in LARGE and next_unit == "cm":
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
