"""Finds where the parts of a sentence are: above and below each other, at a side, in rows or columns."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from artigen.conditioning.numbers import read_count
from artigen.conditioning.vocabulary import (
    EDGES,
    FILLERS,
    GRIDS,
    PART_NOUNS,
    RELATIONS,
    SPOTS,
    Feature,
    Spot,
    count_longest,
)
from artigen.types import PartLabel

LONGEST = count_longest((*SPOTS, *RELATIONS))
"""Words of the longest phrase of a place."""


@dataclass(frozen=True, kw_only=True)
class Group:
    """Parts that are named together: their first word, the first word after them, and how many they are."""

    start: int
    end: int
    label: PartLabel
    count: int | None
    """None where no number is given."""
    at: Spot | None = None
    grid: tuple[str, str] | None = None
    """Rows or columns, and how many there are, in digits."""
    counted: int = 0
    """Words of the number, from the first word on."""


@dataclass(frozen=True, kw_only=True)
class Places:
    """Groups with their places, what is said of their rows and columns, and the words that say it."""

    groups: tuple[Group, ...]
    features: tuple[Feature, ...]
    used: frozenset[int]


def find_places(words: tuple[str, ...], groups: Sequence[Group], used: frozenset[int]) -> Places:
    """Reads "one drawer over two doors", "doors on the left", "six drawers in two columns".

    Args:
        words: Words of the sentence.
        groups: Parts in the order of the words.
        used: Places of words that mean something else.
    """
    placed, features, read = list(groups), [], set(used)
    for index, group in enumerate(placed):
        following = placed[index + 1] if index + 1 < len(placed) else None
        relation = None if following is None else _match(words, group.end, RELATIONS, read)
        if relation is not None and following is not None and _joins(words, relation[2], following):
            first, second = RELATIONS[relation[0]]
            before = "middle" if group.at is not None and group.at != first else first
            placed[index : index + 2] = [replace(group, at=before), replace(following, at=second)]
            read |= set(range(*relation[1:]))
            continue
        grid = _read_grid(words, group, read)
        if grid is not None:
            group = placed[index] = replace(group, grid=grid[0], end=max(grid[1]) + 1)
            read |= grid[1]
        if group.grid is not None:
            features.append((group.label, *group.grid))
        spot = None if group.at is not None else _read_spot(words, placed, index, read)
        if spot is not None:
            each = group.count is not None and bool({"each", "either", "per"} & {words[at] for at in spot[1]})
            placed[index] = replace(group, at=spot[0], count=2 * (group.count or 0) if each else group.count)
            read |= spot[1]
    if placed and not features:
        spread = _find_grid(words, max(placed, key=lambda group: group.count or 0), read)
        features += [] if spread is None else [spread[0]]
        read |= set() if spread is None else spread[1]
    return Places(groups=tuple(placed), features=tuple(features), used=frozenset(read))


def _find_grid(words: tuple[str, ...], group: Group, used: set[int]) -> tuple[Feature, set[int]] | None:
    """Rows or columns that are named apart from their parts: "a six-drawer dresser, two columns"."""
    for at in range(len(words)):
        number = None if at in used else read_count(words, at)
        end = at if number is None else at + number[1]
        if number is not None and number[0] > 1 and end < len(words) and words[end] in GRIDS:
            return (group.label, GRIDS[words[end]], str(number[0])), set(range(at, end + 1))
    return None


def _match(
    words: tuple[str, ...], at: int, table: dict[str, Spot] | dict[str, tuple[Spot, Spot]], used: set[int]
) -> tuple[str, int, int] | None:
    """The longest phrase of a table from a place on, fillers before it aside: it, its first and last + 1."""
    while True:
        for count in range(LONGEST, 0, -1):
            phrase = " ".join(words[at : at + count])
            if phrase in table and at + count <= len(words) and not used & set(range(at, at + count)):
                return phrase, at, at + count
        if at >= len(words) or words[at] not in ("is", "are", "that", "which", "placed", "arranged", "all"):
            return None
        at += 1


def _joins(words: tuple[str, ...], end: int, following: Group) -> bool:
    """Whether nothing but articles is between the end of a relation and the next group."""
    return all(word in FILLERS and word != "and" for word in words[end : following.start])


def match_relation(words: tuple[str, ...], at: int) -> int | None:
    """The end of a phrase such as "above" that begins at a place before a number; None without one."""
    phrase = _match(words, at, RELATIONS, set())
    return None if phrase is None or read_count(words, phrase[2]) is None else phrase[2]


def starts_spot(words: tuple[str, ...], at: int) -> bool:
    """Whether a phrase such as "on each side" begins at a place."""
    return any(" ".join(words[at : at + count]) in SPOTS for count in range(1, LONGEST + 1))


def _read_spot(
    words: tuple[str, ...], groups: Sequence[Group], index: int, used: set[int]
) -> tuple[Spot, set[int]] | None:
    """The place after a group, among its adjectives, or before it."""
    group = groups[index]
    after = _match(words, group.end, SPOTS, used)
    if after is not None:
        return SPOTS[after[0]], set(range(after[1], after[2]))
    end = group.end
    alone = end < len(words) and words[end] in EDGES and end not in used
    if alone and (end + 1 == len(words) or words[end + 1] in (",", "and", "with")):
        return EDGES[words[end]], {end}  # "two drawers left, one right"
    single = group.count is None and words[group.end - 1] in PART_NOUNS
    several = any((other.count or 0) > 1 for other in groups if other.label == group.label)
    definite = "the" in words[max(0, group.start - 2) : group.start]
    if single and (several or definite):  # "the left door" is one of two
        return None
    adjectives = (
        (group.start - 1, *range(group.start, group.end - 1)) if group.start else range(group.end - 1)
    )
    for at in adjectives:
        if words[at] in EDGES and at not in used:
            return EDGES[words[at]], {at}
    begin = groups[index - 1].end if index else 0
    for at in range(begin, group.start):
        before = _match(words, at, SPOTS, used)
        if before is None:
            continue
        between = words[before[2] : group.start]
        other = between[:1] == (",",) and words[before[1] - 1] != ","  # "a plate rack on top, two drawers"
        if not other and all(word in FILLERS or word == "," for word in between):
            return SPOTS[before[0]], set(range(before[1], before[2]))
    return None


def _read_grid(
    words: tuple[str, ...], group: Group, used: set[int]
) -> tuple[tuple[str, str], set[int]] | None:
    """Rows or columns of a group: "in two columns" after it; their number is in words."""
    at = group.end
    if tuple(words[at : at + 1]) not in (("in",), ("as",)):
        return None
    number = read_count(words, at + 1)
    noun = at + 1 + number[1] if number is not None else at
    if number is None or noun >= len(words) or words[noun] not in GRIDS:
        return None
    return (GRIDS[words[noun]], str(number[0])), set(range(at, noun + 1)) - used
