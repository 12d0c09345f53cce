"""DeskLamp: a foot, a lower arm, an upper arm and a tilting head (a chain of three hinges), and a switch.

Arms are 300 to 450 mm long, as in balanced-arm lamps. At rest the lower arm leans back and the upper one
forward. The joints move the lower arm forward, the upper arm up and the head up.
"""

from math import radians

import numpy as np

from artigen.kind import Kind, Place, by_longest, make, plurals
from artigen.shapes.appliances.control_panel import make_button
from artigen.shapes.appliances.rings import build_ring
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish, choose_size
from artigen.shapes.fittings.hardware import rotate
from artigen.shapes.fittings.tubes import lean_rod
from artigen.shapes.primitives import (
    LEFT,
    RIGHT,
    ROUND,
    UP,
    Primitive,
    Vector,
    block,
    cylinder,
    move,
    place_vertices,
    polytope,
)
from artigen.shapes.ranges import around
from artigen.shapes.shape import ShapePart
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
Point = tuple[float, float]
"""Coordinates (x, z) in the plane of the arms."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a desk lamp."""
    style = choose_style(rng, STYLES, wish.style)
    width, depth, height = choose_size(rng, CATEGORY, wish, ((0.19, 0.24), (0.42, 0.52), (0.4, 0.52)))
    foot, plate = width / 2, choose(rng, 0.016, 0.026)
    head, front = _build_head(rng, style)
    droop = radians(choose(rng, 4.0, 14.0))
    level, top = plate + 0.045, height - KNOB * ROUND
    # The elbow is behind the foot so that gravity holds every hinge at rest.
    forward = depth - front - KNOB * ROUND
    behind = 0.53 * forward + choose(rng, 0.066, 0.076)  # from the foot to the elbow
    x = depth / 2 - max(behind + KNOB * ROUND, foot)  # of the foot
    base, elbow = (x, level), (x + behind, top)
    wrist = (front - depth / 2, float(top - forward * np.tan(droop)))
    pin = OUTER - ROD - PLAY
    pieces = (
        cylinder((x, 0.0, 0.0), (x, 0.0, plate), foot / ROUND, "foot"),
        cylinder((x, 0.0, plate), (x, 0.0, level - 0.02), 0.016, "body"),
        cylinder((x, -pin, level), (x, pin, level), 0.011, "body"),
        cylinder((x, 0.0, plate), (x, 0.0, level), 0.009, "body"),
    )
    flat = style == "led"
    lower = _build_arm(base, elbow, OUTER, flat=flat, springs=style == "architect")
    upper = _build_arm(elbow, wrist, INNER, flat=flat, springs=False)
    tip = [move(piece, (wrist[0], 0.0, wrist[1])) for piece in head]
    chain = (
        ("lower_arm", lower, base, RIGHT, choose(rng, 40.0, 55.0), "body"),
        ("upper_arm", upper, elbow, LEFT, choose(rng, 45.0, 60.0), "lower_arm"),
        ("head", tip, wrist, LEFT, choose(rng, 45.0, 70.0), "upper_arm"),
    )
    parts = [
        ShapePart(name, "handle", solids, rotate(axis, (at[0], 0.0, at[1]), radians(opens)), parent=parent)
        for name, solids, at, axis, opens, parent in chain
    ]
    at, size = (x - 0.62 * foot, 0.0, plate), (0.024, 0.024, 0.006)
    parts.append(make_button(at, size, name="switch", finish="accent", shape="round", out=UP))
    return Draft(style, Assembly(pieces, parts).close(), _draw_finishes(rng, style))


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
    """Two rods or flat bars side by side, with spacers between them and knobs on the hinges of the outer
    ones."""
    way = np.array(end) - np.array(start)
    way /= np.linalg.norm(way)

    def place(base: Point, run: float, y: float, up: float = 0.0) -> Vector:
        x, z = np.array(base) + run * way + up * np.array((-way[1], way[0]))
        return float(x), y, float(z)

    pieces: list[Primitive] = []
    for y in (-apart, apart):
        if flat:
            ends, wide = ((start, -0.006), (end, 0.006)), (-0.011, 0.011)
            corners = [place(p, r, a, b) for p, r in ends for a in around(y, ROD) for b in wide]
            pieces.append(polytope(np.array(corners), "arm"))
        else:
            pieces.append(lean_rod(place(start, -0.006, y), place(end, 0.006, y), ROD, "arm"))
    spacers = ((start, 0.05), *(((start, 0.15),) if springs else ()), (end, -0.05))
    pieces += [cylinder(place(p, r, -apart), place(p, r, apart), 0.004, "arm") for p, r in spacers]
    if springs:
        for y in (-0.007, 0.007):
            pieces.append(lean_rod(place(start, 0.05, y), place(start, 0.15, y), 0.0055, "accent"))
    if apart == OUTER:
        near, far = apart + ROD - 0.001, apart + ROD + 0.006
        for p in (start, end):
            for side in (-1.0, 1.0):
                ends = place(p, 0.0, side * near), place(p, 0.0, side * far)
                pieces.append(cylinder(*ends, KNOB, "accent"))
    return pieces


