"""Toilet: a bowl with hinged seat and lid, and a cistern with a flush lever or buttons.

Sizes follow EN 997 and EN 33: 355 to 400 mm wide, 620 to 700 mm deep with the cistern, seats 400 to 430 mm
above the floor. Wall-hung bowls protrude by 490 to 540 mm; their flush plates measure 246 by 164 mm.
"""

from math import radians

import numpy as np

from artigen.kind import Kind, Place, by_height, make, plurals
from artigen.shapes.appliances.cavity import build_tub
from artigen.shapes.appliances.control_panel import PRESS, make_button
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, ShapeError, Spans, Wish, choose_size
from artigen.shapes.fittings.hardware import Space, rotate
from artigen.shapes.fittings.outlines import Outline, build_loft, draw_egg
from artigen.shapes.fittings.taps import make_cross_handle
from artigen.shapes.primitives import FRONT, LEFT, RIGHT, UP, Primitive, block, cylinder
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart, require
from artigen.shapes.surfaces.materials import WOODS, make_ceramic, make_metal, make_plastic, make_wood

CATEGORY = "Toilet"
STYLES = {"close_coupled": 0.4, "skirted": 0.3, "wall_hung": 0.3}
SIZES: dict[str, Spans] = {
    "close_coupled": ((0.36, 0.41), (0.63, 0.7), (0.74, 0.83)),
    "skirted": ((0.36, 0.4), (0.62, 0.68), (0.78, 0.86)),
    "wall_hung": ((0.5, 0.6), (0.73, 0.77), (1.08, 1.18)),
}
"""Width, depth and height; wall-hung bowls include their piece of wall."""
WIDEST = {"close_coupled": 0.41, "skirted": 0.4, "wall_hung": 0.37}
"""Greatest width of a bowl (m)."""
GLAZES = (*((0.95, 0.95, 0.945),) * 7, (0.93, 0.92, 0.88), (0.2, 0.2, 0.21))
TANK, WALL = 0.165, 0.23
"""Depth of a cistern and of a piece of wall."""
SHALLOWEST = 0.62
"""Least depth (m) with a piece of wall: in shorter bowls the hinges meet the seat."""
RIM, SEAT, LID = 0.4, 0.02, 0.018
"""Height of the bowl's rim; thickness of seat and lid."""
BUFFER, SLIT = 0.0035, 0.003
"""Gaps below the seat and below the lid."""
BARREL = 0.0105
"""Radius of the hinge's barrels, those of the lid beside those of the seat."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a toilet."""
    style = choose_style(rng, STYLES, wish.style)
    width, depth, height = choose_size(rng, CATEGORY, wish, SIZES[style])
    hung = style == "wall_hung"
    if hung and depth < SHALLOWEST:
        raise ShapeError(
            f"{CATEGORY}: depth {depth:g} m with a piece of wall, expected at least {SHALLOWEST:g} m; give "
            "more, or another style"
        )
    half = min(width / 2, WIDEST[style] / 2)  # of the bowl; cisterns and walls may be wider
    behind = depth / 2 - (WALL if hung else TANK)  # front of the cistern or wall
    hinge = behind - 0.085
    length = hinge + depth / 2
    outline = draw_egg((hinge - 0.4 * length, 0.0), 0.6 * length, 0.4 * length, half)
    built = Assembly(_build_bowl(style, outline, behind, depth / 2), _draw_seat(rng, outline))
    rear = (behind, depth / 2)
    built += _build_wall(rear, width, height) if hung else _draw_cistern(rng, style, rear, width, height)
    seed = int(rng.integers(2**30))
    glaze = make_ceramic(choose_one(rng, GLAZES), seed)
    plain = make_plastic(glaze.color, gloss=0.4)
    wood = make_wood(tuple(WOODS)[int(rng.integers(4))], seed)
    finishes = {
        "body": glaze,
        "front": wood if style == "close_coupled" and rng.random() < 0.3 else plain,
        "handle": make_metal(choose_one(rng, ("chrome", "chrome", "brass", "black")), seed),
        "wall": make_ceramic((0.86, 0.85, 0.83), seed + 1),
        "panel": make_plastic((0.93, 0.93, 0.93)) if rng.random() < 0.5 else make_metal("steel", seed),
    }
    return Draft(style, built.close(), finishes)


def _build_bowl(style: str, outline: Outline, behind: float, back: float) -> list[Primitive]:
    """A rim around a hollow, which narrows without a step to its support, and the block behind the seat."""
    low, taper = (0.2, 0.05) if style != "skirted" else (0.24, 0.016)
    foot, end, half = outline.shrink(taper), outline.a[1], outline.b[1]
    pieces = [*build_loft(outline, 2, (low, RIM), "body", inset=taper, wall=0.045)]
    if style == "close_coupled":
        neck = 0.11
        return [
            *pieces,
            *build_loft(foot, 2, (neck, low), "body", inset=0.025),
            *build_loft(foot.shrink(0.01), 2, (0.0, neck), "body", inset=-0.015),
            block((end - 0.15, back - 0.04), around(0.0, 0.38 * half), (0.0, RIM - 0.16), "body"),
            block((end - 0.1, back), around(0.0, 0.75 * half), (RIM - 0.16, RIM), "body"),
        ]
    if style == "skirted":
        pieces += build_loft(foot, 2, (0.0, low), "body", inset=0.024)
        return [*pieces, block((end - 0.12, back), around(0.0, 0.8 * half), (0.0, RIM), "body")]
    pieces += build_loft(foot, 2, (low - 0.06, low), "body", inset=0.07)
    return [*pieces, block((end - 0.1, behind), around(0.0, 0.72 * half), (low - 0.06, RIM), "body")]


