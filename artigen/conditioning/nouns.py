"""Finds the noun that names the kind of object in a sentence."""

from collections.abc import Sequence
from dataclasses import dataclass

from artigen.conditioning.measures import ADJECTIVES, SCALES
from artigen.conditioning.numbers import read_number
from artigen.conditioning.paints import MATERIALS, PAINTS, SHADES
from artigen.conditioning.sentence import TextError
from artigen.conditioning.vocabulary import (
    AMBIGUOUS,
    CLAUSES,
    FILLERS,
    OTHERS,
    PARTS,
    RELATIONS,
    count_longest,
)
from artigen.kind import Kind, find_noun, list_nouns

NAMES = frozenset((part,) for part in PARTS)
CHESTS, DRAWERS = frozenset({"chest", "chests"}), frozenset({"drawer", "drawers"})
"""A chest with drawers is a chest of drawers."""
WHERE, DETERMINERS = frozenset({"on", "in", "beside", "near", "behind"}), frozenset({"the", "a", "an", "my"})
"""Words that lead to where something is."""


@dataclass(frozen=True)
class Head:
    """A noun of a kind: its first word, their number, and the kind."""

    at: int
    count: int
    kind: Kind


def find_head(words: tuple[str, ...], used: frozenset[int], *, whole: bool = True) -> Head | None:
    """The noun that names the object; None without one.

    Nouns after "with" and the like name contents or surroundings. A noun that also names a part (a door, a
    window) names the object only if no other does, and nothing counts it.

    Raises:
        TextError: If two kinds are named.
    """
    nouns = _find_nouns(words, used)
    alone = [
        noun for noun in nouns if tuple(words[noun.at + noun.count : noun.at + noun.count + 1]) not in NAMES
    ]
    nouns = alone or nouns  # "oven doors" are parts of a range
    nouns = [noun for noun in nouns if not _is_place(noun, nouns, words, whole=whole)] or nouns
    clear = [noun for noun in nouns if not _is_ambiguous(noun, words)]
    if not clear:
        return next((noun for noun in nouns if _is_one(noun, words, whole=whole)), None)
    end = next((at for at in range(clear[0].at, len(words)) if words[at] in CLAUSES), len(words))
    before = [noun for noun in clear if noun.at < end]
    if not before:
        return clear[0]
    head = before[0]
    for noun in before[1:]:
        between = words[head.at + head.count : noun.at]
        if "," in between or (between and noun.kind is head.kind):
            break  # "a desk, one drawer unit at the left", "a sideboard between two cupboards"
        if noun.kind is not head.kind and between:
            raise TextError(f"both {head.kind.name} and {noun.kind.name} are named; give one kind")
        head = noun  # the last word of a compound is its head
    return head


def _find_nouns(words: tuple[str, ...], used: frozenset[int]) -> list[Head]:
    found: list[Head] = []
    at, longest = 0, count_longest(list_nouns())
    while at < len(words):
        divided = _find_divided(words, at)
        if divided is not None:
            found.append(Head(at, 2, divided))
            at += 2
            continue
        for count in range(min(longest, len(words) - at), 0, -1):
            kind = find_noun(" ".join(words[at : at + count]))
            other = any(
                " ".join(words[start:end]) in OTHERS
                for start in range(max(0, at - 2), at + 1)
                for end in range(at + count, at + count + 2)
            )
            if kind is not None and words[at] in CHESTS and DRAWERS & set(words):
                kind = find_noun("chest of drawers")
            if kind is not None and at not in used and not other:
                found.append(Head(at, count, kind))
                at += count
                break
        else:
            at += 1
    return found


def _find_divided(words: tuple[str, ...], at: int) -> Kind | None:
    """The kind of a noun with a number inside: "chest of six drawers"; its head are the words before that."""
    number = read_number(words, at + 2) if tuple(words[at + 1 : at + 2]) == ("of",) else None
    if number is None:
        return None
    end = at + 2 + number[1]
    return find_noun(" ".join((*words[at : at + 2], *words[end : end + 1])))


def _is_place(noun: Head, nouns: Sequence[Head], words: tuple[str, ...], *, whole: bool) -> bool:
    """Whether a noun says where the thing that another one names is: "a lamp on the desk"."""
    before = words[: noun.at]
    starts = [at for at in range(len(before) - 1) if before[at] in WHERE and before[at + 1] in DETERMINERS]
    return bool(starts) and any(
        other.at < starts[-1] and _is_one(other, words, whole=whole) for other in nouns
    )


def _is_ambiguous(noun: Head, words: tuple[str, ...]) -> bool:
    return " ".join(words[noun.at : noun.at + noun.count]) in AMBIGUOUS


def _is_one(noun: Head, words: tuple[str, ...], *, whole: bool) -> bool:
    """Whether a noun that also names a part is one thing, and not in a clause of parts."""
    spelled = " ".join(words[noun.at : noun.at + noun.count])
    before = words[: noun.at]
    number = next((read_number(words, at) for at in (noun.at - 1, noun.at - 2) if at >= 0), None)
    counted = number is not None and number[0] != 1 and words[noun.at - 1] not in ("double", "twin", "triple")
    named = spelled in noun.kind.nouns and not _is_later(before)
    part = spelled in PARTS and (not whole or not named)
    clause = before[max((at + 1 for at, word in enumerate(before) if word == ","), default=0) :]
    return not part and not counted and not CLAUSES & set(clause)


def _is_later(before: tuple[str, ...]) -> bool:
    """Whether a noun of a part comes after what may be another object: "a bench, 60 cm, one door"."""
    described = {*ADJECTIVES, *SCALES, *PAINTS, *SHADES, *FILLERS} | {
        word for material in MATERIALS for word in material.split()
    }
    clause = before[: before.index(",")] if "," in before else ()
    return before[-1:] == ("one",) or bool(set(clause) - described) or bool({*RELATIONS} & set(before))
