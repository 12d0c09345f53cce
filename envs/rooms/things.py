"""Small things that drawers and cupboards hold, made of boxes and cylinders.

A thing stands with its lowest point at z = 0, centred over the origin.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from artigen.transforms import shift
from sim_export.geometry.primitives import PrimitiveShape, primitive_hull
from sim_export.package import Hull

Color = tuple[float, float, float]
Size = tuple[float, float, float]
Row = tuple[float, float, float, float, float, int]
Solids = tuple[tuple[PrimitiveShape, int], ...]
"""Primitives, each with the index of its colour."""
WALL = 0.005
"""Thickness (m) of the walls of vessels."""
SHY = 0.001
"""Height (m) at which the walls of vessels begin above the ground, so that the bottom alone touches it."""
STAVES = 12
"""Number of boxes around a vessel."""
WHITE, CREAM, DARK, GREY = (0.93, 0.92, 0.88), (0.86, 0.85, 0.81), (0.20, 0.20, 0.22), (0.70, 0.71, 0.73)
RED, BLUE, GREEN, YELLOW = (0.78, 0.33, 0.23), (0.26, 0.43, 0.57), (0.35, 0.50, 0.35), (0.88, 0.75, 0.40)
BROWN = (0.50, 0.31, 0.20)
CERAMIC = tuple((color, color) for color in (WHITE, BLUE, RED, YELLOW))
PRINT = tuple((color, CREAM) for color in (RED, BLUE, GREEN, YELLOW))
CLOTH = ((WHITE, CREAM), (BLUE, GREY), (CREAM, WHITE))
STEEL, TOOLS = ((GREY, DARK), (GREY, BROWN)), ((GREY, RED), (GREY, YELLOW))
SEATS = ((BROWN, BROWN), (DARK, CREAM), (WHITE, GREY), (BROWN, CREAM), (DARK, BROWN))
BAND = ((0.0, 1.0, 0.98, 0.0, 0.3, 0), (0.0, 1.0, 1.0, 0.3, 0.7, 1), (0.0, 1.0, 0.98, 0.7, 1.0, 0))


@dataclass(frozen=True)
class Thing:
    """A kind of thing: where it belongs, the range of its size (m), its looks.

    ``where`` names a kind of room and ``drawer``, ``shelf`` or ``top``, or ``fridge``. ``density`` is the
    mass per volume of its box (kg/m^3). ``rows`` are its boxes: start and end along x, width, bottom and top
    as shares of the size, and index of the colour. If it is ``round``, they are cylinders with that diameter.
    A vessel has no rows but a flat bottom with ``foot`` times its diameter. What ``faces`` somewhere has its
    face towards -x. ``across`` turns the rows to run along y.
    """

    name: str
    where: tuple[str, ...]
    low: Size
    high: Size
    density: float
    colors: tuple[tuple[Color, Color], ...]
    rows: tuple[Row, ...] = ()
    round: bool = False
    foot: float | None = None
    faces: bool = False
    across: bool = False
    draw: Callable[[Size], Solids] | None = None
    """Draws the solids of what rows cannot say."""


@lru_cache(maxsize=4096)
def thing_solids(name: str, size: Size) -> Solids:
    """The primitives of a thing; raises `ValueError` for an unknown name."""
    thing = next((thing for thing in THINGS if thing.name == name), None)
    if thing is None:
        raise ValueError(f"thing {name!r}, expected one of {', '.join(thing.name for thing in THINGS)}")
    if thing.draw is not None:
        return thing.draw(size)
    if thing.foot is not None:
        return _vessel(size, thing.foot)
    solids = []
    for start, end, width, bottom, top, color in thing.rows:
        low, high, span = bottom * size[2], top * size[2], width * size[0 if thing.across else 1]
        if thing.round:
            solids.append((_rod(span / 2, low, high), color))
        else:
            first, last = ((share - 0.5) * size[1 if thing.across else 0] for share in (start, end))
            corners = ((first, -span / 2, low), (last, span / 2, high))
            if thing.across:
                corners = ((-span / 2, first, low), (span / 2, last, high))
            solids.append((_box(*corners), color))
    return tuple(solids)


@lru_cache(maxsize=4096)
def thing_hulls(name: str, size: Size) -> tuple[Hull, ...]:
    """One hull per primitive of a thing."""
    return tuple(primitive_hull(solid) for solid, _ in thing_solids(name, size))


def _box(low: Size, high: Size) -> PrimitiveShape:
    T = shift((np.array(low) + high) / 2)
    return PrimitiveShape(kind="box", sizes=tuple(np.subtract(high, low).tolist()), T_object_shape=T)


def _rod(radius: float, low: float, high: float, x: float = 0.0) -> PrimitiveShape:
    T = shift(np.array([x, 0.0, (low + high) / 2]))
    return PrimitiveShape(kind="cylinder", sizes=(radius, high - low), T_object_shape=T)


def _vessel(size: Size, foot: float) -> Solids:
    """A round vessel with flared walls of boxes; its handle takes the difference of length and width."""
    top, height = size[1] / 2 * np.cos(np.pi / STAVES), size[2]
    base = foot * top
    rim = height - WALL * np.sin(np.arctan2(top - base, height))
    tilt, length = np.arctan2(top - base, rim), float(np.hypot(top - base, rim))
    c, s = np.cos(tilt), np.sin(tilt)
    stave = np.eye(4)
    stave[:3, :3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    stave[:3, 3] = [(base + top) / 2 - WALL / 2 * c, 0.0, rim / 2 + WALL / 2 * s]
    stave[:3, 3] += stave[:3, 2] * SHY / c / 2
    edges = (WALL, float(2 * top * np.tan(np.pi / STAVES)), length - SHY / c)
    reach, bar = size[0] - size[1], 0.005
    solids = [(_rod(base, 0.0, WALL, -reach / 2), 1)]
    for angle in np.arange(STAVES) * 2 * np.pi / STAVES:
        turn = np.eye(4)
        turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        turn[0, 3] = -reach / 2
        solids.append((PrimitiveShape(kind="box", sizes=edges, T_object_shape=turn @ stave), 0))
    if reach > 2 * bar:
        start, end, low, high = 0.46 * size[1] - reach / 2, size[0] / 2, 0.25 * height, 0.75 * height
        spans = ((start, end, low, low + bar), (start, end, high - bar, high), (end - bar, end, low, high))
        solids += [(_box((x0, -bar, z0), (x1, bar, z1)), 0) for x0, x1, z0, z1 in spans]
    return tuple(solids)


def _chair(size: Size) -> Solids:
    """A chair that faces -x: four legs, a seat, two posts and two rails."""
    x, y, z = size[0] / 2, size[1] / 2, size[2]
    seat, leg = 0.45, 0.035
    feet = [(-x, -y), (-x, y - leg), (x - leg, -y), (x - leg, y - leg)]
    parts = [(_box((a, b, 0.0), (a + leg, b + leg, seat if a < 0 else z)), 0) for a, b in feet]
    rails = [(0.6 * (z - seat) + seat, z), (0.2 * (z - seat) + seat, 0.4 * (z - seat) + seat)]
    back = [(_box((x - leg, leg - y, low), (x - 0.3 * leg, y - leg, high)), 0) for low, high in rails]
    return (*parts, (_box((-x, -y, seat), (x - leg, y, seat + 0.03)), 1), *((solid, 0) for solid, _ in back))


def _stool(size: Size) -> Solids:
    """A bar stool: four legs, a ring of rails for feet, a round seat."""
    r, z, leg = 0.8 * size[0] / 2, size[2], 0.03
    feet = [(-r, -r), (-r, r - leg), (r - leg, -r), (r - leg, r - leg)]
    parts = [(_box((a, b, 0.0), (a + leg, b + leg, z - 0.04)), 0) for a, b in feet]
    rails = [((leg - r, a, 0.25), (r - leg, a + leg, 0.27)) for a in (-r, r - leg)]
    return (*parts, *((_box(low, high), 0) for low, high in rails), (_rod(size[0] / 2, z - 0.04, z), 1))


def _office_chair(size: Size) -> Solids:
    """An office chair that faces -x: a round foot, a column, a seat, a back on a bar."""
    x, y, z = size[0] / 2, size[1] / 2, size[2]
    return (
        (_rod(0.9 * y, 0.0, 0.05), 0), (_rod(0.035, 0.05, 0.42), 0),
        (_box((-x, -0.85 * y, 0.42), (0.7 * x, 0.85 * y, 0.49)), 1),
        (_box((0.7 * x, -0.03, 0.44), (0.82 * x, 0.03, 0.70)), 0),
        (_box((0.82 * x, -0.8 * y, 0.56), (x, 0.8 * y, z)), 1),
    )  # fmt: skip


def _shoes(size: Size) -> Solids:
    """A pair of shoes whose toes point to -x."""
    x, y, z = size[0] / 2, size[1] / 2, size[2]
    pair = []
    for low, high in ((-y, -0.1 * y), (0.1 * y, y)):
        pair += [
            (_box((-x, low, 0.0), (x, high, 0.2 * z)), 1),
            (_box((-x, low, 0.2 * z), (0.1 * x, high, 0.6 * z)), 0),
        ]
        pair.append((_box((0.1 * x, low, 0.2 * z), (0.9 * x, high, z)), 0))
    return tuple(pair)


def _keyboard(size: Size) -> Solids:
    """A keyboard with its rows of keys along y."""
    x, y, z = size[0] / 2, size[1] / 2, size[2]
    edges = np.linspace(-0.9 * x, 0.9 * x, 6)
    keys = [((a + 0.002, -0.96 * y, 0.6 * z), (b - 0.002, 0.96 * y, z)) for a, b in pairwise(edges.tolist())]
    return ((_box((-x, -y, 0.0), (x, y, 0.6 * z)), 0), *((_box(low, high), 1) for low, high in keys))


def _kettle(size: Size) -> Solids:
    """A kettle: a round body with a lid, a spout and a handle on the other side."""
    z, handle = size[2], 0.3 * size[0]
    r = size[1] / 2
    at = (size[1] - size[0]) / 2
    bar = size[0] / 2
    return (
        (_rod(r, 0.0, 0.8 * z, at), 0), (_rod(0.8 * r, 0.8 * z, 0.9 * z, at), 0),
        (_rod(0.012, 0.9 * z, z, at), 1),
        (_box((bar - handle, -0.01, 0.72 * z), (bar, 0.01, 0.8 * z)), 1),
        (_box((bar - 0.02, -0.01, 0.3 * z), (bar, 0.01, 0.72 * z)), 1),
    )  # fmt: skip


def _plant(size: Size) -> Solids:
    """A pot with a shoot as high as the plant, and leaves in two rings."""
    r, z = size[0] / 2, size[2]
    pot = min(0.36 * z, 1.1 * r)
    solids = [(_rod(0.62 * r, 0.0, pot), 0), (_rod(0.04 * r, pot, z), 1)]
    for count, out, tip, wide in ((7, 0.9, 0.78, 0.26), (5, 0.45, 0.98, 0.24)):
        rise, reach = tip * z - pot, out * r
        tilt, long = np.arctan2(reach, rise), float(np.hypot(rise, reach))
        c, s = np.cos(tilt), np.sin(tilt)
        leaf = np.eye(4)
        leaf[:3, :3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
        leaf[:3, 3] = [reach / 2, 0.0, pot + rise / 2]
        for angle in (np.arange(count) + 0.5 * (count % 2)) * 2 * np.pi / count:
            turn = np.eye(4)
            turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
            edges = (0.03 * r, wide * 2 * r, long)
            solids.append((PrimitiveShape(kind="box", sizes=edges, T_object_shape=turn @ leaf), 1))
    return tuple(solids)


def _in(rooms: str, *places: str) -> tuple[str, ...]:
    return tuple(f"{room} {place}" for room in rooms.split() for place in places)


THINGS = (
    Thing("cup", _in("living_room", "shelf", "top") + _in("kitchen", "shelf", "drawer", "top") +
          _in("office", "shelf", "top"),
          (0.105, 0.075, 0.08),
          (0.125, 0.09, 0.1), 350, CERAMIC, foot=0.85),
    Thing("bowl", _in("kitchen", "shelf", "drawer", "top"), (0.13, 0.13, 0.05),
          (0.18, 0.18, 0.075), 250, CERAMIC,
          foot=0.5),
    Thing("plate", _in("kitchen", "shelf", "drawer"), (0.19, 0.19, 0.02), (0.26, 0.26, 0.028), 350, CERAMIC,
          foot=0.65),
    Thing("bottle", (*_in("laundry", "shelf", "top"), *_in("kitchen bathroom", "shelf", "top"), "fridge"),
          (0.06, 0.06, 0.17),
          (0.085, 0.085, 0.28),
          550, ((GREEN, YELLOW), (BROWN, CREAM)), round=True,
          rows=((0, 1, 1, 0, 0.6, 0), (0, 1, 0.75, 0.6, 0.7, 0),
                (0, 1, 0.4, 0.7, 0.92, 0), (0, 1, 0.46, 0.92, 1, 1))),
    Thing("jar", (*_in("kitchen bathroom workshop", "shelf", "top"), *_in("workshop", "drawer"), "fridge"),
          (0.06, 0.06, 0.06), (0.1, 0.1, 0.13), 700, PRINT, rows=BAND, round=True),
    Thing("carton", (*_in("living_room hall laundry", "shelf", "drawer"),
          *_in("kitchen office bedroom bathroom workshop", "shelf"), "fridge"), (0.05, 0.09, 0.09),
          (0.11, 0.18, 0.24), 250, PRINT, rows=BAND),
    Thing("case", (*_in("kitchen office bedroom bathroom workshop", "drawer"), "fridge"), (0.07, 0.05, 0.025),
          (0.15, 0.1, 0.055), 300, PRINT, rows=((0.01, 0.99, 0.98, 0, 0.7, 0), (0, 1, 1, 0.7, 1, 1))),
    Thing("spoon", _in("kitchen", "drawer"), (0.17, 0.035, 0.008), (0.26, 0.06, 0.014), 900, STEEL,
          rows=((0, 0.3, 1, 0, 1, 0), (0.3, 0.6, 0.2, 0, 0.8, 0), (0.6, 1, 0.32, 0, 1, 1))),
    Thing("knife", _in("kitchen", "drawer"), (0.2, 0.024, 0.01), (0.3, 0.036, 0.016), 1500, STEEL,
          rows=((0, 0.6, 1, 0, 0.4, 0), (0.6, 1, 0.75, 0, 1, 1))),
    Thing("pen", _in("office bedroom", "drawer") + _in("office", "top"), (0.13, 0.009, 0.008),
          (0.15, 0.012, 0.011), 800, PRINT,
          rows=((0, 0.06, 0.4, 0, 0.5, 1), (0.06, 0.7, 0.9, 0, 0.9, 0), (0.7, 1, 1, 0, 1, 1))),
    Thing("book", _in("living_room hall", "shelf", "drawer") +
          _in("office bedroom", "shelf", "drawer", "top"), (0.18, 0.12, 0.018),
          (0.26, 0.19, 0.04), 700,
          PRINT, rows=((0, 1, 1, 0, 0.12, 0), (0.02, 0.98, 0.95, 0.12, 0.88, 1), (0, 1, 1, 0.88, 1, 0))),
    Thing("books", _in("office bedroom living_room", "shelf"), (0.13, 0.16, 0.19), (0.17, 0.36, 0.24), 550,
          ((RED, BLUE), (GREEN, CREAM), (BLUE, YELLOW), (BROWN, CREAM)), faces=True, across=True,
          rows=((0, 0.14, 1, 0, 1, 0), (0.14, 0.3, 0.9, 0, 0.9, 1), (0.3, 0.42, 0.95, 0, 0.95, 0),
                (0.42, 0.6, 0.85, 0, 0.84, 1), (0.6, 0.72, 1, 0, 0.97, 0), (0.72, 0.9, 0.9, 0, 0.9, 1),
                (0.9, 1, 0.92, 0, 0.8, 0))),
    Thing("towel", _in("laundry", "shelf", "drawer", "top") +
          _in("bathroom bedroom", "shelf", "drawer") + _in("bathroom", "top"), (0.2, 0.16, 0.04),
          (0.32, 0.24, 0.075), 180,
          CLOTH, rows=((0, 1, 1, 0, 0.48, 0), (0.02, 0.98, 0.96, 0.48, 0.52, 1), (0, 1, 0.98, 0.52, 1, 0))),
    Thing("screwdriver", _in("workshop", "drawer", "shelf", "top"), (0.17, 0.024, 0.02),
          (0.26, 0.034, 0.03), 900,
          TOOLS, rows=((0, 0.58, 0.25, 0, 0.25, 0), (0.58, 1, 1, 0, 1, 1))),
    Thing("hammer", _in("workshop", "drawer", "shelf", "top"), (0.26, 0.1, 0.024),
          (0.32, 0.13, 0.032), 900, TOOLS,
          rows=((0, 0.1, 1, 0, 1, 0), (0.1, 0.55, 0.18, 0, 0.7, 1), (0.55, 1, 0.26, 0, 0.9, 1))),
    Thing("plant", _in("living_room hall", "top") +
          _in("kitchen office bedroom bathroom", "top"), (0.14, 0.14, 0.22), (0.22, 0.22, 0.38), 250,
          ((CREAM, GREEN), (RED, GREEN), (DARK, GREEN)), draw=_plant),
    Thing("lamp", _in("living_room", "top") +
          _in("office bedroom", "top"), (0.2, 0.2, 0.34), (0.28, 0.28, 0.46), 60,
          ((DARK, CREAM), (GREY, WHITE), (YELLOW, WHITE)), round=True,
          rows=((0, 1, 0.55, 0, 0.05, 0), (0, 1, 0.07, 0.05, 0.6, 0), (0, 1, 1, 0.6, 1, 1))),
    Thing("monitor", _in("office", "top"), (0.17, 0.48, 0.38), (0.2, 0.6, 0.46), 90, ((DARK, DARK),),
          rows=((0, 1, 0.4, 0, 0.03, 0), (0.55, 0.7, 0.1, 0.03, 0.4, 0), (0.4, 0.55, 1, 0.28, 1, 1)),
          faces=True),
    Thing("board", _in("kitchen", "top"), (0.3, 0.2, 0.015), (0.4, 0.28, 0.022), 650, ((BROWN, BROWN),),
          rows=((0, 1, 1, 0, 1, 0),)),
    Thing("fruit_bowl", _in("kitchen", "top"), (0.22, 0.22, 0.1), (0.28, 0.28, 0.13), 220,
          ((WHITE, YELLOW), (DARK, RED), (CREAM, GREEN)), round=True,
          rows=((0, 1, 0.4, 0, 0.12, 0), (0, 1, 1, 0.12, 0.5, 0), (0, 1, 0.8, 0.5, 0.8, 1),
                (0, 1, 0.4, 0.8, 1, 1))),
    Thing("kettle", _in("kitchen", "top"), (0.22, 0.15, 0.2), (0.25, 0.17, 0.24), 180,
          ((GREY, DARK), (RED, DARK), (CREAM, BROWN)), draw=_kettle),
    Thing("keyboard", _in("office", "top"), (0.13, 0.4, 0.022), (0.15, 0.45, 0.026), 400,
          ((DARK, GREY), (GREY, WHITE)), faces=True, draw=_keyboard),
    Thing("soap", _in("bathroom laundry", "top"), (0.07, 0.07, 0.15), (0.08, 0.08, 0.2), 600,
          ((CREAM, DARK), (BLUE, WHITE)), round=True,
          rows=((0, 1, 1, 0, 0.7, 0), (0, 1, 0.3, 0.7, 0.9, 1), (0, 1, 0.6, 0.9, 1, 1))),
    Thing("chair", (), (0.44, 0.42, 0.86), (0.48, 0.46, 0.92), 28, SEATS, faces=True, draw=_chair),
    Thing("stool", (), (0.36, 0.36, 0.62), (0.38, 0.38, 0.66), 50, SEATS, faces=True, draw=_stool),
    Thing("office_chair", (), (0.56, 0.56, 0.9), (0.6, 0.6, 1.0), 40,
          ((DARK, DARK), (DARK, BLUE), (GREY, DARK)), faces=True, draw=_office_chair),
    Thing("floor_lamp", (), (0.34, 0.34, 1.5), (0.42, 0.42, 1.65), 18,
          ((DARK, CREAM), (GREY, WHITE), (BROWN, CREAM)), round=True,
          rows=((0, 1, 0.75, 0, 0.02, 0), (0, 1, 0.06, 0.02, 0.8, 0), (0, 1, 1, 0.8, 1, 1))),
    Thing("floor_plant", (), (0.34, 0.34, 0.9), (0.46, 0.46, 1.3), 60,
          ((CREAM, GREEN), (DARK, GREEN), (GREY, GREEN)), draw=_plant),
    Thing("shoes", (), (0.26, 0.2, 0.09), (0.3, 0.22, 0.12), 150,
          ((DARK, GREY), (BROWN, CREAM), (BLUE, WHITE), (WHITE, GREY)), faces=True, draw=_shoes),
    Thing("basket", (), (0.36, 0.36, 0.3), (0.42, 0.42, 0.42), 40, ((CREAM, BROWN), (GREY, GREY)), foot=0.85),
)  # fmt: skip
"""All things."""
