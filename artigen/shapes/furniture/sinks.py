"""Sinks: a basin in a worktop and a tap with a turning lever."""

import numpy as np

from artigen.shapes.appliances.cavity import build_rim
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose
from artigen.shapes.fittings.hardware import Space, rotate
from artigen.shapes.primitives import RIGHT, Vector, block, cylinder
from artigen.shapes.ranges import Range, around
from artigen.shapes.shape import ShapePart

TAP_HEIGHT = 0.27
"""Height (m) of the tap above the worktop."""


def make_sink(rng: np.random.Generator, top: Space, span: Range) -> Assembly:
    """A worktop in a box: four boards around a steel basin within the ``span`` of y."""
    width, depth = top.width, top.depth
    under, height = top.z
    long = min(choose(rng, 0.36, 0.6), span[1] - span[0] - 0.1)
    wide = min(choose(rng, 0.32, 0.4), depth - 0.2)
    deep = choose(rng, 0.14, 0.2)
    middle = (span[0] + span[1]) / 2
    x = (0.075 - depth / 2, 0.075 - depth / 2 + wide)
    y = around(middle, long / 2)
    z, (front, side) = (under, height), (depth / 2, width / 2)
    boards = (
        block((-front, x[0]), around(0.0, side), z, "top"),
        block((x[1], front), around(0.0, side), z, "top"),
        block(x, (-side, y[0]), z, "top"),
        block(x, (y[1], side), z, "top"),
    )
    bottom = (height - deep, height - deep + max(0.008, long / 60))
    rim = build_rim(x, y, (bottom[1], height + 0.003), 0.006, "steel")
    basin = Assembly((*boards, block(x, y, bottom, "steel"), *rim))
    return basin + _make_tap((x[1] + 0.055, middle, height), wide)


def _make_tap(foot: Vector, wide: float) -> Assembly:
    """A column with a spout over the basin, and a lever on its side that turns upwards."""
    x, y, z = foot
    tall, reach, radius = TAP_HEIGHT - 0.013, 0.55 * wide + 0.05, 0.013
    spout = (
        cylinder((x, y, z), (x, y, z + 0.012), 0.026, "steel"),
        cylinder((x, y, z + 0.012), (x, y, z + tall), radius, "steel"),
        cylinder((x + 0.8 * radius, y, z + tall), (x - reach, y, z + tall), radius, "steel"),
        cylinder(
            (x - reach + radius, y, z + tall - 0.045), (x - reach + radius, y, z + tall), radius, "steel"
        ),
    )
    side = y - radius - 0.002
    axle = z + 0.07
    lever = (
        cylinder((x, side, axle), (x, side - 0.028, axle), 0.016, "steel"),
        cylinder((x, side - 0.018, axle), (x, side - 0.018, axle + 0.095), 0.007, "steel"),
    )
    turn = rotate(RIGHT, (x, side, axle), np.pi / 2)
    return Assembly(spout, (ShapePart("lever", "knob", lever, turn),))
