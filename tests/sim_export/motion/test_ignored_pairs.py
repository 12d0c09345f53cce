"""Pairs of links without contact: screws, what touches, and what never meets."""

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from artigen.types import Joint
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import convex_hull
from sim_export.motion.ignored_pairs import ignored_pairs, kept_distance
from sim_export.motion.kinematics import link_displacements
from sim_export.package import Hull, Link, SimPackage


def box(low, high) -> Hull:
    signs = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
    return convex_hull(np.asarray(low) + signs * (np.asarray(high) - np.asarray(low)))


def joint(
    number: int,
    axis,
    origin=(0.0, 0.0, 0.0),
    upper: float = 1.0,
    kind: Literal["fixed", "prismatic", "revolute", "continuous"] = "prismatic",
    parent: str = "link_9",
    child: str | None = None,
) -> Joint:
    return Joint(
        name=f"joint_{number}",
        type=kind,
        parent=parent,
        child=child or f"link_{number}",
        origin=np.asarray(origin, dtype=float),
        axis=np.asarray(axis, dtype=float),
        upper=upper,
    )


def package(joints, **hulls) -> SimPackage:
    links = tuple(
        Link(name=name, label=None, parts=(), visuals=(), hulls=(hull,), inertial=None)
        for name, hull in hulls.items()
    )
    return SimPackage(name="a", category="Table", visual="source", links=links, joints=tuple(joints))


FAR = box([9.0, 9.0, 9.0], [9.1, 9.1, 9.1])


@pytest.mark.parametrize(
    ("least", "listed"), [(0.9e-3, False), (1.1e-3, True), (19.9e-3, True), (20.1e-3, False)]
)
def test_links_that_slide_towards_each_other_are_listed_by_how_near_they_come(least, listed):
    made = package(
        [joint(0, [1, 0, 0], upper=0.1), joint(1, [-1, 0, 0], upper=0.1)],
        link_0=box([0.0, 0.0, 0.0], [0.1, 0.1, 0.1]),
        link_1=box([0.3 + least, 0.0, 0.0], [0.4, 0.1, 0.1]),
        link_9=FAR,
    )
    assert (ignored_pairs(made) == (("link_0", "link_1"),)) == listed


@pytest.mark.parametrize(("least", "listed"), [(0.9e-3, False), (1.15e-3, True)])
def test_square_knobs_are_listed_unless_their_corners_meet(least, listed):
    side = 0.03
    center = np.array([side * np.sqrt(2.0) + least, 0.0, 0.0])
    half = np.array([side / 2.0, side / 2.0, 0.01])
    knobs = {"link_0": box(-half, half), "link_1": box(center - half, center + half)}
    turns = [
        joint(k, [0, 0, 1], at, upper=2.0 * np.pi, kind="continuous")
        for k, at in enumerate((np.zeros(3), center))
    ]
    made = package(turns, **knobs, link_9=FAR)
    assert (ignored_pairs(made) == (("link_0", "link_1"),)) == listed


@pytest.mark.parametrize(("travel", "listed"), [(1.13, True), (1.18, False)])
def test_pairs_that_need_more_poses_are_not_listed(travel, listed):
    """A bar that slides beside a longer one at 10 mm: halved six times, 127 poses, for up to 1.152 m."""
    made = package(
        [joint(0, [1, 0, 0], upper=travel), joint(1, [0, 1, 0], upper=1e-9)],
        link_0=box([0.0, 0.0, 0.0], [1.0, 0.1, 0.1]),
        link_1=box([-1.0, 0.11, 0.0], [8.0, 0.2, 0.1]),
        link_9=FAR,
    )
    assert (ignored_pairs(made) == (("link_0", "link_1"),)) == listed


@pytest.mark.parametrize(("end", "listed"), [(0.575, True), (0.59, False)])
def test_pairs_are_measured_at_128_poses_at_most(end, listed):
    """A bar that slides past the end of another one: 127 or 129 poses."""
    made = package(
        [joint(0, [1, 0, 0], upper=1.2), joint(1, [0, 1, 0], upper=1e-9)],
        link_0=box([0.0, 0.0, 0.0], [1.0, 0.1, 0.1]),
        link_1=box([-1.0, 0.11, 0.0], [end, 0.2, 0.1]),
        link_9=FAR,
    )
    assert (ignored_pairs(made) == (("link_0", "link_1"),)) == listed


