"""Safe: a steel box with thick walls, a heavy door with a turning dial or handwheel, and shelves."""

from dataclasses import replace
from math import radians

import numpy as np

from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Draft, Wish
from artigen.shapes.fittings.fronts import FrontDesign, make_door
from artigen.shapes.fittings.hardware import GAP, PASSING, Panel, Space, around, narrow, sweep_gap
from artigen.shapes.primitives import DOWN, FRONT, LEFT, RIGHT, UP, Primitive, block, cylinder, line
from artigen.shapes.shape import Motion, ShapePart, make_base
from artigen.shapes.surfaces.materials import LACQUERS, make_lacquer
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Safe"
STYLES = ("dial", "handwheel", "keypad")
COLORS = ("anthracite", "black", "grey", "forest", "navy", "white")
BODY, DOOR = "body", "door"
ARM = 0.0085
"""Radius (m) of the spokes of a lever or handwheel."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a safe that meets the wish."""
    style = wish.style or choose_one(rng, STYLES)
    color = make_lacquer(LACQUERS[choose_one(rng, COLORS)], gloss=choose(rng, 0.2, 0.5))
    finishes = draw_palette(rng, "appliance", "steel") | {"body": color, "front": color}
    width = choose(rng, 0.32, 0.7, wish.width)
    depth = choose(rng, 0.3, 0.6, wish.depth)
    height = choose(rng, 0.3, 1.4, wish.height)
    wall = choose(rng, 0.03, 0.06)
    reach = 0.06  # of the parts that turn on the door
    foot = float(rng.choice((0.0, 0.025)))
    outer = Space(x=(reach - depth / 2, depth / 2), y=around(0.0, width / 2), z=(foot, height))
    thick = choose(rng, 0.7, 1.0) * wall
    left = bool(rng.random() < 0.25)
    swing = sweep_gap(width - 2 * wall, thick)
    panel = Panel(
        x=outer.x[0],
        thickness=thick,
        y=(outer.y[0] + wall + (swing if left else GAP), outer.y[1] - wall - (GAP if left else swing)),
        z=(foot + wall + GAP, height - wall - GAP),
    )
    plain = FrontDesign(style="flat", frame=0.0, handle=None)
    upper = radians(float(rng.choice((95.0, 110.0, 135.0, 165.0))))
    if not _passes_side(panel, upper, wall + GAP):
        upper = min(upper, radians(135.0))
    door = make_door(panel, plain, name=DOOR, edge="left" if left else "right", upper=upper)[0]
    pad, lock = _make_lock(panel, style)
    door = replace(door, primitives=(*door.primitives, *pad))
    body = make_base(_make_body(outer, wall, foot))
    shelves = _make_shelves(rng, outer, wall, panel.back + 0.01)
    return Draft(style, (body, door, *lock, *shelves), finishes)


def _make_body(outer: Space, wall: float, foot: float) -> tuple[Primitive, ...]:
    """Five walls without the front, with a lining, on four pads if ``foot`` is not 0."""
    x, y, z = outer.x, outer.y, outer.z
    inner_y, back = narrow(y, wall), x[1] - wall
    walls = (
        line(block(x, (y[0], inner_y[0]), z, "body"), "inside", LEFT),
        line(block(x, (inner_y[1], y[1]), z, "body"), "inside", RIGHT),
        line(block(x, inner_y, (z[0], z[0] + wall), "body"), "inside", UP),
        line(block(x, inner_y, (z[1] - wall, z[1]), "body"), "inside", DOWN),
        line(block((back, x[1]), inner_y, narrow(z, wall), "body"), "inside", FRONT),
    )
    pads = [(a, b) for a in narrow(x, 0.05) for b in narrow(y, 0.05)] if foot else []
    return (*walls, *(cylinder((a, b, 0.0), (a, b, foot), 0.024, "rubber") for a, b in pads))


