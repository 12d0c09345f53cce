"""What lies between the two joints of a screw has mass and collision, and nothing ever meets it."""

import numpy as np
import pytest

from artigen.shapes.draw import draw_shape
from sim_export.checks.subject import Subject
from sim_export.checks.suite import run_checks
from sim_export.collision.pins import pin_carriers
from sim_export.files.write import write_package
from sim_export.geometry.primitives import find_primitive
from sim_export.package import SimPackage
from sim_export.physics.inertia import subtree_inertial
from sim_export.physics.materials import GRAVITY
from sim_export.reference import build_reference

SCREW_TABLE = 40
"""Seed of a round table whose top is screwed up."""


@pytest.fixture(scope="module")
def package() -> SimPackage:
    return build_reference(draw_shape("Table", SCREW_TABLE))


def test_every_link_has_mass_and_collision(package):
    assert any(joint.follows is not None for joint in package.joints)
    assert all(link.hulls and link.inertial is not None for link in package.links)


def test_the_pin_stands_on_the_axis_beside_what_the_screw_moves(package):
    links = {link.name: link for link in package.links}
    (travel,) = (joint for joint in package.joints if joint.follows is not None)
    carrier, moved = links[travel.parent], links[travel.child]
    (hull,) = carrier.hulls
    shape = find_primitive(hull)
    assert shape is not None
    assert shape.kind == "cylinder"
    assert shape.sizes == pytest.approx((0.002, 0.004))
    assert np.abs(np.cross(shape.T_object_shape[:3, 2], travel.axis)).max() < 1e-9
    middle = shape.T_object_shape[:3, 3]
    assert np.allclose(middle, carrier.inertial.com)
    assert np.abs(np.cross(middle - travel.origin, travel.axis)).max() < 1e-9
    assert (moved.inertial.com - middle) @ travel.axis == pytest.approx(0.0, abs=1e-9)


def test_the_screw_carries_its_load(package):
    """The thread turns a weight into a moment; friction is more than that, so that it stays where it is."""
    (turn,) = (joint for joint in package.joints if joint.kind == "screw" and joint.follows is None)
    (travel,) = (joint for joint in package.joints if joint.follows is not None)
    moved = subtree_inertial(package.links, package.joints, turn.child)
    assert turn.friction > moved.mass * GRAVITY * travel.ratio


def test_checks_pass_and_see_the_pin_as_no_obstacle(package, tmp_path):
    folder = write_package(package, tmp_path / "table")
    assert [check.id for check in run_checks(folder) if check.verdict == "fail"] == []
    subject = Subject(folder)
    (carrier,) = subject.carriers
    assert carrier.endswith("carrier")
    assert not subject.hull_sets[carrier].hulls
    assert any(shape.link == carrier for shape in subject.collisions)


def test_objects_without_screws_stay_as_they_are(package):
    cart = build_reference(draw_shape("Cart", 0))
    assert all(new is old for new, old in zip(pin_carriers(cart.links, cart.joints), cart.links, strict=True))
    again = pin_carriers(package.links, package.joints)
    assert all(new is old for new, old in zip(again, package.links, strict=True))
