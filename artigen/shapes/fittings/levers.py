"""Lever handles of doors and windows: a rose, a neck and a grip that a hand presses down or turns.

Usual sizes (DIN 18255): roses of 50 to 54 mm, grips of 105 to 140 mm whose middle is 50 to 60 mm away from
the leaf.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, get_args

import numpy as np

from artigen.shapes.choices import choose, choose_one
from artigen.shapes.fittings.tubes import lay_pipe, lean_rod
from artigen.shapes.primitives import Primitive, Vector, as_vector, cylinder, rounded_box
from artigen.shapes.ranges import Range

LeverKind = Literal["round", "square", "curved"]
LEVER_KINDS: tuple[LeverKind, ...] = get_args(LeverKind)
BEND = 0.018
"""Radius (m) of the bend between neck and grip."""
ROSE_GAP = 0.0015
"""Gap (m) between the leaf and a rose that turns with its lever."""


@dataclass(frozen=True, kw_only=True)
class LeverDesign:
    """One model of lever handle (m)."""

    kind: LeverKind
    length: float
    """Distance from the axis to the end of the grip."""
    reach: float
    """Distance from the leaf to the far side of the grip."""
    thickness: float = 0.019
    rose: float = 0.026
    """Radius of the rose."""


def design_lever(rng: np.random.Generator, length: Range = (0.115, 0.14), reach: float = 0.06) -> LeverDesign:
    """Draws a lever of one of three kinds."""
    kind = choose_one(rng, LEVER_KINDS)
    return LeverDesign(kind=kind, length=choose(rng, *length), reach=reach)


def build_lever(
    design: LeverDesign, at: Vector, *, out: float, along: tuple[float, float] = (-1.0, 0.0)
) -> tuple[Primitive, ...]:
    """The pieces of one lever on a face at ``at``.

    Args:
        design: The model.
        at: Where its axis meets the face.
        out: -1 on a front, which looks along -x, 1 on a rear face.
        along: Unit direction (y, z) of the grip.
    """
    x, y, z = at
    half = design.thickness / 2
    middle = design.reach - half

    def point(ahead: float, run: float) -> Vector:
        return x + out * ahead, y + along[0] * run, z + along[1] * run

    rose = cylinder(point(ROSE_GAP, 0.0), point(ROSE_GAP + 0.008, 0.0), design.rose, "handle")
    if design.kind == "square":
        neck = cylinder(point(0.009, 0.0), point(middle, 0.0), 0.8 * half, "handle")
        across = 1.15 * half
        corners = np.array([point(middle - 0.7 * half, -half), point(middle + half, design.length)])
        wide = np.array([0.0, abs(along[1]), abs(along[0])]) * across
        low, high = corners.min(axis=0) - wide, corners.max(axis=0) + wide
        grip = rounded_box(as_vector(low), as_vector(high), 0.0025, "handle")
        return rose, neck, grip
    straight = 0.55 if design.kind == "curved" else 1.0
    path = [point(0.009, 0.0), point(middle, 0.0), point(middle, straight * design.length)]
    grip = lay_pipe(path, half, BEND, "handle", pieces=2)
    if design.kind == "round":
        return rose, *grip
    stations = ((0.0, 0.55, half), (0.004, 0.8, 0.9 * half), (0.014, 1.0, 0.75 * half))
    tail = [
        lean_rod(
            point(middle - before[0], before[1] * design.length),
            point(middle - after[0], after[1] * design.length),
            (before[2], after[2]),
            "handle",
        )
        for before, after in pairwise(stations)
    ]
    return rose, *grip, *tail
