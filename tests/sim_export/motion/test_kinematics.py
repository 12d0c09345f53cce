"""What hangs from a link and what must be open first, followed to the end of any chain."""

from dataclasses import replace

import numpy as np
import pytest
from screw_jar import screw_package

from artigen.transforms import joint_motion
from artigen.types import Joint
from sim_export.geometry.hulls import box_hull
from sim_export.motion.kinematics import (
    hanging_links,
    link_displacements,
    needed_fractions,
    object_joints,
    sample_sweep,
)
from sim_export.package import Link, Requirement


def joint(parent: str, child: str) -> Joint:
    return Joint(
        name=f"to_{child}",
        type="revolute",
        parent=parent,
        child=child,
        origin=np.zeros(3),
        axis=np.array([0.0, 0.0, 1.0]),
        upper=1.0,
    )


def need(name: str, needs: str, fraction: float) -> Requirement:
    return Requirement(joint=name, needs=needs, fraction=fraction)


def test_all_that_hangs_from_a_link_is_found_in_any_order_of_joints():
    joints = [joint("b", "c"), joint("a", "b"), joint("a", "d"), joint("c", "e")]
    for order in (joints, joints[::-1]):
        assert hanging_links(order, "b") == {"b", "c", "e"}
        assert hanging_links(order, "a") == {"a", "b", "c", "d", "e"}
        assert hanging_links(order, "e") == {"e"}


def test_a_cycle_ends():
    assert hanging_links([joint("a", "b"), joint("b", "a")], "a") == {"a", "b"}
    assert needed_fractions("x", [need("x", "y", 0.5), need("y", "x", 1.0)]) == {"y": 0.5}


def test_needs_of_needs_count_and_the_largest_share_does():
    needs = [need("tray", "door", 0.5), need("tray", "drawer", 0.2), need("drawer", "door", 0.9)]
    assert needed_fractions("tray", needs) == {"door": 0.9, "drawer": 0.2}
    assert needed_fractions("door", needs) == {}


@pytest.mark.parametrize("order", [1, -1])
def test_an_opening_that_grows_takes_its_own_needs_along(order):
    needs = [need("a", "b", 0.1), need("a", "c", 0.1), need("c", "b", 0.8), need("b", "d", 1.0)]
    assert needed_fractions("a", needs[::order]) == {"b": 0.8, "c": 0.1, "d": 1.0}


@pytest.mark.parametrize(("reach", "poses"), [(0.3999, 101), (0.4001, 102)])
def test_no_point_moves_farther_than_four_millimetres_from_pose_to_pose(reach: float, poses: int):
    """A door that turns by one radian, whose farthest corner is so far (m) from the hinge."""
    hulls = {"body": (), "door": (box_hull(np.zeros(3), np.array([reach, 1e-6, 0.5])),)}
    links = [
        Link(name=name, label=None, parts=(), visuals=(), hulls=own, inertial=None)
        for name, own in hulls.items()
    ]
    door = joint("body", "door")
    assert len(sample_sweep(links, [door], door)) == poses


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_joint_of_a_screw_moves_its_part_as_the_two_joints_of_the_package_do(way: float):
    package = screw_package()
    joints = [replace(one, axis=way * one.axis) if one.is_travel else one for one in package.joints]
    (screw,) = object_joints(joints)
    q = np.linspace(-1.0, 7.0, 9)
    T = link_displacements(package.links, joints, {screw.name: q})
    child = [link.name for link in package.links].index(screw.child)
    np.testing.assert_allclose(joint_motion(screw, q), T[:, child], atol=1e-12)


def test_joints_are_equal_where_all_their_values_are():
    one = joint("a", "b")
    assert one == replace(one)
    assert hash(one) == hash(replace(one))
    for change in ({"upper": 2.0}, {"origin": np.ones(3)}, {"axis": -one.axis}, {"ratio": 1.0}):
        assert replace(one, **change) != one


@pytest.mark.parametrize(("spring", "far"), [(3.0, -6.0), (-3.0, 1.0), (0.0, 0.0)])
def test_a_spring_closes_twice_as_hard_when_open_and_a_counterbalance_carries_a_third(
    spring: float, far: float
):
    sprung = replace(joint("a", "b"), upper=2.0, spring=spring)
    np.testing.assert_allclose(sprung.pull(np.array([0.0, 1.0, 2.0])), [-spring, (far - spring) / 2, far])
