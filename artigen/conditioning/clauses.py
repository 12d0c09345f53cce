"""Reads the parts of a sentence one after the other: lengths, the kind, features, style, counts, colours."""

from dataclasses import dataclass, field, replace

from artigen.conditioning.colors import read_finishes
from artigen.conditioning.nouns import find_head
from artigen.conditioning.numbers import read_length, read_number, split_words
from artigen.conditioning.sentence import Sentence, TextError
from artigen.conditioning.vocabulary import (
    ADJECTIVES,
    AXES,
    BARE,
    DIRECTIONS,
    FEATURES,
    FILLERS,
    PAINTS,
    PART_NOUNS,
    PARTS,
    PIECES,
    SCALES,
    SHADES,
    STYLES,
    UNITS,
    Axis,
)
from artigen.kind import Kind, kinds
from artigen.types import PartLabel

BETWEEN = 3
"""Largest number of words between a number and its part: "three wide white oak drawers"."""
LONGEST = 5
"""Words of the longest phrase of features."""
FURTHEST = 10.0
"""Largest length (m) of a number without a unit, which has that of the number before."""


@dataclass(frozen=True, kw_only=True)
class Reading:
    """Words of a sentence, those that are read, and what they say so far."""

    words: tuple[str, ...]
    used: frozenset[int] = frozenset()
    whole: bool = True
    """Whether the sentence must name a kind."""
    head: range = range(0)
    """Words of the noun that names the kind."""
    found: Sentence = field(default_factory=Sentence)

    def take(self, at: int, count: int = 1) -> "Reading":
        """The reading with words marked as read."""
        return replace(self, used=self.used | set(range(at, at + count)))

    def say(self, **said: object) -> "Reading":
        """The reading with more content."""
        return replace(self, found=replace(self.found, **said))


def read_clauses(text: str, *, whole: bool = True) -> Sentence:
    """Everything that a sentence says, without a check of sizes; if it is not ``whole``, a door is a part.

    Raises:
        TextError: If it names two kinds, or gives a number, length, style or colour twice.
    """
    reading = Reading(words=split_words(text), whole=whole)
    for read in (_read_sizes, _read_kind, _read_style, _read_features, _read_counts, _read_colors,
                 _read_adjectives, _read_parts):  # fmt: skip
        reading = read(reading)
    return replace(reading.found, ignored=_list_ignored(reading))


def _read_sizes(reading: Reading) -> Reading:
    """Reads "1.2 m wide", "80 cm in width", "width of 80 cm", "60 x 55 x 85 cm", and "80 deep" after a
    length with a unit."""
    words, at, unit = reading.words, 0, None
    while at < len(words):
        triple = _read_triple(words, at)
        if triple is not None:
            for axis, length in zip(AXES, triple[0], strict=True):
                reading = _say_length(reading, axis, length)
            reading = reading.take(at, triple[1])
            at += triple[1]
            continue
        length = read_length(words, at)
        number = read_number(words, at)
        if length is not None:
            unit = next(word for word in words[at : at + length[1]][::-1] if word in UNITS)
        elif number is not None and unit is not None and words[at][0].isdigit():
            bare = number[0] * UNITS[unit]
            length = (bare, number[1]) if bare <= FURTHEST else None
        named = None if length is None else _find_direction(words, at, length[1])
        if length is None or named is None:
            at += 1
            continue
        axis, start, end = named
        reading = _say_length(reading.take(start, end - start), axis, length[0])
        at = end
    return reading


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
        if place and tuple(words[end : end + 1]) not in (("x",), ("by",)):
            return None
        end += place > 0
        number = read_number(words, end)
        if number is None or not words[end][0].isdigit():
            return None
        end += number[1]
        unit = words[end] if end < len(words) and words[end] in UNITS else None
        numbers.append((number[0], unit))
        end += unit is not None
    last = numbers[-1][1]
    if last is None:
        return None
    return [value * UNITS[unit or last] for value, unit in numbers], end - at


def _say_length(reading: Reading, axis: Axis, length: float) -> Reading:
    known = dict(reading.found.size)
    if abs(known.get(axis, length) - length) > 1e-9:
        raise TextError(f"{axis} is {known[axis]:g} m and {length:g} m; give it once")
    if length <= 0:
        raise TextError(f"{axis} is {length:g} m, expected more than 0")
    sizes = {**known, axis: length}
    return reading.say(size=tuple((axis, sizes[axis]) for axis in AXES if axis in sizes))


def _read_kind(reading: Reading) -> Reading:
    head = find_head(reading.words, reading.used, whole=reading.whole)
    if head is None:
        return reading
    return replace(reading.take(head.at, head.count), head=range(head.at, head.at + head.count)).say(
        kind=head.kind.name
    )


def _kind_of(reading: Reading) -> Kind | None:
    return None if reading.found.kind is None else kinds()[reading.found.kind]


def _read_style(reading: Reading) -> Reading:
    """Reads styles of the kind by their names and other words; colours are never styles."""
    kind = _kind_of(reading)
    if kind is None:
        return reading
    words = reading.words
    named = {style.replace("_", " "): style for style in kind.styles} | dict(kind.style_words)
    named = {word: style for word, style in named.items() if word not in PAINTS and word != "steel"}
    for at in range(len(words)):
        for count in (3, 2, 1):
            style = named.get(" ".join(words[at : at + count]))
            inside = at in reading.head and at + count - 1 in reading.head
            if style is None or (at in reading.used and not inside):
                continue
            if words[at] in SHADES and at + 1 < len(words) and words[at + 1] in PAINTS:
                continue
            if words[at] in SCALES and at not in reading.head and reading.found.style is not None:
                continue
            if reading.found.style in SCALES:  # "a large leather suitcase" has the style of leather
                first = words.index(reading.found.style)
                reading = replace(reading, used=reading.used - {first}).say(style=None)
            if reading.found.style not in (None, style):
                raise TextError(f"styles {reading.found.style} and {style} are asked for; name one")
            reading = reading.take(at, count).say(style=style)
            break
    return reading


