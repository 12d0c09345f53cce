"""Microwave: a door beside, below or above its controls, a cavity with a turntable, keys and dials.

Those that hang over a range have a ventilation grille above the door.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import radians
from typing import Literal

import numpy as np

from artigen.kind import EVERY, Channel, Kind, Place, by_width, make, plurals
from artigen.shapes.appliances.appliance_doors import build_window_leaf, draw_border, draw_grip, mount_grip
from artigen.shapes.appliances.cavity import build_feet, build_shell
from artigen.shapes.appliances.control_panel import (
    build_badge,
    build_display,
    design_dial,
    make_button,
    make_dial,
)
from artigen.shapes.appliances.rings import build_ring
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, pick
from artigen.shapes.draw import Draft, Wish
from artigen.shapes.fittings.hardware import GAP, Panel, Space, hinge, rotate, sweep_gap
from artigen.shapes.primitives import UP, Primitive, block, cylinder
from artigen.shapes.ranges import Range, around, divide_range, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Microwave"
STYLES = ("steel", "black", "white", "retro")
Layout = Literal["above", "below", "hung", "beside"]
LAYOUTS: dict[Layout, float] = {"above": 0.1, "below": 0.08, "hung": 0.1, "beside": 0.72}
"""Where the controls are; those of a hung one are beside its door."""
SUNK = 0.012
"""Depth (m) in the front of what is printed or cut there; thinner hulls would be too oblong for engines."""

LEAST_GRILLE = 0.04
"""Height (m) in which two slots have room."""


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """Layout of the parts (m)."""

    outer: Space
    """Outer box of the housing, behind the door."""
    hollow: Space
    door: Panel
    controls: Panel
    grille: Panel | None
    layout: Layout

    @property
    def drops(self) -> bool:
        """Whether the door drops down below the controls."""
        return self.layout == "above"


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a microwave oven."""
    style = wish.style or str(rng.choice(STYLES, p=(0.58, 0.1, 0.29, 0.03)))
    palette = draw_palette(rng, "appliance", style)
    plan = _draw_plan(rng, wish)
    face = "panel" if rng.random() < 0.15 else "front"
    controls = _draw_controls(rng, plan, face)
    door = _draw_door(rng, plan, face, wish)
    built = Assembly(_build_body(plan, face, controls.pieces), (*door, *controls.parts))
    if rng.random() < 0.72:
        built += Assembly(parts=(_draw_turntable(rng, plan),))
    return Draft(style, built.close(), palette)


def _draw_plan(rng: np.random.Generator, wish: Wish) -> _Plan:
    width = choose(rng, 0.44, 0.62, wish.width)
    depth = choose(rng, 0.62 * width, 0.85 * width, wish.depth)
    height = choose(rng, 0.54 * width, 0.68 * width, wish.height)
    layout = pick(rng, LAYOUTS)
    foot = choose(rng, 0.008, 0.018) if rng.random() < 0.85 else 0.0
    thick, wall = choose(rng, 0.030, 0.042), choose(rng, 0.014, 0.026)
    column, strip = choose(rng, 0.19, 0.30) * width, choose(rng, 0.20, 0.27) * height
    y, z, grille = around(0.0, width / 2), (foot, height), None
    if layout == "hung":
        z = (0.0, height - max(0.6 * strip, LEAST_GRILLE))
    door = Panel(x=-depth / 2, thickness=thick, y=y, z=z)
    controls = replace(door, thickness=thick + GAP)
    right, bottom, top = wall, wall, wall
    if layout == "above":
        door = replace(door, z=(foot, height - strip))
        gap = sweep_gap(door.height, thick)
        controls = replace(controls, z=(height - strip + gap, height))
        top = strip + gap + 0.005
    elif layout == "below":
        door = replace(door, z=(foot + strip, height))
        controls = replace(controls, z=(foot, foot + strip - 0.003))
        bottom += strip
    else:
        door = replace(door, y=(column - width / 2, y[1]))
        controls = replace(controls, y=(y[0], door.y[0] - sweep_gap(door.width, thick)))
        right = column + 0.012
    if layout == "hung":
        grille = replace(controls, y=y, z=(z[1] + 0.003, height))
        top += height - z[1]
    outer = Space(x=(door.back + GAP, depth / 2), y=y, z=(z[0], height))
    hollow = Space(
        x=(outer.x[0], outer.x[1] - 1.6 * wall),
        y=(y[0] + right, y[1] - wall - 0.012),
        z=(z[0] + bottom, height - top),
    )
    return _Plan(outer=outer, hollow=hollow, door=door, controls=controls, grille=grille, layout=layout)


