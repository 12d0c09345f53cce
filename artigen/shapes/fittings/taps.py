"""Taps: mixer cartridges with a lever, cross handles, quarter-turn levers, hand wheels.

Each stands at a point of a face and points along ``out``, its axis of rotation. Lengths are in metres.
"""

from math import radians

import numpy as np

from artigen.shapes.appliances.control_panel import DIAL_GAP
from artigen.shapes.fittings.hardware import rotate
from artigen.shapes.primitives import Primitive, Vector, as_vector, cylinder, polytope
from artigen.shapes.shape import ShapePart

PIVOT = 0.007
"""Radius of the pin that a mixer's lever lifts about."""
TURN = radians(50.0)
"""Range of a mixer's cartridge."""
LIFT = radians(25.0)
"""Range of a mixer's lever (EN 817: 20 to 30 degrees)."""


def along(at: Vector, *steps: tuple[Vector, float]) -> Vector:
    """A point moved by the given lengths along the given directions."""
    return as_vector(np.array(at) + sum((length * np.array(way) for way, length in steps), np.zeros(3)))


def cross(first: Vector, second: Vector) -> Vector:
    """The direction perpendicular to two others."""
    return as_vector(np.cross(first, second).astype(float))


def make_mixer(
    at: Vector,
    out: Vector,
    ahead: Vector,
    *,
    radius: float,
    height: float,
    length: float,
) -> tuple[ShapePart, ShapePart]:
    """A cartridge that turns about ``out`` (temperature) with a lever along ``ahead`` that lifts (flow).

    Args:
        at: Middle of the face that the cartridge stands on.
        out: Axis of the cartridge, away from the face (unit).
        ahead: Direction of the lever, perpendicular to ``out`` (unit).
        radius: Radius of the cartridge.
        height: Height of the cartridge above the face.
        length: Distance from the axis to the tip of the lever.
    """
    aside = cross(ahead, out)
    pin = height + 0.0015 + PIVOT
    body = cylinder(along(at, (out, DIAL_GAP)), along(at, (out, height)), radius, "handle")
    cartridge = ShapePart("lever_cartridge", "knob", (body,), rotate(out, at, TURN))
    ends = [along(at, (out, pin), (aside, side * 0.8 * radius)) for side in (-1, 1)]
    stations = ((0.0, 0.72 * radius, (-0.6 * PIVOT, PIVOT)), (length, 0.4 * radius, (0.006, 0.013)))
    blade = np.array(
        [
            along(at, (out, pin + up), (ahead, run), (aside, side * wide))
            for run, wide, levels in stations
            for side in (-1, 1)
            for up in levels
        ]
    )
    solids = (cylinder(ends[0], ends[1], PIVOT, "handle"), polytope(blade, "handle"))
    lift = rotate(aside, along(at, (out, pin)), LIFT)
    return cartridge, ShapePart("lever", "knob", solids, lift, parent=cartridge.name)


def make_cross_handle(
    at: Vector,
    out: Vector,
    ahead: Vector,
    *,
    name: str,
    reach: float,
    height: float,
    arms: int = 4,
    upper: float = np.pi,
) -> ShapePart:
    """A hub with arms that turns about ``out``: a cross of four, a quarter-turn lever of one.

    Args:
        at: Middle of the face that it stands on.
        out: Its axis, away from the face (unit).
        ahead: Direction of its first arm, perpendicular to ``out`` (unit).
        name: Name of the part.
        reach: Length of an arm from the axis.
        height: Height of the hub's top above the face.
        arms: Number of arms.
        upper: Range (rad).
    """
    aside = cross(out, ahead)
    level, rod = height - 0.008, 0.0055 if arms > 1 else 0.007
    pieces: list[Primitive] = [
        cylinder(along(at, (out, DIAL_GAP)), along(at, (out, 0.55 * height)), 0.013, "handle"),
        cylinder(along(at, (out, 0.55 * height)), along(at, (out, height)), 0.0105, "handle"),
    ]
    for k in range(arms):
        angle = 2 * np.pi * k / arms
        way = along((0.0, 0.0, 0.0), (ahead, float(np.cos(angle))), (aside, float(np.sin(angle))))
        tip = along(at, (out, level), (way, reach))
        pieces.append(cylinder(along(at, (out, level)), tip, rod, "handle"))
        if arms > 1:
            pieces.append(cylinder(along(tip, (way, -0.012)), tip, 1.45 * rod, "handle"))
    return ShapePart(name, "knob", pieces, rotate(out, at, upper))
