"""Both sides of the limits of faults: what is checked at all, cavities that close, doors that turn."""

import numpy as np
import pytest

from artigen.shapes.fittings.hardware import rotate, slide
from artigen.shapes.primitives import box
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.sketch.cavity import find_cavities
from artigen.sketch.contact import gather_bodies
from artigen.sketch.faults import find_faults
from artigen.sketch.opening import Opener, measure_blocked

PAINT = Finish(kind="plastic", color=(0.5, 0.5, 0.5), accent=(0.4, 0.4, 0.4))


@pytest.mark.parametrize(("count", "moved"), [(4, True), (5, False)])
def test_motions_are_checked_after_at_most_four_faults_at_rest(count: int, moved: bool):  # noqa: FBT001
    """So many pieces of a body hang in the air; besides, a gate is on the way of a slide."""
    plate = box((-0.3, -0.3, 0.0), (0.3, 0.3, 0.01), "paint")
    gate = box((-0.1, -0.05, 0.01), (-0.05, 0.05, 0.05), "paint")
    lost = [box((0.05 * k, 0.2, 0.2), (0.05 * k + 0.01, 0.21, 0.21), "paint") for k in range(count)]
    travel = slide(0.2)
    key = (box((0.0, -0.05, 0.01), (0.1, 0.05, 0.05), "paint"),)
    shape = Shape(
        category="Box",
        seed=0,
        style="plain",
        parts=(
            ShapePart(name="body", label="base", parent=None, primitives=(plate, gate, *lost)),
            ShapePart(name="key", label="knob", parent="body", primitives=key, joint=travel),
        ),
        finishes=(("paint", PAINT),),
    )
    found = [fault.id for fault in find_faults(shape)]
    assert found == ["loose"] * count + ["blocked"] * moved


@pytest.mark.parametrize(("gap", "count"), [(0.45e-6, 1), (0.55e-6, 0)])
def test_walls_close_a_cavity_if_they_touch_to_the_micrometre(gap: float, count: int):
    """Corners are rounded: a slit of half a micrometre is none or a whole one."""
    walls = gather_bodies(
        (
            box((0.0, 0.0, 0.0), (1.0, 1.0, 0.1), "paint"),
            box((0.0, 0.0, 0.1), (0.1, 1.0, 0.9), "paint"),
            box((0.9, 0.0, 0.1), (1.0, 1.0, 0.9), "paint"),
            box((0.1, 0.0, 0.1), (0.9, 0.1, 0.9), "paint"),
            box((0.1, 0.9, 0.1), (0.9, 1.0, 0.9), "paint"),
            box((0.0, 0.0, 0.9 + gap), (1.0, 1.0, 1.0), "paint"),
        )
    )
    assert len(find_cavities(walls, 0)) == count


@pytest.mark.parametrize(("ahead", "blocked"), [(0.95, 1.0), (1.05, 0.0)])
def test_a_door_is_seen_to_open_along_its_first_way_for_a_radian(ahead: float, blocked: float):
    """The end of a door, a metre from its hinge, has a wall before it; the door turns further than that."""
    end = box((-0.005, 0.995, 0.0), (0.005, 1.005, 0.01), "paint")
    wall = box((-ahead - 0.2, 0.5, -0.5), (-ahead, 1.5, 0.5), "paint")
    hinge = rotate((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 1.7)
    own = np.array([0])
    door = Opener(index=1, label="door", joint=hinge, body=own, panel=own)
    assert measure_blocked(gather_bodies((end, wall)), door, np.array([1])) == (blocked, 0.0)
