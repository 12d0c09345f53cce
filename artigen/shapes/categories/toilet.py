"""Toilet: a bowl with hinged seat and lid, and a cistern with a flush lever or buttons.

Sizes follow EN 997 and EN 33: 355 to 400 mm wide, 620 to 700 mm deep with the cistern, seats 400 to 430 mm
above the floor. Wall-hung bowls protrude by 490 to 540 mm; their flush plates measure 246 by 164 mm.
"""

from math import radians

import numpy as np

from artigen.shapes.appliances.cavity import build_tub
from artigen.shapes.appliances.control_panel import PRESS, make_button
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish, choose_size
from artigen.shapes.fittings.hardware import Range, Space, around, rotate
from artigen.shapes.fittings.outlines import Outline, build_loft, draw_egg
from artigen.shapes.fittings.taps import make_cross_handle
from artigen.shapes.primitives import FRONT, LEFT, RIGHT, UP, Primitive, block, box, cylinder
from artigen.shapes.shape import ShapePart, make_base, require
from artigen.shapes.surfaces.materials import WOODS, make_ceramic, make_metal, make_plastic, make_wood

CATEGORY = "Toilet"
STYLES = {"close_coupled": 0.4, "skirted": 0.3, "wall_hung": 0.3}
SIZES: dict[str, tuple[Range, Range, Range]] = {
    "close_coupled": ((0.36, 0.41), (0.63, 0.7), (0.74, 0.83)),
    "skirted": ((0.36, 0.4), (0.62, 0.68), (0.78, 0.86)),
    "wall_hung": ((0.5, 0.6), (0.7, 0.76), (1.08, 1.18)),
}
"""Width, depth and height; wall-hung bowls include their piece of wall."""
GLAZES = ((0.95, 0.95, 0.945), (0.95, 0.95, 0.945), (0.93, 0.92, 0.88), (0.2, 0.2, 0.21))
TANK, WALL = 0.165, 0.19
"""Depth of a cistern and of a piece of wall."""
RIM, SEAT, LID = 0.4, 0.017, 0.016
"""Height of the bowl's rim; thickness of seat and lid."""
SLIT = 0.0025
Drawn = tuple[list[Primitive], list[ShapePart]]
"""Solids of the body, and the moving parts."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a toilet."""
    style = choose_style(rng, STYLES, wish.style)
    wide, deep, tall = SIZES[style]
    width, depth, height = choose_size(rng, CATEGORY, wish, (wide, deep, tall))
    hung = style == "wall_hung"
    half = min(width / 2, 0.185) if hung else width / 2
    behind = depth / 2 - (WALL if hung else TANK)  # front of the cistern or wall
    hinge = behind - 0.085
    length = hinge + depth / 2
    outline = draw_egg((hinge - 0.4 * length, 0.0), 0.6 * length, 0.4 * length, half)
    pieces = _build_bowl(style, outline, behind, depth / 2)
    seat, lid = _make_seat(outline, hinge, upper=radians(choose(rng, 89.0, 92.0)))
    if hung:
        wall, flush = _draw_wall(behind, depth / 2, width, height)
    else:
        wall, flush = _draw_cistern(rng, style, behind, depth / 2, width, height)
    body = make_base((*pieces, *wall))
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
    return Draft(style, (body, lid, seat, *flush), finishes)


def _build_bowl(style: str, outline: Outline, behind: float, back: float) -> list[Primitive]:
    """A rim around a hollow, its bottom, its support, and the block behind the seat."""
    low, taper = (0.2, 0.055) if style != "skirted" else (0.24, 0.0)
    foot, under = outline.shrink(taper), low - 0.03
    middle, end, half = sum(outline.a) / 2, outline.a[1], outline.b[1]
    pieces = [
        *build_loft(outline, 2, (low, RIM), "body", inset=taper, wall=0.045),
        *build_loft(foot, 2, (under, low), "body"),
    ]
    if style == "close_coupled":
        base = draw_egg((middle + 0.06, 0.0), 0.17, behind - middle, 0.62 * half)
        return [
            *pieces,
            *build_loft(base, 2, (0.0, under), "body", inset=-0.02),
            block((end - 0.1, back), around(0.0, 0.75 * half), (RIM - 0.16, RIM), "body"),
        ]
    if style == "skirted":
        pieces += build_loft(foot, 2, (0.0, under), "body", inset=0.03)
        return [*pieces, block((end - 0.12, back), around(0.0, 0.8 * half), (0.0, RIM), "body")]
    pieces += build_loft(foot, 2, (low - 0.1, under), "body", inset=0.07)
    return [*pieces, block((end - 0.1, behind), around(0.0, 0.72 * half), (low - 0.06, RIM), "body")]


