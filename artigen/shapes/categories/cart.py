"""Cart: kitchen trolleys, service carts and tool carts on four castors, with a push bar.

A cart is a stack of tiers between four posts: boards, baskets, pull-out trays, rows of drawers, cabinets.
Tool carts are one cabinet of drawers under a rimmed top.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from artigen.shapes.choices import choose, choose_one, pick
from artigen.shapes.draw import CrowdedError, Draft, Wish
from artigen.shapes.fittings.drawers import BoxDesign, make_tray
from artigen.shapes.fittings.feet import make_castors
from artigen.shapes.fittings.hardware import GAP, Range, Space, around, narrow
from artigen.shapes.furniture.cabinet import Looks, draw_layout, draw_looks, make_cabinet
from artigen.shapes.furniture.carcass import fits_engines
from artigen.shapes.furniture.furniture_kinds import STYLES as LOOKS
from artigen.shapes.furniture.splits import Cell, Node, Split, Taste
from artigen.shapes.primitives import Primitive, block, cylinder
from artigen.shapes.shape import ShapePart, make_base
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Cart"
BODY = "body"
MAX_LAYOUTS = 60
Tier = Literal["board", "basket", "pull_out", "drawers", "cabinet"]


@dataclass(frozen=True, kw_only=True)
class _Kind:
    """A style of cart: weight, sizes (m), palettes, posts and tiers."""

    weight: float
    width: Range
    depth: Range
    height: Range
    palettes: tuple[str, ...]
    looks: tuple[str, ...]
    post: Range
    tiers: tuple[tuple[Tier, float], ...]
    """Weights of tiers; none for a cart that is one cabinet."""
    wheel: Range


STYLES: dict[str, _Kind] = {
    "kitchen": _Kind(
        weight=3.0,
        width=(0.5, 1.15),
        depth=(0.36, 0.55),
        height=(0.8, 0.95),
        palettes=("oak", "birch", "pine", "white", "sage", "black"),
        looks=("flat", "shaker", "country"),
        post=(0.034, 0.05),
        tiers=(("board", 3), ("basket", 0.8), ("pull_out", 0.8), ("drawers", 1.5), ("cabinet", 1.2)),
        wheel=(0.03, 0.045),
    ),
    "service": _Kind(
        weight=2.0,
        width=(0.55, 1.0),
        depth=(0.4, 0.55),
        height=(0.78, 1.0),
        palettes=("industrial", "steel", "metal"),
        looks=("industrial",),
        post=(0.026, 0.034),
        tiers=(("board", 1.0), ("basket", 3.0), ("pull_out", 0.4)),
        wheel=(0.045, 0.065),
    ),
    "tool": _Kind(
        weight=1.5,
        width=(0.5, 0.85),
        depth=(0.4, 0.52),
        height=(0.75, 1.0),
        palettes=("black", "anthracite", "navy", "blue", "terracotta", "grey"),
        looks=("handleless", "flat"),
        post=(0.03, 0.03),
        tiers=(),
        wheel=(0.045, 0.06),
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
    style = wish.style or pick(rng, {name: kind.weight for name, kind in STYLES.items()})
    kind = STYLES[style]
    palette = choose_one(rng, kind.palettes)
    finishes = draw_palette(rng, "furniture", palette)
    size = (
        choose(rng, *kind.width, wish.width),
        choose(rng, *kind.depth, wish.depth),
        choose(rng, *kind.height, wish.height),
    )
    for _ in range(MAX_LAYOUTS):
        parts = _build(rng, kind, size, wish)
        if fits_engines(parts):
            return Draft(style, parts, finishes)
    raise CrowdedError(
        f"{CATEGORY}: no cart of {size} m respects the limits of engines; request a smaller one"
    )


def _build(
    rng: np.random.Generator, kind: _Kind, size: tuple[float, float, float], wish: Wish
) -> tuple[ShapePart, ...]:
    width, depth, height = size
    looks = draw_looks(rng, LOOKS[choose_one(rng, kind.looks)], max(size), wish)
    looks = replace(looks, margin=GAP, lock=False)
    bar = choose(rng, 0.045, 0.065)  # the push bar protrudes on the left
    x = (looks.reach - depth / 2, depth / 2)
    y = (-width / 2, width / 2 - bar)
    stand = make_castors(x, y, choose(rng, *kind.wheel), swivel=bool(rng.random() < 0.45))
    frame = _Frame(x=x, y=y, z=(stand.height, height), post=choose(rng, *kind.post), looks=looks)
    solids, parts = _stack_tiers(rng, frame, kind) if kind.tiers else _build_chest(rng, frame)
    body = make_base((*solids, *stand.primitives))
    return (body, *parts, _make_push_bar(frame, bar), *stand.parts)


def _stack_tiers(
    rng: np.random.Generator, frame: _Frame, kind: _Kind
) -> tuple[list[Primitive], list[ShapePart]]:
    """Posts, a top, and two or three tiers below; the lowest begins at the castors."""
    top = choose(rng, 0.02, 0.035)
    high = frame.z[1] - top
    over = 0.0 if kind.post[0] < 0.03 else choose(rng, 0.0, 0.02)
    solids = [
        block((px, px + frame.post), (py, py + frame.post), (frame.z[0], high), "leg")
        for px in (frame.x[0], frame.x[1] - frame.post)
        for py in (frame.y[0], frame.y[1] - frame.post)
    ]
    solids.append(
        block(
            (frame.x[0] - min(over, frame.looks.reach), frame.x[1]), frame.y, (high, frame.z[1]), "top", 0.003
        )
    )
    parts: list[ShapePart] = []
    count = int(rng.integers(2, 4))
    shares = rng.dirichlet(np.full(count, 12.0))
    edges = frame.z[0] + (high - frame.z[0]) * np.concatenate([[0.0], np.cumsum(shares)])
    repeated: Tier = pick(rng, dict(kind.tiers))
    for index in range(count):
        tier: Tier = repeated if rng.random() < 0.45 else pick(rng, dict(kind.tiers))
        span = (float(edges[index]), float(edges[index + 1]))
        own, hung = _build_tier(rng, frame, tier, span, f"{'abc'[index]}")
        solids, parts = [*solids, *own], [*parts, *hung]
    return solids, parts


def _build_tier(
    rng: np.random.Generator, frame: _Frame, tier: Tier, z: Range, tag: str
) -> tuple[tuple[Primitive, ...], tuple[ShapePart, ...]]:
    """One tier between the posts: solids of the body, and parts."""
    tall = z[1] - z[0]
    wall = max(0.010, (frame.inner[1] - frame.inner[0]) / 60)
    if tier == "drawers" and tall > 0.14:
        low = z[1] - min(tall, choose(rng, 0.12, 0.2))
        drawer: Node = Cell(fill="drawer")
        wide = frame.inner[1] - frame.inner[0] > 0.6 and rng.random() < 0.6
        node = Split(along="columns", shares=(1.0, 1.0), children=(drawer, drawer)) if wide else drawer
        return _hang_cabinet(node, frame, (low, z[1]), tag)
    if tier == "cabinet" and tall > 0.3:
        space = Space(x=frame.x, y=frame.inner, z=z)
        return _hang_cabinet(draw_layout(rng, space, frame.looks, CABINET), frame, z, tag)
    if tier == "pull_out":
        rim = min(0.12, 0.5 * tall)
        space = Space(x=(frame.x[0] + 0.004, frame.x[1]), y=frame.inner, z=(z[0] + 0.004, z[0] + 0.004 + rim))
        rails = tuple(
            block(narrow(frame.x, frame.post), y, (z[0] + 0.01, z[0] + 0.04), "leg")
            for y in ((frame.y[0], frame.inner[0]), (frame.inner[1], frame.y[1]))
        )
        design = BoxDesign(wall=wall, rim=1.0, finish="front")
        return rails, (make_tray(space, design, name=f"tray_{tag}", parent=BODY),)
    rim = 0.0 if tier != "basket" else min(choose(rng, 0.04, 0.1), 0.4 * tall)
    shelf = ShapePart(f"shelf_{tag}", "shelf", _make_basket(frame.x, frame.inner, (z[0], z[0] + rim), wall))
    return (), (shelf,)


def _make_basket(x: Range, y: Range, z: Range, wall: float) -> tuple[Primitive, ...]:
    """A board, with a rim up to the top of ``z`` if that is higher than the board."""
    floor = block(x, y, (z[0], z[0] + 1.3 * wall), "inside" if z[1] > z[0] else "top")
    up = (z[0] + 1.3 * wall, z[1])
    if up[1] - up[0] < 0.01:
        return (floor,)
    return (
        floor,
        *(
            block(span_x, span_y, up, "front")
            for span_x, span_y in (
                ((x[0], x[0] + wall), y),
                ((x[1] - wall, x[1]), y),
                (narrow(x, wall), (y[0], y[0] + wall)),
                (narrow(x, wall), (y[1] - wall, y[1])),
            )
        ),
    )


def _hang_cabinet(
    node: Node, frame: _Frame, z: Range, tag: str
) -> tuple[tuple[Primitive, ...], tuple[ShapePart, ...]]:
    built = make_cabinet(node, Space(x=frame.x, y=frame.inner, z=z), frame.looks, prefix=tag)
    return built.primitives, built.parts


def _build_chest(rng: np.random.Generator, frame: _Frame) -> tuple[list[Primitive], list[ShapePart]]:
    """A cabinet of drawers under a top with a rim."""
    rim, wall = choose(rng, 0.02, 0.05), 0.012
    high = frame.z[1] - rim
    space = Space(x=frame.x, y=frame.y, z=(frame.z[0], high))
    built = make_cabinet(draw_layout(rng, space, frame.looks, TOOLS), space, frame.looks)
    x, y, z = frame.x, frame.y, (high, frame.z[1])
    back = built.primitives[0].center[0] - built.primitives[0].size[0] / 2
    edges = (
        ((back, back + wall), y),
        ((x[1] - wall, x[1]), y),
        ((back + wall, x[1] - wall), (y[0], y[0] + wall)),
        ((back + wall, x[1] - wall), (y[1] - wall, y[1])),
    )
    rims = [block((float(a[0]), float(a[1])), b, z, "accent") for a, b in edges]
    return [*built.primitives, *rims], list(built.parts)


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
