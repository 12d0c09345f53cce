"""Pot: a saucepan, casserole or stockpot with a loose lid that lifts.

Diameters are 160 to 280 mm, for burners of 145 to 210 mm; saucepans have a grip of 150 to 190 mm.
"""

from itertools import pairwise

import numpy as np

from artigen.kind import Kind, Place, by_longest, make, plurals
from artigen.shapes.appliances.rings import build_ring
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Spans, Wish, choose_size
from artigen.shapes.fittings.hardware import lift, slide
from artigen.shapes.fittings.tubes import bend_elbow, lean_rod
from artigen.shapes.primitives import UP, Primitive, Vector, cylinder, polygon, prism
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.materials import (
    LACQUERS,
    make_ceramic,
    make_glass,
    make_plastic,
    make_polished,
    make_wood,
)

CATEGORY = "Pot"
STYLES = {"casserole": 0.4, "saucepan": 0.35, "stockpot": 0.25}
SIZES: dict[str, Spans] = {
    "casserole": ((0.31, 0.37), (0.22, 0.28), (0.15, 0.19)),
    "saucepan": ((0.34, 0.4), (0.16, 0.2), (0.14, 0.17)),
    "stockpot": ((0.33, 0.39), (0.24, 0.28), (0.26, 0.33)),
}
"""Width including handles, diameter, height including the lid."""
ENAMELS = ("terracotta", "navy", "cream", "forest", "black", "sage", "blue")
WALL, BOTTOM, SIDES = 0.005, 0.008, 16
ROUND = float(np.cos(np.pi / SIDES))
"""Ratio of the distance of a prism's faces from its axis to that of its edges."""
LID, DOME, KNOB = 0.005, 0.016, 0.032
"""Heights of the lid's rim, of its dome, and of the knob on it."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a pot."""
    style = choose_style(rng, STYLES, wish.style)
    wide, deep, tall = SIZES[style]
    width, depth, height = choose_size(rng, CATEGORY, wish, (wide, deep, tall))
    radius, rim = depth / 2, height - 0.0015 - LID - DOME - KNOB
    axis = width / 2 - radius if style == "saucepan" else 0.0  # y of the middle of the pot
    slope = 0.94 if style == "casserole" and rng.random() < 0.5 else 1.0
    low = slope * radius
    wall = max(WALL, (rim - BOTTOM) / 45)
    outer, inner = (low, radius), (ROUND * low - wall, ROUND * radius - wall)
    span, radii = (BOTTOM, rim), ((inner[0], outer[0]), (inner[1], outer[1]))
    pieces = build_ring((0.0, axis, 0.0), "z", span, radii, "body", sides=SIDES, lining="inside")
    base = cylinder((0.0, axis, 0.0), (0.0, axis, BOTTOM), 0.985 * low, "foot")
    if style == "saucepan":
        grips = lift(_build_grip(rng, axis - radius, width), 0.8 * rim)
    else:
        grips = _build_ears(rng, radius, width, rim)
    built = Assembly((*pieces, base, *grips), _make_lid(axis, radius, rim, wall))
    return Draft(style, built.close(), _draw_finishes(rng))


def _make_lid(axis: float, radius: float, rim: float, wall: float) -> tuple[ShapePart, ShapePart]:
    """A lid that lifts out of the pot: a flat rim, a dome, and a collar that fits into the pot."""
    low = rim + 0.0015
    circle = 0.86 * radius * polygon(SIDES)
    top = low + LID + DOME
    pieces = (
        cylinder((0.0, axis, low), (0.0, axis, low + LID), 0.99 * radius, "trim"),
        cylinder((0.0, axis, rim - 0.008), (0.0, axis, low), ROUND * radius - wall - 0.01, "trim"),
        prism(circle, (0.0, axis, low + LID), (0.0, axis, top), "lid", taper=0.4),
    )
    rise = slide(0.12, UP)
    lid = ShapePart("lid", "door", pieces, rise)
    stem = cylinder((0.0, axis, top), (0.0, axis, top + 0.4 * KNOB), 0.007, "handle")
    head = cylinder((0.0, axis, top + 0.4 * KNOB), (0.0, axis, top + KNOB), 0.019, "handle")
    return lid, ShapePart("lid_knob", "handle", (stem, head), parent="lid")


