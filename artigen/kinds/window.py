"""Window: casements with a turning handle, sashes that slide up, panes that slide sideways.

Profiles are 70 to 80 mm as in DIN 68121 (IV 68, IV 78), insulating glass is 24 mm thick, and handles turn by
90 degrees. A leaf is held by its handle, by a cam on the meeting rail, or by a bolt; two panes that
both slide, each half-way, are not held.
"""

from dataclasses import replace

import numpy as np

from artigen.kind import PLAIN, Kind, Place, by_height, plurals
from artigen.shapes.appliances.cavity import build_frame
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish, choose_size
from artigen.shapes.fittings.handles import HandleDesign, HandleKind, make_handle
from artigen.shapes.fittings.hardware import GAP, Panel, Space, rotate, slide
from artigen.shapes.fittings.hinges import Leaf, hang_leaves
from artigen.shapes.fittings.latches import (
    RELEASED,
    THROW,
    Hanging,
    Latch,
    build_jambs,
    build_lock_stile,
    build_tongue,
    hang_parts,
    make_bolt,
)
from artigen.shapes.fittings.levers import LeverDesign, build_lever, design_lever
from artigen.shapes.primitives import LEFT, RIGHT, UP, Primitive, block, cylinder
from artigen.shapes.ranges import Range, around, between, margins, narrow
from artigen.shapes.shape import ShapePart, require
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Window"
STYLES = {"casement": 0.5, "sash": 0.3, "sliding": 0.2}
PALETTES = ("white", "white", "white", "oak", "walnut", "anthracite", "pine", "sage")
SIZES: dict[str, tuple[Range, Range]] = {
    "casement": ((0.6, 1.5), (0.75, 1.45)),
    "sash": ((0.62, 1.0), (1.1, 1.65)),
    "sliding": ((1.2, 1.8), (0.8, 1.25)),
}
"""Width and height."""
PROFILE, SILL, OVERHANG = 0.055, 0.024, 0.03
LEAF = 0.056
"""Thickness of a casement leaf."""
SASH, APART, RAIL, STOP = 0.036, 0.008, 0.048, 0.012
"""Sliding sashes: thickness, gap between their tracks, width of their rails and of the stops beside them."""
LIFT = 0.06
"""Height of the pull on the lower rail of a sash: half of a hand that is 0.21 m wide fits above the sill."""
PANE = 0.024
PULLS: tuple[HandleKind, ...] = ("pull", "bar", "arch")
TWO_LEAVES = 1.12
"""Width from which a casement window has two leaves."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a window on its sill."""
    style = choose_style(rng, STYLES, wish.style)
    wide, tall = SIZES[style]
    width, depth, height = choose_size(rng, CATEGORY, wish, (wide, (0.19, 0.28), tall))
    deep = 0.084 if style == "casement" else STOP + SASH + APART + SASH + STOP
    x = (depth / 2 - deep, depth / 2)
    y = (OVERHANG - width / 2, width / 2 - OVERHANG)
    inner = Space(x=x, y=narrow(y, PROFILE), z=(SILL + PROFILE, height - PROFILE))
    sill = block(around(0.0, depth / 2), around(0.0, width / 2), (0.0, SILL), "top")
    bars = int(rng.integers(3)) if rng.random() < 0.4 else 0
    draw_kind = {"casement": _draw_casement, "sash": _draw_sashes, "sliding": _draw_sliding}[style]
    built = Assembly((sill,)) + draw_kind(rng, inner, bars)
    finishes = draw_palette(rng, "furniture", choose_one(rng, PALETTES))
    finishes["top"] = finishes["top"] if finishes["top"].kind == "stone" else finishes["front"]
    return Draft(style, built.close("frame"), finishes)


def _outline(inner: Space) -> tuple[Range, Range]:
    """Outer edges (y, z) of the frame."""
    return narrow(inner.y, -PROFILE), narrow(inner.z, -PROFILE)


