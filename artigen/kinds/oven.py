"""Oven: ranges with a hob, wall ovens and hobs, built of bands of controls, ovens and drawers."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from artigen.kind import EVERY, PLAIN, Channel, Kind, Place, by_height, by_width, plurals
from artigen.shapes.appliances.appliance_doors import draw_border, draw_grip
from artigen.shapes.appliances.cavity import SIDES, build_walls
from artigen.shapes.appliances.control_panel import DialDesign, design_dial, make_dial, spread_controls
from artigen.shapes.appliances.cooktop import CooktopKind, build_burners
from artigen.shapes.appliances.housing import Housing
from artigen.shapes.appliances.oven_cavity import build_rails, choose_levels, make_racks
from artigen.shapes.appliances.oven_front import FrontLook, make_oven_door, make_warming_drawer
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose
from artigen.shapes.draw import Draft, Spans, Wish, pick_nearest
from artigen.shapes.fittings.hardware import GAP, ROOM, Edge, Panel, Space
from artigen.shapes.primitives import UP, Primitive, block, line
from artigen.shapes.ranges import Range, around, margins, narrow, share_range
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Oven"
STYLES = ("steel", "black", "white", "retro")
Form = Literal["range", "double_range", "pro", "wall", "double_wall", "hob", "rangetop"]
FORMS: dict[Form, float] = {
    "range": 0.46,
    "double_range": 0.11,
    "pro": 0.13,
    "wall": 0.12,
    "double_wall": 0.07,
    "hob": 0.06,
    "rangetop": 0.05,
}
SIZES: dict[Form, Spans] = {
    "range": ((0.50, 0.80), (0.58, 0.70), (0.85, 0.96)),
    "double_range": ((0.60, 0.80), (0.60, 0.72), (0.88, 1.00)),
    "pro": ((0.90, 1.25), (0.60, 0.76), (0.86, 0.96)),
    "wall": ((0.55, 0.78), (0.52, 0.62), (0.42, 0.74)),
    "double_wall": ((0.55, 0.78), (0.52, 0.64), (1.10, 1.40)),
    "hob": ((0.56, 0.92), (0.48, 0.55), (0.06, 0.13)),
    "rangetop": ((0.75, 1.22), (0.58, 0.70), (0.18, 0.26)),
}
"""Width, depth without handles, height without upstand."""
SKIN = 0.024
"""Thickness of sides and back of the housing (m)."""
BASED = 0.5
"""Probability that a range has a closed base."""
MAX_PIECES = 32 - 4
"""Maximum number of solids of the body: 32 per link minus four feet or base boards."""


@dataclass(frozen=True, kw_only=True)
class _Plan(Housing):
    """Dimensions (m) and choices that all parts share."""

    kind: Form
    wall: float
    """Thickness of the walls above, below and beside a cavity."""
    foot: float
    base: float
    """Setback of a closed base from the front of the housing; 0 for feet."""
    look: FrontLook
    cooktop: CooktopKind
    burners: int
    upstand: float
    rear_controls: bool
    dial: DialDesign


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws an oven."""
    style = wish.style or str(rng.choice(STYLES, p=(0.6, 0.09, 0.28, 0.03)))
    palette = draw_palette(rng, "appliance", style)
    plan = _draw_plan(rng, wish, style)
    if plan.kind == "hob":
        built = _draw_hob(rng, plan)
    else:
        top, under = _draw_top(rng, plan)
        controls, lower = _draw_controls(rng, plan, under)
        built = top + controls
        if plan.kind != "rangetop":
            room = MAX_PIECES - len(built.pieces)
            built += _draw_bands(rng, plan, (plan.foot, lower), room)
        if plan.foot:
            built += Assembly(plan.build_stand(plan.foot, plan.base, radius=0.022, inset=0.04))
    return Draft(style, built.close(), palette)


