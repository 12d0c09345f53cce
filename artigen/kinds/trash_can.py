"""TrashCan: pedal bins, bins with a lid or a flap below a hood, sorting bins, and wheeled bins.

Catalogue sizes: pedal bins of 5 to 40 l (0.2 to 0.34 m across, 0.28 to 0.68 m high), kitchen bins of up to 60
l, and wheeled bins of EN 840-1 from 80 l (0.45 m x 0.53 m x 0.94 m) to 240 l (0.58 m x 0.74 m x 1.07 m).
"""

from dataclasses import replace
from math import radians

import numpy as np

from artigen.kind import Kind, Place, by_height, make, plurals
from artigen.shapes.appliances.rings import build_ring
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Spans, Wish, choose_lengths
from artigen.shapes.fittings.feet import make_wheel
from artigen.shapes.fittings.hardware import GAP, rotate, slide
from artigen.shapes.fittings.lids import build_collar, build_vessel, hinge_lid, loft, make_lid, shrink
from artigen.shapes.fittings.outlines import trace_corners
from artigen.shapes.primitives import (
    LEFT,
    RIGHT,
    ROUND,
    UP,
    Primitive,
    block,
    cylinder,
    polygon,
    polytope,
    prism,
)
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart, require
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import make_lacquer, make_metal, make_plastic
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "TrashCan"
STYLES = {"pedal": 3.0, "flip": 2.0, "flap": 1.6, "sorting": 1.4, "wheeled": 2.2}
SIZES: dict[str, Spans] = {
    "pedal": ((0.2, 0.34), (0.25, 0.4), (0.28, 0.68)),
    "flip": ((0.24, 0.42), (0.2, 0.34), (0.32, 0.68)),
    "flap": ((0.26, 0.42), (0.24, 0.36), (0.5, 0.8)),
    "sorting": ((0.5, 0.8), (0.28, 0.38), (0.45, 0.7)),
    "wheeled": ((0.45, 0.58), (0.53, 0.74), (0.93, 1.07)),
}
"""Width, depth and height (m)."""
SHELL: tuple[Color, ...] = (
    (0.90, 0.90, 0.89), (0.25, 0.26, 0.28), (0.13, 0.13, 0.14), (0.60, 0.61, 0.61),
    (0.62, 0.20, 0.18), (0.30, 0.45, 0.58), (0.82, 0.76, 0.66), (0.55, 0.66, 0.58),
)  # fmt: skip
STREET: tuple[Color, ...] = ((0.14, 0.33, 0.20), (0.20, 0.21, 0.22), (0.15, 0.26, 0.44), (0.33, 0.23, 0.16))
SORTED: tuple[Color, ...] = ((0.22, 0.42, 0.66), (0.86, 0.72, 0.20), (0.28, 0.52, 0.30), (0.45, 0.31, 0.20))
"""Lid colours: paper, packaging, glass and compost."""
SIDES = 22
"""Number of sides of a round bin."""
LIDS = ("first", "second", "third", "fourth")
"""Roles of the finishes of the lids of a sorting bin."""
SLENDER = 56
"""Largest ratio of a wall's length to its thickness."""
PEDAL, HUB = 0.045, 0.012
"""Protrusion (m) of a pedal in front and of a hinge behind."""
SPRING = 1.0
"""Torque (N m) that pulls a pedal up: 10 N at its tread."""
WALL = 0.008
"""Thickness (m) of moulded plastic walls."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a bin that meets the wish."""
    style = choose_style(rng, STYLES, wish.style)
    width, depth, height = choose_lengths(rng, wish, SIZES[style])
    slender = choose(rng, 0.5, 0.8)
    if style in ("pedal", "flip") and wish.width is None:
        width = max(min(width, slender * height), 0.42 * height)
    if style == "pedal" and wish.depth is None and rng.random() < 0.7:
        depth = width + HUB + PEDAL  # round: as deep as wide, plus the pedal
    build = {
        "pedal": _build_pedal_bin,
        "flip": _build_flip_bin,
        "flap": _build_flap_bin,
        "sorting": _build_sorting_bin,
        "wheeled": _build_wheeled_bin,
    }[style]
    built = build(rng, width, depth, height)
    return Draft(style, built.close(), _draw_finishes(rng, style))