def _build_body(plan: _Plan, face: str, extras: Sequence[Primitive]) -> list[Primitive]:
    outer, foot = plan.outer, plan.outer.z[0]
    pieces = [*build_shell(outer, plan.hollow, "body", "inside"), plan.controls.fill(face), *extras]
    if plan.grille:
        pieces += _build_grille(plan.grille)
    if foot:
        pieces += build_feet(outer.x, outer.y, foot, "rubber", radius=0.014, inset=0.04)
    return pieces


def _build_grille(panel: Panel) -> list[Primitive]:
    """A band with dark slots, two or three of them one above the other."""
    rows = divide_range(narrow(panel.z, 0.008), max(2, round(panel.height / 0.022)), 0.007)
    x = (panel.x - 0.0015, panel.x + SUNK)
    return [panel.fill("body"), *(block(x, narrow(panel.y, 0.02), z, "rubber") for z in rows)]


def _draw_door(rng: np.random.Generator, plan: _Plan, face: str, wish: Wish) -> list[ShapePart]:
    panel = plan.door
    margin = choose(rng, 0.09, 0.22) * panel.height
    rail = choose(rng, 0.045, 0.07)
    free = rail if not plan.drops else margin
    window = (
        (panel.y[0] + free, panel.y[1] - margin),
        (panel.z[0] + margin, panel.z[1] - (margin if not plan.drops else rail)),
    )
    border = draw_border(rng, (0.01, 0.03))
    leaf = build_window_leaf(panel, window, face, "inside", border=border)
    if not plan.drops:
        at = (sum(window[0]) / 2, panel.z[0] + margin / 2)
        leaf += (build_badge(panel.x, at, min(0.06, 3 * margin)),)
    edge = "bottom" if plan.drops else "left"
    upper = radians(90 if plan.drops else rng.uniform(88, 125))
    door = ShapePart("door", "door", leaf, hinge(panel, edge, upper))
    if rng.random() < 0.4:
        return [door]
    span = panel.width if plan.drops else panel.height
    length = choose(rng, 0.6, 0.86) * span
    kinds = wish.choose_handles(("bar", "pull", "arch", "edge"))
    design = draw_grip(rng, kinds, length=length, longest=plan.outer.width)
    inset = max(0.004, (rail - design.thickness) / 2) if design.kind != "edge" else 0.004
    return [door, mount_grip(panel, design, parent="door", edge=edge, inset=inset)]


def _draw_controls(rng: np.random.Generator, plan: _Plan, face: str) -> Assembly:
    """Draws the controls and the fixed parts of the panel between them."""
    if plan.layout in ("above", "below"):
        return _draw_strip(rng, plan)
    panel = plan.controls
    parts: list[ShapePart] = []
    extras: list[Primitive] = []
    low, high = narrow(panel.z, 0.014)
    y, _ = panel.center
    inner: Range = narrow(panel.y, 0.012)
    if rng.random() < 0.7:
        tall = choose(rng, 0.026, 0.042)
        extras.append(build_display(panel.x, inner, (high - tall, high)))
        high -= tall + 0.012
    if rng.random() < 0.45:  # a button that releases the door
        tall = choose(rng, 0.024, 0.036)
        size = (0.8 * (inner[1] - inner[0]), tall, 0.008)
        at = (panel.x, y, low + tall / 2)
        parts.append(make_button(at, size, name="door_button", finish="handle"))
        low += tall + 0.012
    kind = rng.choice(("dials", "keys", "touch", "dial_and_keys"), p=(0.44, 0.24, 0.2, 0.12))
    if kind == "dial_and_keys":
        split = low + 0.42 * (high - low)
        parts += _draw_dials(rng, panel.x, inner, (low, split), 1)
        parts += _draw_keys(rng, panel.x, inner, (split, high), face, rows=int(rng.integers(1, 4)))
    elif kind == "dials":
        parts += _draw_dials(rng, panel.x, inner, (low, high), int(rng.integers(1, 3)))
    elif kind == "keys":
        parts += _draw_keys(rng, panel.x, inner, (low, high), face, rows=int(rng.integers(4, 7)))
    else:
        if not extras:
            extras.append(build_display(panel.x, inner, (high - 0.03, high)))
            high -= 0.04
        extras.append(block((panel.x - 0.0015, panel.x + SUNK), inner, (low, high), "panel"))
    return Assembly(extras, parts)


