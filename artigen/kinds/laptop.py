"""Laptop: a screen that opens over a keyboard.

Outlines follow the screen (16:10 or 16:9, 13 to 17 inches): 0.30 m x 0.21 m to 0.40 m x 0.27 m, 14 to 26 mm
thick. Keys are 19 mm apart (ISO 9241-410). Blocks of keys are single solids, which limits the number of
hulls.
"""

from dataclasses import dataclass
from math import radians

import numpy as np

from artigen.kind import Kind, Place, by_width, make, plurals
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish
from artigen.shapes.fittings.hardware import GAP
from artigen.shapes.fittings.lids import loft, make_lid, shrink
from artigen.shapes.primitives import LEFT, Primitive, block, cylinder
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import make_glass, make_metal, shade_color

CATEGORY = "Laptop"
STYLES = {"light": 3.0, "business": 2.0, "gaming": 1.5, "colour": 1.5}
PITCH = 0.01905
"""Distance (m) between keys."""
BARREL = 0.0045
"""Radius (m) of the hinge."""


@dataclass(frozen=True, kw_only=True)
class _Look:
    """Thickness of base and lid (m), colours, and opening angle of the lid (degrees)."""

    base: Range
    lid: Range
    bodies: tuple[Color, ...]
    keys: tuple[Color, ...]
    opens: Range


DARK, BLACK, SILVER = (0.20, 0.205, 0.22), (0.10, 0.10, 0.11), (0.74, 0.75, 0.76)
LOOKS = {
    "light": _Look(
        base=(0.009, 0.012), lid=(0.0045, 0.006),
        bodies=(SILVER, SILVER, (0.45, 0.46, 0.48), (0.80, 0.72, 0.66)),
        keys=(BLACK, DARK), opens=(115, 140),
    ),
    "business": _Look(
        base=(0.013, 0.017), lid=(0.006, 0.008), bodies=(BLACK, DARK, (0.30, 0.31, 0.33)),
        keys=(DARK, (0.28, 0.285, 0.30)),
        opens=(135, 178),
    ),
    "gaming": _Look(
        base=(0.018, 0.022), lid=(0.007, 0.009), bodies=(BLACK, DARK),
        keys=((0.62, 0.12, 0.12), (0.16, 0.46, 0.62), (0.30, 0.55, 0.28)), opens=(115, 140),
    ),
    "colour": _Look(
        base=(0.012, 0.016), lid=(0.0055, 0.0075),
        bodies=((0.90, 0.90, 0.90), (0.42, 0.55, 0.68), (0.80, 0.56, 0.54), (0.36, 0.52, 0.46)),
        keys=((0.86, 0.86, 0.86), DARK), opens=(120, 160),
    ),
}  # fmt: skip

ROWS: tuple[tuple[float, ...], ...] = (
    (1.5, 4.0, 4.0, 4.0, 1.5),
    (5.0, 4.0, 4.0, 2.0),
    (1.5, 5.0, 5.0, 3.5),
    (1.8, 5.0, 5.0, 3.2),
    (2.3, 5.0, 5.0, 2.7),
    (4.0, 6.5, 4.5),
)
"""Widths of key blocks in keys, row by row from the rear; 15 keys per row."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a laptop that meets the wish."""
    style = choose_style(rng, STYLES, wish.style)
    look = LOOKS[style]
    width = choose(rng, *((0.35, 0.4) if style == "gaming" else (0.295, 0.37)), wish.width)
    depth = choose(rng, 0.65 * width, 0.72 * width, wish.depth)
    lid = choose(rng, *look.lid)
    base = choose(rng, *look.base, None if wish.height is None else wish.height - lid - GAP - 0.002)
    built = _build(rng, (width, depth, base, lid), look, style)
    return Draft(style, built.close(), _draw_finishes(rng, look, style))


def _draw_finishes(rng: np.random.Generator, look: _Look, style: str) -> dict[str, Finish]:
    body, key = choose_one(rng, look.bodies), choose_one(rng, look.keys)
    kind, gloss = ("steel", 0.4) if style == "light" else ("plastic", 0.25)
    shade = shade_color(body, 0.94)
    well = (0.05, 0.05, 0.055) if max(body) < 0.4 else shade_color(body, 0.62)
    dark = Finish(kind="plastic", color=BLACK, accent=BLACK, gloss=0.2)
    return {
        "body": Finish(kind=kind, color=body, accent=shade, grain=LEFT, period=0.05, gloss=gloss),
        "key": Finish(kind="plastic", color=key, accent=key, gloss=0.15),
        "panel": Finish(kind="glass", color=shade, accent=shade, gloss=0.35),
        "inside": Finish(kind="plastic", color=well, accent=well, gloss=0.1),
        "trim": dark,
        "screen": make_glass((0.055, 0.075, 0.11)),
        "rubber": Finish(kind="rubber", color=(0.13, 0.13, 0.13), accent=(0.16, 0.16, 0.16), gloss=0.05),
        "mark": make_metal("chrome", 1),
        "accent": Finish(kind="plastic", color=(0.75, 0.12, 0.10), accent=(0.75, 0.12, 0.10), gloss=0.2),
    }