def _draw_finishes(rng: np.random.Generator, style: str) -> dict[str, Finish]:
    """Finishes of the shell, its lid and its bucket."""
    seed = int(rng.integers(2**30))
    colors = STREET if style == "wheeled" else SHELL
    shell = make_plastic(choose_one(rng, colors))
    lids = [make_plastic(SORTED[int(k)]) for k in rng.permutation(len(SORTED))]
    lid, metallic, dark = lids[0] if style == "wheeled" else shell, rng.random() < 0.6, rng.random() < 0.5
    if style == "wheeled" and dark:
        lid = shell
    if style in ("flip", "flap") and dark:
        lid = make_plastic((0.15, 0.15, 0.16))
    if style == "pedal" or (style == "flap" and metallic):
        paint = shell.color
        shell = make_metal("steel", seed) if metallic else make_lacquer(paint, gloss=0.45)
        lid = make_plastic((0.14, 0.14, 0.15)) if dark else shell
    return draw_palette(rng, "appliance", "steel") | {
        "body": shell,
        "front": lid,
        "tray": make_plastic((0.17, 0.17, 0.18) if rng.random() < 0.7 else (0.75, 0.75, 0.74)),
        "trim": make_plastic((0.14, 0.14, 0.15)),
        **dict(zip(LIDS, lids, strict=False)),
    }


