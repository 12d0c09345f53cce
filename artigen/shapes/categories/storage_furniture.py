"""StorageFurniture: cabinets, dressers, wardrobes, sideboards, nightstands, bookcases, TV stands.

A kind of furniture is a size, a taste and what it stands on (`artigen.shapes.furniture_kinds`); how its front
is divided comes from the grammar of `artigen.shapes.splits`.
"""

from dataclasses import dataclass, replace
from math import radians

import numpy as np

from artigen.shapes.carcass import CarcassDesign, fits_engines, make_carcass, open_carcass
from artigen.shapes.cells import Fitting, furnish_cells
from artigen.shapes.draw import Draft, ShapeError, Wish, choose
from artigen.shapes.drawers import BoxDesign
from artigen.shapes.feet import StandDesign, design_stand, make_stand
from artigen.shapes.fronts import FrontDesign, design_front
from artigen.shapes.furniture_kinds import KINDS, STYLES, Kind, Style
from artigen.shapes.handles import design_handle
from artigen.shapes.hardware import GAP, Edge, Range, Space
from artigen.shapes.palette import draw_palette
from artigen.shapes.primitives import rounded_box
from artigen.shapes.shape import ShapePart
from artigen.shapes.splits import FRONT_GAP, Placed, Room, draw_node, lay_out, pick

CATEGORY = "StorageFurniture"
MAX_LAYOUTS = 60
BODY = "body"
FACED = ("drawer", "door", "double", "drop", "lift", "fold")
"""Fills whose fronts lie before the body, not within it."""


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """All choices of one object but its layout; lengths in metres."""

    doors: FrontDesign
    drawers: FrontDesign
    carcass: CarcassDesign
    stand: StandDesign
    thickness: float
    inset: bool
    worktop: float
    overhang: tuple[float, float]
    """Of the worktop, in front and at each side."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """A piece of storage furniture that meets the wish, drawn again while engines could not hold it."""
    style = wish.style or pick(rng, {name: look.weight for name, look in STYLES.items()})
    if style not in STYLES:
        raise ShapeError(f"{CATEGORY}: style {style!r} is not known, expected one of {', '.join(STYLES)}")
    kind = _choose_kind(rng, wish)
    finishes = tuple(sorted(draw_palette(rng, "furniture", style).items()))
    size = (
        choose(rng, *kind.width, wish.width),
        choose(rng, *kind.depth, wish.depth),
        choose(rng, *kind.height, wish.height),
    )
    for _ in range(MAX_LAYOUTS):
        parts = _build(rng, kind, _draw_plan(rng, kind, STYLES[style], size), size)
        if fits_engines(parts):
            return Draft(style=style, parts=parts, finishes=finishes)
    raise ShapeError(
        f"{CATEGORY}: none of {MAX_LAYOUTS} layouts of {size} m (width, depth, height) keeps within what "
        "engines hold; wish for a smaller one"
    )


def _choose_kind(rng: np.random.Generator, wish: Wish) -> Kind:
    """A kind whose sizes include those wished for, or come nearest."""
    misses = {name: _miss(kind, wish) for name, kind in KINDS.items()}
    least = min(misses.values())
    return KINDS[pick(rng, {name: kind.weight for name, kind in KINDS.items() if misses[name] <= least})]


def _miss(kind: Kind, wish: Wish) -> float:
    """How far the wished sizes lie outside a kind's, in all (m)."""
    pairs = ((wish.width, kind.width), (wish.depth, kind.depth), (wish.height, kind.height))
    return sum(max(low - want, want - high, 0.0) for want, (low, high) in pairs if want is not None)


