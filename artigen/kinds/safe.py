"""Safe: a steel box with thick walls, a heavy door with a dial, handwheel or keypad, and shelves."""

from dataclasses import replace
from math import radians

import numpy as np

from artigen.kind import EVERY, Kind, Place, by_height, make, plurals
from artigen.shapes.appliances.cavity import build_feet, build_shell
from artigen.shapes.appliances.control_panel import make_button
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Draft, Wish, choose_lengths
from artigen.shapes.fittings.fronts import FrontDesign, make_front
from artigen.shapes.fittings.handles import HandleDesign, make_handle, place_handle
from artigen.shapes.fittings.hardware import GAP, PASSING, Edge, Panel, Space, hinge, rotate, sweep_gap
from artigen.shapes.primitives import FRONT, Primitive, block, cylinder
from artigen.shapes.ranges import around, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.materials import LACQUERS, make_lacquer
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Safe"
STYLES = ("dial", "handwheel", "keypad")
COLORS = ("anthracite", "black", "grey", "forest", "navy", "white")
REACH = 0.06
"""Protrusion (m) of the parts that turn on the door."""
ARM = 0.0085
"""Radius (m) of the spokes of a lever or handwheel."""
DIAL = 0.042
"""Radius (m) of the largest combination dial: they are 75 to 85 mm wide, on large safes as well."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a safe that meets the wish."""
    style = wish.style or choose_one(rng, STYLES)
    color = make_lacquer(LACQUERS[choose_one(rng, COLORS)], gloss=choose(rng, 0.2, 0.5))
    finishes = draw_palette(rng, "appliance", "steel") | {"body": color, "front": color}
    width, depth, height = choose_lengths(rng, wish, ((0.32, 0.7), (0.3, 0.6), (0.3, 1.4)))
    wall, foot = choose(rng, 0.03, 0.06), float(rng.choice((0.0, 0.025)))
    x, y = (REACH - depth / 2, depth / 2), around(0.0, width / 2)
    outer = Space(x=x, y=y, z=(foot, height))
    hollow = outer.hollow(wall)
    thick, left = choose(rng, 0.7, 1.0) * wall, bool(rng.random() < 0.25)
    swing, (low, high) = sweep_gap(width - 2 * wall, thick), hollow.y
    across = (low + swing, high - GAP) if left else (low + GAP, high - swing)
    panel = Panel(x=x[0], thickness=thick, y=across, z=narrow(hollow.z, GAP))
    upper = radians(float(rng.choice((95.0, 110.0, 135.0, 165.0))))
    if not _passes_side(panel, upper, wall + GAP):
        upper = min(upper, radians(135.0))
    edge: Edge = "left" if left else "right"
    pad, lock = _make_lock(rng, panel, style, edge)
    solids = (*make_front(panel, FrontDesign(style="flat", frame=0.0, handle=None)), *pad)
    door = ShapePart("door", "door", solids, hinge(panel, edge, upper))
    feet = build_feet(x, y, foot, "rubber", radius=0.024) if foot else ()
    shelves = _make_shelves(rng, replace(hollow, x=(panel.back + 0.01, hollow.x[1])))
    built = Assembly((*build_shell(outer, hollow, "body", "inside"), *feet), (door, *lock, *shelves))
    return Draft(style, built.close(), finishes)


def _make_lock(
    rng: np.random.Generator, panel: Panel, style: str, edge: Edge
) -> tuple[tuple[Primitive, ...], tuple[ShapePart, ...]]:
    """A dial or keypad above a lever, a handwheel or a fixed handle: solids of the door, and its parts."""
    (y, z), size, wheel = panel.center, _lock_size(panel), style == "handwheel"
    apart = min(0.3 * panel.height, 2.6 * size) / 2 + 0.012
    spokes = _make_spokes(panel, (y, z - apart), size, count=4 if wheel else 2)
    if style == "keypad":
        plate, keys = _make_keypad(panel, (y, z + apart), size, enter=bool(rng.random() < 0.4))
        pull = HandleDesign(kind="pull", length=0.13, thickness=0.014, finish="steel")
        upright, at = place_handle(panel, pull, edge)
        handle = make_handle(panel, pull, name="pull", parent="door", upright=upright, at=at)
        return plate, (spokes if rng.random() < 0.6 else handle, *keys)
    return (), (_make_dial(panel, (y, z + apart), 0.7 * size if wheel else size), spokes)


def _lock_size(panel: Panel) -> float:
    """Size of a lock (m): spokes are a quarter longer than this."""
    return float(np.clip(0.17 * min(panel.width, panel.height), 0.03, 0.07))