def _build_ears(rng: np.random.Generator, radius: float, width: float, rim: float) -> tuple[Primitive, ...]:
    """Two handles below the rim, left and right."""
    rod, level, half = 0.0055, 0.82 * rim, choose(rng, 0.038, 0.05)
    root = (radius**2 - half**2) ** 0.5 - WALL
    bend, pieces = 0.014, []
    for side in (-1.0, 1.0):
        tip = side * (width / 2 - rod)
        shoulder = tip - side * bend
        high = level + min(0.009, 0.5 * abs(shoulder - side * root))
        for end in (-1.0, 1.0):
            pieces.append(
                lean_rod((end * half, side * root, level), (end * half, shoulder, high), rod, "handle")
            )
            center, ways = (end * (half - bend), shoulder, high), ((end, 0.0, 0.0), (0.0, side, 0.0))
            pieces += bend_elbow(center, ways, bend, rod, "handle", pieces=2)
        pieces.append(cylinder((bend - half, tip, high), (half - bend, tip, high), rod, "handle"))
    return tuple(pieces)


def _build_grip(rng: np.random.Generator, start: float, width: float) -> tuple[Primitive, ...]:
    """A long, slightly rising grip on the right."""
    rise = choose(rng, 0.012, 0.03)
    end = -width / 2
    neck = start - 0.03
    stub = lean_rod((0.0, start + 2 * WALL, 0.0), (0.0, neck, 0.004), 0.0075, "trim")
    path: list[Vector] = [(0.0, neck, 0.004), (0.0, (neck + end) / 2, 0.5 * rise)]
    path += [(0.0, end + 0.02, rise), (0.0, end, rise)]
    rods = pairwise(zip(path, (0.0085, 0.0115, 0.011, 0.009), strict=True))
    return stub, *(lean_rod(a, b, (first, second), "handle") for (a, first), (b, second) in rods)


def _draw_finishes(rng: np.random.Generator) -> dict[str, Finish]:
    seed, steel = int(rng.integers(2**30)), make_polished("steel", 0)
    enamel = bool(rng.random() < 0.4)
    color = LACQUERS[choose_one(rng, ENAMELS)]
    glassy = bool(rng.random() < (0.15 if enamel else 0.5))
    grips = (
        make_plastic((0.12, 0.12, 0.125)),
        steel,
        make_wood("walnut", seed),
        make_polished("brass", seed),
    )
    body = make_ceramic(color, seed) if enamel else steel
    return {
        "body": body,
        "inside": make_ceramic((0.87, 0.85, 0.8), seed) if enamel else steel,
        "foot": make_polished("dark", seed),
        "trim": steel if glassy or not enamel else body,
        "lid": make_glass((0.55, 0.62, 0.62), opacity=0.45) if glassy else body,
        "handle": grips[int(rng.integers(4 if enamel else 3))],
    }


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "cooking pot",
        "saucepan",
        "pot",
        "casserole",
        "casserole dish",
        "stockpot",
        "stock pot",
        "dutch oven",
        "pressure cooker",
        "stewpot",
        "stew pot",
        "sauce pan",
    ),
    hints=("lid pot",),
    size=(by_longest(0.35),),
    deepest=np.inf,
    diagonal=(0.1, 1.0),
    build="metal",
    stands="free",
    styles=tuple(STYLES),
    style_words={"stock pot": "stockpot"},
    forms={},
    sizes=((0.12, 0.7), (0.1, 0.5), (0.06, 0.6)),
    bare="width",
    make=make(density={"steel_sheet": 1100.0}),
    makes={},
    feet=False,
    trade=None,
    synset="pot.n.01",
    wikidata=None,
    partnet="KitchenPot",
    body="pot_body",
    places=(Place(role="pot", low=(0.1, 0.15, 0.08), high=(0.35, 0.5, 0.35), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=20,
    draw=draw,
)
