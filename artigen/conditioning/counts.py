"""Reads the numbers of a sentence: of parts, with their places, and of objects."""

from collections.abc import Sequence
from dataclasses import replace

from artigen.conditioning.colors import is_compound, is_noun
from artigen.conditioning.measures import ADJECTIVES, SCALES
from artigen.conditioning.numbers import crosses, read_count, read_number
from artigen.conditioning.paints import PANES
from artigen.conditioning.parse import BETWEEN, Parse, kind_of, say_count, say_features
from artigen.conditioning.places import Group, find_places, match_relation, starts_spot
from artigen.conditioning.sentence import Placing, TextError
from artigen.conditioning.vocabulary import GRIDS, ONES, PART_NOUNS, PARTS
from artigen.kind import find_noun
from artigen.types import PART_LABELS


def read_counts(parse: Parse) -> Parse:
    """Reads numbers of parts and their places: "three wide drawers over two doors", "no handles or knobs"."""
    words, at = parse.words, 0
    groups: list[Group] = []
    while at < len(words):
        group = _read_group(parse, at) or _read_rest(parse, at, groups)
        if group is None or (at in parse.used and group.counted):
            at += 1
            continue
        if group.counted:
            noun = words[group.end - 1] in {*PARTS, *ONES}
            named = group.end - 1 if noun else at  # "two on each side" has no noun
            parse = parse.take(named).take(at, group.counted)
        groups.append(group)
        while group.count == 0 and words[group.end : group.end + 1] in (("or",), ("nor",), ("and",)):
            after = group.end + 1
            if after >= len(words) or words[after] not in PARTS:
                break
            group = Group(start=after, end=after + 1, label=PARTS[words[after]], count=0)
            parse = parse.take(after)
            groups.append(group)
        at = group.end
    articles = {group.label for group in groups if group.counted == 1 and words[group.start] in ("a", "an")}
    parse = parse.say(articles=tuple(sorted(articles)))
    places = find_places(words, groups, parse.used)
    parse = say_features(replace(parse, used=places.used), places.features)
    for label in PART_LABELS:
        own = [group for group in places.groups if group.label == label and group.count is not None]
        numbers = [group for group in own if words[group.start] not in ("a", "an") or group.at is not None]
        own = numbers or own  # "a drawer pedestal with three drawers"
        placed = [group for group in own if group.at is not None]
        spots = {group.at for group in placed}
        apart = len(spots) > 1 or (len(spots) == 1 < len(own))  # "three drawers, one of them on top"
        added = apart and own[0].at is not None  # "two doors above three drawers, and two doors"
        for group in own:
            if not added and not (apart and group.at):
                parse = say_count(parse, label, group.count or 0)
        total = sum(group.count or 0 for group in (own if added else placed))
        held = dict(parse.found.counts).get(label, total)
        if apart and total > held:
            raise TextError(
                f"{held} parts called {label} are asked for, and places for {total}; give one number"
            )
        parse = say_count(parse, label, held) if apart else parse
    placings = [
        Placing(label=group.label, count=group.count, at=group.at, pane=_is_glazed(words, group))
        for group in places.groups
        if group.at is not None and group.count != 0
    ]
    return parse.say(places=tuple(placings))


def _is_glazed(words: tuple[str, ...], group: Group) -> bool:
    return group.label == "door" and bool(PANES & set(words[max(0, group.start - 1) : group.end]))