def _make_lock(panel: Panel, style: str) -> tuple[tuple[Primitive, ...], tuple[ShapePart, ...]]:
    """A dial or keypad above a lever or handwheel: solids of the door, and turning parts."""
    y, z = panel.center
    size = _lock_size(panel)
    apart = min(0.3 * panel.height, 2.6 * size) / 2 + 0.012
    upper, lower = (y, z + apart), (y, z - apart)
    spokes = _make_spokes(panel, lower, size, count=4 if style == "handwheel" else 2)
    if style == "keypad":
        return _make_keypad(panel, upper, size), (spokes,)
    return (), (_make_dial("dial", panel, upper, 0.7 * size if style == "handwheel" else size), spokes)


def _lock_size(panel: Panel) -> float:
    """Radius of the largest dial (m); spokes are a quarter longer."""
    return float(np.clip(0.17 * min(panel.width, panel.height), 0.03, 0.07))


def _passes_side(panel: Panel, upper: float, beside: float) -> bool:
    """Whether a lock ``beside`` metres from the hinge clears the body when the door is folded back."""
    nearest = panel.width / 2 - 1.25 * _lock_size(panel) - ARM
    return nearest * np.cos(np.pi - upper) > beside + PASSING


def _make_keypad(panel: Panel, at: tuple[float, float], size: float) -> tuple[Primitive, ...]:
    """A keypad: a plate with nine keys."""
    x, pitch, half = panel.x - 0.008, 0.5 * size, 0.17 * size
    plate = block((x, panel.x), around(at[0], size), around(at[1], 0.9 * size), "panel")
    keys = [
        block((x - 0.004, x), around(y, half), around(z, half), "plastic")
        for y in (at[0] - pitch, at[0], at[0] + pitch)
        for z in (at[1] - pitch, at[1], at[1] + pitch)
    ]
    return (plate, *keys)


def _make_dial(name: str, panel: Panel, at: tuple[float, float], radius: float) -> ShapePart:
    """A combination dial: a flange, a knob and a mark."""
    x = panel.x - 0.0015
    solids = (
        cylinder((x, *at), (x - 0.008, *at), radius, "panel"),
        cylinder((x - 0.008, *at), (x - 0.028, *at), 0.6 * radius, "steel"),
        block(
            (x - 0.011, x - 0.008), around(at[0], 0.003), (at[1] + 0.62 * radius, at[1] + radius), "inside"
        ),
    )
    return ShapePart(name, "knob", solids, _turn(x, at, 2 * np.pi), parent=DOOR)


def _make_spokes(panel: Panel, at: tuple[float, float], radius: float, count: int) -> ShapePart:
    """A hub with arms: two arms are a lever with a quarter turn, four a handwheel without limits."""
    x = panel.x - 0.0015
    solids = [cylinder((x, *at), (x - 0.035, *at), 0.4 * radius, "steel")]
    for k in range(count):
        turn = 2 * np.pi * k / count
        tip = (at[0] + radius * 1.25 * np.cos(turn), at[1] + radius * 1.25 * np.sin(turn))
        solids.append(
            cylinder((x - 0.035 + ARM, *at), (x - 0.035 + ARM, float(tip[0]), float(tip[1])), ARM, "steel")
        )
    motion = _turn(x, at, 2 * np.pi if count > 2 else np.pi / 2)
    return ShapePart("lever", "knob", tuple(solids), motion, parent=DOOR)


def _turn(x: float, at: tuple[float, float], upper: float) -> Motion:
    kind = "continuous" if upper > 6 else "revolute"
    return Motion(type=kind, axis=FRONT, origin=(x, *at), upper=upper)


def _make_shelves(rng: np.random.Generator, outer: Space, wall: float, front: float) -> list[ShapePart]:
    """Loose shelves, at least a hand's width apart."""
    low, high = narrow(outer.z, wall)
    count = int((high - low) / choose(rng, 0.18, 0.3))
    levels = [low + (k + 1) * (high - low) / (count + 1) for k in range(count)]
    y = narrow(outer.y, wall)
    return [
        ShapePart(f"shelf_{k}", "shelf", (block((front, outer.x[1] - wall), y, (z, z + 0.012), "steel"),))
        for k, z in enumerate(levels)
    ]
