"""Guesses the category of an object from a name: ``kitchen_base_cabinet_03`` is StorageFurniture."""

import re
from collections.abc import Sequence

from artigen.conditioning.prompt import CATEGORY_WORDS
from artigen.datasets.sizes import SIZE_TABLE

UNKNOWN = "Object"

OTHER_WORDS: dict[str, str] = {
    "armoire": "StorageFurniture",
    "kitchen cabinet": "StorageFurniture",
    "hanging cabinet": "StorageFurniture",
    "sink cabinet": "StorageFurniture",
    "base cabinet": "StorageFurniture",
    "wall cabinet": "StorageFurniture",
    "drawer": "StorageFurniture",
    "shelf": "StorageFurniture",
    "coffee maker": "CoffeeMachine",
    "espresso machine": "CoffeeMachine",
    "sink": "Faucet",
    "lamp": "Lamp",
    "lid pot": "KitchenPot",
    "kettle": "Kettle",
}
"""Nouns of sources that are not in the vocabulary of requests."""
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
    known = {" ".join(split_words(name)): name for name in SIZE_TABLE}
    known |= {**CATEGORY_WORDS, **OTHER_WORDS}
    for name in names:
        words = split_words(name)
        for end in range(len(words), 0, -1):
            for start in range(end):
                noun = " ".join(words[start:end])
                for spelled in (noun, noun.removesuffix("s")):
                    if spelled in known:
                        return known[spelled], f"category {known[spelled]} by the word {noun!r} in {name!r}"
    for name in names:
        spelled = [
            token for token in re.split(r"[^A-Za-z0-9]+", name) if re.fullmatch(r"[A-Za-z]+\d*", token)
        ]
        words = [word for word in split_words(" ".join(spelled)) if len(word) > 2 and word not in NO_NAMES]
        if words:
            category = "".join(word.capitalize() for word in words)
            return category, f"category {category} is the name {name!r}: it holds no noun that is known"
    return UNKNOWN, f"category {UNKNOWN}: none of {', '.join(map(repr, names))} says what it is"
