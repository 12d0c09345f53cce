"""Printer: an inkjet with a scanner, a laser printer, a multifunction printer with cassettes, a copier.

Cassettes hold A4 paper (ISO 216: 210 mm x 297 mm) lengthwise. Inkjets are 0.40 to 0.46 m wide, 0.31 to 0.38 m
deep and 0.15 to 0.22 m high; laser printers 0.36 to 0.42 m wide and 0.22 to 0.30 m high; copiers on castors
0.56 to 0.64 m wide and 1.0 to 1.15 m high.
"""

from dataclasses import dataclass
from math import radians

import numpy as np

from artigen.shapes.appliances.control_panel import make_button
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Wish, choose_lengths
from artigen.shapes.fittings.feet import make_castors
from artigen.shapes.fittings.hardware import GAP, Panel, Range, around, hinge, narrow, slide, sweep_gap
from artigen.shapes.fittings.lids import hinge_lid, loft, shrink
from artigen.shapes.primitives import Primitive, block, box, cylinder, polytope
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import make_glass, make_plastic

CATEGORY = "Printer"
STYLES = {"inkjet": 3.0, "laser": 2.5, "multifunction": 2.5, "copier": 1.5}
SIZES: dict[str, tuple[Range, Range, Range]] = {
    "inkjet": ((0.40, 0.46), (0.31, 0.38), (0.15, 0.22)),
    "laser": ((0.36, 0.42), (0.36, 0.42), (0.22, 0.3)),
    "multifunction": ((0.40, 0.46), (0.38, 0.46), (0.36, 0.5)),
    "copier": ((0.56, 0.64), (0.58, 0.7), (1.0, 1.15)),
}
"""Width, depth and height (m)."""
SHELLS: tuple[Color, ...] = ((0.90, 0.90, 0.89), (0.82, 0.82, 0.80), (0.15, 0.15, 0.16), (0.32, 0.33, 0.35))
WALL, FACE = 0.012, 0.016
"""Thickness (m) of the housing, and of the fronts of cassettes."""


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
    built = _build(rng, frame, height, style)
    return Draft(style, built.close(), _draw_finishes(rng))


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
    copier, scans = style == "copier", style != "laser"
    built, low = _make_foot(frame, copier=copier)
    scanner = {"inkjet": 0.055, "laser": 0.0, "multifunction": 0.11, "copier": 0.16}[style]
    lid = 0.02 if style == "inkjet" else 0.03
    top = height - scanner if scans else height
    bay = 0.0 if style == "laser" else (0.06 if style == "inkjet" else choose(rng, 0.09, 0.13))
    pitch = {"inkjet": 0.05, "laser": 0.085, "multifunction": 0.085, "copier": 0.13}[style]
    base = top - (bay or 0.04)
    count = {"inkjet": 1, "laser": 1, "multifunction": int(rng.integers(1, 3))}.get(style, 4)
    count = int(np.clip((base - low - (0.2 if copier else 0.03)) / pitch, 1, count))
    high = low + count * pitch
    front = frame.x[0] + FACE + GAP
    built += Assembly(tuple(_make_walls(frame, (low, high), front)))
    for k in range(count):
        built += _make_cassette(frame, (low + k * pitch, low + (k + 1) * pitch), f"cassette_{k}")
    if base - high > 0.02:
        built += _make_engine(rng, frame, (high, base), opens=style != "inkjet")
    else:
        base = high
    if bay:
        built += _make_bay(frame, (base, top), deep=0.6 if style == "inkjet" else 1.0)
    else:
        built += _make_top_tray(frame, top)
    right = frame.y[0]
    if not scans:
        return built + _make_controls(
            rng, frame, (height - 0.038, height - 0.004), (right + 0.004, right + 0.056)
        )
    crest = 0.0 if style == "inkjet" else (0.07 if copier else 0.045)
    bed = height - lid - crest - GAP
    built += _make_scanner(rng, frame, (top, bed), height, lid)
    across = (right + 0.03, right + 0.03 + choose(rng, 0.14, 0.22))
    return built + _make_controls(rng, frame, (top + 0.003, bed - 0.003), across)


def _make_foot(frame: _Frame, *, copier: bool) -> tuple[Assembly, float]:
    """Castors or rubber feet, and the floor of the housing; returns the height of its upper side, too."""
    if copier:
        castors = make_castors(frame.x, frame.y, 0.025, swivel=False)
        level, pieces, parts = castors.height, [*castors.primitives], castors.parts
    else:
        level, parts = 0.008, ()
        pieces = [
            cylinder((a, b, 0.0), (a, b, level), 0.012, "rubber")
            for a in (frame.x[0] + 0.05, frame.x[1] - 0.03)
            for b in narrow(frame.y, 0.04)
        ]
    pieces.append(block((frame.x[0] + 0.02, frame.x[1]), frame.y, (level, level + WALL), "body"))
    return Assembly(pieces, parts), level + WALL


