"""Wardrobe: a tall cupboard with a clothes rail behind hinged or sliding doors.

Clothes on hangers need 0.5 m of depth and 0.9 to 1.5 m of height below the rail. Catalogue sizes are 1.75 to
2.3 m high, 0.5 m wide per door and 0.5 to 0.66 m deep.
"""

from dataclasses import replace

import numpy as np

from artigen.kind import NONE, Kind, Place, by_height, make, plurals
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_style
from artigen.shapes.draw import Draft, Size, Wish
from artigen.shapes.fittings.hardware import ROOM, Space
from artigen.shapes.furniture.carcass import LAID_LAYOUTS, draw_fitting, open_carcass
from artigen.shapes.furniture.case import CasePlan, build_case, draw_plan, place_case
from artigen.shapes.furniture.furniture_kinds import STYLES as LOOKS
from artigen.shapes.furniture.furniture_kinds import Mounting
from artigen.shapes.furniture.interior import furnish_interior
from artigen.shapes.furniture.splits import Cell, Node, Split, draw_order, join_cells
from artigen.shapes.surfaces.finishes import Finish
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Wardrobe"
STYLES = {"flat": 3.0, "shaker": 2.2, "country": 1.0, "louvre": 0.8, "mirrored": 1.4, "sliding": 2.4}
"""Styles and their weights."""
PLAIN = {name: weight for name, weight in STYLES.items() if name in ("flat", "shaker", "country")}
"""Styles of given layouts, whose cells say what slides and what is glazed."""
MAX_LAYOUTS = 100
MIRRORED = 10
"""Layouts with mirrored sliding doors that are tried before plain ones; wide mirrors need too many hulls."""
DOOR = 0.5
"""Usual width (m) of a door."""
BACKING = 0.014
"""Thickness (m) of the back: the minimum for engines at this height."""
MOUNTING = Mounting(stands=(("plinth", 2), ("toe_kick", 1.5), ("floor", 1), ("legs", 1)))
MIRROR = Finish(kind="glass", color=(0.74, 0.79, 0.81), accent=(0.80, 0.85, 0.87), period=0.5, gloss=0.95)


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a wardrobe that meets the wish."""
    style = choose_style(rng, STYLES if wish.layout is None else PLAIN, wish.style)
    slides = style == "sliding"
    doors = int(
        rng.choice((2, 2, 3, 4) if slides else (1, 2, 2, 3) if style == "louvre" else (1, 2, 2, 3, 4))
    )
    width = choose(rng, 0.44 * doors, 0.56 * doors, wish.width)
    if slides and wish.width is None:
        width = max(1.2, width)
    size = (width, choose(rng, 0.5, 0.66, wish.depth), choose(rng, 1.75, 2.3, wish.height))
    doors = max(1, round(width / DOOR))
    finishes = draw_palette(rng, "furniture", style) | {"mirror": MIRROR}
    look = LOOKS[{"mirrored": "framed_glass", "sliding": "flat"}.get(style, style)]
    mirrored = style == "mirrored" or (slides and bool(rng.random() < 0.5))
    look = replace(look, frame=0.0 if slides else 0.5 * look.frame)

    def draw_parts(attempt: int) -> Assembly:
        plan = draw_plan(wish.shared_stream(rng, attempt), MOUNTING, look, size, wish)
        fronts = replace(plan.looks.doors, style="framed_glass", glass="mirror")
        carcass = replace(plan.looks.carcass, back=BACKING, recess=0.0)
        doors_look = fronts if mirrored and (not slides or attempt < MIRRORED) else plan.looks.doors
        plan = replace(plan, looks=replace(plan.looks, doors=doors_look, carcass=carcass, lock=False))
        if slides and wish.layout is None:
            return _build_sliding(rng, plan, size)
        return build_case(
            plan, _draw_hinged(rng, doors, size) if wish.layout is None else wish.layout.node, size
        )

    return Draft(
        style,
        draw_fitting(CATEGORY, size, MAX_LAYOUTS if wish.layout is None else LAID_LAYOUTS, draw_parts),
        finishes,
    )


def _draw_hinged(rng: np.random.Generator, doors: int, size: Size) -> Node:
    """Draws tall doors, single and in pairs, sometimes above drawers or below lockers."""
    height = size[2]
    pairs = doors // 2 if rng.random() < 0.75 else max(doors // 2 - 1, 0)
    widths = [2] * pairs + [1] * (doors - 2 * pairs)
    rng.shuffle(widths)
    low = choose(rng, 0.18, 0.3) * int(rng.choice((1, 1, 2))) if rng.random() < 0.45 else 0.0
    low = low if height - low > 1.3 else 0.0
    high = choose(rng, 0.35, 0.45) if height > 2.1 and not low and rng.random() < 0.35 else 0.0
    inside = ["rod"] + ["shelves" if rng.random() < 0.4 else "rod" for _ in widths[1:]]
    rng.shuffle(inside)
    columns: list[Node] = []
    for index, (wide, held) in enumerate(zip(widths, inside, strict=True)):
        edge = "left" if index < len(widths) / 2 else "right"
        fill = "double" if wide == 2 else "door"
        count = 1 if held == "rod" else int(rng.integers(3, 6))
        tall = Cell(fill=fill, edge=edge, inside="rod" if held == "rod" else "shelves", count=count)
        if low:
            drawer = Cell(fill="drawer")
            drawers = (drawer, drawer) if low > 0.3 else (drawer,)
            below = (low / len(drawers),) * len(drawers)
            column = Split(along="rows", shares=(height - low, *below), children=(tall, *drawers))
        elif high:
            column = Split(
                along="rows", shares=(high, height - high), children=(Cell(fill=fill, edge=edge), tall)
            )
        else:
            column = tall
        columns.append(column)
    return join_cells("columns", [float(wide) for wide in widths], columns)


def _build_sliding(rng: np.random.Generator, plan: CasePlan, size: Size) -> Assembly:
    """Two sliding doors before a clothes rail beside shelves."""
    rail = Cell(fill="open", inside="rod", count=1)
    shelves = Cell(fill="open", inside="shelves", count=int(rng.integers(3, 6)))
    share = choose(rng, 0.5, 0.65)
    node = draw_order(rng, 0.5, "columns", (share, 1 - share), (rail, shelves))
    outer, design = place_case(plan, size), plan.looks.carcass
    y, z = open_carcass(outer, design)
    tracks = 2 * plan.looks.thickness + ROOM + 0.012
    space = Space(x=(outer.x[0] + tracks, outer.x[1] - design.back - design.recess), y=y, z=z)
    return build_case(plan, Cell(fill="slide"), size) + furnish_interior(space, node, plan.looks)


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("wardrobe", "armoire", "closet"),
    hints=(),
    size=(by_height(0.8, 1.05, "low one"), by_height(0.9, 1.6, "half-height one"), by_height(1.9)),
    deepest=np.inf,
    diagonal=(1.0, 4.0),
    build="board",
    stands="free",
    styles=tuple(STYLES),
    style_words={
        "modern": "flat",
        "contemporary": "flat",
        "antique": "country",
        "vintage": "country",
        "louvred": "louvre",
        "louvered": "louvre",
        "corner": NONE,
        "mirror": "mirrored",
        "mirrors": "mirrored",
        "rustic": "country",
        "farmhouse": "country",
    },
    forms={},
    sizes=((0.35, 3.6), (0.4, 0.9), (1.3, 3.0)),
    bare="width",
    make=make(density={"wood_board": 580.0}, wall={"wood_board": 0.02}),  # particle board on a thin back
    makes={},
    feet=True,
    trade="furniture",
    synset="wardrobe.n.01",
    wikidata="Q14745",  # furniture
    partnet="StorageFurniture",
    body="wardrobe_body",
    places=(Place(role="wardrobe", low=(0.35, 0.45, 1.4), high=(0.75, 1.8, 2.4), draws=((0.0, 1.2, 0.0),)),),
    holds="things",
    open_front=0.065,
    lid_stays=False,
    colored=("top", "leg"),
    laid_out=True,
    channel=None,
    word=28,
    draw=draw,
)