def _glaze(x: Range, y: Range, z: Range, bars: int) -> list[Primitive]:
    """A pane with a number of horizontal bars and, if there are any, one vertical bar."""
    middle, half = sum(x) / 2, min(PANE, 0.6 * (x[1] - x[0])) / 2
    pieces = [block(around(middle, half), y, z, "glass")]
    out = (middle - half - 0.006, middle + half + 0.006)
    for k in range(bars):
        at = z[0] + (k + 1) * (z[1] - z[0]) / (bars + 1)
        pieces.append(block(out, y, around(at, 0.012), "front"))
    if bars:
        at = sum(y) / 2
        pieces.append(block(out, around(at, 0.012), z, "front"))
    return pieces


def _draw_casement(rng: np.random.Generator, inner: Space, bars: int) -> Assembly:
    """Draws one leaf or two; the handle of the first turns a tongue out of its keep."""
    count = 2 if inner.width > TWO_LEAVES - 2 * (PROFILE + OVERHANG) else 1
    lever = replace(design_lever(rng, (0.105, 0.125), 0.052), thickness=0.016, rose=0.02)
    leaves = hang_leaves(inner, LEAF, count=count, hand=1 if rng.random() < 0.5 else -1, sill=0.004)
    first, level = leaves[0], inner.z[0] + 0.45 * inner.height
    latch = Latch(x=first.x, edge=first.edge, side=first.side, level=level, backset=0.034, lift=-1)
    (low, high), (bottom, top) = _outline(inner)
    frame = [
        block(inner.x, (low, high), (a, b), "body") for a, b in ((bottom, inner.z[0]), (inner.z[1], top))
    ]
    frame += build_jambs(inner, PROFILE, latch if count == 1 else None)
    back = (inner.x[0] + LEAF + 0.003, inner.x[1])
    hole = narrow(inner.y, STOP), narrow(inner.z, STOP)
    frame += build_frame(back, (inner.y, inner.z), hole, "body")
    hanging = Hanging(
        levels=narrow(first.z, 0.13),
        barrel=0.07,
        straps=(0.025, 0.02),
        swing=(90.0, 105.0),
        key="handle",
        bolt=(0.046, inner.z[1] + 0.004),
        over=0.0,
        length=0.18,
        astragal=(0.02, 0.011),
    )
    built = Assembly(frame) + hang_parts(rng, leaves, hanging, lambda leaf: _build_leaf(leaf, latch, bars))
    return built + Assembly(parts=(_make_turn_handle(latch, lever),))


def _build_leaf(leaf: Leaf, latch: Latch, bars: int) -> list[Primitive]:
    """Stiles and rails around a pane; the lock stile holds the latch or its keep."""
    wide = 0.078
    hung, field, lock = leaf.stiles(wide)
    pieces = list(build_lock_stile(leaf, latch, lock, through=False))
    pieces.append(block(leaf.x, hung, leaf.z, "front"))
    pieces += [block(leaf.x, field, rail, "front") for rail in margins(leaf.z, wide)]
    return pieces + _glaze(leaf.x, field, narrow(leaf.z, wide), bars)


def _make_turn_handle(latch: Latch, design: LeverDesign) -> ShapePart:
    """A handle that points down and turns to horizontal to open."""
    (y, z) = latch.axis
    lever = build_lever(design, (latch.x[0], y, z), out=-1.0, along=(0.0, -1.0))
    motion = rotate((-latch.side, 0.0, 0.0), (latch.x[0], y, z), np.pi / 2)
    pieces = (*lever, *build_tongue(latch, through=False))
    return ShapePart("handle", "knob", pieces, motion, parent="leaf")


