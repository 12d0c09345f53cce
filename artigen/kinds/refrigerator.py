"""Refrigerator: rows of compartments behind doors, pairs of doors, freezer drawers or glass doors."""

from dataclasses import dataclass, replace
from itertools import pairwise
from math import radians
from typing import Literal

import numpy as np

from artigen.kind import Channel, Kind, Place, by_height, make, plurals
from artigen.shapes.appliances.appliance_doors import build_window_leaf, draw_grip, mount_grip
from artigen.shapes.appliances.cavity import build_feet, build_shell
from artigen.shapes.appliances.cold_storage import (
    LOW,
    build_cold_leaf,
    build_freezer_drawer,
    draw_shelves_and_crispers,
    plan_bins,
    reach_inwards,
)
from artigen.shapes.appliances.control_panel import build_badge
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose
from artigen.shapes.draw import Draft, Spans, Wish, choose_lengths, pick_nearest
from artigen.shapes.fittings.handles import HandleDesign
from artigen.shapes.fittings.hardware import GAP, Edge, Panel, Space, hinge, slide, sweep_gap
from artigen.shapes.furniture.cabinet import list_cells
from artigen.shapes.furniture.laid_rows import LaidRow, list_rows
from artigen.shapes.primitives import Primitive, block
from artigen.shapes.ranges import Range, around, divide_range, narrow, share_down
from artigen.shapes.shape import Need, ShapePart
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Refrigerator"
STYLES = ("steel", "white", "black", "retro")
BADGE_DROP = 0.055
"""Distance (m) of the maker's plate from the top of the highest door."""
Form = Literal[
    "single", "mini", "top_freezer", "bottom_freezer", "drawer", "side_by_side", "french", "display"
]
FrontKind = Literal["door", "pair", "drawer", "glass"]
FORMS: dict[Form, float] = {
    "single": 0.12,
    "mini": 0.13,
    "top_freezer": 0.18,
    "bottom_freezer": 0.15,
    "drawer": 0.10,
    "side_by_side": 0.12,
    "french": 0.13,
    "display": 0.07,
}
SIZES: dict[Form, Spans] = {
    "single": ((0.54, 0.76), (0.56, 0.74), (1.15, 1.85)),
    "mini": ((0.44, 0.56), (0.44, 0.56), (0.48, 0.90)),
    "top_freezer": ((0.54, 0.80), (0.60, 0.80), (1.34, 1.80)),
    "bottom_freezer": ((0.54, 0.80), (0.60, 0.80), (1.55, 2.00)),
    "drawer": ((0.60, 0.86), (0.64, 0.82), (1.60, 1.84)),
    "side_by_side": ((0.83, 0.95), (0.68, 0.86), (1.70, 1.84)),
    "french": ((0.76, 0.94), (0.70, 0.88), (1.68, 1.84)),
    "display": ((0.48, 1.60), (0.50, 0.72), (0.85, 2.00)),
}
"""Width, depth without handles, and height."""


