"""Small things that drawers and cupboards hold, made of boxes and cylinders.

A thing stands with its lowest point at z = 0, centred over the origin.
"""

from dataclasses import dataclass
from functools import lru_cache

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
STAVES = 12
"""Number of boxes around a vessel."""
WHITE, CREAM, DARK, GREY = (0.93, 0.92, 0.88), (0.86, 0.85, 0.81), (0.20, 0.20, 0.22), (0.70, 0.71, 0.73)
RED, BLUE, GREEN, YELLOW = (0.78, 0.33, 0.23), (0.26, 0.43, 0.57), (0.35, 0.50, 0.35), (0.88, 0.75, 0.40)
BROWN = (0.50, 0.31, 0.20)
CERAMIC = tuple((color, color) for color in (WHITE, BLUE, RED, YELLOW))
PRINT = tuple((color, CREAM) for color in (RED, BLUE, GREEN, YELLOW))
CLOTH = ((WHITE, CREAM), (BLUE, GREY), (CREAM, WHITE))
STEEL, TOOLS = ((GREY, DARK), (GREY, BROWN)), ((GREY, RED), (GREY, YELLOW))
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


@lru_cache(maxsize=4096)
def thing_solids(name: str, size: Size) -> Solids:
    """The primitives of a thing; raises `ValueError` for an unknown name."""
    thing = next((thing for thing in THINGS if thing.name == name), None)
    if thing is None:
        raise ValueError(f"thing {name!r}, expected one of {', '.join(thing.name for thing in THINGS)}")
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
    edges = (WALL, float(2 * top * np.tan(np.pi / STAVES)), length)
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
          ((CREAM, GREEN), (RED, GREEN), (DARK, GREEN)), round=True,
          rows=((0, 1, 0.6, 0, 0.36, 0), (0, 1, 0.12, 0.36, 0.44, 1), (0, 1, 0.85, 0.44, 0.6, 1),
                (0, 1, 1, 0.6, 0.84, 1), (0, 1, 0.65, 0.84, 1, 1))),
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
)  # fmt: skip
"""All things."""
