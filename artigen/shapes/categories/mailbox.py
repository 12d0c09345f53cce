"""Mailbox: an arched box with a flag on a post, a box with a flap on legs, a parcel locker, a cluster box.

USPS-STD-7C places the bottom of a roadside box 1.04 to 1.14 m above the road; boxes measure 0.16 m x 0.48 m x
0.19 m to 0.29 m x 0.58 m x 0.38 m. EN 13724 has slots of 230 to 280 mm by 30 to 35 mm for C4 letters.
"""

from dataclasses import replace
from math import radians

import numpy as np

from artigen.shapes.appliances.cavity import build_shell
from artigen.shapes.assembly import Assembly, draw_styled
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.draw import Draft, Wish
from artigen.shapes.fittings.fronts import FrontDesign, make_door
from artigen.shapes.fittings.handles import HandleDesign, make_handle
from artigen.shapes.fittings.hardware import GAP, Panel, Range, Space, hinge, narrow, rotate, sweep_gap
from artigen.shapes.fittings.lids import build_roof
from artigen.shapes.fittings.locks import make_lock
from artigen.shapes.primitives import RIGHT, Primitive, block, box, move, prism
from artigen.shapes.shape import ShapePart
from artigen.shapes.surfaces.finishes import Color, Finish
from artigen.shapes.surfaces.materials import LACQUERS, make_lacquer, make_metal, make_stone, make_wood
from artigen.shapes.surfaces.palette import draw_palette

CATEGORY = "Mailbox"
STYLES = {"rural": 3.0, "modern": 2.5, "parcel": 1.5, "cluster": 1.2}
SIZES: dict[str, tuple[Range, Range, Range]] = {
    "rural": ((0.17, 0.29), (0.46, 0.6), (1.25, 1.5)),
    "modern": ((0.3, 0.42), (0.16, 0.3), (1.05, 1.3)),
    "parcel": ((0.38, 0.52), (0.34, 0.46), (1.05, 1.35)),
    "cluster": ((0.6, 0.85), (0.4, 0.5), (1.4, 1.6)),
}
"""Width, depth and height (m)."""
PAINTS: tuple[Color, ...] = (
    LACQUERS["black"], LACQUERS["anthracite"], LACQUERS["white"], (0.62, 0.14, 0.13), (0.16, 0.26, 0.46),
    (0.18, 0.33, 0.24), (0.60, 0.61, 0.61), (0.86, 0.68, 0.12),
)  # fmt: skip
WALL = 0.008
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
        "mark": make_lacquer(
            (0.72, 0.10, 0.10) if paint.color != PAINTS[3] else (0.90, 0.90, 0.88), gloss=0.4
        ),
        "paper": make_lacquer((0.92, 0.92, 0.90)),
    }


