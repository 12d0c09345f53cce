"""A round table whose top rises on a screw."""

import numpy as np

from artigen.shapes.appliances.cavity import build_rim
from artigen.shapes.assembly import Assembly
from artigen.shapes.choices import choose
from artigen.shapes.draw import Size
from artigen.shapes.fittings.legs import make_column
from artigen.shapes.primitives import UP, block, cylinder
from artigen.shapes.ranges import around
from artigen.shapes.shape import ShapePart
from artigen.types import Joint


def build_screw_table(
    rng: np.random.Generator, size: Size, thickness: float, *, turned: bool = False
) -> Assembly:
    """A round top of a thickness (m) on a threaded spindle in a column, possibly ``turned``, on a foot."""
    width, depth, height = size
    radius = min(width, depth) / 2
    rise = choose(rng, 0.07, 0.12)
    spindle, gap, wall = 0.022, 0.0025, 0.014
    foot = choose(rng, 0.02, 0.035)
    under = height - thickness
    plate = under - 0.012  # a flange under the top holds the spindle
    mouth = plate - gap
    start = mouth - rise - 0.12
    outer = spindle + gap + wall
    tube = around(0.0, outer)
    column = build_rim(tube, tube, (start, mouth), wall, "leg", sides=True)
    if rng.random() < 0.5:
        base = [cylinder((0.0, 0.0, 0.0), (0.0, 0.0, foot), 0.62 * radius, "leg")]
    else:
        arm, half = 0.8 * radius, 0.03
        base = [
            block(around(0.0, arm), around(0.0, half), (0.0, foot), "leg"),
            block(around(0.0, half), (-arm, -half), (0.0, foot), "leg"),
            block(around(0.0, half), (half, arm), (0.0, foot), "leg"),
        ]
    span = (foot, start)
    post = (block(around(0.0, outer), around(0.0, outer), span, "leg"),)
    if turned:
        post = make_column(span, 2 * outer, "leg")
    turns = choose(rng, 2.5, 4.0) * 2 * np.pi
    top = (
        cylinder((0.0, 0.0, under), (0.0, 0.0, height), radius, "top"),
        cylinder((0.0, 0.0, plate), (0.0, 0.0, under), min(0.09, 0.4 * radius), "steel"),
        cylinder((0.0, 0.0, start + gap), (0.0, 0.0, plate), spindle, "steel"),
    )
    thread = Joint(type="screw", axis=np.array(UP), upper=turns, pitch=rise / turns)
    part = ShapePart("top", "shelf", top, thread)
    return Assembly((*base, *post, *column), (part,))
