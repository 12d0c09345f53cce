"""Door: a room door in its frame, held shut by a latch with levers on both sides.

Leaves follow DIN 18101 (610 to 985 mm wide, 1,985 or 2,110 mm high, 40 mm thick, levers 1,050 mm above the
floor). The leaf opens once the lever has turned a tongue out of its keep in the frame. The leaf with the
lever of a double door opens first; a bolt holds the other one. Service doors have no latch, but a
pull on the front, a push plate behind, kick plates on both faces and a window.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import radians

import numpy as np

from artigen.kind import Kind, Place, by_height, make, plurals
from artigen.shapes.appliances.cavity import build_frame
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish, choose_size
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import Panel, Space, rotate
from artigen.shapes.fittings.hinges import Leaf, fit_hinges, hang_leaves
from artigen.shapes.fittings.latches import (
    TURN,
    Hanging,
    Latch,
    build_jambs,
    build_lock_stile,
    build_tongue,
    hang_parts,
)
from artigen.shapes.fittings.levers import LeverDesign, build_lever, design_lever
from artigen.shapes.primitives import Primitive, block
from artigen.shapes.ranges import Range, around, margins, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Door"
STYLES = {"panelled": 0.32, "flush": 0.23, "glazed": 0.23, "double": 0.12, "service": 0.1}
PALETTES = ("white", "white", "white", "oak", "oak", "walnut", "grey", "cream", "anthracite", "sage")
WIDTHS, PAIRS, HEIGHTS = (0.61, 0.735, 0.86, 0.985), (1.26, 1.51, 1.76), (1.985, 1.985, 2.11)
THICK = 0.04
LINING, TRIM, TRIM_THICK, STOP = 0.025, 0.062, 0.012, 0.013
"""Thickness (m) of the frame: linings beside the leaf, casings around them, and stops."""
BORDER = TRIM + 0.006
"""Distance (m) from the edge of the casing to the leaf; casings are set back from the edge of the lining."""
STILE = 0.112
"""Width of stiles (m), twice the backset of the lock."""
LEVER = 1.05
BARREL, STRAPS = 0.1, (0.03, 0.0085)
"""Length of a hinge, and extent of its straps on leaf and frame (m)."""
PLATE = 0.0015
"""Thickness (m) of kick plates and push plates before the leaf's face."""
GRIDS = {
    "panelled": ((1, 2), (2, 2), (2, 3), (1, 1), (1, 3)),
    "glazed": ((1, 1), (1, 1), (1, 3), (2, 4), (1, 4)),
}
"""Numbers of columns and rows of fields."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a door."""
    style = choose_style(rng, STYLES, wish.style)
    count = 2 if style == "double" or (style == "service" and rng.random() < 0.4) else 1
    wide = float(rng.choice(PAIRS if count == 2 else WIDTHS)) + 2 * BORDER
    tall = float(rng.choice(HEIGHTS)) + BORDER
    lever = design_lever(rng)
    width, depth, height = choose_size(
        rng, CATEGORY, wish, ((wide, wide + 0.02), (0.2, 0.36), (tall, tall + 0.02))
    )
    pull = HandleDesign(kind="pull", length=0.3, thickness=0.022, finish="steel")
    reach = pull.reach if style == "service" else lever.reach
    x = (reach - depth / 2, depth / 2 - TRIM_THICK)
    inner = Space(x=x, y=(BORDER - width / 2, width / 2 - BORDER), z=(0.0, height - BORDER))
    leaves = hang_leaves(inner, THICK, count=count, hand=1 if rng.random() < 0.5 else -1, sill=0.007)
    finishes = draw_palette(rng, "furniture", choose_one(rng, PALETTES))
    if style == "service":
        built = Assembly(_build_frame(inner, None)) + _hang_service_leaves(rng, leaves, pull)
        return Draft(style, built.close("frame"), finishes)
    look = style if count == 1 else choose_one(rng, ("panelled", "glazed"))
    grids = GRIDS.get(look, ((1, 1),))
    columns, rows = choose_one(rng, grids)
    first = leaves[0]
    latch = Latch(x=first.x, edge=first.edge, side=first.side, level=min(LEVER, 0.55 * height))
    frame = _build_frame(inner, latch if count == 1 else None)
    hanging = Hanging(
        levels=_choose_levels(first),
        barrel=BARREL,
        straps=STRAPS,
        swing=(88.0, 105.0),
        key="lever",
        bolt=(STILE / 2, inner.z[1] + BORDER - TRIM),
        over=TRIM_THICK,
        length=0.16,
        astragal=(0.022, 0.018),
    )
    grid = (columns if count == 1 else 1, rows)
    built = Assembly(frame)
    built += hang_parts(rng, leaves, hanging, lambda leaf: _build_leaf(leaf, latch, look, grid))
    built += Assembly(parts=(_make_lever(latch, lever),))
    return Draft(style, built.close("frame"), finishes)


