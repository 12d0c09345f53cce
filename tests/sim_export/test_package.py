"""What a joint is of which nothing is said."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from artigen.types import Joint
from sim_export.files.urdf import urdf_text
from sim_export.package import Link, SimPackage


def plain_joint(**given) -> Joint:
    return Joint(
        name="joint_0", type="prismatic", parent="link_1", child="link_0",
        origin=np.zeros(3), axis=np.array([1.0, 0.0, 0.0]), **given,
    )  # fmt: skip


def written(joint: Joint) -> ET.Element:
    """The joint in a URDF file."""
    links = tuple(
        Link(name=name, label=None, parts=(), visuals=(), hulls=(), inertial=None)
        for name in ("link_0", "link_1")
    )
    package = SimPackage(name="a", category="Thing", visual="source", links=links, joints=(joint,))
    found = ET.fromstring(urdf_text(package)).find("joint")
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("element", "numbers"),
    [
        ("limit", {"lower": 0.0, "upper": 0.0, "effort": 100.0, "velocity": 1.0}),
        ("dynamics", {"friction": 0.0, "damping": 0.0}),
    ],
)
def test_a_joint_stays_closed_is_free_and_moves_by_100_newtons_at_a_metre_per_second(element, numbers):
    found = written(plain_joint()).find(element)
    assert found is not None
    assert {name: float(value) for name, value in found.attrib.items()} == numbers


def test_a_joint_that_follows_another_by_no_ratio_does_not_move():
    found = written(plain_joint(follows="joint_1")).find("mimic")
    assert found is not None
    assert float(found.attrib["multiplier"]) == 0.0


def test_a_joint_has_no_spring():
    assert plain_joint(upper=0.5).stiffness == 0.0
