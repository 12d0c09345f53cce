"""Finds what colours and materials of a sentence belong to, before, after and behind commas."""

from dataclasses import replace

import numpy as np

from artigen.conditioning.measures import ADJECTIVES, SCALES, UNITS
from artigen.conditioning.numbers import read_number
from artigen.conditioning.paints import MATERIALS, PAINTS, PLAIN, SHADES, SURFACES, Stuff
from artigen.conditioning.sentence import OBJECT, TextError
from artigen.conditioning.vocabulary import (
    CLAUSES,
    FEATURES,
    FILLERS,
    LEGS,
    PARTS,
    PIECES,
    RACKS,
    RELATIONS,
    SPOTS,
)
from artigen.shapes.surfaces.finishes import Color

BETWEEN = 4
"""Largest number of words between a colour and its noun."""
LINKS = {
    "in", "of", "are", "is", "be", "should", "must", "painted", "finished", "made", "from", "coloured",
    "colored", "all",
}  # fmt: skip
"""Words between a noun and a colour after it."""
ENDS = {",", "with", "without", "in", "on", "of", "for", "but"}
"""Words that a colour does not reach across."""
Pairs = tuple[tuple[str, str], ...]


def read_finishes(
    words: tuple[str, ...], used: frozenset[int], head: range
) -> tuple[Pairs, Pairs, frozenset[int]]:
    """Colour words and material words by what they belong to, and the words that are read.

    Args:
        words: Words of the sentence.
        used: Places of those that mean something else.
        head: Places of the noun that names the object.

    Raises:
        TextError: If one thing has two colours, or two materials.
    """
    colors: dict[str, str] = {}
    materials: dict[str, str] = {}
    read = set(used)
    at = 0
    while at < len(words):
        count = measure_finish(words, at)
        stuff = find_stuff(words[at])
        if (
            count == 1
            and stuff is not None
            and stuff.kind == "stone"
            and {*words[at + 1 : at + 2]} & {*PAINTS}
        ):
            count = 0  # "slate grey"
        if not count or at in used:
            at += 1
            continue
        word = " ".join(words[at : at + count])
        table = colors if find_color_only(word) is not None else materials
        target = _find_after(words, at + count, head, used)
        end = at + count
        while target is None and end < len(words) and measure_finish(words, end):
            end += measure_finish(words, end)
        if target is None and at > head.start and is_noun(words, end):
            at = end  # "a mailbox with a red plastic flag"
            continue
        target = target or _find_before(words, at, head, table)
        if table.get(target, word) != word and words[at - 1] in ("or", "and"):
            at += count  # "oak or walnut"
            continue
        if table.get(target, word) != word:
            named = "the object" if target == OBJECT else f"the {target}"
            raise TextError(f"{table[target]} and {word} are asked for, both of {named}; name one")
        table[target] = word
        read |= set(range(at, at + count))
        at += count
    return tuple(sorted(colors.items())), tuple(sorted(materials.items())), frozenset(read)


def find_color_only(word: str) -> Color | None:
    """The colour (sRGB) of a paint, which may have a shade before it, "light blue", or another colour, "navy
    blue", which it then is; a plain colour before it tints it, "blue grey". None for other words."""
    shade, _, paint = word.rpartition(" ")
    color = PAINTS.get(paint)
    if color is not None and shade in PAINTS and shade != paint:
        first = np.array(PAINTS[shade])
        r, g, b = ((first + color) / 2).tolist() if shade in PLAIN else PAINTS[shade]
        return r, g, b
    return None if color is None or shade not in ("", *SHADES) else _shade(color, shade)


def _shade(color: Color, shade: str) -> Color:
    """A colour after a word such as "light"; "" leaves it."""
    share = SHADES.get(shade, 0.0)
    goal = 1.0 if share > 0 else 0.0
    r, g, b = (level + abs(share) * (goal - level) for level in color)
    return r, g, b


def find_stuff(word: str) -> Stuff | None:
    """The material of a word, which may have a shade before it, "light oak"; None for other words."""
    shade, _, name = word.rpartition(" ")
    stuff = MATERIALS.get(name)
    if word in MATERIALS or stuff is None or stuff.color is None or shade not in SHADES:
        return MATERIALS.get(word)
    return replace(stuff, color=_shade(stuff.color, shade))


def measure_finish(words: tuple[str, ...], at: int) -> int:
    """Number of words of the colour or material at a place; 0 for none."""
    for count in (2, 1):
        word = " ".join(words[at : at + count])
        if at + count <= len(words) and (find_stuff(word) is not None or find_color_only(word) is not None):
            return count
    return 0


def _name_target(words: tuple[str, ...], at: int, head: range) -> str | None:
    if at in head:
        return OBJECT
    return PARTS.get(words[at]) or PIECES.get(words[at]) or ("leg" if words[at] in LEGS else None)


def _find_after(words: tuple[str, ...], start: int, head: range, used: frozenset[int]) -> str | None:
    """What the next noun names, unless a clause ends before it."""
    for at in range(start, min(start + BETWEEN, len(words))):
        if words[at] in ENDS:
            return None
        if words[at] == "and" and not _is_description(words, at + 1):
            return None
        target = _name_target(words, at, head)
        if target is not None and not (at in used and at + 1 in head):  # "a white two-door cabinet"
            return target
    return None


def is_noun(words: tuple[str, ...], at: int) -> bool:
    """Whether a word may be a noun without a known meaning: no part, and nothing that describes one."""
    known = {
        *PARTS,
        *PIECES,
        *LEGS,
        *FILLERS,
        *SURFACES,
        *UNITS,
        *ADJECTIVES,
        *SCALES,
        *SHADES,
        *ENDS,
        *CLAUSES,
        *RELATIONS,
    }
    return (
        at < len(words)
        and words[at].isalpha()
        and words[at] not in known
        and not measure_finish(words, at)
        and read_number(words, at) is None
        and not any(" ".join(words[at : at + count]) in {*FEATURES, *SPOTS} for count in range(1, 6))
    )


def is_compound(words: tuple[str, ...], at: int) -> bool:
    """Whether the noun of a part names something else with another one: "a towel rack", "a pull cord"."""
    return (words[at] in RACKS and at > 0 and is_noun(words, at - 1)) or (
        words[at] == "pull" and is_noun(words, at + 1)
    )


def _is_description(words: tuple[str, ...], at: int) -> bool:
    """Whether a word after "and" goes on describing the same noun: "white and narrow fridge"."""
    return at < len(words) and (words[at] in ADJECTIVES or measure_finish(words, at) > 0)


def _find_before(words: tuple[str, ...], at: int, head: range, known: dict[str, str]) -> str:
    """What a colour after its noun belongs to: the noun that it is linked to, else the object."""
    place = at - 1
    while place >= 0 and words[place] in LINKS:
        place -= 1
    link = words[place + 1 : at]
    named = place > 0 and words[place - 1] in ("the", "its")  # "make the handles black"
    if place < 0 or not (link or named):
        return OBJECT
    target = _name_target(words, place, head)
    if link == ("in",) and target in ("drawer", "door", "shelf", "tray") and OBJECT not in known:
        return OBJECT  # "a dresser with six drawers in oak"
    return target or OBJECT