def _choose_levels(leaf: Leaf) -> tuple[float, ...]:
    """Heights of the two or three hinges of a leaf."""
    bottom, top = leaf.z
    return (bottom + 0.22, top - 0.2, *((top - 0.55,) if top > 2.03 else ()))


def _hang_service_leaves(rng: np.random.Generator, leaves: Sequence[Leaf], pull: HandleDesign) -> Assembly:
    """Leaves with their hinges and pulls."""
    frame: list[Primitive] = []
    parts: list[ShapePart] = []
    upper, tall, wide = radians(choose(rng, 88.0, 105.0)), choose(rng, 0.3, 0.7), choose(rng, 0.07, 0.13)
    for index, leaf in enumerate(leaves):
        name = ("leaf", "leaf_1")[index]
        on_leaf, on_frame = fit_hinges(leaf, _choose_levels(leaf), length=BARREL, straps=STRAPS)
        frame += on_frame
        solids = [*_build_service_leaf(leaf, wide, (1.75 - tall, 1.75)), *on_leaf]
        parts.append(ShapePart(name, "door", solids, leaf.swing(upper), parent="frame"))
        panel = Panel(x=leaf.x[0], thickness=THICK, y=leaf.y, z=leaf.z)
        at = (leaf.edge - leaf.side * STILE / 2, min(LEVER, 0.55 * leaf.z[1]))
        parts.append(make_handle(panel, pull, name=f"pull_{index}", parent=name, upright=True, at=at))
    return Assembly(frame, parts)


def _build_service_leaf(leaf: Leaf, wide: float, sight: Range) -> list[Primitive]:
    """A leaf with a window in the middle, a push plate on its rear and kick plates on both faces."""
    (x0, x1), middle = leaf.x, sum(leaf.y) / 2
    top = leaf.z[1] - 0.15
    hole = around(middle, wide), (min(sight[0], top - 0.2), min(sight[1], top))
    plates = narrow(leaf.y, 0.03), (leaf.z[0] + 0.02, 0.3)
    push = around(leaf.edge - leaf.side * STILE / 2, 0.04), around(min(LEVER, 0.55 * leaf.z[1]), 0.15)
    return [
        *build_frame(leaf.x, (leaf.y, leaf.z), hole, "front"),
        block(around((x0 + x1) / 2, 0.004), *hole, "glass"),
        block((x0 - PLATE, x0 + PLATE), *plates, "steel"),
        *(block((x1 - PLATE, x1 + PLATE), *place, "steel") for place in (plates, push)),
    ]


def _build_frame(inner: Space, latch: Latch | None) -> list[Primitive]:
    """Linings with casings on both faces, stops behind the leaf, and the keep of a single leaf."""
    x, top, finish = inner.x, inner.z[1], "body"
    stop = x[0] + THICK + 0.003
    pieces = [
        block(x, narrow(inner.y, -LINING), (top, top + LINING), finish),
        block((stop, x[1]), inner.y, (top - STOP, top), finish),
    ]
    pieces += build_jambs(inner, LINING, latch)
    pieces += [block((stop, x[1]), y, (0.0, top - STOP), finish) for y in margins(inner.y, STOP)]
    outer, edge = narrow(inner.y, -BORDER), top + BORDER
    for face in ((x[0] - TRIM_THICK, x[0]), (x[1], x[1] + TRIM_THICK)):
        pieces += [block(face, y, (0.0, edge), finish) for y in margins(outer, TRIM)]
        pieces.append(block(face, narrow(outer, TRIM), (edge - TRIM, edge), finish))
    return pieces


