"""Cart: kitchen trolleys, service carts, tool carts and platforms on four castors; wheelbarrows.

A cart is a stack of tiers between four posts: boards, baskets, pull-out trays, rows of drawers, cabinets.
Tool carts are one cabinet of drawers under a rimmed top, platforms a deck to which their bar is welded.
Wheelbarrows hold 80 to 120 litres on a frame of tube with two handles and one wheel of 36 to 40 cm.
"""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from artigen.kind import Kind, Place, by_longest, make, plurals
from artigen.shapes.appliances.cavity import build_rim
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, pick
from artigen.shapes.draw import Draft, Size, Spans, Wish, choose_lengths, choose_size, pick_nearest
from artigen.shapes.fittings.drawers import BoxDesign, make_tray
from artigen.shapes.fittings.feet import make_castors, make_wheel
from artigen.shapes.fittings.hardware import GAP, Space
from artigen.shapes.fittings.lids import build_vessel
from artigen.shapes.fittings.tubes import lean_rod
from artigen.shapes.furniture.cabinet import draw_layout, make_cabinet
from artigen.shapes.furniture.carcass import draw_fitting
from artigen.shapes.furniture.furniture_kinds import STYLES as LOOKS
from artigen.shapes.furniture.looks import Looks, draw_looks
from artigen.shapes.furniture.splits import Cell, Node, Split, Taste
from artigen.shapes.primitives import ROUND, as_vector, block, cylinder
from artigen.shapes.ranges import Range, around, narrow, share_range
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Cart"
MAX_LAYOUTS = 60
Tier = Literal["board", "basket", "pull_out", "drawers", "cabinet"]


@dataclass(frozen=True, kw_only=True)
class _Kind:
    """A style of cart: weight, sizes (m), palettes, posts and tiers."""

    weight: float
    spans: Spans
    palettes: tuple[str, ...]
    looks: tuple[str, ...]
    post: Range
    tiers: tuple[tuple[Tier, float], ...]
    """Weights of tiers; none for a cart that is one cabinet, or a platform."""
    wheel: Range


STYLES: dict[str, _Kind] = {
    "kitchen": _Kind(
        weight=3.0,
        spans=((0.5, 1.15), (0.36, 0.55), (0.8, 0.95)),
        palettes=("oak", "birch", "pine", "white", "sage", "black"),
        looks=("flat", "shaker", "country"),
        post=(0.034, 0.05),
        tiers=(("board", 3), ("basket", 0.8), ("pull_out", 0.8), ("drawers", 1.5), ("cabinet", 1.2)),
        wheel=(0.03, 0.045),
    ),
    "service": _Kind(
        weight=2.0,
        spans=((0.55, 1.0), (0.4, 0.55), (0.78, 1.0)),
        palettes=("industrial", "steel", "metal"),
        looks=("industrial",),
        post=(0.026, 0.034),
        tiers=(("board", 1.0), ("basket", 3.0), ("pull_out", 0.4)),
        wheel=(0.045, 0.065),
    ),
    "tool": _Kind(
        weight=1.5,
        spans=((0.5, 0.85), (0.4, 0.52), (0.75, 1.0)),
        palettes=("black", "anthracite", "navy", "blue", "terracotta", "grey"),
        looks=("handleless", "flat"),
        post=(0.03, 0.03),
        tiers=(),
        wheel=(0.045, 0.06),
    ),
    "platform": _Kind(
        weight=1.0,
        spans=((0.7, 0.95), (0.45, 0.62), (0.82, 1.0)),
        palettes=("industrial", "steel", "blue", "anthracite", "oak"),
        looks=("industrial",),
        post=(0.026, 0.034),
        tiers=(),
        wheel=(0.05, 0.065),
    ),
    "wheelbarrow": _Kind(
        weight=1.0,
        spans=((1.25, 1.45), (0.56, 0.66), (0.58, 0.68)),
        palettes=("blue", "navy", "forest", "terracotta", "anthracite", "steel"),
        looks=("industrial",),
        post=(0.028, 0.034),
        tiers=(),
        wheel=(0.18, 0.2),
    ),
}
CABINET = Taste(
    module=(0.28, 0.7),
    drawer=(0.07, 0.2),
    rules=(("stack", 1.2), ("columns", 0.6), ("closed", 2.0)),
    fills=(("door", 2.0), ("double", 2.0)),
    trays=0.1,
    levels=1,
)
TOOLS = Taste(
    module=(0.4, 0.9),
    drawer=(0.055, 0.2),
    rules=(("stack", 4.0), ("drawer_row", 1.0)),
    fills=(("double", 1.0),),
)


