"""Reads the lengths of a sentence: with a direction, as a product, and bare."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from artigen.conditioning.measures import AXES, DIRECTIONS, UNITS, VOLUMES, Axis
from artigen.conditioning.numbers import Length, crosses, read_length, read_number
from artigen.conditioning.parse import Parse, kind_of, say_length, say_range
from artigen.conditioning.sentence import TextError
from artigen.conditioning.vocabulary import CLAUSES, PARTS
from artigen.kind import Kind

WIDEST = 1.25
"""Width (m) of the widest ranges and refrigerators; a longer length of an appliance is its height."""
ORDERS: tuple[tuple[Axis, ...], ...] = (
    AXES, ("width", "height", "depth"), ("height", "width", "depth"), ("depth", "width", "height"),
)  # fmt: skip
"""What the three lengths of a product may be."""
FAR_MORE_USUAL = 0.7
"""How much nearer to a kind's usual lengths, as the sum of logarithms, another order must be."""
FURTHEST = 10.0
"""Largest length (m) of a number without a unit, which has that of the number before."""


def read_sizes(parse: Parse) -> Parse:
    """Reads "1.2 m wide", "80 cm in width", "width of 80 cm", "60 x 55 x 85 cm", and "80 deep" after a
    length with a unit."""
    words, at, unit = parse.words, 0, None
    while at < len(words):
        triple = _read_triple(words, at)
        if triple is not None:
            for axis, length in zip(AXES, triple[0], strict=True):
                parse = say_length(parse, axis, length)
            parse = replace(parse.take(at, triple[1]), product=tuple(triple[0]))
            at += triple[1]
            continue
        length = read_length(words, at)
        number = read_number(words, at)
        if length is not None:
            unit = next((word for word in words[at : at + length.words][::-1] if word in UNITS), None)
        elif number is not None and unit is not None and words[at][0].isdigit():
            bare = number[0] * UNITS[unit]
            length = Length(low=bare, high=bare, words=number[1]) if bare <= FURTHEST else None
        named = None if length is None else _find_direction(words, at, length.words)
        each = words[max(0, at - 1) : at] in (("each",), ("every",))  # "three drawers, each 20 cm high"
        if length is None or named is None:
            at += 1
            continue
        axis, start, end = named
        if each:
            parse, at = parse.lose(start, end - start), end
            continue
        parse = say_range(parse.take(start, end - start), axis, length)
        at = end
    return parse


def _find_direction(words: tuple[str, ...], at: int, used: int) -> tuple[Axis, int, int] | None:
    """The axis of a length, and the first word of the phrase and the first after it."""
    end = at + used
    after = end + (tuple(words[end : end + 1]) == ("in",))
    if after < len(words) and words[after] in DIRECTIONS:
        return DIRECTIONS[words[after]], at, after + 1
    for back in (1, 2):
        start = at - back
        linked = back == 1 or words[at - 1] in ("of", "is")
        if start >= 0 and linked and words[start] in DIRECTIONS:
            return DIRECTIONS[words[start]], start, end
    return None


def _read_triple(words: tuple[str, ...], at: int) -> tuple[list[float], int] | None:
    """Width, depth and height (m) of "60 x 55 x 85 cm", and the number of words."""
    numbers: list[tuple[float, str | None]] = []
    end = at
    for place in range(3):
        if place and not crosses(words, end):
            return None
        end += place > 0
        number = read_number(words, end)
        spelled = number is not None and not words[end][0].isdigit()
        end += 0 if number is None else number[1]
        unit = words[end] if end < len(words) and words[end] in UNITS else None
        if number is None or (spelled and unit is None):
            return None
        numbers.append((number[0], unit))
        end += unit is not None
    last = numbers[-1][1]
    if last is None:
        return None
    return [value * UNITS[unit or last] for value, unit in numbers], end - at


