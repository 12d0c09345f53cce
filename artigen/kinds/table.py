"""Table: dining and side tables, desks, coffee tables, consoles, kitchen islands with a sink, screw tables.

A table is a top on supports: a frame of legs with drawers, pedestals and panels side by side, a cabinet with
a basin, or a column with a round top on a screw.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from artigen.kind import NONE, Channel, Kind, Place, by_height, make, plurals
from artigen.kinds.storage_furniture import STYLES
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, pick
from artigen.shapes.draw import Draft, Outline, Size, Spans, Wish, choose_lengths, pick_nearest
from artigen.shapes.fittings.hardware import GAP, Space
from artigen.shapes.fittings.legs import make_legs
from artigen.shapes.furniture.cabinet import draw_layout, make_cabinet
from artigen.shapes.furniture.carcass import LAID_LAYOUTS, draw_fitting, open_carcass
from artigen.shapes.furniture.desks import build_desk
from artigen.shapes.furniture.framed_tables import TOPS, TablePlan, build_frame, make_plain_top
from artigen.shapes.furniture.furniture_kinds import STYLE_WORDS
from artigen.shapes.furniture.laid_tables import Underside, build_under_top
from artigen.shapes.furniture.layouts import Layout
from artigen.shapes.furniture.looks import Looks, draw_looks
from artigen.shapes.furniture.screw_table import build_screw_table
from artigen.shapes.furniture.sinks import TAP_HEIGHT, make_sink
from artigen.shapes.furniture.splits import Node, Taste, lay_out
from artigen.shapes.furniture.table_frames import TopKind, make_shelf
from artigen.shapes.primitives import block
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Table"
MAX_LAYOUTS = 60
PAINTED = 0.13
"""Probability of a painted table: most are of wood."""
OUTLINES: dict[Outline, tuple[TopKind, ...]] = {
    "round": ("ellipse",), "oval": ("oval", "ellipse"), "square": ("plain", "rounded"),
    "rectangle": ("plain", "rounded"),
}  # fmt: skip
"""Tops by their outline."""
UNDER_SINK = Taste(
    module=(0.42, 0.9),
    rules=(("columns", 1.0), ("closed", 1.5)),
    fills=(("door", 3.0), ("double", 3.0), ("drop", 0.3)),
    shelf_pitch=(2.0, 3.0),
    trays=0.0,
    levels=1,
)


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a table that meets the wish."""
    style = wish.style or pick(rng, {name: look.weight for name, look in STYLES.items() if not look.closed})
    kind = _choose_kind(rng, wish)
    finishes = draw_palette(rng, "furniture", style, painted=PAINTED)
    width, depth, height = choose_lengths(rng, wish, kind.spans)
    size = (width, width if kind.round and wish.depth is None else depth, height)

    def draw_parts(attempt: int) -> Assembly:
        plan = _draw_plan(wish.shared_stream(rng, attempt), style, size, wish)
        return kind.build(rng, plan) if wish.layout is None else _build_laid(plan, wish.layout)

    def suits(parts: Sequence[ShapePart]) -> bool:
        return wish.layout is not None or bool(wish.counts) or any(part.joint for part in parts)

    layouts = MAX_LAYOUTS if wish.layout is None else LAID_LAYOUTS
    return Draft(style, draw_fitting(CATEGORY, size, layouts, draw_parts, suits), finishes)


def _draw_plan(rng: np.random.Generator, style: str, size: Size, wish: Wish) -> TablePlan:
    look = STYLES[style]
    if not wish.handles and "knob" in look.handles and rng.random() < 0.45:  # most tables have small handles
        look = replace(look, handles=("knob",))
    if not wish.handles:  # under a top there is no room for a finger above a lip
        look = replace(look, handles=tuple(kind for kind in look.handles if kind != "edge"))
    looks = draw_looks(rng, look, max(size), wish)
    return TablePlan(
        size=size,
        looks=replace(looks, carcass=replace(looks.carcass, lid=False), lock=False, margin=GAP),
        top=choose(rng, 0.02, 0.04),
        leg=choose_one(rng, wish.choose_legs([kind for kind in look.legs if kind != "splayed"])),
        tops=tuple(TOPS) if wish.outline is None else OUTLINES[wish.outline],
        moulded=bool(rng.random() < look.moulded),
        leg_width=choose(rng, 0.04, 0.065) * float(np.clip(0.55 + 0.4 * max(size), 0.7, 1.25)),
    )


