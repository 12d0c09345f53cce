"""Surfaces of revolution have an axis, and their sectors are all of them."""

from dataclasses import replace

import numpy as np
import pytest
from triangle_box import box

from artigen.transforms import rotation_about
from sim_export.collision.cover import surface_hulls
from sim_export.collision.cover.free_space import find_free_space
from sim_export.collision.cover.object_cover import ObjectCover
from sim_export.collision.cover.sectors import count_sectors, cut_sectors, find_axis
from sim_export.collision.cover.surface_hulls import USUAL, cover_surface
from sim_export.geometry.distances import surface_distances
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import triangle_areas

PROFILE = ((0.03, 0.0), (0.034, 0.1), (0.034, 0.15), (0.012, 0.2), (0.012, 0.25))
"""Radius and height (m) of a bottle without a bottom."""


def turned(profile=PROFILE, *, span=2.0 * np.pi, about=(0.0, 0.0), sides=96):
    """Triangles of a profile that turns about a vertical axis."""
    angles = np.linspace(0.0, span, sides + 1)
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    grid = np.stack(
        [np.column_stack([radius * ring + about, np.full(len(ring), z)]) for radius, z in profile]
    )
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    return np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)


def test_the_axis_of_a_bottle_is_found_wherever_it_stands_and_however_it_lies():
    upright = find_axis(turned(about=(0.2, -0.1)))
    assert upright is not None
    np.testing.assert_allclose(upright.direction, (0, 0, 1))
    np.testing.assert_allclose(upright.point[:2], (0.2, -0.1), atol=2e-4)
    assert upright.radius == pytest.approx(0.034, rel=0.02)
    turn = rotation_about(np.array([1.0, 0.0, 0.0]), np.array(np.pi / 2))
    lying = find_axis(turned() @ turn.T)
    assert lying is not None
    np.testing.assert_allclose(np.abs(lying.direction), (0, 1, 0))


@pytest.mark.parametrize("shape", [box((0, 0, 0), (0.3, 0.2, 0.1)), box((0, 0, 0), (0.3, 0.3, 0.01))])
def test_boxes_and_plates_have_no_axis(shape):
    assert find_axis(shape) is None


@pytest.mark.parametrize(("sixteenths", "found"), [(12.3, True), (10.7, False)])
def test_a_ring_is_closed_if_it_goes_three_quarters_around(sixteenths, found):
    """Twelve of sixteen parts count, and one that is only begun counts."""
    assert (find_axis(turned(span=2.0 * np.pi * sixteenths / 16.0)) is not None) == found


@pytest.mark.parametrize(("sixteenths", "found"), [(11.2, True), (10.8, False)])
def test_of_the_sixteen_parts_of_a_ring_the_twelfth_counts_once_it_is_begun(sixteenths, found):
    """A hoop with a radius of 5 cm, lower than a ring is wide, so that all points are in one ring."""
    hoop = turned(((0.05, 0.0), (0.05, 0.0009)), span=2.0 * np.pi * sixteenths / 16.0)
    assert (find_axis(hoop) is not None) == found


@pytest.mark.parametrize(("share", "found"), [(0.7, True), (0.66, False)])
def test_seven_tenths_of_the_sides_are_round(share, found):
    """A tube, in the middle of a ring, and a plate through its axis in such strips as those of the tube.

    Where the plate crosses the tube, some more is round.
    """
    tube = turned(((0.048, 0.0), (0.048, 0.2)))
    width = triangle_areas(tube).sum() * (1.0 / share - 1.0) / 0.2
    edges = np.linspace(-width / 2.0, width / 2.0, 1 + round(96 * (1.0 / share - 1.0)))
    foot, top = (np.column_stack([edges, 0.0 * edges, np.full(len(edges), z)]) for z in (0.0, 0.2))
    a, b, c, d = foot[:-1], foot[1:], top[1:], top[:-1]
    plate = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    assert (find_axis(np.concatenate([tube, plate])) is not None) == found


@pytest.mark.parametrize(("along", "found"), [(0.88, True), (0.92, False)])
def test_a_cone_is_round_unless_its_normals_are_nearly_along_its_axis(along, found):
    """Steep sides; flatter than 26 degrees, it is nothing but an end, as any plate has."""
    height = 0.04 * np.sqrt(1.0 / along**2 - 1.0)
    assert (find_axis(turned(((0.05, 0.0), (0.01, height)))) is not None) == found


