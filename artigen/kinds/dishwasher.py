"""Dishwasher: a drop-down door before a steel tub with racks, or drawers that are tubs."""

from dataclasses import dataclass, replace

import numpy as np

from artigen.kind import EVERY, Channel, Kind, Place, by_height, make, plurals
from artigen.shapes.appliances.appliance_doors import draw_grip, mount_grip
from artigen.shapes.appliances.cavity import SIDES, build_shell, build_tub
from artigen.shapes.appliances.control_panel import build_badge, design_dial, spread_controls
from artigen.shapes.appliances.housing import Housing
from artigen.shapes.appliances.racks import build_basket, build_rack
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose
from artigen.shapes.draw import Draft, Spans, Wish, choose_lengths
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import ROOM, Panel, Space, hinge, slide, sweep_gap
from artigen.shapes.primitives import Primitive, block, box, cylinder, line
from artigen.shapes.ranges import Range, around, divide_range, margins, narrow
from artigen.shapes.shape import ShapePart, require
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Dishwasher"
STYLES = ("steel", "white", "black", "retro")
LOW: Spans = ((0.50, 0.56), (0.48, 0.54), (0.43, 0.52))
USUAL: Spans = ((0.43, 0.66), (0.54, 0.68), (0.80, 0.90))
"""Width, depth and height (m) of machines for a worktop, and of others."""
BASED = 0.6
"""Probability of a closed base instead of feet."""
BULGE = 0.012
"""Depth of the door's liner in the tub (m)."""


