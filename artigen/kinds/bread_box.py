"""BreadBox: a counter-top box with a drop front, a curved lid that swings up, or a lid on top.

Catalogue sizes are 0.33 to 0.45 m wide, 0.22 to 0.29 m deep and 0.16 to 0.25 m high; a loaf of 1 kg is 0.3 m
long and 0.13 m high.
"""

from functools import partial
from math import radians

import numpy as np

from artigen.kind import Kind, Place, by_width, make, plurals
from artigen.shapes.appliances.cavity import build_feet, build_shell
from artigen.shapes.assembly import Assembly, draw_styled
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Draft, Spans, Wish
from artigen.shapes.fittings.carrying import make_grip
from artigen.shapes.fittings.fronts import FrontDesign, FrontStyle, make_door
from artigen.shapes.fittings.handles import HandleDesign, HandleKind
from artigen.shapes.fittings.hardware import FINGER_ROOM, GAP, Panel, Space, sweep_gap
from artigen.shapes.fittings.lids import build_vessel, join_outlines, make_lid
from artigen.shapes.primitives import block, cylinder, polytope, prism
from artigen.shapes.ranges import around, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.materials import make_lacquer, make_metal, make_wood
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "BreadBox"
STYLES = {"drop": 2.5, "window": 1.5, "curved": 2.5, "enamel": 1.5}
LOW: Spans = ((0.33, 0.45), (0.22, 0.29), (0.17, 0.23))
SIZES = dict.fromkeys(STYLES, LOW) | {"enamel": (*LOW[:2], (0.21, 0.27))}
PASTELS = ((0.92, 0.90, 0.84), (0.62, 0.74, 0.70), (0.62, 0.73, 0.80), (0.68, 0.20, 0.18), (0.16, 0.17, 0.18),
           (0.88, 0.70, 0.66))  # fmt: skip
