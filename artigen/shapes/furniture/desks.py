"""Desks: a top on pedestals, side panels or legs."""

from dataclasses import replace

import numpy as np

from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose
from artigen.shapes.fittings.hardware import Space
from artigen.shapes.fittings.legs import make_legs
from artigen.shapes.furniture.cabinet import draw_layout, make_cabinet
from artigen.shapes.furniture.framed_tables import TablePlan, hang_drawers, make_plain_top
from artigen.shapes.furniture.splits import Node, Taste
from artigen.shapes.primitives import block
from artigen.shapes.shape import ShapePart

PEDESTAL = Taste(
    module=(0.3, 0.7),
    drawer=(0.1, 0.3),
    rules=(("stack", 3.0), ("drawer_row", 1.5), ("closed", 1.2), ("open_row", 0.5)),
    fills=(("door", 3.0), ("double", 1.0)),
    trays=0.05,
)


def build_desk(rng: np.random.Generator, plan: TablePlan) -> Assembly:
    """A top on pedestals, side panels or legs, with a modesty board and sometimes drawers between them."""
    width, depth, height = plan.size
    high = height - plan.top
    reach = plan.looks.reach
    x, y = (reach - depth / 2, depth / 2), (0.015 - width / 2, width / 2 - 0.015)
    wide = choose(rng, 0.32, 0.46) * float(np.clip(width / 1.3, 0.85, 1.1))
    both = width > 1.25 and rng.random() < 0.5
    built = Assembly(make_plain_top(plan))
    lifted = float(rng.choice((0.0, 0.06, 0.12)))
    spans = [(y[1] - wide, y[1]), (y[0], y[0] + wide)] if both else [(y[1] - wide, y[1])]
    first: Node | None = None
    for index, span in enumerate(spans):
        space = Space(x=x, y=span, z=(lifted, high))
        looks = replace(plan.looks, carcass=replace(plan.looks.carcass, lid=lifted > 0))
        node = first if first is not None and rng.random() < 0.6 else draw_layout(rng, space, looks, PEDESTAL)
        first = node
        built += make_cabinet(node, space, looks, prefix="ab"[index])
        if lifted:
            under = (x[0] + 0.03, x[1])
            built += Assembly(make_legs(under, span, lifted, kind=plan.leg, width=0.04, finish="leg"))
    free = (y[0] + wide if both else y[0], y[1] - wide)
    if not both:
        board = 0.03 if rng.random() < 0.5 else plan.leg_width
        end, deep = (y[0], y[0] + board), (x[0] + 0.02, x[1])
        if board == 0.03:
            built += Assembly((block(deep, end, (0.0, high), "body"),))
        else:
            across = (y[0], y[0] + 3 * board)
            legs = make_legs(deep, across, high, kind="square", width=board, finish="leg")
            built += Assembly(legs[::2])
        free = (end[1], free[1])
    if rng.random() < 0.7:
        low = high - choose(rng, 0.2, 0.4)
        board = Space(x=(x[1] - 0.06, x[1] - 0.042), y=free, z=(low, high))
        built += Assembly((board.fill("body"),))
    if rng.random() < 0.45 and free[1] - free[0] > 0.35:
        space = Space(x=(x[0], x[1] - 0.1), y=free, z=(high - choose(rng, 0.09, 0.12), high))
        count = 2 if free[1] - free[0] > 0.9 and rng.random() < 0.6 else 1
        hung = hang_drawers(count, space, plan.looks, rng)
        built += Assembly(hung.pieces, [_rename(part, "c") for part in hung.parts])
    return built


def _rename(part: ShapePart, tag: str) -> ShapePart:
    parent = part.parent if part.parent == "body" else f"{tag}_{part.parent}"
    return replace(part, name=f"{tag}_{part.name}", parent=parent)
