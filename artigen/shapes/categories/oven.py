"""Ovens: ranges with a hob, wall ovens and hobs alone, as bands of controls, ovens and drawers."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from artigen.shapes.appliance_doors import build_window_leaf, draw_grip, mount_grip
from artigen.shapes.cavity import SIDES, build_feet, build_tub, share_range
from artigen.shapes.control_panel import (
    FRONT,
    DialDesign,
    build_display,
    design_dial,
    make_button,
    make_dial,
    spread_controls,
)
from artigen.shapes.cooktop import COOKTOP_KINDS, CooktopKind, build_burners
from artigen.shapes.draw import Draft, Wish, choose
from artigen.shapes.handles import HandleDesign
from artigen.shapes.hardware import GAP, Panel, Range, Space, hinge, slide, sweep_gap
from artigen.shapes.oven_cavity import build_rails, choose_levels, make_racks
from artigen.shapes.palette import draw_palette
from artigen.shapes.primitives import Primitive, Vector, box, line, rounded_box
from artigen.shapes.shape import ShapePart

CATEGORY = "Oven"
STYLES = ("steel", "black", "white", "retro")
Kind = Literal["range", "double_range", "pro", "wall", "double_wall", "hob", "rangetop"]
KINDS: dict[Kind, float] = {
    "range": 0.46,
    "double_range": 0.11,
    "pro": 0.13,
    "wall": 0.12,
    "double_wall": 0.07,
    "hob": 0.06,
    "rangetop": 0.05,
}
SIZES: dict[Kind, tuple[Range, Range, Range]] = {
    "range": ((0.50, 0.80), (0.58, 0.70), (0.85, 0.96)),
    "double_range": ((0.60, 0.80), (0.60, 0.72), (0.88, 1.00)),
    "pro": ((0.90, 1.25), (0.60, 0.76), (0.86, 0.96)),
    "wall": ((0.55, 0.78), (0.52, 0.62), (0.42, 0.74)),
    "double_wall": ((0.55, 0.78), (0.52, 0.64), (1.10, 1.40)),
    "hob": ((0.56, 0.92), (0.48, 0.55), (0.06, 0.13)),
    "rangetop": ((0.75, 1.22), (0.58, 0.70), (0.18, 0.26)),
}
"""Width, depth without handles, height without an upstand."""
SKIN = 0.024
"""Sides and back of the housing (m)."""
MAX_PIECES = 32 - 4
"""Pieces of the body: engines take 32 on one link, and four are feet."""


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """Sizes and choices that all parts share; metres."""

    kind: Kind
    width: float
    depth: float
    height: float
    thickness: float
    """Of the doors."""
    wall: float
    foot: float
    face: str
    """Finish of doors and controls."""
    cooktop: CooktopKind
    burners: int
    upstand: float
    rear_controls: bool
    dial: DialDesign
    grip: HandleDesign | None
    longest: float

    @property
    def x(self) -> float:
        """Front face of doors and controls."""
        return -self.depth / 2

    @property
    def front(self) -> float:
        """Front face of the housing."""
        return self.x + self.thickness + GAP

    @property
    def y(self) -> Range:
        return -self.width / 2, self.width / 2


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws an oven."""
    style = wish.style or str(rng.choice(STYLES, p=(0.42, 0.24, 0.22, 0.12)))
    palette = draw_palette(rng, "appliance", style)
    plan = _draw_plan(rng, wish, style)
    pieces: list[Primitive] = []
    parts: list[ShapePart] = []
    if plan.kind == "hob":
        pieces, parts = _draw_hob(rng, plan)
    else:
        top = _draw_top(rng, plan, pieces)
        lower = _draw_controls(rng, plan, top, pieces, parts)
        _draw_bands(rng, plan, (plan.foot, lower), pieces, parts)
        if plan.foot:
            pieces += build_feet((plan.front, -plan.x), plan.y, plan.foot, "leg", inset=0.04)
    body = ShapePart(name="body", label="base", parent=None, primitives=tuple(pieces))
    return Draft(style=style, parts=(body, *parts), finishes=tuple(sorted(palette.items())))