def test_what_a_screw_connects_is_listed_and_comes_first():
    cap = joint(1, [0, 0, 1], parent="link_0", child="link_1", kind="prismatic")
    turn = joint(0, [0, 0, 1], kind="continuous", upper=2.0 * np.pi)
    travel = replace(cap, of_screw=True, follows="joint_0", ratio=0.001)
    inside = {
        "link_0": box([-0.002, -0.002, 0.0], [0.002, 0.002, 0.004]),
        "link_1": box([-0.02, -0.02, 0.0], [0.005, 0.02, 0.02]),
        "link_9": box([-0.03, -0.03, -0.2], [0.03, 0.03, 0.01]),
        "link_8": box([0.03, -0.03, -0.2], [0.05, 0.03, -0.05]),
    }
    fixed = joint(8, [1, 0, 0], upper=0.0, kind="fixed", parent="link_7", child="link_8")
    base = joint(7, [1, 0, 0], upper=0.0, kind="fixed", child="link_7")
    made = package([turn, travel, base, fixed], **inside, link_7=FAR)
    assert ignored_pairs(made) == (("link_1", "link_9"), ("link_9", "link_8"))
    without = package([turn, cap, base, fixed], **inside, link_7=FAR)
    assert ("link_1", "link_9") not in ignored_pairs(without)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_links_keep_their_distance_at_every_pose(seed):
    """Against poses drawn at random, in chains of two joints on either side."""
    rng = np.random.default_rng(seed)
    kinds: list[Literal["revolute", "prismatic"]] = [
        "revolute" if turns else "prismatic" for turns in rng.integers(0, 2, 3)
    ]
    joints = []
    for k, (parent, child) in enumerate((("link_9", "link_2"), ("link_2", "link_0"), ("link_9", "link_1"))):
        axis = rng.normal(size=3)
        joints.append(
            joint(
                k, axis / np.linalg.norm(axis), rng.uniform(-0.1, 0.1, 3), kind=kinds[k],
                upper=rng.uniform(0.0, 0.05), parent=parent, child=child,
            )
        )  # fmt: skip
    low = rng.uniform(0.0, 0.04, 3)
    hulls = {
        "link_0": box([-0.05] * 3, [0.0] * 3),
        "link_1": box(low, low + 0.05),
        "link_2": FAR,
        "link_9": FAR,
    }
    made = package(joints, **hulls)
    sets = {link.name: HullSet(hulls=link.hulls) for link in made.links}
    least = kept_distance(made.links, joints, ("link_0", "link_1"), sets)
    qpos = {each.name: rng.uniform(0.0, each.upper, 200) for each in joints}
    T = link_displacements(made.links, joints, qpos)
    found = signed_distances(sets["link_0"], sets["link_1"], T[:, 0], T[:, 1], 0.05).distance
    if least is not None:
        assert found.min(initial=np.inf) >= min(least, 0.02)


@pytest.mark.parametrize(
    ("apart", "listed"), [(-1.1e-3, False), (-0.9e-3, True), (0.9e-4, True), (1.1e-4, False)]
)
def test_links_touch_from_a_millimetre_inside_each_other_to_a_tenth_of_one_apart(apart, listed):
    made = package(
        [joint(0, [1, 0, 0], upper=0.1), joint(1, [-1, 0, 0], upper=0.1)],
        link_0=box([0.0, 0.0, 0.0], [0.1, 0.1, 0.1]),
        link_1=box([0.1 + apart, 0.0, 0.0], [0.2, 0.1, 0.1]),
        link_9=FAR,
    )
    assert (ignored_pairs(made) == (("link_0", "link_1"),)) == listed


@pytest.mark.parametrize(("wider", "listed"), [(0.00115, False), (0.00125, True)])
def test_what_turns_is_taken_for_a_prism_that_is_a_thousandth_wider(wider, listed):
    """A bar that turns about its middle, a metre long to either side, and a post 1 mm beyond the prism.

    The edges of a prism with 64 sides are 1 / cos(2.8 deg) = 1.0012 m from its axis.
    """
    made = package(
        [joint(0, [0, 0, 1], upper=2.0 * np.pi, kind="continuous"), joint(1, [0, 0, 1], upper=1e-9)],
        link_0=box([-0.1, -np.sqrt(0.99), 0.0], [0.1, np.sqrt(0.99), 0.1]),
        link_1=box([-0.01, 1.001 + wider, 0.0], [0.01, 1.05, 0.1]),
        link_9=FAR,
    )
    assert (ignored_pairs(made) == (("link_0", "link_1"),)) == listed
