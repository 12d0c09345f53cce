"""Fronts of ovens: doors with a window, and warming drawers."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from artigen.shapes.appliances.appliance_doors import build_window_leaf, mount_grip
from artigen.shapes.appliances.cavity import build_tub
from artigen.shapes.appliances.control_panel import build_badge
from artigen.shapes.appliances.racks import choose_thickness
from artigen.shapes.choices import choose
from artigen.shapes.fittings.handles import HandleDesign
from artigen.shapes.fittings.hardware import Panel, Space, hinge, slide, stay_above, sweep_gap
from artigen.shapes.primitives import block
from artigen.shapes.ranges import narrow
from artigen.shapes.shape import ShapePart


@dataclass(frozen=True, kw_only=True)
class FrontLook:
    """Design of the fronts of one oven."""

    face: str
    """Role of the finish."""
    grip: HandleDesign | None
    """None for grip lips along the free edges of the doors."""
    longest: float
    """Longest edge of the oven (m), which lips and handles are proportional to."""
    border: float = 0.0
    """Width (m) of the black print around windows."""
    floor: float = -np.inf
    """Height (m) above which open doors stay."""


def make_oven_door(
    rng: np.random.Generator,
    slot: Panel,
    look: FrontLook,
    *,
    name: str,
    edge: Literal["bottom", "left", "right"],
) -> list[ShapePart]:
    """A door with a window and a handle, which fills its slot except for the gaps that it needs to turn."""
    low, high = (0.002, sweep_gap(slot.height, slot.thickness)) if edge == "bottom" else (0.0, 0.003)
    panel = Panel(x=slot.x, thickness=slot.thickness, y=slot.y, z=(slot.z[0] + low, slot.z[1] - high))
    aside = choose(rng, 0.08, 0.22) * panel.width
    top = max(choose(rng, 0.17, 0.28) * panel.height, 0.055)
    bottom = choose(rng, 0.10, 0.28) * panel.height
    window = (narrow(panel.y, aside), (panel.z[0] + bottom, panel.z[1] - top))
    leaf = build_window_leaf(panel, window, look.face, "cavity", border=look.border)
    if bottom > 0.04:
        leaf += (build_badge(panel.x, (panel.center[0], panel.z[0] + bottom / 2), 0.07),)
    upper = float(np.pi / 2 if edge == "bottom" else np.radians(rng.uniform(90, 120)))
    if look.grip is None:
        handle = _mount_lip(panel, edge, aside, look.longest, parent=name)
    else:
        inset = max(0.012, min(0.03, (top - look.grip.thickness) / 2))
        handle = mount_grip(panel, look.grip, parent=name, edge=edge, inset=inset)
    joint = stay_above(hinge(panel, edge, upper), (*leaf, *handle.primitives), look.floor)
    return [ShapePart(name, "door", leaf, joint), handle]


def make_warming_drawer(
    rng: np.random.Generator, panel: Panel, tub: Space, look: FrontLook
) -> list[ShapePart]:
    """A warming drawer: a front, and a steel box that fills ``tub`` behind it."""
    wall = choose_thickness(tub, 0.008)
    face = "front" if rng.random() < 0.5 else look.face
    solids = [panel.fill(face, 0.003), *build_tub(tub, wall, "steel")]
    if look.grip is not None and rng.random() < 0.6:
        handle = mount_grip(panel, look.grip, parent="drawer", edge=None, inset=0.02)
    else:
        handle = _mount_lip(panel, "bottom", 0.3 * panel.width, look.longest, parent="drawer")
    return [ShapePart("drawer", "drawer", solids, slide(0.68 * tub.depth)), handle]


def _mount_lip(
    panel: Panel, edge: Literal["bottom", "left", "right"], aside: float, longest: float, *, parent: str
) -> ShapePart:
    """A grip lip for the fingertips along the free edge, ``aside`` metres short at both ends."""
    size, inset = max(0.018, 0.017 * longest), 0.008
    y, z = narrow(panel.y, aside), (panel.z[1] - inset - size, panel.z[1] - inset)
    if edge != "bottom":
        z = (panel.z[0] + 0.1 * panel.height, panel.z[1] - 0.2 * panel.height)
        start = panel.y[0] + inset if edge == "left" else panel.y[1] - inset - size
        y = (start, start + size)
    lip = block((panel.x - 0.022, panel.x), y, z, "handle")
    return ShapePart(f"{parent}_handle", "handle", (lip,), parent=parent)