def _build_laid(plan: TablePlan, layout: Layout) -> Assembly:
    """A top on the columns of a given layout."""
    width, depth, height = plan.size
    under = Underside(
        x=(plan.looks.reach - depth / 2, depth / 2),
        y=around(0.0, width / 2 - 0.015),
        height=height - plan.top,
        looks=plan.looks,
        leg=plan.leg,
        width=0.04,
        lifted=layout.stand_height or 0.0,
    )
    return Assembly(make_plain_top(plan)) + build_under_top(layout.node, under)


def _build_sink(rng: np.random.Generator, plan: TablePlan) -> Assembly:
    """A worktop with a basin over a cabinet or an open frame; the height includes the tap."""
    width, depth, total = plan.size
    high = total - TAP_HEIGHT - plan.top
    x, y = (plan.looks.reach - depth / 2 + 0.005, depth / 2), around(0.0, width / 2)
    top = Space(x=around(0.0, depth / 2), y=y, z=(high, high + plan.top))
    if rng.random() < 0.25:
        legs = make_legs(x, y, high, kind="square", width=0.04, finish="leg")
        shelf = make_shelf(legs, choose(rng, 0.15, 0.3))
        return make_sink(rng, top, y) + Assembly(legs, (shelf,))
    foot = choose(rng, 0.08, 0.12)
    space = Space(x=x, y=y, z=(foot, high))
    node = draw_layout(rng, space, plan.looks, UNDER_SINK)
    cabinet = make_cabinet(node, space, plan.looks)
    sink = make_sink(rng, top, _widest_column(node, space, plan.looks))
    kick = (
        block((x[0] + 0.06, x[0] + 0.078), narrow(y, 0.02), (0.0, foot), "body"),
        block((x[1] - 0.03, x[1] - 0.012), narrow(y, 0.02), (0.0, foot), "body"),
    )
    return Assembly((*sink.pieces, *cabinet.pieces, *kick), (*cabinet.parts, *sink.parts))


def _widest_column(node: Node, space: Space, looks: Looks) -> Range:
    """The widest range of y without boards, for a basin."""
    edges = dict.fromkeys(("left", "right", "top", "bottom"), 0.0)
    y, z = open_carcass(space, looks.carcass)
    cells, _ = lay_out(node, y, z, board=looks.carcass.inner, reach=edges, inset=looks.inset)
    return max((cell.y for cell in cells), key=lambda span: round(span[1] - span[0], 6))


def _build_screw(rng: np.random.Generator, plan: TablePlan) -> Assembly:
    return build_screw_table(rng, plan.size, plan.top, turned=plan.leg in ("turned", "cabriole"))


@dataclass(frozen=True)
class _Kind:
    """A kind of table: weight, ranges of its size (m), and its builder."""

    weight: float
    spans: Spans
    build: Callable[[np.random.Generator, TablePlan], Assembly]
    round: bool = False


KINDS: dict[str, _Kind] = {
    "dining": _Kind(2.4, ((0.8, 2.0), (0.65, 1.0), (0.7, 0.78)), build_frame),
    "side": _Kind(2.8, ((0.35, 0.65), (0.32, 0.5), (0.42, 0.68)), build_frame),
    "coffee": _Kind(2.0, ((0.7, 1.3), (0.45, 0.75), (0.32, 0.5)), build_frame),
    "console": _Kind(2.0, ((0.8, 1.6), (0.3, 0.45), (0.7, 0.9)), build_frame),
    "desk": _Kind(2.4, ((0.95, 1.8), (0.5, 0.8), (0.7, 0.78)), build_desk),
    "sink": _Kind(0.4, ((0.55, 1.3), (0.52, 0.66), (1.09, 1.21)), _build_sink),
    "screw": _Kind(0.5, ((0.45, 0.9), (0.45, 0.9), (0.45, 0.78)), _build_screw, round=True),
}


