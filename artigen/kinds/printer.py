"""Printer: an inkjet with a scanner, a laser printer, a multifunction printer with cassettes, a copier.

Cassettes hold A4 paper (ISO 216: 210 mm x 297 mm) lengthwise. Inkjets are 0.40 to 0.46 m wide, 0.31 to 0.38 m
deep and 0.15 to 0.22 m high; laser printers 0.36 to 0.42 m wide and 0.22 to 0.30 m high; copiers on castors
0.56 to 0.64 m wide and 1.0 to 1.15 m high.
"""

from dataclasses import dataclass
from math import radians

import numpy as np

from artigen.kind import EVERY, Kind, Place, by_width, make, plurals
from artigen.shapes.appliances.control_panel import make_button
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Spans, Wish, choose_lengths
from artigen.shapes.fittings.feet import make_castors
from artigen.shapes.fittings.hardware import GAP, Panel, hinge, slide, sweep_gap
from artigen.shapes.fittings.lids import loft, make_lid, shrink
from artigen.shapes.primitives import Primitive, block, cylinder, polytope
from artigen.shapes.ranges import Range, around, margins, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import make_glass, make_plastic

CATEGORY = "Printer"
STYLES = {"inkjet": 3.0, "laser": 2.5, "multifunction": 2.5, "copier": 1.5}
SIZES: dict[str, Spans] = {
    "inkjet": ((0.40, 0.46), (0.31, 0.38), (0.15, 0.22)),
    "laser": ((0.36, 0.42), (0.36, 0.42), (0.22, 0.3)),
    "multifunction": ((0.40, 0.46), (0.38, 0.46), (0.36, 0.5)),
    "copier": ((0.56, 0.64), (0.58, 0.7), (1.0, 1.15)),
}
"""Width, depth and height (m)."""
SHELLS: tuple[Color, ...] = ((0.90, 0.90, 0.89), (0.82, 0.82, 0.80), (0.15, 0.15, 0.16), (0.32, 0.33, 0.35))
WALL, FACE = 0.012, 0.016
"""Thickness (m) of the housing, and of the fronts of cassettes."""
KEY = 0.012
"""Least width (m) that a button takes up in its row."""
PAPER: Range = (-0.105, 0.105)
"""Range of y of a sheet of A4 paper."""


