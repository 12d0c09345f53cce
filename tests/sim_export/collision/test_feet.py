"""Laws of feet: bodies stand as low as they look, on what the mesh has there, and sweeps stay free."""

from dataclasses import replace

import numpy as np
import pytest
from hull_link import box, link, solid

from artigen.types import Joint
from sim_export.collision import attachment, feet
from sim_export.collision.feet import Levelled, add_feet, level_object
from sim_export.geometry.hulls import box_hull
from sim_export.package import Inertial, Link

PLATE = ((-0.3, -0.4, 0.0), (0.3, 0.4, 0.8))
FEET = [
    ((x - 0.02, y - 0.02, -0.012), (x + 0.02, y + 0.02, 0.01)) for x in (-0.25, 0.25) for y in (-0.35, 0.35)
]
FRAME = [
    ((-0.3, -0.4, -0.012), (0.3, -0.38, 0.01)),
    ((-0.3, 0.38, -0.012), (0.3, 0.4, 0.01)),
    ((-0.3, -0.4, -0.012), (-0.28, 0.4, 0.01)),
    ((0.28, -0.4, -0.012), (0.3, 0.4, 0.01)),
]
BODY = box_hull(np.array(PLATE[0]), np.array(PLATE[1]))


def lowest(links) -> np.ndarray:
    points = np.concatenate([hull.vertices for item in links for hull in item.hulls])
    return points[points[:, 2] < points[:, 2].min() + 1e-6]


def test_four_feet_that_hulls_lack_are_added():
    links = (link("body", BODY),)
    new, records = add_feet(links, [], [], {"body": solid(PLATE, *FEET)})
    low = lowest(new)
    np.testing.assert_allclose(
        [low.min(axis=0), low.max(axis=0)], [[-0.27, -0.37, -0.012], [0.27, 0.37, -0.012]]
    )
    assert len(new[0].hulls) == 5
    assert "12.0 mm" in records[0]
    assert "4 of 4" in records[0]


@pytest.mark.parametrize("depth", [0.0, 0.004, 0.08])
def test_bodies_that_stand_or_lack_more_than_feet_are_left_alone(depth: float):
    links = (link("body", BODY),)
    mesh = solid(PLATE, ((-0.3, -0.4, -depth), (0.3, 0.4, 0.1)))
    new, records = add_feet(links, [], [], {"body": mesh})
    assert new[0] is links[0]
    assert not records


def test_a_frame_stands_on_its_corners():
    new, _ = add_feet((link("body", BODY),), [], [], {"body": solid(PLATE, *FRAME)})
    points = lowest(new)
    np.testing.assert_allclose(points.min(axis=0)[:2], [-0.3, -0.4])
    np.testing.assert_allclose(points.max(axis=0)[:2], [0.3, 0.4])
    for hull in new[0].hulls[1:]:
        assert np.ptp(hull.vertices, axis=0).max() < 0.2


def test_feet_keep_out_of_the_way_of_what_moves(monkeypatch):
    tray = box_hull(np.array([-0.3, -0.4, -0.011]), np.array([-0.2, 0.4, -0.002]))
    slide = Joint(
        name="joint_0", type="prismatic", parent="body", child="tray",
        axis=np.array([-1.0, 0.0, 0.0]), origin=np.zeros(3), lower=0.0, upper=0.3,
    )  # fmt: skip
    links = (link("body", BODY), link("tray", tray))
    meshes = {"body": solid(PLATE, *FEET), "tray": solid(((-0.3, -0.4, -0.011), (-0.2, 0.4, -0.002)))}
    monkeypatch.setattr(feet, "NEAR", 0.0005)
    new, records = add_feet(links, [slide], [], meshes)
    assert "2 of 4" in records[0]
    assert lowest(new)[:, 0].min() > 0.2


def test_a_foot_stays_short_where_something_passes_just_above_it():
    """The front of a drawer ends a little below the body, and slides out over two feet."""
    front = box_hull(np.array([-0.3, -0.4, -0.0015]), np.array([-0.2, 0.4, 0.3]))
    slide = Joint(
        name="joint_0", type="prismatic", parent="body", child="front",
        axis=np.array([-1.0, 0.0, 0.0]), origin=np.zeros(3), lower=0.0, upper=0.3,
    )  # fmt: skip
    body = box_hull(np.array([-0.19, -0.4, 0.0]), np.array([0.3, 0.4, 0.8]))
    links = (link("body", body), link("front", front))
    meshes = {"body": solid(PLATE, *FEET), "front": solid(((-0.3, -0.4, -0.0015), (-0.2, 0.4, 0.3)))}
    new, records = add_feet(links, [slide], [], meshes)
    assert "4 of 4" in records[0]
    short = [hull for hull in new[0].hulls[1:] if hull.vertices[:, 0].max() < 0.0]
    assert len(short) == 2
    assert all(hull.vertices[:, 2].max() <= -0.0015 - 1e-3 for hull in short)