def _build_leaf(leaf: Leaf, latch: Latch, look: str, grid: tuple[int, int]) -> list[Primitive]:
    """Stiles and rails around fields of board or glass; the lock stile holds the latch or its keep."""
    (x0, x1), (z0, z1), finish = leaf.x, leaf.z, "front"
    hung, field, lock = leaf.stiles(STILE)
    pieces = list(build_lock_stile(leaf, latch, lock))
    if look == "flush":
        plain = min(hung[0], field[0]), max(hung[1], field[1])
        return [*pieces, block((x0, x1), plain, (z0, z1), finish)]
    pieces.append(block((x0, x1), hung, (z0, z1), finish))
    columns, rows = grid
    bottom, top = z0 + 0.2, z1 - STILE
    levels = np.linspace(bottom, top, rows + 1)
    if look == "panelled" and rows == 2:
        levels[1] = latch.level
    slim = 0.032 if look == "glazed" else 0.09
    between = [around(float(z), slim / 2) for z in levels[1:-1]]
    edges = np.linspace(field[0], field[1], columns + 1)
    posts = [around(float(y), slim / 2) for y in edges[1:-1]]
    rails = [(z0, bottom), *between, (top, z1)]
    pieces += [block((x0, x1), field, (low, high), finish) for low, high in rails]
    if look == "glazed":  # one pane with bars on both faces
        middle = (x0 + x1) / 2
        pieces += [block((x0 + 0.006, x1 - 0.006), y, (bottom, top), finish) for y in posts]
        pane = block(around(middle, 0.004), field, (bottom, top), "glass")
        return [*pieces, pane]
    spans = [(low[1], high[0]) for low, high in pairwise([(0.0, field[0]), *posts, (field[1], 0.0)])]
    for low, high in pairwise(rails):
        pieces += [block((x0, x1), y, (low[1], high[0]), finish) for y in posts]
        pieces += [_build_field(leaf.x, y, (low[1], high[0]), finish) for y in spans]
    return pieces


def _build_field(x: Range, y: Range, z: Range, finish: str) -> Primitive:
    """A raised panel, whose bevelled edges enter the frame."""
    back, slope = 0.004, 0.014
    return block(narrow(x, back), narrow(y, -slope / 2), narrow(z, -slope / 2), finish, slope)


def _make_lever(latch: Latch, design: LeverDesign) -> ShapePart:
    """Levers on both faces, joined by the spindle that turns the tongue."""
    (y, z), along = latch.axis, (-float(latch.side), 0.0)
    pieces = (
        *build_lever(design, (latch.x[0], y, z), out=-1.0, along=along),
        *build_lever(design, (latch.x[1], y, z), out=1.0, along=along),
        *build_tongue(latch),
    )
    motion = rotate((latch.side, 0.0, 0.0), (latch.x[0], y, z), TURN)
    return ShapePart("lever", "knob", pieces, motion, parent="leaf")


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("door", "doorway", "front door", "interior door", "french door", "room door"),
    hints=(),
    size=(by_height(2.05),),
    deepest=0.5,
    diagonal=(1.0, 3.5),
    build="board",
    stands="mounted",
    styles=tuple(STYLES),
    style_words={"glass": "glazed", "french": "double", "double leaf": "double"},
    forms={},
    sizes=((0.55, 2.6), (0.05, 0.6), (1.6, 3.0)),
    bare="height",
    make=make(density={"wood_board": 480.0}),  # tubular board
    makes={
        "flush": make(density={"wood_board": 400.0}),
        "service": make(density={"wood_board": 300.0}),  # light boards on a honeycomb
    },
    feet=False,
    trade="joinery",
    synset="door.n.01",
    wikidata="Q36794",
    partnet=CATEGORY,
    body="door_body",
    places=(Place(role="door", low=(0.1, 0.6, 1.9), high=(0.45, 1.95, 2.3), draws=((0.2, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=13,
    draw=draw,
)