@dataclass(frozen=True, kw_only=True)
class _Plan(Housing):
    """Dimensions (m) and choices that all parts share."""

    toe: float
    """Lower edge of housing and fronts."""
    base: float
    """Setback of a closed base from the front of the housing; 0 for feet."""
    lid: float
    """Thickness of the machine's own worktop; 0 if built in."""
    wall: float
    grip: HandleDesign | None
    paired: bool
    """Whether there are two short handles side by side, as on fronts that match a kitchen."""
    drawers: int

    @property
    def top(self) -> float:
        """Height of the upper edge of fronts and housing."""
        return self.height - self.lid


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a dishwasher."""
    style = wish.style or str(rng.choice(STYLES, p=(0.58, 0.32, 0.07, 0.03)))
    palette = draw_palette(rng, "appliance", style)
    plan = _draw_plan(rng, wish)
    draw_fronts = _draw_drawers if plan.drawers else _draw_door_and_racks
    built = Assembly(tuple(_build_base(plan))) + draw_fronts(rng, plan)
    return Draft(style, built.close(), palette)


def _draw_plan(rng: np.random.Generator, wish: Wish) -> _Plan:
    low = rng.random() < 0.08 if wish.height is None else wish.height < 0.6  # stands on a worktop
    width, depth, height = choose_lengths(rng, wish, LOW if low else USUAL)
    paired = rng.random() < 0.06
    length = choose(rng, 0.12, 0.16) if paired else choose(rng, 0.55, 0.86) * width
    kinds = wish.choose_handles(("bar", "bar", "pull", "arch", "edge"))
    grip = draw_grip(rng, kinds, length=length, longest=max(width, depth, height))
    return _Plan(
        width=width,
        depth=depth,
        height=height,
        thickness=choose(rng, 0.042, 0.058),
        toe=0.018 if low else choose(rng, 0.07, 0.12),
        base=choose(rng, 0.015, 0.06) if rng.random() < BASED and not low else 0.0,
        lid=choose(rng, 0.020, 0.032) if rng.random() < 0.4 and not low else 0.0,
        wall=choose(rng, 0.020, 0.032),
        grip=grip if rng.random() < 0.82 or paired else None,
        paired=paired,
        drawers=int(rng.integers(1, 3)) if rng.random() < 0.16 and not low else 0,
    )


def _build_base(plan: _Plan) -> list[Primitive]:
    """Feet and a toe kick, or a closed base, and the worktop."""
    kick = plan.front + 0.03
    pieces = [*plan.build_stand(plan.toe, plan.base, radius=0.018, inset=0.03)]
    if plan.toe > 0.05 and not plan.base:
        pieces.append(block((kick, kick + 0.014), narrow(plan.y, 0.002), (0.012, plan.toe), "leg"))
    if plan.lid:
        pieces.append(block((plan.x, plan.back), plan.y, (plan.top, plan.height), "top", 0.004))
    return pieces


def _draw_door_and_racks(rng: np.random.Generator, plan: _Plan) -> Assembly:
    """Tub, door, and racks that slide out over the open door."""
    outer = Space(x=(plan.front, plan.back), y=plan.y, z=(plan.toe, plan.top))
    sill = plan.toe + 0.003
    # The liner of the open door is level with the floor of the tub.
    floor = sill + plan.thickness + BULGE + 0.004
    tub = Space(
        x=(plan.front, plan.back - plan.wall), y=narrow(plan.y, plan.wall), z=(floor, plan.top - 0.04)
    )
    shell = build_shell(outer, tub, "body", "steel")
    built = Assembly((*shell, *_build_spray_arm(tub)))
    strip, fixed = choose(rng, 0.07, 0.12), bool(rng.random() < 0.4)
    ceiling = min(tub.z[1] - 0.05, plan.top - strip - ROOM if fixed else plan.top)  # racks pass below
    door = _draw_door(rng, plan, sill, tub, strip, fixed=fixed)
    return built + door + _draw_racks(rng, tub, ceiling)


def _build_spray_arm(tub: Space) -> tuple[Primitive, ...]:
    """A spray arm on a hub under the ceiling of the tub."""
    x, top, reach = sum(tub.x) / 2, tub.z[1], 0.38 * tub.width
    return (
        cylinder((x, 0.0, top - 0.02), (x, 0.0, top), 0.03, "plastic"),
        block(around(x, 0.018), around(0.0, reach), (top - 0.032, top - 0.02), "plastic"),
    )


def _draw_door(
    rng: np.random.Generator, plan: _Plan, sill: float, tub: Space, strip: float, *, fixed: bool
) -> Assembly:
    """The door with controls on its upper edge, or below a fixed control strip of the housing."""
    low, top = plan.top - strip, plan.top - 0.003
    if fixed:
        top = low - sweep_gap(low - sill, plan.thickness + BULGE)
    seam = top if fixed else top - strip
    leaf = Panel(x=plan.x, thickness=plan.thickness, y=plan.y, z=(sill, seam))
    finish = "panel" if rng.random() < 0.55 else "front"
    deep, up = ((plan.x, plan.front), (low, plan.top)) if fixed else ((plan.x, leaf.back), (seam, top))
    face, band = (
        line(board, "steel", SIDES["front"])
        for board in (leaf.fill("front", 0.003), block(deep, plan.y, up, finish, 0.003))
    )
    carrier = "body" if fixed else "door"
    controls = _draw_controls(rng, plan.x, plan.y, (low, plan.top - 0.003), carrier)
    housed = (band, *controls.pieces)
    badge = build_badge(leaf.x, (0.0, leaf.z[0] + 0.07), 0.06)
    solids = (face, badge, *_build_liner(leaf, tub), *(() if fixed else housed))
    door = ShapePart("door", "door", solids, hinge(replace(leaf, z=(sill, top)), "bottom", np.pi / 2))
    return Assembly(housed if fixed else (), (door, *_mount(plan, leaf, "door"), *controls.parts))


def _build_liner(leaf: Panel, tub: Space) -> tuple[Primitive, ...]:
    """The liner of the door, which enters the tub, with the detergent box."""
    y, z = narrow(tub.y, 0.03), (tub.z[0] + 0.02, min(leaf.z[1], tub.z[1]) - 0.04)
    rear, level = leaf.back + BULGE, z[0] + 0.5 * (z[1] - z[0])
    return (
        block((leaf.back - 0.02, rear), y, z, "steel"),
        box((rear - 0.010, -0.02, level), (rear + 0.003, 0.12, level + 0.10), "plastic"),
    )


def _draw_controls(rng: np.random.Generator, x: float, y: Range, z: Range, parent: str) -> Assembly:
    dial = design_dial(rng, (0.019, 0.027), endless=0.7)
    dials = int(rng.choice((0, 1, 2), p=(0.5, 0.42, 0.08)))
    counts = (
        dials if parent == "body" else 0,  # drop-down doors have keys; dials are on housings
        int(rng.choice((0, 1, 3, 4, 5, 6), p=(0.5, 0.1, 0.1, 0.13, 0.1, 0.07))),
    )
    across = narrow(y, 0.03)
    return spread_controls(rng, dial, x, across, z, counts=counts, parent=parent)


def _mount(plan: _Plan, panel: Panel, parent: str) -> list[ShapePart]:
    """The handle along the upper edge, a pair of short ones, or none."""
    if plan.grip is None:
        return []
    inset = 0.002 if plan.grip.kind == "edge" else 0.028
    if not plan.paired:
        return [mount_grip(panel, plan.grip, parent=parent, edge=None, inset=inset)]
    z = panel.z[1] - inset - plan.grip.thickness / 2
    places = [(side * 0.26 * panel.width, z) for side in (1, -1)]
    return [
        make_handle(panel, plan.grip, name=f"{parent}_handle_{k}", parent=parent, upright=False, at=at)
        for k, at in enumerate(places)
    ]


def _draw_racks(rng: np.random.Generator, tub: Space, ceiling: float) -> Assembly:
    """Draws baskets from the bottom up on rails of the tub, below a ceiling; the topmost may be a flat
    cutlery tray."""
    most = 3 if tub.height > 0.6 else (2 if tub.height > 0.42 else 1)
    count = min(most, int(rng.choice((0, 1, 2, 3), p=(0.12, 0.14, 0.52, 0.22))))
    rails: list[Primitive] = []
    parts: list[ShapePart] = []
    y = narrow(tub.y, ROOM)
    x = (tub.x[0] + 0.035, tub.x[1] - ROOM)
    for k in range(count):
        if k == 0:
            start = tub.z[0] + ROOM
            z = (start, start + min(choose(rng, 0.15, 0.22), 0.7 * tub.height))
        elif k == 1:
            start = max(tub.z[0] + choose(rng, 0.46, 0.52) * tub.height, parts[0].bounds()[1, 2] + 0.03)
            z = (start, min(start + choose(rng, 0.10, 0.14), ceiling - (0.05 if count == 3 else 0.0)))
        else:
            z = (ceiling - 0.04, ceiling)
        space = Space(x=x, y=y, z=z)
        if k == 2:
            solids = build_rack(space, bars=int(rng.integers(12, 18)), lip=0.03)
        else:
            solids = build_basket(space, bars=6, posts=4 - k, tines=5)
        rail = (z[0] - 0.0135, z[0] - 0.0015)
        rails += [block((x[0], tub.x[1]), side, rail, "plastic") for side in margins(tub.y, 2 * ROOM)]
        motion, needs = slide(choose(rng, 0.6, 0.78) * space.depth), require("door", fraction=1.0)
        parts.append(ShapePart(f"rack_{k}", "tray", solids, motion, needs=needs))
    return Assembly(rails, parts)


def _draw_drawers(rng: np.random.Generator, plan: _Plan) -> Assembly:
    """Draws one or two drawers, each a tub with a front."""
    outer = Space(x=(plan.front, plan.back), y=plan.y, z=(plan.toe, plan.top))
    hollow = outer.hollow(plan.wall)
    built = Assembly(build_shell(outer, hollow, "body", "inside"))
    for k, z in enumerate(reversed(divide_range((plan.toe, plan.top - 0.003), plan.drawers, 0.004))):
        low, high = max(z[0], hollow.z[0]) + ROOM, min(z[1] - 0.03, hollow.z[1] - 0.02)
        if k == 0 and plan.drawers == 2:
            shelf = block(hollow.x, hollow.y, (low - ROOM - 0.012, low - ROOM), "inside")
            built += Assembly((shelf,))
        panel = Panel(x=plan.x, thickness=plan.thickness, y=plan.y, z=z)
        tub = Space(x=(panel.back, hollow.x[1] - 0.02), y=narrow(hollow.y, ROOM), z=(low, high))
        box = build_tub(tub, _tub_wall(tub), "steel")
        solids, name = (panel.fill("front", 0.003), *box, *_build_tines(tub)), f"drawer_{k}"
        drawer = ShapePart(name, "drawer", solids, slide(0.62 * tub.depth))
        built += Assembly(parts=(drawer, *_mount(plan, panel, name)))
    return built


def _tub_wall(tub: Space) -> float:
    """Thickness of a drawer's walls (m); engines mishandle thinner walls of this size."""
    return max(0.012, max(tub.width, tub.depth, tub.height) / 55)


