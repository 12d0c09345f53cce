"""ToolBox: a portable plastic or steel box, a bench chest with drawers, or a box on wheels.

Boxes are sold by their length of 13 to 26 inches (0.33 to 0.66 m), half as deep and high; bench chests are
0.5 to 0.7 m wide and 0.3 to 0.42 m high, boxes on wheels 0.6 m high.
"""

from dataclasses import replace
from itertools import pairwise
from math import radians

import numpy as np

from artigen.shapes.assembly import Assembly, draw_styled
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Draft, Wish
from artigen.shapes.fittings.carrying import CHANNEL, build_channel, make_grip, make_pull_handle
from artigen.shapes.fittings.drawers import BoxDesign, make_drawer
from artigen.shapes.fittings.feet import make_wheel
from artigen.shapes.fittings.fronts import FrontDesign
from artigen.shapes.fittings.handles import HandleDesign
from artigen.shapes.fittings.hardware import FINGER_ROOM, GAP, Panel, Range, Space, narrow
from artigen.shapes.fittings.lids import (
    build_half_shell,
    build_roof,
    build_vessel,
    hinge_lid,
    make_lift_out,
    shrink,
)
from artigen.shapes.fittings.locks import make_latch
from artigen.shapes.primitives import DOWN, SEGMENTS, Primitive, block, box, cylinder
from artigen.shapes.shape import Need, ShapePart
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import make_lacquer, make_metal, make_plastic
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "ToolBox"
STYLES = {"plastic": 2.5, "metal": 2.5, "chest": 2.5, "rolling": 1.5}
SIZES: dict[str, tuple[Range, Range, Range]] = {
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
WALL = 0.007


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


def _make_latches(
    rng: np.random.Generator, x: float, width: float, rim: float, rise: float
) -> list[ShapePart]:
    """One latch in the middle of the front, or two latches."""
    half, count = choose(rng, 0.02, 0.03), int(rng.choice((1, 2, 2)))
    places = [0.0] if count == 1 else [-0.3 * width, 0.3 * width]
    return [
        make_latch(
            x, (at - half, at + half), (rim - 0.04, rim + rise), name=f"latch_{k}", parent="body", upper=2.2
        )
        for k, at in enumerate(places)
    ]


def _make_lid(
    solids: tuple[Primitive, ...], x: Range, y: Range, z: float, upper: float, latches: list[ShapePart]
) -> ShapePart:
    needs = tuple(Need(part=latch.name) for latch in latches)
    motion = hinge_lid(x, y, z, upper)
    return ShapePart("lid", "door", solids, motion, needs=needs)


def _build_plastic(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A tub, a deep lid with a grip in the middle, and a tray on ledges."""
    reach, grip = 0.013, FINGER_ROOM + 0.018
    x, y = (reach - depth / 2, depth / 2), (-width / 2, width / 2)
    rise = choose(rng, 0.22, 0.32) * (height - grip)
    rim = height - grip - rise - GAP
    taper = choose(rng, 0.03, 0.1) * depth
    pieces = list(build_vessel(shrink((x, y), taper / 2), (x, y), (0.0, rim), WALL, "body"))
    pieces += _build_band(x, y, (rim - 0.022, rim), "body")
    latches = _make_latches(rng, x[0] - 0.003, width, rim, min(0.035, 0.8 * rise))
    low = rim + GAP
    shell = build_half_shell(Space(x=x, y=y, z=(low, low + rise)), WALL, DOWN, "top", "top")
    ribs = [
        box((x[0] - 0.003, a - 0.012, low), (x[0] + WALL, a + 0.012, low + rise), "top")
        for a in (-0.42 * width, 0.42 * width)
    ]
    lid = _make_lid((*shell, *ribs), x, y, low, radians(choose(rng, 95, 110)), latches)
    span = choose(rng, 0.26, 0.5) * width
    handle = make_grip(
        (sum(x) / 2, 0.0, low + rise), span, name="lid_handle", parent="lid", thick=0.018, finish="handle"
    )
    tray = _add_tray(shrink((x, y), taper / 2), rim, pieces, lean=taper / 2)
    return Assembly(pieces, (lid, handle, *latches, *tray))


def _build_band(x: Range, y: Range, z: Range, finish: str) -> list[Primitive]:
    """A rib around the upper edge of a tub, which protrudes 3 mm in front."""
    return [
        block((x[0] - 0.003, x[0] + WALL), y, z, finish),
        block((x[0] + WALL, x[1]), (y[0], y[0] + WALL), z, finish),
        block((x[0] + WALL, x[1]), (y[1] - WALL, y[1]), z, finish),
    ]


def _add_tray(
    outline: tuple[Range, Range], rim: float, pieces: list[Primitive], lean: float = 0.0
) -> list[ShapePart]:
    """Adds a tray with a carrying bar, on two ledges of the body.

    ``outline`` is that of the body at its bottom; the rim is wider by ``lean`` on every side.
    """
    x, y = shrink(outline, WALL)
    level = max(0.45 * rim, rim - 0.075)
    reach = lean * level / rim + 0.003  # into the wall
    pieces += [
        block(x, (low, high), (level - 0.012, level), "body")
        for low, high in ((y[0] - reach, y[0] + 0.02), (y[1] - 0.02, y[1] + reach))
    ]
    inside = shrink((x, y), GAP + 0.002)
    tray = make_lift_out(inside, (level + 0.0015, rim - 0.026), 0.005, "tray")
    (x0, x1), (y0, y1) = inside
    middle = (x0 + x1) / 2
    wall = box((middle - 0.003, y0, level + 0.005), (middle + 0.003, y1, rim - 0.026), "tray")
    bar = box(
        (middle - 0.006, -0.16 * (y1 - y0), rim - 0.026),
        (middle + 0.006, 0.16 * (y1 - y0), rim - 0.006),
        "tray",
    )
    return [replace(tray, primitives=(*tray.primitives, wall, bar))]


def _build_metal(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A box of folded steel with a gabled lid and a grip along its ridge."""
    reach, grip = 0.012, FINGER_ROOM + 0.014
    x, y = (reach - depth / 2, depth / 2), (-width / 2, width / 2)
    rise = choose(rng, 0.24, 0.36) * (height - grip)
    rim = height - grip - rise - GAP
    pieces = list(build_vessel((x, y), (x, y), (0.0, rim), WALL, "body"))
    latches = _make_latches(rng, x[0] - 0.0005, width, rim, min(0.03, 0.55 * rise))
    low, middle = rim + GAP, sum(x) / 2
    ridge, eaves = choose(rng, 0.16, 0.3) * depth, low + 0.5 * rise
    outline = np.array(
        [
            (x[0], low),
            (x[0], eaves),
            (middle - ridge, low + rise),
            (middle + ridge, low + rise),
            (x[1], eaves),
            (x[1], low),
        ]
    )
    roof = build_roof(outline, WALL, y, "top")
    lid = _make_lid(roof, x, y, low, radians(choose(rng, 95, 115)), latches)
    span = choose(rng, 0.3, 0.6) * width
    handle = make_grip((middle, 0.0, low + rise), span, name="lid_handle", parent="lid", thick=0.014)
    tray = _add_tray((x, y), rim, pieces)
    return Assembly(pieces, (lid, handle, *latches, *tray))


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
    behind, lip = CHANNEL + 0.006, 0.024
    radius, tread, foot = choose(rng, 0.055, 0.075), 0.034, 0.03
    aside = tread + GAP + 0.002
    rise = choose(rng, 0.13, 0.2) * height
    built = _stack(rng, (width, depth, height), rise, behind=behind, foot=foot, aside=aside)
    back, rim = depth / 2 - behind, height - rise
    spread = choose(rng, 0.45, 0.6) * width
    channel = build_channel(back, spread, (foot + 0.1, rim - 0.05), "body")
    rods = make_pull_handle(
        back, spread, (foot + 0.1, rim - 0.02), 0.5 * (rim - foot), parent="body", finish="metal"
    )
    level = radius * float(np.cos(np.pi / SEGMENTS))
    parts, pieces = [rods], [*channel]
    at_x = back - 0.6 * radius
    for index, side in enumerate((-1.0, 1.0)):
        at = side * (width / 2 - tread / 2)
        parts.append(make_wheel(f"wheel_{index}", "body", (at_x, at, level), tread))
        hub = [(at_x, side * a, level) for a in (width / 2 - aside - WALL, width / 2 - tread - GAP)]
        pieces.append(cylinder(hub[0], hub[1], 0.02, "body"))
        edge = side * (width / 2 - aside - 0.03)
        pieces.append(
            box(
                (lip - depth / 2 + 0.03, edge - 0.03, 0.0),
                (lip - depth / 2 + 0.07, edge + 0.03, foot),
                "body",
            )
        )
    return built + Assembly(pieces, parts)


def _stack(
    rng: np.random.Generator,
    size: tuple[float, float, float],
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
    lip, thick = 0.024, 0.012
    x, y = (lip - depth / 2, depth / 2 - behind), (aside - width / 2, width / 2 - aside)
    rim = height - rise - GAP
    deck = foot + choose(rng, 0.5, 0.62) * (rim - foot)
    set_back = x[0] + thick + GAP
    pieces = [
        block((set_back, x[1]), y, (foot, foot + WALL), "body"),
        block((x[1] - WALL, x[1]), y, (foot + WALL, rim), "body"),
        block((x[0], x[1] - WALL), y, (deck, deck + WALL), "body"),
        block((x[0], x[0] + WALL), y, (deck + WALL, rim), "body"),
    ]
    for a in (y[0], y[1] - WALL):
        pieces.append(box((set_back, a, foot + WALL), (x[1] - WALL, a + WALL, deck), "body"))
        pieces.append(block(narrow(x, WALL), (a, a + WALL), (deck + WALL, rim), "body"))
    latches = _make_latches(rng, x[0] - 0.0005, width, rim, min(0.03, 0.6 * rise))
    low = rim + GAP
    shell = build_half_shell(Space(x=x, y=y, z=(low, low + rise)), WALL, DOWN, "top", "inside")
    lid = _make_lid(shell, x, y, low, radians(choose(rng, 84, 90)), latches)
    parts = [lid, *latches]
    shares = np.linspace(
        1.0, choose(rng, 1.0, 1.7), int(np.clip((deck - foot) / rng.uniform(0.055, 0.09), 1, 4))
    )
    design = HandleDesign(kind="edge", length=choose(rng, 0.4, 0.8) * width, thickness=0.010)
    front = FrontDesign(style="flat", frame=0.0, handle=design)
    tops = deck - 0.003 - np.concatenate([[0.0], np.cumsum(shares)]) / shares.sum() * (deck - foot - 0.005)
    for index, (upper, lower) in enumerate(pairwise(tops.tolist())):
        panel = Panel(x=x[0], thickness=thick, y=narrow(y, 0.001), z=(lower + 0.003, upper))
        z = (max(panel.z[0], foot + WALL), panel.z[1])
        space = Space(x=(panel.back, x[1] - WALL), y=narrow(y, WALL), z=z)
        style = BoxDesign(wall=0.006, floor=0.005, rim=0.8, finish="tray")
        parts += make_drawer(
            panel, space, front, box=style, name=f"drawer_{index}", parent="body", travel=0.75
        )
    if rim - deck > 0.12:
        parts += _add_tray((x, y), rim, pieces)
    return Assembly(pieces, parts)
