"""Interiors of refrigerators: glass shelves, crispers, freezer baskets, doors with bins."""

from dataclasses import dataclass
from math import cos, sin, sqrt

import numpy as np

from artigen.shapes.appliances.appliance_doors import BULGE, INSET, build_leaf
from artigen.shapes.appliances.cavity import build_tub
from artigen.shapes.appliances.racks import SLENDER, choose_thickness
from artigen.shapes.choices import choose
from artigen.shapes.fittings.hardware import GAP, ROOM, Edge, Panel, Space, slide
from artigen.shapes.primitives import Primitive, block, box
from artigen.shapes.ranges import Range, between, divide_range, margins, narrow
from artigen.shapes.shape import Need, ShapePart
from artigen.types import PartLabel

LOW = 0.26
"""Height (m) above the floor of a compartment that is reserved for tubs; doors have no bins there."""


@dataclass(frozen=True, kw_only=True)
class BinPlan:
    """Bins on the rear side of a door (m)."""

    depth: float
    """Protrusion of ribs and bins into the cabinet."""
    z: Range
    levels: tuple[float, ...]
    """Heights of the bins' floors."""


def reach_inwards(panel: Panel, upper: float) -> float:
    """Width (m), from the hinged edge, of the opening that an open leaf with a liner covers."""
    corners = [(0.0, panel.thickness), (panel.width, 0.0), (panel.width, panel.thickness)]
    corners.append((INSET, panel.thickness + BULGE))
    return max(u * cos(upper) + w * sin(upper) for u, w in corners)


def plan_bins(rng: np.random.Generator, depth: float, z: Range) -> BinPlan | None:
    """Stacked bins within a range of heights; None if not even one fits."""
    count = int(min(rng.integers(2, 5), (z[1] - z[0]) / 0.17))
    if count < 1:
        return None
    rows = divide_range(narrow(z, 0.02), count, 0.0)
    levels = tuple(
        low + choose(rng, 0.0, 0.25) * (high - low) * (k > 0) for k, (low, high) in enumerate(rows)
    )
    return BinPlan(depth=depth, z=narrow(z, 0.015), levels=levels)


def build_cold_leaf(
    panel: Panel,
    edge: Edge,
    opening: tuple[Range, Range],
    bins: BinPlan | None,
    *,
    bevel: float,
    niche: tuple[Range, Range] | None = None,
) -> tuple[Primitive, ...]:
    """An insulated leaf with bins between two ribs, which clear the walls of ``opening`` as it turns.

    Args:
        panel: Front, including the gasket.
        edge: Hinged edge, "left" or "right".
        opening: Free ranges of y and z behind it.
        bins: Bins on its rear side.
        bevel: Chamfer of the outer edges (m).
        niche: Ranges (y, z) of a dispenser.
    """
    leaf = build_leaf(panel, opening, "front", "inside", bevel=bevel, niche=niche)
    if bins is None:
        return leaf
    hinge_y, sign = (panel.y[1], -1.0) if edge == "left" else (panel.y[0], 1.0)
    free = max(abs(hinge_y - opening[0][0]), abs(hinge_y - opening[0][1])) - 0.004
    inner = min(abs(hinge_y - opening[0][0]), abs(hinge_y - opening[0][1])) + 0.012
    outer = sqrt(free**2 - (panel.thickness + bins.depth) ** 2)
    y0, y1 = between(hinge_y + sign * inner, hinge_y + sign * outer)
    x0, x1 = panel.back, panel.back + bins.depth
    rib = max(0.022, (bins.z[1] - bins.z[0]) / SLENDER)
    pieces = [block((x0, x1), side, bins.z, "inside") for side in margins((y0, y1), rib)]
    floor = max(0.008, (y1 - y0) / SLENDER)
    for level in bins.levels:
        pieces.append(box((x0, y0 + rib, level), (x1, y1 - rib, level + floor), "inside"))
        lip = min(level + 0.075, bins.z[1])
        pieces.append(box((x1 - floor, y0 + rib, level + floor), (x1, y1 - rib, lip), "clear"))
    return (*leaf, *pieces)


def build_shelf(space: Space, level: float, *, trim: bool) -> tuple[Primitive, ...]:
    """A glass shelf across a cabinet at a height, with a moulding along its front edge."""
    thickness = choose_thickness(space, 0.007)
    (x0, x1), (y0, y1) = space.x, space.y
    edge = x0 + 0.016 if trim else x0
    pane = box((edge, y0, level - thickness), (x1, y1, level), "clear")
    if not trim:
        return (pane,)
    return pane, box((x0, y0, level - thickness - 0.004), (edge, y1, level + 0.002), "plastic")