KINDS: tuple[HandleKind, ...] = ("knob", "bar", "edge")
WALL = 0.009


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a bread box that meets the wish."""
    builders = {
        "drop": _build_drop,
        "window": partial(_build_drop, front="framed_glass"),
        "curved": _build_curved,
        "enamel": _build_enamel,
    }
    return draw_styled(rng, wish, STYLES, SIZES, builders, _draw_finishes)


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


def _build_drop(
    rng: np.random.Generator, width: float, depth: float, height: float, front: FrontStyle = "flat"
) -> Assembly:
    """A box with a drop front, which may have a pane; some have a shelf."""
    kind = choose_one(rng, KINDS)
    length = choose(rng, 0.022, 0.028) if kind == "knob" else choose(rng, 0.1, 0.2)
    handle = HandleDesign(kind=kind, length=length, thickness=0.010)
    foot, thick = 0.016, 0.013
    x, y = (handle.reach - depth / 2, depth / 2), around(0.0, width / 2)
    outer = Space(x=(x[0] + thick + GAP, x[1]), y=y, z=(foot, height))
    inner = outer.hollow(WALL)
    shell = build_shell(outer, inner, "body", "inside", ends=("top", "body"))
    feet = build_feet((outer.x[0] - 0.01, x[1]), y, foot, "rubber", radius=0.011, inset=0.03)
    top = height - max(0.001, sweep_gap(height - foot, thick) - 0.003)
    panel = Panel(x=x[0], thickness=thick, y=narrow(y, 0.001), z=(foot + 0.001, top))
    design = FrontDesign(style=front, frame=0.032, handle=handle, glass="clear")
    parts = [*make_door(panel, design, name="door", edge="bottom", upper=radians(78))]
    if height > 0.2 and rng.random() < 0.5:
        level = sum(inner.z) / 2
        board = block((inner.x[0] + 0.4 * inner.depth, inner.x[1]), inner.y, (level, level + 0.008), "inside")
        parts.append(ShapePart("shelf", "shelf", (board,)))
    return Assembly((*shell, *feet), parts)


def _build_curved(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """Two cheeks with a quarter-ellipse lid between, which swings up about its rear edge."""
    x, y = around(0.0, depth / 2), around(0.0, width / 2)
    sill = choose(rng, 0.2, 0.32) * height
    crest = x[0] + choose(rng, 0.5, 0.75) * depth  # where the curve meets the flat top
    turns, rear, inner = np.linspace(0.0, np.pi / 2, 7), x[1] - 0.03, narrow(y, WALL)

    def trace(inset: float) -> np.ndarray:
        """Curve and flat top, within a distance of the outside."""
        run, rise = crest - x[0] - inset, height - inset - sill
        curve = [(crest - run * np.cos(t), sill + rise * np.sin(t)) for t in turns]
        return np.array([*curve, (rear, height - inset)])

    outline = trace(0.0)
    profile = np.array([*outline[:-1, ::-1], (height, x[1]), (0.0, x[1]), (0.0, x[0])])
    cheeks = "foot" if rng.random() < 0.4 else "body"
    pieces = [
        *(prism(profile, (0, a, 0), (0, a + WALL, 0), cheeks) for a in (y[0], y[1] - WALL)),
        block(x, inner, (0.0, WALL), "body"),
        block((x[0], x[0] + WALL), inner, (WALL, sill - GAP), "body"),
        block((x[1] - WALL, x[1]), inner, (WALL, height), "body"),
        block((rear + GAP, x[1] - WALL), inner, (height - WALL, height), "body"),
    ]
    solids = join_outlines(outline, trace(WALL), narrow(inner, GAP), "front")
    lid = make_lid(solids, (x[0], rear), inner, height, radians(choose(rng, 70, 85)), stays=True)
    turn = choose(rng, 0.6, 0.85)  # where the bar is on the curve
    run, rise = crest - x[0], height - sill
    out = np.array([-np.cos(turn) / run, np.sin(turn) / rise])
    out /= np.hypot(*out)
    skin = np.array([crest - run * np.cos(turn), sill + rise * np.sin(turn)])
    end, foot, half = skin + 0.036 * out, skin - 0.006 * out, 0.004 * np.array([-out[1], out[0]])
    a, c = end.tolist()
    bar = cylinder((a, -0.3 * width, c), (a, 0.3 * width, c), 0.007, "handle")
    flat = [point + side for point in (end, foot) for side in (-half, half)]
    posts = [
        polytope(np.array([(x, b + s, z) for x, z in flat for s in (-0.006, 0.006)]), "handle")
        for b in (-0.26 * width, 0.26 * width)
    ]
    return Assembly(pieces, (lid, ShapePart("lid_handle", "handle", (bar, *posts), parent="lid")))


def _build_enamel(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A tall box with a lid on top and a grip on the lid."""
    x, y = around(0.0, depth / 2), around(0.0, width / 2)
    thick = choose(rng, 0.012, 0.02)
    low = height - FINGER_ROOM - 0.012 - thick
    rim = low - GAP
    walls = build_vessel((x, y), (x, y), (0.0, rim), 0.007, "body", lining="inside")
    sign = block((x[0] - 0.0015, x[0] + 0.003), around(0.0, 0.22 * width), (0.4 * rim, 0.66 * rim), "inside")
    slab = block(x, y, (low, low + thick), "top", 0.003)
    plug = block((x[0] + 0.016, x[1] - 0.012), narrow(y, 0.012), (low - 0.006, low + 0.004), "top")
    lid = make_lid((slab, plug), x, y, low, radians(choose(rng, 80, 95)), stays=True)
    handle = make_grip((-0.02, 0.0, low + thick), 0.11, name="lid_handle", parent="lid", thick=0.012)
    return Assembly((*walls, sign), (lid, handle))


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("bread box", "bread bin", "breadbox", "breadbin"),
    hints=(),
    size=(by_width(0.38),),
    deepest=np.inf,
    diagonal=(0.2, 1.0),
    build="board",
    stands="free",
    styles=tuple(STYLES),
    style_words={"roll top": "curved", "enamelled": "enamel"},
    forms={},
    sizes=((0.25, 0.6), (0.15, 0.4), (0.12, 0.4)),
    bare="width",
    make=make(density={"steel_sheet": 500.0}),
    makes={},
    feet=True,
    trade="appliance",
    synset=None,
    wikidata=None,
    partnet=None,
    body="breadbox_body",
    places=(Place(role="bread box", low=(0.15, 0.2, 0.12), high=(0.35, 0.5, 0.3), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=True,
    colored=(),
    laid_out=False,
    channel=None,
    word=10,
    draw=draw,
)
