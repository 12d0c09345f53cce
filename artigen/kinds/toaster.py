"""Toaster: levers that lower the bread, a browning dial, buttons, and a crumb tray.

Toasters for two slices are 160 to 190 mm wide, 270 to 310 mm deep and 180 to 210 mm high, those for four
about 300 mm wide; slots are 30 to 38 mm wide, levers travel 60 to 70 mm.
"""

import numpy as np

from artigen.kind import EVERY, Kind, Place, Spans, by_width, make, plurals
from artigen.shapes.appliances.cavity import build_feet
from artigen.shapes.appliances.control_panel import design_dial, make_button, make_dial
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose_style
from artigen.shapes.draw import Draft, Wish, choose_size
from artigen.shapes.fittings.hardware import GAP, slide
from artigen.shapes.fittings.outlines import trace_corners
from artigen.shapes.primitives import DOWN, FRONT, Primitive, block, box, prism
from artigen.shapes.ranges import Range, around, margins, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Toaster"
STYLES = {"steel": 0.3, "white": 0.2, "black": 0.2, "retro": 0.3}
FOOT, FLOOR, END, WALL = 0.008, 0.012, 0.03, 0.016
"""Heights (m) of the feet and of the tray's space; thickness (m) of the ends and of the sides."""
SLOT, TRAVEL = 0.034, 0.062
SPRING = 4.0
"""Force (N) that pushes a lever up; twice that when pressed down."""
KNOB = 0.024
"""Protrusion of a lever's knob."""
TWO, FOUR = (0.165, 0.195), (0.29, 0.33)
"""Widths (m) for two and for four slices."""
DEEP_AND_HIGH: tuple[Range, Range] = ((0.28, 0.32), (0.18, 0.21))
SHOULDER = 0.8
"""Radius of the housing's upper edges relative to the thickness of its sides."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a toaster."""
    style = choose_style(rng, STYLES, wish.style)
    four = bool(rng.random() < 0.3) if wish.width is None else wish.width > 0.24
    wide = FOUR if four else TWO
    width, depth, height = choose_size(rng, CATEGORY, wish, (wide, *DEEP_AND_HIGH))
    x, y = (-depth / 2 + KNOB, depth / 2), around(0.0, width / 2)
    bays = [(y[0], 0.0), (0.0, y[1])] if four else [y]
    bottom = FOOT + FLOOR + 0.022
    built = Assembly(
        (
            *build_feet(x, y, FOOT, "rubber", radius=0.01, inset=0.025),
            block(x, y, (FOOT, FOOT + 0.008), "rubber"),
            *_build_skirt(x, y, bottom),
        )
    )
    for index, bay in enumerate(bays):
        rounded = (bay[1] == y[1], bay[0] == y[0])
        built += _build_bay(rng, x, bay, (bottom, height), f"_{index}" if four else "", rounded)
    built += Assembly(parts=(_make_tray(x, y),))
    return Draft(style, built.close(), draw_palette(rng, "appliance", style))


def _build_skirt(x: Range, y: Range, top: float) -> list[Primitive]:
    """Sides and back around the tray, and the floor above it."""
    low = FOOT + 0.008
    pieces = [block(x, side, (low, top), "front") for side in margins(y, WALL)]
    pieces.append(block((x[1] - END, x[1]), narrow(y, WALL), (low, top), "front"))
    return [*pieces, block((x[0], x[1] - END), narrow(y, WALL), (top - 0.008, top), "front")]


