"""A cabinet in a given box: its design, shared with its neighbours, its carcass and its cells."""

from dataclasses import dataclass, replace
from math import radians

import numpy as np

from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Wish
from artigen.shapes.fittings.drawers import BoxDesign
from artigen.shapes.fittings.fronts import FrontDesign, design_front
from artigen.shapes.fittings.handles import design_handle
from artigen.shapes.fittings.hardware import GAP, Edge, Space
from artigen.shapes.furniture.carcass import FRAME_DEPTH, CarcassDesign, make_carcass, open_carcass, widen
from artigen.shapes.furniture.cells import Fitting, furnish_cells
from artigen.shapes.furniture.furniture_kinds import Style
from artigen.shapes.furniture.splits import FRONT_GAP, Cell, Node, Room, Taste, draw_node, lay_out
from artigen.types import PartLabel

FACED = ("drawer", "door", "double", "drop", "lift", "fold")
"""Fillings whose fronts lie before the body instead of within it."""
MAX_DRAWERS_ON_RUNNERS = 5
OVERLAY = 0.012
"""Overlap (m) of fronts with the stiles and rails of a face frame."""
PUSH_OPEN = 0.04
"""Probability of fronts without handles, which open when pushed."""


@dataclass(frozen=True, kw_only=True)
class Looks:
    """Design that the cabinets of one object share (metres, radians)."""

    doors: FrontDesign
    drawers: FrontDesign
    carcass: CarcassDesign
    box: BoxDesign
    thickness: float
    """Thickness of fronts."""
    inset: bool
    """Whether fronts lie within the carcass instead of before it."""
    swing: float
    wide_swing: float
    travel: float
    runners: bool
    lock: bool
    margin: float = 0.0005
    """Distance of fronts from the outline of the carcass."""

    @property
    def reach(self) -> float:
        """Protrusion of handles from the fronts."""
        return 0.0 if self.doors.handle is None else self.doors.handle.reach


def draw_looks(
    rng: np.random.Generator, style: Style, longest: float, wish: Wish, *, hand: float = 1.05
) -> Looks:
    """Draws a design in a style for an object whose longest edge is ``longest`` metres."""
    handles = wish.choose_handles(style.handles)
    handle = design_handle(rng, choose_one(rng, handles), longest=longest)
    front = choose_one(rng, style.doors)
    doors = replace(design_front(rng, front, handle=handle), hand=hand)
    # A leaf that opens past 90 degrees sweeps over the edge of its neighbour, where that has its handle.
    margin = 0.0 if handle.kind == "edge" else 0.006
    limit = 90.0 + np.degrees(np.arctan2(margin + 0.0025, handle.reach))
    angles = [angle for angle in (95.0, 100.0, 105.0, 110.0) if angle < limit]
    doors = replace(doors, handle=None) if rng.random() < PUSH_OPEN else doors
    return Looks(
        doors=doors,
        drawers=replace(doors, style=choose_one(rng, style.drawers)),
        carcass=CarcassDesign(
            board=choose(rng, 0.016, 0.022),
            inner=choose(rng, 0.015, 0.019),
            back=0.010 if longest > 1.4 else choose(rng, 0.006, 0.008),
        ),
        box=BoxDesign(rim=choose(rng, 0.55, 0.82)),
        thickness=choose(rng, 0.017, 0.021),
        inset=bool(rng.random() < style.inset),
        swing=radians(float(rng.choice(angles))),
        wide_swing=radians(float(rng.choice((95.0, 105.0, 110.0, 125.0, 155.0, 165.0)))),
        travel=choose(rng, 0.62, 0.84),
        runners=bool(rng.random() < 0.75),
        lock=bool(rng.random() < 0.08),
    )


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


def make_cabinet(
    node: Node, outer: Space, looks: Looks, *, parent: str = "body", prefix: str = ""
) -> Assembly:
    """Builds a layout into a box whose front is the face of the fronts, handles excluded.

    Args:
        node: The layout.
        outer: The box, including the thickness of the fronts.
        looks: Design.
        parent: Name of the part that the solids join and that carries all other parts.
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
    rooms = [widen(cell.y, cell.z, outer, design, boards) for cell in placed]
    placed = tuple(
        replace(cell, room_y=room[0], room_z=room[1]) for cell, room in zip(placed, rooms, strict=True)
    )
    drawers = sum(cell.cell.fill == "drawer" for cell in placed)
    fitting = Fitting(
        front_x=outer.x[0],
        thickness=looks.thickness,
        body=(body_x, outer.x[1] - design.back - design.recess),
        doors=looks.doors,
        drawers=looks.drawers,
        box=looks.box,
        parent=parent,
        swing=looks.swing,
        wide_swing=looks.wide_swing,
        travel=looks.travel,
        runners=looks.runners and drawers <= MAX_DRAWERS_ON_RUNNERS,
        lock=looks.lock,
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
