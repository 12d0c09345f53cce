"""Words of sentences for colours and materials."""

from dataclasses import dataclass

from artigen.shapes.surfaces.finishes import Color, FinishKind
from artigen.shapes.surfaces.materials import METALS, STONES, WOODS

PAINTS: dict[str, Color] = {
    "white": (0.92, 0.92, 0.91),
    "ivory": (0.93, 0.90, 0.82),
    "cream": (0.91, 0.87, 0.76),
    "beige": (0.83, 0.77, 0.65),
    "silver": (0.76, 0.76, 0.77),
    "grey": (0.53, 0.53, 0.54),
    "gray": (0.53, 0.53, 0.54),
    "charcoal": (0.24, 0.25, 0.27),
    "anthracite": (0.24, 0.25, 0.27),
    "black": (0.10, 0.10, 0.11),
    "brown": (0.42, 0.28, 0.19),
    "red": (0.70, 0.16, 0.15),
    "burgundy": (0.40, 0.10, 0.14),
    "orange": (0.86, 0.48, 0.17),
    "terracotta": (0.65, 0.40, 0.31),
    "yellow": (0.88, 0.77, 0.32),
    "green": (0.36, 0.50, 0.36),
    "sage": (0.56, 0.62, 0.53),
    "mint": (0.67, 0.82, 0.74),
    "turquoise": (0.30, 0.63, 0.63),
    "teal": (0.15, 0.43, 0.45),
    "blue": (0.26, 0.38, 0.60),
    "navy": (0.16, 0.21, 0.35),
    "purple": (0.44, 0.28, 0.50),
    "pink": (0.86, 0.63, 0.66),
}
"""sRGB colours of paints."""
PLAIN = frozenset({
    "white", "grey", "gray", "black", "brown", "red", "orange", "yellow", "green", "blue", "purple", "pink",
})  # fmt: skip
"""Colours of which others are shades."""
SHADES = {"light": 0.4, "pale": 0.5, "dark": -0.4, "deep": -0.3}
"""Share of the way to white, or to black where negative, of a colour after such a word."""


@dataclass(frozen=True)
class Stuff:
    """A material: what finish it is, and its colour if the word implies one (sRGB)."""

    kind: FinishKind
    color: Color | None = None


MATERIALS: dict[str, Stuff] = {
    **{name.replace("_", " "): Stuff("wood", color) for name, (color, _) in WOODS.items()},
    "oak": Stuff("wood", (0.80, 0.66, 0.47)),
    "walnut": Stuff("wood", (0.40, 0.28, 0.20)),
    "beech": Stuff("wood", (0.82, 0.66, 0.48)),
    "ash": Stuff("wood", (0.82, 0.73, 0.58)),
    "bamboo": Stuff("wood", (0.82, 0.69, 0.45)),
    "wood": Stuff("wood"),
    "dark wood": Stuff("wood", (0.30, 0.20, 0.14)),
    "light wood": Stuff("wood", (0.84, 0.74, 0.58)),
    "wooden": Stuff("wood"),
    "timber": Stuff("wood"),
    **{name: Stuff("steel", METALS[name][0]) for name in ("chrome", "brass", "bronze")},
    "steel": Stuff("steel", (0.72, 0.73, 0.74)),
    "stainless": Stuff("steel", (0.72, 0.73, 0.74)),
    "stainless steel": Stuff("steel", (0.72, 0.73, 0.74)),
    "brushed steel": Stuff("steel", (0.72, 0.73, 0.74)),
    "copper": Stuff("steel", (0.72, 0.45, 0.32)),
    "gold": Stuff("steel", (0.83, 0.68, 0.36)),
    "aluminium": Stuff("steel", (0.78, 0.78, 0.79)),
    "aluminum": Stuff("steel", (0.78, 0.78, 0.79)),
    "iron": Stuff("steel", (0.20, 0.20, 0.21)),
    "metal": Stuff("steel"),
    **{name: Stuff("stone", color) for name, (color, _) in STONES.items()},
    "marble": Stuff("stone", (0.88, 0.87, 0.86)),
    "stone": Stuff("stone"),
    "glass": Stuff("glass"),
    "plastic": Stuff("plastic"),
    "rubber": Stuff("rubber"),
}  # fmt: skip
"""Materials by words."""
PANES = frozenset({"glass", "glazed"})
"""Words for doors with panes."""
SURFACES = frozenset({
    "matte", "matt", "gloss", "glossy", "high", "satin", "lacquer", "lacquered", "laminate", "veneer",
    "paint", "polished", "brushed", "stained", "oiled", "varnished", "metallic", "colour", "color", "tone",
    "tones", "throughout", "outside", "enamel", "enameled", "enamelled", "powder", "coated", "coat",
    "melamine", "mdf", "plywood", "veneered", "laminated", "ceramic", "porcelain", "hue", "look",
})  # fmt: skip
"""Words after a colour or a material that name no piece."""
METALLIC: dict[str, FinishKind] = {"silver": "steel"}
"""Colour words that imply a material."""