def _build_bay(
    rng: np.random.Generator, x: Range, y: Range, z: Range, tag: str, rounded: tuple[bool, bool]
) -> Assembly:
    """Two slots between walls, with the lever, dial and buttons before them; the upper edges of the left and
    right wall may be rounded."""
    low, high = z
    middle, apart = sum(y) / 2, 0.25 * (y[1] - y[0]) - 0.004
    slots = [around(middle + side * apart, SLOT / 2) for side in (-1.0, 1.0)]
    inner = narrow(x, END)
    web = 0.006  # half of the gap for the lever's arm
    cut = SHOULDER * (slots[0][0] - y[0])
    left, right = ((cut, cut) if edge else (0.0, 0.0) for edge in rounded)
    sharp = (0.0, 0.0)
    walls = (
        ((y[0], slots[0][0]), (sharp, sharp, sharp, right)),
        ((slots[1][1], y[1]), (sharp, sharp, left, sharp)),
    )
    pieces = [
        *(prism(trace_corners(a, z, cuts, 4), (x[0], 0, 0), (x[1], 0, 0), "front") for a, cuts in walls),
        box((inner[1], slots[0][0], low), (x[1] - 0.004, slots[1][1], high - 0.004), "front"),
        box((inner[0] + 0.02, slots[0][1], low), (inner[1], slots[1][0], high - 0.004), "body"),
        box((x[0] + 0.004, slots[0][0], low), (inner[0], middle - web, high - 0.004), "front"),
        box((x[0] + 0.004, middle + web, low), (inner[0], slots[1][1], high - 0.004), "front"),
        block((x[0] + 0.004, inner[0]), around(middle, web), (high - 0.03, high - 0.004), "front"),
    ]
    top = high - 0.042
    arm = 0.004
    z_arm, ends = (top - 0.012, top - 0.002), (slots[0][0] + 0.006, slots[1][1] - 0.006)
    grip = (x[0] - KNOB, x[0] - 0.003), around(middle, 0.02), (top - 0.014, top + 0.006)
    lever = [
        block(*grip, "handle", 0.003),
        block((x[0] - 0.004, inner[0] + 0.008), around(middle, arm), z_arm, "steel"),
        block((inner[0] + 0.004, inner[0] + 0.014), ends, z_arm, "steel"),
    ]
    reach = (inner[0] + 0.014, inner[1] - 0.006)
    for a, b in slots:
        lever.append(block(reach, around((a + b) / 2, 0.006), (z_arm[0], top - 0.006), "steel"))
    travel = min(TRAVEL, top - 0.014 - low - 0.012)
    parts = [ShapePart(f"lever{tag}", "knob", lever, slide(travel, DOWN, spring=SPRING))]
    side = y[0] + 0.5 * (slots[0][0] - y[0])
    face, aside = x[0], y[1] - (side - y[0])
    dial = design_dial(rng, (0.0085, 0.0095), endless=0.0)  # within the width of a side
    parts.append(make_dial(dial, (face, side, low + 0.035), name=f"browning{tag}", out=FRONT))
    for k, word in enumerate(("cancel", "defrost", "reheat")[: int(rng.integers(1, 4))]):
        at = (face, aside, low + 0.03 + 0.022 * k)
        size = (0.014, 0.014, 0.005)
        parts.append(make_button(at, size, name=f"{word}{tag}", finish="handle", shape="round"))
    return Assembly(pieces, parts)


def _make_tray(x: Range, y: Range) -> ShapePart:
    """A flat tray with a lip below the slots, which slides out to the front."""
    low, top = FOOT + 0.008 + GAP, FOOT + FLOOR + 0.022 - 0.008 - GAP
    span = (y[0] + WALL + 0.004, y[1] - WALL - 0.004)
    end = x[1] - END - 0.006
    pieces = (
        block((x[0], end), span, (low, low + 0.005), "steel"),
        block((x[0] - 0.002, x[0] + 0.006), span, (low, top), "handle"),
        block((end - 0.005, end), span, (low, low + 0.011), "steel"),
    )
    return ShapePart("crumb_tray", "tray", pieces, slide(0.7 * (end - x[0])))


FORMS: dict[str, Spans] = {
    **dict.fromkeys(("two slice toaster", "2 slice toaster"), (TWO, *DEEP_AND_HIGH)),
    **dict.fromkeys(("four slice toaster", "4 slice toaster"), (FOUR, *DEEP_AND_HIGH)),
}
KIND = Kind(
    name=CATEGORY,
    nouns=plurals("toaster", *FORMS),
    hints=(),
    size=(by_width(0.3),),
    deepest=np.inf,
    diagonal=(0.2, 0.9),
    build="sheet",
    stands="free",
    styles=tuple(STYLES),
    style_words={
        "vintage": "retro",
        "pop up": EVERY,
    },
    forms=FORMS,
    sizes=((0.12, 0.5), (0.2, 0.45), (0.12, 0.3)),
    bare="width",
    make=make(density={"steel_sheet": 210.0}),  # thin sheet
    makes={},
    feet=True,
    trade="appliance",
    synset="toaster.n.02",
    wikidata="Q14890",
    partnet=CATEGORY,
    body="toaster_body",
    places=(Place(role="toaster", low=(0.2, 0.1, 0.12), high=(0.4, 0.4, 0.3), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=24,
    draw=draw,
)