def _make_seat(outline: Outline, hinge: float, upper: float) -> tuple[ShapePart, ShapePart]:
    """A seat ring and a lid that turn about one axis behind them; the lid opens first."""
    low = RIM + SLIT
    edge = outline.shrink(0.002)
    ring = build_loft(edge, 2, (low, low + SEAT), "front", wall=0.07)
    top = low + SEAT + SLIT
    plate = build_loft(edge, 2, (top, top + LID), "front", inset=-0.012)
    axis, x = low + SEAT / 2, edge.a[1]
    pins, ears = [], []
    for y in (-0.07, 0.07):
        pins.append(cylinder((x + 0.004, y - 0.018, axis), (x + 0.004, y + 0.018, axis), 0.0075, "handle"))
        pins.append(
            block((x - 0.06, x + 0.004), around(y, 0.012), (low + 0.002, low + SEAT - 0.002), "front")
        )
    for low_y, high_y in ((-0.121, -0.099), (0.099, 0.121)):
        ears.append(box((x - 0.05, low_y, top), (x + 0.0115, high_y, top + LID - 0.004), "front"))
        ears.append(box((x - 0.0035, low_y, axis - 0.0075), (x + 0.0115, high_y, top), "front"))
    motion = rotate(LEFT, (x + 0.004, 0.0, axis), upper - 0.05)
    swing = rotate(LEFT, (x + 0.004, 0.0, axis), upper)
    seat = ShapePart("seat", "shelf", (*ring, *pins), motion, needs=require("lid", fraction=1.0))
    lid = ShapePart("lid", "door", (*plate, *ears), swing)
    return seat, lid


def _draw_cistern(
    rng: np.random.Generator, style: str, front: float, back: float, width: float, height: float
) -> Drawn:
    """Draws a tank with a lid on the block behind the bowl, and a lever on its front or buttons on top."""
    buttons = style == "skirted" or rng.random() < 0.4
    lid = 0.03
    top = height - (0.0012 + PRESS + 0.006 if buttons else 0.0)
    low = RIM if style == "skirted" else RIM + 0.012
    half = width / 2
    tank = Space(x=(front + 0.008, back), y=(-half + 0.008, half - 0.008), z=(low, top - lid))
    pieces = [*build_tub(tank, 0.014, "body")]
    pieces.append(block((front, back), around(0.0, half), (top - lid, top), "body", 0.005))
    if low > RIM:
        pieces.append(cylinder((front + 0.08, 0.0, RIM), (front + 0.08, 0.0, low), 0.055, "body"))
    middle = (front + back) / 2
    if buttons:
        apart = 0.021
        parts = [
            make_button(
                (middle, y, top), (0.038, 0.038, 0.006), name=name, parent="body", finish="handle", out=UP
            )
            for name, y in (("flush", apart), ("small_flush", -apart))
        ]
        return pieces, parts
    at = (front + 0.008, half - 0.07, top - lid - 0.05)
    lever = make_cross_handle(
        at,
        FRONT,
        RIGHT,
        name="flush",
        parent="body",
        reach=0.085,
        height=0.026,
        finish="handle",
        arms=1,
        upper=radians(35.0),
    )
    return pieces, [lever]


def _draw_wall(front: float, back: float, width: float, height: float) -> Drawn:
    """Draws a piece of wall with a flush plate of two buttons."""
    level = height - 0.16
    wall = block((front, back), around(0.0, width / 2), (0.0, height), "wall")
    plate = block((front - 0.006, front), around(0.0, 0.123), around(level, 0.082), "panel")
    parts = [
        make_button((front - 0.006, y, level), (wide, 0.12, 0.006), name=name, parent="body", finish="panel")
        for name, y, wide in (("flush", 0.038, 0.13), ("small_flush", -0.071, 0.08))
    ]
    return [wall, plate], parts
