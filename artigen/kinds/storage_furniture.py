"""StorageFurniture: cabinets, dressers, wardrobes, sideboards, nightstands, bookcases, TV stands.

A kind of furniture has sizes, a taste and stands (`artigen.shapes.furniture.furniture_kinds`); the grammar of
`artigen.shapes.furniture.splits` divides its front.
"""

from collections.abc import Sequence

import numpy as np

from artigen.kind import PLAIN, Channel, Kind, Place, Spans, by_height, by_width, plurals
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import pick
from artigen.shapes.draw import Draft, Wish, choose_lengths, pick_nearest
from artigen.shapes.fittings.hardware import Space
from artigen.shapes.furniture.cabinet import count_fronts, draw_layout
from artigen.shapes.furniture.carcass import LAID_LAYOUTS, draw_fitting
from artigen.shapes.furniture.case import build_case, draw_plan, place_case
from artigen.shapes.furniture.furniture_kinds import FORMS, STYLE_WORDS, STYLES, Form, Style
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
    kind = _choose_form(rng, wish, STYLES[style])
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
        return shown and (laid or bool(wish.counts) or any(part.joint for part in parts))

    return Draft(
        style,
        draw_fitting(CATEGORY, size, MAX_LAYOUTS if wish.layout is None else LAID_LAYOUTS, draw_parts, suits),
        finishes,
    )


def _choose_form(rng: np.random.Generator, wish: Wish, style: Style) -> Form:
    """Draws a kind whose sizes include the wished ones or are closest to them."""
    weights = {name: kind.weight for name, kind in FORMS.items()}
    sizes = {
        name: kind.spans
        for name, kind in FORMS.items()
        if not style.closed or dict(kind.taste.rules).get("closed", 0) > 0.5
    }
    return FORMS[pick_nearest(rng, wish, weights, sizes)]


def _draw_wanted(rng: np.random.Generator, box: Space, looks: Looks, kind: Form, wish: Wish) -> Node:
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


NOUNS: dict[str, tuple[str, ...]] = {
    "nightstand": ("nightstand", "night stand", "bedside cabinet", "bedside table", "bedside unit"),
    "bookcase": (
        "bookcase", "bookshelf", "shelving unit", "shelf unit", "cube shelf", "cube unit", "shelving",
    ),
    "tv_stand": (
        "tv stand", "tv unit", "tv cabinet", "tv console", "tv bench", "media unit", "media console",
        "media centre", "media center",
        "lowboard", "entertainment center", "entertainment centre", "entertainment unit",
    ),
    "sideboard": ("sideboard", "credenza", "buffet"),
    "base_cabinet": (
        "kitchen cabinet", "base cabinet", "lower cabinet",
        "lower kitchen cabinet", "base unit", "kitchen unit", "sink cabinet", "vanity unit",
        "vanity", "bathroom vanity",
    ),
    "wall_cabinet": (
        "wall cabinet", "upper cabinet", "upper kitchen cabinet",
        "hanging cabinet", "wall unit", "wall cupboard", "wall mounted cabinet",
        "wall hung cabinet",
    ),
    "drawer_unit": ("drawer unit", "drawer base", "drawer cabinet",),
}  # fmt: skip
"""Nouns of forms of furniture."""


SIZES: dict[str, Spans] = {noun: FORMS[form].spans for form, nouns in NOUNS.items() for noun in nouns}
SIZES |= dict.fromkeys(
    ("pantry", "larder", "larder unit", "tall unit", "locker", "linen cupboard", "broom cupboard"),
    ((0.4, 0.9), (0.35, 0.62), (1.8, 2.2)),
)
SIZES |= dict.fromkeys(
    ("hutch", "highboard", "china cabinet", "display cabinet", "display case"),
    ((0.7, 1.2), (0.35, 0.5), (1.2, 2.0)),
)
SIZES |= dict.fromkeys(("shoe cabinet", "shoe rack"), ((0.5, 0.9), (0.17, 0.38), (0.9, 1.3)))
SIZES["medicine cabinet"] = ((0.3, 0.7), (0.15, 0.2), (0.5, 0.8))
"""Usual widths, depths and heights (m) by nouns that say more than the kind."""

KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        *("cabinet", "cupboard", "storage furniture/storage furniture", "glass cabinet", "storage cabinet"),
        *("storage unit", "bathroom cabinet", "washstand", "cubby", "etagere", *SIZES),
    ),
    hints=("drawer", "shelf"),
    size=(
        by_width(1.4, 0.45, "sideboard"),
        by_height(0.8, 1.05, "chest, base cabinet"),
        by_height(0.9, 1.6, "cupboard"),
        by_height(1.9, note="wardrobe, tall cabinet"),
    ),
    deepest=0.65,
    diagonal=(0.2, 3.5),
    build="board",
    stands="free",
    styles=tuple(STYLES),
    style_words={
        **STYLE_WORDS,
        "ornate": "classic",
        "louvred": "louvre",
        "louvered": "louvre",
        "glazed": "framed_glass",
        "glass cabinet": "framed_glass",
    },
    forms=SIZES,
    sizes=((0.2, 4.0), (0.15, 1.2), (0.2, 3.2)),
    bare="width",
    make=PLAIN,
    makes={},
    feet=True,
    trade="furniture",
    synset="cabinet.n.01",
    wikidata="Q14745",  # furniture
    partnet=CATEGORY,
    body="furniture_body",
    places=(
        Place(
            role="base cabinet",
            low=(0.5, 0.28, 0.72),
            high=(0.74, 1.4, 1.0),
            draws=((0.6, 0.45, 0.88), (0.6, 0.6, 0.88), (0.6, 0.8, 0.88), (0.6, 0.9, 0.88)),
        ),
        Place(role="larder", low=(0.45, 0.4, 1.6), high=(0.74, 1.7, 2.3)),
        Place(
            role="wall cabinet",
            low=(0.25, 0.3, 0.34),
            high=(0.44, 1.25, 0.95),
            draws=((0.34, 0.6, 0.72), (0.34, 0.8, 0.72)),
            joint="revolute",
        ),
        Place(role="island", low=(0.5, 0.9, 0.7), high=(0.95, 1.8, 1.0), draws=((0.62, 1.2, 0.88),)),
        Place(role="pedestal", low=(0.3, 0.28, 0.38), high=(0.66, 0.66, 0.86), draws=((0.5, 0.42, 0.6),)),
        Place(role="filing cabinet", low=(0.3, 0.3, 0.7), high=(0.7, 1.7, 1.7), draws=((0.45, 0.8, 1.1),)),
        Place(
            role="bookcase",
            low=(0.25, 0.4, 1.4),
            high=(0.45, 1.7, 2.3),
            draws=((0.38, 0.9, 1.9), (0.32, 0.8, 2.0)),
        ),
        Place(role="sideboard", low=(0.3, 0.7, 0.55), high=(0.6, 2.0, 0.98), draws=((0.42, 1.3, 0.8),)),
        Place(role="nightstand", low=(0.28, 0.3, 0.38), high=(0.52, 0.66, 0.72), draws=((0.4, 0.45, 0.55),)),
        Place(role="wardrobe", low=(0.35, 0.45, 1.4), high=(0.75, 1.8, 2.4), draws=((0.6, 1.2, 2.1),)),
        Place(role="dresser", low=(0.35, 0.6, 0.6), high=(0.7, 1.8, 1.4), draws=((0.48, 1.0, 0.9),)),
        Place(role="lowboard", low=(0.3, 0.8, 0.34), high=(0.6, 2.0, 0.78), draws=((0.42, 1.4, 0.5),)),
    ),
    holds="things",
    open_front=None,
    lid_stays=False,
    colored=("top",),
    laid_out=True,
    channel=Channel(number=0, boards=("top", "side", "back"), round_door=False),
    word=0,
    draw=draw,
)
