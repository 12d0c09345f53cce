"""Washing machines: a porthole before a lying drum, or a lid over a standing one; detergent drawer and controls."""

from dataclasses import dataclass

import numpy as np

from artigen.shapes.cavity import SIDES, build_feet, build_tub
from artigen.shapes.control_panel import design_dial, spread_controls
from artigen.shapes.draw import Draft, Wish, choose
from artigen.shapes.drums import SHEET, build_bearing, build_porthole, make_drum
from artigen.shapes.handles import HandleDesign, make_handle
from artigen.shapes.hardware import GAP, Panel, Range, Space, hinge, slide
from artigen.shapes.palette import draw_palette
from artigen.shapes.primitives import Primitive, box, line, rounded_box
from artigen.shapes.rings import build_pierced_plate
from artigen.shapes.shape import Motion, ShapePart

CATEGORY = "WashingMachine"
STYLES = ("white", "steel", "black", "retro")


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """Sizes that all parts share; metres."""

    width: float
    depth: float
    height: float
    pedestal: float
    """Height of a drawer below; 0 without."""
    thickness: float
    """Of the door or the lid."""
    band: float
    """Height of the band of controls, or of the console."""
    longest: float

    @property
    def y(self) -> Range:
        return -self.width / 2, self.width / 2


WALL = 0.024
"""Sides and back of the housing (m)."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a washing machine."""
    style = wish.style or str(rng.choice(STYLES, p=(0.58, 0.22, 0.14, 0.06)))
    palette = draw_palette(rng, "appliance", style)
    loads_at_top = rng.random() < 0.22
    plan = _draw_plan(rng, wish, loads_at_top)
    parts = _draw_top_loader(rng, plan) if loads_at_top else _draw_front_loader(rng, plan)
    return Draft(style=style, parts=tuple(parts), finishes=tuple(sorted(palette.items())))


def _draw_plan(rng: np.random.Generator, wish: Wish, loads_at_top: bool) -> _Plan:  # noqa: FBT001
    width = choose(rng, 0.57, 0.70, wish.width)
    depth = choose(rng, 0.54, 0.72, wish.depth)
    height = choose(rng, *((1.00, 1.12) if loads_at_top else (0.82, 0.99)), wish.height)
    pedestal = 0.0
    if not loads_at_top and wish.height is None and rng.random() < 0.12:
        pedestal = float(rng.uniform(0.26, 0.36))
    return _Plan(
        width=width,
        depth=depth,
        height=height + pedestal,
        pedestal=pedestal,
        thickness=float(rng.uniform(0.036, 0.052)),
        band=float(rng.uniform(0.105, 0.145)),
        longest=max(width, depth, height + pedestal),
    )


def _draw_front_loader(rng: np.random.Generator, plan: _Plan) -> list[ShapePart]:
    x = -plan.depth / 2 + plan.thickness + GAP
    back, y = plan.depth / 2, plan.y
    foot = float(rng.uniform(0.012, 0.025))
    floor = foot + plan.pedestal
    sill = plan.height - plan.band
    radius = min(float(rng.uniform(0.80, 0.94)) * (sill - floor) / 2, 0.40 * plan.width)
    hole = (0.0, (floor + sill) / 2 + 0.01, float(rng.uniform(0.72, 0.8)) * radius)
    inner = (y[0] + WALL, y[1] - WALL)
    pieces: list[Primitive] = [
        *build_feet((x, back), y, foot, "rubber", radius=0.022, inset=0.04),
        *_build_cabinet(plan, x, (floor, plan.height)),
        *build_pierced_plate((x, x + 0.03), (inner, (floor + 0.018, sill)), hole, "front", lining="rubber"),
    ]
    detergent, controls = _draw_band(rng, plan, x, (sill, plan.height - 0.022), pieces)
    upper = float(np.radians(rng.uniform(100, 170)))
    panel = Panel(
        x=-plan.depth / 2, thickness=plan.thickness, y=(-radius, radius), z=(hole[1] - radius, hole[1] + radius)
    )
    edge = "left" if rng.random() < 0.8 else "right"
    glass = "clear" if rng.random() < 0.45 else "glass"
    door = ShapePart(
        name="door",
        label="door",
        parent="body",
        primitives=build_porthole(panel, 0.84 * hole[2], float(rng.uniform(0.035, 0.055)), glass),
        motion=hinge(panel, edge, upper),
    )
    parts = [door]
    if rng.random() < 0.5:
        thickness = max(0.016, 0.017 * plan.longest)
        design = HandleDesign(kind="block", length=float(rng.uniform(0.09, 0.14)), thickness=thickness)
        aside = (0.84 * hole[2] + radius - 0.022) / 2
        side = -1.0 if edge == "left" else 1.0
        at = (side * aside, hole[1])
        parts.append(make_handle(panel, design, name="door_handle", parent="door", upright=True, at=at))
    wall = back - WALL
    end = wall - 0.05
    room = min(plan.width / 2 - WALL, sill - hole[1], hole[1] - floor - 0.030) - 0.008
    size = room * np.cos(np.pi / 16) - SHEET
    center = (0.0, 0.0, hole[1])
    pieces.append(build_bearing(end, wall, center, "x"))
    parts.append(make_drum(center, "x", (x + 0.055 + 0.03, end), size, paddles=int(rng.integers(2, 5))))
    if plan.pedestal:
        parts += _draw_pedestal(rng, plan, x, foot, pieces)
    body = ShapePart(name="body", label="base", parent=None, primitives=tuple(pieces))
    return [body, *parts, *detergent, *controls]


