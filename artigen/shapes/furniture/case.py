"""Case furniture: a cabinet on a stand, with or without a worktop."""

from dataclasses import dataclass, replace

import numpy as np

from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, pick
from artigen.shapes.draw import Size, Wish
from artigen.shapes.fittings.feet import StandDesign, StandKind, design_stand, make_stand
from artigen.shapes.fittings.hardware import Space
from artigen.shapes.fittings.mouldings import build_moulding
from artigen.shapes.furniture.cabinet import FACED, OVERLAY, has_fronts, list_cells, make_cabinet
from artigen.shapes.furniture.carcass import HULL_RATIO
from artigen.shapes.furniture.furniture_kinds import Mounting, Style
from artigen.shapes.furniture.layouts import Layout
from artigen.shapes.furniture.looks import Looks, draw_looks
from artigen.shapes.furniture.splits import Node
from artigen.shapes.primitives import block
from artigen.shapes.ranges import around

RAISED: tuple[StandKind, ...] = ("plinth", "toe_kick", "legs", "sled")
"""Stands of any height."""
INSET, FRAMED = 0.008, 0.025
"""Distances (m) of neighbouring fronts from which the board between them shows, and from which it is a face
frame: overlaying fronts are 3 mm apart, and boards are at most 22 mm thick."""
BACK_HULLS = 2
"""Hulls of a back along its longer edge."""
STILES = (0.03, 0.08)
"""Range of the width (m) of stiles and rails."""
CORNICE, MOULDED = 0.02, (0.03, 0.05)
"""Overhang of a moulded top, and the range of its thickness (m)."""
RECESSED = 0.8
"""Probability of a back between the sides with a hanging rail behind it."""


@dataclass(frozen=True, kw_only=True)
class CasePlan:
    """All choices of one object except its layout (lengths in metres)."""

    looks: Looks
    stand: StandDesign
    worktop: float
    """Thickness of the worktop; 0 for none."""
    overhang: tuple[float, float]
    """Overhang of the worktop, in front and at each side."""
    moulded: bool = False
    """Whether the worktop has a moulded edge; on a tall body it is a cornice."""


def draw_plan(rng: np.random.Generator, mounting: Mounting, style: Style, size: Size, wish: Wish) -> CasePlan:
    """Draws the choices for an object of a mounting, style and size.

    They are equal throughout a suite, in which cabinets made for a worktop have one.
    """
    looks = draw_looks(rng, style, max(size), wish, hand=mounting.hand)
    covered = bool(rng.random() < mounting.worktop) or (wish.suite is not None and mounting.rails > 0.0)
    overhang = (choose(rng, 0.0, 0.02), float(rng.choice((0.0, 0.012))))
    frame, recess = choose(rng, 0.036, 0.045), choose(rng, 0.012, 0.019)
    carcass = replace(
        looks.carcass,
        lid=not covered,
        rails=bool(rng.random() < mounting.rails),
        frame=frame if rng.random() < style.frame else 0.0,
        recess=recess if rng.random() < RECESSED else 0.0,
    )
    stand = design_stand(
        rng, pick(rng, wish.choose_stands(dict(mounting.stands))), size[2], wish.choose_legs(style.legs)
    )
    moulded = bool(rng.random() < style.moulded) and mounting.rails == 0.0 and wish.layout is None
    if moulded:
        carcass = replace(carcass, lid=False)
    plan = CasePlan(
        looks=replace(looks, carcass=carcass),
        stand=stand,
        worktop=choose(rng, *(MOULDED if moulded else (0.018, 0.04))) if covered or moulded else 0.0,
        overhang=(CORNICE, CORNICE) if moulded else overhang if covered else (0.0, 0.0),
        moulded=moulded,
    )
    return plan if wish.layout is None else _suit_layout(plan, wish.layout, size)


def _suit_layout(plan: CasePlan, layout: Layout, size: Size) -> CasePlan:
    """The plan with the stand, the worktop and the gaps between fronts that a layout states; its back is
    thick enough to leave hulls of the body for the boards of the layout."""
    looks, stand, worktop = plan.looks, plan.stand, plan.worktop
    back = max(looks.carcass.back, max(size) / (BACK_HULLS * HULL_RATIO))
    looks = replace(looks, carcass=replace(looks.carcass, back=back))
    if layout.stand_height is not None and stand.kind in RAISED:
        stand = replace(stand, height=layout.stand_height)
    if layout.worktop is not None:
        worktop = layout.worktop
        looks = replace(looks, carcass=replace(looks.carcass, lid=worktop == 0.0))
    if layout.gap is not None:
        framed = layout.gap >= FRAMED
        inset = looks.inset if framed else layout.gap >= INSET
        frame = float(np.clip(layout.gap + (0.0 if inset else 2 * OVERLAY), *STILES)) if framed else 0.0
        looks = replace(looks, inset=inset, carcass=replace(looks.carcass, frame=frame))
    overhang = plan.overhang if worktop else (0.0, 0.0)
    return replace(plan, looks=looks, stand=stand, worktop=worktop, overhang=overhang)


def place_case(plan: CasePlan, size: Size) -> Space:
    """The box of the cabinet in an object of a size: above the stand, below the worktop."""
    width, depth, height = size
    ahead, aside = plan.overhang
    return Space(
        x=(ahead - depth / 2, depth / 2),
        y=(aside - width / 2, width / 2 - aside),
        z=(plan.stand.height, height - plan.worktop),
    )


def build_case(plan: CasePlan, node: Node, size: Size) -> Assembly:
    """An object with the layout ``node``."""
    width, depth, height = size
    box, ahead, looks = place_case(plan, size), plan.overhang[0], plan.looks
    cells = list_cells(node)
    if any(cell.fill == "slide" for cell in cells):  # they run in the carcass
        looks = replace(looks, carcass=replace(looks.carcass, frame=0.0))
    if has_fronts(node):
        held = any(cell.handles != 0 for cell in cells if cell.fill in FACED)
        box = replace(box, x=(max(ahead, plan.looks.reach if held else 0.0) - depth / 2, depth / 2))
    cabinet = make_cabinet(node, box, looks)
    shell = cabinet.pieces[0].center[0] - cabinet.pieces[0].size[0] / 2  # where the sides begin
    stand = make_stand(plan.stand, (float(shell), box.x[1]), box.y)
    built = cabinet + stand
    if plan.worktop:
        x = (box.x[0] - ahead, depth / 2)
        y, z = around(0.0, width / 2), (box.z[1], height)
        top = build_moulding(x, y, z, CORNICE, "top") if plan.moulded else (block(x, y, z, "top", 0.002),)
        built += Assembly(top)
    return built
