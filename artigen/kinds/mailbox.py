"""Mailbox: an arched box with a flag on a post, a box with a flap on legs, a parcel locker, a cluster box.

USPS-STD-7C places the bottom of a roadside box 1.04 to 1.14 m above the road; boxes measure 0.16 m x 0.48 m x
0.19 m to 0.29 m x 0.58 m x 0.38 m. EN 13724 has slots of 230 to 280 mm by 30 to 35 mm for C4 letters.
"""

from dataclasses import replace
from math import radians

import numpy as np

from artigen.kind import PLAIN, Kind, by_height, by_longest, plurals
from artigen.shapes.appliances.cavity import build_shell
from artigen.shapes.assembly import Assembly, draw_styled
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Draft, Spans, Wish
from artigen.shapes.fittings.fronts import FrontDesign, make_front
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import GAP, Panel, Space, hinge, rotate, sweep_gap
from artigen.shapes.fittings.lids import build_roof
from artigen.shapes.fittings.locks import make_lock
from artigen.shapes.primitives import RIGHT, Vector, block, move, prism
from artigen.shapes.ranges import Range, around, margins, narrow, share_down
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import LACQUERS, make_lacquer, make_metal, make_stone, make_wood
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Mailbox"
STYLES = {"rural": 3.0, "modern": 2.5, "parcel": 1.5, "cluster": 1.2}
SIZES: dict[str, Spans] = {
    "rural": ((0.17, 0.29), (0.46, 0.6), (1.25, 1.5)),
    "modern": ((0.3, 0.42), (0.16, 0.3), (1.05, 1.3)),
    "parcel": ((0.38, 0.52), (0.34, 0.46), (1.05, 1.35)),
    "cluster": ((0.6, 0.85), (0.4, 0.5), (1.4, 1.6)),
}
"""Width, depth and height (m)."""
WHITE, RED, SIGNAL = (0.90, 0.90, 0.88), (0.62, 0.14, 0.13), (0.72, 0.10, 0.10)
"""Colours of a red box's flag, of red boxes, and of other flags."""
PAINTS: tuple[Color, ...] = (
    LACQUERS["black"], LACQUERS["anthracite"], LACQUERS["white"], RED, (0.16, 0.26, 0.46),
    (0.18, 0.33, 0.24), (0.60, 0.61, 0.61), (0.86, 0.68, 0.12),
)  # fmt: skip
WALL, THICK, PLATE, POST = 0.008, 0.012, 0.012, 0.045
"""Thickness (m) of an arched sheet, of doors and of foot plates; half the width of a post."""
KEY = 0.026
"""Protrusion (m) of a key."""


def draw(rng: np.random.Generator, wish: Wish) -> Draft:
    """Draws a mailbox that meets the wish."""
    builders = {
        "rural": _build_rural,
        "modern": _build_modern,
        "parcel": _build_parcel,
        "cluster": _build_cluster,
    }
    return draw_styled(rng, wish, STYLES, SIZES, builders, _draw_finishes)


def _draw_finishes(rng: np.random.Generator, style: str) -> dict[str, Finish]:
    seed = int(rng.integers(2**30))
    paint = make_lacquer(choose_one(rng, PAINTS), gloss=0.4)
    other = make_metal("steel", seed) if rng.random() < 0.5 else paint
    wood = make_wood(choose_one(rng, ("pine", "oak", "teak", "grey_oak")), seed)
    post = wood if style == "rural" and rng.random() < 0.75 else make_lacquer(LACQUERS["anthracite"])
    return draw_palette(rng, "appliance", "steel") | {
        "body": paint,
        "front": paint if style == "rural" else other,
        "inside": make_lacquer(LACQUERS["grey"]),
        "leg": post,
        "foot": make_stone("concrete", seed),
        "mark": make_lacquer(WHITE if paint.color == RED else SIGNAL, gloss=0.4),
        "paper": make_lacquer((0.92, 0.92, 0.90)),
    }


