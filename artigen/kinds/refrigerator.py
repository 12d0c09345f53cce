"""Refrigerator: rows of compartments behind doors, pairs of doors, freezer drawers or glass doors."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from artigen.kind import Channel, Kind, Place, by_height, make, plurals
from artigen.shapes.appliances.appliance_doors import draw_grip
from artigen.shapes.appliances.cavity import build_feet, build_shell
from artigen.shapes.appliances.cold_doors import (
    ColdPlan,
    Compartment,
    Form,
    FrontKind,
    draw_doors,
    draw_glass_doors,
    make_drawer,
)
from artigen.shapes.appliances.cold_storage import draw_shelves_and_crispers
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose
from artigen.shapes.draw import Draft, Spans, Wish, choose_lengths, pick_nearest
from artigen.shapes.fittings.hardware import GAP, Edge, Panel, Space
from artigen.shapes.furniture.cabinet import list_cells
from artigen.shapes.furniture.laid_rows import LaidRow, list_rows
from artigen.shapes.primitives import Primitive, block
from artigen.shapes.ranges import Range, around, divide_range, narrow, share_down
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Refrigerator"
STYLES = ("steel", "white", "black", "retro")
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


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a refrigerator."""
    style = wish.style or str(rng.choice(STYLES, p=(0.48, 0.43, 0.05, 0.04)))
    palette = draw_palette(rng, "appliance", style)
    plan = _draw_plan(rng, wish)
    cells = _draw_cells(rng, plan) if wish.layout is None else _lay_cells(plan, list_rows(wish.layout.node))
    built = Assembly(tuple(_build_housing(plan, cells)))
    bare = rng.random() < 0.45  # nothing that moves behind solid doors
    moulded = bare or rng.random() < 0.12  # shelves that are part of the cabinet
    for index, cell in enumerate(cells):
        built += _draw_compartment(rng, plan, cell, f"{index}", moulded=moulded, bare=bare)
    return Draft(style, built.close(), palette)


def _draw_plan(rng: np.random.Generator, wish: Wish) -> ColdPlan:
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
    return ColdPlan(
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


def _lay_cells(plan: ColdPlan, rows: list[LaidRow]) -> list[Compartment]:
    """Compartments behind rows of fronts; of doors one above the other, all but the highest freeze."""
    y, z = plan.outer.y, (plan.floor, plan.outer.z[1])
    if plan.kind == "side_by_side":
        shares = rows[0].shares if len(rows[0].shares) == 2 else (1.0, 1.0)
        split = y[1] - shares[0] / sum(shares) * (y[1] - y[0])
        left = _make_cell(plan, (split, y[1]), z, frozen=True, front="door")
        return [left, _make_cell(plan, (y[0], split), z, frozen=False, front="door")]
    cells: list[Compartment] = []
    tallest = max(row.height for row in rows)
    for row, span in zip(rows, share_down(z, [row.height for row in rows]), strict=True):
        front: FrontKind = "drawer" if row.drawers else "pair" if row.paired else "door"
        front = "glass" if plan.kind == "display" else front
        made = _make_cell(plan, y, span, frozen=row.drawers or row.height < tallest, front=front)
        edge: Edge = "right" if row.cells[0].edge == "right" else "left"
        cells.append(replace(made, edge=edge, leaves=max(len(row.cells), 1 + row.paired)))
    return cells


def _draw_cells(rng: np.random.Generator, plan: ColdPlan) -> list[Compartment]:
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


def _make_cell(plan: ColdPlan, y: Range, z: Range, *, frozen: bool, front: FrontKind) -> Compartment:
    """The space behind a front, minus the outer walls and half of each partition to a neighbour."""
    outer, wall, half = plan.outer, plan.wall, 0.021
    left = wall if y[1] == outer.y[1] else half
    right = wall if y[0] == outer.y[0] else half
    top = wall if z[1] == outer.z[1] else half
    bottom = wall if z[0] == plan.floor else half
    x = (outer.x[0], outer.x[1] - wall - 0.04)
    space = Space(x=x, y=(y[0] + right, y[1] - left), z=(z[0] + bottom, z[1] - top))
    return Compartment(frozen=frozen, front=front, y=y, z=z, space=space)


def _build_housing(plan: ColdPlan, cells: list[Compartment]) -> list[Primitive]:
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
    rng: np.random.Generator, plan: ColdPlan, cell: Compartment, stem: str, *, moulded: bool, bare: bool
) -> Assembly:
    """Draws the fronts of a compartment and its contents."""
    seam = 0.003
    low = cell.z[0] + (0.0 if cell.z[0] == plan.floor else seam)
    high = cell.z[1] - (0.0 if cell.z[1] == plan.outer.z[1] else seam)
    if cell.front == "drawer":
        panel = Panel(x=plan.x, thickness=plan.thickness, y=cell.y, z=(low, high))
        return Assembly(parts=tuple(make_drawer(plan, cell, panel, stem)))
    if cell.front == "glass":
        fronts, needs, free, bins = draw_glass_doors(rng, plan, cell, (low, high)), (), None, 0.0
    else:
        fronts, needs, free, bins = draw_doors(rng, plan, cell, (low, high), stem)
    free = None if bare else free
    full = cell.frozen and not bins
    shelves, sliding = draw_shelves_and_crispers(
        rng, cell.space, stem=stem, bins=bins, crispers=free, needs=needs, full=full
    )
    if moulded:
        pieces = tuple(piece for shelf in shelves for piece in shelf.primitives)
        return Assembly(pieces, (*fronts, *sliding))
    return Assembly(parts=(*fronts, *sliding, *shelves))


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
    bare="width",
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