def _read_features(reading: Reading) -> Reading:
    """Reads phrases such as "bottom freezer" and "hinged on the left"; some are styles of the kind."""
    words, kind = reading.words, _kind_of(reading)
    for at in range(len(words)):
        for count in range(LONGEST, 0, -1):
            feature = FEATURES.get(" ".join(words[at : at + count]))
            if feature is None or set(range(at, at + count)) <= reading.used:
                continue
            reading = reading.take(at, count)
            reading = reading.say(features=tuple(dict.fromkeys((*reading.found.features, feature))))
            style = STYLES.get(feature)
            if kind is not None and style in kind.styles and reading.found.style is None:
                reading = reading.say(style=style)
            break
    return reading


def _read_counts(reading: Reading) -> Reading:
    """Reads numbers of parts: "three wide oak drawers", "no handles or knobs"."""
    words, at = reading.words, 0
    while at < len(words):
        number = None if at in reading.used else read_number(words, at)
        if number is None or number[0] != int(number[0]):
            at += 1
            continue
        place = _find_part(reading, at + number[1])
        if place is None or (number[0] == 1 and words[place] not in PART_NOUNS):
            at += 1
            continue
        reading = _say_count(reading.take(at, number[1]).take(place), PARTS[words[place]], int(number[0]))
        while number[0] == 0 and words[place + 1 : place + 2] in (("or",), ("nor",), ("and",)):
            after = place + 2
            if after >= len(words) or words[after] not in PARTS:
                break
            reading, place = _say_count(reading.take(after), PARTS[words[after]], 0), after
        at = place + 1
    return reading


def _find_part(reading: Reading, start: int) -> int | None:
    """Place of the part that a number counts."""
    for place in range(start, min(start + BETWEEN + 1, len(reading.words))):
        word = reading.words[place]
        if place in reading.head or word in (",", "with", "and") or read_number(reading.words[place:], 0):
            return None
        if word in PARTS:
            return place
    return None


def _say_count(reading: Reading, label: PartLabel, count: int) -> Reading:
    known = dict(reading.found.counts)
    if known.get(label, count) != count:
        raise TextError(f"{known[label]} and {count} parts called {label} are asked for; give one number")
    return reading.say(counts=tuple(sorted({**known, label: count}.items())))


def _read_colors(reading: Reading) -> Reading:
    colors, materials, used = read_finishes(reading.words, reading.used, reading.head)
    return replace(reading, used=used).say(colors=colors, materials=materials)


def _read_adjectives(reading: Reading) -> Reading:
    """Reads "tall" and the like where they describe the whole object."""
    for at, word in enumerate(reading.words):
        counted = at > 0 and reading.words[at - 1][0].isdigit()
        if word not in ADJECTIVES or at in reading.used or counted or _describes_part(reading, at):
            continue
        axis, factor = ADJECTIVES[word]
        known = dict(reading.found.stretch)
        if known.get(axis, factor) != factor:
            raise TextError(f"{word!r} contradicts an earlier word about the {axis}")
        reading = reading.take(at).say(stretch=tuple(sorted({**known, axis: factor}.items())))
    for at, word in enumerate(reading.words):
        if word in SCALES and at not in reading.used and not _describes_part(reading, at):
            stretch = {**dict.fromkeys(AXES, SCALES[word]), **dict(reading.found.stretch)}
            reading = reading.take(at).say(stretch=tuple(sorted(stretch.items())))
    return reading


def _describes_part(reading: Reading, at: int) -> bool:
    """Whether the next noun after an adjective is a part."""
    for place in range(at + 1, min(at + 2 + BETWEEN, len(reading.words))):
        if place in reading.head or reading.words[place] == ",":
            return False
        if reading.words[place] in PARTS:
            return True
    return False


def _read_parts(reading: Reading) -> Reading:
    """Parts that are named, coloured or described without a number."""
    counted = dict(reading.found.counts)
    labels: set[PartLabel] = {PARTS[part] for part, *_ in reading.found.features if part in PARTS}
    labels |= {
        PARTS[target] for target, _ in (*reading.found.colors, *reading.found.materials) if target in PARTS
    }
    for at, word in enumerate(reading.words):
        if word in PARTS and at not in reading.head:
            reading = reading.take(at)
            labels.add(PARTS[word])
        elif PIECES.get(word) in dict((*reading.found.colors, *reading.found.materials)):
            reading = reading.take(at)
    bare = BARE in reading.found.features
    some = tuple(
        sorted(label for label in labels if label not in counted and not (bare and label == "handle"))
    )
    if bare and "handle" not in counted:
        reading = _say_count(reading, "handle", 0)
    return reading.say(some=some)


def _list_ignored(reading: Reading) -> tuple[str, ...]:
    """Words that say something which is not understood; neighbours form a phrase with a number and a unit."""
    lost: list[str] = []
    at, words = 0, reading.words
    while at < len(words):
        length = None if at in reading.used else read_length(words, at)
        if length is not None and words[at] not in FILLERS:
            lost.append(" ".join(words[at : at + length[1]]))
            at += length[1]
            continue
        known = at in reading.used or words[at] in FILLERS or words[at] == ","
        lost += [] if known else [words[at]]
        at += 1
    return tuple(lost)
