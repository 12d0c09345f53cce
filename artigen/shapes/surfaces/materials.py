"""Materials by name: woods, lacquers, metals, stones and glasses of furniture and appliances."""

from dataclasses import replace

from artigen.shapes.surfaces.finishes import Color, Finish

WOODS: dict[str, tuple[Color, Color]] = {
    "oak": ((0.74, 0.55, 0.35), (0.60, 0.41, 0.24)),
    "white_oak": ((0.90, 0.79, 0.65), (0.79, 0.66, 0.51)),
    "walnut": ((0.46, 0.29, 0.18), (0.30, 0.17, 0.095)),
    "birch": ((0.95, 0.85, 0.73), (0.87, 0.74, 0.60)),
    "pine": ((0.87, 0.72, 0.50), (0.72, 0.52, 0.31)),
    "cherry": ((0.70, 0.43, 0.26), (0.55, 0.30, 0.16)),
    "teak": ((0.61, 0.42, 0.26), (0.44, 0.28, 0.16)),
    "grey_oak": ((0.65, 0.60, 0.53), (0.51, 0.46, 0.40)),
    "maple": ((0.95, 0.77, 0.54), (0.87, 0.67, 0.43)),
    "mahogany": ((0.44, 0.22, 0.13), (0.31, 0.135, 0.075)),
    "wenge": ((0.215, 0.145, 0.11), (0.145, 0.092, 0.068)),
    "black_ash": ((0.16, 0.15, 0.145), (0.09, 0.085, 0.08)),
}
"""Colour of early wood and of growth rings; the redder ones are mostly stained."""
LACQUERS: dict[str, Color] = {
    "white": (0.93, 0.925, 0.91),
    "cream": (0.90, 0.87, 0.79),
    "light_grey": (0.75, 0.75, 0.74),
    "grey": (0.53, 0.54, 0.54),
    "anthracite": (0.22, 0.23, 0.24),
    "sage": (0.56, 0.62, 0.53),
    "navy": (0.14, 0.20, 0.31),
    "forest": (0.18, 0.27, 0.22),
    "blue": (0.46, 0.55, 0.62),
    "terracotta": (0.65, 0.40, 0.31),
    "black": (0.04, 0.04, 0.044),
}
VARNISHED, DEEPER, WARMER = 0.4, 1.1, 1.15
"""Gloss of varnished wood, the power to which varnish raises its colour, and the factor of its saturation."""
METALS: dict[str, tuple[Color, Color]] = {
    "steel": ((0.89, 0.89, 0.885), (0.64, 0.64, 0.635)),
    "chrome": ((0.86, 0.86, 0.87), (0.80, 0.80, 0.81)),
    "brass": ((0.78, 0.63, 0.38), (0.66, 0.50, 0.27)),
    "bronze": ((0.36, 0.28, 0.21), (0.26, 0.20, 0.15)),
    "black": ((0.04, 0.04, 0.044), (0.055, 0.055, 0.055)),
    "dark": ((0.43, 0.43, 0.44), (0.25, 0.25, 0.26)),
}
"""Colour and brushing; black is powder-coated, dark is dark stainless steel."""
STONES: dict[str, tuple[Color, Color]] = {
    "granite": ((0.30, 0.30, 0.31), (0.55, 0.54, 0.52)),
    "terrazzo": ((0.86, 0.85, 0.82), (0.60, 0.55, 0.50)),
    "quartz": ((0.90, 0.895, 0.88), (0.74, 0.73, 0.71)),
    "concrete": ((0.62, 0.615, 0.60), (0.52, 0.515, 0.50)),
    "slate": ((0.20, 0.205, 0.21), (0.29, 0.29, 0.30)),
}


def make_wood(name: str, seed: int, *, figure: float = 1.0) -> Finish:
    """A wood of `WOODS`, open-pored and oiled; ``figure`` in [0, 1.5] is the contrast of its grain."""
    color, accent = WOODS[name]
    red, green, blue = ((1.0 - figure) * c + figure * a for c, a in zip(color, accent, strict=True))
    rings = (red, green, blue)
    return Finish(kind="wood", color=color, accent=rings, period=0.045, seed=seed, gloss=0.12)


def varnish(finish: Finish) -> Finish:
    """A wood under clear varnish, which makes it deeper and warmer in colour."""
    return replace(
        finish, color=deepen_color(finish.color), accent=deepen_color(finish.accent), gloss=VARNISHED
    )


def deepen_color(color: Color) -> Color:
    """A colour (sRGB), darker and farther from the grey of its brightness."""
    channels = [channel**DEEPER for channel in color]
    grey = sum(share * channel for share, channel in zip((0.3, 0.59, 0.11), channels, strict=True))
    red, green, blue = (min(max(grey + WARMER * (c - grey), 0.02), 1.0) for c in channels)
    return red, green, blue


def make_lacquer(color: Color, *, gloss: float = 0.18) -> Finish:
    """A uniform paint; its accent, a shade darker, gives a slight variation."""
    return Finish(kind="lacquer", color=color, accent=shade_color(color, 0.96), period=0.4, gloss=gloss)


def make_metal(name: str, seed: int) -> Finish:
    """A metal of `METALS`, brushed along y; powder-coated black is a lacquer."""
    color, brushing = METALS[name]
    if name == "black":
        return replace(make_lacquer(color), gloss=0.15)
    gloss = 0.75 if name == "chrome" else 0.5
    return Finish(
        kind="steel",
        color=color,
        accent=brushing,
        grain=(0.0, 1.0, 0.0),
        period=0.012,
        seed=seed,
        gloss=gloss,
    )


def make_polished(name: str, seed: int) -> Finish:
    """A metal of `METALS`, polished or plated, with hardly visible brushing."""
    metal = make_metal(name, seed)
    red, green, blue = (
        0.85 * own + 0.15 * other for own, other in zip(metal.color, metal.accent, strict=True)
    )
    return replace(metal, accent=(red, green, blue), gloss=max(metal.gloss, 0.6))


def make_stone(name: str, seed: int) -> Finish:
    """A stone of `STONES`, honed."""
    color, speckles = STONES[name]
    period = 0.016 if name == "terrazzo" else 0.006
    return Finish(kind="stone", color=color, accent=speckles, period=period, seed=seed, gloss=0.3)


def make_ceramic(color: Color, seed: int) -> Finish:
    """Glazed sanitary ware or stoneware: the pattern of stone in a uniform colour."""
    return Finish(
        kind="stone", color=color, accent=shade_color(color, 0.985), period=0.02, seed=seed, gloss=0.5
    )


def make_plastic(color: Color, *, gloss: float = 0.25) -> Finish:
    """A moulding of one colour."""
    return Finish(kind="plastic", color=color, accent=shade_color(color, 0.95), period=0.3, gloss=gloss)


def make_glass(color: Color, *, opacity: float = 1.0) -> Finish:
    """Float glass; opaque where it is printed from behind, as on control panels."""
    return Finish(
        kind="glass", color=color, accent=shade_color(color, 1.1), period=0.5, gloss=0.55, opacity=opacity
    )


def shade_color(color: Color, factor: float) -> Color:
    """A colour times a factor."""
    return color[0] * factor, color[1] * factor, color[2] * factor
