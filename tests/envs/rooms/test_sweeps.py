"""Poses of what turns, and which joints need space."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.types import Joint
from envs.rooms.sweeps import opening_joints, sweep_joint
from sim_export.geometry.hulls import box_hull
from sim_export.package import Link, SimPackage


@pytest.mark.parametrize(("turns", "poses"), [(0.25, 31), (5.0, 601), (5.99, 720), (7.0, 720)])
def test_poses_are_three_degrees_apart_unless_a_joint_turns_more_than_six_times(turns: float, poses: int):
    hulls = (box_hull(np.zeros(3), np.ones(3)),)
    links = tuple(
        Link(name=name, label=label, parts=(), visuals=(), inertial=None, hulls=hulls)
        for name, label in (("lid", "door"), ("body", "base"))
    )
    joint = Joint(
        name="joint", type="revolute", parent="body", child="lid", origin=np.zeros(3),
        axis=np.array([0.0, 0.0, 1.0]), upper=2.0 * np.pi * turns - 1e-6,
    )  # fmt: skip
    package = SimPackage(name="lid", category="Box", visual="voxels", links=links, joints=(joint,))
    assert len(sweep_joint(package, joint).T) == poses


@pytest.mark.parametrize(("led", "opens"), [("door", True), ("knob", False)])
def test_a_pedal_needs_space_where_a_lid_follows_it(led, opens: object):
    hull = (box_hull(np.zeros(3), np.ones(3)),)
    labels = {"pedal": "knob", "lid": led, "body": "base"}
    links = tuple(
        Link(name=name, label=label, parts=(), visuals=(), inertial=None, hulls=hull)
        for name, label in labels.items()
    )
    pedal = Joint(
        name="press", type="revolute", parent="body", child="pedal", origin=np.zeros(3),
        axis=np.array([0.0, 1.0, 0.0]), upper=0.2,
    )  # fmt: skip
    lid = replace(pedal, name="swing", child="lid", upper=1.6, follows="press", ratio=8.0)
    package = SimPackage(name="bin", category="TrashCan", visual="voxels", links=links, joints=(pedal, lid))
    assert (pedal in opening_joints(package)) == opens
    if opens:
        assert 1 in sweep_joint(package, pedal).links
