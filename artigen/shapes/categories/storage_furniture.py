"""StorageFurniture: cabinets, dressers, wardrobes, sideboards, nightstands, bookcases, TV stands.

A kind of furniture is a size, a taste and what it stands on (`artigen.shapes.furniture.furniture_kinds`);
how its front is divided comes from the grammar of `artigen.shapes.furniture.splits`.
"""

from dataclasses import dataclass, replace

import numpy as np

from artigen.shapes.draw import CrowdedError, Draft, ShapeError, Wish, choose
from artigen.shapes.fittings.feet import StandDesign, design_stand, make_stand
from artigen.shapes.fittings.hardware import Space
from artigen.shapes.furniture.cabinet import (
    Looks,
    count_fronts,
    draw_layout,
    draw_looks,
    has_fronts,
    list_cells,
    make_cabinet,
)
from artigen.shapes.furniture.carcass import fits_engines
from artigen.shapes.furniture.furniture_kinds import KINDS, STYLES, Kind, Style
from artigen.shapes.furniture.splits import Node, pick
from artigen.shapes.primitives import rounded_box
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette
from artigen.types import PartLabel

CATEGORY = "StorageFurniture"
MAX_LAYOUTS = 100
RECESSED = 0.6
"""Chance of a back that lies within the sides, with a rail behind it."""
BODY = "body"


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """All choices of one object but its layout; lengths in metres."""

    looks: Looks
    stand: StandDesign
    worktop: float
    """Thickness; 0 without one."""
    overhang: tuple[float, float]
    """Of the worktop, in front and at each side."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """A piece of storage furniture that meets the wish.

    It is drawn again while engines could not hold it, and while nothing moves unless counts are wished for.
    """
    style = wish.style or pick(rng, {name: look.weight for name, look in STYLES.items()})
    if style not in STYLES:
        raise ShapeError(f"{CATEGORY}: style {style!r} is not known, expected one of {', '.join(STYLES)}")
    kind = _choose_kind(rng, wish, STYLES[style])
    finishes = tuple(sorted(draw_palette(rng, "furniture", style).items()))
    size = (
        choose(rng, *kind.width, wish.width),
        choose(rng, *kind.depth, wish.depth),
        choose(rng, *kind.height, wish.height),
    )
    for _ in range(MAX_LAYOUTS):
        parts = _build(rng, kind, _draw_plan(rng, kind, STYLES[style], size), size, wish)
        shown = not STYLES[style].closed or any(part.label == "door" for part in parts)
        moves = wish.counts or any(part.motion for part in parts)
        if shown and moves and fits_engines(parts):
            return Draft(style=style, parts=parts, finishes=finishes)
    raise CrowdedError(
        f"{CATEGORY}: none of {MAX_LAYOUTS} layouts of {size} m (width, depth, height) keeps within what "
        "engines hold; wish for a smaller one"
    )


def _choose_kind(rng: np.random.Generator, wish: Wish, style: Style) -> Kind:
    """A kind whose sizes include those wished for, or come nearest."""
    shown = [
        name
        for name, kind in KINDS.items()
        if not style.closed or dict(kind.taste.rules).get("closed", 0) > 0.5
    ]
    misses = {name: _miss(KINDS[name], wish) for name in shown}
    least = min(misses.values())
    return KINDS[pick(rng, {name: KINDS[name].weight for name in shown if misses[name] <= least})]


def _miss(kind: Kind, wish: Wish) -> float:
    """How far the wished sizes lie outside a kind's, in all (m)."""
    pairs = ((wish.width, kind.width), (wish.depth, kind.depth), (wish.height, kind.height))
    return sum(max(low - want, want - high, 0.0) for want, (low, high) in pairs if want is not None)


def _draw_plan(rng: np.random.Generator, kind: Kind, style: Style, size: tuple[float, float, float]) -> _Plan:
    looks = draw_looks(rng, style, max(size), kind.hand)
    covered = bool(rng.random() < kind.worktop)
    overhang = (float(rng.uniform(0.0, 0.02)), float(rng.choice((0.0, 0.012))))
    frame, recess = float(rng.uniform(0.036, 0.045)), float(rng.uniform(0.012, 0.019))
    carcass = replace(
        looks.carcass,
        lid=not covered,
        rails=bool(rng.random() < kind.rails),
        frame=frame if rng.random() < style.frame else 0.0,
        recess=recess if rng.random() < RECESSED else 0.0,
    )
    return _Plan(
        looks=replace(looks, carcass=carcass),
        stand=design_stand(rng, pick(rng, dict(kind.stands)), size[2]),
        worktop=float(rng.uniform(0.018, 0.04)) if covered else 0.0,
        overhang=overhang if covered else (0.0, 0.0),
    )


def _draw_wanted(rng: np.random.Generator, box: Space, looks: Looks, kind: Kind, wish: Wish) -> Node:
    """A layout, the first of `MAX_LAYOUTS` that has the drawers and doors wished for, or the last one."""
    wanted: list[tuple[PartLabel, int]] = [
        (label, count) for label, count in wish.counts if label in ("drawer", "door")
    ]
    node = draw_layout(rng, box, looks, kind.taste)
    for _ in range(MAX_LAYOUTS):
        held = count_fronts(node)
        if all(held[label] == count for label, count in wanted):
            break
        node = draw_layout(rng, box, looks, kind.taste)
    return node


def _build(
    rng: np.random.Generator, kind: Kind, plan: _Plan, size: tuple[float, float, float], wish: Wish
) -> tuple[ShapePart, ...]:
    """One layout of a plan in a size (width, depth, height)."""
    width, depth, height = size
    ahead, aside = plan.overhang
    box = Space(
        x=(ahead - depth / 2, depth / 2),
        y=(aside - width / 2, width / 2 - aside),
        z=(plan.stand.height, height - plan.worktop),
    )
    node = _draw_wanted(rng, box, plan.looks, kind, wish)
    looks = plan.looks
    if any(cell.fill == "slide" for cell in list_cells(node)):  # they run in the carcass, not behind a frame
        looks = replace(looks, carcass=replace(looks.carcass, frame=0.0))
    if has_fronts(node):
        box = replace(box, x=(max(ahead, plan.looks.reach) - depth / 2, depth / 2))
    cabinet = make_cabinet(node, box, looks, parent=BODY)
    shell = cabinet.primitives[0].center[0] - cabinet.primitives[0].size[0] / 2  # where the sides begin
    stand = make_stand(plan.stand, (float(shell), box.x[1]), box.y, parent=BODY)
    solids = [*cabinet.primitives, *stand.primitives]
    if plan.worktop:
        low = (box.x[0] - ahead, -width / 2, box.z[1])
        solids.append(rounded_box(low, (depth / 2, width / 2, height), 0.002, "top"))
    body = ShapePart(name=BODY, label="base", parent=None, primitives=tuple(solids))
    return (body, *cabinet.parts, *stand.parts)