def _draw_plan(rng: np.random.Generator, kind: Kind, look: Style, size: tuple[float, float, float]) -> _Plan:
    longest = max(size)
    handle = design_handle(rng, look.handles[int(rng.integers(len(look.handles)))], longest=longest)
    front = look.doors[int(rng.integers(len(look.doors)))]
    doors = replace(design_front(rng, front, handle=handle), hand=kind.hand)
    covered = bool(rng.random() < kind.worktop)
    carcass = CarcassDesign(
        board=float(rng.uniform(0.016, 0.022)),
        inner=float(rng.uniform(0.015, 0.019)),
        back=0.010 if longest > 1.4 else float(rng.uniform(0.006, 0.008)),
        lid=not covered,
    )
    overhang = (float(rng.uniform(0.0, 0.02)), float(rng.choice((0.0, 0.012))))
    return _Plan(
        doors=doors,
        drawers=replace(doors, style=look.drawers[int(rng.integers(len(look.drawers)))]),
        carcass=carcass,
        stand=design_stand(rng, pick(rng, dict(kind.stands)), size[2]),
        thickness=float(rng.uniform(0.017, 0.021)),
        inset=bool(rng.random() < look.inset),
        worktop=float(rng.uniform(0.018, 0.04)) if covered else 0.0,
        overhang=overhang if covered else (0.0, 0.0),
    )


def _build(
    rng: np.random.Generator, kind: Kind, plan: _Plan, size: tuple[float, float, float]
) -> tuple[ShapePart, ...]:
    """One layout of a plan in a size (width, depth, height)."""
    width, depth, height = size
    y = (plan.overhang[1] - width / 2, width / 2 - plan.overhang[1])
    z = (plan.stand.height, height - plan.worktop)
    opening = open_carcass(Space(x=(0.0, depth), y=y, z=z), plan.carcass)
    room = Room(
        width=opening[0][1] - opening[0][0], height=opening[1][1] - opening[1][0], bottom=opening[1][0]
    )
    node = draw_node(rng, room, kind.taste)
    placed, boards = lay_out(
        node, *opening, board=plan.carcass.inner, reach=_reach(plan.carcass, plan.inset), inset=plan.inset
    )
    faced = any(cell.cell.fill in FACED for cell in placed)
    handle = plan.doors.handle
    ahead = handle.reach if faced and handle else 0.0
    front_x = max(ahead, plan.overhang[0]) - depth / 2
    body_x = front_x + plan.thickness + GAP if faced and not plan.inset else front_x
    outer = Space(x=(body_x, depth / 2), y=y, z=z)

    stand = make_stand(plan.stand, outer.x, outer.y, parent=BODY)
    solids = [*make_carcass(outer, plan.carcass, boards), *stand.primitives]
    if plan.worktop:
        low = (front_x - plan.overhang[0], -width / 2, z[1])
        solids.append(rounded_box(low, (depth / 2, width / 2, height), 0.002, "top"))
    furnished = furnish_cells(placed, _draw_fitting(rng, plan, placed, front_x, outer))
    body = ShapePart(name=BODY, label="base", parent=None, primitives=(*solids, *furnished.primitives))
    return (body, *furnished.parts, *stand.parts)


def _reach(carcass: CarcassDesign, inset: bool) -> dict[Edge, float]:  # noqa: FBT001
    """How far fronts extend beyond the opening at the body's edges."""
    if inset:
        return {"left": -GAP, "right": -GAP, "top": -GAP, "bottom": -GAP}
    side = carcass.board - 0.0005
    return {"left": side, "right": side, "top": side if carcass.lid else -FRONT_GAP, "bottom": side}


def _draw_fitting(
    rng: np.random.Generator, plan: _Plan, placed: tuple[Placed, ...], front_x: float, outer: Space
) -> Fitting:
    body: Range = (outer.x[0], outer.x[1] - plan.carcass.back)
    drawers = sum(cell.cell.fill == "drawer" for cell in placed)
    # A door that opens further would meet the lip at the edge of its neighbour.
    at_edge = plan.doors.handle is not None and plan.doors.handle.kind == "edge"
    return Fitting(
        front_x=front_x,
        thickness=plan.thickness,
        body=body,
        doors=plan.doors,
        drawers=plan.drawers,
        box=BoxDesign(rim=float(rng.uniform(0.55, 0.82))),
        parent=BODY,
        swing=radians(95.0 if at_edge else float(rng.choice((95.0, 100.0, 105.0, 110.0)))),
        wide_swing=radians(float(rng.choice((95.0, 105.0, 110.0, 125.0, 155.0, 165.0)))),
        travel=float(rng.uniform(0.62, 0.84)),
        runners=bool(rng.random() < 0.4 and drawers <= 5),
        lock=bool(rng.random() < 0.08),
    )
