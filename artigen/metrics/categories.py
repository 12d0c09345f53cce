"""Comparison of category names between the grammar and PartNet-Mobility."""

NAMES = {"Dresser": "StorageFurniture", "Wardrobe": "StorageFurniture", "FilingCabinet": "StorageFurniture"}
"""Kinds of the grammar that PartNet-Mobility, and so the paper, classifies under another name."""


def is_same_category(one: str | None, other: str | None) -> bool:
    """Whether both are the same category in PartNet-Mobility."""
    return NAMES.get(one or "", one) == NAMES.get(other or "", other)