@dataclass(frozen=True, kw_only=True)
class _Cell:
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
class _Plan:
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


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a refrigerator."""
    style = wish.style or str(rng.choice(STYLES, p=(0.46, 0.35, 0.14, 0.05)))
    palette = draw_palette(rng, "appliance", style)
    plan = _draw_plan(rng, wish)
    cells = _draw_cells(rng, plan) if wish.layout is None else _lay_cells(plan, list_rows(wish.layout.node))
    built = Assembly(tuple(_build_housing(plan, cells)))
    bare = rng.random() < 0.45  # nothing that moves behind solid doors
    moulded = bare or rng.random() < 0.12  # shelves that are part of the cabinet
    for index, cell in enumerate(cells):
        built += _draw_compartment(rng, plan, cell, f"{index}", moulded=moulded, bare=bare)
    return Draft(style, built.close(), palette)


def _draw_plan(rng: np.random.Generator, wish: Wish) -> _Plan:
    kind = (
        pick_nearest(rng, wish, FORMS, SIZES)
        if wish.layout is None
        else _name_form(list_rows(wish.layout.node))
    )
    width, depth, height = choose_lengths(rng, wish, SIZES[kind])
    thickness = choose(rng, *((0.045, 0.055) if kind in ("mini", "display") else (0.052, 0.072)))
    foot = choose(rng, 0.015, 0.028)
    floor = foot + choose(rng, *((0.0, 0.012) if kind == "mini" else (0.03, 0.08)))
    x = -depth / 2
    longest = max(width, depth, height)
    kinds = (
        ("bar", "bar", "bar", "pull", "pull", "arch", "edge")
        if kind != "display"
        else ("bar", "pull", "edge")
    )
    length = choose(rng, 0.3, 0.8) * min(1.0, height)
    offered = replace(wish, layout=None).choose_handles(kinds)
    grip = draw_grip(rng, offered, length=length, longest=longest)
    return _Plan(
        kind=kind,
        outer=Space(x=(x + thickness + GAP, depth / 2), y=around(0.0, width / 2), z=(foot, height)),
        floor=floor,
        x=x,
        thickness=thickness,
        wall=choose(rng, *((0.032, 0.040) if kind == "mini" else (0.038, 0.055))),
        longest=longest,
        edge="left" if rng.random() < 0.35 else "right",
        bevel=choose(rng, 0.004, 0.018) if rng.random() < 0.8 else 0.0,
        grip=grip if _has_grips(rng, wish) else None,
    )


def _has_grips(rng: np.random.Generator, wish: Wish) -> bool:
    usual = rng.random() < 0.86
    return usual if wish.layout is None else any(cell.handles for cell in list_cells(wish.layout.node))


def _name_form(rows: list[LaidRow]) -> Form:
    """The form of a refrigerator with these rows of fronts."""
    if all(cell.pane for row in rows for cell in row.cells):
        return "display"
    if len(rows) == 1:
        return "side_by_side" if rows[0].paired else "single"
    if rows[0].paired:
        return "french"
    if any(row.drawers for row in rows):
        return "drawer"
    return "top_freezer" if rows[0].height < rows[-1].height else "bottom_freezer"


def _lay_cells(plan: _Plan, rows: list[LaidRow]) -> list[_Cell]:
    """Compartments behind rows of fronts; of doors one above the other, all but the highest freeze."""
    y, z = plan.outer.y, (plan.floor, plan.outer.z[1])
    if plan.kind == "side_by_side":
        shares = rows[0].shares if len(rows[0].shares) == 2 else (1.0, 1.0)
        split = y[1] - shares[0] / sum(shares) * (y[1] - y[0])
        left = _make_cell(plan, (split, y[1]), z, frozen=True, front="door")
        return [left, _make_cell(plan, (y[0], split), z, frozen=False, front="door")]
    cells: list[_Cell] = []
    tallest = max(row.height for row in rows)
    for row, span in zip(rows, share_down(z, [row.height for row in rows]), strict=True):
        front: FrontKind = "drawer" if row.drawers else "pair" if row.paired else "door"
        front = "glass" if plan.kind == "display" else front
        made = _make_cell(plan, y, span, frozen=row.drawers or row.height < tallest, front=front)
        edge: Edge = "right" if row.cells[0].edge == "right" else "left"
        cells.append(replace(made, edge=edge, leaves=max(len(row.cells), 1 + row.paired)))
    return cells


def _draw_cells(rng: np.random.Generator, plan: _Plan) -> list[_Cell]:
    """Splits the front into rows and columns, from the top left on."""
    y, z = plan.outer.y, (plan.floor, plan.outer.z[1])
    share = choose(rng, 0.26, 0.40)
    if plan.kind in ("single", "mini", "display"):
        return [_make_cell(plan, y, z, frozen=False, front="glass" if plan.kind == "display" else "door")]
    if plan.kind == "side_by_side":
        split = y[1] - choose(rng, 0.38, 0.5) * (y[1] - y[0])
        left = _make_cell(plan, (split, y[1]), z, frozen=True, front="door")
        return [left, _make_cell(plan, (y[0], split), z, frozen=False, front="door")]
    first = plan.kind == "top_freezer"
    cut = z[1] - share * (z[1] - z[0]) if first else z[0] + share * (z[1] - z[0])
    front: FrontKind = "pair" if plan.kind == "french" else "door"
    upper, low = _make_cell(plan, y, (cut, z[1]), frozen=first, front=front), (z[0], cut)
    if plan.kind in ("top_freezer", "bottom_freezer"):
        return [upper, _make_cell(plan, y, low, frozen=not first, front="door")]
    if plan.kind == "french" and rng.random() < 0.25:
        return [upper, _make_cell(plan, y, low, frozen=True, front="pair")]
    count = 2 if cut - z[0] > 0.5 or rng.random() < 0.3 else 1
    rows = reversed(divide_range(low, count, 0.0))
    return [upper, *(_make_cell(plan, y, row, frozen=True, front="drawer") for row in rows)]


def _make_cell(plan: _Plan, y: Range, z: Range, *, frozen: bool, front: FrontKind) -> _Cell:
    """The space behind a front, minus the outer walls and half of each partition to a neighbour."""
    outer, wall, half = plan.outer, plan.wall, 0.021
    left = wall if y[1] == outer.y[1] else half
    right = wall if y[0] == outer.y[0] else half
    top = wall if z[1] == outer.z[1] else half
    bottom = wall if z[0] == plan.floor else half
    x = (outer.x[0], outer.x[1] - wall - 0.04)
    space = Space(x=x, y=(y[0] + right, y[1] - left), z=(z[0] + bottom, z[1] - top))
    return _Cell(frozen=frozen, front=front, y=y, z=z, space=space)


def _build_housing(plan: _Plan, cells: list[_Cell]) -> list[Primitive]:
    """Walls, partitions between compartments, feet, and the grille below the fronts."""
    outer, spaces = plan.outer, [cell.space for cell in cells]
    hollow = Space(
        x=spaces[0].x,
        y=(min(s.y[0] for s in spaces), max(s.y[1] for s in spaces)),
        z=(min(s.z[0] for s in spaces), max(s.z[1] for s in spaces)),
    )
    pieces = list(build_shell(outer, hollow, "body", "inside", bevel=min(plan.bevel, 0.005)))
    for one, other in pairwise(spaces):
        if one.y == other.y:
            pieces.append(block(one.x, one.y, (other.z[1], one.z[0]), "inside"))
        else:
            pieces.append(block(one.x, (other.y[1], one.y[0]), one.z, "inside"))
    if plan.floor - outer.z[0] > 0.025:
        span, finish = (outer.z[0], plan.floor - 0.006), "plastic" if plan.bevel else "rubber"
        pieces.append(block((plan.x + 0.02, outer.x[0]), narrow(outer.y, 0.01), span, finish))
    return [*pieces, *build_feet(outer.x, outer.y, outer.z[0], "rubber", radius=0.02, inset=0.03)]


def _draw_compartment(
    rng: np.random.Generator, plan: _Plan, cell: _Cell, stem: str, *, moulded: bool, bare: bool
) -> Assembly:
    """Draws the fronts of a compartment and its contents."""
    seam = 0.003
    low = cell.z[0] + (0.0 if cell.z[0] == plan.floor else seam)
    high = cell.z[1] - (0.0 if cell.z[1] == plan.outer.z[1] else seam)
    if cell.front == "drawer":
        panel = Panel(x=plan.x, thickness=plan.thickness, y=cell.y, z=(low, high))
        return Assembly(parts=tuple(_make_drawer(plan, cell, panel, stem)))
    if cell.front == "glass":
        fronts, needs, free, bins = _draw_glass_doors(rng, plan, cell, (low, high)), (), None, 0.0
    else:
        fronts, needs, free, bins = _draw_doors(rng, plan, cell, (low, high), stem)
    free = None if bare else free
    full = cell.frozen and not bins
    shelves, sliding = draw_shelves_and_crispers(
        rng, cell.space, stem=stem, bins=bins, crispers=free, needs=needs, full=full
    )
    if moulded:
        pieces = tuple(piece for shelf in shelves for piece in shelf.primitives)
        return Assembly(pieces, (*fronts, *sliding))
    return Assembly(parts=(*fronts, *sliding, *shelves))


def _draw_doors(
    rng: np.random.Generator, plan: _Plan, cell: _Cell, z: Range, stem: str
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


def _dispenses(rng: np.random.Generator, plan: _Plan, cell: _Cell) -> bool:
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


def _place_doors(plan: _Plan, cell: _Cell, z: Range) -> list[tuple[Panel, Edge]]:
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


def _mount(plan: _Plan, panel: Panel, edge: Edge, parent: str) -> list[ShapePart]:
    """A vertical handle near the free edge, as close to hand height as the door allows."""
    if plan.grip is None:
        return []
    half = min(plan.grip.length, 0.86 * panel.height) / 2
    margin = min(half + 0.04, panel.height / 2)
    level = float(np.clip(1.05, panel.z[0] + margin, panel.z[1] - margin))
    inset = 0.002 if plan.grip.kind == "edge" else 0.03
    return [mount_grip(panel, plan.grip, parent=parent, edge=edge, inset=inset, level=level)]


def _make_drawer(plan: _Plan, cell: _Cell, panel: Panel, stem: str) -> list[ShapePart]:
    name = f"drawer_{stem}"
    pieces = build_freezer_drawer(panel, cell.space, bevel=plan.bevel)
    drawer = ShapePart(name, "drawer", pieces, slide(0.7 * cell.space.depth))
    if plan.grip is None:
        return [drawer]
    inset = 0.002 if plan.grip.kind == "edge" else min(0.035, panel.height / 5)
    return [drawer, mount_grip(panel, plan.grip, parent=name, edge=None, inset=inset)]


def _draw_glass_doors(rng: np.random.Generator, plan: _Plan, cell: _Cell, z: Range) -> list[ShapePart]:
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


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "refrigerator",
        "fridge",
        "freezer",
        "fridge freezer",
        "mini fridge",
        "bar fridge",
        "upright freezer",
        "icebox",
        "wine cooler",
        "beverage cooler",
        "minibar",
    ),
    hints=(),
    size=(by_height(1.75),),
    deepest=0.8,
    diagonal=(0.5, 3.0),
    build="foam",
    stands="free",
    styles=tuple(STYLES),
    style_words={"vintage": "retro"},
    forms=dict.fromkeys(
        ("mini fridge", "minibar", "wine cooler", "bar fridge"), ((0.44, 0.56), (0.45, 0.58), (0.5, 0.9))
    ),
    sizes=((0.35, 1.9), (0.35, 1.1), (0.4, 2.4)),
    make=make(hidden=6.0, wall={"glass": 0.004}),  # compressor
    makes={},
    feet=True,
    trade="appliance",
    synset="refrigerator.n.01",
    wikidata="Q37828",
    partnet=CATEGORY,
    body="refrigerator_body",
    places=(
        Place(role="fridge", low=(0.5, 0.45, 1.3), high=(0.95, 1.4, 2.2), draws=((0.68, 0.7, 1.75),)),
        Place(role="small fridge", low=(0.4, 0.35, 0.45), high=(0.7, 0.65, 1.0)),
    ),
    holds="food",
    open_front=0.03,
    lid_stays=False,
    colored=(),
    laid_out=True,
    channel=Channel(number=2, boards=("top", "side", "back"), round_door=False),
    word=2,
    draw=draw,
)