def _draw_dials(rng: np.random.Generator, x: float, y: Range, z: Range, count: int) -> list[ShapePart]:
    room = min(y[1] - y[0], (z[1] - z[0]) / count - 0.008)
    most = min(0.45 * room, 0.032)
    finish = "accent" if rng.random() < 0.4 else "handle"
    design = design_dial(rng, (0.72 * most, most), endless=0.65, finish=finish)
    middle = (y[0] + y[1]) / 2
    return [
        make_dial(design, (x, middle, (a + b) / 2), name=f"dial_{k}")
        for k, (a, b) in enumerate(divide_range(z, count, 0.0))
    ]


def _draw_keys(
    rng: np.random.Generator, x: float, y: Range, z: Range, face: str, *, rows: int
) -> list[ShapePart]:
    columns = 3 if y[1] - y[0] > 0.065 else 2
    gap = choose(rng, 0.005, 0.007)
    tall = min((z[1] - z[0] - gap * (rows - 1)) / rows, 0.022)
    rows_z = divide_range((z[1] - rows * tall - gap * (rows - 1), z[1]), rows, gap)
    columns_y = divide_range(y, columns, gap)
    wide = columns_y[0][1] - columns_y[0][0]
    finish = (face, face, "plastic", "accent")[int(4 * rng.random())]
    return [
        make_button(
            (x, sum(across) / 2, sum(up) / 2),
            (wide, tall, 0.006),
            name=f"key_{row * columns + column}",
            finish=finish,
        )
        for row, up in enumerate(reversed(rows_z))
        for column, across in enumerate(reversed(columns_y))
    ]


def _draw_strip(rng: np.random.Generator, plan: _Plan) -> Assembly:
    """Draws controls above or below the door: a display in the middle, dials beside it."""
    panel = plan.controls
    y, z = panel.center
    third = panel.width / 3
    display = build_display(panel.x, around(y, third / 2), around(z, 0.016))
    design = design_dial(rng, (0.26 * panel.height, 0.36 * panel.height), endless=0.65)
    parts = [
        make_dial(design, (panel.x, y + side * third, z), name=f"dial_{k}") for k, side in enumerate((1, -1))
    ]
    return Assembly((display,), parts[: int(rng.integers(1, 3))])


def _draw_turntable(rng: np.random.Generator, plan: _Plan) -> ShapePart:
    """Draws a glass plate on a coupling, `GAP` above the floor of the cavity."""
    space = plan.hollow
    radius = min(0.46 * min(space.width, space.depth), choose(rng, 0.12, 0.18))
    x, y, z = sum(space.x) / 2, sum(space.y) / 2, space.z[0]
    thick, level = 0.0075, z + 0.014
    rim = (radius - 0.012, radius), (radius - 0.008, radius + 0.004)
    pieces = (
        cylinder((x, y, z + GAP), (x, y, level), 0.022, "plastic"),
        cylinder((x, y, level), (x, y, level + thick), radius - 0.008, "clear"),
        *build_ring((x, y, level), "z", (0.0, thick + 0.008), rim, "clear"),
    )
    return ShapePart("turntable", "tray", pieces, rotate(UP, (x, y, z)))


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("microwave", "microwave oven"),
    hints=(),
    size=(by_width(0.5),),
    deepest=0.5,
    diagonal=(0.3, 1.1),
    build="sheet",
    stands="free",
    styles=tuple(STYLES),
    style_words={"vintage": "retro", "countertop": EVERY},
    forms={},
    sizes=((0.3, 0.9), (0.25, 0.75), (0.18, 0.65)),
    bare="width",
    make=make(hidden=4.0, wall={"glass": 0.004}),  # transformer
    makes={},
    feet=True,
    trade="appliance",
    synset="microwave.n.02",
    wikidata="Q127956",
    partnet=CATEGORY,
    body="microwave_body",
    places=(Place(role="microwave", low=(0.25, 0.35, 0.2), high=(0.6, 0.7, 0.5), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=0.03,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=Channel(number=6, boards=("top", "side", "back"), round_door=False),
    word=6,
    draw=draw,
)