@pytest.mark.parametrize(("share", "found"), [(0.18, False), (0.22, True)])
def test_a_disc_is_round_if_a_fifth_of_it_is_its_rim(share, found):
    """The rim of a closed cylinder is ``h / (h + r)`` of its surface."""
    height = 0.05 * share / (1.0 - share)
    profile = ((1e-4, 0.0), (0.05, 0.0), (0.05, height), (1e-4, height))
    assert (find_axis(turned(profile)) is not None) == found


@pytest.mark.parametrize(("widths", "found"), [(0.45, True), (1.05, False)])
def test_halves_of_a_tube_are_one_ring_if_their_radii_differ_by_less_than_its_width(widths, found):
    """A ring is 4 mm wide, two hundredths of the height of 0.2 m."""
    inner = turned(((0.04, 0.0), (0.04, 0.2)), span=np.pi)
    radius = 0.04 + widths * 0.004
    outer = turned(((radius, 0.0), (radius, 0.2)), span=np.pi) * [-1.0, -1.0, 1.0]
    assert (find_axis(np.concatenate([inner, outer])) is not None) == found


@pytest.mark.parametrize("size", [0.02, 0.06])
def test_a_handle_does_not_move_the_axis(size):
    """A box beside a bottle, with up to a third of its surface."""
    found = find_axis(np.concatenate([turned(), box((0.03, -size / 4, 0.05), (0.03 + size, size / 4, 0.1))]))
    assert found is not None
    np.testing.assert_allclose(found.point[:2], 0.0, atol=3e-4)


@pytest.mark.parametrize(
    ("depth", "count"),
    [(0.04, 6), (0.0077, 8), (0.0075, 10), (0.00087, 24), (0.0007, 24)],
)
def test_sectors_are_as_few_as_their_arcs_allow_from_6_to_24(depth, count):
    """Even numbers, of a tube with a radius of 10 cm: eight arcs are 7.6 mm deep, 24 are 0.86 mm."""
    assert count_sectors(0.1, depth) == count


@pytest.mark.parametrize(("diagonal", "count"), [(0.97, 8), (0.93, 10)])
def test_arcs_are_eight_thousandths_of_the_diagonal_deep(diagonal, count):
    """A tube with a radius of 10 cm in an object of some diagonal (m); no sector is cut again."""
    tube, coarse = turned(((0.1, 0.0), (0.1, 0.1))), replace(USUAL, bulge=0.02)
    cover = cover_surface(tube, find_free_space(tube, diagonal), diagonal, coarse)
    assert len(cover.cut) == count


def test_sectors_together_are_the_surface_and_each_lies_within_its_angle():
    triangles = turned()
    axis = find_axis(triangles)
    assert axis is not None
    parts = cut_sectors(triangles, axis, 8)
    assert len(parts) == 8
    areas = [triangle_areas(part).sum() for part in parts]
    np.testing.assert_allclose(sum(areas), triangle_areas(triangles).sum(), rtol=1e-3)
    np.testing.assert_allclose(areas, np.mean(areas), rtol=0.05)


@pytest.mark.slow
def test_by_sectors_fewer_hulls_follow_a_bottle_more_closely(monkeypatch):
    walls = np.concatenate([turned(sides=48), 0.97 * turned(sides=48)[:, ::-1]])

    def measure() -> tuple[int, float]:
        """Number of hulls, and how far (m) 99 % of their surface is from the bottle at most."""
        hulls = ObjectCover({"bottle": walls}, {}).make_hulls()["bottle"]
        solid = np.concatenate([hull.vertices[hull.faces] for hull in hulls])
        far = surface_distances(sample_triangles(solid, 4000)[0], walls, 16000)
        return len(hulls), float(np.percentile(far, 99))

    sectors = measure()
    monkeypatch.setattr(surface_hulls, "find_axis", lambda triangles: None)
    pieces = measure()
    assert sectors[0] < 0.75 * pieces[0]
    assert sectors[1] < 0.9 * pieces[1]