def _draw_seat(rng: np.random.Generator, outline: Outline) -> tuple[ShapePart, ShapePart]:
    """A lid and a seat ring that turn about one axis behind them; the lid opens first."""
    low, edge = RIM + BUFFER, outline.shrink(0.002)
    high, x = low + SEAT, edge.a[1]
    top, axis = high + SLIT, (x + 0.004, 0.0, low + SEAT / 2)
    ring = [*build_loft(edge, 2, (low, high), "front", wall=0.07)]
    plate = [*build_loft(edge, 2, (top, top + LID), "front", inset=-0.012)]
    for y in (-0.07, 0.07):
        pin = ((axis[0], y - 0.018, axis[2]), (axis[0], y + 0.018, axis[2]))
        ring += [
            cylinder(*pin, BARREL, "handle"),
            block((x - 0.06, axis[0]), around(y, 0.012), narrow((low, high), 0.002), "front"),
        ]
    for y in (-0.11, 0.11):
        pin = ((axis[0], y - 0.014, axis[2]), (axis[0], y + 0.014, axis[2]))
        ear = around(y, 0.014)
        plate += [
            cylinder(*pin, BARREL, "front"),
            block(around(axis[0], BARREL), ear, (axis[2], top), "front"),
            block((x - 0.05, axis[0] + BARREL), ear, (top, top + LID - 0.004), "front"),
        ]
    upper = radians(choose(rng, 89.0, 92.0))
    needs = require("lid", fraction=1.0)
    seat = ShapePart("seat", "shelf", ring, rotate(LEFT, axis, upper - 0.05), needs=needs)
    return ShapePart("lid", "door", plate, rotate(LEFT, axis, upper)), seat


def _draw_cistern(rng: np.random.Generator, style: str, x: Range, width: float, height: float) -> Assembly:
    """A tank with a lid on the block behind the bowl, and a lever on its front or buttons on top."""
    buttons = style == "skirted" or rng.random() < 0.4
    top = height - (0.0012 + PRESS + 0.006 if buttons else 0.0)
    low, cover = RIM if style == "skirted" else RIM + 0.012, top - 0.03
    (front, back), half = x, width / 2
    pieces = [
        *build_tub(
            Space(x=(front + 0.008, back), y=around(0.0, half - 0.008), z=(low, cover)), 0.014, "body"
        ),
        block(x, around(0.0, half), (cover, top), "body", 0.005),
    ]
    if low > RIM:
        pieces.append(cylinder((front + 0.08, 0.0, RIM), (front + 0.08, 0.0, low), 0.055, "body"))
    if not buttons:
        at = (front + 0.008, half - 0.07, cover - 0.05)
        lever = make_cross_handle(
            at, FRONT, RIGHT, name="flush", reach=0.085, height=0.026, arms=1, upper=radians(35)
        )
        return Assembly(pieces, (lever,))
    size = (0.038, 0.038, 0.006)
    flush, small = (
        make_button((sum(x) / 2, y, top), size, name=name, finish="handle", out=UP)
        for name, y in (("flush", 0.021), ("small_flush", -0.021))
    )
    return Assembly(pieces, (flush, small))


def _build_wall(x: Range, width: float, height: float) -> Assembly:
    """A piece of wall with a flush plate of two buttons."""
    level, face = height - 0.16, x[0] - 0.006
    wall = block(x, around(0.0, width / 2), (0.0, height), "wall")
    plate = block((face, x[0]), around(0.0, 0.123), around(level, 0.082), "panel")
    buttons = [
        make_button((face, y, level), (wide, 0.12, 0.006), name=name, finish="panel")
        for name, y, wide in (("flush", 0.038, 0.13), ("small_flush", -0.071, 0.08))
    ]
    return Assembly((wall, plate), buttons)


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("toilet", "lavatory/lavatories", "loo", "wc"),
    hints=(),
    size=(by_height(0.75),),
    deepest=np.inf,
    diagonal=(0.4, 2.0),
    build="weighted",
    stands="free",
    styles=tuple(STYLES),
    style_words={"wall mounted": "wall_hung"},
    forms={},
    sizes=((0.3, 0.8), (0.45, 1.0), (0.5, 1.5)),
    bare="height",
    make=make(wall={"stone": 0.011}),  # vitreous china
    makes={},
    feet=True,
    trade="fittings",
    synset="toilet.n.02",
    wikidata="Q7857",
    partnet=CATEGORY,
    body="toilet_body",
    places=(Place(role="toilet", low=(0.45, 0.3, 0.35), high=(0.8, 0.65, 1.2), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=25,
    draw=draw,
)
