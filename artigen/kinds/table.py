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
from artigen.shapes.fittings.feet import make_castors
from artigen.shapes.fittings.hardware import GAP, Space, lift
from artigen.shapes.fittings.legs import LegKind, make_legs
from artigen.shapes.furniture.cabinet import draw_layout, make_cabinet
from artigen.shapes.furniture.carcass import LAID_LAYOUTS, draw_fitting, open_carcass
from artigen.shapes.furniture.furniture_kinds import STYLE_WORDS
from artigen.shapes.furniture.laid_tables import Underside, build_under_top
from artigen.shapes.furniture.layouts import Layout
from artigen.shapes.furniture.looks import Looks, draw_looks
from artigen.shapes.furniture.screw_table import build_screw_table
from artigen.shapes.furniture.sinks import TAP_HEIGHT, make_sink
from artigen.shapes.furniture.splits import Cell, Node, Split, Taste, lay_out
from artigen.shapes.furniture.table_frames import (
    PANEL,
    SIDES,
    STRETCHER_KINDS,
    WALL,
    TopKind,
    inset_of_ellipse,
    inset_of_oval,
    make_apron,
    make_arch,
    make_panels,
    make_shelf,
    make_stretchers,
    make_top,
    most_radius,
)
from artigen.shapes.primitives import Primitive, block
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Table"
MAX_LAYOUTS = 60
PAINTED = 0.13
"""Probability of a painted table: most are of wood."""
OVERHANGING, ARCHED, STRETCHED, CLOSED, GIRDED = 0.4, 0.2, 0.3, 0.2, 0.75
"""Probabilities of an overhanging top, arched aprons, stretchers, closed sides (twice for small tables), and
an apron around the drawers."""
TOPS: dict[TopKind, float] = {"plain": 0.72, "rounded": 0.1, "oval": 0.06, "ellipse": 0.12}
OUTLINES: dict[Outline, tuple[TopKind, ...]] = {
    "round": ("ellipse",), "oval": ("oval", "ellipse"), "square": ("plain", "rounded"),
    "rectangle": ("plain", "rounded"),
}  # fmt: skip
"""Tops by their outline."""
PEDESTAL = Taste(
    module=(0.3, 0.7),
    drawer=(0.1, 0.3),
    rules=(("stack", 3.0), ("drawer_row", 1.5), ("closed", 1.2), ("open_row", 0.5)),
    fills=(("door", 3.0), ("double", 1.0)),
    trays=0.05,
)
UNDER_SINK = Taste(
    module=(0.42, 0.9),
    rules=(("columns", 1.0), ("closed", 1.5)),
    fills=(("door", 3.0), ("double", 3.0), ("drop", 0.3)),
    shelf_pitch=(2.0, 3.0),
    trays=0.0,
    levels=1,
)


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """Choices that every kind of table is built from (m)."""

    size: Size
    looks: Looks
    top: float
    """Thickness of the top."""
    leg: LegKind
    leg_width: float
    tops: tuple[TopKind, ...]
    moulded: bool
    """Whether the edge of the top is moulded."""


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


def _draw_plan(rng: np.random.Generator, style: str, size: Size, wish: Wish) -> _Plan:
    look = STYLES[style]
    if not wish.handles and "knob" in look.handles and rng.random() < 0.45:  # most tables have small handles
        look = replace(look, handles=("knob",))
    if not wish.handles:  # under a top there is no room for a finger above a lip
        look = replace(look, handles=tuple(kind for kind in look.handles if kind != "edge"))
    looks = draw_looks(rng, look, max(size), wish)
    return _Plan(
        size=size,
        looks=replace(looks, carcass=replace(looks.carcass, lid=False), lock=False, margin=GAP),
        top=choose(rng, 0.02, 0.04),
        leg=choose_one(rng, wish.choose_legs([kind for kind in look.legs if kind != "splayed"])),
        tops=tuple(TOPS) if wish.outline is None else OUTLINES[wish.outline],
        moulded=bool(rng.random() < look.moulded),
        leg_width=choose(rng, 0.04, 0.065) * float(np.clip(0.55 + 0.4 * max(size), 0.7, 1.25)),
    )


def _make_top(plan: _Plan) -> tuple[Primitive, ...]:
    width, depth, height = plan.size
    return make_top(width, depth, (height - plan.top, height), "plain", 0.0, moulded=plan.moulded)


