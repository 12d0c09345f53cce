"""Sinks: a basin in a worktop and a tap with a turning lever."""

from dataclasses import dataclass

import numpy as np

from artigen.shapes.choices import choose
from artigen.shapes.fittings.hardware import Range, Space, around, narrow, rotate
from artigen.shapes.primitives import RIGHT, Primitive, cylinder
from artigen.shapes.shape import ShapePart

TAP_HEIGHT = 0.27
"""Height (m) of the tap above the worktop."""


@dataclass(frozen=True, kw_only=True)
class Sink:
    """A worktop with its basin, and the lever of the tap."""

    primitives: tuple[Primitive, ...]
    parts: tuple[ShapePart, ...]


def make_sink(rng: np.random.Generator, top: Space, span: Range, *, parent: str) -> Sink:
    """A worktop in a box: four boards around a steel basin within the ``span`` of y."""
    width, depth = top.width, top.depth
    under, height = top.z
    long = min(choose(rng, 0.36, 0.6), span[1] - span[0] - 0.1)
    wide = min(choose(rng, 0.32, 0.4), depth - 0.2)
    deep = choose(rng, 0.14, 0.2)
    middle = (span[0] + span[1]) / 2
    x = (0.075 - depth / 2, 0.075 - depth / 2 + wide)
    y = around(middle, long / 2)
    z = (under, height)
    boards = [
        Space(x=(-depth / 2, x[0]), y=around(0.0, width / 2), z=z),
        Space(x=(x[1], depth / 2), y=around(0.0, width / 2), z=z),
        Space(x=x, y=(-width / 2, y[0]), z=z),
        Space(x=x, y=(y[1], width / 2), z=z),
    ]
    wall, floor, rim = 0.006, max(0.008, long / 60), height + 0.003
    bottom = (height - deep, height - deep + floor)
    sides = (bottom[1], rim)
    basin = [
        Space(x=x, y=y, z=bottom),
        Space(x=(x[0], x[0] + wall), y=y, z=sides),
        Space(x=(x[1] - wall, x[1]), y=y, z=sides),
        Space(x=narrow(x, wall), y=(y[0], y[0] + wall), z=sides),
        Space(x=narrow(x, wall), y=(y[1] - wall, y[1]), z=sides),
    ]
    tap, lever = _make_tap((x[1] + 0.055, middle, height), wide, parent)
    solids = [board.fill("top") for board in boards] + [sheet.fill("steel") for sheet in basin]
    return Sink(primitives=(*solids, *tap), parts=(lever,))


def _make_tap(
    foot: tuple[float, float, float], wide: float, parent: str
) -> tuple[tuple[Primitive, ...], ShapePart]:
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
    return spout, ShapePart("lever", "knob", lever, turn, parent=parent)