def _choose_kind(rng: np.random.Generator, wish: Wish) -> _Kind:
    """Draws a kind whose sizes include the wished ones or are closest to them."""
    known = {
        name: kind
        for name, kind in KINDS.items()
        if not kind.round
        or (wish.outline in (None, "round") and not (wish.width and wish.depth and wish.width != wish.depth))
    }
    weights = {name: kind.weight for name, kind in known.items()}
    sizes = {name: kind.spans for name, kind in known.items()}
    return known[pick_nearest(rng, wish, weights, sizes)]


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "table",
        "desk",
        "dining table",
        "kitchen table",
        "coffee table",
        "side table",
        "end table",
        "console table",
        "writing desk",
        "writing table",
        "kitchen island",
        "workbench",
        "island",
        "console",
    ),
    hints=(),
    size=(
        by_height(0.45, 0.38, "coffee table"),
        by_height(0.75, 0.95, "desk, dining table"),
        by_height(0.65, note="side table"),
    ),
    deepest=np.inf,
    diagonal=(0.3, 3.5),
    build="board",
    stands="free",
    styles=tuple(STYLES),
    style_words={**STYLE_WORDS, "splayed legs": NONE, "angled legs": NONE},
    forms={
        "coffee table": ((0.8, 1.3), (0.5, 0.8), (0.35, 0.5)),
        "desk": ((1.0, 1.6), (0.55, 0.8), (0.72, 0.76)),
        "writing desk": ((1.0, 1.4), (0.5, 0.7), (0.72, 0.76)),
        "side table": ((0.4, 0.6), (0.4, 0.6), (0.45, 0.65)),
        "end table": ((0.4, 0.6), (0.4, 0.6), (0.45, 0.65)),
        "console table": ((0.9, 1.4), (0.3, 0.4), (0.75, 0.85)),
        "dining table": ((1.2, 2.0), (0.8, 1.0), (0.72, 0.77)),
        "kitchen table": ((1.1, 1.8), (0.75, 0.95), (0.72, 0.77)),
        "workbench": ((1.2, 1.8), (0.6, 0.75), (0.85, 0.92)),
        "kitchen island": ((1.0, 1.8), (0.6, 1.0), (0.88, 0.94)),
        "island": ((1.0, 1.8), (0.6, 1.0), (0.88, 0.94)),
        "console": ((0.9, 1.4), (0.3, 0.4), (0.75, 0.85)),
    },
    sizes=((0.25, 4.0), (0.2, 2.0), (0.25, 1.5)),
    bare="width",
    make=make(density={"wood_board": 580.0}),  # light tops
    makes={},
    feet=True,
    trade="furniture",
    synset="table.n.02",
    wikidata="Q14748",
    partnet=CATEGORY,
    body="furniture_body",
    places=(
        Place(role="sink", low=(0.5, 0.5, 1.05), high=(0.7, 1.35, 1.25), draws=((0.6, 0.9, 1.15),)),
        Place(role="table", low=(0.55, 0.75, 0.66), high=(1.1, 2.0, 0.84), draws=((0.8, 1.4, 0.75),)),
        Place(
            role="desk",
            low=(0.45, 0.95, 0.66),
            high=(0.9, 1.9, 0.82),
            draws=((0.7, 1.4, 0.74), (0.65, 1.2, 0.74)),
        ),
        Place(role="low table", low=(0.4, 0.65, 0.28), high=(0.9, 1.4, 0.56), draws=((0.55, 1.0, 0.42),)),
        Place(role="nightstand", low=(0.28, 0.3, 0.38), high=(0.52, 0.66, 0.72)),
    ),
    holds="things",
    open_front=None,
    lid_stays=False,
    colored=("top", "leg"),
    laid_out=True,
    channel=Channel(number=1, boards=("top",), round_door=False),
    word=1,
    draw=draw,
)
