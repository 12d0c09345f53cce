"""WashingMachine: a round door before a horizontal drum, or a lid over a vertical one."""

from math import radians

import numpy as np

from artigen.kind import EVERY, NONE, Channel, Kind, Place, by_height, make, plurals
from artigen.shapes.appliances.cavity import SIDES, build_feet, build_rim, build_tub, build_walls
from artigen.shapes.appliances.control_panel import design_dial, spread_controls
from artigen.shapes.appliances.drums import build_bearing, fit_radius, make_drum
from artigen.shapes.appliances.laundry import (
    FACE,
    LID,
    WALL,
    LaundryPlan,
    build_cabinet,
    draw_band,
    draw_porthole,
    seat_drum,
)
from artigen.shapes.appliances.rings import build_pierced_plate
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose
from artigen.shapes.draw import Draft, Wish, choose_lengths
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import GAP, ROOM, Panel, Space, rotate, slide
from artigen.shapes.fittings.lids import build_collar
from artigen.shapes.primitives import LEFT, Primitive, block, line
from artigen.shapes.ranges import Range, around, narrow
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "WashingMachine"
STYLES = ("white", "steel", "black", "retro")


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a washing machine."""
    style = wish.style or str(rng.choice(STYLES, p=(0.62, 0.22, 0.13, 0.03)))
    palette = draw_palette(rng, "appliance", style)
    loads_at_top = rng.random() < 0.22 if wish.height is None else wish.height >= 1.0
    plan = _draw_plan(rng, wish, loads_at_top=loads_at_top)
    built = _draw_top_loader(rng, plan) if loads_at_top else _draw_front_loader(rng, plan)
    return Draft(style, built.close(), palette)


def _draw_plan(rng: np.random.Generator, wish: Wish, *, loads_at_top: bool) -> LaundryPlan:
    tall = (1.00, 1.12) if loads_at_top else (0.82, 0.99)
    width, depth, height = choose_lengths(rng, wish, ((0.57, 0.70), (0.54, 0.72), tall))
    pedestal = 0.0
    if not loads_at_top and wish.height is None and rng.random() < 0.12:
        pedestal = choose(rng, 0.26, 0.36)
    return LaundryPlan(
        width=width,
        depth=depth,
        height=height + pedestal,
        pedestal=pedestal,
        thickness=choose(rng, 0.036, 0.052),
        band=choose(rng, 0.105, 0.145),
    )


def _draw_front_loader(rng: np.random.Generator, plan: LaundryPlan) -> Assembly:
    x = plan.front
    back, y = plan.back, plan.y
    foot = choose(rng, 0.012, 0.025)
    floor, sill = foot + plan.pedestal, plan.height - plan.band
    radius = min(choose(rng, 0.80, 0.94) * (sill - floor) / 2, 0.40 * plan.width)
    level = (floor + sill) / 2 + 0.01
    hole = choose(rng, 0.72, 0.8) * radius
    built = Assembly(
        (
            *build_feet((x + FACE, back), y, foot, "rubber", radius=0.022, inset=0.03),
            *build_cabinet(plan, x, (floor, plan.height)),
            *build_pierced_plate(
                (x, x + FACE), (y, (floor, sill)), (0.0, level, hole), "front", lining="rubber"
            ),
        )
    )
    built += draw_band(rng, plan, x, (sill, plan.height - LID))
    square = around(level, radius)
    panel = Panel(x=plan.x, thickness=plan.thickness, y=around(0.0, radius), z=square)
    built += draw_porthole(rng, plan, panel, hole)
    end, wall = back - WALL - 0.05, back - WALL
    room = min(plan.width / 2 - WALL, sill - level, level - floor - 0.03) - 0.008
    center = (0.0, 0.0, level)
    drum = make_drum(center, "x", (x + FACE + 0.055, end), fit_radius(room), paddles=int(rng.integers(2, 5)))
    built += seat_drum(rng, drum, build_bearing(end, wall, center, "x"))
    return built + _draw_pedestal(rng, plan, x, foot) if plan.pedestal else built


def _draw_pedestal(rng: np.random.Generator, plan: LaundryPlan, x: float, foot: float) -> Assembly:
    """Draws a drawer under the machine and the floor below it."""
    inner, back = narrow(plan.y, WALL), plan.back - WALL
    board = block((x + FACE, back), inner, (foot, foot + 0.018), "body")
    panel = Panel(x=x + FACE - 0.028 - GAP, thickness=0.028, y=plan.y, z=(foot, foot + plan.pedestal - 0.004))
    tub = Space(
        x=(panel.back, back - 0.03), y=narrow(inner, ROOM), z=(foot + 0.018 + ROOM, panel.z[1] - 0.04)
    )
    solids = (panel.fill("front", 0.003), *build_tub(tub, max(tub.width, tub.depth) / 55, "plastic"))
    name = "pedestal_drawer"
    drawer = ShapePart(name, "drawer", solids, slide(0.7 * tub.depth))
    long = choose(rng, 0.3, 0.6) * plan.width
    design = HandleDesign(kind="bar", length=long, thickness=0.018 * plan.longest)
    at = (0.0, panel.z[1] - 0.05)
    handle = make_handle(panel, design, name="pedestal_handle", parent=name, upright=False, at=at)
    return Assembly((board,), (drawer, handle))


def _draw_top_loader(rng: np.random.Generator, plan: LaundryPlan) -> Assembly:
    """Draws a vertical drum under a lid, with a console of controls behind."""
    x, back, y = plan.x, plan.back, plan.y
    foot = choose(rng, 0.015, 0.03)
    deck = plan.height - plan.band - 0.03
    console = back - choose(rng, 0.13, 0.17)
    dial = design_dial(rng, (0.022, 0.032), endless=0.7)
    hinge_x = console - dial.length - choose(rng, 0.010, 0.020)
    hole = (x + 0.05, hinge_x - 0.04), narrow(y, 0.06)
    face = "panel" if rng.random() < 0.4 else "front"
    pieces = (
        *build_feet((x, back), y, foot, "rubber", radius=0.022, inset=0.04),
        *_build_tall_cabinet(plan, (foot, deck)),
        *build_collar(((x, back), y), hole, (deck, deck + 0.03), "top"),
        block((console, back), y, (deck + 0.03, plan.height), face, 0.006),
    )
    center, end = ((x + back) / 2 - 0.03, 0.0, 0.0), foot + 0.018 + 0.22
    room = min(plan.width / 2, center[0] - x, back - center[0]) - WALL - 0.012
    drum = make_drum(center, "z", (end, deck - 0.02), fit_radius(room), paddles=int(rng.choice((0, 3, 4))))
    bottom = deck + 0.03 + GAP
    extent = (x + 0.006, hinge_x), narrow(y, 0.012), (bottom, bottom + 0.026)
    motion = rotate(LEFT, (hinge_x, 0.0, extent[2][1]), radians(choose(rng, 78, 90)))
    lid = _build_lid(rng, extent, 0.016 * plan.longest)
    door = ShapePart("lid", "door", lid, motion)
    counts = (
        int(rng.choice((1, 2, 3, 4), p=(0.3, 0.2, 0.3, 0.2))),
        int(rng.choice((0, 3, 5, 6), p=(0.5, 0.2, 0.2, 0.1))),
    )
    across, up = narrow(y, 0.03), (deck + 0.05, plan.height)
    built = Assembly(pieces, (door,)) + spread_controls(rng, dial, console, across, up, counts=counts)
    return built + seat_drum(rng, drum, build_bearing(end, foot + 0.018, center, "z"))


def _build_tall_cabinet(plan: LaundryPlan, z: Range) -> tuple[Primitive, ...]:
    """Four walls and a floor with a steel lining."""
    x, inner = (plan.x, plan.back), narrow(plan.y, WALL)
    front = block((plan.x, plan.x + WALL), inner, z, "front")
    floor = block(narrow(x, WALL), inner, (z[0], z[0] + 0.018), "body")
    return (*build_walls(x, plan.y, z, WALL, "steel"), line(front, "steel", SIDES["front"]), floor)


def _build_lid(
    rng: np.random.Generator, extent: tuple[Range, Range, Range], lip: float
) -> tuple[Primitive, ...]:
    """A lid with a lip along its front edge; half of the lids have a pane."""
    x, y, z = extent
    grip = block((x[0] - 0.012, x[0]), around(0.0, 0.12), (z[1] - max(lip, 0.016), z[1]), "front")
    if rng.random() < 0.4:
        return block(x, y, z, "front", 0.004), grip
    rail = choose(rng, 0.05, 0.08)
    pane = block(narrow(x, rail), narrow(y, rail), (z[0] + 0.008, z[1] - 0.004), "glass")
    return (*build_rim(x, y, z, rail, "front"), pane, grip)


KIND = Kind(
    name=CATEGORY,
    nouns=plurals(
        "washing machine", "washer", "clothes washer", "laundry machine", "washer dryer", "front loader"
    ),
    hints=(),
    size=(by_height(0.85),),
    deepest=0.75,
    diagonal=(0.5, 2.0),
    build="sheet",
    stands="free",
    styles=tuple(STYLES),
    style_words={
        "front loading": EVERY,
        "front load": EVERY,
        "top loading": NONE,
        "top load": NONE,
        "top loader": NONE,
        "toploader": NONE,
        "toploading": NONE,
        "frontloader": EVERY,
        "frontloading": EVERY,
        "vintage": "retro",
    },
    forms={},
    sizes=((0.4, 1.0), (0.4, 1.0), (0.6, 1.6)),
    bare="width",
    make=make(hidden=5.0, filled=100.0),  # counterweight of concrete, motor
    makes={},
    feet=True,
    trade="appliance",
    synset="washer.n.03",
    wikidata="Q124441",
    partnet=CATEGORY,
    body="washing_machine_body",
    places=(
        Place(
            role="washing machine",
            low=(0.4, 0.4, 0.7),
            high=(0.8, 0.8, 1.3),
            draws=((0.6, 0.6, 0.88),),
            along=(0.5, 0.4),
        ),
    ),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=("top",),
    laid_out=False,
    channel=Channel(number=5, boards=("top", "side", "back", "plate"), round_door=True),
    word=5,
    draw=draw,
)