@dataclass(frozen=True, kw_only=True)
class _Frame:
    """The space of a cart's tiers: the box over its castors, including posts (m)."""

    x: Range
    y: Range
    z: Range
    post: float
    looks: Looks

    @property
    def inner(self) -> Range:
        """Range of y between the posts."""
        return narrow(self.y, self.post)


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a cart that meets the wish."""
    weights = {name: kind.weight for name, kind in STYLES.items()}
    sizes = {name: kind.spans for name, kind in STYLES.items()}
    style = wish.style or pick_nearest(rng, wish, weights, sizes)
    kind = STYLES[style]
    palette = choose_one(rng, kind.palettes)
    finishes = draw_palette(rng, "furniture", palette)
    if style == "wheelbarrow":
        size = choose_size(rng, CATEGORY, wish, kind.spans)
    else:
        size = choose_lengths(rng, wish, kind.spans)
    parts = draw_fitting(CATEGORY, size, MAX_LAYOUTS, lambda _: _build(rng, kind, size, wish))
    return Draft(style, parts, finishes)


def _build(rng: np.random.Generator, kind: _Kind, size: Size, wish: Wish) -> Assembly:
    if kind is STYLES["platform"]:
        return _build_platform(rng, kind, size)
    if kind is STYLES["wheelbarrow"]:
        return _build_wheelbarrow(rng, kind, size)
    width, depth, height = size
    looks = draw_looks(rng, LOOKS[choose_one(rng, kind.looks)], max(size), wish)
    looks = replace(looks, margin=GAP, lock=False)
    bar = choose(rng, 0.045, 0.065)  # the push bar protrudes on the left
    x = (looks.reach - depth / 2, depth / 2)
    y = (-width / 2, width / 2 - bar)
    wheel, swivel = choose(rng, *kind.wheel), bool(rng.random() < 0.45)
    stand = make_castors(x, y, wheel, swivel=swivel, lengthwise=True)
    frame = _Frame(x=x, y=y, z=(stand.height, height), post=choose(rng, *kind.post), looks=looks)
    built = _stack_tiers(rng, frame, kind) if kind.tiers else _build_chest(rng, frame)
    return built + Assembly(parts=(_make_push_bar(frame, bar),)) + stand


def _build_platform(rng: np.random.Generator, kind: _Kind, size: Size) -> Assembly:
    """A deck with a bow of tube at its left end, and a rail half-way up."""
    (width, depth, height), tube = size, choose(rng, *kind.post) / 2
    x, y = around(0.0, depth / 2), around(0.0, width / 2)
    wheel, swivel = choose(rng, *kind.wheel), bool(rng.random() < 0.6)
    stand = make_castors(x, y, wheel, swivel=swivel, lengthwise=True)
    deck = (stand.height, stand.height + choose(rng, 0.028, 0.04))
    end, top = y[1] - tube - 0.006, height - tube
    (front, back), rail = narrow(x, 0.04 + tube), deck[1] + choose(rng, 0.45, 0.6) * (top - deck[1])
    bars = ((top, tube), (rail, 0.7 * tube))
    pieces = [
        block(x, y, deck, "top", 0.004),
        *(cylinder((a, end, deck[1]), (a, end, height), tube, "handle") for a in (front, back)),
        *(cylinder((front, end, z), (back, end, z), radius, "handle") for z, radius in bars),
    ]
    return Assembly(pieces) + stand


def _build_wheelbarrow(rng: np.random.Generator, kind: _Kind, size: Size) -> Assembly:
    """A tray on two tubes that lead from the wheel, on the right, to the handles; two legs at its rear."""
    (width, depth, height), tube = size, choose(rng, *kind.post) / 2
    radius, tread, end = choose(rng, *kind.wheel), 0.075, width / 2
    axle = (ROUND * radius - end, ROUND * radius)  # y, z
    floor, grip = 2 * radius - 0.03, choose(rng, 0.9, 1.0) * height - 1.25 * tube
    front, rear = axle[0] + radius + 0.02, end - choose(rng, 0.5, 0.56)
    near, far = tread / 2 + GAP + tube, 0.44 * depth  # x of the tubes at the wheel and at the handles
    middle, rise = 0.5 * (near + far), floor - tube
    pieces = []
    for side in (-1.0, 1.0):
        path = [
            (side * near, axle[0] - 0.02, axle[1]),
            (side * middle, front, rise),
            (side * middle, rear, rise),
            (side * far, end, grip),
        ]
        pieces += [lean_rod(a, b, tube, "handle") for a, b in pairwise(path)]
        hold = 0.13 / (end - rear)
        start = np.array(path[3]) + hold * (np.array(path[2]) - np.array(path[3]))
        pieces.append(lean_rod(as_vector(start), path[3], 1.25 * tube, "rubber"))
        foot = (side * 0.8 * depth / 2, rear + 0.06, 0.0)
        pieces.append(lean_rod(foot, (side * middle, rear - 0.02, rise), tube, "handle"))
    pieces += [cylinder((-middle, y, rise), (middle, y, rise), tube, "handle") for y in (front, rear - 0.02)]
    low = around(0.0, middle + tube), (front - 0.01, rear + 0.02)
    high = around(0.0, depth / 2), (axle[0] - 0.02, rear + 0.12)
    pieces += build_vessel(low, high, (floor, height), 0.022, "front")
    wheel = make_wheel("wheel", "body", (0.0, *axle), tread, lengthwise=True)
    return Assembly(pieces, (wheel,))


def _stack_tiers(rng: np.random.Generator, frame: _Frame, kind: _Kind) -> Assembly:
    """Posts, a top, and two or three tiers below; the lowest begins at the castors."""
    (x0, x1), (y0, y1), (low, top), post = frame.x, frame.y, frame.z, frame.post
    high = top - choose(rng, 0.02, 0.035)
    over = 0.0 if kind.post[0] < 0.03 else choose(rng, 0.0, 0.02)
    posts = [
        block((x, x + post), (y, y + post), (low, high), "leg")
        for x in (x0, x1 - post)
        for y in (y0, y1 - post)
    ]
    board = block((x0 - min(over, frame.looks.reach), x1), frame.y, (high, top), "top", 0.003)
    built = Assembly((*posts, board))
    count = int(rng.integers(2, 4))
    shares = rng.dirichlet(np.full(count, 12.0))
    repeated: Tier = pick(rng, dict(kind.tiers))
    for tag, span in zip("abc", share_range((low, high), shares.tolist()), strict=False):
        tier: Tier = repeated if rng.random() < 0.45 else pick(rng, dict(kind.tiers))
        built += _build_tier(rng, frame, tier, span, tag)
    return built


def _build_tier(rng: np.random.Generator, frame: _Frame, tier: Tier, z: Range, tag: str) -> Assembly:
    """One tier between the posts."""
    low, tall, (right, left) = z[0], z[1] - z[0], frame.inner
    wall = max(0.010, (left - right) / 60)
    if tier == "drawers" and tall > 0.14:
        space = Space(x=frame.x, y=frame.inner, z=(z[1] - min(tall, choose(rng, 0.12, 0.2)), z[1]))
        drawer: Node = Cell(fill="drawer")
        wide = left - right > 0.6 and rng.random() < 0.6
        node = Split(along="columns", shares=(1.0, 1.0), children=(drawer, drawer)) if wide else drawer
        return make_cabinet(node, space, frame.looks, prefix=tag)
    if tier == "cabinet" and tall > 0.3:
        space = Space(x=frame.x, y=frame.inner, z=z)
        return make_cabinet(draw_layout(rng, space, frame.looks, CABINET), space, frame.looks, prefix=tag)
    if tier == "pull_out":
        start, rim = (frame.x[0] + 0.004, frame.x[1]), (low + 0.004, low + 0.004 + min(0.12, 0.5 * tall))
        run, rail = narrow(frame.x, frame.post), (low + 0.01, low + 0.04)
        rails = [block(run, y, rail, "leg") for y in ((frame.y[0], right), (left, frame.y[1]))]
        design = BoxDesign(wall=wall, rim=1.0, finish="front")
        tray = make_tray(Space(x=start, y=frame.inner, z=rim), design, name=f"tray_{tag}")
        return Assembly(rails, (tray,))
    rim = min(choose(rng, 0.04, 0.1), 0.4 * tall) if tier == "basket" else 0.0
    floor, up = (low, low + 1.3 * wall), (low + 1.3 * wall, low + rim)
    board = block(frame.x, frame.inner, floor, "front" if rim else "top")
    sides = build_rim(frame.x, frame.inner, up, wall, "front") if up[1] - up[0] >= 0.01 else ()
    return Assembly(parts=(ShapePart(f"shelf_{tag}", "shelf", (board, *sides)),))


def _build_chest(rng: np.random.Generator, frame: _Frame) -> Assembly:
    """A cabinet of drawers under a top with a rim."""
    high = frame.z[1] - choose(rng, 0.02, 0.05)
    space = Space(x=frame.x, y=frame.y, z=(frame.z[0], high))
    built = make_cabinet(draw_layout(rng, space, frame.looks, TOOLS), space, frame.looks)
    start = float(built.pieces[0].center[0] - built.pieces[0].size[0] / 2)  # of the sides, behind the fronts
    return built + Assembly(build_rim((start, frame.x[1]), frame.y, (high, frame.z[1]), 0.012, "accent"))


def _make_push_bar(frame: _Frame, reach: float) -> ShapePart:
    """A push bar along the left end on two arms, below the top."""
    radius = 0.011 + 0.06 * (reach - 0.045)
    z, y = frame.z[1] - 0.09, frame.y[1] + reach - radius
    first, last = narrow(frame.x, frame.post)
    inset = frame.post / 2
    arms = [
        block(around(x, 0.009), (frame.y[1], y), around(z, 0.009), "handle")
        for x in (first - inset, last + inset)
    ]
    rod = cylinder((first - inset - 0.03, y, z), (last + inset + 0.03, y, z), radius, "handle")
    return ShapePart("push_bar", "handle", (rod, *arms))


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "trolley",
        "cart",
        "wheelbarrow",
        "handcart",
        "hand cart",
        "barrow",
        "dolly/dollies",
        "hand truck",
    ),
    hints=(),
    size=(by_longest(1.0),),
    deepest=np.inf,
    diagonal=(0.3, 3.0),
    build="metal",
    stands="free",
    styles=tuple(STYLES),
    style_words={"serving": "service", "barrow": "wheelbarrow"},
    forms={},
    sizes=((0.35, 2.0), (0.25, 0.9), (0.4, 1.3)),
    bare="width",
    make=make(density={"steel_sheet": 650.0}),
    makes={
        "kitchen": make(density={"steel": 480.0, "steel_sheet": 480.0, "wood_board": 560.0}),  # softwood
        # Tubes and a thin tray; the tyre is full of air.
        "wheelbarrow": make(density={"steel_sheet": 800.0, "steel": 400.0, "rubber": 350.0}),
    },
    feet=True,
    trade="furniture",
    synset="handcart.n.01",
    wikidata=None,
    partnet=CATEGORY,
    body="cart_body",
    places=(Place(role="cart", low=(0.3, 0.4, 0.6), high=(0.7, 1.1, 1.1), draws=((0.0, 0.0, 0.0),)),),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=7,
    draw=draw,
)
