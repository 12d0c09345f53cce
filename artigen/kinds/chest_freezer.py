"""ChestFreezer: an insulated chest with a lid and baskets, or with sliding panes as in shops.

Chests of 100 to 400 l are 0.55 to 1.4 m wide, 0.55 to 0.72 m deep and 0.83 to 0.9 m high, with foam walls of
55 to 75 mm. A step in the floor at one end covers the compressor.
"""

from math import radians

import numpy as np

from artigen.kind import Kind, Place, by_height, make, plurals
from artigen.shapes.appliances.cavity import build_feet, build_rim
from artigen.shapes.appliances.control_panel import DIAL_GAP, DialDesign, design_dial, make_dial
from artigen.shapes.appliances.racks import build_basket
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish, choose_lengths
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import GAP, ROOM, Panel, Space, slide, sweep_gap
from artigen.shapes.fittings.lids import Rectangle, build_vessel, make_lid, shrink
from artigen.shapes.fittings.locks import make_lock
from artigen.shapes.primitives import LEFT, RIGHT, UP, block, cylinder
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart, require
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "ChestFreezer"
STYLES = {"white": 4.0, "steel": 1.5, "black": 1.0, "shop": 2.0}
ADS = ((0.16, 0.35, 0.62), (0.70, 0.14, 0.14), (0.12, 0.45, 0.42), (0.90, 0.62, 0.16))
"""Colours of the bands around freezers in shops."""
DARK, GREEN = (0.14, 0.14, 0.15), (0.30, 0.62, 0.32)
RAISED = 0.008
"""Height (m) of the handle above the lid."""
PLUG = 0.018
"""Depth (m) of the lid's liner in the chest."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a chest freezer that meets the wish."""
    style = choose_style(rng, STYLES, wish.style)
    shop = style == "shop"
    wide = (0.9, 1.7) if shop else (0.55, 1.4)
    width, depth, height = choose_lengths(rng, wish, (wide, (0.55, 0.72), (0.83, 0.92)))
    finishes = draw_palette(rng, "appliance", "white" if shop else style)
    colors = {"mark": (choose_one(rng, ADS), 0.35), "trim": (DARK, 0.2), "lamp": (GREEN, 0.4)}
    for role, (color, gloss) in colors.items():
        finishes[role] = Finish(kind="plastic", color=color, accent=color, gloss=gloss)
    built = _build(rng, width, depth, height, shop=shop)
    return Draft(style, built.close(), finishes)


def _build(rng: np.random.Generator, width: float, depth: float, height: float, *, shop: bool) -> Assembly:
    """The chest on its feet, its lid or panes, its baskets and its controls."""
    dial = design_dial(rng, (0.018, 0.024), endless=0.3)
    reach, foot = max(0.0 if shop else 0.028, dial.length + DIAL_GAP), choose(rng, 0.02, 0.045)
    x, y = (reach - depth / 2, depth / 2), around(0.0, width / 2)
    wall = choose(rng, 0.055, 0.075)
    cover = 0.05 if shop else choose(rng, 0.06, 0.075)
    rim = height - cover - GAP
    hollow = Space(x=narrow(x, wall), y=narrow(y, wall), z=(foot + wall, rim))
    step = min(choose(rng, 0.17, 0.24), 0.4 * hollow.width)
    level = hollow.z[0] + 0.4 * hollow.height
    built = Assembly(
        (
            *build_vessel((x, y), (x, y), (foot, rim), wall, "body", lining="inside"),
            *build_feet(x, y, foot, "rubber", radius=0.025, inset=0.06),
            block(hollow.x, (hollow.y[0], hollow.y[0] + step), (hollow.z[0], level), "inside"),
        )
    )
    built += _build_controls(rng, dial, x[0], y, foot, step)
    if shop:
        band = block((x[0] - 0.002, x[0] + 0.003), narrow(y, 0.02), (foot + 0.24, rim - 0.06), "mark")
        baskets = _make_baskets(hollow, level, step, 1, "pane_right")
        return built + Assembly((band,)) + _build_panes((x, y), rim, height, wall) + Assembly(parts=baskets)
    lid = _make_lid((x, y), hollow, (rim + GAP, height - RAISED), radians(choose(rng, 78, 90)))
    thick = choose(rng, 0.018, 0.024)
    face = Panel(x=x[0], thickness=0.02, y=y, z=(rim + GAP, height))
    design = HandleDesign(kind="block", length=choose(rng, 0.16, 0.28), thickness=thick)
    at = (0.0, height - thick / 2)
    parts = [lid, make_handle(face, design, name="lid_handle", parent="lid", upright=False, at=at)]
    if rng.random() < 0.6:
        parts.append(make_lock((x[0], 0.22 * width, rim - 0.035), name="lock"))
    count = int(rng.integers(1, 3)) if width > 0.85 else 1
    return built + Assembly(parts=(*parts, *_make_baskets(hollow, level, step, count, "lid")))


