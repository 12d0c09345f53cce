"""A cabinet in a given box: its design, shared with its neighbours, its carcass and its cells."""

from dataclasses import replace

import numpy as np

from artigen.shapes.assembly import Assembly
from artigen.shapes.fittings.hardware import GAP, Edge, Space
from artigen.shapes.furniture.carcass import FRAME_DEPTH, make_carcass, open_carcass, widen
from artigen.shapes.furniture.cells import Fitting, furnish_cells
from artigen.shapes.furniture.looks import Looks
from artigen.shapes.furniture.splits import FRONT_GAP, Cell, Node, Room, Taste, draw_node, lay_out
from artigen.types import PartLabel

FACED = ("drawer", "door", "double", "drop", "lift", "fold")
"""Fillings whose fronts lie before the body instead of within it."""
MAX_DRAWERS_ON_RUNNERS = 5
OVERLAY = 0.012
"""Overlap (m) of fronts with the stiles and rails of a face frame."""


def draw_layout(rng: np.random.Generator, outer: Space, looks: Looks, taste: Taste) -> Node:
    """Draws the layout of the front of a cabinet of this size."""
    y, z = open_carcass(outer, looks.carcass)
    return draw_node(rng, Room(width=y[1] - y[0], height=z[1] - z[0], bottom=z[0]), taste)


def list_cells(node: Node) -> list[Cell]:
    """The cells of a layout, in order."""
    return (
        [node] if isinstance(node, Cell) else [cell for child in node.children for cell in list_cells(child)]
    )


def count_fronts(node: Node) -> dict[PartLabel, int]:
    """Number of drawers and of doors of a layout."""
    fills = [cell.fill for cell in list_cells(node)]
    doors = sum(
        {"open": 0, "blank": 0, "drawer": 0, "double": 2, "fold": 2, "slide": 2}.get(fill, 1)
        for fill in fills
    )
    return {"drawer": fills.count("drawer"), "door": doors}


def has_fronts(node: Node) -> bool:
    """Whether a layout has fronts before the body."""
    return any(cell.fill in FACED for cell in list_cells(node))


def make_cabinet(node: Node, outer: Space, looks: Looks, *, prefix: str = "") -> Assembly:
    """Builds a layout into a box whose front is the face of the fronts, handles excluded.

    Args:
        node: The layout.
        outer: The box, including the thickness of the fronts.
        looks: Design.
        prefix: Makes the names of parts unique among several cabinets.
    """
    body_x = outer.x[0]
    if has_fronts(node) and not looks.inset:
        body_x += looks.thickness + GAP
    body = replace(outer, x=(body_x, outer.x[1]))
    design = looks.carcass
    placed, boards = lay_out(
        node,
        *open_carcass(outer, design),
        board=design.frame or design.inner,
        reach=_reach_of_fronts(looks),
        inset=looks.inset,
        overlay=OVERLAY if design.frame else None,
    )
    placed = tuple(replace(cell, room_y=widen(cell.y, cell.z, outer, design, boards)[0]) for cell in placed)
    drawers = sum(cell.cell.fill == "drawer" for cell in placed)
    looks = replace(looks, runners=looks.runners and drawers <= MAX_DRAWERS_ON_RUNNERS)
    fitting = Fitting(
        **vars(looks),
        front_x=outer.x[0],
        body=(body_x, outer.x[1] - design.back - design.recess),
        frame=FRAME_DEPTH if design.frame else 0.0,
    )
    cells = furnish_cells(placed, fitting, prefix)
    solids = make_carcass(body, design, boards)
    return Assembly((*solids, *cells.pieces), cells.parts)


def _reach_of_fronts(looks: Looks) -> dict[Edge, float]:
    """Extent of fronts beyond the opening at the carcass' edges."""
    if looks.inset:
        return {"left": -GAP, "right": -GAP, "top": -GAP, "bottom": -GAP}
    if looks.carcass.frame:
        return dict.fromkeys(("left", "right", "top", "bottom"), OVERLAY)
    side = looks.carcass.board - looks.margin
    return {"left": side, "right": side, "top": side if looks.carcass.lid else -FRONT_GAP, "bottom": side}
