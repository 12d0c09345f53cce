"""ChestFreezer: an insulated chest with a lid and baskets, or with sliding panes as in shops.

Chests of 100 to 400 l are 0.55 to 1.4 m wide, 0.55 to 0.72 m deep and 0.83 to 0.9 m high, with foam walls of
55 to 75 mm. A step in the floor at one end covers the compressor.
"""

from math import radians

import numpy as np

from artigen.shapes.appliances.cavity import build_feet
from artigen.shapes.appliances.control_panel import DIAL_GAP, DialDesign, design_dial, make_dial
from artigen.shapes.appliances.racks import build_basket
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import GAP, ROOM, Panel, Range, Space, around, narrow, slide, sweep_gap
from artigen.shapes.fittings.lids import build_vessel, hinge_lid
from artigen.shapes.fittings.locks import make_lock
from artigen.shapes.primitives import UP, Primitive, block, box, cylinder
from artigen.shapes.shape import ShapePart, require
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "ChestFreezer"
STYLES = {"white": 4.0, "steel": 1.5, "black": 1.0, "shop": 2.0}
ADS = ((0.16, 0.35, 0.62), (0.70, 0.14, 0.14), (0.12, 0.45, 0.42), (0.90, 0.62, 0.16))
"""Colours of the bands around freezers in shops."""
RAISED = 0.008
"""Height (m) of the handle above the lid."""
PLUG = 0.018
"""Depth (m) of the lid's liner in the chest."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a chest freezer that meets the wish."""
    style = choose_style(rng, STYLES, wish.style)
    shop = style == "shop"
    width = choose(rng, 0.9 if shop else 0.55, 1.7 if shop else 1.4, wish.width)
    depth = choose(rng, 0.55, 0.72, wish.depth)
    height = choose(rng, 0.83, 0.92, wish.height)
    finishes = draw_palette(rng, "appliance", "white" if shop else style)
    ad = choose_one(rng, ADS)
    dark, lamp = (0.14, 0.14, 0.15), (0.30, 0.62, 0.32)
    finishes["trim"] = Finish(kind="plastic", color=dark, accent=dark, gloss=0.2)
    finishes["lamp"] = Finish(kind="plastic", color=lamp, accent=lamp, gloss=0.4)
    finishes["mark"] = Finish(kind="plastic", color=ad, accent=ad, gloss=0.35)
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
    chest = build_vessel((x, y), (x, y), (foot, rim), wall, "body", lining="inside")
    feet = build_feet(x, y, foot, "rubber", radius=0.025, inset=0.06)
    hollow = Space(x=narrow(x, wall), y=narrow(y, wall), z=(foot + wall, rim))
    step = min(choose(rng, 0.17, 0.24), 0.4 * hollow.width)
    level = foot + wall + 0.4 * hollow.height
    hump = block(hollow.x, (hollow.y[0], hollow.y[0] + step), (foot + wall, level), "inside")
    built = Assembly((*chest, *feet, hump)) + _build_controls(rng, dial, x[0], y, foot, step)
    if shop:
        low, high = foot + 0.24, rim - 0.06
        band = block((x[0] - 0.002, x[0] + 0.003), narrow(y, 0.02), (low, high), "mark")
        built += Assembly((band,)) + _build_panes((x, y), rim, height, wall)
        return built + Assembly(parts=tuple(_make_baskets(hollow, level, step, 1, ("pane_right",))))
    lid = _make_lid((x, y), hollow, (rim + GAP, height - RAISED), radians(choose(rng, 78, 90)))
    thick = choose(rng, 0.018, 0.024)
    face = Panel(x=x[0], thickness=0.02, y=y, z=(rim + GAP, height))
    design = HandleDesign(kind="block", length=choose(rng, 0.16, 0.28), thickness=thick)
    handle = make_handle(
        face, design, name="lid_handle", parent="lid", upright=False, at=(0.0, height - thick / 2)
    )
    parts = [lid, handle]
    if rng.random() < 0.6:
        parts.append(make_lock((x[0], 0.22 * width, rim - 0.035), name="lock", parent="body"))
    count = int(rng.integers(1, 3)) if width > 0.85 else 1
    parts += _make_baskets(hollow, level, step, count, ("lid",) * count)
    return built + Assembly(parts=parts)


