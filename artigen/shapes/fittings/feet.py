"""Stands of furniture: legs, plinths, sled bases, castors and levelling feet."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from artigen.shapes.appliances.cavity import build_rim
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose, choose_one
from artigen.shapes.fittings.hardware import GAP, rotate
from artigen.shapes.fittings.legs import LegKind, make_legs
from artigen.shapes.primitives import (
    FRONT,
    RIGHT,
    ROUND,
    UP,
    Primitive,
    Vector,
    as_vector,
    block,
    cylinder,
)
from artigen.shapes.ranges import Range, around, between, margins, narrow
from artigen.shapes.shape import ShapePart
from artigen.types import Joint

StandKind = Literal["floor", "plinth", "toe_kick", "legs", "sled", "castors", "screw_feet"]
PLAIN_LEGS: tuple[LegKind, ...] = ("square", "tapered", "round", "splayed")
NOTCHED = 0.75
"""Probability that the sides of a toe kick are notched."""
SCREW_TRAVEL = 0.003
"""Travel (m) of a levelling foot."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Stand(Assembly):
    """The stand of a body whose underside is at ``height``."""

    height: float


@dataclass(frozen=True, kw_only=True)
class StandDesign:
    """Type and dimensions (m) of a stand."""

    kind: StandKind
    height: float
    leg: LegKind = "square"
    width: float = 0.04
    """Thickness of a leg or tube; radius of a wheel."""
    notch: float = 0.0
    """Setback of the sides of a toe kick, like its board; 0 if the sides reach the front."""


def design_stand(
    rng: np.random.Generator, kind: StandKind, height: float, legs: Sequence[LegKind] = PLAIN_LEGS
) -> StandDesign:
    """A stand for an object with a total height of ``height`` metres; ``legs`` of a kind that suits it."""
    drawn = choose(rng, 0.0, 1.0)
    leg = choose_one(rng, legs)
    width = choose(rng, 0.03, 0.045)
    notch = choose(rng, 0.05, 0.09) if rng.random() < NOTCHED else 0.0
    low, high = {
        "plinth": (0.05, 0.1),
        "toe_kick": (0.08, 0.12),
        "legs": (0.1, 0.2),
        "sled": (0.1, 0.18),
    }.get(kind, (0.0, 0.0))
    tall = min(low + drawn * (high - low), 0.32 * height)
    if kind == "castors":
        width = 0.022 + 0.01 * drawn
        tall = make_castors((0.0, 1.0), (0.0, 1.0), width, swivel=False).height
    elif kind == "screw_feet":
        tall = make_screw_feet((0.0, 1.0), (0.0, 1.0)).height
    elif kind == "sled":
        width *= 0.7
    return StandDesign(kind=kind, height=tall, leg=leg, width=width, notch=notch)


def make_stand(design: StandDesign, x: Range, y: Range) -> Stand:
    """The stand under a body whose underside is the rectangle x by y."""
    height, edge = design.height, 0.012
    inner_x, inner_y = narrow(x, edge), narrow(y, edge)
    match design.kind:
        case "floor":
            return Stand(height=0.0)
        case "plinth":
            setback = (x[0] + 0.03, x[1] - 0.01)
            return Stand(height=height, pieces=make_plinth(setback, inner_y, height))
        case "toe_kick":
            return Stand(height=height, pieces=make_toe_kick(x, y, height, design.notch))
        case "legs":
            kind, width, long = design.leg, design.width, y[1] - y[0] > 1.35
            legs = make_legs(inner_x, inner_y, height, kind=kind, width=width, finish="leg", middle=long)
            return Stand(height=height, pieces=legs)
        case "sled":
            deep = narrow(y, 0.06)
            return Stand(height=height, pieces=make_sled(inner_x, deep, height, design.width))
        case "castors":
            return make_castors(inner_x, inner_y, design.width, swivel=False)
        case "screw_feet":
            return make_screw_feet(inner_x, inner_y)


def make_toe_kick(x: Range, y: Range, height: float, notch: float = 0.0) -> tuple[Primitive, ...]:
    """Sides that reach the floor and a recessed board between or before them."""
    wall, room, z = 0.018, notch or 0.05, (0.0, height)
    board = (x[0] + room, x[0] + room + wall)
    behind, across = ((board[1], x[1]), y) if notch else (x, narrow(y, wall))
    sides = [block(behind, side, z, "body") for side in margins(y, wall)]
    front = block(board, across, z, "body")
    return (front, *sides) if notch else (*sides, front)


def make_plinth(x: Range, y: Range, height: float) -> tuple[Primitive, ...]:
    """A frame of four boards on the floor under a body; long boards are thicker."""
    wall = max(0.018, max(x[1] - x[0], y[1] - y[0]) / 56)
    return build_rim(x, y, (0.0, height), wall, "body")


def make_sled(x: Range, y: Range, height: float, width: float) -> tuple[Primitive, ...]:
    """A sled base of square tube: left and right, a runner on the floor and two posts."""
    out = []
    for low in (y[0], y[1] - width):
        span = (low, low + width)
        out.append(block(x, span, (0.0, width), "leg"))
        out += [block(post, span, (width, height), "leg") for post in margins(x, width)]
    return tuple(out)


