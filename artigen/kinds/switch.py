"""Switch: rockers, toggles, dimmers and push buttons on a piece of wall.

Plates are 80 mm wide and inserts 71 mm apart (DIN 49075); rockers tilt by 10 degrees, toggles by 50.
"""

from dataclasses import replace
from itertools import pairwise
from math import radians

import numpy as np

from artigen.kind import PLAIN, Kind, by_longest, plurals
from artigen.shapes.appliances.cavity import build_frame
from artigen.shapes.appliances.control_panel import DIAL_GAP, DialDesign, design_dial, make_button, make_dial
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose_one, choose_style
from artigen.shapes.draw import Draft, Wish, choose_size
from artigen.shapes.fittings.hardware import rotate
from artigen.shapes.fittings.tubes import lean_rod
from artigen.shapes.primitives import LEFT, Primitive, Vector, block, cylinder, polytope
from artigen.shapes.ranges import around, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.materials import LACQUERS, make_ceramic, make_plastic, make_polished

CATEGORY = "Switch"
STYLES = {"rocker": 0.4, "toggle": 0.25, "dimmer": 0.15, "buttons": 0.2}
PLATE, PITCH, HIGH = 0.08, 0.071, 0.08
THICK = 0.009
"""Thickness (m) of a plate."""
REACH = {"rocker": 0.00565, "toggle": 0.03, "dimmer": 0.026, "buttons": 0.016}
"""Protrusion of the moving parts from their plate."""
ROCK, FLIP = radians(10.0), radians(50.0)
SIGNALS = ((0.13, 0.5, 0.25), (0.7, 0.13, 0.12), (0.12, 0.12, 0.125), (0.85, 0.65, 0.1), (0.15, 0.3, 0.6))
LIGHT = ((0.94, 0.94, 0.935), (0.94, 0.94, 0.935), (0.9, 0.88, 0.82), (0.2, 0.2, 0.21), (0.75, 0.75, 0.74))


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a plate of switches."""
    style = choose_style(rng, STYLES, wish.style)
    width, depth, height = choose_size(rng, CATEGORY, wish, ((0.115, 0.29), (0.065, 0.09), (0.115, 0.145)))
    count = max(1, int((width - 0.02 - PLATE) / PITCH) + 1)
    face = -depth / 2 + REACH[style]  # x of the plate's face
    wide, (low, high) = PLATE + (count - 1) * PITCH, ((height - HIGH) / 2, (height + HIGH) / 2)
    wall = block((face + THICK, depth / 2), around(0.0, width / 2), (0.0, height), "wall")
    places = [((count - 1) / 2 - k) * PITCH for k in range(count)]
    plate = [block((face, face + THICK), around(0.0, wide / 2), (low, high), "panel", 0.002)]
    if style == "rocker":
        plate = _build_plate(face, wide, (low, high), places)
    built = Assembly((wall, *plate))
    kind = _draw_dimmer(rng) if style == "dimmer" else None
    for k, y in enumerate(places):
        at = (face, y, height / 2)
        if style == "rocker":
            built += Assembly(parts=(_make_rocker(f"rocker_{k}", at),))
        elif style == "toggle":
            built += _make_toggle(f"toggle_{k}", at)
        elif kind is not None:
            built += Assembly(parts=(make_dial(kind, at, name=f"dimmer_{k}"),))
        else:
            built += Assembly(parts=_make_pair(f"button_{k}", at))
    return Draft(style, built.close(), _draw_finishes(rng, style))


def _draw_finishes(rng: np.random.Generator, style: str) -> dict[str, Finish]:
    seed, color = int(rng.integers(2**30)), choose_one(rng, LIGHT)
    metal = make_polished(choose_one(rng, ("brass", "steel", "black", "chrome")), seed)
    plain = make_plastic(color, gloss=0.35)
    plate = metal if style in ("toggle", "dimmer") and rng.random() < 0.6 else plain
    signals = rng.permutation(len(SIGNALS))
    paints = ("white", "cream", "sage", "light_grey", "blue", "terracotta")
    return {
        "wall": make_ceramic(LACQUERS[choose_one(rng, paints)], seed),
        "panel": make_polished("steel", seed) if style == "buttons" and rng.random() < 0.5 else plate,
        "front": plain if rng.random() < 0.8 else make_plastic(LIGHT[3]),
        "metal": metal,
        "accent": make_polished("chrome", seed + 1),
        "rubber": make_plastic((0.13, 0.13, 0.135)),
        "first": make_plastic(SIGNALS[int(signals[0])]),
        "second": make_plastic(SIGNALS[int(signals[1])]),
    }


def _build_plate(face: float, wide: float, z: tuple[float, float], places: list[float]) -> list[Primitive]:
    """A frame with a window for each rocker, and a back."""
    half, back = 0.0295, face + THICK
    inner = wide / 2 - 0.004
    pieces = [block((back - 0.002, back), around(0.0, inner), narrow(z, 0.004), "panel")]
    middle = sum(z) / 2
    edges = [-wide / 2, *((low + high) / 2 for low, high in pairwise(places[::-1])), wide / 2]
    for k, y in enumerate(reversed(places)):
        hole = around(y, half), around(middle, half)
        pieces += build_frame((face, back), ((edges[k], edges[k + 1]), z), hole, "panel")
    return pieces


def _make_rocker(name: str, at: Vector) -> ShapePart:
    """A rocker with its lower half pressed in, which tilts to the upper one."""
    half, thick = 0.0275, 0.0055
    pivot = (at[0] - 0.0006, at[1], at[2])
    flat = np.array([(a, c) for a in (-thick / 2, thick / 2) for c in (-half, half)])
    cosine, sine = np.cos(ROCK / 2), np.sin(ROCK / 2)
    flat = flat @ np.array([(cosine, sine), (-sine, cosine)])
    corners = np.array([(x, y, z) for x, z in flat for y in (-half, half)])
    tilted = polytope(corners, "front", center=pivot)
    return ShapePart(name, "knob", (tilted,), rotate(LEFT, pivot, ROCK))


def _make_toggle(name: str, at: Vector) -> Assembly:
    """A toggle before a collar, which points down and flips up."""
    x, y, z = at
    collar = cylinder((x - 0.004, y, z), (x, y, z), 0.014, "accent")
    pivot = (x - 0.004 - DIAL_GAP - 0.0055, y, z)
    reach = REACH["toggle"] - 0.004 - DIAL_GAP - 0.0055
    tip = (pivot[0] - reach, y, z - reach * float(np.tan(FLIP / 2)))
    stem = lean_rod(pivot, tip, 0.0042, "metal")
    ball = cylinder((pivot[0], y - 0.008, z), (pivot[0], y + 0.008, z), 0.0055, "metal")
    return Assembly((collar,), (ShapePart(name, "knob", (stem, ball), rotate(LEFT, pivot, FLIP)),))


def _draw_dimmer(rng: np.random.Generator) -> DialDesign:
    design = design_dial(rng, (0.017, 0.022), endless=0.2, finish="metal")
    long = REACH["dimmer"] - DIAL_GAP - (0.002 if design.kind == "round" else 0.0)
    return replace(design, length=long)


def _make_pair(name: str, at: Vector) -> tuple[ShapePart, ShapePart]:
    """Two round push buttons above each other."""
    (x, y, z), size = at, (0.026, 0.026, 0.0126)
    first, second = (
        make_button((x, y, z + up), size, name=f"{name}_{word}", finish=word, shape="round")
        for word, up in (("first", 0.019), ("second", -0.019))
    )
    return first, second


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("light switch", "switch", "wall switch", "dimmer", "dimmer switch"),
    hints=(),
    size=(by_longest(0.12),),
    deepest=np.inf,
    diagonal=(0.05, 0.6),
    build="plastic",
    stands="mounted",
    styles=tuple(STYLES),
    style_words={"push button": "buttons"},
    forms={},
    sizes=((0.05, 0.6), (0.02, 0.2), (0.05, 0.4)),
    bare="width",
    make=PLAIN,
    makes={},
    feet=False,
    trade="fittings",
    synset="switch.n.01",
    wikidata=None,
    partnet=CATEGORY,
    body="switch_body",
    places=(),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=23,
    draw=draw,
)
