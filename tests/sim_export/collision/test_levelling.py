"""Laws of levelling: what would topple gets feet and stands, what stands is left as it is."""

import numpy as np
import pytest

from sim_export.collision.hulls import box_hull
from sim_export.collision.levelling import LIFT, level_object
from sim_export.package import Inertial, Link, PackageJoint

BODY = ((-0.3, -0.4, 0.02), (0.3, 0.4, 0.8))
TRIM = ((-0.3, -0.4, 0.0), (-0.28, 0.4, 0.03))
BACK = ((0.28, -0.4, 0.0), (0.3, 0.4, 0.03))


def link(name: str, *boxes, label=None) -> Link:
    hulls = tuple(box_hull(np.array(low), np.array(high)) for low, high in boxes)
    middle = np.mean(boxes[0], axis=0)
    inertial = Inertial(mass=10.0, com=middle, inertia=np.eye(3))
    return Link(name=name, label=label, parts=(name,), visuals=(), hulls=hulls, inertial=inertial)


def lowest(links) -> np.ndarray:
    points = np.concatenate([hull.vertices for item in links for hull in item.hulls])
    return points[points[:, 2] < points[:, 2].min() + 1e-9]


def test_a_body_on_its_front_trim_gets_four_feet_and_stands_on_them():
    done = level_object((link("body", BODY, TRIM),), [], [], "StorageFurniture")
    assert len(done.feet) == 4
    stands = lowest(done.links)
    np.testing.assert_allclose(stands[:, 2], 0.0, atol=1e-9)
    assert stands[:, 0].max() > 0.25  # the back stands, too
    for foot in done.feet:
        assert foot.mesh.vertices[:, 2].min() == pytest.approx(0.0)
        assert foot.mesh.vertices[:, 2].max() > BODY[0][2]  # it reaches into the body
    assert "levelling feet" in done.records[0]
    again = level_object(done.links, [], [], "StorageFurniture")
    assert again.links[0] is done.links[0]


def test_what_stands_is_the_same_object():
    body = link("body", BODY, TRIM, BACK)
    done = level_object((body,), [], [], "StorageFurniture")
    assert done.links[0] is body
    assert done.feet == ()
    assert done.records == ()


def test_what_hangs_on_a_wall_gets_no_feet():
    assert level_object((link("body", BODY, TRIM),), [], [], "Window").feet == ()


def test_a_body_is_lifted_off_its_door():
    door = link("link_0", ((-0.33, -0.4, 0.0), (-0.31, 0.4, 0.7)), label="door")
    hinge = PackageJoint(
        name="joint_0", type="revolute", kind="revolute", parent="body", child="link_0",
        origin=np.array([-0.31, 0.4, 0.0]), axis=np.array([0.0, 0.0, -1.0]), lower=0.0, upper=1.5,
    )  # fmt: skip
    done = level_object((door, link("body", BODY)), [hinge], [], "StorageFurniture")
    assert lowest(done.links)[:, 2].max() == pytest.approx(-LIFT)
    assert len(lowest(done.links)) == 16  # four feet of four corners


def test_feet_that_would_be_stilts_are_not_added_and_that_is_said():
    high = ((-0.3, -0.4, 0.3), (0.3, 0.4, 0.8))
    trim = ((-0.3, -0.4, 0.0), (-0.28, 0.4, 0.31))
    done = level_object((link("body", high, trim),), [], [], "StorageFurniture")
    assert lowest(done.links)[:, 0].max() < 0.0
    assert "not" in done.records[0] or "no foot" in done.records[0]
