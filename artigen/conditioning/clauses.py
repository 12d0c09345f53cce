"""Reads the parts of a sentence one after the other: lengths, the kind, features, style, counts, colours."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from artigen.conditioning.colors import read_finishes
from artigen.conditioning.nouns import find_head
from artigen.conditioning.numbers import read_count, read_length, read_number, split_words
from artigen.conditioning.places import Group, find_places, starts_spot
from artigen.conditioning.sentence import OBJECT, Placing, Sentence, TextError
from artigen.conditioning.vocabulary import (
    ADJECTIVES,
    AXES,
    BARE,
    CLAUSES,
    DIRECTIONS,
    FEATURES,
    FILLERS,
    GLAZED,
    GRIDS,
    LEGS,
    LEVEL,
    MATERIALS,
    PAINTS,
    PART_NOUNS,
    PARTS,
    PIECES,
    SCALES,
    SHADES,
    STYLES,
    UNITS,
    Axis,
    Feature,
)
from artigen.kind import EVERY, NONE, Kind, kinds
from artigen.types import PART_LABELS, PartLabel

BETWEEN = 3
"""Largest number of words between a number and its part: "three wide white oak drawers"."""
LONGEST = 5
"""Words of the longest phrase of features."""
COMPARED = 4
"""Number of words between "than" or "as" and an adjective: "wider than it is tall"."""
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
    for read in (_read_sizes, _read_kind, _read_style, _read_features, _read_counts, _read_objects,
                 _read_bare_sizes, _read_colors, _read_adjectives, _read_parts):  # fmt: skip
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
    spelled = " ".join(reading.words[head.at : head.at + head.count])
    singular = {many: one for one, many in head.kind.nouns.items()}
    return replace(reading.take(head.at, head.count), head=range(head.at, head.at + head.count)).say(
        kind=head.kind.name, noun=singular.get(spelled, spelled)
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
            if style == NONE:
                raise TextError(
                    f"{' '.join(words[at : at + count])!r}: no {next(iter(kind.nouns))} ({kind.name}) of "
                    "ours is that; leave it out"
                )
            if style == EVERY:
                reading = reading.take(at, count)
                break
            if reading.found.style in SCALES:  # "a large leather suitcase" has the style of leather
                first = words.index(reading.found.style)
                reading = replace(reading, used=reading.used - {first}).say(style=None)
            if reading.found.style not in (None, style) and words[at] in MATERIALS:
                break  # a double door of glass
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
            label = PARTS.get(words[at - 1]) if at and feature == LEVEL else None
            if label not in (None, "door"):  # "two drawers side by side"
                feature = (str(label), "rows", "1")
            reading = _say_features(reading, (feature,))
            style = STYLES.get(feature)
            if kind is not None and style in kind.styles and reading.found.style is None:
                reading = reading.say(style=style)
            break
    return reading


def _read_counts(reading: Reading) -> Reading:
    """Reads numbers of parts and their places: "three wide drawers over two doors", "no handles or knobs"."""
    words, at = reading.words, 0
    groups: list[Group] = []
    while at < len(words):
        group = _read_group(reading, at) or _read_rest(reading, at, groups)
        if group is None or (at in reading.used and group.counted):
            at += 1
            continue
        if group.counted:
            named = group.end - 1 if words[group.end - 1] in PARTS else at  # "two on each side" has no noun
            reading = reading.take(named).take(at, group.counted)
        groups.append(group)
        while group.count == 0 and words[group.end : group.end + 1] in (("or",), ("nor",), ("and",)):
            after = group.end + 1
            if after >= len(words) or words[after] not in PARTS:
                break
            group = Group(start=after, end=after + 1, label=PARTS[words[after]], count=0)
            reading = reading.take(after)
            groups.append(group)
        at = group.end
    articles = {group.label for group in groups if group.counted == 1 and words[group.start] in ("a", "an")}
    reading = reading.say(articles=tuple(sorted(articles)))
    places = find_places(words, groups, reading.used)
    reading = _say_features(replace(reading, used=places.used), places.features)
    for label in PART_LABELS:
        own = [group for group in places.groups if group.label == label and group.count is not None]
        placed = [group for group in own if group.at is not None]
        apart = len({group.at for group in placed}) > 1  # two on the left and three on the right
        for group in own:
            if not (apart and group.at):
                reading = _say_count(reading, label, group.count or 0)
        total = sum(group.count or 0 for group in placed)
        held = dict(reading.found.counts).get(label, total)
        if apart and total > held:
            raise TextError(
                f"{held} parts called {label} are asked for, and places for {total}; give one number"
            )
        reading = _say_count(reading, label, held) if apart else reading
    placings = (
        Placing(label=group.label, count=group.count, at=group.at)
        for group in places.groups
        if group.at is not None and group.count != 0
    )
    return reading.say(places=tuple(placings))


def _read_group(reading: Reading, at: int) -> Group | None:
    """The parts that are named from a place on, after their number or without one."""
    words = reading.words
    number = read_count(words, at)
    if number is None:
        named = words[at] in PARTS and at not in reading.head
        return Group(start=at, end=at + 1, label=PARTS[words[at]], count=None) if named else None
    end = at + number[1]
    if (
        end + 2 < len(words) and words[end] in GRIDS and words[end + 1] == "of"
    ):  # "two columns of three drawers"
        each = _read_group(reading, end + 2)
        if each is None:
            return None
        grid = (GRIDS[words[end]], str(number[0]))
        counted = end + 2 + each.counted - at
        total = None if each.count is None else number[0] * each.count
        return replace(each, start=at, count=total, counted=counted, grid=grid)
    place = _find_part(reading, end)
    article = words[at] in ("a", "an") and place in reading.head  # "a drawer unit"
    if place is None or article or (number[0] == 1 and words[place] not in PART_NOUNS):
        return None
    return Group(start=at, end=place + 1, label=PARTS[words[place]], count=number[0], counted=number[1])


def _read_rest(reading: Reading, at: int, groups: Sequence[Group]) -> Group | None:
    """Some of the parts that were named before: "four drawers, two on each side"."""
    number = read_count(reading.words, at)
    end = at if number is None else at + number[1]
    while end < len(reading.words) and reading.words[end] in {*ADJECTIVES, *SCALES}:  # "two small on top"
        end += 1
    if number is None or not groups or not starts_spot(reading.words, end):
        return None
    return Group(start=at, end=end, label=groups[-1].label, count=number[0], counted=number[1])


def _say_features(reading: Reading, features: Sequence[Feature]) -> Reading:
    return reading.say(features=tuple(dict.fromkeys((*reading.found.features, *features))))


def _find_part(reading: Reading, start: int) -> int | None:
    """Place of the part that a number counts."""
    for place in range(start, min(start + BETWEEN + 1, len(reading.words))):
        word = reading.words[place]
        counts_head = place == reading.head.start and len(reading.head) > 1 and word in PARTS
        if counts_head:  # "a five-drawer chest"
            return place
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


def _read_objects(reading: Reading) -> Reading:
    """Reads how many objects are wanted: "three white cabinets", "a pair of ovens"."""
    head, words = reading.head, reading.words
    kind = _kind_of(reading)
    if kind is None or " ".join(words[head.start : head.stop]) not in kind.nouns.values():
        return reading
    for at in range(head.start):
        number = None if at in reading.used else read_count(words, at)
        if number is not None and number[0] > 1 and "," not in words[at : head.start]:
            return reading.take(at, number[1]).say(objects=number[0])
    return reading


def _read_bare_sizes(reading: Reading) -> Reading:
    """Reads lengths without a direction, "a 60 cm dishwasher", "1.2 m x 60 cm", and directions whose numbers
    have no unit, "height 75, width 40": that in which the kind has such sizes."""
    kind, at = _kind_of(reading), 0
    if kind is None:
        return reading
    words = reading.words
    while at < len(words):
        named = None if at in reading.used else _read_unitless(words, at, kind)
        if named is not None and named[0] not in dict(reading.found.size):
            reading = _say_length(reading.take(at, named[2]), named[0], named[1])
            at += named[2]
            continue
        lengths, used = ([], 0) if at in reading.used else _read_product(words, at)
        axes = find_axes(kind, lengths)
        if (
            not used
            or axes is None
            or _is_of_part(reading, at, at + used)
            or set(axes) & {axis for axis, _ in reading.found.size}
        ):
            at += 1
            continue
        for axis, length in zip(axes, lengths, strict=True):
            reading = _say_length(reading, axis, length)
        reading = reading.take(at, used)
        at += used
    return reading


def _is_of_part(reading: Reading, at: int, end: int) -> bool:
    """Whether a length without a direction belongs to something else than the object: it stands in a clause
    about parts, or beside the noun of one."""
    words = reading.words
    start = max((place + 1 for place in range(at) if words[place] == ","), default=0)
    beside = [place for place in (at - 1, end) if 0 <= place < len(words) and place not in reading.head]
    clause = any(words[place] in CLAUSES for place in range(start, at) if place not in reading.used)
    return clause or words[at] in ("a", "an") or any(words[place] in PARTS for place in beside)


def _read_product(words: tuple[str, ...], at: int) -> tuple[list[float], int]:
    """Lengths (m) of "80 cm" or "1.2 m x 60 cm", and the number of words; none without a unit."""
    first = read_length(words, at)
    if first is None:
        number = read_number(words, at)
        end = at + number[1] if number is not None else at
        crossed = number is not None and tuple(words[end : end + 1]) in (("x",), ("by",))
        last = read_length(words, end + 1) if crossed else None
        if number is None or last is None:
            return [], 0
        unit = next(word for word in words[end + 1 : end + 1 + last[1]][::-1] if word in UNITS)
        return [number[0] * UNITS[unit], last[0]], end + 1 + last[1] - at
    end = at + first[1]
    last = read_length(words, end + 1) if tuple(words[end : end + 1]) in (("x",), ("by",)) else None
    return ([first[0]], first[1]) if last is None else ([first[0], last[0]], end + 1 + last[1] - at)


def find_axes(kind: Kind, lengths: Sequence[float]) -> tuple[Axis, ...] | None:
    """What lengths (m) without a direction measure: a single one the width of furniture and appliances, and
    of others what their kind is measured by; two the width and the depth, or else the height.

    None where the kind has no such sizes.
    """
    spans = dict(zip(AXES, kind.sizes, strict=True))
    tall = kind.trade not in ("furniture", "appliance") and {rule.extent for rule in kind.size} == {"height"}
    single: tuple[Axis, ...] = ("height", "width") if tall else ("width", "height")
    orders: list[tuple[Axis, ...]] = [(axis,) for axis in single]
    if len(lengths) == 2:
        orders = [("width", "depth"), ("depth", "width"), ("width", "height")]
    for axes in orders if lengths else ():
        if all(
            spans[axis][0] <= length <= spans[axis][1] for axis, length in zip(axes, lengths, strict=True)
        ):
            return axes
    return None


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


def _read_colors(reading: Reading) -> Reading:
    colors, materials, used = read_finishes(reading.words, reading.used, reading.head)
    kind, glazed = _kind_of(reading), STYLES[GLAZED]
    if kind is not None and dict(materials).get(OBJECT) == "glass" and glazed in kind.styles:
        materials = tuple(pair for pair in materials if pair[0] != OBJECT)  # a glass cabinet has glass doors
        reading = _say_features(reading, (GLAZED,)).say(style=reading.found.style or glazed)
    return replace(reading, used=used).say(colors=colors, materials=materials)


def _read_adjectives(reading: Reading) -> Reading:
    """Reads "tall" and the like where they describe the whole object."""
    for at, word in enumerate(reading.words):
        counted = at > 0 and reading.words[at - 1][0].isdigit()
        compared = bool({"than", "as"} & set(reading.words[max(0, at - COMPARED) : at]))
        if (
            word not in ADJECTIVES
            or at in reading.used
            or counted
            or compared
            or _describes_part(reading, at)
        ):
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
        if reading.words[place] in PARTS or starts_spot(reading.words, place):
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
            opened = at > 0 and reading.words[at - 1] == "open" and PARTS[word] == "shelf"
            reading = reading.take(at - 1, 2) if opened else reading.take(at)
            labels.add(PARTS[word])
        elif PIECES.get(word) in dict((*reading.found.colors, *reading.found.materials)):
            reading = reading.take(at)
        if word in LEGS and at not in reading.head:
            reading = _say_legs(reading, at)
    bare = BARE in reading.found.features
    some = tuple(
        sorted(label for label in labels if label not in counted and not (bare and label == "handle"))
    )
    if bare and "handle" not in counted:
        reading = _say_count(reading, "handle", 0)
    return reading.say(some=some)


def _say_legs(reading: Reading, at: int) -> Reading:
    """Legs or feet that are named, with their number before them: the object stands on legs."""
    number = next(
        (place for place in (at - 1, at - 2) if place >= 0 and place not in reading.used
         and read_number(reading.words, place) is not None),
        None,
    )  # fmt: skip
    reading = reading.take(at) if number is None else reading.take(at).take(number)
    if any(part == "stand" for part, *_ in reading.found.features):
        return reading
    return _say_features(reading, (("stand", "type", "legs"),))


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
