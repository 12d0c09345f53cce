"""Dryer: a drum behind a round or square door, a water tank and a flap before the heat exchanger.

European tumble dryers are 0.6 m wide, 0.85 m high and 0.55 to 0.66 m deep; American ones are 0.69 m wide,
0.97 to 1.0 m high and up to 0.76 m deep.
"""

from dataclasses import replace
from math import radians

import numpy as np

from artigen.kind import EVERY, NONE, Kind, Place, by_height, make, plurals
from artigen.shapes.appliances.cavity import build_feet
from artigen.shapes.appliances.drums import build_bearing, build_porthole, fit_radius, make_drum
from artigen.shapes.appliances.laundry import (
    FACE,
    LID,
    WALL,
    LaundryPlan,
    build_cabinet,
    draw_band,
    make_door_grip,
)
from artigen.shapes.appliances.rings import build_pierced_plate
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Spans, Wish, choose_lengths
from artigen.shapes.fittings.hardware import GAP, Panel, hinge, slide, sweep_gap
from artigen.shapes.primitives import UP, Primitive, block, cylinder
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart, require
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Dryer"
STYLES = {"white": 5.0, "steel": 2.0, "black": 1.2, "american": 2.0}
EUROPEAN: Spans = ((0.59, 0.61), (0.55, 0.66), (0.84, 0.87))
AMERICAN: Spans = ((0.67, 0.7), (0.68, 0.76), (0.96, 1.0))


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a dryer that meets the wish."""
    style = choose_style(rng, STYLES, wish.style)
    american = style == "american"
    palette = draw_palette(
        rng, "appliance", choose_one(rng, ("white", "white", "steel")) if american else style
    )
    width, depth, height = choose_lengths(rng, wish, AMERICAN if american else EUROPEAN)
    plan = LaundryPlan(
        width=width, depth=depth, height=height, pedestal=0.0,
        thickness=choose(rng, 0.036, 0.05), band=choose(rng, 0.1, 0.14),
    )  # fmt: skip
    built = _build(rng, plan, square=american or bool(rng.random() < 0.12))
    return Draft(style, built.close(), palette)


def _build(rng: np.random.Generator, plan: LaundryPlan, *, square: bool) -> Assembly:
    """Cabinet, band, door, drum, lint filter, and the kick plate with its flap."""
    x, back, y = plan.front, plan.back, plan.y
    foot = choose(rng, 0.012, 0.025)
    kick = foot + choose(rng, 0.14, 0.17) * plan.height
    sill = plan.height - plan.band
    radius = min(choose(rng, 0.86, 0.96) * (sill - kick) / 2, 0.43 * plan.width)
    level = (kick + sill) / 2
    hole = choose(rng, 0.72, 0.78) * radius
    plate = build_pierced_plate((x, x + FACE), (y, (kick, sill)), (0.0, level, hole), "front", lining="steel")
    feet = build_feet((x + FACE, back), y, foot, "rubber", radius=0.022, inset=0.03)
    built = Assembly((*feet, *build_cabinet(plan, x, (foot, plan.height)), *plate))
    band = draw_band(rng, plan, x, (sill, plan.height - LID))
    tank = tuple(replace(part, name="water_tank") if part.label == "drawer" else part for part in band.parts)
    built += Assembly(band.pieces, tank)
    panel = Panel(x=plan.x, thickness=plan.thickness, y=around(0.0, radius), z=around(level, radius))
    built += _make_door(rng, plan, panel, hole, square=square)
    end, wall = back - WALL - 0.05, back - WALL
    room = min(plan.width / 2 - WALL, sill - level, level - kick + 0.02) - 0.008
    drum = make_drum(
        (0.0, 0.0, level), "x", (x + FACE + 0.055, end), fit_radius(room), paddles=int(rng.integers(2, 4))
    )
    bearing = build_bearing(end, wall, (0.0, 0.0, level), "x")
    built += Assembly((bearing,), (drum, _make_filter(x + FACE, level - hole, kick + 0.01)))
    return built + _make_kick(rng, plan, x, (foot, kick))


def _make_door(
    rng: np.random.Generator, plan: LaundryPlan, panel: Panel, hole: float, *, square: bool
) -> Assembly:
    """A round door with a glass or sheet bowl, or a square one with a plug; most have a grip."""
    edge = "right" if rng.random() < 0.8 else "left"
    upper = radians(choose(rng, 100, 165))
    y, z = panel.center
    if square:
        plug = cylinder((panel.back - 0.004, y, z), (panel.back + 0.03, y, z), 0.8 * hole, "steel")
        inset = 0.2 * panel.width
        finish = "panel" if rng.random() < 0.5 else "front"
        face = (panel.x - 0.003, panel.x + 0.002)
        field = block(face, narrow(panel.y, inset), narrow(panel.z, inset), finish)
        solids: tuple[Primitive, ...] = (panel.fill("front", 0.008), field, plug)
    else:
        pane = choose_one(rng, ("glass", "clear", "front"))
        solids = build_porthole(panel, 0.84 * hole, choose(rng, 0.03, 0.045), pane)
    door = ShapePart("door", "door", solids, hinge(panel, edge, upper))
    grip = make_door_grip(plan, panel, edge, 0.84 * hole, choose(rng, 0.1, 0.16))
    return Assembly(parts=(door, grip))


def _make_filter(x: float, sill: float, lowest: float) -> ShapePart:
    """The lint filter: a sieve behind the front, below the opening, which is pulled up by a tab."""
    front, half, low = x + GAP, 0.085, max(sill - 0.11, lowest)
    solids = (
        block((front, front + 0.014), around(0.0, half), (low, sill - 0.004), "plastic"),
        block((front, front + 0.014), around(0.0, 0.5 * half), (sill - 0.004, sill + 0.012), "plastic"),
    )
    lift = slide(0.85 * (sill - low), UP)
    return ShapePart("lint_filter", "tray", solids, lift, needs=require("door"))


def _make_kick(rng: np.random.Generator, plan: LaundryPlan, x: float, z: Range) -> Assembly:
    """The kick plate, with a flap before the fins of the heat exchanger."""
    wide, thick = choose(rng, 0.24, 0.34), 0.014
    left = plan.y[1] - 0.05 if rng.random() < 0.5 else plan.y[0] + 0.05 + wide
    hole = (left - wide, left)
    pieces = [
        block((x, x + FACE), (plan.y[0], hole[0]), z, "front"),
        block((x, x + FACE), (hole[1], plan.y[1]), z, "front"),
    ]
    floor = z[0] + 0.018
    for k in range(3):
        at = hole[0] + (k + 0.5) * wide / 3 - 0.02
        pieces.append(block((x + 0.06, x + 0.19), (at, at + 0.04), (floor, z[1] - 0.012), "steel"))
    room = sweep_gap(z[1] - z[0], thick)
    panel = Panel(x=x, thickness=thick, y=narrow(hole, GAP), z=(z[0] + GAP, z[1] - room))
    across, up = (left - 0.65 * wide, left - 0.35 * wide), (panel.z[1] - 0.016, panel.z[1] - 0.004)
    solids = (panel.fill("front", 0.002), block((x - 0.008, x), across, up, "front"))
    flap = ShapePart("flap", "door", solids, hinge(panel, "bottom", radians(88)))
    return Assembly(pieces, (flap,))


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("tumble dryer", "dryer", "tumble drier", "drier", "clothes dryer", "clothes drier"),
    hints=(),
    size=(by_height(0.85),),
    deepest=np.inf,
    diagonal=(0.6, 2.0),
    build="sheet",
    stands="free",
    styles=tuple(STYLES),
    style_words={"front loading": EVERY, "front load": EVERY, "top loading": NONE, "top load": NONE},
    forms={},
    sizes=((0.4, 0.9), (0.4, 1.0), (0.6, 1.4)),
    bare="width",
    make=make(hidden=4.0, filled=30.0),  # motor, fan
    makes={},
    feet=True,
    trade="appliance",
    synset="clothes_dryer.n.01",
    wikidata=None,
    partnet=None,
    body="dryer_body",
    places=(Place(role="dryer", low=(0.4, 0.5, 0.7), high=(0.8, 0.8, 1.2), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=0.03,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=15,
    draw=draw,
)
