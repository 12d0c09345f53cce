"""Which objects must stand on their own."""

MOUNTED_CATEGORIES = frozenset({"Door", "Faucet", "Switch", "Window"})
HELD_CATEGORIES = frozenset(
    {"Eyeglasses", "Knife", "Lighter", "Pen", "Phone", "Pliers", "Remote", "Scissors", "Stapler", "USB"}
)
"""PartNet-Mobility categories that are fixed to a building or hand-held and need not stand. All others,
including unknown categories, must stand."""


def must_stand(category: str) -> bool:
    """Whether objects of this category must stand on their own."""
    return category not in MOUNTED_CATEGORIES | HELD_CATEGORIES