def _build_tracks(inner: Space, *, upright: bool) -> list[Primitive]:
    """A frame with stops before, between and behind two tracks, at its sides or above and below."""
    x, outline = inner.x, _outline(inner)
    pieces = list(build_frame(x, outline, (inner.y, inner.z), "body"))
    middle = x[0] + STOP + SASH
    slots = ((x[0], x[0] + STOP), (middle + 0.002, middle + APART - 0.002), (x[1] - STOP, x[1]))
    for low, high in slots:
        for at in margins(inner.y if upright else inner.z, STOP):
            y, z = (at, inner.z) if upright else (inner.y, at)
            pieces.append(block((low, high), y, z, "body"))
    return pieces


def _find_tracks(inner: Space) -> tuple[Range, Range]:
    """x of the sash that slides and of the fixed one behind it."""
    front = (inner.x[0] + STOP, inner.x[0] + STOP + SASH)
    return front, (front[1] + APART, front[1] + APART + SASH)


def _build_sash(x: Range, y: Range, z: Range, rails: tuple[float, float], bars: int) -> list[Primitive]:
    """Stiles, a lower and an upper rail of the given heights, and the pane."""
    hole = narrow(y, RAIL), (z[0] + rails[0], z[1] - rails[1])
    return [*build_frame(x, (y, z), hole, "front"), *_glaze(x, *hole, bars)]


def _draw_sashes(rng: np.random.Generator, inner: Space, bars: int) -> Assembly:
    """Draws a sash that slides up before a fixed one, held by a cam on its rail in a notch of the other."""
    front, back = _find_tracks(inner)
    y = narrow(inner.y, GAP)
    low, high = inner.z
    top = low + choose(rng, 0.46, 0.54) * (high - low)
    middle, deep = sum(y) / 2, back[0] + THROW + 0.006
    notch_y, notch_z = (middle - 0.016, middle + 0.044), (top + 0.001, top + 0.0175)
    rail, ledge = (top - RAIL, notch_z[0]), (notch_z[1], top + 0.034)
    frame = _build_tracks(inner, upright=True)
    frame += [block(back, inner.y, (a, b), "front") for a, b in (rail, ledge)]
    beside = (inner.y[0], notch_y[0]), (notch_y[1], inner.y[1])
    frame += [block(back, side, notch_z, "front") for side in beside]
    frame.append(block((deep, back[1]), notch_y, notch_z, "front"))
    free = narrow(inner.y, RAIL)
    frame += [block(back, side, (ledge[1], high), "front") for side in margins(inner.y, RAIL)]
    frame.append(block(back, free, (high - RAIL, high), "front"))
    frame += _glaze(back, free, (ledge[1], high - RAIL), bars)
    solids = _build_sash(front, y, (low + 0.002, top), (0.075, RAIL), bars)
    motion, needs = slide(0.92 * (high - top - 0.024), UP), require("cam", fraction=RELEASED)
    sash = ShapePart("sash", "door", solids, motion, parent="frame", needs=needs)
    at, z = ((front[0] + front[1]) / 2, middle), top + 0.0055
    cam = (
        cylinder((*at, top + 0.0015), (*at, top + 0.019), 0.013, "handle"),
        block((at[0], back[0] + THROW), around(middle, 0.008), (z, z + 0.008), "handle"),
        block((at[0] - 0.045, at[0]), around(middle, 0.006), (z + 0.007, z + 0.0135), "handle"),
    )
    turn = rotate(UP, (*at, top), np.pi / 2)
    lock = ShapePart("cam", "knob", cam, turn, parent="sash")
    panel = Panel(x=front[0], thickness=SASH, y=y, z=(low, low + 0.075))
    lift = HandleDesign(kind="pull", length=0.18, thickness=0.012)
    grip = make_handle(panel, lift, name="lift", parent="sash", upright=False, at=(middle, low + LIFT))
    return Assembly(frame, (sash, lock, grip))


