"""BreadBox: a counter-top box with a drop front, a curved lid that swings up, or a lid on top.

Catalogue sizes are 0.33 to 0.45 m wide, 0.22 to 0.29 m deep and 0.16 to 0.25 m high; a loaf of 1 kg is 0.3 m
long and 0.13 m high.
"""

from math import radians

import numpy as np

from artigen.shapes.appliances.cavity import build_shell
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish
from artigen.shapes.fittings.carrying import make_grip
from artigen.shapes.fittings.fronts import FrontDesign, make_door
from artigen.shapes.fittings.handles import HandleDesign, HandleKind
from artigen.shapes.fittings.hardware import FINGER_ROOM, GAP, Panel, Space, narrow, sweep_gap
from artigen.shapes.fittings.lids import build_vessel, hinge_lid
from artigen.shapes.primitives import block, box, cylinder, polytope, prism
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.materials import make_lacquer, make_metal, make_wood
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "BreadBox"
STYLES = {"drop": 2.5, "window": 1.5, "curved": 2.5, "enamel": 1.5}
PASTELS = ((0.92, 0.90, 0.84), (0.62, 0.74, 0.70), (0.62, 0.73, 0.80), (0.68, 0.20, 0.18), (0.16, 0.17, 0.18),
           (0.88, 0.70, 0.66))  # fmt: skip