def order_product(parse: Parse) -> Parse:
    """Lengths of "200 x 80 x 30 cm" as those that they are: width, depth and height, unless only another
    order can be, or is far more usual of the kind."""
    kind = kind_of(parse)
    if kind is None or not parse.product:
        return parse
    form = kind.forms.get(parse.found.noun or "", kind.sizes)
    usual = dict(zip(AXES, (math.sqrt(low * high) for low, high in form), strict=True))

    def differ(axes: tuple[Axis, ...]) -> float:
        return sum(
            abs(math.log(length / usual[axis])) for axis, length in zip(axes, parse.product, strict=True)
        )

    spans = dict(zip(AXES, kind.sizes, strict=True))
    can = [axes for axes in ORDERS if _fit(spans, axes, parse.product)]
    best = min(can, key=differ, default=AXES)
    if AXES in can and differ(AXES) - differ(best) <= FAR_MORE_USUAL:
        return parse
    said = dict(zip(best, parse.product, strict=True))
    return parse.say(size=tuple((axis, said[axis]) for axis in AXES))


def read_volume(parse: Parse) -> Parse:
    """Reads "40 litres".

    Raises:
        TextError: If two volumes are given, or nothing.
    """
    for at in range(len(parse.words)):
        number = None if at in parse.used else read_number(parse.words, at)
        end = at if number is None else at + number[1]
        unit = VOLUMES.get(parse.words[end]) if end < len(parse.words) else None
        letter = end < len(parse.words) and parse.words[end] == "l"  # "an L-shaped desk"
        if number is None or unit is None or (letter and not parse.words[at][0].isdigit()):
            continue
        volume = number[0] * unit
        if parse.found.volume not in (None, volume) or volume <= 0:
            raise TextError(f"{1000 * volume:g} litres: expected one volume, more than 0")
        parse = parse.take(at, number[1] + 1).say(volume=volume)
    return parse


def read_bare_sizes(parse: Parse) -> Parse:
    """Reads lengths without a direction, "a 60 cm dishwasher", "1.2 m x 60 cm", "160 x 80", and directions
    whose numbers have no unit, "height 75, width 40": that in which the kind has such sizes."""
    kind, at = kind_of(parse), 0
    if kind is None:
        return parse
    words = parse.words
    while at < len(words):
        named = None if at in parse.used else _read_unitless(words, at, kind)
        if named is not None and named[0] not in dict(parse.found.size):
            parse = say_length(parse.take(at, named[2]), named[0], named[1])
            at += named[2]
            continue
        products = [] if at in parse.used else [_read_product(words, at), *_read_plain_product(words, at)]
        lengths, used = next((one for one in products if find_axes(kind, one[0]) is not None), ([], 0))
        axes = find_axes(kind, lengths)
        if len(lengths) == 1 and axes is not None and _is_tall(words, lengths[0], kind):
            axes = ("height",)
        if (
            not used
            or axes is None
            or _is_of_part(parse, at, at + used)
            or set(axes) & {axis for axis, *_ in (*parse.found.size, *parse.found.ranges)}
        ):
            at += 1
            continue
        span = read_length(words, at) if len(lengths) == 1 else None
        for axis, length in zip(axes, lengths, strict=True):
            parse = say_length(parse, axis, length) if span is None else say_range(parse, axis, span)
        parse = parse.take(at, used)
        at += used
    return parse


def _is_tall(words: tuple[str, ...], length: float, kind: Kind) -> bool:
    """Whether a single length (m) is the height of what is called tall."""
    low, high = dict(zip(AXES, kind.sizes, strict=True))["height"]
    return bool({"tall", "high", "highboy"} & set(words)) and low <= length <= high


def _is_of_part(parse: Parse, at: int, end: int) -> bool:
    """Whether a length without a direction belongs to something else than the object: it stands in a clause
    about parts, or beside the noun of one."""
    words = parse.words
    start = max((place + 1 for place in range(at) if words[place] == ","), default=0)
    beside = [place for place in (at - 1, end) if 0 <= place < len(words) and place not in parse.head]
    clause = any(words[place] in CLAUSES for place in range(start, at) if place not in parse.used)
    return clause or words[at] in ("a", "an") or any(words[place] in PARTS for place in beside)


