"""`Looks`: the design of fronts, carcass and drawers that the cabinets of one object share."""

from dataclasses import dataclass, replace
from math import radians

import numpy as np

from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Wish
from artigen.shapes.fittings.drawers import BoxDesign
from artigen.shapes.fittings.fronts import FrontDesign, design_front
from artigen.shapes.fittings.handles import design_handle
from artigen.shapes.furniture.carcass import CarcassDesign
from artigen.shapes.furniture.furniture_kinds import Style

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
    """Swing of doors with a neighbour on their hinged edge."""
    wide_swing: float
    """Swing of doors whose hinged edge is free."""
    travel: float
    """Travel of drawers, as a share of their depth."""
    runners: bool
    """Whether drawers run on visible rails; otherwise the box fills its opening."""
    lock: bool
    """Whether doors have a turning lock."""
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
    trim = choose_one(rng, style.trims)
    handle = design_handle(rng, choose_one(rng, handles), longest=longest, trim=trim)
    drawn, layout = choose_one(rng, style.doors), wish.layout
    front = (layout and layout.doors) or drawn
    arched = bool(rng.random() < style.arched)
    doors = replace(design_front(rng, front, handle=handle), hand=hand, arched=arched)
    # A leaf that opens past 90 degrees sweeps over the edge of its neighbour, where that has its handle.
    margin = 0.0 if handle.kind == "edge" else 0.006
    limit = 90.0 + np.degrees(np.arctan2(margin + 0.0025, handle.reach))
    angles = [angle for angle in (95.0, 100.0, 105.0, 110.0) if angle < limit]
    if rng.random() < PUSH_OPEN and layout is None:
        doors = replace(doors, handle=None)
    return Looks(
        doors=doors,
        drawers=replace(
            doors, style=(layout and layout.drawers) or choose_one(rng, style.drawers), arched=False
        ),
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
        lock=bool(rng.random() < 0.08) and layout is None,
    )
