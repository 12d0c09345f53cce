"""Fronts of a cooled compartment: doors with bins, drawers and glass doors."""

from dataclasses import dataclass, replace
from math import radians
from typing import Literal

import numpy as np

from artigen.shapes.appliances.appliance_doors import build_window_leaf, mount_grip
from artigen.shapes.appliances.cold_storage import (
    LOW,
    build_cold_leaf,
    build_freezer_drawer,
    plan_bins,
    reach_inwards,
)
from artigen.shapes.appliances.control_panel import build_badge
from artigen.shapes.choices import choose
from artigen.shapes.fittings.handles import HandleDesign
from artigen.shapes.fittings.hardware import Edge, Panel, Space, hinge, slide, sweep_gap
from artigen.shapes.ranges import Range, around, divide_range, narrow
from artigen.shapes.shape import Need, ShapePart

BADGE_DROP = 0.055
"""Distance (m) of the maker's plate from the top of the highest door."""
Form = Literal[
    "single", "mini", "top_freezer", "bottom_freezer", "drawer", "side_by_side", "french", "display"
]
FrontKind = Literal["door", "pair", "drawer", "glass"]


@dataclass(frozen=True, kw_only=True)
class Compartment:
    """A compartment: its front and the free space behind it."""

    frozen: bool
    front: FrontKind
    y: Range
    z: Range
    """Ranges of the front, including gaps."""
    space: Space
    """Free space behind the front."""
    edge: Edge | None = None
    """Hinged edge of its door; None for that of the whole."""
    leaves: int | None = None
    """Number of its glass doors; None for the usual."""


@dataclass(frozen=True, kw_only=True)
class ColdPlan:
    """Choices that all compartments are built from (m)."""

    kind: Form
    outer: Space
    """Outer box of the housing."""
    floor: float
    """Height of the lower edge of the fronts."""
    x: float
    thickness: float
    """x of the front face of the leaves, and their thickness."""
    wall: float
    longest: float
    edge: Edge
    bevel: float
    grip: HandleDesign | None


def draw_doors(
    rng: np.random.Generator, plan: ColdPlan, cell: Compartment, z: Range, stem: str
) -> tuple[list[ShapePart], tuple[Need, ...], Range, float]:
    """Draws the doors of a compartment.

    Returns:
        The parts; the parts that must be open before a crisper slides out; the range of y that is then free
        at the height of the crispers; the depth of the bins on the doors.
    """
    upper = radians(choose(rng, 92, 150))
    depth = choose(rng, 0.07, 0.11) if rng.random() < (0.5 if cell.frozen else 0.88) else 0.0
    bins = plan_bins(rng, depth, (cell.space.z[0] + LOW, cell.space.z[1])) if depth else None
    dispenses = _dispenses(rng, plan, cell)
    parts: list[ShapePart] = []
    needs: list[Need] = []
    low, high = narrow(cell.space.y, 0.004)
    for k, (panel, edge) in enumerate(_place_doors(plan, cell, z)):
        name = f"door_{stem}_{k}"
        niche = _draw_niche(rng, panel) if dispenses and k == 0 else None
        across = cell.space.y if cell.front == "door" else _half(cell.space.y, panel, edge)
        leaf = build_cold_leaf(panel, edge, (across, cell.space.z), bins, bevel=plan.bevel, niche=niche)
        if k == 0 and z[1] == plan.outer.z[1] and panel.height > 4 * BADGE_DROP:
            leaf += (build_badge(panel.x, (panel.center[0], panel.z[1] - BADGE_DROP), 0.06),)
        parts.append(ShapePart(name, "door", leaf, hinge(panel, edge, upper)))
        parts += _mount(plan, panel, edge, name)
        needs.append(Need(part=name, fraction=1.0))
        reach = reach_inwards(panel, upper) + 0.004
        if edge == "left":
            high = min(high, panel.y[1] - reach)
        else:
            low = max(low, panel.y[0] + reach)
    return parts, tuple(needs), (low, high), depth if bins else 0.0


def _dispenses(rng: np.random.Generator, plan: ColdPlan, cell: Compartment) -> bool:
    """Whether the first door has a dispenser."""
    if plan.kind == "side_by_side":
        return cell.frozen and rng.random() < 0.7
    return cell.front == "pair" and not cell.frozen and rng.random() < 0.6