def _draw_plan(rng: np.random.Generator, wish: Wish, style: str) -> _Plan:
    kind = pick_nearest(rng, wish, FORMS, SIZES)
    widths, depths, heights = SIZES[kind]
    width = choose(rng, *widths, wish.width)
    depth = choose(rng, *depths, wish.depth)
    built_in = kind in ("wall", "double_wall", "rangetop", "hob")
    rear = kind in ("range", "double_range") and rng.random() < 0.3
    upstand = 0.0
    if not built_in and (rear or rng.random() < 0.3):
        upstand = float(rng.uniform(0.13, 0.24) if rear else rng.uniform(0.05, 0.10))
    height = choose(rng, *heights, None if wish.height is None else wish.height - upstand)
    longest = max(width, depth, height + upstand)
    foot = float(rng.uniform(0.02, 0.05) if rng.random() < 0.7 else rng.uniform(0.07, 0.13))
    if built_in:
        foot = 0.02 if kind == "rangetop" else 0.0
    length = choose(rng, 0.62, 0.86) * width
    grip = draw_grip(rng, wish.choose_handles(("bar", "bar", "pull", "arch")), length=length, longest=longest)
    heat: tuple[CooktopKind, ...] = ("gas", "glass", "coil")
    drawn = heat[int(rng.choice(3, p=(0.55, 0.35, 0.10)))]
    look = FrontLook(
        face="panel" if style in ("black", "steel") and rng.random() < 0.15 else "front",
        grip=grip if rng.random() < 0.62 else None,
        longest=longest,
        border=draw_border(rng, (0.015, 0.05)),
        floor=0.002 if foot else -np.inf,
    )
    return _Plan(
        kind=kind,
        width=width,
        depth=depth,
        height=height,
        thickness=choose(rng, 0.036, 0.05),
        wall=choose(rng, 0.045, 0.065),
        foot=foot,
        base=choose(rng, 0.01, 0.06) if rng.random() < BASED and not built_in else 0.0,
        look=look,
        cooktop="gas" if kind in ("pro", "rangetop") else drawn,
        burners=_draw_burners(rng, kind, width),
        upstand=upstand,
        rear_controls=rear,
        dial=_draw_dial(rng, look.face),
    )


def _draw_dial(rng: np.random.Generator, face: str) -> DialDesign:
    """Draws dials that contrast with their background."""
    dark = rng.random() < 0.4 and face != "panel"
    return design_dial(rng, (0.017, 0.026), endless=0.72, finish="rubber" if dark else "handle")


def _draw_burners(rng: np.random.Generator, kind: Form, width: float) -> int:
    if kind in ("pro", "rangetop"):
        return 6
    if width < 0.56:
        return 4
    return int(rng.choice((4, 5), p=(0.7, 0.3)))


def _draw_top(rng: np.random.Generator, plan: _Plan) -> tuple[Assembly, float]:
    """Draws the worktop with its burners and upstand; returns the height of its underside, too."""
    if plan.kind in ("wall", "double_wall"):
        return Assembly(), plan.height
    under = plan.height - choose(rng, 0.026, 0.04)
    finish = "panel" if plan.cooktop == "glass" else "top"
    slab = block((plan.x, plan.back), plan.y, (under, plan.height), finish, 0.004)
    rear = plan.back - (0.065 if plan.upstand else 0.03)
    area = ((plan.x + 0.05, rear - 0.015), narrow(plan.y, 0.03))
    pieces = (slab, *build_burners(rng, plan.cooktop, area, plan.height, count=plan.burners))
    if plan.upstand:
        x, z = (plan.back - 0.06, plan.back), (plan.height, plan.height + plan.upstand)
        pieces += (block(x, plan.y, z, plan.look.face, 0.005),)
    return Assembly(pieces), under


def _draw_controls(rng: np.random.Generator, plan: _Plan, top: float) -> tuple[Assembly, float]:
    """Draws dials, keys and a display on a band under the worktop or on the upstand; returns the lower edge
    of the band, too."""
    bands: tuple[Primitive, ...] = ()
    if plan.rear_controls:
        lower = top
        x, z = plan.back - 0.06, (plan.height + 0.04, plan.height + plan.upstand)
    else:
        lower = plan.foot if plan.kind == "rangetop" else top - choose(rng, 0.10, 0.14)
        x, z = plan.x, (max(lower, top - 0.15), top)
        bands = (
            block((plan.x, plan.front), plan.y, (lower, top), plan.look.face, 0.003),
            block((plan.front, plan.back), plan.y, (lower, top), "body"),
        )
    keys = int(rng.choice((0, 1, 3, 4, 5), p=(0.62, 0.1, 0.1, 0.09, 0.09)))
    counts = (_count_dials(rng, plan), keys)
    across = narrow(plan.y, 0.03)
    return Assembly(bands) + spread_controls(rng, plan.dial, x, across, z, counts=counts), lower


