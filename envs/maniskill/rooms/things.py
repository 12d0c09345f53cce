"""Small things that drawers and cupboards hold, made of boxes and cylinders.

A thing stands with its lowest point at z = 0, centred over the origin.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float

from sim_export.geometry.primitives import PrimitiveShape, primitive_hull
from sim_export.package import Hull

Color = tuple[float, float, float]
Size = tuple[float, float, float]
Solids = tuple[tuple[PrimitiveShape, int], ...]
"""Primitives, each with the index of its colour."""
WALL = 0.005
"""Thickness (m) of the walls of vessels."""
STAVES = 12
"""Number of boxes around a vessel."""


@dataclass(frozen=True, kw_only=True)
class Thing:
    """A kind of thing. ``where`` names its places: a kind of room and ``drawer`` or ``shelf``, or ``fridge``.

    ``low`` and ``high`` bound its size (m), and ``density`` is its mass per volume of its box (kg/m^3).
    """

    name: str
    where: tuple[str, ...]
    low: Size
    high: Size
    density: float
    colors: tuple[tuple[Color, Color], ...]
    build: Callable[[Size], Solids]


@lru_cache(maxsize=4096)
def thing_solids(name: str, size: Size) -> Solids:
    """The primitives of a thing; raises `ValueError` for an unknown name."""
    for thing in THINGS:
        if thing.name == name:
            return thing.build(size)
    raise ValueError(f"thing {name!r}, expected one of {', '.join(thing.name for thing in THINGS)}")


@lru_cache(maxsize=4096)
def thing_hulls(name: str, size: Size) -> tuple[Hull, ...]:
    """One hull per primitive of a thing."""
    return tuple(primitive_hull(solid) for solid, _ in thing_solids(name, size))


def _place(offset: tuple[float, float, float]) -> Float[np.ndarray, "4 4"]:
    T = np.eye(4)
    T[:3, 3] = offset
    return T


def _box(low: Size, high: Size) -> PrimitiveShape:
    bottom, top = np.array(low), np.array(high)
    x, y, z = (top + bottom).tolist()
    edges = tuple((top - bottom).tolist())
    return PrimitiveShape(kind="box", sizes=edges, T_object_shape=_place((x / 2, y / 2, z / 2)))


def _rod(radius: float, low: float, high: float) -> PrimitiveShape:
    middle = _place((0.0, 0.0, (low + high) / 2))
    return PrimitiveShape(kind="cylinder", sizes=(radius, high - low), T_object_shape=middle)


def _vessel(size: Size, foot: float) -> Solids:
    """A round vessel with a flat bottom of ``foot`` times its diameter, and flared walls of boxes."""
    top, height = size[1] / 2 * np.cos(np.pi / STAVES), size[2]
    base = foot * top
    tilt = np.arctan2(top - base, height)
    rim = height - WALL * np.sin(tilt)
    tilt, length = np.arctan2(top - base, rim), np.hypot(top - base, rim)
    width = 2 * top * np.tan(np.pi / STAVES)
    c, s = np.cos(tilt), np.sin(tilt)
    stave = np.eye(4)
    stave[:3, :3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    stave[:3, 3] = [(base + top) / 2 - WALL / 2 * c, 0.0, rim / 2 + WALL / 2 * s]
    solids = [(_rod(base, 0.0, WALL), 1)]
    for angle in np.arange(STAVES) * 2 * np.pi / STAVES:
        c, s = np.cos(angle), np.sin(angle)
        turn = np.eye(4)
        turn[:2, :2] = [[c, -s], [s, c]]
        box = PrimitiveShape(
            kind="box", sizes=(WALL, float(width), float(length)), T_object_shape=turn @ stave
        )
        solids.append((box, 0))
    return tuple(solids)


def _cup(size: Size) -> Solids:
    """A vessel with a handle at +x, which takes the difference of length and width."""
    reach, height = size[0] - size[1], size[2]
    start, end, half = size[1] / 2 * 0.93, size[1] / 2 + reach, 0.005
    bars = [_box((start, -half, z * height), (end, half, z * height + 2 * half)) for z in (0.25, 0.7)] + [
        _box((end - 2 * half, -half, 0.25 * height), (end, half, 0.7 * height + 2 * half))
    ]
    shift = _place((-reach / 2, 0.0, 0.0))
    return tuple(
        (PrimitiveShape(kind=one.kind, sizes=one.sizes, T_object_shape=shift @ one.T_object_shape), color)
        for one, color in (*_vessel(size, 0.85), *((bar, 0) for bar in bars))
    )


def _turned(profile: tuple[tuple[float, float, int], ...]) -> Callable[[Size], Solids]:
    """Cylinders on each other: shares of the diameter and of the height up to their tops, and colours."""

    def build(size: Size) -> Solids:
        solids, low = [], 0.0
        for diameter, top, color in profile:
            solids.append((_rod(diameter * size[1] / 2, low * size[2], top * size[2]), color))
            low = top
        return tuple(solids)

    return build


def _row(profile: tuple[tuple[float, float, float, int], ...]) -> Callable[[Size], Solids]:
    """Boxes in a row along x: shares of length, width and height, and colours."""

    def build(size: Size) -> Solids:
        solids, start = [], -size[0] / 2
        for length, width, height, color in profile:
            end, half = start + length * size[0], width * size[1] / 2
            solids.append((_box((start, -half, 0.0), (end, half, height * size[2])), color))
            start = end
        return tuple(solids)

    return build


def _layers(profile: tuple[tuple[float, float, int], ...]) -> Callable[[Size], Solids]:
    """Boxes on each other: inset (m) of their sides, share of the height up to their tops, and colours."""

    def build(size: Size) -> Solids:
        solids, low = [], 0.0
        for inset, top, color in profile:
            x, y = size[0] / 2 - inset, size[1] / 2 - inset
            solids.append((_box((-x, -y, low * size[2]), (x, y, top * size[2])), color))
            low = top
        return tuple(solids)

    return build


CERAMIC = (
    ((0.93, 0.92, 0.88), (0.86, 0.85, 0.81)),
    ((0.36, 0.51, 0.58), (0.30, 0.44, 0.51)),
    ((0.75, 0.42, 0.30), (0.66, 0.36, 0.26)),
    ((0.85, 0.74, 0.48), (0.77, 0.66, 0.42)),
)
STEEL = (((0.72, 0.73, 0.75), (0.20, 0.20, 0.22)), ((0.72, 0.73, 0.75), (0.55, 0.34, 0.19)))
TOOLS = (((0.62, 0.63, 0.65), (0.78, 0.20, 0.14)), ((0.62, 0.63, 0.65), (0.93, 0.69, 0.13)))
PRINT = (
    ((0.80, 0.34, 0.22), (0.95, 0.92, 0.83)),
    ((0.22, 0.40, 0.58), (0.94, 0.93, 0.88)),
    ((0.35, 0.52, 0.33), (0.95, 0.92, 0.83)),
    ((0.90, 0.76, 0.36), (0.94, 0.93, 0.88)),
)
GLASS = (((0.30, 0.45, 0.32), (0.75, 0.70, 0.52)), ((0.52, 0.30, 0.20), (0.88, 0.87, 0.84)))
CLOTH = (
    ((0.88, 0.87, 0.84), (0.80, 0.79, 0.76)),
    ((0.47, 0.58, 0.66), (0.41, 0.51, 0.58)),
    ((0.72, 0.60, 0.56), (0.64, 0.53, 0.49)),
)


def _thing(
    name: str,
    where: str,
    low: Size,
    high: Size,
    density: float,
    colors: tuple,
    build: Callable[[Size], Solids],
) -> Thing:
    places = tuple(place.strip() for place in where.split(","))
    return Thing(
        name=name, where=places, low=low, high=high, density=density, colors=colors, build=build
    )  # fmt: skip


THINGS = (
    _thing(
        "cup", "kitchen shelf, kitchen drawer, office shelf", (0.105, 0.075, 0.08), (0.125, 0.09, 0.1),
        350.0, CERAMIC, _cup,
    ),
    _thing(
        "bowl", "kitchen shelf, kitchen drawer", (0.13, 0.13, 0.05), (0.18, 0.18, 0.075),
        250.0, CERAMIC, lambda size: _vessel(size, 0.5),
    ),
    _thing(
        "plate", "kitchen shelf, kitchen drawer", (0.19, 0.19, 0.02), (0.26, 0.26, 0.028),
        350.0, CERAMIC, lambda size: _vessel(size, 0.65),
    ),
    _thing(
        "bottle", "kitchen shelf, bathroom shelf, fridge", (0.06, 0.06, 0.17), (0.085, 0.085, 0.28),
        550.0, GLASS, _turned(((1.0, 0.6, 0), (0.75, 0.7, 0), (0.4, 0.92, 0), (0.46, 1.0, 1))),
    ),
    _thing(
        "jar", "kitchen shelf, bathroom shelf, workshop shelf, workshop drawer, fridge", (0.06, 0.06, 0.06),
        (0.1, 0.1, 0.13), 700.0, PRINT,
        _turned(((0.98, 0.12, 0), (1.0, 0.66, 1), (0.98, 0.84, 0), (0.9, 1.0, 1))),
    ),
    _thing(
        "carton", "kitchen shelf, office shelf, bedroom shelf, bathroom shelf, workshop shelf, fridge",
        (0.05, 0.09, 0.09), (0.11, 0.18, 0.24), 250.0, PRINT,
        _layers(((0.001, 0.3, 0), (0.0, 0.7, 1), (0.001, 1.0, 0))),
    ),
    _thing(
        "case", "kitchen drawer, office drawer, bedroom drawer, bathroom drawer, workshop drawer, fridge",
        (0.07, 0.05, 0.025), (0.15, 0.1, 0.055), 300.0, PRINT, _layers(((0.001, 0.7, 0), (0.0, 1.0, 1))),
    ),
    _thing(
        "spoon", "kitchen drawer", (0.17, 0.035, 0.008), (0.26, 0.06, 0.014),
        900.0, STEEL, _row(((0.3, 1.0, 1.0, 0), (0.3, 0.2, 0.8, 0), (0.4, 0.32, 1.0, 1))),
    ),
    _thing(
        "knife", "kitchen drawer", (0.2, 0.024, 0.01), (0.3, 0.036, 0.016),
        1500.0, STEEL, _row(((0.6, 1.0, 0.4, 0), (0.4, 0.75, 1.0, 1))),
    ),
    _thing(
        "pen", "office drawer, bedroom drawer", (0.13, 0.009, 0.008), (0.15, 0.012, 0.011),
        800.0, PRINT, _row(((0.06, 0.4, 0.5, 1), (0.64, 0.9, 0.9, 0), (0.3, 1.0, 1.0, 1))),
    ),
    _thing(
        "book", "office shelf, office drawer, bedroom shelf, bedroom drawer", (0.18, 0.12, 0.018),
        (0.26, 0.19, 0.04), 700.0, PRINT, _layers(((0.0, 0.12, 0), (0.004, 0.88, 1), (0.0, 1.0, 0))),
    ),
    _thing(
        "towel", "bathroom shelf, bathroom drawer, bedroom shelf, bedroom drawer", (0.2, 0.16, 0.04),
        (0.32, 0.24, 0.075), 180.0, CLOTH,
        _layers(((0.0, 0.32, 0), (0.006, 0.36, 1), (0.003, 0.66, 0), (0.008, 0.7, 1), (0.004, 1.0, 0))),
    ),
    _thing(
        "screwdriver", "workshop drawer, workshop shelf", (0.17, 0.024, 0.02), (0.26, 0.034, 0.03),
        900.0, TOOLS, _row(((0.58, 0.25, 0.25, 0), (0.42, 1.0, 1.0, 1))),
    ),
    _thing(
        "hammer", "workshop drawer, workshop shelf", (0.26, 0.1, 0.024), (0.32, 0.13, 0.032),
        900.0, TOOLS, _row(((0.1, 1.0, 1.0, 0), (0.45, 0.18, 0.7, 1), (0.45, 0.26, 0.9, 1))),
    ),
    _thing(
        "wrench", "workshop drawer", (0.15, 0.03, 0.008), (0.24, 0.045, 0.012),
        3000.0, TOOLS, _row(((0.18, 1.0, 1.0, 0), (0.64, 0.45, 0.7, 0), (0.18, 0.9, 1.0, 0))),
    ),
)  # fmt: skip
"""All things."""