def _build_pedal_bin(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A round or square steel bin with a pedal that opens its lid, and a bucket that lifts out."""
    thick, foot, under = choose(rng, 0.016, 0.024), 0.05, 0.032
    x, y = (PEDAL - depth / 2, depth / 2 - HUB), around(0.0, width / 2)
    low = height - thick - 0.012
    rim, top = low - GAP, low + thick
    opened = radians(choose(rng, 96, 105))
    middle, radius = sum(x) / 2, min(x[1] - x[0], width) / 2
    half = min(0.045, 0.17 * width)
    is_round = abs(x[1] - x[0] - width) < 1e-6
    if is_round:
        x, y = around(middle, radius), around(0.0, radius)
        walls, cover, pail = _build_round(middle, radius, (under, foot, rim), (low, top, height))
    else:
        walls = (
            *build_vessel((x, y), (x, y), (foot, rim), WALL, "body", lining="trim"),
            block(narrow(x, 0.004), narrow(y, 0.004), (under, foot), "trim"),
        )
        field, inside = shrink((x, y), 0.005), shrink((x, y), WALL + 0.010)
        crown = loft(field, shrink(field, 0.03), (top, height), "front")
        cover = (block(x, y, (low, top), "front", 0.004), crown)
        pail = build_vessel(inside, inside, (foot + WALL + 0.004, rim - 0.012), 0.006, "tray")
    pivot = x[1] + HUB
    pieces = [
        *walls,
        block((x[1] - 0.01, pivot), around(0.0, 0.28 * width), (rim - 0.05, rim), "trim"),
        *_build_plinth(narrow(x, 0.006), narrow(y, 0.006), 0.4 * half + 0.005, under, is_round=is_round),
    ]
    tab = block((x[1] - 0.02, pivot), around(0.0, 0.25 * width), (low, low + 0.012), "front")
    pedal = _make_pedal(x[0] - PEDAL, x[0] + 0.05, half, under)
    assert pedal.joint is not None
    swing = hinge_lid((x[0], pivot), y, low, opened)
    swing = replace(swing, follows=pedal.name, ratio=swing.upper / pedal.joint.upper)
    parts = [ShapePart("lid", "door", (*cover, tab), swing), pedal]
    if rng.random() < 0.8:
        parts.append(_make_bucket("bucket", pail, 0.75 * (rim - foot), "pedal"))
    return Assembly(pieces, parts)


def _make_bucket(name: str, pail: tuple[Primitive, ...], lift: float, opener: str) -> ShapePart:
    """A bucket that lifts out once a part is open."""
    return ShapePart(name, "tray", pail, slide(lift, UP), needs=require(opener))


def _build_round(
    x: float, radius: float, body: tuple[float, float, float], cover: tuple[float, float, float]
) -> tuple[tuple[Primitive, ...], tuple[Primitive, ...], tuple[Primitive, ...]]:
    """Walls and base, cover, and bucket of a round bin.

    Args:
        x: x of its axis (m).
        radius: Radius.
        body: Heights of the base, of the floor and of the rim.
        cover: Heights of the underside, of the edge and of the dome of the cover.
    """
    (under, foot, rim), (low, top, crown) = body, cover
    wall = max(0.006, crown / SLENDER)
    inner = radius * float(np.cos(np.pi / SIDES)) - wall
    pail = inner - 0.010
    hollow = ROUND * pail - wall

    def disc(low: float, high: float, size: float, finish: str) -> Primitive:
        return cylinder((x, 0.0, low), (x, 0.0, high), size, finish)

    axis, shell, floor = (x, 0.0, 0.0), (inner, radius), foot + 0.0105
    walls = (
        *build_ring(axis, "z", (foot, rim), (shell, shell), "body", sides=SIDES, lining="trim"),
        disc(under, foot + 0.001, radius - 0.006, "trim"),
        disc(foot, foot + 0.008, inner + 0.002, "trim"),
    )
    dome = prism(0.96 * radius * polygon(), (x, 0, top), (x, 0, crown), "front", taper=0.7)
    bucket = (
        *build_ring(axis, "z", (floor, rim - 0.012), ((hollow, pail), (hollow, pail)), "tray"),
        disc(floor, foot + 0.0175, hollow + 0.003, "tray"),
    )
    return walls, (disc(low, top, radius, "front"), dome), bucket


def _build_plinth(x: Range, y: Range, slot: float, top: float, *, is_round: bool) -> list[Primitive]:
    """A base below a round or square bin, with a slot in front, ``slot`` to either side, for the pedal."""
    middle, radius = sum(x) / 2, y[1] if is_round else 0.0
    near, far = (radius, max(radius - slot, 0.0)), (radius, radius)
    sharp = (0.0, 0.0)
    plans = (
        ((middle, x[1]), y, (sharp, far, far, sharp)),
        ((x[0], middle), (slot, y[1]), (sharp, sharp, sharp, near)),
        ((x[0], middle), (y[0], -slot), (near, sharp, sharp, sharp)),
    )
    return [prism(trace_corners(*plan, 4), (0, 0, 0.0), (0, 0, top), "trim") for plan in plans]


def _make_pedal(tip: float, pivot: float, half: float, under: float) -> ShapePart:
    """A pedal lever just below ``under`` that protrudes in front and moves by a centimetre."""
    top = under - 0.0015
    solids = (
        block((tip + 0.03, pivot), around(0.0, 0.4 * half), (top - 0.006, top), "steel"),
        block((tip, tip + 0.034), around(0.0, half), (top - 0.008, top), "steel", 0.002),
    )
    drop = float((top - 0.011) / (pivot - tip))
    return ShapePart("pedal", "knob", solids, rotate(RIGHT, (pivot, 0.0, top), min(drop, 0.2), spring=SPRING))


def _build_flip_bin(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A moulded bin that tapers downwards, and a lid with a lip."""
    lip, thick, rise = 0.014, 0.012, choose(rng, 0.014, 0.03)
    x, y = (lip - depth / 2, depth / 2), around(0.0, width / 2)
    low = height - rise - thick
    taper = choose(rng, 0.0, 0.14) * min(width, depth)
    walls = build_vessel(shrink((x, y), taper / 2), (x, y), (0.0, low - GAP), WALL, "body")
    field = shrink((x, y), 0.006)
    solids = (
        block(x, y, (low, low + thick), "front", 0.003),
        block((x[0] - lip, x[0] + 0.01), around(0.0, 0.2 * width), (low, low + thick), "front"),
        loft(field, shrink(field, choose(rng, 0.02, 0.07)), (low + thick, height), "front"),
    )
    return Assembly(walls, (make_lid(solids, x, y, low, radians(choose(rng, 80, 105))),))


def _build_flap_bin(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A bin below a sloping hood with a flap, which is hinged at its upper edge."""
    x, y = around(0.0, depth / 2), around(0.0, width / 2)
    rim, wall = height - choose(rng, 0.5, 0.62) * depth, 0.01
    taper = choose(rng, 0.0, 0.12) * min(width, depth)
    walls = build_vessel(shrink((x, y), taper / 2), (x, y), (0.0, rim), wall, "body")
    front, top = x[0] + 0.008, x[0] + choose(rng, 0.55, 0.7) * depth  # ends of the slope
    eaves = rim + 0.03
    cheek = np.array([(rim, front), (eaves, front), (height, top), (height, x[1]), (rim, x[1])])
    hood = [prism(cheek, (0, a, 0), (0, a + wall, 0), "front") for a in (y[0], y[1] - wall)]
    inner = narrow(y, wall)
    hood += [
        block((x[1] - wall, x[1]), inner, (rim, height), "front"),
        block((top, x[1] - wall), inner, (height - wall, height), "front"),
        block((front, front + wall), inner, (rim, eaves - 0.012), "front"),
    ]
    flap = _make_flap((front, eaves), (top, height), narrow(inner, GAP))
    return Assembly((*walls, *hood), (flap,))


def _make_flap(low: tuple[float, float], high: tuple[float, float], y: Range) -> ShapePart:
    """A plate in the slope from one (x, z) up to another, with a lip below and a hinge above."""
    thick, gap = 0.008, 0.006
    start, way = np.array(low), np.array(high) - np.array(low)
    length = float(np.hypot(*way))
    along = way / length
    out = np.array([-along[1], along[0]])
    top = length - thick - gap  # its inner edge swings by its thickness

    def plate(run: Range, rise: Range, across: Range) -> Primitive:
        flat = [start + s * along + t * out for s in run for t in rise]
        return polytope(np.array([(x, b, z) for x, z in flat for b in across]), "front")

    middle, half = (y[0] + y[1]) / 2, 0.22 * (y[1] - y[0])
    solids = (
        plate((gap, top), (-thick, 0.0), y),
        plate((gap, gap + 0.014), (0.0, 0.014), around(middle, half)),
    )
    x, z = (start + top * along).tolist()
    turn = rotate(LEFT, (x, middle, z), radians(80))
    return ShapePart("flap", "door", solids, turn)


def _build_sorting_bin(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """Compartments side by side, each with a bucket and a lid in the colour of its waste."""
    count = int(np.clip(round(width / choose(rng, 0.2, 0.28)), 2, 4))
    lip = 0.014
    x, y = (lip - depth / 2, depth / 2), around(0.0, width / 2)
    low, pitch = height - 0.018, width / count
    rim = low - GAP
    pieces = list(build_vessel((x, y), (x, y), (0.0, rim), WALL, "body"))
    parts: list[ShapePart] = []
    for k in range(count):
        left = y[1] - k * pitch
        right, middle = left - pitch, left - pitch / 2
        if k:
            pieces.append(block(narrow(x, WALL), around(left, WALL / 2), (WALL, rim), "body"))
        own, grip = (right + 0.0015, left - 0.0015), around(middle, 0.25 * pitch)
        slab = block(x, own, (low, height), LIDS[k], 0.004)
        lug = block((x[0] - lip, x[0]), grip, (low, low + 0.012), LIDS[k])
        parts.append(make_lid((slab, lug), x, own, low, radians(98), name=f"lid_{k}"))
        sign = (x[0] - 0.003, x[0]), around(middle, 0.055), (0.66 * rim, 0.66 * rim + 0.09)
        pieces.append(block(*sign, LIDS[k]))
        ends = right - (WALL / 2 if k < count - 1 else 0.0), left + (WALL / 2 if k else 0.0)
        inside = shrink((x, ends), WALL + 0.010)
        pail = build_vessel(inside, inside, (WALL + GAP, rim - 0.015), 0.006, "tray")
        parts.append(_make_bucket(f"bucket_{k}", pail, 0.7 * rim, f"lid_{k}"))
    return Assembly(pieces, parts)


def _build_wheeled_bin(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A bin of EN 840, which tapers downwards and has two wheels behind and a push bar at its rim."""
    bar, lip, wall = 0.05, 0.016, 0.010
    x, y = (lip - depth / 2, depth / 2 - bar), around(0.0, width / 2)
    rise = choose(rng, 0.035, 0.06)
    low = height - rise
    rim, crest = low - GAP, low + 0.45 * rise
    radius, tread = choose(rng, 0.085, 0.1), 0.045
    bottom = (x[0] + 0.12 * depth, x[1] - 0.1 * depth), narrow(y, 0.07)
    inner = (x[0] + 0.012, x[1]), narrow(y, 0.012)
    arm, pivot = x[1] + bar - 0.014, x[1] + 0.012
    pieces = [
        *build_vessel(bottom, (x, y), (0.0, rim), wall, "body"),
        *build_collar((x, y), inner, (rim - 0.03, rim), "body"),
    ]
    for a in (-0.3 * width, 0.3 * width):
        pieces.append(block((x[1] - 0.02, arm + 0.004), around(a, 0.02), (rim - 0.05, rim - 0.02), "body"))
    grip = cylinder((arm, -0.36 * width, rim - 0.035), (arm, 0.36 * width, rim - 0.035), 0.014, "trim")
    solids = [
        loft((x, y), shrink((x, y), 0.004), (low, crest), "front"),
        loft(shrink((x, y), 0.012), shrink((x, y), 0.09), (crest, height), "front"),
        block((x[1] - 0.02, pivot), around(0.0, 0.3 * width), (low, low + 0.012), "front"),
    ]
    for a in (-0.28 * width, 0.28 * width):
        solids.append(block((x[0] - lip, x[0] + 0.01), around(a, 0.06), (low, low + 0.014), "front"))
    lid = make_lid(solids, (x[0], pivot), y, low, radians(choose(rng, 82, 90)))
    parts = [lid, ShapePart("handle", "handle", (grip,))]
    axle, level = bottom[0][1] - 0.3 * radius, ROUND * radius
    half = bottom[1][1]
    face = half + (y[1] - half) * 2 * radius / rim + GAP + 0.002  # the sides lean outwards at the wheels
    for index, side in enumerate((-1.0, 1.0)):
        parts.append(make_wheel(f"wheel_{index}", "body", (axle, side * (face + tread / 2), level), tread))
        stub = (side * (half - wall), side * (face - 0.003))
        pieces.append(cylinder((axle, stub[0], level), (axle, stub[1], level), 0.018, "steel"))
    return Assembly(pieces, parts)


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "trash can",
        "bin",
        "dustbin",
        "garbage can",
        "waste bin",
        "trash bin",
        "garbage bin",
        "rubbish bin",
        "litter bin",
        "wheelie bin",
        "wastebasket",
        "wastepaper basket",
        "dust bin",
        "waste basket",
        "trashcan",
        "garbage pail",
    ),
    hints=(),
    size=(by_height(0.6),),
    deepest=np.inf,
    diagonal=(0.2, 2.4),
    build="plastic",
    stands="free",
    styles=tuple(STYLES),
    style_words={
        "wheelie": "wheeled",
        "swing": "flap",
        "recycling": "sorting",
        "step": "pedal",
        "flip top": "flip",
    },
    forms={},
    sizes=((0.12, 1.3), (0.12, 1.1), (0.15, 1.6)),
    bare="width",
    make=make(density={"steel_sheet": 250.0}, wall={"plastic": 0.004}),
    makes={},
    feet=True,
    trade="appliance",
    synset="ashcan.n.01",
    wikidata=None,
    partnet=CATEGORY,
    body="trashcan_body",
    places=(Place(role="bin", low=(0.18, 0.18, 0.25), high=(0.5, 0.5, 0.75), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=27,
    draw=draw,
)
