"""Reads what a sentence says of lengths by others: "twice as tall as it is wide", "wider than it is tall"."""

from artigen.conditioning.measures import COMPARATIVES, DIRECTIONS
from artigen.conditioning.numbers import read_number
from artigen.conditioning.parse import Parse, say_length
from artigen.conditioning.sentence import TextError
from artigen.conditioning.vocabulary import PARTS

MORE = 1.35
"""Ratio of the lengths of what is wider than it is tall, as of what is called wide."""
AGREE = 0.05
"""Largest relative difference between two given lengths and what is said of their ratio."""
LINKS = frozenset({"it", "is", "they", "are", "the", "that", "which"})
"""Words between two directions, or between a noun and what is said of it."""


def read_proportions(parse: Parse) -> Parse:
    """Reads ratios of lengths; where one of both lengths is given, it gives the other.

    Raises:
        TextError: If both are given and have another ratio.
    """
    words = parse.words
    for at in range(len(words) - 2):
        start, end, compared = at, at + 2, words[at] in COMPARATIVES and words[at + 1] == "than"
        if compared:
            way, direction = COMPARATIVES[words[at]]
            ratio = MORE if way == "more" else 1 / MORE
        elif words[at] == words[at + 2] == "as" and words[at + 1] in DIRECTIONS:
            direction, end = words[at + 1], at + 3
            start, ratio = _read_factor(words, at)
        else:
            continue
        while end < len(words) and words[end] in LINKS:
            end += 1
        axis, other = DIRECTIONS[direction], DIRECTIONS.get(words[end]) if end < len(words) else None
        noun = next((place for place in range(start - 1, -1, -1) if words[place] not in LINKS), 0)
        of_part = words[noun] in PARTS and noun not in parse.head
        if other is None or other == axis or parse.used & {at, end} or of_part:
            continue
        parse, sizes = parse.take(start, end + 1 - start), dict(parse.found.size)
        if axis in sizes and other in sizes:
            said = sizes[axis] / sizes[other]
            if (said - 1) * (ratio - 1) <= 0 if compared else abs(said / ratio - 1) > AGREE:
                raise TextError(
                    f"{axis} is {sizes[axis]:g} m and {other} {sizes[other]:g} m, which is not "
                    f"{' '.join(words[start : end + 1])!r}; leave one out"
                )
        elif axis in sizes:
            parse = say_length(parse, other, sizes[axis] / ratio)
        elif other in sizes:
            parse = say_length(parse, axis, sizes[other] * ratio)
        else:
            parse = parse.say(ratios=(*parse.found.ratios, (axis, ratio, other)))
    return parse


def _read_factor(words: tuple[str, ...], at: int) -> tuple[int, float]:
    """The first word of "twice", "half" or "three times" before a word, and the factor; 1 without one."""
    number = read_number(words, at - 2) if at > 1 and words[at - 1] == "times" else None
    if number is not None:
        return at - 2, number[0]
    factor = {"twice": 2.0, "half": 0.5}.get(words[at - 1]) if at else None
    return (at, 1.0) if factor is None else (at - 1, factor)