def _make_walls(frame: _Frame, z: Range, front: float) -> list[Primitive]:
    """Sides and back of one storey."""
    return [
        block((front, frame.x[1]), (frame.y[0], frame.inner[0]), z, "body"),
        block((front, frame.x[1]), (frame.inner[1], frame.y[1]), z, "body"),
        block((frame.x[1] - WALL, frame.x[1]), frame.inner, z, "body"),
    ]


def _make_cassette(frame: _Frame, z: Range, name: str) -> Assembly:
    """A cassette below a deck: a paper tray with a grip in its front and a stack of paper."""
    front, thick = frame.x[0], FACE
    deck = z[1] - 0.008
    pieces: list[Primitive] = []
    pieces.append(block((front + thick + GAP, frame.x[1] - WALL), frame.inner, (deck, z[1]), "inside"))
    y = narrow(frame.inner, 0.004)
    x = (front + thick, frame.x[1] - WALL - 0.006)
    low, rim, wall = z[0] + GAP, min(deck - 0.006, z[0] + 0.06), 0.007
    grip = 0.32 * (y[1] - y[0])
    solids = [
        block((front, front + thick), narrow(frame.y, 0.001), (z[0] + 0.002, z[1] - 0.022), "front"),
        box((front, frame.y[0] + 0.001, z[1] - 0.022), (front + thick, -grip / 2, z[1] - 0.002), "front"),
        box((front, grip / 2, z[1] - 0.022), (front + thick, frame.y[1] - 0.001, z[1] - 0.002), "front"),
        block((front + 0.011, front + thick), around(0.0, grip / 2), (z[1] - 0.022, z[1] - 0.002), "trim"),
        block(x, y, (low, low + wall), "inside"),
        block(x, (y[0], y[0] + wall), (low + wall, rim), "inside"),
        block(x, (y[1] - wall, y[1]), (low + wall, rim), "inside"),
        block((x[1] - wall, x[1]), narrow(y, wall), (low + wall, rim), "inside"),
    ]
    long = min(0.297, x[1] - x[0] - 2 * wall)
    solids.append(
        block((x[1] - wall - long, x[1] - wall), around(0.0, 0.105), (low + wall, rim - 0.008), "paper")
    )
    motion = slide(0.72 * (x[1] - x[0]))
    tray = ShapePart(name, "tray", tuple(solids), motion)
    return Assembly(pieces, (tray,))


def _make_engine(rng: np.random.Generator, frame: _Frame, z: Range, *, opens: bool) -> Assembly:
    """The printing unit: closed, or with a drop front before the toner."""
    front, thick = frame.x[0], 0.014
    if not opens or z[1] - z[0] < 0.09:
        body = block((front, frame.x[1]), frame.y, z, "body", 0.003)
        return Assembly((body,))
    start = front + thick + GAP
    roof = block((start, frame.x[1] - WALL), frame.inner, (z[1] - WALL, z[1]), "body")
    deep = frame.x[1] - start
    toner = [
        block((start + 0.25 * deep, frame.x[1] - WALL), frame.inner, (z[0], z[0] + 0.02), "inside"),
        cylinder(
            (start + 0.4 * deep, frame.inner[0], z[0] + 0.045),
            (start + 0.4 * deep, frame.inner[1], z[0] + 0.045),
            0.026,
            "trim",
        ),
    ]
    panel = Panel(
        x=front, thickness=thick, y=narrow(frame.y, 0.001),
        z=(z[0] + 0.002, z[1] - sweep_gap(z[1] - z[0], thick)),
    )  # fmt: skip
    slab = block((front, panel.back), panel.y, panel.z, "front", 0.002)
    lip = block((front - 0.008, front), around(0.0, 0.05), (panel.z[1] - 0.014, panel.z[1] - 0.004), "front")
    motion = hinge(panel, "bottom", radians(choose(rng, 70, 88)))
    door = ShapePart("door", "door", (slab, lip), motion)
    return Assembly((*_make_walls(frame, z, start), roof, *toner), (door,))


