"""Components of washing machines and dryers: cabinet, round door, drum, control band."""

from dataclasses import dataclass
from math import radians

import numpy as np

from artigen.shapes.appliances.cavity import build_tub, build_walls
from artigen.shapes.appliances.control_panel import design_dial, spread_controls
from artigen.shapes.appliances.drums import build_porthole
from artigen.shapes.appliances.housing import Housing
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import GAP, Panel, Space, hinge, slide
from artigen.shapes.primitives import Primitive, block, box
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart

WALL = 0.024
"""Thickness of sides and back of the housing (m)."""
LID = 0.022
"""Thickness of the top (m)."""
FACE = 0.03
"""Thickness of the front plate (m)."""


@dataclass(frozen=True, kw_only=True)
class LaundryPlan(Housing):
    """Dimensions that all parts share (m); ``thickness`` is that of the door or lid."""

    pedestal: float
    """Height of a drawer below; 0 for none."""
    band: float
    """Height of the control band or console."""


def seat_drum(rng: np.random.Generator, drum: ShapePart, bearing: Primitive) -> Assembly:
    """Draws the drum and its bearing; sometimes none, as in display models."""
    if rng.random() < 0.15:
        return Assembly((bearing,))
    return Assembly((bearing,), (drum,))


def draw_porthole(rng: np.random.Generator, plan: LaundryPlan, panel: Panel, hole: float) -> Assembly:
    """Draws the round door, with a handle half of the time."""
    edge = "left" if rng.random() < 0.8 else "right"
    glass = "clear" if rng.random() < 0.45 else "glass"
    mouth = 0.84 * hole
    solids = build_porthole(panel, mouth, choose(rng, 0.035, 0.055), glass)
    door = ShapePart("door", "door", solids, hinge(panel, edge, radians(choose(rng, 100, 170))))
    if rng.random() < 0.5:
        return Assembly(parts=(door,))
    return Assembly(parts=(door, make_door_grip(plan, panel, edge, mouth, choose(rng, 0.09, 0.14))))


def make_door_grip(plan: LaundryPlan, panel: Panel, edge: str, mouth: float, length: float) -> ShapePart:
    """A handle on the rim of a round door, opposite its hinged edge; ``mouth`` is the radius of its glass."""
    design = HandleDesign(kind="block", length=length, thickness=max(0.016, 0.017 * plan.longest))
    aside = (mouth + panel.width / 2 - 0.022) / 2
    at = (-aside if edge == "left" else aside, panel.center[1])
    return make_handle(panel, design, name="door_handle", parent="door", upright=True, at=at)


def build_cabinet(plan: LaundryPlan, x: float, z: Range) -> list[Primitive]:
    """Sides, back, floor and worktop; sides and back begin at the floor of the cabinet's lowest tier."""
    back, up = plan.back, (z[0] - plan.pedestal, z[1] - LID)
    return [
        *build_walls((x + FACE, back), plan.y, up, WALL, "steel"),
        block((x + FACE, back - WALL), narrow(plan.y, WALL), (z[0], z[0] + 0.018), "body"),
        block((x, back), plan.y, (z[1] - LID, z[1]), "top", 0.004),
    ]


def draw_band(rng: np.random.Generator, plan: LaundryPlan, x: float, z: Range) -> Assembly:
    """Draws the control band above the porthole, usually with a detergent drawer at its left end."""
    finish = "panel" if rng.random() < 0.45 else "front"
    left = plan.y[1]
    built = Assembly()
    if rng.random() < 0.74:
        left -= choose(rng, 0.17, 0.22)
        built = draw_box_drawer(rng, plan, x, (left, z), finish)
    band = block((x, x + FACE), (plan.y[0], left), z, finish, 0.002)
    dial = design_dial(rng, (0.024, 0.034), endless=0.7)
    counts = (
        int(rng.choice((0, 1, 2, 3), p=(0.1, 0.6, 0.12, 0.18))),
        int(rng.choice((0, 3, 4, 5, 6), p=(0.43, 0.12, 0.14, 0.13, 0.18))),
    )
    across = (plan.y[0] + WALL + 0.012, left - 0.012)
    return built + Assembly((band,)) + spread_controls(rng, dial, x, across, z, counts=counts)


def draw_box_drawer(
    rng: np.random.Generator, plan: LaundryPlan, x: float, place: tuple[float, Range], finish: str
) -> Assembly:
    """A drawer with two chambers between a y and the left side, and the shelf that it runs on."""
    left, z = place
    y, wall = (left + GAP, plan.y[1]), plan.y[1] - WALL
    low, high = narrow(z, GAP)
    room = 0.010
    tub = Space(x=(x + 0.02, x + 0.24), y=(y[0] + room, wall - room), z=(z[0] + 0.026, z[1] - 0.02))
    lip, middle = max(0.016, 0.016 * plan.longest), sum(tub.y) / 2
    solids = (
        block((x, x + 0.02), y, (low, high), finish, 0.002),
        block((x - 0.014, x), narrow(y, 0.02), (low, low + lip), finish),
        *build_tub(tub, 0.005, "plastic"),
        block(tub.x, around(middle, 0.003), tub.z, "plastic"),
    )
    drawer = ShapePart("detergent_drawer", "drawer", solids, slide(choose(rng, 0.5, 0.7) * tub.depth))
    top = tub.z[0] - room
    shelf = box((x + FACE, left - 0.01, top - 0.008), (tub.x[1] + 0.01, wall, top), "steel")
    return Assembly((shelf,), (drawer,))