def _make_lid(outline: tuple[Range, Range], hollow: Space, z: Range, upper: float) -> ShapePart:
    """An insulated lid: skin, gasket, and a liner that enters the chest."""
    x, y = outline
    skin = block(x, y, (z[0] + 0.012, z[1]), "front", 0.006)
    gasket = block(narrow(x, 0.012), narrow(y, 0.012), (z[0], z[0] + 0.02), "rubber")
    swing = sweep_gap(x[1] - hollow.x[0], PLUG)
    low = z[0] - PLUG
    liner = block(
        (hollow.x[0] + swing + 0.004, hollow.x[1] - 0.012),
        narrow(hollow.y, 0.008),
        (low, z[0] + 0.02),
        "inside",
    )
    motion = hinge_lid(x, y, z[0], upper)
    return ShapePart("lid", "door", (skin, gasket, liner), motion)


def _make_baskets(
    hollow: Space, level: float, step: float, count: int, covers: tuple[str, ...]
) -> list[ShapePart]:
    """Wire baskets that lift out: one on the step, the next one on the floor."""
    out = []
    start = hollow.y[0] + ROOM
    for k in range(count):
        low = level if k == 0 else hollow.z[0]
        end = start + (step if k == 0 else 0.3) - 2 * ROOM
        if end > hollow.y[1] - ROOM:
            break
        top = min(hollow.z[1] - PLUG - 0.012, low + 0.26)
        space = Space(x=narrow(hollow.x, ROOM), y=(start, end), z=(low + GAP, top))
        solids = build_basket(space, "steel", bars=4, posts=3, tines=0)
        lift = slide(0.85 * (top - low), UP)
        out.append(
            ShapePart(f"basket_{k}", "tray", solids, lift, needs=require(covers[k], fraction=1.0))
        )  # fmt: skip
        start = end + 2 * ROOM
    return out


def _build_panes(outline: tuple[Range, Range], rim: float, height: float, wall: float) -> Assembly:
    """A frame with two sliding panes."""
    x, y = outline
    inner_x, inner_y = narrow(x, 0.4 * wall), narrow(y, 0.4 * wall)
    frame: list[Primitive] = [
        block((x[0], inner_x[0]), y, (rim, height), "front", 0.004),
        block((inner_x[1], x[1]), y, (rim, height), "front", 0.004),
        block(inner_x, (y[0], inner_y[0]), (rim, height), "front"),
        block(inner_x, (inner_y[1], y[1]), (rim, height), "front"),
    ]
    long, overlap = inner_y[1] - inner_y[0] - 2 * GAP, 0.04
    half = (long + overlap) / 2
    parts: list[ShapePart] = []
    travel = half - overlap - 0.05
    for name, near, low, way in (
        ("left", inner_y[1] - GAP - half, 1, -1.0),
        ("right", inner_y[0] + GAP, 0, 1.0),
    ):
        z = rim + GAP + low * 0.022
        span = (near, near + half)
        deep = narrow(inner_x, GAP)
        rail = 0.026
        solids = [
            block((deep[0], deep[0] + rail), span, (z, z + 0.018), "trim"),
            block((deep[1] - rail, deep[1]), span, (z, z + 0.018), "trim"),
            block(narrow(deep, rail), (span[0], span[0] + rail), (z, z + 0.018), "trim"),
            block(narrow(deep, rail), (span[1] - rail, span[1]), (z, z + 0.018), "trim"),
            block(narrow(deep, rail), narrow(span, rail), (z + 0.003, z + 0.015), "clear"),
        ]
        motion = slide(travel, (0.0, way, 0.0))
        pane = f"pane_{name}"
        parts.append(ShapePart(pane, "door", tuple(solids), motion))
    return Assembly(frame, parts)


def _build_controls(
    rng: np.random.Generator, design: DialDesign, x: float, y: Range, foot: float, step: float
) -> Assembly:
    """A grille before the compressor, a thermostat beside it, and a drain."""
    low = foot + 0.04
    right = y[0] + 0.05
    slats = [
        box(
            (x - 0.002, right, low + 0.012 + 0.022 * k),
            (x + 0.003, right + 0.6 * step, low + 0.024 + 0.022 * k),
            "trim",
        )
        for k in range(int(rng.integers(4, 7)))
    ]
    at = (x, right + 0.6 * step + 0.06, low + 0.05)
    dial = make_dial(design, at, name="thermostat", parent="body")
    lamp = cylinder((x - 0.002, at[1] + 0.045, at[2]), (x + 0.003, at[1] + 0.045, at[2]), 0.006, "lamp")
    drain = cylinder((x - 0.006, y[1] - 0.12, low), (x + 0.003, y[1] - 0.12, low), 0.016, "trim")
    return Assembly((*slats, lamp, drain), (dial,))