def _draw_plan(rng: np.random.Generator, wish: Wish, style: str) -> _Plan:
    kind = tuple(KINDS)[int(rng.choice(len(KINDS), p=tuple(KINDS.values())))]
    widths, depths, heights = SIZES[kind]
    width = choose(rng, *widths, wish.width)
    depth = choose(rng, *depths, wish.depth)
    built_in = kind in ("wall", "double_wall", "rangetop", "hob")
    rear = kind in ("range", "double_range") and rng.random() < 0.3
    upstand = 0.0
    if not built_in and (rear or rng.random() < 0.3):
        upstand = float(rng.uniform(0.13, 0.24) if rear else rng.uniform(0.05, 0.10))
    height = choose(rng, *heights, None if wish.height is None else wish.height - upstand)
    longest = max(width, depth, height + upstand)
    if kind in ("hob", "wall", "double_wall"):
        foot = 0.0
    else:
        foot = float(rng.uniform(0.02, 0.05) if rng.random() < 0.7 else rng.uniform(0.07, 0.13))
    if kind == "rangetop":
        foot = 0.02
    grip = draw_grip(
        rng, ("bar", "bar", "pull", "arch"), length=float(rng.uniform(0.62, 0.86)) * width, longest=longest
    )
    gas = ("gas", "glass", "coil")[int(rng.choice(3, p=(0.55, 0.35, 0.10)))]
    return _Plan(
        kind=kind,
        width=width,
        depth=depth,
        height=height,
        thickness=float(rng.uniform(0.036, 0.05)),
        wall=float(rng.uniform(0.045, 0.065)),
        foot=foot,
        face="panel" if style in ("black", "steel") and rng.random() < 0.4 else "front",
        cooktop=COOKTOP_KINDS[0] if kind in ("pro", "rangetop") else gas,
        burners=_draw_burners(rng, kind, width),
        upstand=upstand,
        rear_controls=rear,
        dial=design_dial(
            rng, (0.017, 0.026), endless=0.72, finish="handle" if rng.random() < 0.6 else "rubber"
        ),
        grip=grip if rng.random() < 0.66 else None,
        longest=longest,
    )


def _draw_burners(rng: np.random.Generator, kind: Kind, width: float) -> int:
    if kind in ("pro", "rangetop"):
        return 6
    if width < 0.56:
        return 4
    return int(rng.choice((4, 5), p=(0.7, 0.3)))


def _draw_top(rng: np.random.Generator, plan: _Plan, pieces: list[Primitive]) -> float:
    """Worktop with its burners and upstand; returns the height of its underside."""
    if plan.kind in ("wall", "double_wall"):
        return plan.height
    under = plan.height - float(rng.uniform(0.026, 0.04))
    finish = "panel" if plan.cooktop == "glass" else "top"
    pieces.append(rounded_box((plan.x, *plan.y[:1], under), (-plan.x, plan.y[1], plan.height), 0.004, finish))
    rear = -plan.x - (0.065 if plan.upstand else 0.03)
    area = ((plan.x + 0.05, rear - 0.015), (plan.y[0] + 0.03, plan.y[1] - 0.03))
    pieces += build_burners(rng, plan.cooktop, area, plan.height, count=plan.burners)
    if plan.upstand:
        low = (-plan.x - 0.06, plan.y[0], plan.height)
        pieces.append(rounded_box(low, (-plan.x, plan.y[1], plan.height + plan.upstand), 0.005, plan.face))
    return under


