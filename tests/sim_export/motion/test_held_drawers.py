"""Drawers stay held."""

import numpy as np
import pytest

from artigen.types import Joint
from sim_export.geometry.hulls import box_hull
from sim_export.motion.held_drawers import held_length, keep_drawers_held
from sim_export.package import Link


def chest(upper: float) -> tuple[tuple[Link, ...], tuple[Joint, ...], dict]:
    """A carcass from x = 0 to 1 and a drawer of depth 0.8 that comes out along -x."""
    carcass = box_hull(np.zeros(3), np.ones(3))
    drawer = box_hull(np.array([0.0, 0.1, 0.1]), np.array([0.8, 0.9, 0.4]))
    links = (
        Link(name="base", label=None, parts=(), visuals=(), hulls=(), inertial=None),
        Link(name="link_0", label="drawer", parts=("drawer",), visuals=(), hulls=(drawer,), inertial=None),
        Link(name="link_1", label="base", parts=("body",), visuals=(), hulls=(carcass,), inertial=None),
    )
    joints = (
        Joint(
            name="joint_0", type="prismatic", parent="link_1", child="link_0",
            origin=np.zeros(3), axis=np.array([-1.0, 0.0, 0.0]), upper=upper,
        ),
        Joint(
            name="joint_1", type="fixed", parent="base", child="link_1",
            origin=np.zeros(3), axis=np.array([1.0, 0.0, 0.0]),
        ),
    )  # fmt: skip
    return links, joints, {"link_0": drawer.vertices}


@pytest.mark.parametrize("upper", [0.75, 0.8, 1.0])
def test_a_drawer_that_would_fall_out_is_held_by_exactly_the_share(upper):
    links, joints, panels = chest(upper)
    kept, records = keep_drawers_held(links, joints, panels)
    carcass, own = np.array([-1.0, 0.0]), panels["link_0"] @ joints[0].axis
    assert held_length(own, carcass, kept[0].upper) == pytest.approx(0.12 * 0.8)
    assert len(records) == 1


def test_a_drawer_that_stays_inside_is_left_alone():
    links, joints, panels = chest(0.5)
    kept, records = keep_drawers_held(links, joints, panels)
    assert kept[0] is joints[0]
    assert records == ()


def test_a_limit_that_makes_no_sense_is_reported_and_not_repaired():
    links, joints, panels = chest(5.0)
    kept, records = keep_drawers_held(links, joints, panels)
    assert kept[0].upper == 5.0
    assert "too little range" in records[0]


@pytest.mark.parametrize(("share", "upper"), [(0.51, 0.704), (0.49, 0.704 / 0.49)])
def test_a_limit_is_lowered_if_half_of_the_range_is_left(share: float, upper: float):
    """A drawer of 0.8 m is held up to 0.704 m, of which its range is so much longer."""
    links, joints, panels = chest(0.704 / share)
    kept, _ = keep_drawers_held(links, joints, panels)
    assert kept[0].upper == pytest.approx(upper)
