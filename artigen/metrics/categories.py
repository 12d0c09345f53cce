"""Whether two categories are the same thing by two names."""

NAMES = {"Dresser": "StorageFurniture", "Wardrobe": "StorageFurniture", "FilingCabinet": "StorageFurniture"}
"""Kinds of the grammar that PartNet-Mobility, and so the paper, files under another name."""


def is_same_category(one: str | None, other: str | None) -> bool:
    """Whether both are one category to PartNet-Mobility."""
    return NAMES.get(one or "", one) == NAMES.get(other or "", other)
