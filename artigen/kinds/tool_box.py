"""ToolBox: a portable plastic or steel box, a bench chest with drawers, or a box on wheels.

Boxes are sold by their length of 13 to 26 inches (0.33 to 0.66 m), half as deep and high; bench chests are
0.5 to 0.7 m wide and 0.3 to 0.42 m high, boxes on wheels 0.6 m high.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import radians

import numpy as np

from artigen.kind import Kind, Place, by_longest, make, plurals
from artigen.shapes.assembly import Assembly, draw_styled
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Draft, Size, Spans, Wish
from artigen.shapes.fittings.carrying import CHANNEL, build_channel, make_grip, make_pull_handle
from artigen.shapes.fittings.drawers import BoxDesign, make_drawer
from artigen.shapes.fittings.feet import make_wheel
from artigen.shapes.fittings.fronts import FrontDesign
from artigen.shapes.fittings.handles import HandleDesign
from artigen.shapes.fittings.hardware import FINGER_ROOM, GAP, Panel, Space
from artigen.shapes.fittings.lids import (
    Rectangle,
    build_half_shell,
    build_roof,
    build_vessel,
    make_lid,
    make_lift_out,
    shrink,
)
from artigen.shapes.fittings.locks import DEEP, FREE, UNHOOKED, make_latch
from artigen.shapes.primitives import ROUND, Primitive, block, cylinder
from artigen.shapes.ranges import Range, around, margins, narrow, share_down
from artigen.shapes.shape import ShapePart, require
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import make_lacquer, make_metal, make_plastic
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "ToolBox"
STYLES = {"plastic": 2.5, "metal": 2.5, "chest": 2.5, "rolling": 1.5}
SIZES: dict[str, Spans] = {
    "plastic": ((0.36, 0.62), (0.2, 0.29), (0.2, 0.32)),
    "metal": ((0.36, 0.56), (0.17, 0.25), (0.2, 0.3)),
    "chest": ((0.5, 0.7), (0.26, 0.36), (0.3, 0.42)),
    "rolling": ((0.44, 0.56), (0.36, 0.46), (0.54, 0.68)),
}
"""Width, depth and height (m)."""
PAINTS: tuple[Color, ...] = ((0.66, 0.12, 0.11), (0.66, 0.12, 0.11), (0.16, 0.30, 0.52), (0.17, 0.18, 0.19),
                             (0.44, 0.46, 0.47), (0.16, 0.33, 0.25), (0.86, 0.62, 0.12))  # fmt: skip
PAIRS: tuple[tuple[Color, Color], ...] = (
    ((0.15, 0.15, 0.16), (0.90, 0.70, 0.10)), ((0.15, 0.15, 0.16), (0.80, 0.20, 0.14)),
    ((0.16, 0.29, 0.48), (0.16, 0.16, 0.17)), ((0.17, 0.17, 0.18), (0.86, 0.44, 0.12)),
    ((0.14, 0.36, 0.36), (0.17, 0.17, 0.18)), ((0.40, 0.42, 0.43), (0.70, 0.14, 0.12)),
)  # fmt: skip
"""Colours of body and lid of plastic boxes."""
WALL, LIP = 0.007, 0.024
"""Thickness (m) of the walls; protrusion of the handles of drawers."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a tool box that meets the wish."""
    builders = {
        "plastic": _build_plastic,
        "metal": _build_metal,
        "chest": _build_chest,
        "rolling": _build_rolling,
    }
    return draw_styled(rng, wish, STYLES, SIZES, builders, _draw_finishes)


def _draw_finishes(rng: np.random.Generator, style: str) -> dict[str, Finish]:
    seed = int(rng.integers(2**30))
    paint = make_lacquer(choose_one(rng, PAINTS), gloss=0.4)
    body, lid = (make_plastic(color) for color in choose_one(rng, PAIRS))
    finishes = draw_palette(rng, "appliance", "steel") | {"handle": make_metal("chrome", seed)}
    if style in ("metal", "chest"):
        return finishes | {"body": paint, "top": paint, "front": paint, "tray": paint, "inside": paint}
    handle = make_plastic((0.16, 0.16, 0.17)) if lid.color[0] > 0.2 else body
    return finishes | {
        "body": body, "top": lid, "front": lid, "tray": lid, "handle": handle, "steel": lid, "inside": body,
        "metal": make_metal("steel", seed),
    }  # fmt: skip


def _make_latches(rng: np.random.Generator, x: float, y: Range, rim: float, rise: float) -> list[ShapePart]:
    """One latch in the middle of the front, or two latches."""
    half, count = choose(rng, 0.012, 0.018), int(rng.choice((1, 2, 2)))
    places, z = [0.0] if count == 1 else [0.6 * y[0], 0.6 * y[1]], (rim - 0.04, rim + rise)
    return [make_latch(x, around(at, half), z, name=f"latch_{k}", upper=1.6) for k, at in enumerate(places)]