def _passes_side(panel: Panel, upper: float, beside: float) -> bool:
    """Whether a lock ``beside`` metres from the hinge clears the body when the door is folded back."""
    nearest = panel.width / 2 - 1.25 * _lock_size(panel) - ARM
    return nearest * np.cos(np.pi - upper) > beside + PASSING


def _make_keypad(
    panel: Panel, at: tuple[float, float], size: float, *, enter: bool
) -> tuple[tuple[Primitive, ...], tuple[ShapePart, ...]]:
    """A plate with twelve keys as on a telephone, and a wide one below to ``enter`` the code."""
    x, pitch, edge, middle = panel.x - 0.008, 0.42 * size, 0.3 * size, (0.21 if enter else 0.0) * size
    plate = block((x, panel.x), around(at[0], 0.8 * size), around(at[1], 1.05 * size), "panel")
    places = [(column * pitch, (1.5 - row) * pitch + middle) for row in range(4) for column in (1, 0, -1)]
    sizes = [(edge, edge, 0.004)] * 12
    if enter:
        places.append((0.0, middle - 2.5 * pitch))
        sizes.append((2 * pitch + edge, edge, 0.004))
    keys = [
        make_button((x, at[0] + y, at[1] + z), extent, name=f"key_{k}", parent="door", finish="plastic")
        for k, ((y, z), extent) in enumerate(zip(places, sizes, strict=True))
    ]
    return (plate,), tuple(keys)


def _make_dial(panel: Panel, at: tuple[float, float], radius: float) -> ShapePart:
    """A combination dial: a flange, a knob and a mark."""
    x, radius = panel.x - 0.0015, min(radius, DIAL)
    up = (at[1] + 0.62 * radius, at[1] + radius)
    solids = (
        cylinder((x, *at), (x - 0.008, *at), radius, "panel"),
        cylinder((x - 0.008, *at), (x - 0.028, *at), 0.6 * radius, "steel"),
        block((x - 0.011, x - 0.008), around(at[0], 0.003), up, "inside"),
    )
    return ShapePart("dial", "knob", solids, rotate(FRONT, (x, *at)), parent="door")


def _make_spokes(panel: Panel, at: tuple[float, float], radius: float, count: int) -> ShapePart:
    """A hub with arms: two arms are a lever with a quarter turn, four a handwheel without limits."""
    x = panel.x - 0.0015
    middle = x - 0.035 + ARM
    solids = [cylinder((x, *at), (x - 0.035, *at), 0.4 * radius, "steel")]
    for turn in 2 * np.pi * np.arange(count) / count:
        run, rise = 1.25 * radius * float(np.cos(turn)), 1.25 * radius * float(np.sin(turn))
        solids.append(cylinder((middle, *at), (middle, at[0] + run, at[1] + rise), ARM, "steel"))
    motion = rotate(FRONT, (x, *at), None if count > 2 else np.pi / 2)
    return ShapePart("lever", "knob", solids, motion, parent="door")


def _make_shelves(rng: np.random.Generator, space: Space) -> list[ShapePart]:
    """Loose shelves, at least a hand's width apart."""
    count = int(space.height / choose(rng, 0.18, 0.3))
    levels = [space.z[0] + (k + 1) * space.height / (count + 1) for k in range(count)]
    return [
        ShapePart(f"shelf_{k}", "shelf", (block(space.x, space.y, (z, z + 0.012), "steel"),))
        for k, z in enumerate(levels)
    ]


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "safe",
        "strongbox",
        "gun safe",
        "lockbox",
        "lock box",
        "strong box",
    ),
    hints=(),
    size=(
        by_height(0.45, 1.7),
        by_height(1.3, note="gun safe"),
    ),
    deepest=np.inf,
    diagonal=(0.2, 2.5),
    build="sheet",
    stands="free",
    styles=tuple(STYLES),
    style_words={"combination": "dial", "digital": "keypad", "electronic": "keypad", "lock": EVERY},
    forms={"gun safe": ((0.5, 0.75), (0.4, 0.6), (1.3, 1.6))},
    sizes=((0.2, 1.2), (0.2, 1.0), (0.2, 2.2)),
    bare="height",
    make=make(density={"steel_sheet": 1150.0}),  # plates around concrete
    makes={},
    feet=True,
    trade=None,
    synset="safe.n.01",
    wikidata="Q471898",
    partnet=CATEGORY,
    body="safe_body",
    places=(Place(role="safe", low=(0.25, 0.3, 0.55), high=(0.65, 0.75, 1.35), draws=((0.0, 0.0, 0.9),)),),
    holds="things",
    open_front=0.08,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=8,
    draw=draw,
)