def _build_rural(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """An arched box with a front door and a flag on its right side, on a post in a block."""
    flag, grip, thick, board = 0.0055, 0.03, 0.010, 0.022
    x, y = (grip - depth / 2, depth / 2), (flag - width / 2, width / 2)
    half, middle = (y[1] - y[0]) / 2, sum(y) / 2
    z = (height - half - choose(rng, 0.5, 0.8) * (y[1] - y[0]), height)
    spring, start, under = height - half, x[0] + thick + GAP, z[0] - 0.006
    arch = [(middle + half * np.cos(t), spring + half * np.sin(t)) for t in np.linspace(0.0, np.pi, 9)]
    outline = np.array([(y[1], z[0]), *arch, (y[0], z[0])])  # (y, z), from the left over the top
    vault = build_roof(outline[::-1], WALL, (-x[1], -start), "body", ends=False)
    pieces = [
        *(move(solid, turn=np.pi / 2) for solid in vault),
        block((start, x[1]), y, (under, z[0] + 0.004), "body"),
        prism(outline, (x[1] - WALL, 0, 0), (x[1], 0, 0), "body"),
        block((-0.38 * depth, 0.42 * depth), around(0.0, 0.4 * width), (under - board, under), "leg"),
        block(around(0.0, POST), around(0.0, POST), (0.05, under - board), "leg"),
        block(around(0.0, 0.16), around(0.0, width / 2), (0.0, 0.05), "foot"),
    ]
    panel = Panel(x=x[0], thickness=thick, y=y, z=z)
    front = prism(outline, (x[0], 0, 0), (panel.back, 0, 0), "front")
    door = ShapePart("door", "door", (front,), hinge(panel, "bottom", radians(choose(rng, 85, 110))))
    knob = HandleDesign(kind="knob", length=0.028, thickness=0.01, finish="accent")
    at = (middle, height - 0.045)
    handle = make_handle(panel, knob, name="door_handle", parent="door", upright=False, at=at)
    if rng.random() < 0.6:
        heights = (under - board, under - board, under - 0.3, under - 0.36)
        places = (0.25 * depth, 0.19 * depth, POST - 0.005, POST - 0.005)
        pieces.append(prism(np.column_stack([heights, places]), (0, -0.03, 0), (0, 0.03, 0), "leg"))
    axle = (choose(rng, -0.15, 0.1) * depth, y[0] - 0.0015, z[0] + 0.45 * (spring - z[0]))
    return Assembly(pieces, (door, handle, _make_flag(axle, min(0.15, 0.32 * depth))))


def _make_flag(at: Vector, long: float) -> ShapePart:
    """A flag on the right side, which points to the rear and is turned up for outgoing mail."""
    x, y, z = at
    solids = (
        block((x - 0.012, x + long), (y - 0.004, y), around(z, 0.008), "mark"),
        block((x + 0.62 * long, x + long), (y - 0.004, y), (z + 0.008, z + 0.04), "mark"),
    )
    return ShapePart("flag", "knob", solids, rotate(RIGHT, at, np.pi / 2))


def _build_modern(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A box on two legs with a foot plate: a flap over the slot, and a door with a lock below."""
    tall = choose(rng, 0.32, 0.5)
    x, y, low = (KEY - depth / 2, depth / 2), around(0.0, width / 2), height - tall
    legs = [block((0.02, 0.06), around(a, 0.02), (PLATE, low + 0.002), "leg") for a in narrow(y, 0.05)]
    plate = block(around(0.0, depth / 2), y, (0.0, PLATE), "leg")
    return _build_box(rng, Space(x=x, y=y, z=(low, height)), (0.09, tall - 0.09)) + Assembly((*legs, plate))


def _build_parcel(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A column: a flap and a door for letters, and a large door for parcels."""
    x, y = (KEY - depth / 2, depth / 2), around(0.0, width / 2)
    plinth = block((x[0] + 0.05, x[1] - 0.03), narrow(y, 0.03), (0.0, 0.04), "leg")
    rest = height - 0.04 - 0.1
    upper = choose(rng, 0.25, 0.4) * rest
    built = _build_box(rng, Space(x=x, y=y, z=(0.04, height)), (0.1, upper, rest - upper))
    return built + Assembly((plinth,))


def _build_box(rng: np.random.Generator, outer: Space, heights: tuple[float, ...]) -> Assembly:
    """A box whose front is, from the top, a flap over a slot and doors with locks."""
    front, cap = outer.x[0], 0.012
    shell = replace(outer, x=(front + THICK + GAP, outer.x[1]))
    inner, hood = shell.hollow(0.010), shell.x[0] + 0.002
    pieces = [
        *build_shell(shell, inner, "body", "inside"),
        block((front - 0.012, hood), outer.y, (outer.z[1] - cap, outer.z[1]), "body", 0.002),
    ]
    left, upper = bool(rng.random() < 0.5), radians(choose(rng, 92, 115))
    aside, high = sweep_gap(outer.width, THICK), outer.z[1] - cap
    low = high - heights[0]
    built = Assembly(pieces) + _build_flap(front, hood, outer.y, (low, high))
    y = (outer.y[0] + aside, outer.y[1] - 0.001) if left else (outer.y[0] + 0.001, outer.y[1] - aside)
    for k in range(1, len(heights)):
        last = k == len(heights) - 1
        high, low = low, outer.z[0] if last else low - heights[k]
        panel = Panel(x=front, thickness=THICK, y=y, z=narrow((low, high), 0.002))
        shelf = () if last else (block(inner.x, inner.y, around(low, 0.004), "inside"),)
        built += Assembly(shelf, _make_locked_door(panel, f"door_{k}", upper, left=left))
    return built


def _build_flap(front: float, hood: float, y: Range, z: Range) -> Assembly:
    """A flap with a lip in a frame, hinged at its upper edge."""
    x, jamb = (front, hood), 0.028
    jambs = [block(x, side, (z[0] + 0.002, z[1]), "body") for side in margins(y, jamb)]
    frame = (*jambs, block(x, narrow(y, jamb), (z[1] - 0.014, z[1]), "body"))
    panel = Panel(x=front, thickness=THICK, y=narrow(y, 0.03), z=(z[0] + 0.004, z[1] - 0.018))
    lip = block((front - 0.008, front), narrow(panel.y, 0.06), (panel.z[0], panel.z[0] + 0.006), "front")
    flap = (panel.fill("front", 0.001), lip)
    return Assembly(frame, (ShapePart("flap", "door", flap, hinge(panel, "top", radians(70))),))


def _make_locked_door(panel: Panel, name: str, upper: float, *, left: bool) -> tuple[ShapePart, ShapePart]:
    """A door with a lock, and a name card if it fits."""
    solids = [*make_front(panel, FrontDesign(style="flat", frame=0.0, handle=None))]
    y, z = panel.center
    if panel.height < 0.25 and panel.width > 0.2:
        solids.append(block((panel.x - 0.0015, panel.x + 0.003), around(y, 0.04), around(z, 0.014), "paper"))
    door = ShapePart(name, "door", solids, hinge(panel, "right" if left else "left", upper))
    at = (panel.x, panel.y[1] - 0.025 if left else panel.y[0] + 0.025, z)
    return door, make_lock(at, name=f"{name}_lock", parent=name, radius=0.009)


def _build_cluster(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A cluster box: two columns of compartments with doors and locks on a pedestal."""
    foot, wall = choose(rng, 0.35, 0.5), 0.012
    y, front = around(0.0, width / 2), KEY - depth / 2
    shell = Space(x=(front + THICK + GAP, depth / 2), y=y, z=(foot, height))
    inner = shell.hollow(wall)
    built = Assembly(
        (
            *build_shell(shell, inner, "body", "inside"),
            block(around(0.0, 0.1), around(0.0, 0.12), (PLATE, foot), "leg"),
            block(around(0.0, 0.2), around(0.0, 0.2), (0.0, PLATE), "leg"),
            block(inner.x, around(0.0, wall / 2), inner.z, "inside"),
        )
    )
    rows = int(rng.integers(4, 7))
    right = [1.0] * (rows - 2) + [2.0] if rng.random() < 0.6 else [1.0] * rows  # a parcel locker below
    columns = ((0.0, y[1]), (0.0, inner.y[1]), [1.0] * rows), ((y[0], 0.0), (inner.y[0], 0.0), right)
    for column, (span, deep, shares) in enumerate(columns):
        across = narrow(span, sweep_gap(span[1] - span[0], THICK) / 2 + 0.001)
        for k, z in enumerate(share_down((foot, height), shares)):
            panel = Panel(x=front, thickness=THICK, y=across, z=narrow(z, 0.0015))
            door = _make_locked_door(panel, f"door_{column}_{k}", radians(95), left=bool(column))
            last = k == len(shares) - 1
            shelf = () if last else (block(inner.x, deep, around(z[0], 0.004), "inside"),)
            built += Assembly(shelf, door)
    return built


KIND = Kind(
    name=CATEGORY,
    nouns=plurals("mailbox", "letterbox", "letter box", "mail box", "postbox", "post box", "parcel box"),
    hints=(),
    size=(
        by_longest(0.5, 1.8),
        by_height(1.2, note="on a post"),
    ),
    deepest=np.inf,
    diagonal=(0.2, 2.6),
    build="sheet",
    stands="free",
    styles=tuple(STYLES),
    style_words={"apartment": "cluster", "on a post": "rural", "post mounted": "rural"},
    forms={},
    sizes=((0.12, 1.3), (0.1, 0.9), (0.2, 2.0)),
    bare="height",
    make=PLAIN,
    makes={},
    feet=False,
    trade=None,
    synset="mailbox.n.01",
    wikidata=None,
    partnet=None,
    body="mailbox_body",
    places=(),
    holds=None,
    open_front=None,
    lid_stays=False,
    colored=(),
    laid_out=False,
    channel=None,
    word=19,
    draw=draw,
)