def _draw_niche(rng: np.random.Generator, panel: Panel) -> tuple[Range, Range] | None:
    wide = choose(rng, 0.40, 0.55) * panel.width
    middle = panel.center[0] + 0.04
    bottom = choose(rng, 0.92, 1.05)
    top = bottom + choose(rng, 0.28, 0.38)
    if bottom < panel.z[0] + 0.1 or top > panel.z[1] - 0.1:
        return None
    return around(middle, wide / 2), (bottom, top)


def _half(y: Range, panel: Panel, edge: Edge) -> Range:
    """The half of an opening behind one of two doors."""
    return (panel.y[0], y[1]) if edge == "left" else (y[0], panel.y[1])


def _place_doors(plan: ColdPlan, cell: Compartment, z: Range) -> list[tuple[Panel, Edge]]:
    """Panels of the doors of a compartment, from the left, each with its hinged edge."""
    panel = Panel(x=plan.x, thickness=plan.thickness, y=cell.y, z=z)
    if cell.front == "pair":
        left, right = panel.split(sweep_gap(panel.width / 2, plan.thickness))
        return [(left, "left"), (right, "right")]
    half = sweep_gap(cell.y[1] - cell.y[0], plan.thickness) / 2 + 0.002
    y = (
        cell.y[0] + (half if cell.y[0] != plan.outer.y[0] else 0.0),
        cell.y[1] - (half if cell.y[1] != plan.outer.y[1] else 0.0),
    )
    edge = cell.edge or plan.edge
    if plan.kind == "side_by_side":
        edge = "left" if cell.frozen else "right"
    return [(replace(panel, y=y), edge)]


def _mount(plan: ColdPlan, panel: Panel, edge: Edge, parent: str) -> list[ShapePart]:
    """A vertical handle near the free edge, as close to hand height as the door allows."""
    if plan.grip is None:
        return []
    half = min(plan.grip.length, 0.86 * panel.height) / 2
    margin = min(half + 0.04, panel.height / 2)
    level = float(np.clip(1.05, panel.z[0] + margin, panel.z[1] - margin))
    inset = 0.002 if plan.grip.kind == "edge" else 0.03
    return [mount_grip(panel, plan.grip, parent=parent, edge=edge, inset=inset, level=level)]


def make_drawer(plan: ColdPlan, cell: Compartment, panel: Panel, stem: str) -> list[ShapePart]:
    """A freezer drawer, with its handle."""
    name = f"drawer_{stem}"
    pieces = build_freezer_drawer(panel, cell.space, bevel=plan.bevel)
    drawer = ShapePart(name, "drawer", pieces, slide(0.7 * cell.space.depth))
    if plan.grip is None:
        return [drawer]
    inset = 0.002 if plan.grip.kind == "edge" else min(0.035, panel.height / 5)
    return [drawer, mount_grip(panel, plan.grip, parent=name, edge=None, inset=inset)]


def draw_glass_doors(
    rng: np.random.Generator, plan: ColdPlan, cell: Compartment, z: Range
) -> list[ShapePart]:
    """Draws one to three glass doors side by side, hinged on the same edge."""
    usual = int(np.clip(round((cell.y[1] - cell.y[0]) / rng.uniform(0.42, 0.65)), 1, 3))
    count, edge = cell.leaves or usual, cell.edge or plan.edge
    gap = sweep_gap((cell.y[1] - cell.y[0]) / count, plan.thickness)
    rail = choose(rng, 0.035, 0.06)
    # A door that opens beyond 90 degrees would hit the handle of its neighbour.
    upper = radians(rng.uniform(90, 120) if count == 1 else 90)
    parts: list[ShapePart] = []
    for k, y in enumerate(reversed(divide_range(cell.y, count, gap))):
        panel = Panel(x=plan.x, thickness=plan.thickness, y=y, z=z)
        window = (narrow(y, rail), (z[0] + 1.3 * rail, z[1] - rail))
        leaf = build_window_leaf(panel, window, "front", "rubber", glass="clear")
        name = f"door_{k}"
        parts.append(ShapePart(name, "door", leaf, hinge(panel, edge, upper)))
        parts += _mount(plan, panel, edge, name)
    return parts
