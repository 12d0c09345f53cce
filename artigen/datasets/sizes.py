"""Real-world sizes of categories: PartNet's lengths are normalised, a simulator needs metres.

Each rule (`artigen.kind.SizeRule`) gives one extent of the closed object in metres. Where one number would be
wrong for half of a category (a nightstand and a wardrobe are both storage furniture), the rule depends on the
ratio of height to footprint. A limit on the depth keeps sizes plausible.
"""

import numpy as np
from jaxtyping import Float

from artigen.kind import by_longest, find_category

LONGEST = 2.4
"""Longest edge of any object (metres)."""
FALLBACK = (by_longest(0.5),)
"""Rule for categories that are not known."""


def estimate_size(category: str, extents: Float[np.ndarray, "3"]) -> tuple[float, bool]:
    """Longest edge in metres, and whether the category is known.

    Args:
        extents: Depth, width and height (x, y, z) of the closed object, in any unit.
    """
    depth, width, height = (float(extent) for extent in extents)
    known = find_category(category)
    slenderness = height / max(depth, width)
    rule = next(rule for rule in (FALLBACK if known is None else known.size) if slenderness <= rule.up_to)
    longest = max(depth, width, height)
    measured = {"height": height, "width": width, "longest": longest}[rule.extent]
    size = min(rule.metres / measured * longest, LONGEST)
    if known is not None:
        size = min(size, known.deepest / depth * longest)
    return size, known is not None
