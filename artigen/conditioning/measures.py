"""Words of sentences for numbers, units, limits and directions, and adjectives of size."""

from typing import Literal, get_args

Axis = Literal["width", "depth", "height"]
AXES: tuple[Axis, ...] = get_args(Axis)

NUMBERS: dict[str, int] = {
    "zero": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8,
    "nine": 9, "ten": 10, "eleven": 11, "twelve": 12, "thirteen": 13, "fourteen": 14, "fifteen": 15,
    "sixteen": 16, "seventeen": 17, "eighteen": 18, "nineteen": 19, "twenty": 20, "thirty": 30, "forty": 40,
    "fifty": 50, "sixty": 60, "seventy": 70, "eighty": 80, "ninety": 90, "hundred": 100,
    "no": 0, "without": 0, "neither": 0,
    "a": 1, "an": 1, "single": 1, "double": 2, "twin": 2, "triple": 3, "both": 2,
}  # fmt: skip
"""Words for numbers; sentences use the first of each."""
LIMITS: dict[str, tuple[int, int]] = {
    **dict.fromkeys(("at least", "no less than", "no fewer than", "minimum of", "a minimum of"), (1, 0)),
    **dict.fromkeys(("at most", "up to", "no more than", "maximum of", "a maximum of"), (-1, 0)),
    "exactly": (0, 0), "more than": (1, 1), "less than": (-1, -1), "fewer than": (-1, -1),
}  # fmt: skip
"""Phrases before a number: where others are that are allowed, and how far the nearest whole one is."""
SIDES = {"under": -1, "below": -1, "over": 1, "above": 1}
"""The same before lengths only: before a number of parts they say where those are."""
GROUPS = {"dozen": 12, "couple": 2, "pair": 2}
"""Nouns for numbers of things: a dozen drawers, a pair of doors."""
UNITS: dict[str, float] = {
    "mm": 0.001, "millimetre": 0.001, "millimeter": 0.001, "millimetres": 0.001, "millimeters": 0.001,
    "cm": 0.01, "centimetre": 0.01, "centimeter": 0.01, "centimetres": 0.01, "centimeters": 0.01,
    "m": 1.0, "metre": 1.0, "meter": 1.0, "metres": 1.0, "meters": 1.0,
    "in": 0.0254, "inch": 0.0254, "inches": 0.0254,
    "ft": 0.3048, "foot": 0.3048, "feet": 0.3048,
}  # fmt: skip
"""Metres of each unit."""
BODY = {"knee": 0.5, "hip": 0.9, "waist": 1.0, "shoulder": 1.4, "eye": 1.6}
"""Heights (m) above the floor of standing adults: "waist-high"."""
VOLUMES: dict[str, float] = {
    **dict.fromkeys(("litre", "litres", "liter", "liters", "l"), 0.001),
    **dict.fromkeys(("gallon", "gallons"), 0.003785),
}
"""Cubic metres of each unit."""
DIRECTIONS: dict[str, Axis] = {
    "wide": "width", "width": "width", "broad": "width", "long": "width", "length": "width",
    "deep": "depth", "depth": "depth",
    "tall": "height", "high": "height", "height": "height", "w": "width", "d": "depth", "h": "height",
    "diameter": "width", "across": "width",
}  # fmt: skip
ADJECTIVES: dict[str, tuple[Axis, float]] = {
    "tall": ("height", 1.35),
    "high": ("height", 1.35),
    "low": ("height", 0.7),
    "short": ("height", 0.7),
    "wide": ("width", 1.35),
    "narrow": ("width", 0.7),
    "deep": ("depth", 1.25),
    "shallow": ("depth", 0.75),
    "long": ("width", 1.35),
    "slim": ("width", 0.7),
    "broad": ("width", 1.35),
}
"""Adjectives that scale a kind's usual extent along one axis when no length is given."""
COMPARATIVES = {
    "taller": ("more", "tall"), "higher": ("more", "high"), "wider": ("more", "wide"),
    "longer": ("more", "long"), "deeper": ("more", "deep"), "lower": ("less", "high"),
    "shorter": ("less", "high"), "narrower": ("less", "wide"), "shallower": ("less", "deep"),
}  # fmt: skip
"""Comparatives before "than" and a length, as the limit and the direction that they are."""
SCALES = {
    "large": 1.2, "big": 1.2, "oversized": 1.3, "huge": 1.3,
    "small": 0.8, "little": 0.8, "compact": 0.8, "mini": 0.7, "tiny": 0.7,
}  # fmt: skip
"""Adjectives that scale all extents of which nothing else is said."""