def _count_dials(rng: np.random.Generator, plan: _Plan) -> int:
    if plan.kind in ("wall", "double_wall"):
        return int(rng.choice((0, 1, 2, 3), p=(0.3, 0.1, 0.4, 0.2)))
    ovens = 2 if plan.kind in ("double_range", "pro") else 1
    wanted = plan.burners + int(rng.integers(0, 2 * ovens + 1))
    if plan.cooktop == "glass" and rng.random() < 0.25:
        wanted = 0
    if plan.kind == "rangetop":
        wanted = int(rng.integers(6, 9))
    return min(wanted, int((plan.width - 0.06) / (2.5 * plan.dial.radius)), 10)


def _draw_bands(rng: np.random.Generator, plan: _Plan, z: Range, room: int) -> Assembly:
    """Draws the housing below the controls: one or two rows of ovens, sometimes with a drawer below.

    The body may have ``room`` further solids.
    """
    rows = (1.0,)
    if plan.kind in ("double_range", "double_wall"):
        rows = (1.0, choose(rng, 0.5, 1.0))
    has_drawer = plan.kind in ("range", "pro") and rng.random() < 0.55 and z[1] - z[0] > 0.5
    drawer = choose(rng, 0.13, 0.2) if has_drawer else 0.0
    racks = 0 if rng.random() < 0.4 else int(rng.integers(1, 4))
    built = Assembly(build_walls((plan.front, plan.back), plan.y, z, SKIN, "cavity"))
    if has_drawer:
        built += _draw_drawer(rng, plan, (z[0], z[0] + drawer), narrow(plan.y, SKIN))
    for row, span in enumerate(share_range((z[0] + drawer, z[1]), rows, 0.0)):
        left = room - len(built.pieces) - 2 * (len(rows) - 1 - row)
        built += _draw_oven_row(rng, plan, f"{row}", span, racks=racks, room=left)
    return built


def _draw_oven_row(
    rng: np.random.Generator, plan: _Plan, row: str, z: Range, *, racks: int, room: int
) -> Assembly:
    """Draws ovens side by side: floor and ceiling, walls between and beside them, doors and racks."""
    inner, back = narrow(plan.y, SKIN), plan.back - SKIN
    floor, ceiling = z[0] + plan.wall, z[1] - 0.7 * plan.wall
    columns = [plan.y]
    if plan.kind == "pro" and rng.random() < 0.6:
        columns = share_range(plan.y, (choose(rng, 0.4, 1.0), 1.0), 0.004)
    edge: Edge = "bottom"
    if plan.kind == "wall" and rng.random() < 0.3:
        edge = "left" if rng.random() < 0.5 else "right"
    # Racks must clear the edge of a side-hinged leaf.
    cheek = 0.0 if edge == "bottom" else plan.thickness + 0.008 - SKIN
    pieces = [
        line(block((plan.front, back), inner, (z[0], floor), "body"), "cavity", SIDES["bottom"]),
        line(block((plan.front, back), inner, (ceiling, z[1]), "body"), "cavity", SIDES["top"]),
    ]
    free = [inner[0] + cheek, inner[1] - cheek]
    if cheek:
        fills = margins(inner, cheek)
        pieces += [block((plan.front, back), fill, (floor, ceiling), "cavity") for fill in fills]
    if len(columns) > 1:
        between = around((columns[0][1] + columns[1][0]) / 2, plan.wall / 2)
        free[1:1] = between
        pieces.append(block((plan.front, back), between, (floor, ceiling), "cavity"))
    built = Assembly(pieces)
    for column, y in enumerate(columns):
        space = Space(x=(plan.front, back), y=(free[2 * column], free[2 * column + 1]), z=(floor, ceiling))
        slot = Panel(x=plan.x, thickness=plan.thickness, y=y, z=z)
        door = f"door_{row}_{column}"
        fronts = make_oven_door(rng, slot, plan.look, name=door, edge=edge)
        levels = choose_levels(rng, space, z[0] + plan.thickness + 0.006, racks)
        rails = build_rails(space, levels)
        if len(built.pieces) + len(rails) > room:
            rails = ()
        stem, aside = f"rack_{row}_{column}", ROOM if rails else GAP
        inside = make_racks(rng, space, levels, stem=stem, door=door, aside=aside)
        built += Assembly(rails, (*fronts, *inside))
    return built