@dataclass(frozen=True, kw_only=True)
class _Footing:
    """The rectangle of a frame's legs, and the top over it (m)."""

    x: Range
    y: Range
    top: tuple[Primitive, ...]


def _draw_footing(rng: np.random.Generator, plan: _Plan) -> _Footing:
    """Places legs near the edges of the top or well within them, always below the top."""
    width, depth, height = plan.size
    ahead, aside = 0.0, 0.02
    if rng.random() < OVERHANGING:
        ahead, aside = choose(rng, 0.03, 0.08) * depth, choose(rng, 0.05, 0.11) * width
    edge = choose(rng, 0.0, 0.03) + plan.looks.reach + ahead
    behind = min(edge, 0.02 + ahead)
    fitting: list[TopKind] = [kind for kind in TOPS if kind != "oval" or width > 1.3 * depth]
    wished: list[TopKind] = [kind for kind in fitting if kind in plan.tops] or fitting
    kind: TopKind = pick(rng, {kind: TOPS[kind] for kind in wished})
    radius = choose(rng, 0.04, 0.12)
    if kind == "ellipse":
        edge, behind = max(edge, 0.13 * depth), max(behind, 0.13 * depth)
        aside = max(aside, inset_of_ellipse(width, depth, min(edge, behind)))
    if kind == "oval":
        edge, behind = max(edge, 0.08 * depth), max(behind, 0.08 * depth)
        aside = max(aside, inset_of_oval(depth, min(edge, behind)))
    radius = min(radius, most_radius(max(min(edge, behind), 0.001), aside))
    if kind == "rounded" and radius < 0.02:
        kind = "plain"
    return _Footing(
        x=(edge - depth / 2, depth / 2 - behind),
        y=(aside - width / 2, width / 2 - aside),
        top=make_top(width, depth, (height - plan.top, height), kind, radius, moulded=plan.moulded),
    )


def _build_frame(rng: np.random.Generator, plan: _Plan) -> Assembly:
    """Four legs under a top: drawers or an apron between them, a shelf or stretchers below, or castors."""
    width, _, height = plan.size
    low, high = 0.0, height - plan.top
    footing = _draw_footing(rng, plan)
    x, y = footing.x, footing.y
    built = Assembly(footing.top)
    rolling = high < 0.55 and rng.random() < 0.35
    long = rolling and width > 0.95 and rng.random() < 0.2  # three pairs of legs and no drawers
    if rolling:
        swivel, radius = bool(rng.random() < 0.3) or long, choose(rng, 0.022, 0.03)
        stand = make_castors(x, y, radius, swivel=swivel, pairs=3 if long else 2)
        low = stand.height
        built += stand
    leg = plan.leg_width
    upright = make_legs(x, y, high - low, kind=plan.leg, width=leg, finish="leg", middle=long)
    legs = lift(upright, low)
    built += Assembly(legs)
    closed = not long and rng.random() < (2 * CLOSED if width < 0.7 else CLOSED)
    inner = narrow(y, leg)
    room = inner[1] - inner[0]
    drawers = int(rng.choice(5, p=(0.15, 0.5, 0.22, 0.1, 0.03))) if width > 0.4 else 1
    drawers = min(max(drawers, int(np.ceil(room / 1.05))) if drawers and not long else 0, int(room / 0.24))
    deep = choose(rng, 0.085, min(0.15, 0.35 * (high - low) + 0.02))
    arch = choose(rng, 0.03, 0.06) if rng.random() < ARCHED and not long and room > 0.25 else 0.0
    behind = x[1] - max(0.25 * leg + WALL, 0.5 * leg + PANEL / 2)  # x of the rear boards
    if drawers:
        girded = closed or rng.random() < GIRDED
        back = min(x[0] + choose(rng, 0.45, 1.0) * (x[1] - x[0]), behind if girded else x[1])
        space = Space(x=(x[0], back), y=inner, z=(high - deep, high))
        built += _hang_drawers(drawers, space, plan.looks, rng)
        if girded and not closed:
            built += Assembly(make_apron(x, y, (high - deep, high), leg, sides=("back", "right", "left")))
        if arch:
            start = x[0] + max(plan.looks.thickness + GAP, 0.25 * leg)
            edge = (high - deep - 0.012, high - deep)
            built += Assembly(make_arch((start, start + WALL), inner, edge, arch))
    elif rng.random() < 0.75:
        sides = SIDES[:1] if closed else SIDES
        built += Assembly(make_apron(x, y, (high - 0.6 * deep, high), leg, sides=sides, arch=arch))
    at = low + choose(rng, 0.25, 0.4) * (high - low)
    shelved = rng.random() < (0.65 if high < 0.6 else 0.12)
    if shelved:
        built += Assembly(parts=(make_shelf(legs, at),))
    elif not long and rng.random() < STRETCHED:
        kind = choose_one(rng, STRETCHER_KINDS)
        built += Assembly(make_stretchers(legs, 0.7 * at + 0.3 * low, 0.48 * leg, kind))
    if closed:
        built += Assembly(make_panels(legs, (at + 0.02 if shelved else at, high)))
    return built