def _draw_sliding(rng: np.random.Generator, inner: Space, bars: int) -> Assembly:
    """Draws a sash that slides sideways before a fixed one, held by a bolt in the frame above, or two."""
    front, back = _find_tracks(inner)
    z = narrow(inner.z, GAP)
    middle, left = sum(inner.y) / 2, bool(rng.random() < 0.5)
    over = RAIL / 2
    y = (middle - over, inner.y[1] - GAP) if left else (inner.y[0] + GAP, middle + over)
    frame = _build_tracks(inner, upright=False)
    if rng.random() < 0.4:
        return Assembly(frame, _make_panes(rng, inner, left=left, bars=bars))
    rest = (inner.y[0], middle + over) if left else (middle - over, inner.y[1])
    frame += _build_sash(back, rest, inner.z, (RAIL, RAIL), bars)
    stile = (y[1] - RAIL / 2) if left else (y[0] + RAIL / 2)
    at = (front[0], stile, inner.z[1] - STOP)
    bolt, guides, staple = make_bolt(at, STOP, parent="sash", length=0.18)
    solids = (*_build_sash(front, y, z, (RAIL, RAIL), bars), *guides)
    motion = slide(0.92 * (inner.width - (y[1] - y[0])), RIGHT if left else LEFT)
    needs = require("bolt", fraction=RELEASED)
    sash = ShapePart("sash", "door", solids, motion, parent="frame", needs=needs)
    pull = HandleDesign(kind=choose_one(rng, PULLS), length=0.15, thickness=0.013)
    grip = _make_pull(front[0], stile, inner.z, pull, name="pull", parent="sash")
    return Assembly((*frame, *staple), (sash, bolt, grip))


def _make_panes(rng: np.random.Generator, inner: Space, *, left: bool, bars: int) -> list[ShapePart]:
    """Two sashes that slide past each other until the rear one's pull meets the front one, each half-way."""
    pull = HandleDesign(kind=choose_one(rng, PULLS), length=0.15, thickness=0.013)
    middle, z, parts = sum(inner.y) / 2, narrow(inner.z, GAP), []
    for name, x, side in (("front", 0, 1.0 if left else -1.0), ("rear", 1, -1.0 if left else 1.0)):
        track, outer = _find_tracks(inner)[x], middle + side * (inner.width / 2 - GAP)
        y = between(middle - side * RAIL / 2, outer)
        free = y[1] - y[0] - 1.5 * RAIL - pull.height / 2
        slid = slide(free / 2 - GAP, (0.0, -side, 0.0))
        pieces = _build_sash(track, y, z, (RAIL, RAIL), bars)
        grip = _make_pull(track[0], outer - side * RAIL / 2, inner.z, pull, name=f"{name}_pull", parent=name)
        parts += [ShapePart(name, "door", pieces, slid, parent="frame"), grip]
    return parts


def _make_pull(
    x: float, stile: float, z: Range, design: HandleDesign, *, name: str, parent: str
) -> ShapePart:
    """An upright pull on the stile of a sash whose face is at ``x``."""
    panel = Panel(x=x, thickness=SASH, y=around(stile, RAIL / 2), z=narrow(z, GAP))
    at = (stile, z[0] + 0.45 * (z[1] - z[0]))
    return make_handle(panel, design, name=name, parent=parent, upright=True, at=at)


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("window"),
    hints=(),
    size=(by_height(1.2),),
    deepest=np.inf,
    diagonal=(0.3, 3.5),
    build="board",
    stands="mounted",
    styles=tuple(STYLES),
    style_words={
        "single hung": "sash",
        "double hung": "sash",
        "side hung": "casement",
        "top hung": "casement",
        "hinged": "casement",
    },
    forms={},
    sizes=((0.3, 3.0), (0.05, 0.5), (0.3, 2.6)),
    bare="width",
    make=PLAIN,
    makes={},
    feet=False,
    trade="joinery",
    synset="window.n.01",
    wikidata="Q35473",
    partnet=CATEGORY,
    body="window_body",
    places=(Place(role="window", low=(0.05, 0.4, 0.6), high=(0.4, 1.9, 1.5), draws=((0.0, 1.0, 1.2),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=29,
    draw=draw,
)