def _build_tines(tub: Space) -> tuple[Primitive, ...]:
    """Two rows of tines on a bar in the floor of a drawer."""
    wall = _tub_wall(tub)
    floor, height = tub.z[0] + wall, 0.35 * tub.height
    out = []
    for x in (tub.x[0] + tub.depth * share for share in (0.36, 0.68)):
        out.append(block(around(x, 0.006), narrow(tub.y, wall), (floor, floor + 0.012), "plastic"))
        for y in np.linspace(tub.y[0] + 0.07, tub.y[1] - 0.07, 7):
            out.append(cylinder((x, float(y), floor), (x, float(y), floor + height), 0.004, "plastic"))
    return tuple(out)


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("dishwasher", "dish washer"),
    hints=(),
    size=(by_height(0.85),),
    deepest=0.7,
    diagonal=(0.5, 2.0),
    build="sheet",
    stands="free",
    styles=tuple(STYLES),
    style_words={"vintage": "retro", "built in": EVERY, "front loading": EVERY},
    forms={},
    sizes=((0.4, 0.8), (0.4, 0.9), (0.4, 1.2)),
    bare="width",
    make=make(hidden=2.0, filled=25.0),  # pump
    makes={},
    feet=True,
    trade="appliance",
    synset="dishwasher.n.01",
    wikidata="Q186263",
    partnet=CATEGORY,
    body="dishwasher_body",
    places=(
        Place(
            role="dishwasher",
            low=(0.4, 0.4, 0.7),
            high=(0.75, 0.75, 1.0),
            draws=((0.6, 0.6, 0.86),),
            along=(0.5, 0.4),
        ),
    ),
    holds=None,
    open_front=0.04,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=Channel(number=3, boards=("top", "side", "back"), round_door=False),
    word=3,
    draw=draw,
)