def build_crisper(space: Space, finish: str) -> tuple[Primitive, ...]:
    """A tub with a grip along the upper edge of its front."""
    wall = choose_thickness(space, 0.006)
    x, z = (space.x[0] - 1.2 * wall - 0.004, space.x[0]), (space.z[1] - 0.026, space.z[1])
    lip = block(x, narrow(space.y, 0.015), z, finish)
    return (*build_tub(space, wall, finish), lip)


def make_crispers(
    space: Space, count: int, *, stem: str, label: PartLabel, finish: str, needs: tuple[Need, ...]
) -> list[ShapePart]:
    """Tubs side by side that fill a space, except for the clearance between them."""
    out = []
    for k, y in enumerate(reversed(divide_range(space.y, count, GAP))):
        tub = Space(x=space.x, y=y, z=(space.z[0] + GAP, space.z[1]))
        solids, motion = build_crisper(tub, finish), slide(0.68 * tub.depth)
        out.append(ShapePart(f"{stem}_{k}", label, solids, motion, needs=needs))
    return out


def build_freezer_drawer(panel: Panel, space: Space, *, bevel: float) -> tuple[Primitive, ...]:
    """An insulated front with a basket on its rear side."""
    wall = choose_thickness(space, 0.008)
    low = space.z[0] + 0.012
    tub = Space(
        x=(panel.back, space.x[1] - 0.03), y=narrow(space.y, ROOM), z=(low, low + 0.72 * (space.z[1] - low))
    )
    return (
        *build_leaf(panel, (space.y, space.z), "front", "inside", bevel=bevel),
        *build_tub(tub, wall, "plastic"),
    )


def draw_shelves_and_crispers(
    rng: np.random.Generator,
    space: Space,
    *,
    stem: str,
    bins: float,
    crispers: Range | None,
    needs: tuple[Need, ...],
    full: bool,
) -> tuple[list[ShapePart], list[ShapePart]]:
    """Draws the contents of a compartment: shelves at uneven heights, tubs at its bottom.

    Args:
        rng: Random generator.
        space: Free space.
        stem: Prefix that makes the names of its parts unique.
        bins: Depth (m) of the bins on the doors.
        crispers: Range of y in which tubs clear the open doors; None for no tubs.
        needs: Parts that must be open before a tub slides.
        full: Whether tubs fill the compartment, as in freezers.

    Returns:
        The shelves and the sliding parts.
    """
    front = space.x[0] + bins + (0.03 if bins else 0.045)
    pane = choose_thickness(space, 0.007)
    levels: list[float] = []
    sliding: list[ShapePart] = []
    bottom = space.z[0]
    if crispers is not None and rng.random() < 0.6 and space.height > 0.36:
        rows, tall = 1, choose(rng, 0.15, 0.22)
        if full and space.height > 0.5:
            rows = min(int(space.height / rng.uniform(0.19, 0.26)), 5)
            tall = (space.height - 0.02) / rows - 0.012 - pane
        count = 2 if crispers[1] - crispers[0] > 0.5 and rng.random() < 0.6 and rows == 1 else 1
        label: PartLabel = "drawer" if rng.random() < 0.7 else "tray"
        finish = "clear" if rng.random() < 0.5 else "plastic"
        for row in range(rows):
            tub = Space(x=(space.x[0] + 0.036, space.x[1] - 0.015), y=crispers, z=(bottom, bottom + tall))
            sliding += make_crispers(
                tub, count, stem=f"crisper_{stem}_{row}", label=label, finish=finish, needs=needs
            )
            if row < rows - 1 or rows == 1:
                levels.append(bottom + tall + 0.008 + pane)
            bottom += tall + 0.009 + pane  # mouldings protrude by a millimetre
    room = space.z[1] - 0.14 - bottom
    wanted = min(int(room / rng.uniform(0.20, 0.34)), 5 if crispers is None else 4)
    if room > 0.08 and wanted > 0:
        levels += [top for _, top in divide_range((bottom, bottom + room), wanted, 0.0)]
    trim = crispers is not None and not (full and len(levels) > 3)
    shelves = []
    for k, level in enumerate(levels):
        # Low shelves are below the bins and extend further forward.
        x = (front if level > space.z[0] + LOW else space.x[0] + 0.045, space.x[1])
        pieces = build_shelf(Space(x=x, y=space.y, z=space.z), level, trim=trim)
        shelves.append(ShapePart(f"shelf_{stem}_{k}", "shelf", pieces))
    return shelves, sliding