def _build(
    rng: np.random.Generator, size: tuple[float, float, float, float], look: _Look, style: str
) -> Assembly:
    """The base, and the lid, which turns about a barrel behind the base."""
    width, depth, thick, lid = size
    foot, end = 0.002, 0.06 * width
    x, y = (-depth / 2, depth / 2 - BARREL), around(0.0, width / 2)
    top, rear = foot + thick, x[1] - BARREL - GAP
    low, deck = top + GAP, ((x[0], rear), y)
    pieces = [loft(shrink(deck, 0.35 * thick), deck, (foot, top), "body")]
    for at in (x[0] + 0.02, rear - 0.03):
        pieces.append(block((at, at + 0.01), narrow(y, 0.05), (0.0, foot + 0.001), "rubber"))
    pieces += _build_keys(x[0], rear, y, top, style)
    if style == "gaming":
        for at in (y[0] + 0.02, y[1] - 0.09):
            pieces.append(
                block((rear - 0.001, rear + 0.0012), (at, at + 0.07), (top - 0.008, top - 0.002), "key")
            )
    inset, front = choose(rng, 0.005, 0.009), x[1] - 0.012
    solids = [
        block(x, y, (low + 0.001, low + lid), "body"),
        block((x[0] + 0.001, front), narrow(y, 0.001), (low, low + 0.003), "trim"),
        block((x[0] + inset, front - 2 * inset), narrow(y, inset), (low - 0.0005, low + 0.002), "screen"),
        cylinder((x[1], y[0] + end, low), (x[1], y[1] - end, low), BARREL, "trim"),
    ]
    if rng.random() < 0.8:
        middle = (sum(x) / 2, 0.0)
        solids.append(cylinder((*middle, low + 0.002), (*middle, low + lid + 0.0004), 0.045 * width, "mark"))
    return Assembly(pieces, (make_lid(solids, x, y, low, radians(choose(rng, *look.opens)), name="screen"),))


def _build_keys(front: float, rear: float, y: Range, top: float, style: str) -> list[Primitive]:
    """Six rows of keys on a dark field, with the touchpad before them."""
    pitch = min(PITCH, 0.92 * (y[1] - y[0]) / 15)
    half, gap, end = 15 * pitch / 2, 0.0022, rear - 0.018
    field = (end - 5.7 * pitch - 0.002, end + 0.002)
    out = [block(field, around(0.0, half + 0.002), (top - 0.002, top + 0.0003), "inside")]
    for number, row in enumerate(ROWS):
        deep, left = 0.7 * pitch if number == 0 else pitch, half
        for keys in row:
            right = left - keys * pitch
            across = (right + gap / 2, left - gap / 2)
            out.append(block((end - deep + gap, end), across, (top - 0.001, top + 0.0012), "key"))
            left = right
        end -= deep
    room, wide = end - 0.004 - front, 0.5 * min(0.13, 0.38 * (y[1] - y[0]))
    pad = (front + 0.14 * room, front + 0.9 * room)
    out.append(block(pad, around(0.0, wide), (top - 0.002, top + 0.0005), "panel"))
    if style == "business":
        at = (end + 3.0 * pitch, 0.6 * pitch)
        out.append(cylinder((*at, top), (*at, top + 0.0018), 0.004, "accent"))
    return out


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "laptop",
        "notebook computer",
        "laptop computer",
        "notebook",
        "ultrabook",
        "chromebook",
    ),
    hints=(),
    size=(by_width(0.34),),
    deepest=np.inf,
    diagonal=(0.2, 0.9),
    build="plastic",
    stands="free",
    styles=tuple(STYLES),
    style_words={"coloured": "colour", "colored": "colour", "color": "colour"},
    forms={},
    sizes=((0.2, 0.6), (0.15, 0.45), (0.01, 0.08)),
    bare=None,  # inches of laptops are those of their screens
    make=make(wall={"plastic": 0.0015}, filled=500.0),  # battery
    makes={},
    feet=False,
    trade=None,
    synset="laptop.n.01",
    wikidata="Q3962",
    partnet=CATEGORY,
    body="laptop_body",
    places=(Place(role="laptop", low=(0.15, 0.25, 0.01), high=(0.35, 0.45, 0.05), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=18,
    draw=draw,
)