def make_castors(
    x: Range, y: Range, radius: float, *, swivel: bool, pairs: int = 2, lengthwise: bool = False
) -> Stand:
    """Pairs of castors within the rectangle x by y; with ``swivel`` the left forks turn too, or all of three.

    A fork is a plate and two cheeks. It belongs to the body unless it swivels about its vertical axle, as
    at the push bar of a cart. Wheels roll along x, with ``lengthwise`` along y, away from a push bar.
    """
    width, wall = max(0.024, 0.7 * radius), 0.005
    plate = max(0.006, 0.12 * radius)
    height = 2 * radius + GAP + plate + (GAP if swivel else 0.0)
    half = width / 2 + GAP + wall
    room_x, room_y = (half, radius) if lengthwise else (radius, half)
    fixed: list[Primitive] = []
    parts: list[ShapePart] = []
    across = np.linspace(y[0] + room_y, y[1] - room_y, pairs).tolist()
    corners = [(at_x, at_y) for at_x in narrow(x, room_x) for at_y in across]
    for index, (at_x, at_y) in enumerate(corners):
        turning = swivel and (pairs > 2 or at_y > sum(y) / 2)
        thick = plate + (GAP if swivel and not turning else 0.0)
        fork = _make_fork((at_x, at_y), radius, width, wall, thick, lengthwise=lengthwise)
        carrier = "body"
        if turning:
            carrier = f"castor_{index}"
            axle = rotate(UP, (at_x, at_y, height))
            parts.append(ShapePart(carrier, "wheel", fork, axle))
        else:
            fixed += fork
        center = (at_x, at_y, ROUND * radius)
        parts.append(make_wheel(f"wheel_{index}", carrier, center, width, lengthwise=lengthwise))
    return Stand(height=height, pieces=fixed, parts=parts)


def _make_fork(
    at: tuple[float, float],
    radius: float,
    width: float,
    wall: float,
    plate: float,
    *,
    lengthwise: bool,
) -> tuple[Primitive, ...]:
    inner = width / 2 + GAP
    top = 2 * radius + GAP
    ahead, aside = (at[1], at[0]) if lengthwise else at
    spans = [
        (around(ahead, 0.5 * radius), (aside + low, aside + low + wall), (0.75 * radius, top))
        for low in (inner, -inner - wall)
    ]
    spans.insert(0, (around(ahead, 0.8 * radius), around(aside, inner + wall), (top, top + plate)))
    return tuple(block(b, a, z, "steel") if lengthwise else block(a, b, z, "steel") for a, b, z in spans)


def make_wheel(
    name: str, parent: str, center: Vector, width: float, *, lengthwise: bool = False
) -> ShapePart:
    """A tyre with a slightly protruding hub that rolls along x, or along y.

    In simulators it is a prism that rests on a flat side.
    """
    radius, axle = center[2] / ROUND, FRONT if lengthwise else RIGHT
    tyre, core = (
        cylinder(
            as_vector(np.array(center) - half * np.array(axle)),
            as_vector(np.array(center) + half * np.array(axle)),
            share * radius,
            finish,
        )
        for half, share, finish in ((width / 2, 1.0, "rubber"), (width / 2 + 0.001, 0.55, "steel"))
    )
    return ShapePart(name, "wheel", (tyre, core), rotate(axle, center), parent=parent)


def make_screw_feet(x: Range, y: Range) -> Stand:
    """Four levelling feet, screws beside brackets that rise by `SCREW_TRAVEL` in 1.5 turns.

    A foot is a pad and a stem, which stays clear of the underside when screwed in. The brackets reach the
    floor and bear the load, since threads yield in simulators.
    """
    radius, pad, stem = 0.022, 0.012, 0.007
    room = SCREW_TRAVEL + GAP
    bracket = 0.03
    height = pad + room + bracket
    turns = 1.5 * 2 * np.pi
    fixed: list[Primitive] = []
    parts: list[ShapePart] = []
    for index, (at_x, at_y) in enumerate((a, b) for a in narrow(x, radius) for b in y):
        side = 1.0 if at_y < sum(y) / 2 else -1.0
        at_y += side * radius
        beside = between(at_y + side * (radius + GAP), at_y + side * (radius + GAP + 0.016))
        fixed.append(block(around(at_x, 0.02), beside, (0.0, height), "steel"))
        solids = (
            cylinder((at_x, at_y, 0.0), (at_x, at_y, pad), radius, "rubber"),
            cylinder((at_x, at_y, pad), (at_x, at_y, height - room), stem, "steel"),
        )
        thread = Joint(
            type="screw",
            axis=np.array(UP),
            origin=np.array((at_x, at_y, 0.0)),
            upper=turns,
            pitch=SCREW_TRAVEL / turns,
        )
        parts.append(ShapePart(f"foot_{index}", "knob", solids, thread))
    return Stand(height=height, pieces=fixed, parts=parts)
