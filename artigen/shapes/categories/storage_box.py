"""Box: a wooden chest, a trunk with a curved lid, a plastic tub with clips, a carton with flaps.

Chests are 0.7 to 1.2 m wide and knee-high. Plastic tubs follow the modules of a Euro pallet of 0.8 m x 1.2 m:
0.6 m x 0.4 m, and half of it. Cartons are FEFCO type 0201: four flaps, each half as long as the box is deep,
of which the outer pair meets in the middle.
"""

from dataclasses import replace
from itertools import pairwise
from math import radians

import numpy as np

from artigen.shapes.assembly import Assembly, draw_styled
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Draft, Wish
from artigen.shapes.fittings.feet import make_legs, make_plinth
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import GAP, Edge, Panel, Range, narrow
from artigen.shapes.fittings.lids import (
    build_roof,
    build_vessel,
    hinge_lid,
    loft,
    make_lift_out,
    shrink,
    trace_arch,
)
from artigen.shapes.fittings.locks import make_latch
from artigen.shapes.fittings.turning import turn_part
from artigen.shapes.primitives import Primitive, block, box
from artigen.shapes.shape import Need, ShapePart, require
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import make_lacquer, make_metal, make_plastic
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Box"
STYLES = {"chest": 2.5, "trunk": 1.5, "plastic": 2.5, "carton": 2.5}
SIZES: dict[str, tuple[Range, Range, Range]] = {
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
CARDBOARD: Color = (0.72, 0.57, 0.40)


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
        shell = Finish(
            kind="glass", color=(0.80, 0.85, 0.87), accent=(0.84, 0.88, 0.90), gloss=0.3, opacity=0.35
        )
        finishes |= {
            "body": shell if clear else make_plastic(TUBS[tub]),
            "top": make_plastic(TUBS[lid]),
            "trim": make_plastic(TUBS[lid]),
        }
    if style == "carton":
        board = Finish(
            kind="lacquer", color=CARDBOARD, accent=(0.70, 0.55, 0.38), period=0.3, seed=seed, gloss=0.03
        )
        finishes |= {
            "body": board,
            "trim": make_plastic((0.80, 0.70, 0.52)),
            "paper": make_lacquer((0.92, 0.91, 0.88)),
        }
    return finishes


def _build_chest(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """Boards on a plinth or on legs, and a slightly overhanging lid."""
    wall, lid = choose(rng, 0.018, 0.024), choose(rng, 0.02, 0.03)
    over = choose(rng, 0.006, 0.018)
    x, y = (over - depth / 2, depth / 2), (over - width / 2, width / 2 - over)
    raised = bool(rng.random() < 0.45)
    foot = choose(rng, 0.08, 0.14) if raised else choose(rng, 0.04, 0.07)
    rim = height - lid - GAP
    stand = (
        make_legs(x, y, foot, kind="tapered" if rng.random() < 0.5 else "square", width=0.04, finish="body")
        if raised
        else make_plinth((x[0] - 0.5 * over, x[1]), narrow(y, -0.5 * over), foot, "body")
    )
    walls = build_vessel((x, y), (x, y), (foot, rim), wall, "body", lining="inside")
    panels: list[Primitive] = []
    if rng.random() < 0.6:
        panels = _frame_front(x[0], y, (foot, rim), int(rng.integers(2, 4)))
    board = block((-depth / 2, depth / 2), (-width / 2, width / 2), (rim + GAP, height), "top", 0.004)
    span = ((-depth / 2, x[1]), (-width / 2, width / 2))
    motion = hinge_lid(*span, rim + GAP, radians(choose(rng, 92, 108)))
    cover = ShapePart("lid", "door", (board,), motion)
    return Assembly((*stand, *walls, *panels), (cover,))


def _frame_front(x: float, y: Range, z: Range, fields: int) -> list[Primitive]:
    """Stiles and rails on the front."""
    wide, thick = 0.055, 0.006
    stiles = np.linspace(y[0], y[1] - wide, fields + 1)
    out = [block((x - thick, x), (float(a), float(a) + wide), z, "body") for a in stiles]
    for a, b in pairwise(stiles):
        for c in (z[0], z[1] - wide):
            out.append(box((x - thick, float(a) + wide, c), (x, float(b), c + wide), "body"))
    return out


def _build_trunk(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A box with straps, a curved lid, a hasp in front, handles at the sides and a tray inside."""
    wall, strap = 0.02, 0.004
    x, y = (HASP - depth / 2, depth / 2 - strap), (BAIL - width / 2, width / 2 - BAIL)
    rise = choose(rng, 0.24, 0.34) * depth
    rim = height - strap - rise - GAP
    walls = build_vessel((x, y), (x, y), (0.012, rim), wall, "body", lining="inside")
    feet = [
        box((a, b, 0.0), (a + 0.05, b + 0.05, 0.012), "metal")
        for a in (x[0], x[1] - 0.05)
        for b in (y[0], y[1] - 0.05)
    ]
    bands = [(a, a + 0.03) for a in np.linspace(y[0] + 0.06, y[1] - 0.09, int(rng.integers(2, 4))).tolist()]
    if len(bands) == 3:  # the hasp is in the middle
        bands.pop(1)
    straps = [box((x[0] - strap, a, 0.012), (x[0], b, rim), "metal") for a, b in bands]
    low = rim + GAP
    solids = [*build_roof(trace_arch(x, low, rise), wall, y, "top")]
    for band in bands:
        crest = trace_arch(narrow(x, -strap), low, rise + strap)
        solids += build_roof(crest, 2 * strap, band, "metal", ends=False)
    motion = hinge_lid((x[0], x[1] + strap), y, low, radians(choose(rng, 92, 105)))
    lid = ShapePart("lid", "door", tuple(solids), motion, needs=require("hasp"))
    hasp = make_latch(
        x[0] - 0.002, (-0.03, 0.03), (rim - 0.05, rim + 0.06), name="hasp", parent="body", finish="metal"
    )
    plate = box((x[0] - 0.002, -0.04, rim - 0.07), (x[0], 0.04, rim), "metal")
    parts = [lid, hasp, *_make_side_handles(width / 2 - BAIL, 0.55 * rim)]
    ledge = 0.55 * rim
    ledges = [
        block(narrow(x, wall), (a, a + 0.016), (ledge - 0.02, ledge), "inside")
        for a in (y[0] + wall, y[1] - wall - 0.016)
    ]
    inside = (x[0] + wall + GAP + 0.002, x[1] - wall - GAP - 0.002), (y[0] + wall + GAP, y[1] - wall - GAP)
    parts.append(make_lift_out(inside, (ledge + 0.0015, rim - 0.012), 0.012, "drawer"))
    return Assembly((*walls, *feet, *straps, plate, *ledges), parts)


def _make_side_handles(half: float, z: float) -> list[ShapePart]:
    """Side handles of a body that is ``2 * half`` metres wide."""
    panel = Panel(x=-half, thickness=0.02, y=(-0.3, 0.3), z=(z - 0.1, z + 0.1))
    design = HandleDesign(kind="arch", length=0.13, thickness=0.012, finish="metal")
    made = make_handle(panel, design, name="handle", parent="body", upright=False, at=(0.0, z))
    return [replace(turn_part(made, side), name=f"handle_{side}") for side in ("left", "right")]


def _build_tub(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A tub that tapers downwards, a lid with a raised field and a clip at each side; some have wheels."""
    wall, clip = 0.006, 0.0115
    x, y = (-depth / 2, depth / 2), (clip - width / 2, width / 2 - clip)
    thick, rise = 0.012, choose(rng, 0.006, 0.014)
    rim = height - thick - rise - GAP
    taper = choose(rng, 0.08, 0.16) * min(depth, height)
    inner = shrink((x, y), 0.016)
    walls = build_vessel(shrink(inner, taper / 2), inner, (0.0, rim), wall, "body")
    brim = [
        block(narrow(x, 0.004), (y[0], inner[1][0] + wall), (rim - 0.018, rim), "body"),
        block(narrow(x, 0.004), (inner[1][1] - wall, y[1]), (rim - 0.018, rim), "body"),
        block((x[0] + 0.004, inner[0][0] + wall), narrow(inner[1], wall), (rim - 0.018, rim), "body"),
        block((inner[0][1] - wall, x[1] - 0.004), narrow(inner[1], wall), (rim - 0.018, rim), "body"),
    ]
    low = rim + GAP
    field = shrink((x, y), 0.03)
    solids = (
        block(x, y, (low, low + thick), "top", 0.004),
        loft(field, shrink(field, 0.01), (low + thick, height), "top"),
    )
    motion = hinge_lid(x, y, low, radians(choose(rng, 95, 110)))
    needs = require("clip_left", "clip_right")
    lid = ShapePart("lid", "door", solids, motion, needs=needs)
    half = min(0.05, 0.16 * depth)
    made = make_latch(
        -y[1], (-half, half), (rim - 0.045, low + 0.9 * thick), name="clip", parent="body", finish="trim"
    )
    clips = [replace(turn_part(made, side), name=f"clip_{side}") for side in ("left", "right")]
    return Assembly((*walls, *brim), (lid, *clips))


def _build_carton(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A carton with two or four flaps; the outer ones, front and rear, close over those at the sides."""
    wall = max(0.005, max(width, depth, height) / 56)
    x, y = (-depth / 2, depth / 2), (-width / 2, width / 2)
    four = bool(rng.random() < 0.75)
    upper = height - wall - GAP  # front and rear wall
    side = upper - wall - GAP if four else upper
    inner = narrow(x, wall)
    pieces = (
        block((x[0], inner[0]), y, (0.0, upper), "body"),
        block((inner[1], x[1]), y, (0.0, upper), "body"),
        block(inner, (y[0], y[0] + wall), (0.0, side), "body"),
        block(inner, (y[1] - wall, y[1]), (0.0, side), "body"),
        block(inner, narrow(y, wall), (0.0, wall), "body"),
    )
    opened = radians(choose(rng, 105, 178))
    taped, tape = bool(rng.random() < 0.6), 0.026
    parts: list[ShapePart] = []
    for name, near, far in (("front", x[0], -0.0008), ("rear", 0.0008, x[1])):
        edge = "bottom" if name == "front" else None
        span = (near, far)
        seam = (far - tape, far) if name == "front" else (near, near + tape)
        rest = (near, far - tape) if name == "front" else (near + tape, far)
        solids = [block(rest, narrow(y, 0.001), (height - wall, height), "body")]
        strip = block(seam, narrow(y, 0.001), (height - wall, height), "trim" if taped else "body")
        motion = hinge_lid(span, y, height - wall, opened, edge)
        parts.append(ShapePart(f"flap_{name}", "door", (*solids, strip), motion))
    if four:
        needs = tuple(Need(part=part.name) for part in parts)
        reach = min(depth / 2, width / 2 - 0.004)
        across = narrow(inner, GAP)
        sides: tuple[tuple[Edge, Range], ...] = (
            ("right", (y[0], y[0] + reach)),
            ("left", (y[1] - reach, y[1])),
        )
        for name, span in sides:
            low = side + GAP
            solid = block(across, span, (low, low + wall), "body")
            motion = hinge_lid(across, span, low, opened, name)
            parts.append(ShapePart(f"flap_{name}", "door", (solid,), motion, needs=needs))
    marks = _mark_carton(rng, x[0], y, height) if rng.random() < 0.7 else ()
    return Assembly((*pieces, *marks), parts)


def _mark_carton(rng: np.random.Generator, x: float, y: Range, height: float) -> tuple[Primitive, ...]:
    """Adds a paper label to the front."""
    wide, high = 0.3 * (y[1] - y[0]), 0.28 * height
    left = choose(rng, y[0] + 0.03, y[1] - 0.03 - wide)
    return (box((x - 0.0012, left, 0.5 * height), (x + 0.002, left + wide, 0.5 * height + high), "paper"),)