def test_where_a_link_has_all_its_hulls_one_is_stretched(monkeypatch):
    monkeypatch.setattr(attachment, "MOST_OF_LINK", 1)
    new, _ = add_feet((link("body", BODY),), [], [], {"body": solid(PLATE, *FEET)})
    assert len(new[0].hulls) == 1
    assert lowest(new)[0, 2] == pytest.approx(-0.012)


@pytest.mark.parametrize(("depth", "feet"), [(0.0044, 0), (0.0046, 4), (0.059, 4), (0.061, 0)])
def test_feet_are_added_where_hulls_end_four_and_a_half_to_sixty_millimetres_too_high(depth, feet):
    pads = [((low[0], low[1], -depth), high) for low, high in FEET]
    new, _ = add_feet((link("body", BODY),), [], [], {"body": solid(PLATE, *pads)})
    assert len(new[0].hulls) == 1 + feet


def test_feet_reach_a_millimetre_into_what_stands_on_them():
    new, _ = add_feet((link("body", BODY),), [], [], {"body": solid(PLATE, *FEET)})
    assert [hull.vertices[:, 2].max() for hull in new[0].hulls[1:]] == pytest.approx([0.001] * 4)


@pytest.mark.parametrize(("fall", "feet"), [(0.0037, 4), (0.0039, 2)])
def test_feet_stay_four_millimetres_below_the_lowest_hull_where_something_passes(fall, feet):
    """A front that slides 20 mm out over two feet, and falls on its way by so much (m): 0.2 mm are left."""
    way = np.array([-0.02, 0.0, -fall])
    sides = np.array([-0.3, -0.4, 0.0]), np.array([-0.2, 0.4, 0.3])
    slide = Joint(
        name="joint_0", type="prismatic", parent="body", child="front",
        axis=way / np.linalg.norm(way), origin=np.zeros(3), lower=0.0, upper=float(np.linalg.norm(way)),
    )  # fmt: skip
    body = box_hull(np.array([-0.19, -0.4, 0.0]), np.array([0.3, 0.4, 0.8]))
    links = (link("body", body), link("front", box_hull(*sides)))
    _, records = add_feet(links, [slide], [], {"body": solid(PLATE, *FEET), "front": solid(sides)})
    assert f"{feet} of 4" in records[0]


def test_a_corner_of_a_frame_is_a_fifth_of_its_length_and_width():
    new, _ = add_feet((link("body", BODY),), [], [], {"body": solid(PLATE, *FRAME)})
    sides = [np.ptp(hull.vertices, axis=0)[:2] for hull in new[0].hulls[1:]]
    np.testing.assert_allclose(sides, [[0.12, 0.16]] * 4)


@pytest.mark.parametrize(("width", "feet"), [(0.00105, 0), (0.00115, 1)])
def test_fins_thinner_than_1_1_mm_are_no_feet(width, feet):
    fin = ((0.0, 0.0, -0.012), (width, 0.03, 0.01))
    new, _ = add_feet((link("body", BODY),), [], [], {"body": solid(PLATE, fin)})
    assert len(new[0].hulls) == 1 + feet


@pytest.mark.parametrize(("pegs", "feet"), [(7, 7), (8, 8), (9, 8)])
def test_a_link_gets_its_eight_largest_feet(pegs, feet):
    """Pegs in a row, each wider than the one before it."""
    row = [((0.0, 0.06 * k - 0.3, -0.012), (0.01 + 0.002 * k, 0.06 * k - 0.28, 0.01)) for k in range(pegs)]
    new, _ = add_feet((link("body", BODY),), [], [], {"body": solid(PLATE, *row)})
    assert len(new[0].hulls) == 1 + feet
    assert (min(hull.vertices[:, 1].min() for hull in new[0].hulls[1:]) > -0.29) == (pegs > feet)


CABINET = ((-0.3, -0.4, 0.05), (0.3, 0.4, 0.8))
TRIM = ((-0.3, -0.2, 0.0), (-0.295, 0.2, 0.06))
"""All that a cabinet touches the floor with, so that it topples."""