def _hang_drawers(count: int, space: Space, looks: Looks, rng: np.random.Generator) -> Assembly:
    """One or sometimes two rows of drawers in a low carcass."""
    drawer: Node = Cell(fill="drawer")
    if space.height > 0.17 and rng.random() < 0.3:
        drawer = Split(along="rows", shares=(1.0, 1.0), children=(drawer, drawer), board=False)
    node = drawer
    if count > 1:
        shares = (1.0,) * count if count != 3 or rng.random() < 0.6 else (1.0, 1.6, 1.0)
        node = Split(along="columns", shares=shares, children=(drawer,) * count)
    return make_cabinet(node, space, looks)


def _build_desk(rng: np.random.Generator, plan: _Plan) -> Assembly:
    """A top on pedestals, side panels or legs, with a modesty board and sometimes drawers between them."""
    width, depth, height = plan.size
    high = height - plan.top
    reach = plan.looks.reach
    x, y = (reach - depth / 2, depth / 2), (0.015 - width / 2, width / 2 - 0.015)
    wide = choose(rng, 0.32, 0.46) * float(np.clip(width / 1.3, 0.85, 1.1))
    both = width > 1.25 and rng.random() < 0.5
    built = Assembly(_make_top(plan))
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
        hung = _hang_drawers(count, space, plan.looks, rng)
        built += Assembly(hung.pieces, [_rename(part, "c") for part in hung.parts])
    return built


def _build_laid(plan: _Plan, layout: Layout) -> Assembly:
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
    return Assembly(_make_top(plan)) + build_under_top(layout.node, under)


def _rename(part: ShapePart, tag: str) -> ShapePart:
    parent = part.parent if part.parent == "body" else f"{tag}_{part.parent}"
    return replace(part, name=f"{tag}_{part.name}", parent=parent)


def _build_sink(rng: np.random.Generator, plan: _Plan) -> Assembly:
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


def _build_screw(rng: np.random.Generator, plan: _Plan) -> Assembly:
    return build_screw_table(rng, plan.size, plan.top, turned=plan.leg in ("turned", "cabriole"))


@dataclass(frozen=True)
class _Kind:
    """A kind of table: weight, ranges of its size (m), and its builder."""

    weight: float
    spans: Spans
    build: Callable[[np.random.Generator, _Plan], Assembly]
    round: bool = False


KINDS: dict[str, _Kind] = {
    "dining": _Kind(2.0, ((0.8, 2.0), (0.65, 1.0), (0.7, 0.78)), _build_frame),
    "side": _Kind(2.2, ((0.35, 0.65), (0.32, 0.5), (0.42, 0.68)), _build_frame),
    "coffee": _Kind(2.0, ((0.7, 1.3), (0.45, 0.75), (0.32, 0.5)), _build_frame),
    "console": _Kind(1.4, ((0.8, 1.6), (0.3, 0.45), (0.7, 0.9)), _build_frame),
    "desk": _Kind(3.4, ((0.95, 1.8), (0.5, 0.8), (0.7, 0.78)), _build_desk),
    "sink": _Kind(1.0, ((0.55, 1.3), (0.52, 0.66), (1.09, 1.21)), _build_sink),
    "screw": _Kind(1.1, ((0.45, 0.9), (0.45, 0.9), (0.45, 0.78)), _build_screw, round=True),
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
