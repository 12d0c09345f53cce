"""Guesses the category of an object from a name: ``kitchen_base_cabinet_03`` is StorageFurniture."""

import re
from collections.abc import Sequence
from functools import cache

from artigen.kind import Category, find_kind, kinds, list_categories

UNKNOWN = "Object"

NO_NAMES = ("mobility", "model", "robot", "object", "partnet", "urdf", "asset", "cvx", "main", "scene")
"""Meaningless words in names of files and robots."""


def split_words(name: str) -> list[str]:
    """The words of a name in lower case, split at capitals, digits and other characters."""
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return [word for word in re.split(r"[^a-z]+", spaced.lower()) if word]


def guess_category(names: Sequence[str]) -> tuple[str, str]:
    """The category of the first name with a known noun, and a note on how it was found.

    The last noun in a name counts, and the longest of those. Without a noun, the category is the first name
    that is a word, else `UNKNOWN`.
    """
    known = _name_words()
    for name in names:
        words = split_words(name)
        for end in range(len(words), 0, -1):
            for start in range(end):
                noun = " ".join(words[start:end])
                if noun in known:
                    return known[noun], f"category {known[noun]} by the word {noun!r} in {name!r}"
    for name in names:
        spelled = [
            token for token in re.split(r"[^A-Za-z0-9]+", name) if re.fullmatch(r"[A-Za-z]+\d*", token)
        ]
        words = [word for word in split_words(" ".join(spelled)) if len(word) > 2 and word not in NO_NAMES]
        if words:
            category = "".join(word.capitalize() for word in words)
            return category, f"category {category} is the name {name!r}: it holds no noun that is known"
    return UNKNOWN, f"category {UNKNOWN}: none of {', '.join(map(repr, names))} says what it is"


@cache
def _name_words() -> dict[str, str]:
    """Categories by their names and nouns in words; a source's own categories go before kinds."""
    foreign = [category for category in list_categories() if find_kind(category.name) is None]
    known = {_spell(kind.partnet): name for name, kind in kinds().items() if kind.partnet is not None}
    known |= {_spell(category.name): category.name for category in list_categories()}
    for category in (*kinds().values(), *foreign):
        known |= dict.fromkeys((*_number(category), *category.hints), category.name)
    return known


def _spell(name: str) -> str:
    return " ".join(split_words(name))


def _number(category: Category) -> tuple[str, ...]:
    """The nouns of a category, singular and plural."""
    return (*category.nouns, *category.nouns.values())