def level(*boxes, raised: float = 0.0, beside: tuple[Link, ...] = ()) -> Levelled:
    """A body of 10 kg amid its first box, seen ``raised`` (m) above that, with feet if it topples."""
    hulls = [box(*sides) for sides in boxes]
    inertial = Inertial(mass=10.0, com=hulls[0].vertices.mean(axis=0), inertia=np.eye(3))
    body = replace(link("body", *hulls), inertial=inertial)
    shown = hulls[0].vertices[hulls[0].faces] + np.array([0.0, 0.0, raised])
    return level_object((*beside, body), [], [], "StorageFurniture", shown)


@pytest.mark.parametrize(("inside", "feet"), [(0.0058, True), (0.0062, False)])
def test_a_small_body_stands_if_its_mass_is_two_hundredths_of_its_width_inside_of_its_support(inside, feet):
    body = ((-0.15, -0.2, 0.02), (0.15, 0.2, 0.3))
    front = ((-inside, -0.2, 0.0), (0.01, 0.2, 0.03))
    back = ((0.14, -0.2, 0.0), (0.15, 0.2, 0.03))
    assert bool(level(body, front, back).feet) == feet


@pytest.mark.parametrize(("height", "feet"), [(0.195, 4), (0.205, 0)])
def test_levelling_feet_are_up_to_a_fifth_of_the_height_of_an_object(height, feet):
    body = ((-0.3, -0.4, height), (0.3, 0.4, 1.0))
    assert len(level(body, (TRIM[0], (-0.295, 0.2, height + 0.01))).feet) == feet


@pytest.mark.parametrize(("top", "width"), [(0.8, 0.024), (0.3, 0.02)])
def test_levelling_feet_are_24_mm_wide_or_a_fifteenth_of_the_height_and_10_mm_from_the_outline(top, width):
    done = level((CABINET[0], (0.3, 0.4, top)), TRIM)
    points = np.array([foot.mesh.vertices for foot in done.feet])
    np.testing.assert_allclose(np.ptp(points, axis=1)[:, :2], width)
    np.testing.assert_allclose(points.min(axis=(0, 1))[:2], [-0.29, -0.39])
    np.testing.assert_allclose(points.max(axis=(0, 1))[:2], [0.29, 0.39])


@pytest.mark.parametrize(("aside", "moves"), [(0.078, True), (0.1, False)])
def test_a_levelling_foot_moves_aside_by_three_times_what_it_becomes_shorter(aside, moves):
    """A ledge 20 mm below the underside of a body ends so far (m) from its back.

    The foot in the corner is 31 mm from that anyway, and moves by up to 60 mm.
    """
    done = level(CABINET, TRIM, ((-0.2, -0.4, 0.03), (0.3 - aside, 0.4, 0.05)))
    back = max(foot.mesh.vertices[:, 0].max() for foot in done.feet)
    assert back == pytest.approx(0.312 - aside if moves else 0.29, abs=0.008)


@pytest.mark.parametrize(("above", "reaches"), [(0.0195, True), (0.0205, False)])
def test_a_levelling_foot_is_seen_to_reach_up_to_twenty_millimetres_above_its_hull(above, reaches):
    done = level(CABINET, TRIM, raised=0.001 + above)
    tops = [foot.mesh.vertices[:, 2].max() for foot in done.feet]
    assert tops == pytest.approx([0.051 + (above if reaches else 0.0)] * 4)


@pytest.mark.parametrize(("slabs", "feet"), [(3, 4), (4, 0)])
def test_a_levelling_foot_grows_out_of_one_of_the_four_nearest_hulls(slabs, feet):
    """A body with all 96 hulls: slabs, and above these a post over each foot; as something stands beside the
    feet, only the posts have room to grow."""
    corners = [(x, y) for x in (-0.278, 0.278) for y in (-0.378, 0.378)]
    layers = [((-0.3, -0.4, 0.05 + 0.02 * k), (0.3, 0.4, 0.06 + 0.02 * k)) for k in range(slabs)]
    posts = [((x - 0.01, y - 0.01, 0.15), (x + 0.01, y + 0.01, 0.2)) for x, y in corners]
    count = 95 - slabs - len(posts)
    rest = [((-0.2, 0.004 * k - 0.2, 0.7), (0.2, 0.004 * k - 0.197, 0.8)) for k in range(count)]
    stops = [box((0.9 * x - 0.01, y - 0.01, 0.005), (0.9 * x + 0.01, y + 0.01, 0.045)) for x, y in corners]
    done = level(*layers, TRIM, *posts, *rest, beside=(link("stop", *stops),))
    assert len(done.feet) == feet
    assert len(done.links[1].hulls) == 96
