"""Box: a wooden chest, a trunk with a curved lid, a plastic tub with clips, a carton with flaps.

Chests are 0.7 to 1.2 m wide and knee-high. Plastic tubs follow the modules of a Euro pallet of 0.8 m x 1.2 m:
0.6 m x 0.4 m, and half of it. Cartons are FEFCO type 0201: four flaps, each half as long as the box is deep,
of which the outer pair meets in the middle.
"""

from dataclasses import replace
from itertools import pairwise
from math import radians

import numpy as np

from artigen.kind import EVERY, Kind, Place, by_longest, make, plurals
from artigen.shapes.assembly import Assembly, draw_styled
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Draft, Spans, Wish
from artigen.shapes.fittings.feet import make_plinth
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import GAP, Edge, Panel
from artigen.shapes.fittings.legs import make_legs
from artigen.shapes.fittings.lids import (
    build_collar,
    build_roof,
    build_vessel,
    hinge_lid,
    loft,
    make_lid,
    make_lift_out,
    shrink,
    trace_arch,
)
from artigen.shapes.fittings.locks import DEEP, FREE, make_latch
from artigen.shapes.fittings.turning import turn_part
from artigen.shapes.primitives import Primitive, block
from artigen.shapes.ranges import Range, around, margins, narrow
from artigen.shapes.shape import ShapePart, require
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import make_lacquer, make_metal, make_plastic
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Box"
STYLES = {"chest": 2.5, "trunk": 1.5, "plastic": 2.5, "carton": 2.5}
SIZES: dict[str, Spans] = {
    "chest": ((0.7, 1.2), (0.38, 0.52), (0.4, 0.55)),
    "trunk": ((0.6, 1.0), (0.38, 0.52), (0.45, 0.6)),
    "plastic": ((0.38, 0.78), (0.28, 0.44), (0.18, 0.42)),
    "carton": ((0.28, 0.62), (0.22, 0.42), (0.18, 0.45)),
}
"""Width, depth and height (m)."""
TUBS: tuple[Color, ...] = (
    (0.86, 0.88, 0.89), (0.30, 0.44, 0.62), (0.62, 0.64, 0.66), (0.24, 0.25, 0.27), (0.70, 0.26, 0.22),
    (0.40, 0.56, 0.44), (0.90, 0.86, 0.76),
)  # fmt: skip
HASP, BAIL = 0.0135, 0.039
"""Protrusion (m) of a hasp and of a side handle."""
CARDBOARD = Finish(
    kind="lacquer", color=(0.72, 0.57, 0.40), accent=(0.70, 0.55, 0.38), period=0.3, gloss=0.03
)
CLEAR = Finish(kind="glass", color=(0.80, 0.85, 0.87), accent=(0.84, 0.88, 0.90), gloss=0.3, opacity=0.35)


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a box that meets the wish."""
    builders = {"chest": _build_chest, "trunk": _build_trunk, "plastic": _build_tub, "carton": _build_carton}
    return draw_styled(rng, wish, STYLES, SIZES, builders, _draw_finishes)


def _draw_finishes(rng: np.random.Generator, style: str) -> dict[str, Finish]:
    """Wood or paint, moulded plastic, or brown cardboard with tape."""
    seed, tub, lid = int(rng.integers(2**30)), int(rng.integers(len(TUBS))), int(rng.integers(len(TUBS)))
    wood = choose_one(rng, ("pine", "oak", "walnut", "teak", "classic", "white"))
    finishes = draw_palette(rng, "furniture", wood)
    if finishes["top"].kind == "stone":
        finishes["top"] = finishes["body"]
    finishes["metal"] = make_metal("brass" if rng.random() < 0.5 else "black", seed)
    if style == "plastic":
        clear = rng.random() < 0.35
        cover = make_plastic(TUBS[lid])
        finishes |= {"body": CLEAR if clear else make_plastic(TUBS[tub]), "top": cover, "trim": cover}
    if style == "carton":
        tape, paper = make_plastic((0.80, 0.70, 0.52)), make_lacquer((0.92, 0.91, 0.88))
        finishes |= {"body": replace(CARDBOARD, seed=seed), "trim": tape, "paper": paper}
    return finishes


def _build_chest(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """Boards on a plinth or on legs, and a slightly overhanging lid."""
    wall, lid, over = choose(rng, 0.018, 0.024), choose(rng, 0.02, 0.03), choose(rng, 0.006, 0.018)
    x, y = (over - depth / 2, depth / 2), around(0.0, width / 2 - over)
    raised, rim = bool(rng.random() < 0.45), height - lid - GAP
    foot = choose(rng, 0.08, 0.14) if raised else choose(rng, 0.04, 0.07)
    if raised:
        kind = "tapered" if rng.random() < 0.5 else "square"
        stand = make_legs(x, y, foot, kind=kind, width=0.04, finish="body")
    else:
        stand = make_plinth((x[0] - 0.5 * over, x[1]), narrow(y, -0.5 * over), foot)
    walls = build_vessel((x, y), (x, y), (foot, rim), wall, "body", lining="inside")
    framed = rng.random() < 0.6
    panels = _frame_front(x[0], y, (foot, rim), int(rng.integers(2, 4))) if framed else ()
    top = (x[0] - over, x[1]), narrow(y, -over)
    board = block(*top, (rim + GAP, height), "top", 0.004)
    cover = make_lid((board,), *top, rim + GAP, radians(choose(rng, 92, 108)))
    return Assembly((*stand, *walls, *panels), (cover,))


def _frame_front(x: float, y: Range, z: Range, fields: int) -> list[Primitive]:
    """Stiles and rails on the front."""
    face, wide = (x - 0.006, x), 0.055
    stiles = np.linspace(y[0], y[1] - wide, fields + 1).tolist()
    rails = [(c, c + wide) for c in (z[0], z[1] - wide)]
    out = [block(face, (a, a + wide), z, "body") for a in stiles]
    return out + [block(face, (a + wide, b), rail, "body") for a, b in pairwise(stiles) for rail in rails]


def _build_trunk(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A box with straps, a curved lid, a hasp in front, handles at the sides and a tray inside."""
    wall, strap, foot = 0.02, 0.004, 0.012
    x, y = (HASP - depth / 2, depth / 2 - strap), around(0.0, width / 2 - BAIL)
    rise = choose(rng, 0.24, 0.34) * depth
    rim = height - strap - rise - GAP
    low, ledge = rim + GAP, 0.55 * rim
    bands = [(a, a + 0.03) for a in np.linspace(y[0] + 0.06, y[1] - 0.09, int(rng.integers(2, 4))).tolist()]
    if len(bands) == 3:  # the hasp is in the middle
        bands.pop(1)
    corners = [(a, b) for a in (x[0], x[1] - 0.05) for b in (y[0], y[1] - 0.05)]
    inner = shrink((x, y), wall)
    pieces = [
        *build_vessel((x, y), (x, y), (foot, rim), wall, "body", lining="inside"),
        *(block((a, a + 0.05), (b, b + 0.05), (0.0, foot), "metal") for a, b in corners),
        *(block((x[0] - strap, x[0]), band, (foot, rim), "metal") for band in bands),
        block((x[0] - 0.002, x[0]), around(0.0, 0.04), (rim - 0.07, rim), "metal"),
        *(
            block(inner[0], (a, a + 0.016), (ledge - 0.02, ledge), "inside")
            for a in (inner[1][0], inner[1][1] - 0.016)
        ),
    ]
    solids = [*build_roof(trace_arch(x, low, rise), wall, y, "top")]
    crest = trace_arch(narrow(x, -strap), low, rise + strap)
    for band in bands:
        solids += build_roof(crest, 2 * strap, band, "metal", ends=False)
    upper = radians(choose(rng, 92, 105))
    lid = make_lid(solids, (x[0], x[1] + strap), y, low, upper, needs=require("hasp"))
    place = x[0] - 0.002, around(0.0, 0.03), (rim - 0.05, rim + 0.06)
    hasp = make_latch(*place, name="hasp", finish="metal")
    room = narrow(inner[0], GAP + 0.002), narrow(inner[1], GAP)
    tray = make_lift_out(room, (ledge + 0.0015, rim - 0.012), 0.012, "drawer")
    return Assembly(pieces, (lid, hasp, *_make_side_handles(y[1], ledge), tray))