def _draw_controls(
    rng: np.random.Generator, plan: _Plan, top: float, pieces: list[Primitive], parts: list[ShapePart]
) -> float:
    """Dials, keys and a display on a band below the worktop or on the upstand; returns the band's lower edge."""
    if plan.rear_controls:
        x, z = -plan.x - 0.06, (plan.height + 0.04, plan.height + plan.upstand)
        lower = top
    else:
        low, high = (0.10, 0.14) if plan.kind != "rangetop" else (0.3, 0.3)
        tall = float(rng.uniform(low, high))
        lower = plan.foot if plan.kind == "rangetop" else top - tall
        x, z = plan.x, (max(lower, top - 0.15), top)
        pieces.append(_build_control_band(rng, plan, (lower, top)))
        back = box((plan.front, *plan.y[:1], lower), (-plan.x, plan.y[1], top), "body")
        pieces.append(back)
    keys = int(rng.choice((0, 1, 3, 4, 5), p=(0.62, 0.1, 0.1, 0.09, 0.09)))
    across = (plan.y[0] + 0.03, plan.y[1] - 0.03)
    pieces_added, controls = spread_controls(
        rng, plan.dial, x, across, z, counts=(_count_dials(rng, plan), keys)
    )
    pieces += pieces_added
    parts += controls
    return lower


def _build_control_band(rng: np.random.Generator, plan: _Plan, z: Range) -> Primitive:
    low: Vector = (plan.x, plan.y[0], z[0])
    return rounded_box(low, (plan.front, plan.y[1], z[1]), 0.003, plan.face)


def _count_dials(rng: np.random.Generator, plan: _Plan) -> int:
    if plan.kind in ("wall", "double_wall"):
        return int(rng.choice((0, 1, 2, 3), p=(0.3, 0.1, 0.4, 0.2)))
    ovens = 2 if plan.kind in ("double_range", "pro") else 1
    wanted = plan.burners + int(rng.integers(0, 2 * ovens + 1)) - int(plan.burners > 4 and rng.random() < 0.4)
    if plan.cooktop == "glass" and rng.random() < 0.25:
        wanted = 0
    if plan.kind == "rangetop":
        wanted = int(rng.integers(6, 9))
    return min(wanted, int((plan.width - 0.06) / (2.5 * plan.dial.radius)), 10)


def _draw_bands(
    rng: np.random.Generator, plan: _Plan, z: Range, pieces: list[Primitive], parts: list[ShapePart]
) -> None:
    """Housing below the controls: one or two rows of ovens, perhaps a drawer under them."""
    if plan.kind == "rangetop":
        return
    rows = [1.0]
    if plan.kind in ("double_range", "double_wall"):
        rows = [float(rng.uniform(0.5, 1.0)), 1.0]
    drawer = 0.0
    if plan.kind in ("range", "pro") and rng.random() < 0.55 and z[1] - z[0] > 0.5:
        drawer = float(rng.uniform(0.13, 0.2))
    wall, back = SKIN, -plan.x
    for side, (y0, y1) in (("right", (plan.y[0], plan.y[0] + wall)), ("left", (plan.y[1] - wall, plan.y[1]))):
        board = box((plan.front, y0, z[0]), (back, y1, z[1]), "body")
        pieces.append(line(board, "cavity", SIDES[side]))
    inner = (plan.y[0] + wall, plan.y[1] - wall)
    pieces.append(
        line(box((back - wall, inner[0], z[0]), (back, inner[1], z[1]), "body"), "cavity", SIDES["back"])
    )
    if drawer:
        _draw_drawer(rng, plan, (z[0], z[0] + drawer), inner, pieces, parts)
    stack = share_range((z[0] + drawer, z[1]), list(reversed(rows)), 0.0)
    for row, span in enumerate(reversed(stack)):
        _draw_oven_row(rng, plan, row, span, inner, pieces, parts)


