"""`suggest`: a word that is not understood, with the known one that it may be a misspelling of."""

from difflib import get_close_matches
from functools import cache

from artigen.conditioning.measures import DIRECTIONS
from artigen.conditioning.vocabulary import FILLERS, PARTS, SPOTS
from artigen.kind import list_nouns

NEAR = 0.84
"""Least similarity, as `difflib` measures it: "dors" is 0.89 to "doors"."""


@cache
def _list_known() -> tuple[str, ...]:
    phrases = (*list_nouns(), *PARTS, *DIRECTIONS, *SPOTS)
    return tuple(sorted({word for phrase in phrases for word in phrase.split()} - FILLERS))


def suggest(word: str) -> str:
    """The word, or "dors (doors?)"."""
    near = get_close_matches(word, _list_known(), 1, NEAR)
    return f"{word} ({near[0]}?)" if near and near[0] != word else word