def _build_head(rng: np.random.Generator, style: str) -> tuple[list[Primitive], float]:
    """A head with its hinge at the origin, and its extent forward (m)."""
    pieces = [block(around(0.0, 0.008), around(y, ROD), (-0.034, 0.008), "arm") for y in (-OUTER, OUTER)]
    if style == "led":
        long = choose(rng, 0.2, 0.26)
        pieces.append(block((0.075 - long, 0.075), around(0.0, 0.024), (-0.046, -0.032), "body"))
        pieces.append(block((0.085 - long, 0.02), around(0.0, 0.019), (-0.049, -0.045), "lamp"))
        tilt = radians(choose(rng, 2.5, 4.5))
        pieces = [move(piece, turn=tilt, about=(0.0, 1.0, 0.0)) for piece in pieces]
    else:
        dome = style == "dome"
        mouth, neck, wall = choose(rng, 0.066, 0.08), 0.03, 0.006
        tall = choose(rng, 0.075, 0.095) if dome else choose(rng, 0.1, 0.13)
        belly, bent = (0.9, 0.45) if dome else (0.42, 0.4)  # where the wall of the shade bends
        high, bend, low = -0.06, -0.06 - bent * tall, -0.06 - tall
        radii = (neck, neck + belly * (mouth - neck), mouth)
        top, waist, rim = ((radius, radius + wall) for radius in radii)
        pieces.append(cylinder((0.0, 0.0, -0.065), (0.0, 0.0, -0.03), neck + wall, "body"))
        for span, ends in (((bend, high), (waist, top)), ((low, bend), (rim, waist))):
            pieces += build_ring((0.0, 0.0, 0.0), "z", span, ends, "body", sides=12, lining="inside")
        pieces.append(cylinder((0.0, 0.0, -0.115), (0.0, 0.0, -0.065), 0.02, "lamp"))
    return pieces, -float(min(place_vertices(piece)[:, 0].min() for piece in pieces))


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "desk lamp",
        "desk light",
        "lamp",
        "table lamp",
        "reading lamp",
        "task lamp",
        "anglepoise",
    ),
    hints=(),
    size=(by_longest(0.5),),
    deepest=np.inf,
    diagonal=(0.2, 1.5),
    build="weighted",
    stands="free",
    styles=tuple(STYLES),
    style_words={"articulated": "architect", "anglepoise": "architect"},
    forms={},
    sizes=((0.1, 0.5), (0.2, 0.9), (0.25, 0.9)),
    bare="height",
    make=make(
        density={"stone": 2000.0}, wall={"plastic": 0.0025}
    ),  # concrete in a cover; shades as heavy as a millimetre of aluminium
    makes={},
    feet=False,
    trade="fittings",
    synset="lamp.n.02",
    wikidata=None,
    partnet=None,
    body="desklamp_body",
    places=(Place(role="lamp", low=(0.2, 0.1, 0.3), high=(0.6, 0.4, 0.7), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=12,
    draw=draw,
)