def _make_side_handles(half: float, z: float) -> list[ShapePart]:
    """Side handles of a body that is ``2 * half`` metres wide."""
    panel = Panel(x=-half, thickness=0.02, y=around(0.0, 0.3), z=around(z, 0.1))
    design = HandleDesign(kind="arch", length=0.13, thickness=0.012, finish="metal")
    made = make_handle(panel, design, name="handle", parent="body", upright=False, at=(0.0, z))
    return _turn_aside(made)


def _turn_aside(part: ShapePart) -> list[ShapePart]:
    """A part of the front on the left and on the right side."""
    return [replace(turn_part(part, side), name=f"{part.name}_{side}") for side in ("left", "right")]


def _build_tub(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A tub that tapers downwards, a lid with a raised field and a clip at each side."""
    wall, clip, thick = 0.006, FREE + DEEP, 0.012
    x, y = around(0.0, depth / 2), around(0.0, width / 2 - clip)
    rim = height - thick - choose(rng, 0.006, 0.014) - GAP
    taper, low = choose(rng, 0.08, 0.16) * min(depth, height), rim + GAP
    outer = shrink((x, y), 0.016)
    walls = build_vessel(shrink(outer, taper / 2), outer, (0.0, rim), wall, "body")
    brim = build_collar((narrow(x, 0.004), y), shrink(outer, wall), (rim - 0.018, rim), "body")
    field = shrink((x, y), 0.03)
    solids = (
        block(x, y, (low, low + thick), "top", 0.004),
        loft(field, shrink(field, 0.01), (low + thick, height), "top"),
    )
    upper = radians(choose(rng, 95, 110))
    lid = make_lid(solids, x, y, low, upper, needs=require("clip_left", "clip_right"))
    place = -y[1], around(0.0, min(0.05, 0.16 * depth)), (rim - 0.045, low + 0.9 * thick)
    clips = _turn_aside(make_latch(*place, name="clip", finish="trim"))
    return Assembly((*walls, *brim), (lid, *clips))


def _build_carton(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A carton with two or four flaps; the outer ones, front and rear, close over those at the sides."""
    wall = max(0.005, max(width, depth, height) / 56)
    x, y = around(0.0, depth / 2), around(0.0, width / 2)
    four = bool(rng.random() < 0.75)
    upper = height - wall - GAP  # front and rear wall
    side = upper - wall - GAP if four else upper
    inner = narrow(x, wall)
    pieces = [
        *(block(end, y, (0.0, upper), "body") for end in margins(x, wall)),
        *(block(inner, end, (0.0, side), "body") for end in margins(y, wall)),
        block(inner, narrow(y, wall), (0.0, wall), "body"),
    ]
    opened = radians(choose(rng, 105, 178))
    tape = "trim" if rng.random() < 0.6 else "body"
    seam, cut, (low, across) = 0.0008, 0.0268, (height - wall, narrow(y, 0.001))
    parts: list[ShapePart] = []
    flaps: tuple[tuple[str, Edge | None, Range, Range, Range], ...] = (
        ("front", "bottom", (x[0], -seam), (x[0], -cut), (-cut, -seam)),
        ("rear", None, (seam, x[1]), (cut, x[1]), (seam, cut)),
    )
    for name, edge, span, rest, strip in flaps:
        solids = (block(rest, across, (low, height), "body"), block(strip, across, (low, height), tape))
        parts.append(ShapePart(f"flap_{name}", "door", solids, hinge_lid(span, y, low, opened, edge)))
    if four:
        reach, deep, low = min(depth / 2, width / 2 - 0.004), narrow(inner, GAP), side + GAP
        sides: tuple[Edge, ...] = ("right", "left")
        for edge, span in zip(sides, margins(y, reach), strict=True):
            solid = block(deep, span, (low, low + wall), "body")
            motion = hinge_lid(deep, span, low, opened, edge)
            needs = require("flap_front", "flap_rear")
            parts.append(ShapePart(f"flap_{edge}", "door", (solid,), motion, needs=needs))
    if rng.random() < 0.7:  # a paper label on the front
        wide, high = 0.3 * width, 0.28 * height
        left = choose(rng, y[0] + 0.03, y[1] - 0.03 - wide)
        face, up = (x[0] - 0.0012, x[0] + 0.002), (0.5 * height, 0.5 * height + high)
        pieces.append(block(face, (left, left + wide), up, "paper"))
    return Assembly(pieces, parts)


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "storage box",
        "carton",
        "trunk",
        "box",
        "chest",
        "crate",
        "toy box",
        "toy chest",
        "blanket chest",
        "blanket box",
        "footlocker",
        "coffer",
    ),
    hints=(),
    size=(by_longest(0.4),),
    deepest=np.inf,
    diagonal=(0.1, 2.0),
    build="plastic",
    stands="free",
    styles=tuple(STYLES),
    style_words={"cardboard": "carton", "moving": "carton", "storage": EVERY},
    forms={},
    sizes=((0.12, 2.0), (0.1, 1.0), (0.06, 1.0)),
    bare="width",
    make=make(density={"glass": 1050.0}, wall={"plastic": 0.0022, "glass": 0.0022}),
    makes={
        "carton": make(density={"plastic": 85.0}),
        "chest": make(density={"wood_board": 480.0, "plastic": 480.0}),
        "trunk": make(density={"wood_board": 480.0, "plastic": 480.0}),
    },
    feet=False,
    trade=None,
    synset="box.n.01",
    wikidata=None,
    partnet=CATEGORY,
    body="box_body",
    places=(Place(role="crate", low=(0.2, 0.25, 0.15), high=(0.5, 1.0, 0.5), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=9,
    draw=draw,
)
