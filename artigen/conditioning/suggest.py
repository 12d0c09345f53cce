"""`suggest`: a word that is not understood, with the known one that it may be a misspelling of."""

from difflib import get_close_matches
from functools import cache

from artigen.conditioning.measures import DIRECTIONS
from artigen.conditioning.vocabulary import FILLERS, PARTS, SPOTS
from artigen.kind import list_nouns

NEAR = 0.84
"""Least similarity, as `difflib` measures it: "dors" is 0.89 to "doors"."""

SHORTEST = 5
"""Letters of the shortest word that is suggested: most words are near to some shorter one."""


@cache
def _list_known() -> frozenset[str]:
    phrases = (*list_nouns(), *PARTS, *DIRECTIONS, *SPOTS, *FILLERS)
    return frozenset(word for phrase in phrases for word in phrase.split())


def suggest(word: str) -> str:
    """The word, or "dors (doors?)"."""
    known = _list_known()
    if {word, word.removesuffix("s")} & known:
        return word
    near = get_close_matches(word, sorted(one for one in known - FILLERS if len(one) >= SHORTEST), 1, NEAR)
    return f"{word} ({near[0]}?)" if near else word
