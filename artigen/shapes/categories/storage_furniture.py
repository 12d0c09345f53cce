"""StorageFurniture: cabinets, dressers, wardrobes, sideboards, nightstands, bookcases, TV stands.

A kind of furniture has sizes, a taste and stands (`artigen.shapes.furniture.furniture_kinds`); the grammar of
`artigen.shapes.furniture.splits` divides its front.
"""

from collections.abc import Sequence

import numpy as np

from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import pick
from artigen.shapes.draw import Draft, Wish, choose_lengths, pick_nearest
from artigen.shapes.fittings.hardware import Space
from artigen.shapes.furniture.cabinet import count_fronts, draw_layout
from artigen.shapes.furniture.carcass import LAID_LAYOUTS, draw_fitting
from artigen.shapes.furniture.case import build_case, draw_plan, place_case
from artigen.shapes.furniture.furniture_kinds import KINDS, STYLES, Kind, Style
from artigen.shapes.furniture.looks import Looks
from artigen.shapes.furniture.splits import Node
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette
from artigen.types import PartLabel

CATEGORY = "StorageFurniture"
MAX_LAYOUTS = 100


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a piece of storage furniture that meets the wish.

    It is redrawn while it exceeds the limits of engines and, unless counts are wished for, while nothing
    moves.
    """
    laid = wish.layout is not None
    style = wish.style or pick(
        rng, {name: look.weight for name, look in STYLES.items() if not (laid and look.closed)}
    )
    kind = _choose_kind(rng, wish, STYLES[style])
    finishes = draw_palette(rng, "furniture", style)
    size = choose_lengths(rng, wish, kind.spans)

    def draw_parts(attempt: int) -> Assembly:
        plan = draw_plan(wish.shared_stream(rng, attempt), kind, STYLES[style], size, wish)
        if wish.layout is not None:
            return build_case(plan, wish.layout.node, size)
        node = _draw_wanted(rng, place_case(plan, size), plan.looks, kind, wish)
        return build_case(plan, node, size)

    def suits(parts: Sequence[ShapePart]) -> bool:
        shown = not STYLES[style].closed or any(part.label == "door" for part in parts)
        return shown and (laid or bool(wish.counts) or any(part.motion for part in parts))

    return Draft(
        style,
        draw_fitting(CATEGORY, size, MAX_LAYOUTS if wish.layout is None else LAID_LAYOUTS, draw_parts, suits),
        finishes,
    )


def _choose_kind(rng: np.random.Generator, wish: Wish, style: Style) -> Kind:
    """Draws a kind whose sizes include the wished ones or are closest to them."""
    weights = {name: kind.weight for name, kind in KINDS.items()}
    sizes = {
        name: kind.spans
        for name, kind in KINDS.items()
        if not style.closed or dict(kind.taste.rules).get("closed", 0) > 0.5
    }
    return KINDS[pick_nearest(rng, wish, weights, sizes)]


def _draw_wanted(rng: np.random.Generator, box: Space, looks: Looks, kind: Kind, wish: Wish) -> Node:
    """The first of `MAX_LAYOUTS` layouts with the wished numbers of drawers and doors, or the last one."""
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