@dataclass(frozen=True, kw_only=True)
class _Frame:
    """The housing: ranges of x and y (m); fronts are at ``x[0]``."""

    x: Range
    y: Range

    @property
    def inner(self) -> Range:
        """Range of y between the sides."""
        return narrow(self.y, WALL)


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a printer that meets the wish."""
    style = choose_style(rng, STYLES, wish.style)
    width, depth, height = choose_lengths(rng, wish, SIZES[style])
    frame = _Frame(x=(0.012 - depth / 2, depth / 2), y=around(0.0, width / 2))
    return Draft(style, _build(rng, frame, height, style).close(), _draw_finishes(rng))


def _draw_finishes(rng: np.random.Generator) -> dict[str, Finish]:
    shell, second = (choose_one(rng, SHELLS) for _ in range(2))
    same = rng.random() < 0.5
    dark: Color = (0.13, 0.13, 0.14)

    return {
        "body": make_plastic(shell, gloss=0.2),
        "front": make_plastic(shell if same else second, gloss=0.2),
        "trim": make_plastic(dark, gloss=0.2),
        "key": make_plastic((0.66, 0.67, 0.68), gloss=0.2),
        "mark": make_plastic((0.28, 0.58, 0.34), gloss=0.4),
        "paper": make_plastic((0.95, 0.95, 0.94), gloss=0.05),
        "inside": make_plastic((0.24, 0.24, 0.25), gloss=0.2),
        "panel": make_glass((0.05, 0.06, 0.08)),
        "glass": make_glass((0.30, 0.36, 0.36)),
        "rubber": Finish(kind="rubber", color=dark, accent=dark, gloss=0.05),
        "steel": make_plastic((0.55, 0.55, 0.56), gloss=0.4),
    }


def _build(rng: np.random.Generator, frame: _Frame, height: float, style: str) -> Assembly:
    """Stacks, from the floor up: feet, cassettes, the printing unit, the output bay, the scanner."""
    copier, scans, flat = style == "copier", style != "laser", style == "inkjet"
    built, low = _make_foot(frame, copier=copier)
    scanner = {"inkjet": 0.055, "laser": 0.0, "multifunction": 0.11, "copier": 0.16}[style]
    lid, top = 0.02 if flat else 0.03, height - scanner
    bay = 0.0 if not scans else (0.06 if flat else choose(rng, 0.09, 0.13))
    pitch = {"inkjet": 0.05, "laser": 0.085, "multifunction": 0.085, "copier": 0.13}[style]
    base = top - (bay or 0.04)
    count = {"inkjet": 1, "laser": 1, "multifunction": int(rng.integers(1, 3))}.get(style, 4)
    count = int(np.clip((base - low - (0.2 if copier else 0.03)) / pitch, 1, count))
    high = low + count * pitch
    built += Assembly(_build_walls(frame, (low, high), frame.x[0] + FACE + GAP))
    for k in range(count):
        built += _make_cassette(frame, (low + k * pitch, low + (k + 1) * pitch), f"cassette_{k}")
    if base - high > 0.02:
        built += _make_engine(rng, frame, (high, base), opens=not flat)
    else:
        base = high
    right = frame.y[0]
    if not scans:
        built += Assembly(_build_top_tray(frame, top))
        across = (right + 0.004, right + 0.056)
        return built + _make_controls(rng, frame, (height - 0.038, height - 0.004), across)
    built += _make_bay(frame, (base, top), deep=0.6 if flat else 1.0)
    bed = height - lid - (0.0 if flat else (0.07 if copier else 0.045)) - GAP
    built += _make_scanner(rng, frame, (top, bed), height, lid)
    across = (right + 0.03, right + 0.03 + choose(rng, 0.14, 0.22))
    return built + _make_controls(rng, frame, narrow((top, bed), 0.003), across)


def _make_foot(frame: _Frame, *, copier: bool) -> tuple[Assembly, float]:
    """Castors or rubber feet, and the floor of the housing; returns the height of its upper side, too."""
    (x0, x1), y = frame.x, frame.y
    if copier:
        built = make_castors(frame.x, y, 0.025, swivel=False)
        level = built.height
    else:
        level = 0.008
        places = [(a, b) for a in (x0 + 0.05, x1 - 0.03) for b in narrow(y, 0.04)]
        built = Assembly([cylinder((*at, 0.0), (*at, level), 0.012, "rubber") for at in places])
    floor = block((x0 + 0.02, x1), y, (level, level + WALL), "body")
    return built + Assembly((floor,)), level + WALL


def _build_walls(frame: _Frame, z: Range, front: float) -> tuple[Primitive, ...]:
    """Sides and back of one storey."""
    back = frame.x[1]
    sides = [block((front, back), side, z, "body") for side in margins(frame.y, WALL)]
    return (*sides, block((back - WALL, back), frame.inner, z, "body"))


def _make_cassette(frame: _Frame, z: Range, name: str) -> Assembly:
    """A cassette below a deck: a paper tray with a grip in its front and a stack of paper."""
    start, end = frame.x[0] + FACE, frame.x[1] - WALL
    deck = z[1] - 0.008
    (right, left), x, y = narrow(frame.y, 0.001), (start, end - 0.006), narrow(frame.inner, 0.004)
    low, rim, wall = z[0] + GAP, min(deck - 0.006, z[0] + 0.06), 0.007
    face, (bottom, top), notch = (frame.x[0], start), narrow(z, 0.002), z[1] - 0.022
    half, floor, rear = 0.16 * (y[1] - y[0]), low + wall, x[1] - wall
    long = min(0.297, x[1] - x[0] - 2 * wall)
    solids = (
        block(face, (right, left), (bottom, notch), "front"),
        block(face, (right, -half), (notch, top), "front"),
        block(face, (half, left), (notch, top), "front"),
        block((frame.x[0] + 0.011, start), around(0.0, half), (notch, top), "trim"),
        block(x, y, (low, floor), "inside"),
        *(block(x, side, (floor, rim), "inside") for side in margins(y, wall)),
        block((rear, x[1]), narrow(y, wall), (floor, rim), "inside"),
        block((rear - long, rear), PAPER, (floor, rim - 0.008), "paper"),
    )
    tray = ShapePart(name, "tray", solids, slide(0.72 * (x[1] - x[0])))
    return Assembly((block((start + GAP, end), frame.inner, (deck, z[1]), "inside"),), (tray,))


def _make_engine(rng: np.random.Generator, frame: _Frame, z: Range, *, opens: bool) -> Assembly:
    """The printing unit: closed, or with a drop front before the toner."""
    (front, back), thick, tall = frame.x, 0.014, z[1] - z[0]
    if not opens or tall < 0.09:
        return Assembly((block(frame.x, frame.y, z, "body", 0.003),))
    start, (right, left), level = front + thick + GAP, frame.inner, z[0] + 0.045
    axis = start + 0.4 * (back - start)
    deck = (start + 0.25 * (back - start), back - WALL)
    pieces = (
        *_build_walls(frame, z, start),
        block((start, back - WALL), frame.inner, (z[1] - WALL, z[1]), "body"),
        block(deck, frame.inner, (z[0], z[0] + 0.02), "inside"),
        cylinder((axis, right, level), (axis, left, level), 0.026, "trim"),
    )
    top = z[1] - sweep_gap(tall, thick)
    panel = Panel(x=front, thickness=thick, y=narrow(frame.y, 0.001), z=(z[0] + 0.002, top))
    lip = block((front - 0.008, front), around(0.0, 0.05), (top - 0.014, top - 0.004), "front")
    swing = hinge(panel, "bottom", radians(choose(rng, 70, 88)))
    return Assembly(pieces, (ShapePart("door", "door", (panel.fill("front", 0.002), lip), swing),))


def _make_bay(frame: _Frame, z: Range, *, deep: float) -> Assembly:
    """The output bay, an open storey between printing unit and scanner, with a pull-out tray."""
    x0, x1 = frame.x
    back = x0 + deep * 0.75 * (x1 - x0)
    sides = [block((x0, back), side, z, "body") for side in margins(frame.y, 0.03)]
    pieces = (*sides, block((back, x1), frame.y, z, "body"))
    (start, end), low = (x0 + 0.004, back - 0.01), z[0] + 0.0035
    floor = low + 0.007
    solids = (
        block((start, end), narrow(frame.y, 0.036), (low, floor), "trim"),
        block((start, start + 0.006), around(0.0, 0.06), (floor, low + 0.02), "trim"),
        block((start + 0.03, end - 0.01), PAPER, (floor, low + 0.011), "paper"),
    )
    return Assembly(pieces, (ShapePart("output_tray", "tray", solids, slide(0.55 * (end - start))),))


def _build_top_tray(frame: _Frame, top: float) -> tuple[Primitive, ...]:
    """The output tray of a laser printer, a hollow in its top."""
    (x0, x1), low = frame.x, top - 0.04
    start, end, inner = x0 + 0.03, x1 - 0.08, narrow(frame.y, 0.06)
    slope = ((start, low), (end, low), (start, low + 0.028), (end, low + 0.004))
    return (
        block((end, x1), frame.y, (low, top), "body"),
        *(block((x0, end), side, (low, top), "body") for side in margins(frame.y, 0.06)),
        block((x0, start), inner, (low, low + 0.028), "body"),
        polytope(np.array([(a, b, c) for b in inner for a, c in slope]), "inside"),
    )


def _make_scanner(rng: np.random.Generator, frame: _Frame, z: Range, height: float, lid: float) -> Assembly:
    """The scanner: a housing with a pane and a lid; height beyond that of a lid becomes a document feeder."""
    x, y, bed = frame.x, frame.y, z[1]
    low, top = bed + GAP, bed + GAP + lid
    housing = block(x, y, (z[0], bed - 0.001), "body", 0.002)
    pane = block(narrow(x, 0.03), narrow(y, 0.05), (bed - 0.006, bed), "glass")
    solids = [
        block(x, y, (low + 0.003, top), "front", 0.003),
        block(narrow(x, 0.025), narrow(y, 0.045), (low, low + 0.006), "paper"),
    ]
    if height - top > 0.01:
        middle = y[0] + choose(rng, 0.45, 0.6) * (y[1] - y[0])
        outline = (x[0] + 0.04, x[1] - 0.03), (middle, y[1] - 0.01)
        near, far, rise, ends = y[0] + 0.03, middle + 0.01, 0.3 * (height - top), narrow(x, 0.06)
        flat = [(near, 0.012), (near, 0.02), (far, rise), (far, rise - 0.006)]
        solids += [
            loft(outline, shrink(outline, 0.012), (top, height), "front"),
            polytope(np.array([(a, b, top + c) for a in ends for b, c in flat]), "trim"),
            block(ends, (near, near + 0.02), (top - 0.002, top + 0.014), "trim"),
        ]
    cover = make_lid(solids, x, y, low, radians(choose(rng, 60, 85)))
    return Assembly((housing, pane), (cover,))


def _make_controls(rng: np.random.Generator, frame: _Frame, z: Range, y: Range) -> Assembly:
    """A display and a row of buttons on the front; the last button is green."""
    x, middle, half = frame.x[0], sum(z) / 2, 0.34 * (z[1] - z[0])
    wanted = int(rng.integers(2, 6))
    split = y[1] - choose(rng, 0.35, 0.55) * (y[1] - y[0])
    display = block(around(x, 0.003), (split, y[1]), around(middle, half), "panel")
    room = split - 0.006 - y[0]
    count = min(wanted, int(room / KEY))
    pitch = room / count
    size = min(0.75 * pitch, 1.6 * half)
    shape = "round" if rng.random() < 0.5 else "square"
    buttons = []
    for k in range(count):
        at, finish = (x, split - 0.006 - (k + 0.5) * pitch, middle), "mark" if k == count - 1 else "key"
        buttons.append(make_button(at, (size, size, 0.0045), name=f"button_{k}", finish=finish, shape=shape))
    return Assembly((display,), buttons)


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("printer", "copier", "photocopier"),
    hints=(),
    size=(by_width(0.45),),
    deepest=np.inf,
    diagonal=(0.3, 2.2),
    build="plastic",
    stands="free",
    styles=tuple(STYLES),
    style_words={"photocopier": "copier", "ink jet": "inkjet", "all in one": "multifunction", "paper": EVERY},
    forms={},
    sizes=((0.25, 1.0), (0.2, 1.0), (0.1, 1.5)),
    bare="width",
    make=make(wall={"plastic": 0.0025}, filled=110.0),
    makes={},
    feet=True,
    trade=None,
    synset="printer.n.03",
    wikidata=None,
    partnet=CATEGORY,
    body="printer_body",
    places=(Place(role="printer", low=(0.25, 0.3, 0.1), high=(0.5, 0.6, 0.5), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=21,
    draw=draw,
)
