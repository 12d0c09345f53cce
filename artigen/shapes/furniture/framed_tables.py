"""Tables of a top over a frame of legs, with drawers, an apron, a shelf or stretchers."""

from dataclasses import dataclass

import numpy as np

from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one, pick
from artigen.shapes.draw import Size
from artigen.shapes.fittings.feet import make_castors
from artigen.shapes.fittings.hardware import GAP, Space, lift
from artigen.shapes.fittings.legs import LegKind, make_legs
from artigen.shapes.furniture.cabinet import make_cabinet
from artigen.shapes.furniture.looks import Looks
from artigen.shapes.furniture.splits import Cell, Node, Split
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
from artigen.shapes.primitives import Primitive
from artigen.shapes.ranges import Range, narrow

OVERHANGING, ARCHED, STRETCHED, CLOSED, GIRDED = 0.4, 0.2, 0.3, 0.2, 0.75
"""Probabilities of an overhanging top, arched aprons, stretchers, closed sides (twice for small tables), and
an apron around the drawers."""
TOPS: dict[TopKind, float] = {"plain": 0.72, "rounded": 0.1, "oval": 0.06, "ellipse": 0.12}


@dataclass(frozen=True, kw_only=True)
class TablePlan:
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


def make_plain_top(plan: TablePlan) -> tuple[Primitive, ...]:
    """A rectangular top."""
    width, depth, height = plan.size
    return make_top(width, depth, (height - plan.top, height), "plain", 0.0, moulded=plan.moulded)


@dataclass(frozen=True, kw_only=True)
class _Footing:
    """The rectangle of a frame's legs, and the top over it (m)."""

    x: Range
    y: Range
    top: tuple[Primitive, ...]


def _draw_footing(rng: np.random.Generator, plan: TablePlan) -> _Footing:
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


def build_frame(rng: np.random.Generator, plan: TablePlan) -> Assembly:
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
        built += hang_drawers(drawers, space, plan.looks, rng)
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


def hang_drawers(count: int, space: Space, looks: Looks, rng: np.random.Generator) -> Assembly:
    """One or sometimes two rows of drawers in a low carcass."""
    drawer: Node = Cell(fill="drawer")
    if space.height > 0.17 and rng.random() < 0.3:
        drawer = Split(along="rows", shares=(1.0, 1.0), children=(drawer, drawer), board=False)
    node = drawer
    if count > 1:
        shares = (1.0,) * count if count != 3 or rng.random() < 0.6 else (1.0, 1.6, 1.0)
        node = Split(along="columns", shares=shares, children=(drawer,) * count)
    return make_cabinet(node, space, looks)