def _read_product(words: tuple[str, ...], at: int) -> tuple[list[float], int]:
    """Lengths (m) of "80 cm" or "1.2 m x 60 cm", and the number of words; none without a unit."""
    first = read_length(words, at)
    if first is None:
        number = read_number(words, at)
        end = at + number[1] if number is not None else at
        crossed = number is not None and crosses(words, end)
        last = read_length(words, end + 1) if crossed else None
        if number is None or last is None:
            return [], 0
        unit = next(word for word in words[end + 1 : end + 1 + last.words][::-1] if word in UNITS)
        return [number[0] * UNITS[unit], last.metres], end + 1 + last.words - at
    end = at + first.words
    last = read_length(words, end + 1) if crosses(words, end) else None
    if last is None:
        return [first.metres], first.words
    return [first.metres, last.metres], end + 1 + last.words - at


def _read_plain_product(words: tuple[str, ...], at: int) -> list[tuple[list[float], int]]:
    """Lengths (m) of "160 x 80" or "40 x 35 x 30" in centimetres and in millimetres, and how many words."""
    numbers, end = [], at
    while end < len(words) and words[end][0].isdigit() and (number := read_number(words, end)) is not None:
        numbers.append(number[0])
        end += number[1]
        if len(numbers) == len(AXES) or not crosses(words, end):
            break
        end += 1
    if len(numbers) < 2 or words[end - 1] in ("x", "by"):
        return []
    return [([UNITS[unit] * number for number in numbers], end - at) for unit in ("cm", "mm")]


def find_axes(kind: Kind, lengths: Sequence[float]) -> tuple[Axis, ...] | None:
    """What lengths (m) without a direction measure: a single one what the record says, or else the width or
    height that has such a size; two the width and the depth, or else the height; three all.

    None where the kind has no such sizes.
    """
    spans = dict(zip(AXES, kind.sizes, strict=True))
    tall = kind.bare == "height" or (kind.trade == "appliance" and max(lengths, default=0.0) > WIDEST)
    single: tuple[Axis, ...] = ("height", "width") if tall else ("width", "height")
    orders: list[tuple[Axis, ...]] = [(axis,) for axis in single if kind.bare is not None]
    if len(lengths) == len(AXES):
        orders = [AXES]
    elif len(lengths) == 2:
        orders = [("width", "depth"), ("depth", "width"), ("width", "height")]
    return next((axes for axes in orders if lengths and _fit(spans, axes, lengths)), None)


def _fit(spans: Mapping[Axis, tuple[float, float]], axes: Sequence[Axis], lengths: Sequence[float]) -> bool:
    """Whether all lengths (m) along axes are within their ranges."""
    pairs = zip(axes, lengths, strict=True)
    return all(spans[axis][0] <= length <= spans[axis][1] for axis, length in pairs)


def _read_unitless(words: tuple[str, ...], at: int, kind: Kind) -> tuple[Axis, float, int] | None:
    """Axis, length (m) and number of words of "height 75", "75 high" or "height of 75"."""
    spans = dict(zip(AXES, kind.sizes, strict=True))
    place = at
    before = DIRECTIONS.get(words[at])
    if before is not None:
        place += 1 + (tuple(words[at + 1 : at + 2]) in (("of",), ("is",)))
    number = read_number(words, place) if place < len(words) and words[place][0].isdigit() else None
    if number is None:
        return None
    end = place + number[1]
    after = DIRECTIONS.get(words[end]) if end < len(words) else None
    axis = before or after
    letter = len(words[at] if before else words[end] if axis else "") == 1
    if letter and len({"w", "d", "h"} & set(words)) < 2:
        return None  # "700 W"
    if axis is None or (end < len(words) and words[end] in UNITS):
        return None
    end += before is None
    given = words[end] if end < len(words) and words[end] in UNITS else None
    whole = number[0] == int(number[0])
    for unit in ("cm", "mm", *(() if whole else ("m",))) if given is None else (given,):
        length = number[0] * UNITS[unit]
        if spans[axis][0] <= length <= spans[axis][1]:
            return axis, length, end + (given is not None) - at
    return None