WALL = 0.009


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a bread box that meets the wish."""
    style = choose_style(rng, STYLES, wish.style)
    width = choose(rng, 0.33, 0.45, wish.width)
    depth = choose(rng, 0.22, 0.29, wish.depth)
    height = choose(rng, *((0.21, 0.27) if style == "enamel" else (0.17, 0.23)), wish.height)
    build = {"curved": _build_curved, "enamel": _build_enamel}.get(style, _build_drop)
    built = build(rng, (width, depth, height), style)
    return Draft(style, built.close(), _draw_finishes(rng, style))


def _draw_finishes(rng: np.random.Generator, style: str) -> dict[str, Finish]:
    """Bamboo and other woods, brushed steel, or enamel."""
    seed, pastel = int(rng.integers(2**30)), choose_one(rng, PASTELS)
    wood = choose_one(rng, ("birch", "oak", "walnut", "teak", "pine"))
    finishes = draw_palette(rng, "furniture", wood)
    timber, paint, steel = make_wood(wood, seed), make_lacquer(pastel, gloss=0.5), make_metal("steel", seed)
    for role in ("body", "front", "top"):
        if finishes[role].kind != "wood" and style in ("drop", "window"):
            finishes[role] = finishes["front"]
    shell = paint if style == "enamel" or rng.random() < 0.5 else steel
    if style in ("curved", "enamel"):
        finishes |= {"body": shell, "front": shell, "top": shell, "inside": make_lacquer((0.92, 0.92, 0.91))}
    if style == "enamel" and rng.random() < 0.5:
        finishes["top"] = timber
    if rng.random() < 0.4:
        finishes["handle"] = make_metal("black", seed)
    return finishes | {"foot": timber}


def _build_drop(rng: np.random.Generator, size: tuple[float, float, float], style: str) -> Assembly:
    """A box with a drop front, with a pane in style ``window``; some have a shelf."""
    width, depth, height = size
    kinds: tuple[HandleKind, ...] = ("knob", "bar", "edge")
    kind = kinds[int(rng.integers(3))]
    length = choose(rng, 0.022, 0.028) if kind == "knob" else choose(rng, 0.1, 0.2)
    handle = HandleDesign(kind=kind, length=length, thickness=0.010)
    foot, thick = 0.016, 0.013
    x = (handle.reach - depth / 2, depth / 2)
    y = (-width / 2, width / 2)
    outer = Space(x=(x[0] + thick + GAP, x[1]), y=y, z=(foot, height))
    inner = Space(x=(outer.x[0], x[1] - WALL), y=narrow(y, WALL), z=(foot + WALL, height - WALL))
    pieces = [*build_shell(outer, inner, "body", "inside", ends=("top", "body"))]
    pieces += [
        cylinder((a, b, 0.0), (a, b, foot), 0.011, "rubber")
        for a in (outer.x[0] + 0.02, x[1] - 0.03)
        for b in narrow(y, 0.03)
    ]
    panel = Panel(
        x=x[0], thickness=thick, y=narrow(y, 0.001),
        z=(foot + 0.001, height - max(0.001, sweep_gap(height - foot, thick) - 0.003)),
    )  # fmt: skip
    front = FrontDesign(
        style="framed_glass" if style == "window" else "flat", frame=0.032, handle=handle, glass="clear"
    )
    door = make_door(panel, front, name="door", parent="body", edge="bottom", upper=radians(78))
    shelves: list[ShapePart] = []
    if height > 0.2 and rng.random() < 0.5:
        level = (inner.z[0] + inner.z[1]) / 2
        board = Space(x=(inner.x[0] + 0.4 * inner.depth, inner.x[1]), y=inner.y, z=(level, level + 0.008))
        shelves.append(ShapePart("shelf", "shelf", (board.fill("inside"),)))
    return Assembly(pieces, (*door, *shelves))


def _build_curved(rng: np.random.Generator, size: tuple[float, float, float], style: str) -> Assembly:
    """Two cheeks with a quarter-ellipse lid between, which swings up about its rear edge."""
    width, depth, height = size

    x, y = (-depth / 2, depth / 2), (-width / 2, width / 2)
    sill = choose(rng, 0.2, 0.32) * height
    turns = np.linspace(0.0, np.pi / 2, 7)
    crest = x[0] + choose(rng, 0.5, 0.75) * (x[1] - x[0])  # where the curve meets the flat top
    arc = [(crest - (crest - x[0]) * np.cos(t), sill + (height - sill) * np.sin(t)) for t in turns]
    profile = np.array([(z, a) for a, z in arc] + [(height, x[1]), (0.0, x[1]), (0.0, x[0])])
    cheeks = "foot" if rng.random() < 0.4 else "body"
    pieces = [prism(profile, (0, a, 0), (0, a + WALL, 0), cheeks) for a in (y[0], y[1] - WALL)]
    inner = narrow(y, WALL)
    rear = x[1] - 0.03
    pieces += [
        block(x, inner, (0.0, WALL), "body"),
        block((x[0], x[0] + WALL), inner, (WALL, sill - GAP), "body"),
        block((x[1] - WALL, x[1]), inner, (WALL, height), "body"),
        block((rear + GAP, x[1] - WALL), inner, (height - WALL, height), "body"),
    ]
    outline = np.array([*arc, (rear, height)])
    solids = []
    reach, rise = crest - x[0] - WALL, height - WALL - sill
    curve = [(crest - reach * np.cos(t), sill + rise * np.sin(t)) for t in turns]
    inside = np.array([*curve, (rear, height - WALL)])
    for k in range(len(outline) - 1):
        flat = np.array([outline[k], outline[k + 1], inside[k], inside[k + 1]])
        corners = [(a, b, c) for b in narrow(inner, GAP) for a, c in flat]
        solids.append(polytope(np.array(corners), "front"))
    motion = hinge_lid((x[0], rear), inner, height, radians(choose(rng, 70, 85)))
    lid = ShapePart("lid", "door", tuple(solids), motion)
    turn = choose(rng, 0.6, 0.85)  # where the bar is on the curve
    out = np.array([np.cos(turn) / (crest - x[0]), np.sin(turn) / (height - sill)])
    out = np.array([-out[0], out[1]]) / np.hypot(*out)
    skin = np.array([crest - (crest - x[0]) * np.cos(turn), sill + (height - sill) * np.sin(turn)])
    (a, c), (inner_x, inner_z) = (skin + 0.036 * out).tolist(), (skin - 0.006 * out).tolist()
    bar = cylinder((a, -0.3 * width, c), (a, 0.3 * width, c), 0.007, "handle")
    foot, half = np.array([inner_x, inner_z]), 0.004 * np.array([-out[1], out[0]])
    flat = [end + side for end in (np.array([a, c]), foot) for side in (-half, half)]
    posts = [
        polytope(np.array([(x, b + s, z) for x, z in flat for s in (-0.006, 0.006)]), "handle")
        for b in (-0.26 * width, 0.26 * width)
    ]
    handle = ShapePart("lid_handle", "handle", (bar, *posts), parent="lid")
    return Assembly(pieces, (lid, handle))


def _build_enamel(rng: np.random.Generator, size: tuple[float, float, float], style: str) -> Assembly:
    """A tall box with a lid on top and a grip on the lid or at the sides."""
    width, depth, height = size
    grip = FINGER_ROOM + 0.012
    x, y = (-depth / 2, depth / 2), (-width / 2, width / 2)
    thick = choose(rng, 0.012, 0.02)
    rim = height - grip - thick - GAP
    walls = build_vessel((x, y), (x, y), (0.0, rim), 0.007, "body", lining="inside")
    sign = box((x[0] - 0.0015, -0.22 * width, 0.4 * rim), (x[0] + 0.003, 0.22 * width, 0.66 * rim), "inside")
    low = rim + GAP
    slab = block(x, y, (low, low + thick), "top", 0.003)
    plug = block((x[0] + 0.016, x[1] - 0.012), narrow(y, 0.012), (low - 0.006, low + 0.004), "top")
    motion = hinge_lid(x, y, low, radians(choose(rng, 80, 95)))
    lid = ShapePart("lid", "door", (slab, plug), motion)
    handle = make_grip((-0.02, 0.0, low + thick), 0.11, name="lid_handle", parent="lid", thick=0.012)
    return Assembly((*walls, sign), (lid, handle))
