"""The words of headers, categories and styles, which weights refer to by name.

Words may be added anywhere but not removed.
"""

from functools import cache

from artigen.kind import kinds, list_words

CATEGORIES = list_words()
"""Categories of the grammar."""
STYLES = (
    "flat", "shaker", "framed_glass", "handleless", "classic", "industrial", "country", "louvre",
    "steel", "white", "black", "retro", "kitchen", "service", "tool", "dial", "handwheel", "keypad",
    "other", "carton", "chest", "plastic", "trunk", "window", "drop", "enamel", "curved", "shop", "led",
    "architect", "dome", "glazed", "panelled", "flush", "double", "midcentury", "modern", "american",
    "single", "bridge", "wooden", "lateral", "vertical", "pedestal", "business", "gaming", "light",
    "colour", "cluster", "rural", "parcel", "saucepan", "stockpot", "casserole", "copier", "inkjet",
    "multifunction", "laser", "large", "aluminium", "cabin", "leather", "rocker", "toggle", "dimmer",
    "buttons", "wall_hung", "close_coupled", "skirted", "metal", "rolling", "flap", "pedal", "wheeled",
    "flip", "sorting", "mirrored", "sliding", "casement", "sash", "platform", "wheelbarrow", "pillar",
)  # fmt: skip
"""Styles of all categories."""
OTHER_STYLE = STYLES.index("other")
"""Placeholder for styles without a word."""


@cache
def list_styles(category: int) -> tuple[int, ...]:
    """Numbers of the styles that the grammar draws a category in; `OTHER_STYLE` for those without a word."""
    drawn = kinds()[CATEGORIES[category]].styles
    return tuple(sorted({STYLES.index(style) if style in STYLES else OTHER_STYLE for style in drawn}))