def _draw_oven_row(
    rng: np.random.Generator,
    plan: _Plan,
    row: int,
    z: Range,
    inner: Range,
    pieces: list[Primitive],
    parts: list[ShapePart],
) -> None:
    """Ovens side by side: floor and ceiling, partitions, doors, racks."""
    wall, back = plan.wall, -plan.x - SKIN
    floor, ceiling = z[0] + wall, z[1] - 0.7 * wall
    pieces.append(
        line(box((plan.front, inner[0], z[0]), (back, inner[1], floor), "body"), "cavity", SIDES["bottom"])
    )
    pieces.append(
        line(box((plan.front, inner[0], ceiling), (back, inner[1], z[1]), "body"), "cavity", SIDES["top"])
    )
    columns = [plan.y]
    if plan.kind == "pro" and rng.random() < 0.6:
        columns = share_range(plan.y, (float(rng.uniform(0.4, 1.0)), 1.0), 0.004)
        cut = (columns[0][1] + columns[1][0]) / 2
        pieces.append(box((plan.front, cut - wall / 2, floor), (back, cut + wall / 2, ceiling), "cavity"))
    swings = plan.kind == "wall" and rng.random() < 0.3
    for column, y in enumerate(columns):
        cheek = SKIN
        if swings:  # racks must pass the edge of the open leaf
            cheek = plan.thickness + 0.008
        low = max(y[0] + cheek, inner[0]) if y[0] == plan.y[0] else y[0] - 0.002 + wall / 2
        high = min(y[1] - cheek, inner[1]) if y[1] == plan.y[1] else y[1] + 0.002 - wall / 2
        if swings:
            for a, b in ((inner[0], low), (high, inner[1])):
                pieces.append(box((plan.front, a, floor), (back, b, ceiling), "cavity"))
        space = Space(x=(plan.front, back), y=(low, high), z=(floor, ceiling))
        name = f"door_{row}_{column}"
        parts += _draw_oven_door(rng, plan, Panel(x=plan.x, thickness=plan.thickness, y=y, z=z), name, swings)
        lowest = z[0] + plan.thickness + 0.006
        count = int(rng.choice((0, 1, 2, 3), p=(0.22, 0.28, 0.32, 0.18)))
        levels = choose_levels(rng, space, lowest, count)
        rails = build_rails(space, levels)
        if len(pieces) + len(rails) + (4 if row or not column else 2) <= MAX_PIECES:
            pieces += rails
        parts += make_racks(rng, space, levels, stem=f"rack_{row}_{column}", door=name)


def _draw_oven_door(
    rng: np.random.Generator, plan: _Plan, slot: Panel, name: str, swings: bool
) -> list[ShapePart]:
    """A door with a window, hinged below, or at the side where ``swings``."""
    gap = sweep_gap(slot.height, slot.thickness)
    panel = Panel(x=slot.x, thickness=slot.thickness, y=slot.y, z=(slot.z[0] + 0.002, slot.z[1] - gap))
    edge = "bottom"
    if swings:
        edge = "left" if rng.random() < 0.5 else "right"
        panel = Panel(x=slot.x, thickness=slot.thickness, y=slot.y, z=(slot.z[0], slot.z[1] - 0.003))
    aside = float(rng.uniform(0.08, 0.17)) * panel.width
    top = max(float(rng.uniform(0.17, 0.28)) * panel.height, 0.055)
    bottom = float(rng.uniform(0.10, 0.2)) * panel.height
    window = ((panel.y[0] + aside, panel.y[1] - aside), (panel.z[0] + bottom, panel.z[1] - top))
    leaf = list(build_window_leaf(panel, window, plan.face, "cavity"))
    side = {"bottom": "top", "left": "right", "right": "left"}[edge]
    upper = float(np.pi / 2 if not swings else np.radians(rng.uniform(90, 120)))
    handles = []
    if plan.grip is None:  # a lip that is one piece with the door
        lip = max(0.018, 0.017 * plan.longest)
        y, z = (panel.y[0] + aside, panel.y[1] - aside), (panel.z[1] - 0.01 - lip, panel.z[1] - 0.01)
        if swings:
            z = window[1]
            y = (panel.y[0] + 0.01, panel.y[0] + 0.01 + lip) if edge == "left" else (panel.y[1] - 0.01 - lip, panel.y[1] - 0.01)
        leaf.append(box((panel.x - 0.024, y[0], z[0]), (panel.x, y[1], z[1]), "handle"))
    else:
        inset = max(0.012, min(0.03, (top - plan.grip.thickness) / 2))
        handles.append(
            mount_grip(panel, plan.grip, name=f"{name}_handle", parent=name, side=side, inset=inset)
        )
    door = ShapePart(
        name=name, label="door", parent="body", primitives=tuple(leaf), motion=hinge(panel, edge, upper)
    )
    return [door, *handles]


