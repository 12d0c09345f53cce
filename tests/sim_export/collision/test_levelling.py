"""Laws of levelling: what would topple gets feet and stands, what stands is left as it is."""

import numpy as np
import pytest

from artigen.types import Joint
from sim_export.collision.feet import level_object
from sim_export.geometry.hulls import box_hull
from sim_export.package import Inertial, Link

BODY = ((-0.3, -0.4, 0.02), (0.3, 0.4, 0.8))
TRIM = ((-0.3, -0.4, 0.0), (-0.28, 0.4, 0.03))
BACK = ((0.28, -0.4, 0.0), (0.3, 0.4, 0.03))


def link(name: str, *boxes, label=None) -> Link:
    hulls = tuple(box_hull(np.array(low), np.array(high)) for low, high in boxes)
    middle = np.mean(boxes[0], axis=0)
    inertial = Inertial(mass=10.0, com=middle, inertia=np.eye(3))
    return Link(name=name, label=label, parts=(name,), visuals=(), hulls=hulls, inertial=inertial)


def level(links, joints, requirements, category: str, raised: float = 0.0):
    """Levelled links whose body is seen as its first hull is, but ``raised`` (m) above it."""
    hull = links[-1].hulls[0]
    shown = hull.vertices[hull.faces] + np.array([0.0, 0.0, raised])
    return level_object(links, joints, requirements, category, shown)


def lowest(links) -> np.ndarray:
    points = np.concatenate([hull.vertices for item in links for hull in item.hulls])
    return points[points[:, 2] < points[:, 2].min() + 1e-9]


@pytest.mark.parametrize("category", ["StorageFurniture", "ChestFreezer", "Dryer", "Toilet"])
def test_a_body_on_its_front_trim_gets_four_feet_and_stands_on_them(category):
    done = level((link("body", BODY, TRIM),), [], [], category)
    assert len(done.feet) == 4
    stands = lowest(done.links)
    np.testing.assert_allclose(stands[:, 2], 0.0, atol=1e-9)
    assert stands[:, 0].max() > 0.25  # the back stands, too
    for foot in done.feet:
        assert foot.mesh.vertices[:, 2].min() == pytest.approx(0.0)
        assert foot.mesh.vertices[:, 2].max() > BODY[0][2]  # it reaches into the body
    assert "levelling feet" in done.records[0]
    again = level(done.links, [], [], category)
    assert again.links[0] is done.links[0]


def test_what_stands_is_the_same_object():
    body = link("body", BODY, TRIM, BACK)
    done = level((body,), [], [], "StorageFurniture")
    assert done.links[0] is body
    assert done.feet == ()
    assert done.records == ()


def test_what_hangs_on_a_wall_gets_no_feet():
    assert level((link("body", BODY, TRIM),), [], [], "Window").feet == ()


def test_a_body_that_only_its_door_carries_gets_feet_beside_the_door():
    door = link("link_0", ((-0.33, -0.4, 0.0), (-0.31, 0.4, 0.7)), label="door")
    hinge = Joint(
        name="joint_0", type="revolute", parent="body", child="link_0",
        origin=np.array([-0.31, 0.4, 0.0]), axis=np.array([0.0, 0.0, -1.0]), lower=0.0, upper=1.5,
    )  # fmt: skip
    done = level((door, link("body", BODY)), [hinge], [], "StorageFurniture")
    assert lowest(done.links)[:, 2].max() == pytest.approx(0.0)
    assert len(done.feet) == 4


def test_feet_that_would_be_stilts_are_not_added_and_that_is_said():
    high = ((-0.3, -0.4, 0.3), (0.3, 0.4, 0.8))
    trim = ((-0.3, -0.4, 0.0), (-0.28, 0.4, 0.31))
    done = level((link("body", high, trim),), [], [], "StorageFurniture")
    assert lowest(done.links)[:, 0].max() < 0.0
    assert "not" in done.records[0] or "no foot" in done.records[0]


def barrow(back: float) -> list[Link]:
    """A tray over one wheel at its front, with legs that end ``back`` (m) above the floor."""
    tray = ((-0.4, -0.3, 0.3), (0.5, 0.3, 0.5))
    legs = [((0.3, y - 0.02, back), (0.34, y + 0.02, 0.3)) for y in (-0.25, 0.25)]
    wheel = link("link_0", ((-0.5, -0.04, 0.0), (-0.2, 0.04, 0.29)), label="wheel")
    return [wheel, link("body", tray, *legs)]


def test_a_barrow_gets_the_two_feet_that_it_lacks_and_no_more():
    done = level(barrow(0.05), [], [], "Cart")
    assert len(done.feet) == 2
    feet = np.array([foot.mesh.vertices.mean(axis=0) for foot in done.feet])
    assert (feet[:, 0] > 0.2).all()  # below the legs, not beside the wheel
    assert np.ptp(feet[:, 1]) > 0.4
    again = level(done.links, [], [], "Cart")
    assert again.feet == ()


def test_a_barrow_that_stands_on_its_legs_is_the_same_object():
    links = barrow(0.0)
    assert level(links, [], [], "Cart").links[1] is links[1]


@pytest.mark.parametrize(("raised", "reaches"), [(0.0, False), (0.008, True), (0.0189, True), (0.023, False)])
def test_a_foot_is_seen_to_reach_a_body_that_ends_above_its_hulls(raised, reaches):
    done = level((link("body", BODY, TRIM),), [], [], "StorageFurniture", raised)
    for foot in done.feet:
        gap = BODY[0][2] + raised - foot.mesh.vertices[:, 2].max()
        assert foot.mesh.vertices[:, 2].min() == pytest.approx(0.0)
        assert gap == pytest.approx(0.0 if reaches else raised - 1e-3, abs=1e-9)