def _build_rural(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """An arched box with a front door and a flag on its right side, on a post in a block."""
    flag, grip = 0.0055, 0.03
    x, y = (grip - depth / 2, depth / 2), (flag - width / 2, width / 2)
    half, middle = (y[1] - y[0]) / 2, (y[0] + y[1]) / 2
    high = half + choose(rng, 0.5, 0.8) * (y[1] - y[0])
    z = (height - high, height)
    spring = height - half
    turns = np.linspace(0.0, np.pi, 9)
    arch = np.array([(middle + half * np.cos(t), spring + half * np.sin(t)) for t in turns])
    outline = np.concatenate(
        [[(y[1], z[0])], arch, [(y[0], z[0])]]
    )  # (y, z), from the left over the top to the right
    thick = 0.010
    start = x[0] + thick + GAP
    walls = [
        move(solid, turn=np.pi / 2)
        for solid in build_roof(outline[::-1], WALL, (-x[1], -start), "body", ends=False)
    ]
    floor = block((start, x[1]), y, (z[0] - 0.006, z[0] + 0.004), "body")
    rear = prism(outline, (x[1] - WALL, 0, 0), (x[1], 0, 0), "body")
    front = prism(outline, (x[0], 0, 0), (x[0] + thick, 0, 0), "front")
    panel = Panel(x=x[0], thickness=thick, y=y, z=z)
    door = ShapePart("door", "door", (front,), hinge(panel, "bottom", radians(choose(rng, 85, 110))))
    design = HandleDesign(kind="knob", length=0.028, thickness=0.01, finish="accent")
    handle = make_handle(
        panel, design, name="door_handle", parent="door", upright=False, at=(middle, height - 0.045)
    )
    post, stone = 0.045, 0.16
    under = z[0] - 0.006
    board = 0.022
    pieces = [
        *walls, floor, rear,
        box((-0.38 * depth, -0.4 * width, under - board), (0.42 * depth, 0.4 * width, under), "leg"),
        box((-post, -post, 0.05), (post, post, under - board), "leg"),
        box((-stone, -width / 2, 0.0), (stone, width / 2, 0.05), "foot"),
    ]  # fmt: skip
    if rng.random() < 0.6:
        heights = (under - board, under - board, under - 0.3, under - 0.36)
        places = (0.25 * depth, 0.19 * depth, post - 0.005, post - 0.005)
        profile = np.column_stack([heights, places])
        brace = prism(profile, (0, -0.03, 0), (0, 0.03, 0), "leg")
        pieces.append(brace)
    at = (choose(rng, -0.15, 0.1) * depth, y[0] - 0.0015, z[0] + 0.45 * (spring - z[0]))
    return Assembly(pieces, (door, handle, _make_flag(at, min(0.15, 0.32 * depth))))


def _make_flag(at: tuple[float, float, float], long: float) -> ShapePart:
    """A flag on the right side, which points to the rear and is turned up for outgoing mail."""
    x, y, z = at
    solids = (
        box((x - 0.012, y - 0.004, z - 0.008), (x + long, y, z + 0.008), "mark"),
        box((x + 0.62 * long, y - 0.004, z + 0.008), (x + long, y, z + 0.04), "mark"),
    )
    turn = rotate(RIGHT, (x, y, z), np.pi / 2)
    return ShapePart("flag", "knob", solids, turn)


def _build_modern(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A box on two legs with a foot plate: a flap over the slot, and a door with a lock below."""
    tall = choose(rng, 0.32, 0.5)
    x, y = (KEY - depth / 2, depth / 2), (-width / 2, width / 2)
    legs = [
        box((0.02, a - 0.02, 0.012), (0.06, a + 0.02, height - tall + 0.002), "leg") for a in narrow(y, 0.05)
    ]
    plate = block((-depth / 2, depth / 2), y, (0.0, 0.012), "leg")
    built = _build_box(rng, Space(x=x, y=y, z=(height - tall, height)), (0.09, tall - 0.09))
    return built + Assembly((*legs, plate))


def _build_parcel(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A column: a flap and a door for letters, and a large door for parcels."""
    x, y = (KEY - depth / 2, depth / 2), (-width / 2, width / 2)
    plinth = block((x[0] + 0.05, x[1] - 0.03), narrow(y, 0.03), (0.0, 0.04), "leg")
    rest = height - 0.04 - 0.1
    upper = choose(rng, 0.25, 0.4) * rest
    return _build_box(rng, Space(x=x, y=y, z=(0.04, height)), (0.1, upper, rest - upper)) + Assembly(
        (plinth,)
    )


def _build_box(rng: np.random.Generator, outer: Space, heights: tuple[float, ...]) -> Assembly:
    """A box whose front is, from the top, a flap over a slot and doors with locks."""
    thick = 0.012
    front, wall = outer.x[0], 0.010
    shell = Space(x=(front + thick + GAP, outer.x[1]), y=outer.y, z=outer.z)
    inner = Space(x=(shell.x[0], outer.x[1] - wall), y=narrow(outer.y, wall), z=narrow(outer.z, wall))
    pieces: list[Primitive] = list(build_shell(shell, inner, "body", "inside"))
    roof = block(
        (front - 0.012, shell.x[0] + 0.002), outer.y, (outer.z[1] - 0.012, outer.z[1]), "body", 0.002
    )
    pieces.append(roof)
    left = bool(rng.random() < 0.5)
    upper = radians(choose(rng, 92, 115))
    parts: list[ShapePart] = []
    top = outer.z[1] - 0.012
    for k, high in enumerate(heights):
        bottom = outer.z[0] if k == len(heights) - 1 else top - high
        room = sweep_gap(outer.y[1] - outer.y[0], thick)
        across = (outer.y[0] + (0.001 if not left else room), outer.y[1] - (room if not left else 0.001))
        if k == 0:
            panel = Panel(x=front, thickness=thick, y=narrow(outer.y, 0.03), z=(bottom + 0.004, top - 0.018))
            frame = [
                box(
                    (front, outer.y[0], bottom + 0.002), (shell.x[0] + 0.002, outer.y[0] + 0.028, top), "body"
                ),
                box(
                    (front, outer.y[1] - 0.028, bottom + 0.002), (shell.x[0] + 0.002, outer.y[1], top), "body"
                ),
                block((front, shell.x[0] + 0.002), narrow(outer.y, 0.028), (top - 0.014, top), "body"),
            ]
            pieces += frame
            lip = block(
                (front - 0.008, front), narrow(panel.y, 0.06), (panel.z[0], panel.z[0] + 0.006), "front"
            )
            slab = block((front, panel.back), panel.y, panel.z, "front", 0.001)
            motion = hinge(panel, "top", radians(70))
            parts.append(ShapePart("flap", "door", (slab, lip), motion))
        else:
            panel = Panel(x=front, thickness=thick, y=across, z=(bottom + 0.002, top - 0.002))
            parts += _make_locked_door(panel, f"door_{k}", upper, left=left)
        if k < len(heights) - 1 and k > 0:
            pieces.append(
                block((shell.x[0], inner.x[1]), inner.y, (bottom - 0.004, bottom + 0.004), "inside")
            )
        top = bottom
    return Assembly(pieces, parts)


def _make_locked_door(panel: Panel, name: str, upper: float, *, left: bool) -> list[ShapePart]:
    """A door with a lock, and a name card if it fits."""
    plain = FrontDesign(style="flat", frame=0.0, handle=None)
    door = make_door(panel, plain, name=name, parent="body", edge="right" if left else "left", upper=upper)[0]
    at = panel.y[1] - 0.025 if left else panel.y[0] + 0.025
    if panel.height < 0.25 and panel.width > 0.2:  # name card
        middle = panel.center
        low = (panel.x - 0.0015, middle[0] - 0.04, middle[1] - 0.014)
        card = box(low, (panel.x + 0.003, middle[0] + 0.04, middle[1] + 0.014), "paper")
        door = replace(door, primitives=(*door.primitives, card))
    return [door, make_lock((panel.x, at, panel.center[1]), name=f"{name}_lock", parent=name, radius=0.009)]


def _build_cluster(rng: np.random.Generator, width: float, depth: float, height: float) -> Assembly:
    """A cluster box: columns of compartments with doors and locks on a pedestal."""
    foot = choose(rng, 0.35, 0.5)
    x, y = (KEY - depth / 2, depth / 2), (-width / 2, width / 2)
    thick, wall = 0.012, 0.012
    shell = Space(x=(x[0] + thick + GAP, x[1]), y=y, z=(foot, height))
    inner = Space(x=(shell.x[0], x[1] - wall), y=narrow(y, wall), z=(foot + wall, height - wall))
    pieces: list[Primitive] = [
        *build_shell(shell, inner, "body", "inside"),
        box((-0.1, -0.12, 0.012), (0.1, 0.12, foot), "leg"),
        box((-0.2, -0.2, 0.0), (0.2, 0.2, 0.012), "leg"),
    ]
    columns = 2
    rows = int(rng.integers(4, 7))
    tall = rng.random() < 0.6  # a parcel locker below one column
    middle = 0.0
    pieces.append(block((shell.x[0], inner.x[1]), (middle - wall / 2, middle + wall / 2), inner.z, "inside"))
    parts: list[ShapePart] = []
    for column in range(columns):
        span = (middle, y[1]) if column == 0 else (y[0], middle)
        count = rows if not (tall and column) else rows - 2
        shares = [1.0] * count + ([2.0] if tall and column else [])
        tops = height - np.concatenate([[0.0], np.cumsum(shares)]) / sum(shares) * (height - foot)
        deep = (inner.y[0], middle) if column else (middle, inner.y[1])
        for k, high in enumerate(tops[:-1].tolist()):
            low = float(tops[k + 1])
            room = sweep_gap(span[1] - span[0], thick) / 2 + 0.001
            panel = Panel(x=x[0], thickness=thick, y=narrow(span, room), z=(low + 0.0015, high - 0.0015))
            name = f"door_{column}_{k}"
            parts += _make_locked_door(panel, name, radians(95), left=bool(column))
            if k < len(shares) - 1:
                pieces.append(block((shell.x[0], inner.x[1]), deep, (low - 0.004, low + 0.004), "inside"))
    return Assembly(pieces, parts)