def _draw_drawer(
    rng: np.random.Generator,
    plan: _Plan,
    z: Range,
    inner: Range,
    pieces: list[Primitive],
    parts: list[ShapePart],
) -> None:
    """A warming drawer, and the floor under it."""
    floor = z[0] + SKIN
    back = -plan.x - SKIN
    pieces.append(
        line(box((plan.front, inner[0], z[0]), (back, inner[1], floor), "body"), "cavity", SIDES["bottom"])
    )
    panel = Panel(x=plan.x, thickness=plan.thickness, y=plan.y, z=(z[0], z[1] - 0.003))
    tub = Space(x=(panel.back, back - 0.02), y=(inner[0] + GAP, inner[1] - GAP), z=(floor + GAP, z[1] - 0.03))
    wall = max(0.008, max(tub.width, tub.depth) / 55)
    face = rounded_box(
        (panel.x, panel.y[0], panel.z[0]),
        (panel.back, panel.y[1], panel.z[1]),
        0.003,
        "front" if plan.face == "front" or rng.random() < 0.5 else plan.face,
    )
    solids = [face, *build_tub(tub, wall, "steel")]
    motion = slide(0.68 * tub.depth)
    handles = []
    if plan.grip is not None and rng.random() < 0.6:
        handles.append(
            mount_grip(panel, plan.grip, name="drawer_handle", parent="drawer", side="top", inset=0.02)
        )
    else:
        lip = max(0.016, 0.016 * plan.longest)
        solids.append(
            box(
                (panel.x - 0.018, -0.2 * plan.width, panel.z[1] - lip),
                (panel.x, 0.2 * plan.width, panel.z[1]),
                "handle",
            )
        )
    parts.append(
        ShapePart(name="drawer", label="drawer", parent="body", primitives=tuple(solids), motion=motion)
    )
    parts += handles


def _draw_hob(rng: np.random.Generator, plan: _Plan) -> tuple[list[Primitive], list[ShapePart]]:
    """A hob to be let into a worktop, dials along its front or right side."""
    lid = plan.height - max(0.012, plan.width / 55)
    finish = "panel" if plan.cooktop == "glass" else "top"
    pieces = [
        box((plan.x + 0.02, plan.y[0] + 0.02, 0.0), (-plan.x - 0.02, plan.y[1] - 0.02, lid), "body"),
        box((plan.x, plan.y[0], lid), (-plan.x, plan.y[1], plan.height), finish),
    ]
    margin = 2.6 * plan.dial.radius + 0.02
    aside = rng.random() < 0.4
    x = (plan.x + (0.02 if aside else margin), -plan.x - 0.02)
    y = (plan.y[0] + (margin if aside else 0.02), plan.y[1] - 0.02)
    pieces += build_burners(rng, plan.cooktop, (x, y), plan.height, count=plan.burners)
    count = plan.burners + int(rng.integers(0, 2))
    parts = []
    for k in range(count):
        share = (k + 0.5) / count
        if aside:
            at = (x[0] + share * (x[1] - x[0]), plan.y[0] + margin / 2, plan.height)
        else:
            span = 0.72 * plan.width
            at = (plan.x + margin / 2, span / 2 - share * span, plan.height)
        parts.append(make_dial(plan.dial, at, name=f"dial_{k}", parent="body", out=(0.0, 0.0, 1.0)))
    return pieces, parts