def _cover(
    solids: Sequence[Primitive], outline: Rectangle, low: float, degrees: float, latches: list[ShapePart]
) -> ShapePart:
    """A lid at height ``low`` that latches hold down; its hinges are tight, so that it stays open."""
    needs = require(*(latch.name for latch in latches), fraction=UNHOOKED)
    return make_lid(solids, *outline, low, radians(degrees), needs=needs, stays=True)


def _build_plastic(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A tub with a rib around its rim, a deep lid with a grip in the middle, and a tray on ledges."""
    grip, rib = FINGER_ROOM + 0.018, 0.003
    reach = rib + FREE + DEEP
    x, y = (reach - depth / 2, depth / 2), around(0.0, width / 2)
    rise = choose(rng, 0.22, 0.32) * (height - grip)
    low = height - grip - rise
    rim, top = low - GAP, low + rise
    taper = choose(rng, 0.03, 0.1) * depth
    tub = build_vessel(shrink((x, y), taper / 2), (x, y), (0.0, rim), WALL, "body")
    face, z = (x[0] - rib, x[0] + WALL), (rim - 0.022, rim)
    band = (
        block(face, y, z, "body"),
        *(block((face[1], x[1]), side, z, "body") for side in margins(y, WALL)),
    )
    shell = build_half_shell(Space(x=x, y=y, z=(low, top)), WALL, "top", "top")
    ribs = [block(face, around(a, 0.012), (low, top), "top") for a in (-0.42 * width, 0.42 * width)]
    latches = _make_latches(rng, face[0], y, rim, min(0.035, 0.8 * rise))
    lid = _cover((*shell, *ribs), (x, y), low, choose(rng, 95, 110), latches)
    span = choose(rng, 0.26, 0.5) * width
    handle = make_grip((sum(x) / 2, 0.0, top), span, name="lid_handle", parent="lid", thick=0.018)
    inside = _make_tray(shrink((x, y), taper / 2), rim, lean=taper / 2)
    return Assembly((*tub, *band), (lid, handle, *latches)) + inside


def _make_tray(outline: Rectangle, rim: float, lean: float = 0.0) -> Assembly:
    """A tray with a carrying bar, on two ledges of the body.

    ``outline`` is that of the body at its bottom; the rim is wider by ``lean`` on every side.
    """
    x, y = shrink(outline, WALL)
    level, top = max(0.45 * rim, rim - 0.075), rim - 0.026
    reach = lean * level / rim + 0.003  # into the wall
    ledges = [
        block(x, span, (level - 0.012, level), "body")
        for span in ((y[0] - reach, y[0] + 0.02), (y[1] - 0.02, y[1] + reach))
    ]
    inside = shrink((x, y), GAP + 0.002)
    tray = make_lift_out(inside, (level + 0.0015, top), 0.005, "tray")
    middle, half = sum(inside[0]) / 2, 0.16 * (inside[1][1] - inside[1][0])
    wall = block(around(middle, 0.003), inside[1], (level + 0.005, top), "tray")
    bar = block(around(middle, 0.006), around(0.0, half), (top, rim - 0.006), "tray")
    return Assembly(ledges, (replace(tray, primitives=(*tray.primitives, wall, bar)),))


def _build_metal(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A box of folded steel with a gabled lid and a grip along its ridge."""
    reach, grip = FREE + DEEP + 0.0005, FINGER_ROOM + 0.014
    x, y = (reach - depth / 2, depth / 2), around(0.0, width / 2)
    rise = choose(rng, 0.24, 0.36) * (height - grip)
    low, middle = height - grip - rise, sum(x) / 2
    rim, top, eaves = low - GAP, low + rise, low + 0.5 * rise
    tub = build_vessel((x, y), (x, y), (0.0, rim), WALL, "body")
    latches = _make_latches(rng, x[0] - 0.0005, y, rim, min(0.03, 0.55 * rise))
    ridge = around(middle, choose(rng, 0.16, 0.3) * depth)
    slopes = [(x[0], low), (x[0], eaves), (ridge[0], top), (ridge[1], top), (x[1], eaves), (x[1], low)]
    roof = build_roof(np.array(slopes), WALL, y, "top")
    lid = _cover(roof, (x, y), low, choose(rng, 95, 115), latches)
    span = choose(rng, 0.3, 0.6) * width
    handle = make_grip((middle, 0.0, top), span, name="lid_handle", parent="lid", thick=0.014)
    return Assembly(tub, (lid, handle, *latches)) + _make_tray((x, y), rim)


def _build_chest(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A bench chest: drawers below a well with a lid, a grip on top."""
    grip = FINGER_ROOM + 0.014
    rise = choose(rng, 0.13, 0.2) * height
    built = _stack(rng, (width, depth, height - grip), rise, behind=0.0, foot=0.0)
    span = choose(rng, 0.3, 0.45) * width
    handle = make_grip((0.012, 0.0, height - grip), span, name="lid_handle", parent="lid", thick=0.014)
    return built + Assembly(parts=(handle,))


def _build_rolling(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A higher chest on two wheels, with a telescopic handle behind."""
    behind, tread, foot = FINGER_ROOM + CHANNEL, 0.034, 0.03
    radius = choose(rng, 0.055, 0.075)
    aside = tread + GAP + 0.002
    rise = choose(rng, 0.13, 0.2) * height
    built = _stack(rng, (width, depth, height), rise, behind=behind, foot=foot, aside=aside)
    back, rim, low = depth / 2 - behind, height - rise, foot + 0.1
    spread = choose(rng, 0.45, 0.6) * width
    travel = 0.5 * (rim - foot)
    rods = make_pull_handle(back, spread, (low, rim - 0.02), travel, out=FINGER_ROOM, finish="metal")
    pieces, parts = [*build_channel(back, spread, (low, rim - 0.05), "body")], [rods]
    x, level, front = back - 0.6 * radius, ROUND * radius, LIP - depth / 2 + 0.03
    for index, side in enumerate(around(0.0, 1.0)):
        parts.append(make_wheel(f"wheel_{index}", "body", (x, side * (width - tread) / 2, level), tread))
        inner, outer = (side * (width / 2 - a) for a in (aside + WALL, tread + GAP))
        pieces.append(cylinder((x, inner, level), (x, outer, level), 0.02, "body"))
        stand = around(side * (width / 2 - aside - 0.03), 0.03)
        pieces.append(block((front, front + 0.04), stand, (0.0, foot), "body"))
    return built + Assembly(pieces, parts)


def _stack(
    rng: np.random.Generator,
    size: Size,
    rise: float,
    *,
    behind: float,
    foot: float,
    aside: float = 0.0,
) -> Assembly:
    """Drawers below a well with a lid of height ``rise``.

    ``behind``, ``aside`` and ``foot`` (m) are the space left at the rear, at each side and below.
    """
    width, depth, height = size
    x, y = (LIP - depth / 2, depth / 2 - behind), around(0.0, width / 2 - aside)
    low, thick = height - rise, 0.012
    rim, floor = low - GAP, foot + WALL
    deck = foot + choose(rng, 0.5, 0.62) * (rim - foot)
    start, (x0, x1), well = x[0] + thick + GAP, narrow(x, WALL), (deck + WALL, rim)
    pieces = [
        block((start, x[1]), y, (foot, floor), "body"),
        block((x1, x[1]), y, (floor, rim), "body"),
        block((x[0], x1), y, (deck, deck + WALL), "body"),
        block((x[0], x0), y, well, "body"),
    ]
    for span in margins(y, WALL):
        pieces += [block((start, x1), span, (floor, deck), "body"), block((x0, x1), span, well, "body")]
    latches = _make_latches(rng, x[0] - 0.0005, around(0.0, width / 2), rim, min(0.03, 0.6 * rise))
    shell = build_half_shell(Space(x=x, y=y, z=(low, height)), WALL, "top", "inside")
    parts = [_cover(shell, (x, y), low, choose(rng, 84, 90), latches), *latches]
    largest = choose(rng, 1.0, 1.7)
    shares = np.linspace(1.0, largest, int(np.clip((deck - foot) / rng.uniform(0.055, 0.09), 1, 4)))
    grip = HandleDesign(kind="edge", length=choose(rng, 0.4, 0.8) * width, thickness=0.010)
    front = FrontDesign(style="flat", frame=0.0, handle=grip)
    box = BoxDesign(wall=0.006, floor=0.005, rim=0.8, finish="tray")
    for index, (lower, upper) in enumerate(share_down((foot + 0.002, deck - 0.003), shares.tolist())):
        panel = Panel(x=x[0], thickness=thick, y=narrow(y, 0.001), z=(lower + 0.003, upper))
        space = Space(x=(panel.back, x1), y=narrow(y, WALL), z=(max(panel.z[0], floor), upper))
        parts += make_drawer(panel, space, front, box=box, name=f"drawer_{index}")
    built = Assembly(pieces, parts)
    return built + _make_tray((x, y), rim) if rim - deck > 0.12 else built


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("tool box", "toolbox", "tool chest", "tool case", "tool cabinet"),
    hints=(),
    size=(by_longest(0.5),),
    deepest=np.inf,
    diagonal=(0.2, 1.8),
    build="metal",
    stands="free",
    styles=tuple(STYLES),
    style_words={"mechanic": "chest"},
    forms={},
    sizes=((0.25, 1.1), (0.12, 0.8), (0.12, 1.3)),
    bare="width",
    make=make(density={"steel_sheet": 1000.0}, wall={"plastic": 0.003}),
    makes={},
    feet=True,
    trade=None,
    synset="toolbox.n.01",
    wikidata=None,
    partnet=None,
    body="toolbox_body",
    places=(
        Place(role="tool box", low=(0.15, 0.3, 0.12), high=(0.3, 0.6, 0.4), draws=((0.0, 0.0, 0.0),)),
        Place(role="tool chest", low=(0.25, 0.35, 0.45), high=(0.6, 0.9, 1.1), draws=((0.0, 0.0, 0.6),)),
    ),
    holds=None,
    open_front=None,
    lid_stays=True,
    colored=(),
    laid_out=False,
    channel=None,
    word=26,
    draw=draw,
)