def _read_group(parse: Parse, at: int) -> Group | None:
    """The parts that are named from a place on, after their number or without one."""
    words = parse.words
    number = read_count(words, at)
    if number is None:
        if words[at] not in PARTS or at in parse.head or is_compound(words, at):
            return None
        count = _read_after(words, at + 1)
        counted = 0 if count is None else 2
        return Group(start=at, end=at + 1, label=PARTS[words[at]], count=count, counted=counted)
    end = at + number[1]
    if number[0] == 0 and words[end : end + 1] in (("a",), ("an",), ("any",)):  # "without a lid"
        number, end = (0, number[1] + 1), end + 1
    if (
        end + 2 < len(words) and words[end] in GRIDS and words[end + 1] == "of"
    ):  # "two columns of three drawers"
        each = _read_group(parse, end + 2)
        if each is None:
            return None
        grid = (GRIDS[words[end]], str(number[0]))
        counted = end + 2 + each.counted - at
        total = None if each.count is None else number[0] * each.count
        return replace(each, start=at, count=total, counted=counted, grid=grid)
    crossed = read_number(words, end + 1) if crosses(words, end) else None
    named = crossed is not None and words[end + 2 : end + 3] and words[end + 2] in PARTS
    if crossed is not None and named and end + 3 not in parse.head:
        total = number[0] * int(crossed[0])  # "2 x 3 drawers"
        return Group(start=at, end=end + 3, label=PARTS[words[end + 2]], count=total, counted=end + 2 - at)
    after = match_relation(words, end)
    second = None if after is None else _read_group(parse, after)
    if second is not None and second.counted:  # "3 over 4 drawers"
        return Group(start=at, end=end, label=second.label, count=number[0], counted=number[1])
    place = _find_part(parse, end)
    if place is not None and number[0] > 1 and words[place] in PART_NOUNS and is_noun(words, end):
        return None  # "a 250-sheet tray"
    if place is None or (number[0] == 1 and words[place] not in PART_NOUNS):
        return None
    if words[at] in ("a", "an") and (place in parse.head or place + 1 in parse.head):
        return None  # "a drawer unit", "a glass-door cabinet"
    follows = words[place + 1 : place + 2]
    if follows and place not in parse.head and find_noun(f"{words[place]} {follows[0]}") is not None:
        return None  # "one drawer unit"
    each = words[place + 2 : place + 3] == ("each",) and not starts_spot(words, place + 1)
    if words[at] in ("a", "an") and each:  # "a handle on each door"
        return Group(start=at, end=place + 1, label=PARTS[words[place]], count=None)
    return Group(start=at, end=place + 1, label=PARTS[words[place]], count=number[0], counted=number[1])


def _read_rest(parse: Parse, at: int, groups: Sequence[Group]) -> Group | None:
    """Some of the parts that were named before: "four drawers, two on each side"."""
    words, number = parse.words, read_count(parse.words, at)
    if number is None or not groups:
        return None
    end, label = at + number[1], groups[-1].label
    each = read_count(words, end + 2) if tuple(words[end + 1 : end + 2]) == ("of",) else None
    if each is not None and words[end] in GRIDS:  # "twelve drawers, three columns of four"
        counted = end + 2 + each[1] - at
        grid = (GRIDS[words[end]], str(number[0]))
        return Group(
            start=at, end=at + counted, label=label, count=number[0] * each[0], counted=counted, grid=grid
        )
    if words[end : end + 2] in (("of", "them"), ("of", "which"), ("of", "these")):
        end += 2
    while end < len(words) and words[end] in {*ADJECTIVES, *SCALES}:  # "two small on top"
        end += 1
    related = match_relation(words, end) or (
        groups[-1].end < at and match_relation(words, groups[-1].end) == at
    )
    again = end < len(words) and words[end] in ONES and words[at] not in ONES  # "two small ones"
    if not again and not related and not starts_spot(words, end):
        return None
    return Group(start=at, end=end + again, label=label, count=number[0], counted=number[1])


def _read_after(words: tuple[str, ...], at: int) -> int | None:
    """The number that follows its part: "doors: 2, drawers: 1"."""
    if at >= len(words) or not words[at].isdigit() or (at > 1 and read_number(words, at - 2) is not None):
        return None
    ends = at + 1 == len(words) or words[at + 1] in {",", "and", "with", *PARTS}
    return int(words[at]) if ends else None


def _find_part(parse: Parse, start: int) -> int | None:
    """Place of the part that a number counts."""
    for place in range(start, min(start + BETWEEN + 1, len(parse.words))):
        word = parse.words[place]
        counts_head = place == parse.head.start and len(parse.head) > 1 and word in PARTS
        if counts_head:  # "a five-drawer chest"
            return place
        if place in parse.head or word in (",", "with", "and") or read_number(parse.words[place:], 0):
            return None
        if word in PARTS:
            return None if is_compound(parse.words, place) else place
    return None


def read_objects(parse: Parse) -> Parse:
    """Reads how many objects are wanted: "three white cabinets", "a pair of ovens"."""
    head, words = parse.head, parse.words
    kind = kind_of(parse)
    if kind is not None and words[head.stop : head.stop + 1] == ("pair",):
        return parse.take(head.stop).say(objects=2)
    spelled = {" ".join(words[at : head.stop]) for at in head}
    if kind is None or not spelled & set(kind.nouns.values()):
        return parse
    for at in range(head.start):
        number = None if at in parse.used else read_count(words, at)
        if number is not None and number[0] > 1 and not {",", "of"} & {*words[at + number[1] : head.start]}:
            return parse.take(at, number[1]).say(objects=number[0])
    return parse
