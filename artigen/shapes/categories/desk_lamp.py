"""DeskLamp: a foot, a lower arm, an upper arm and a tilting head (a chain of three hinges), and a switch.

Arms are 300 to 450 mm long, as in balanced-arm lamps. At rest the lower arm leans back and the upper one
forward. The joints move the lower arm forward, the upper arm up and the head up.
"""

from math import radians

import numpy as np

from artigen.shapes.appliances.control_panel import make_button
from artigen.shapes.appliances.rings import build_ring
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish, choose_size
from artigen.shapes.fittings.hardware import around, rotate
from artigen.shapes.fittings.tubes import lean_rod
from artigen.shapes.primitives import (
    SEGMENTS,
    UP,
    Primitive,
    Vector,
    block,
    cylinder,
    move,
    place_vertices,
    polytope,
)
from artigen.shapes.shape import ShapePart, make_base
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.materials import LACQUERS, make_ceramic, make_plastic, make_polished

CATEGORY = "DeskLamp"
STYLES = {"architect": 0.4, "led": 0.3, "dome": 0.3}
COLORS = {
    "architect": ("black", "white", "anthracite", "terracotta", "blue", "sage"),
    "led": ("black", "white", "anthracite", "light_grey"),
    "dome": ("forest", "navy", "cream", "black", "terracotta", "sage"),
}
OUTER, INNER, PLAY = 0.0185, 0.0095, 0.0025
"""Distances (m) of the two rods of an arm from the middle; lower arm and head straddle the upper arm."""
ROD = 0.0045
KNOB = 0.013
"""Radius of the knobs on the hinges."""
ROUND = float(np.cos(np.pi / SEGMENTS))
"""Ratio of the extent of the prism that approximates a cylinder to the cylinder's."""
Point = tuple[float, float]
"""Coordinates (x, z) in the plane of the arms."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a desk lamp."""
    style = choose_style(rng, STYLES, wish.style)
    width, depth, height = choose_size(rng, CATEGORY, wish, ((0.19, 0.24), (0.42, 0.52), (0.4, 0.52)))
    foot, plate = width / 2, choose(rng, 0.016, 0.026)
    head, front = _build_head(rng, style)
    droop = radians(choose(rng, 4.0, 14.0))
    base = (0.0, plate + 0.045)
    top = height - KNOB * ROUND
    # The elbow is behind the foot so that gravity holds every hinge at rest.
    forward = depth - front - KNOB * ROUND
    elbow = (0.53 * forward + choose(rng, 0.066, 0.076), top)
    back = max(elbow[0] + KNOB * ROUND, foot)
    tip = back - depth + front  # x of the hinge of the head
    wrist = (tip, float(top - forward * np.tan(droop)))
    shift = depth / 2 - back
    base, elbow, wrist = ((point[0] + shift, point[1]) for point in (base, elbow, wrist))
    flat = style == "led"
    pieces = [
        cylinder((base[0], 0.0, 0.0), (base[0], 0.0, plate), foot / ROUND, "foot"),
        cylinder((base[0], 0.0, plate), (base[0], 0.0, base[1] - 0.02), 0.016, "body"),
        cylinder(
            (base[0], -OUTER + ROD + PLAY, base[1]), (base[0], OUTER - ROD - PLAY, base[1]), 0.011, "body"
        ),
        cylinder((base[0], 0.0, plate), (base[0], 0.0, base[1]), 0.009, "body"),
    ]
    lower = _build_arm(base, elbow, OUTER, flat=flat, springs=style == "architect")
    upper = _build_arm(elbow, wrist, INNER, flat=flat, springs=False)
    head = [move(piece, (wrist[0], 0.0, wrist[1])) for piece in head]
    parts = [make_base(pieces)]
    chain = (
        ("lower_arm", lower, base, -1.0, rng.uniform(40.0, 55.0)),
        ("upper_arm", upper, elbow, 1.0, rng.uniform(45.0, 60.0)),
        ("head", head, wrist, 1.0, rng.uniform(45.0, 70.0)),
    )
    for name, primitives, (x, z), way, upper_limit in chain:
        motion = rotate((0.0, way, 0.0), (x, 0.0, z), radians(upper_limit))
        part = ShapePart(name, "handle", tuple(primitives), motion, parent=parts[-1].name)
        parts.append(part)
    at = (base[0] - 0.62 * foot, 0.0, plate)
    up, size = UP, (0.024, 0.024, 0.006)
    switch = make_button(at, size, name="switch", finish="accent", shape="round", out=up)
    return Draft(style, (*parts, switch), _draw_finishes(rng, style))


