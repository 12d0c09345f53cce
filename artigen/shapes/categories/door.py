"""Door: a room door in its frame, held shut by a latch with levers on both sides.

Leaves follow DIN 18101 (610 to 985 mm wide, 1,985 or 2,110 mm high, 40 mm thick, levers 1,050 mm above the
floor). The leaf opens once the lever has turned a tongue out of its keep in the frame. The leaf with the
lever of a double door opens first; a bolt holds the other one.
"""

from itertools import pairwise

import numpy as np

from artigen.shapes.choices import choose_one, choose_style
from artigen.shapes.draw import Draft, Wish, choose_size
from artigen.shapes.fittings.hardware import Range, Space, around, narrow, rotate
from artigen.shapes.fittings.hinges import Leaf, hang_leaves
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
from artigen.shapes.shape import ShapePart, make_base
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Door"
STYLES = {"panelled": 0.35, "flush": 0.25, "glazed": 0.25, "double": 0.15}
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
GRIDS = {
    "panelled": ((1, 2), (2, 2), (2, 3), (1, 1), (1, 3)),
    "glazed": ((1, 1), (1, 1), (1, 3), (2, 4), (1, 4)),
}
"""Numbers of columns and rows of fields."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a door."""
    style = choose_style(rng, STYLES, wish.style)
    count = 2 if style == "double" else 1
    wide = float(rng.choice(PAIRS if count == 2 else WIDTHS)) + 2 * BORDER
    tall = float(rng.choice(HEIGHTS)) + BORDER
    lever = design_lever(rng)
    width, depth, height = choose_size(
        rng, CATEGORY, wish, ((wide, wide + 0.02), (0.2, 0.36), (tall, tall + 0.02))
    )
    x = (lever.reach - depth / 2, depth / 2 - TRIM_THICK)
    inner = Space(x=x, y=(BORDER - width / 2, width / 2 - BORDER), z=(0.0, height - BORDER))
    look = style if count == 1 else choose_one(rng, ("panelled", "glazed"))
    grids = GRIDS.get(look, ((1, 1),))
    columns, rows = choose_one(rng, grids)
    leaves = hang_leaves(inner, THICK, count=count, hand=1 if rng.random() < 0.5 else -1, sill=0.007)
    first = leaves[0]
    latch = Latch(x=first.x, edge=first.edge, side=first.side, level=min(LEVER, 0.55 * height))
    frame = _build_frame(inner, latch if count == 1 else None)
    bottom, top = first.z
    hanging = Hanging(
        levels=(bottom + 0.22, top - 0.2, *((top - 0.55,) if height > 2.1 else ())),
        barrel=0.1,
        straps=(0.03, 0.0085),
        swing=(88.0, 105.0),
        key="lever",
        bolt=(STILE / 2, inner.z[1] + BORDER - TRIM),
        over=TRIM_THICK,
        length=0.16,
        astragal=(0.022, 0.018),
    )
    grid = (columns if count == 1 else 1, rows)
    hinges, parts = hang_parts(rng, leaves, hanging, lambda leaf: _build_leaf(leaf, latch, look, grid))
    frame += hinges
    base = make_base(frame, "frame")
    finishes = draw_palette(rng, "furniture", choose_one(rng, PALETTES))
    return Draft(style, (base, *parts, _make_lever(latch, lever)), finishes)


def _build_frame(inner: Space, latch: Latch | None) -> list[Primitive]:
    """Linings with casings on both faces, stops behind the leaf, and the keep of a single leaf."""
    x, top, finish = inner.x, inner.z[1], "body"
    stop = x[0] + THICK + 0.003
    pieces = [
        block(x, narrow(inner.y, -LINING), (top, top + LINING), finish),
        block((stop, x[1]), inner.y, (top - STOP, top), finish),
    ]
    stops = ((inner.y[0], inner.y[0] + STOP), (inner.y[1] - STOP, inner.y[1]))
    pieces += [*build_jambs(inner, LINING, latch, finish)]
    pieces += [block((stop, x[1]), y, (0.0, top - STOP), finish) for y in stops]
    outer, edge = narrow(inner.y, -BORDER), top + BORDER
    for face in ((x[0] - TRIM_THICK, x[0]), (x[1], x[1] + TRIM_THICK)):
        for y in ((outer[0], outer[0] + TRIM), (outer[1] - TRIM, outer[1])):
            pieces.append(block(face, y, (0.0, edge), finish))
        low, high = narrow(outer, TRIM)
        pieces.append(block(face, (low, high), (edge - TRIM, edge), finish))
    return pieces


def _build_leaf(leaf: Leaf, latch: Latch, look: str, grid: tuple[int, int]) -> list[Primitive]:
    """Stiles and rails around fields of board or glass; the lock stile holds the latch or its keep."""
    (x0, x1), (z0, z1), finish = leaf.x, leaf.z, "front"
    hung, field, lock = leaf.stiles(STILE)
    pieces = list(build_lock_stile(leaf, latch, lock, finish))
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
        *build_tongue(latch, "steel"),
    )
    motion = rotate((latch.side, 0.0, 0.0), (latch.x[0], y, z), TURN)
    return ShapePart("lever", "knob", pieces, motion, parent="leaf")