def _build_cabinet(plan: _Plan, x: float, z: Range) -> list[Primitive]:
    """Sides, back, floor and worktop; sides and back stand on the floor of the cabinet's lowest tier."""
    back, (y0, y1) = plan.depth / 2, plan.y
    low = z[0] - plan.pedestal
    inner = (y0 + WALL, y1 - WALL)
    return [
        line(box((x, y0, low), (back, inner[0], z[1] - 0.022), "body"), "steel", SIDES["right"]),
        line(box((x, inner[1], low), (back, y1, z[1] - 0.022), "body"), "steel", SIDES["left"]),
        line(box((back - WALL, inner[0], low), (back, inner[1], z[1] - 0.022), "body"), "steel", SIDES["back"]),
        box((x, inner[0], z[0]), (back - WALL, inner[1], z[0] + 0.018), "body"),
        rounded_box((x, y0, z[1] - 0.022), (back, y1, z[1]), 0.004, "top"),
    ]


def _draw_band(
    rng: np.random.Generator, plan: _Plan, x: float, z: Range, pieces: list[Primitive]
) -> tuple[list[ShapePart], list[ShapePart]]:
    """The band of controls above the porthole, with a detergent drawer at its left end most of the time."""
    inner = (plan.y[0] + WALL, plan.y[1] - WALL)
    finish = "panel" if rng.random() < 0.45 else "front"
    left = inner[1]
    detergent: list[ShapePart] = []
    if rng.random() < 0.8:
        wide = float(rng.uniform(0.15, 0.20))
        left -= wide
        y = (left + GAP, inner[1] - GAP)
        front = Space(x=(x, x + 0.02), y=y, z=(z[0] + GAP, z[1] - GAP))
        tub = Space(x=(x + 0.02, x + 0.24), y=(y[0] + 0.004, y[1] - 0.004), z=(z[0] + 0.022, z[1] - 0.02))
        lip = max(0.016, 0.016 * plan.longest)
        solids = (
            rounded_box((x, y[0], front.z[0]), (x + 0.02, y[1], front.z[1]), 0.002, finish),
            box((x - 0.014, y[0] + 0.02, front.z[0]), (x, y[1] - 0.02, front.z[0] + lip), finish),
            *build_tub(tub, 0.005, "plastic"),
            box((x + 0.02, sum(y) / 2 - 0.003, tub.z[0]), (tub.x[1], sum(y) / 2 + 0.003, tub.z[1]), "plastic"),
        )
        detergent.append(
            ShapePart(
                name="detergent_drawer",
                label="drawer",
                parent="body",
                primitives=solids,
                motion=slide(float(rng.uniform(0.5, 0.7)) * tub.depth),
            )
        )
        low = (x + 0.03, left - 0.01, tub.z[0] - GAP - 0.008)
        pieces.append(box(low, (tub.x[1] + 0.01, inner[1], tub.z[0] - GAP), "steel"))
    pieces.append(rounded_box((x, inner[0], z[0]), (x + 0.03, left, z[1]), 0.002, finish))
    dial = design_dial(rng, (0.024, 0.034), endless=0.7)
    counts = (
        int(rng.choice((0, 1, 2, 3), p=(0.1, 0.62, 0.12, 0.16))),
        int(rng.choice((0, 3, 4, 5, 6), p=(0.45, 0.12, 0.14, 0.13, 0.16))),
    )
    extras, controls = spread_controls(rng, dial, x, (inner[0] + 0.012, left - 0.012), z, counts=counts)
    pieces += extras
    return detergent, controls


def _draw_pedestal(
    rng: np.random.Generator, plan: _Plan, x: float, foot: float, pieces: list[Primitive]
) -> list[ShapePart]:
    """A drawer under the machine, and the floor below it."""
    inner, back = (plan.y[0] + WALL, plan.y[1] - WALL), plan.depth / 2 - WALL
    pieces.append(box((x, inner[0], foot), (back, inner[1], foot + 0.018), "body"))
    panel = Panel(x=x - 0.028 - GAP, thickness=0.028, y=plan.y, z=(foot, foot + plan.pedestal - 0.004))
    tub = Space(
        x=(panel.back, back - 0.03), y=(inner[0] + GAP, inner[1] - GAP), z=(foot + 0.018 + GAP, panel.z[1] - 0.04)
    )
    face = rounded_box((panel.x, panel.y[0], panel.z[0]), (panel.back, panel.y[1], panel.z[1]), 0.003, "front")
    solids = (face, *build_tub(tub, tub.width / 55, "plastic"))
    drawer = ShapePart(
        name="pedestal_drawer", label="drawer", parent="body", primitives=solids, motion=slide(0.7 * tub.depth)
    )
    design = HandleDesign(kind="bar", length=0.5 * plan.width, thickness=0.018 * plan.longest)
    at = (0.0, panel.z[1] - 0.05)
    handle = make_handle(
        panel, design, name="pedestal_handle", parent="pedestal_drawer", upright=False, at=at
    )
    return [drawer, handle]