def _draw_finishes(rng: np.random.Generator, style: str) -> dict[str, Finish]:
    seed, colors = int(rng.integers(2**30)), COLORS[style]
    color = LACQUERS[choose_one(rng, colors)]
    metal = ("brass", "brass", "chrome", "black") if style == "dome" else ("steel", "chrome", "black")
    rods = make_polished(choose_one(rng, metal), seed)
    paint = make_plastic(color, gloss=0.4)
    return {
        "body": paint,
        "foot": make_ceramic(color, seed),  # weighted: as heavy as stone
        "arm": paint if style == "led" and rng.random() < 0.6 else rods,
        "accent": make_polished("chrome", seed + 1),
        "lamp": make_plastic((0.96, 0.95, 0.9)),
        "inside": make_plastic(LACQUERS["white"]),
    }


def _build_arm(start: Point, end: Point, apart: float, *, flat: bool, springs: bool) -> list[Primitive]:
    """Two rods or flat bars side by side, with spacers between them and knobs on the hinge at the end."""
    way = np.array(end) - np.array(start)
    way /= np.linalg.norm(way)
    over = 0.006

    def place(base: Point, run: float, y: float, up: float = 0.0) -> Vector:
        x, z = np.array(base) + run * way + up * np.array((-way[1], way[0]))
        return float(x), y, float(z)

    pieces: list[Primitive] = []
    for y in (-apart, apart):
        if flat:
            ends = ((start, -over), (end, over))
            corners = [place(p, r, y + a, b) for p, r in ends for a in (-ROD, ROD) for b in (-0.011, 0.011)]
            pieces.append(polytope(np.array(corners), "arm"))
        else:
            pieces.append(lean_rod(place(start, -over, y), place(end, over, y), ROD, "arm"))
    spacers = ((start, 0.05), (start, 0.15), (end, -0.05)) if springs else ((start, 0.05), (end, -0.05))
    pieces += [cylinder(place(p, r, -apart), place(p, r, apart), 0.004, "arm") for p, r in spacers]
    if springs:
        pieces += [
            lean_rod(place(start, 0.05, y), place(start, 0.15, y), 0.0055, "accent") for y in (-0.007, 0.007)
        ]
    if apart == OUTER:
        for base in (start, end):
            for side in (-1.0, 1.0):
                out = (side * (apart + ROD - 0.001), side * (apart + ROD + 0.006))
                pieces.append(cylinder(place(base, 0.0, out[0]), place(base, 0.0, out[1]), KNOB, "accent"))
    return pieces


def _build_head(rng: np.random.Generator, style: str) -> tuple[list[Primitive], float]:
    """A head with its hinge at the origin, and its extent forward (m)."""
    sides = (around(-OUTER, ROD), around(OUTER, ROD))
    cheeks = [block(around(0.0, 0.008), (low, high), (-0.034, 0.008), "arm") for low, high in sides]
    if style == "led":
        long = choose(rng, 0.2, 0.26)
        bar = block((0.075 - long, 0.075), around(0.0, 0.024), (-0.046, -0.032), "body")
        light = block((0.085 - long, 0.02), around(0.0, 0.019), (-0.049, -0.045), "lamp")
        tilt = radians(choose(rng, 2.5, 4.5))
        pieces = [move(piece, turn=tilt, about=(0.0, 1.0, 0.0)) for piece in (*cheeks, bar, light)]
    else:
        mouth, neck = choose(rng, 0.066, 0.08), 0.03
        tall = choose(rng, 0.1, 0.13) if style == "architect" else choose(rng, 0.075, 0.095)
        low, wall = -0.06 - tall, 0.006
        belly = 0.9 if style == "dome" else 0.42  # radius of the shade where its wall bends
        bend = -0.06 - (0.45 if style == "dome" else 0.4) * tall
        middle = neck + belly * (mouth - neck)
        top, waist, rim = ((radius, radius + wall) for radius in (neck, middle, mouth))
        pieces = [*cheeks, cylinder((0.0, 0.0, -0.065), (0.0, 0.0, -0.03), neck + wall, "body")]
        for span, ends in (((bend, -0.06), (waist, top)), ((low, bend), (rim, waist))):
            pieces += build_ring((0.0, 0.0, 0.0), "z", span, ends, "body", sides=12, lining="inside")
        pieces.append(cylinder((0.0, 0.0, -0.115), (0.0, 0.0, -0.065), 0.02, "lamp"))
    return pieces, -float(min(place_vertices(piece)[:, 0].min() for piece in pieces))
