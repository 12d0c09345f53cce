"""Drums of washing machines and the round doors in front of them."""

import numpy as np

from artigen.shapes.appliances.rings import build_ring
from artigen.shapes.fittings.hardware import GAP, Panel, rotate
from artigen.shapes.primitives import (
    BACK,
    FRONT,
    UP,
    Primitive,
    Vector,
    block,
    cylinder,
    move,
    polygon,
    prism,
)
from artigen.shapes.ranges import Range, around
from artigen.shapes.shape import ShapePart

SHEET = 0.0115
"""Thickness of a drum's wall (m); engines mishandle thinner walls of this length."""


def make_drum(center: Vector, axis: str, span: Range, radius: float, *, paddles: int) -> ShapePart:
    """A drum about an axis ("x" or "z") through ``center``, open at the beginning (x) or end (z) of ``span``.

    Its gap to the bearing of the housing, behind its closed end, is `GAP`.
    """
    closed = span[1] if axis == "x" else span[0]
    inwards = -SHEET if axis == "x" else SHEET
    radii = (radius, (radius + SHEET) / float(np.cos(np.pi / 16)))
    pieces = list(build_ring(center, axis, span, (radii, radii), "steel"))

    def point(along: float) -> Vector:
        x, y, z = center
        return (x + along, y, z) if axis == "x" else (x, y, z + along)

    pieces.append(cylinder(point(closed), point(closed + inwards), radius + 0.6 * SHEET, "steel"))
    low, high = span[0] + 0.12 * (span[1] - span[0]), span[1] - 0.02
    if axis == "x":
        paddle = block((low, high), (radius - 0.05, radius + 0.004), around(0.0, 0.016), "plastic")
        turns = [2 * np.pi * (k + 0.5) / paddles for k in range(paddles)]
        pieces += [move(paddle, center, turn=turn, about=BACK) for turn in turns]
    elif paddles:
        pieces += _build_agitator(point(span[0] + SHEET), 0.75 * (span[1] - span[0]), paddles)
    return ShapePart("drum", "tray", pieces, rotate(FRONT if axis == "x" else UP, center))


def fit_radius(room: float) -> float:
    """Inner radius of a drum with ``room`` metres around its axis."""
    return float(room * np.cos(np.pi / 16)) - SHEET


def build_bearing(drum_end: float, wall: float, center: Vector, axis: str) -> Primitive:
    """The bearing of a drum, from the housing's ``wall`` to `GAP` before the drum, along the axis."""
    x, y, z = center
    gap = GAP if wall > drum_end else -GAP
    ends = [(drum_end + gap, y, z), (wall, y, z)] if axis == "x" else [(x, y, drum_end + gap), (x, y, wall)]
    return cylinder(ends[0], ends[1], 0.06, "rubber")


def build_porthole(panel: Panel, glass: float, depth: float, finish: str) -> tuple[Primitive, ...]:
    """A round door that fills its square panel: a ring that rises towards the glass, and a bowl behind it.

    Args:
        panel: Square around the door.
        glass: Radius of the bowl's opening (m).
        depth: Depth of the bowl behind the panel (m).
        finish: Role of the finish of the glass.
    """
    y, z = panel.center
    center, radius, thickness = (panel.x, y, z), panel.width / 2, panel.thickness
    rim = build_ring(
        center, "x", (0.0, thickness), ((glass, radius - 0.022), (glass, radius)), "front", sides=20
    )
    pane = cylinder((panel.x + 0.008, y, z), (panel.back, y, z), glass * 1.02, finish)
    mouth = 0.97 * glass * polygon(16)
    bowl = prism(mouth, (panel.back, y, z), (panel.back + depth, y, z), finish, taper=0.72)
    return (*rim, pane, bowl)


def _build_agitator(foot: Vector, height: float, fins: int) -> list[Primitive]:
    """The agitator of a drum: a post with fins."""
    x, y, z = foot
    post = cylinder((x, y, z), (x, y, z + height), 0.045, "plastic")
    cap = cylinder((x, y, z), (x, y, z + 0.03), 0.13, "plastic")
    blades = [
        move(
            block((0.03, 0.11), around(0.0, 0.008), (z + 0.02, z + 0.6 * height), "plastic"),
            (x, y, 0.0),
            turn=2 * np.pi * k / fins,
        )
        for k in range(fins)
    ]
    return [post, cap, *blades]
