"""Dresser: a wide or tall chest of drawers for clothes on feet, sometimes with a cupboard.

Catalogue sizes (width by height): wide ones 1.1 to 1.8 m by 0.72 to 0.95 m, tall ones 0.7 to 1.05 m by 1.0 to
1.35 m, 0.42 to 0.53 m deep. Drawers are at most 1 m wide, for two hands.
"""

from dataclasses import dataclass, replace

import numpy as np

from artigen.kind import Kind, Place, by_height, make, plurals
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, choose_style
from artigen.shapes.draw import Draft, Size, Spans, Wish, choose_lengths
from artigen.shapes.fittings.feet import StandKind
from artigen.shapes.fittings.legs import LegKind
from artigen.shapes.furniture.carcass import LAID_LAYOUTS, draw_fitting
from artigen.shapes.furniture.case import build_case, draw_plan
from artigen.shapes.furniture.furniture_kinds import STYLES as LOOKS
from artigen.shapes.furniture.furniture_kinds import Mounting
from artigen.shapes.furniture.splits import Cell, Node, Split, join_cells, stack_drawers
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Dresser"
MAX_LAYOUTS = 100
WIDE = 1.1
"""Width (m) from which drawers are in columns."""


@dataclass(frozen=True, kw_only=True)
class _Look:
    """A style: fronts, handles, and feet."""

    weight: float
    fronts: str
    palettes: tuple[str, ...]
    stands: tuple[tuple[StandKind, float], ...]
    legs: tuple[LegKind, ...] = ("square", "tapered")


STYLES = {
    "modern": _Look(
        weight=3, fronts="flat", palettes=("flat",), stands=(("plinth", 2), ("legs", 1.5), ("sled", 1))
    ),
    "midcentury": _Look(
        weight=2.5,
        fronts="flat",
        palettes=("walnut", "teak", "oak", "cherry"),
        stands=(("legs", 1),),
        legs=("splayed", "round", "tapered"),
    ),
    "shaker": _Look(weight=2.5, fronts="shaker", palettes=("shaker",), stands=(("legs", 3), ("toe_kick", 1))),
    "classic": _Look(
        weight=2,
        fronts="classic",
        palettes=("classic", "cherry", "cream"),
        stands=(("plinth", 2), ("legs", 2)),
    ),
    "handleless": _Look(
        weight=1.5, fronts="handleless", palettes=("flat",), stands=(("plinth", 2), ("floor", 1), ("sled", 1))
    ),
}
MOST_DRAWERS = 9
"""Maximum number of drawers, in columns and rows of equal width."""
FORMS: dict[str, Spans] = {
    "wide": ((1.1, 1.8), (0.42, 0.53), (0.72, 0.95)),
    "tall": ((0.7, 1.05), (0.42, 0.53), (1.0, 1.35)),
}
"""Width, depth and height (m)."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a dresser that meets the wish."""
    style = choose_style(rng, {name: look.weight for name, look in STYLES.items()}, wish.style)
    look = STYLES[style]
    wide = rng.random() < 0.62
    if wish.width is not None or wish.height is not None:
        wide = (wish.width or 1.2) > (wish.height or 0.9)
    size = choose_lengths(rng, wish, FORMS["wide" if wide else "tall"])
    mounting = Mounting(stands=look.stands, worktop=0.75)
    finishes = draw_palette(rng, "furniture", choose_one(rng, look.palettes))
    if style == "midcentury":
        finishes["leg"] = finishes["top"]

    def draw_parts(attempt: int) -> Assembly:
        plan = draw_plan(wish.shared_stream(rng, attempt), mounting, LOOKS[look.fronts], size, wish)
        leg = choose_one(rng, wish.choose_legs(look.legs))
        framed = style in ("shaker", "classic") or wish.layout is not None
        frame = plan.looks.carcass.frame if framed else 0.0
        looks = replace(plan.looks, carcass=replace(plan.looks.carcass, frame=frame), lock=False)
        plan = replace(plan, looks=looks, stand=replace(plan.stand, leg=leg))
        return build_case(plan, _draw_layout(rng, size) if wish.layout is None else wish.layout.node, size)

    return Draft(
        style,
        draw_fitting(CATEGORY, size, MAX_LAYOUTS if wish.layout is None else LAID_LAYOUTS, draw_parts),
        finishes,
    )


def _draw_layout(rng: np.random.Generator, size: Size) -> Node:
    """Draws drawers in columns, often below a row of smaller ones, sometimes with a cupboard between."""
    width, _, height = size
    rows = int(np.clip(round(height / choose(rng, 0.2, 0.27)), 2, 7))
    small = rng.random() < 0.55
    columns = 1 if width < WIDE else int(rng.choice((2, 2, 3) if width < 1.35 else (2, 3, 3)))
    columns = max(columns, int(np.ceil(width / 1.05)))
    rows = min(rows, MOST_DRAWERS // columns)
    graded = np.linspace(1.0, float(rng.choice((1.0, 1.0, 1.25, 1.5))), max(rows - small, 1))
    stack = stack_drawers(tuple(float(share) for share in graded))
    children = [stack] * columns
    cupboard = columns > 1 and rng.random() < 0.25
    if cupboard:
        at = 1 if columns == 3 else int(rng.integers(columns))
        shelves = 1 if height < 0.95 else 2
        children[at] = Cell(fill="door", edge="left" if at == 0 else "right", inside="shelves", count=shelves)
    body = join_cells("columns", (1.0,) * columns, children)
    if not small or cupboard:
        return body
    count = {1: int(rng.choice((2, 2, 3))), 2: int(rng.choice((2, 3, 4))), 3: 3}.get(columns, columns)
    row = join_cells("columns", (1.0,) * count, (Cell(fill="drawer"),) * count)
    return Split(along="rows", shares=(choose(rng, 0.7, 0.85), float(graded.sum())), children=(row, body))


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "dresser",
        "chest of drawers/chests of drawers",
        "bureau",
        "tallboy",
        "highboy",
        "lowboy",
        "chiffonier",
        "drawer chest",
        "plan chest",
    ),
    hints=(),
    size=(
        by_height(0.8, 1.05),
        by_height(1.2, note="tall one"),
    ),
    deepest=np.inf,
    diagonal=(0.6, 3.0),
    build="board",
    stands="free",
    styles=tuple(STYLES),
    style_words={
        "contemporary": "modern",
        "minimalist": "handleless",
        "vintage": "classic",
        "antique": "classic",
        "victorian": "classic",
        "mid century": "midcentury",
        "traditional": "classic",
    },
    forms=dict.fromkeys(("tallboy", "highboy", "chiffonier"), ((0.5, 0.9), (0.4, 0.5), (1.1, 1.5))),
    sizes=((0.4, 2.4), (0.3, 0.8), (0.5, 1.8)),
    bare="width",
    make=make(wall={"wood_board": 0.02}),
    makes={},
    feet=True,
    trade="furniture",
    synset="chest_of_drawers.n.01",
    wikidata="Q14745",  # furniture
    partnet="StorageFurniture",
    body="dresser_body",
    places=(Place(role="dresser", low=(0.35, 0.6, 0.6), high=(0.7, 1.8, 1.4), draws=((0.0, 1.2, 0.0),)),),
    holds="things",
    open_front=0.065,
    lid_stays=False,
    colored=("top", "leg"),
    laid_out=True,
    channel=None,
    word=14,
    draw=draw,
)