def _make_lid(outline: Rectangle, hollow: Space, z: Range, upper: float) -> ShapePart:
    """An insulated lid on counterbalanced hinges: skin, gasket, and a liner that enters the chest."""
    (x, y), seal = outline, z[0] + 0.02
    swing = sweep_gap(x[1] - hollow.x[0], PLUG)
    liner_x = (hollow.x[0] + swing + 0.004, hollow.x[1] - 0.012)
    solids = (
        block(x, y, (z[0] + 0.012, z[1]), "front", 0.006),
        block(narrow(x, 0.012), narrow(y, 0.012), (z[0], seal), "rubber"),
        block(liner_x, narrow(hollow.y, 0.008), (z[0] - PLUG, seal), "inside"),
    )
    return make_lid(solids, x, y, z[0], upper, stays=True)


def _make_baskets(hollow: Space, level: float, step: float, count: int, cover: str) -> list[ShapePart]:
    """Wire baskets that lift out once a cover is open: one on the step, the next one on the floor."""
    out, start = [], hollow.y[0] + ROOM
    for k, (low, wide) in enumerate(((level, step), (hollow.z[0], 0.3))[:count]):
        end = start + wide - 2 * ROOM
        if end > hollow.y[1] - ROOM:
            break
        top = min(hollow.z[1] - PLUG - 0.012, low + 0.26)
        space = Space(x=narrow(hollow.x, ROOM), y=(start, end), z=(low + GAP, top))
        solids = build_basket(space, bars=4, posts=3, tines=0)
        lift, needs = slide(0.85 * (top - low), UP), require(cover, fraction=1.0)
        out.append(ShapePart(f"basket_{k}", "tray", solids, lift, needs=needs))
        start = end + 2 * ROOM
    return out


def _build_panes(outline: Rectangle, rim: float, height: float, wall: float) -> Assembly:
    """A frame with two sliding panes, the left one above the right one."""
    (x, y), (inner_x, inner_y), z = outline, shrink(outline, 0.4 * wall), (rim, height)
    frame = (
        block((x[0], inner_x[0]), y, z, "front", 0.004),
        block((inner_x[1], x[1]), y, z, "front", 0.004),
        block(inner_x, (y[0], inner_y[0]), z, "front"),
        block(inner_x, (inner_y[1], y[1]), z, "front"),
    )
    overlap, rail, deep = 0.04, 0.026, narrow(inner_x, GAP)
    low, high = narrow(inner_y, GAP)
    half = (high - low + overlap) / 2
    travel = half - overlap - 0.05
    parts = []
    for name, span, level, way in (
        ("pane_left", (high - half, high), rim + GAP + 0.022, RIGHT),
        ("pane_right", (low, low + half), rim + GAP, LEFT),
    ):
        glass = block(narrow(deep, rail), narrow(span, rail), (level + 0.003, level + 0.015), "clear")
        solids = (*build_rim(deep, span, (level, level + 0.018), rail, "trim"), glass)
        parts.append(ShapePart(name, "door", solids, slide(travel, way)))
    return Assembly(frame, parts)


def _build_controls(
    rng: np.random.Generator, design: DialDesign, x: float, y: Range, foot: float, step: float
) -> Assembly:
    """A grille before the compressor, a thermostat and a lamp beside it, and a drain."""
    low, face, grille = foot + 0.04, (x - 0.002, x + 0.003), (y[0] + 0.05, y[0] + 0.05 + 0.6 * step)
    slats = [
        block(face, grille, (low + 0.012 + 0.022 * k, low + 0.024 + 0.022 * k), "trim")
        for k in range(int(rng.integers(4, 7)))
    ]
    _, left, level = at = (x, grille[1] + 0.06, low + 0.05)
    lamp = cylinder((face[0], left + 0.045, level), (face[1], left + 0.045, level), 0.006, "lamp")
    drain = cylinder((x - 0.006, y[1] - 0.12, low), (face[1], y[1] - 0.12, low), 0.016, "trim")
    return Assembly((*slats, lamp, drain), (make_dial(design, at, name="thermostat"),))


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "chest freezer", "deep freezer", "deep freeze", "freezer chest", "shop freezer", "ice cream freezer"
    ),
    hints=(),
    size=(by_height(0.85),),
    deepest=np.inf,
    diagonal=(0.7, 2.8),
    build="foam",
    stands="free",
    styles=tuple(STYLES),
    style_words={"ice cream": "shop", "supermarket": "shop"},
    forms={},
    sizes=((0.4, 2.2), (0.4, 0.95), (0.6, 1.2)),
    bare="width",
    make=make(hidden=6.0),  # compressor
    makes={},
    feet=True,
    trade="appliance",
    synset="deep-freeze.n.01",
    wikidata=None,
    partnet=None,
    body="chestfreezer_body",
    places=(
        Place(role="chest freezer", low=(0.5, 0.5, 0.7), high=(0.8, 1.7, 1.0), draws=((0.0, 0.0, 0.0),)),
    ),
    holds=None,
    open_front=0.03,
    lid_stays=True,
    colored=(),
    laid_out=False,
    channel=None,
    word=11,
    draw=draw,
)