def _draw_top_loader(rng: np.random.Generator, plan: _Plan) -> list[ShapePart]:
    """A standing drum under a lid, a console with the controls behind it."""
    x, back, y = -plan.depth / 2, plan.depth / 2, plan.y
    foot = float(rng.uniform(0.015, 0.03))
    thick = 0.026
    deck = plan.height - plan.band - 0.03
    console = back - float(rng.uniform(0.13, 0.17))
    dial = design_dial(rng, (0.022, 0.032), endless=0.7)
    room = dial.length + float(rng.uniform(0.010, 0.020))
    inner = (y[0] + WALL, y[1] - WALL)
    lid_y = (y[0] + 0.012, y[1] - 0.012)
    lid_x = (x + 0.006, console - room)
    hole_x, hole_y = (x + 0.05, lid_x[1] - 0.04), (y[0] + 0.06, y[1] - 0.06)
    center = ((x + back) / 2 - 0.03, 0.0, 0.0)
    end = foot + 0.018 + 0.22
    lateral = min(plan.width / 2, center[0] - x, back - center[0]) - WALL - 0.012
    size = lateral * np.cos(np.pi / 16) - SHEET
    pieces: list[Primitive] = [
        *build_feet((x, back), y, foot, "rubber", radius=0.022, inset=0.04),
        line(box((x, y[0], foot), (back, inner[0], deck), "body"), "steel", SIDES["right"]),
        line(box((x, inner[1], foot), (back, y[1], deck), "body"), "steel", SIDES["left"]),
        line(box((back - WALL, *inner[:1], foot), (back, inner[1], deck), "body"), "steel", SIDES["back"]),
        line(box((x, inner[0], foot), (x + WALL, inner[1], deck), "front"), "steel", SIDES["front"]),
        box((x + WALL, inner[0], foot), (back - WALL, inner[1], foot + 0.018), "body"),
        box((x, y[0], deck), (back, hole_y[0], deck + 0.03), "top"),
        box((x, hole_y[1], deck), (back, y[1], deck + 0.03), "top"),
        box((x, *hole_y[:1], deck), (hole_x[0], hole_y[1], deck + 0.03), "top"),
        box((hole_x[1], hole_y[0], deck), (back, hole_y[1], deck + 0.03), "top"),
        rounded_box((console, y[0], deck + 0.03), (back, y[1], plan.height), 0.006, "panel" if rng.random() < 0.4 else "front"),
        build_bearing(end, foot + 0.018, center, "z"),
    ]
    drum = make_drum(center, "z", (end, deck - 0.02), size, paddles=int(rng.choice((0, 3, 4))))
    low = deck + 0.03 + GAP
    top = low + thick
    upper = float(np.radians(rng.uniform(78, 90)))  # the dials are in the way of more
    motion = Motion(type="revolute", axis=(0.0, 1.0, 0.0), origin=(lid_x[1], 0.0, top), upper=upper)
    lid = _build_lid(rng, (lid_x, lid_y, (low, top)), 0.016 * plan.longest)
    door = ShapePart(name="lid", label="door", parent="body", primitives=lid, motion=motion)
    counts = (int(rng.choice((1, 2, 3, 4), p=(0.3, 0.2, 0.3, 0.2))), int(rng.choice((0, 3, 5), p=(0.6, 0.2, 0.2))))
    face = (deck + 0.05, plan.height)
    extras, controls = spread_controls(rng, dial, console, (y[0] + 0.03, y[1] - 0.03), face, counts=counts)
    body = ShapePart(name="body", label="base", parent=None, primitives=(*pieces, *extras))
    return [body, door, drum, *controls]


def _build_lid(
    rng: np.random.Generator, extent: tuple[Range, Range, Range], lip: float
) -> tuple[Primitive, ...]:
    """A lid with a lip along its front edge; half of them have a pane."""
    (x0, x1), (y0, y1), (z0, z1) = extent
    grip = box((x0 - 0.012, -0.12, z1 - max(lip, 0.016)), (x0, 0.12, z1), "front")
    if rng.random() < 0.4:
        return rounded_box((x0, y0, z0), (x1, y1, z1), 0.004, "front"), grip
    rail = float(rng.uniform(0.05, 0.08))
    return (
        box((x0, y0, z0), (x0 + rail, y1, z1), "front"),
        box((x1 - rail, y0, z0), (x1, y1, z1), "front"),
        box((x0 + rail, y0, z0), (x1 - rail, y0 + rail, z1), "front"),
        box((x0 + rail, y1 - rail, z0), (x1 - rail, y1, z1), "front"),
        box((x0 + rail, y0 + rail, z0 + 0.008), (x1 - rail, y1 - rail, z1 - 0.004), "glass"),
        grip,
    )