def _draw_drawer(rng: np.random.Generator, plan: _Plan, z: Range, inner: Range) -> Assembly:
    """Draws a warming drawer and the floor below it."""
    floor, back = z[0] + SKIN, plan.back - SKIN
    board = block((plan.front, back), inner, (z[0], floor), "body")
    panel = Panel(x=plan.x, thickness=plan.thickness, y=plan.y, z=(z[0], z[1] - 0.003))
    tub = Space(x=(panel.back, back - 0.02), y=narrow(inner, ROOM), z=(floor + ROOM, z[1] - 0.03))
    return Assembly(
        (line(board, "cavity", SIDES["bottom"]),), tuple(make_warming_drawer(rng, panel, tub, plan.look))
    )


def _draw_hob(rng: np.random.Generator, plan: _Plan) -> Assembly:
    """Draws a built-in hob with dials along its front or right side."""
    lid = plan.height - max(0.012, plan.width / 55)
    finish = "panel" if plan.cooktop == "glass" else "top"
    margin = 2.6 * plan.dial.radius + 0.02
    aside = rng.random() < 0.4
    x = (plan.x + (0.02 if aside else margin), plan.back - 0.02)
    y = (plan.y[0] + (margin if aside else 0.02), plan.y[1] - 0.02)
    pieces = (
        block((plan.x + 0.02, plan.back - 0.02), narrow(plan.y, 0.02), (0.0, lid), "body"),
        block((plan.x, plan.back), plan.y, (lid, plan.height), finish),
        *build_burners(rng, plan.cooktop, (x, y), plan.height, count=plan.burners),
    )
    count = plan.burners + int(rng.integers(0, 2))
    span = 0.72 * plan.width
    parts = []
    for k, share in enumerate((np.arange(count) + 0.5) / count):
        at = (plan.x + margin / 2, span / 2 - float(share) * span, plan.height)
        if aside:
            at = (x[0] + float(share) * (x[1] - x[0]), plan.y[0] + margin / 2, plan.height)
        parts.append(make_dial(plan.dial, at, name=f"dial_{k}", out=UP))
    return Assembly(pieces, parts)


NOUNS: dict[str, Spans] = {
    **dict.fromkeys(
        ("range", "cooker", "stove", "kitchen range", "range cooker"),
        ((0.5, 0.92), (0.55, 0.7), (0.85, 0.95)),
    ),
    **dict.fromkeys(("hob", "cooktop", "stovetop"), SIZES["hob"]),
    **dict.fromkeys(("wall oven", "single oven", "single wall oven"), SIZES["wall"]),
    **dict.fromkeys(("double oven", "double wall oven"), SIZES["double_wall"]),
    "rangetop": SIZES["rangetop"],
}
"""Usual widths, depths and heights (m) by nouns that say more than the kind."""
KIND = Kind(
    name=CATEGORY,
    nouns=plurals("oven", *NOUNS),
    hints=(),
    size=(
        by_width(0.75, 0.35, "cooktop"),
        by_width(0.6, 0.8, "built-in"),
        by_height(0.92, 1.5, "range"),
        by_height(1.15, note="range with back panel, double oven"),
    ),
    deepest=0.7,
    diagonal=(0.4, 2.2),
    build="sheet",
    stands="free",
    styles=tuple(STYLES),
    style_words={"vintage": "retro", "built in": EVERY, "viewing window": EVERY, "window": EVERY},
    forms=NOUNS,
    sizes=((0.3, 1.6), (0.3, 1.0), (0.05, 1.8)),
    bare="width",
    make=PLAIN,
    makes={},
    feet=True,
    trade="appliance",
    synset="oven.n.01",
    wikidata="Q36539",
    partnet=CATEGORY,
    body="oven_body",
    places=(
        Place(
            role="range",
            low=(0.5, 0.45, 0.75),
            high=(0.85, 1.25, 1.3),
            draws=((0.65, 0.6, 0.92),),
            along=(2.0, 0.5),
        ),
        Place(role="table oven", low=(0.3, 0.3, 0.25), high=(0.6, 0.8, 0.62)),
    ),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=Channel(number=4, boards=("side", "back"), round_door=False),
    word=4,
    draw=draw,
)