def _make_bay(frame: _Frame, z: Range, *, deep: float) -> Assembly:
    """The output bay, an open storey between printing unit and scanner, with a pull-out tray."""
    back = frame.x[0] + deep * 0.75 * (frame.x[1] - frame.x[0])
    pieces = [
        block((frame.x[0], back), (frame.y[0], frame.y[0] + 0.03), z, "body"),
        block((frame.x[0], back), (frame.y[1] - 0.03, frame.y[1]), z, "body"),
        block((back, frame.x[1]), frame.y, z, "body"),
    ]
    x, y, low = (frame.x[0] + 0.004, back - 0.01), narrow(frame.y, 0.036), z[0] + 0.0035
    stop = 0.02
    solids = (
        block(x, y, (low, low + 0.007), "trim"),
        block((x[0], x[0] + 0.006), around(0.0, 0.06), (low + 0.007, low + stop), "trim"),
        block((x[0] + 0.03, x[1] - 0.01), around(0.0, 0.105), (low + 0.007, low + 0.011), "paper"),
    )
    motion = slide(0.55 * (x[1] - x[0]))
    tray = ShapePart("output_tray", "tray", solids, motion)
    return Assembly(pieces, (tray,))


def _make_top_tray(frame: _Frame, top: float) -> Assembly:
    """The output tray of a laser printer, a hollow in its top."""
    low, side = top - 0.04, 0.06
    x = (frame.x[0] + 0.03, frame.x[1] - 0.08)
    slope = np.array([(x[0], low), (x[1], low), (x[0], low + 0.028), (x[1], low + 0.004)])
    ramp = polytope(np.array([(a, b, c) for b in narrow(frame.y, side) for a, c in slope]), "inside")
    pieces = (
        block((x[1], frame.x[1]), frame.y, (low, top), "body"),
        box((frame.x[0], frame.y[0], low), (x[1], frame.y[0] + side, top), "body"),
        box((frame.x[0], frame.y[1] - side, low), (x[1], frame.y[1], top), "body"),
        block((frame.x[0], x[0]), narrow(frame.y, side), (low, low + 0.028), "body"),
        ramp,
    )
    return Assembly(pieces)


def _make_scanner(rng: np.random.Generator, frame: _Frame, z: Range, height: float, lid: float) -> Assembly:
    """The scanner: a housing with a pane and a lid; height beyond that of a lid becomes a document feeder."""
    x, y, bed = frame.x, frame.y, z[1]
    crest = height - bed - GAP - lid
    housing = block(x, y, (z[0], bed - 0.001), "body", 0.002)
    pane = block(narrow(x, 0.03), narrow(y, 0.05), (bed - 0.006, bed), "glass")
    low = bed + GAP
    slab = block(x, y, (low + 0.003, low + lid), "front", 0.003)
    mat = block(narrow(x, 0.025), narrow(y, 0.045), (low, low + 0.006), "paper")
    solids: list[Primitive] = [slab, mat]
    if crest > 0.01:
        middle = y[0] + choose(rng, 0.45, 0.6) * (y[1] - y[0])
        outline = (x[0] + 0.04, x[1] - 0.03), (middle, y[1] - 0.01)
        solids.append(loft(outline, shrink(outline, 0.012), (low + lid, height), "front"))
        near, far, rise = y[0] + 0.03, middle + 0.01, 0.3 * crest
        flat = [(near, 0.012), (near, 0.02), (far, rise), (far, rise - 0.006)]
        ends = [(a, b, low + lid + c) for a in narrow(x, 0.06) for b, c in flat]
        solids.append(polytope(np.array(ends), "trim"))
        foot = block(
            narrow(x, 0.06), (y[0] + 0.03, y[0] + 0.05), (low + lid - 0.002, low + lid + 0.014), "trim"
        )
        solids.append(foot)
    motion = hinge_lid(x, y, low, radians(choose(rng, 60, 85)))
    cover = ShapePart("lid", "door", tuple(solids), motion)
    return Assembly((housing, pane), (cover,))


def _make_controls(rng: np.random.Generator, frame: _Frame, z: Range, y: Range) -> Assembly:
    """A display and a row of buttons on the front; the last button is green."""
    x, middle, half = frame.x[0], (z[0] + z[1]) / 2, 0.34 * (z[1] - z[0])
    count, wide = int(rng.integers(2, 6)), y[1] - y[0]
    split = y[1] - choose(rng, 0.35, 0.55) * wide
    display = block(around(x, 0.003), (split, y[1]), around(middle, half), "panel")
    pitch = (split - 0.006 - y[0]) / count
    size = min(0.75 * pitch, 1.6 * half)
    round_ = rng.random() < 0.5
    buttons = [
        make_button(
            (x, split - 0.006 - (k + 0.5) * pitch, middle), (size, size, 0.0045), name=f"button_{k}",
            finish="mark" if k == count - 1 else "key", shape="round" if round_ else "square",
        )
        for k in range(count)
    ]  # fmt: skip
    return Assembly((display,), buttons)
