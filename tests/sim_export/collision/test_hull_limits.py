"""Boundaries of what engines allow of hulls, and of what is changed so that hulls comply."""

import numpy as np
import pytest

from sim_export.collision.cover.free_space import find_free_space
from sim_export.collision.cover.surface_hulls import cover_surface
from sim_export.collision.hull_limits import compact_hull, comply_hull, flatten_facets, hull_aspect, trim_hull
from sim_export.geometry.hulls import convex_hull, hull_planes, hull_volume, hull_width
from sim_export.geometry.primitives import is_box
from sim_export.package import Hull


def plate(outline, thickness: float) -> Hull:
    """A level plate with the corners of an outline (m)."""
    outline = np.asarray(outline)
    return convex_hull(
        np.concatenate([np.column_stack([outline, np.full(len(outline), z)]) for z in (0.0, thickness)])
    )


def circle(diameter: float, sides: int = 16) -> np.ndarray:
    turns = 2.0 * np.pi * np.arange(sides) / sides
    return diameter / 2.0 * np.column_stack([np.cos(turns), np.sin(turns)])


def roof(sides: tuple[float, float], thickness: float, rise: float, strips: int = 2) -> Hull:
    """A level plate whose upper face is an arc of so many strips that rises by so much (m) in its middle."""
    width, depth = sides
    across = np.linspace(-1.0, 1.0, strips + 1)
    heights = thickness + rise * (1.0 - across**2)
    top = [[width / 2 * x, y, z] for x, z in zip(across, heights, strict=True) for y in (0.0, depth)]
    foot = [[width / 2 * x, y, 0.0] for x in (-1.0, 1.0) for y in (0.0, depth)]
    return convex_hull(np.array(top + foot))


def ball(*caps: float, corners: int) -> Hull:
    """Corners on a sphere, four of them in a square at the height of every cap, the rest in no plane."""
    squares = [
        [np.sqrt(1.0 - z * z) * np.cos(turn), np.sqrt(1.0 - z * z) * np.sin(turn), z]
        for z in caps
        for turn in np.pi / 2 * np.arange(4)
    ]
    count = corners - len(squares)
    z = 0.85 * (1.0 - (2.0 * np.arange(count) + 1.0) / count)
    turns = np.arange(count) * np.pi * (3.0 - np.sqrt(5.0))
    ring = np.sqrt(1.0 - z * z)
    rest = np.column_stack([ring * np.cos(turns), ring * np.sin(turns), z])
    return convex_hull(0.1 * np.concatenate([np.reshape(squares, (-1, 3)), rest]))


@pytest.mark.parametrize(("tip", "stays"), [(False, True), (True, False)])
def test_a_hull_may_have_32_corners(tip, stays):
    """A prism of sixteen sides, and one with a tip above it."""
    prism = plate(circle(0.2), 0.1)
    assert len(prism.vertices) == 32
    hull = convex_hull(np.concatenate([prism.vertices, [[0.0, 0.0, 0.15]]])) if tip else prism
    assert (comply_hull(hull) is hull) == stays
    assert len(comply_hull(hull).vertices) <= 32


@pytest.mark.parametrize(("caps", "stays"), [((0.95, -0.95), True), ((0.95,), False)])
def test_a_hull_may_have_54_faces(caps, stays):
    """Thirty corners have 56 triangles, two of which are one face at every flat cap."""
    hull = ball(*caps, corners=30)
    assert len(hull.faces) == 56
    assert (comply_hull(hull) is hull) == stays


@pytest.mark.parametrize(("length", "pieces"), [(0.59, 1), (0.61, 2)])
def test_a_rod_is_cut_if_it_is_more_than_sixty_times_as_long_as_thick(length, pieces):
    """Of three sides, a centimetre thick; boxes may have any length."""
    triangle = 0.01 * np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, np.sqrt(3.0)]]) / np.sqrt(3.0)
    rod = convex_hull(np.array([[x, y, z] for x in (0.0, length) for y, z in triangle]))
    assert hull_width(rod)[0] == pytest.approx(0.01)
    found = trim_hull(rod)
    assert len(found) == pieces
    assert sum(map(hull_volume, found)) == pytest.approx(hull_volume(rod))


@pytest.mark.parametrize(("rise", "flat"), [(0.00145, True), (0.00155, False)])
def test_facets_are_merged_if_they_differ_by_fifteen_ten_thousandths_of_the_diagonal(rise, flat):
    """The roof of a block with a diagonal of a metre; either half lies as far below the other's plane as
    their ridge is high."""
    assert is_box(flatten_facets(roof((0.6, 0.48), 0.64, rise))) == flat


@pytest.mark.parametrize(("share", "flat"), [(0.028, True), (0.032, False)])
def test_merging_facets_may_cost_three_hundredths_of_a_hull(share, flat):
    """A ridge of a millimetre on a plate with a diagonal of a metre; half of it is air."""
    rise = 0.001
    assert is_box(flatten_facets(roof((0.8, 0.6), rise / 2 * (1.0 / share - 1.0), rise))) == flat


@pytest.mark.parametrize(("thickness", "flat"), [(0.00115, False), (0.00125, True)])
def test_merging_facets_leaves_hulls_at_least_twelve_tenths_of_a_millimetre_thick(thickness, flat):
    assert is_box(flatten_facets(roof((0.06, 0.04), thickness, 3e-5))) == flat


@pytest.mark.parametrize(("strips", "flat"), [(25, True), (26, False)])
def test_twenty_four_facets_are_merged_one_after_the_other(strips, flat):
    assert is_box(flatten_facets(roof((0.8, 0.6), 0.1, 1e-3, strips))) == flat


@pytest.mark.parametrize(("diameter", "whole"), [(0.225, True), (0.24, False)])
def test_thin_hulls_are_thickened_up_to_four_thousandths_of_the_diagonal_of_an_object(diameter, whole):
    """A disc drawn as one sheet in an object with a diagonal of a metre: 4 mm do for 0.233 m."""
    rim = np.column_stack([circle(diameter), np.zeros(16)])
    sheet = np.stack([np.broadcast_to(rim[0], (14, 3)), rim[1:-1], rim[2:]], axis=1)
    hulls = cover_surface(sheet, find_free_space(sheet, 1.0), 1.0).hulls
    assert (len(hulls) == 1) == whole
    assert all(hull_width(hull)[0] <= 0.004 for hull in hulls)


def test_a_hull_is_thickened_by_hardly_more_than_its_length_asks_for():
    (thick,) = compact_hull(plate(circle(0.5), 0.002), 0.1)
    assert 56.0 < hull_aspect(thick) <= 60.0


@pytest.mark.parametrize("lost", [0.1, 0.03, 0.01])
def test_a_ball_is_halved_until_its_surface_is_near_to_hulls_of_few_corners(lost):
    rng = np.random.default_rng(0)
    points = rng.normal(size=(3000, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    hulls = compact_hull(convex_hull(points), 0.0, lost=lost)
    planes = [hull_planes(hull) for hull in hulls]
    outside = np.min([(points @ p[:, :3].T - p[:, 3]).max(axis=1) for p in planes], axis=0)
    assert outside.max() <= lost
    assert all(len(hull.vertices) <= 32 for hull in hulls)
    assert len(hulls) <= 1.3 / lost


@pytest.mark.parametrize(("diameter", "whole"), [(0.5, True), (0.75, False)])
def test_a_thin_disc_is_halved_seven_times(diameter, whole):
    """A millimetre and a half thick; pieces that are still longer than 0.09 m are left out."""
    disc = plate(circle(diameter), 0.0015)
    kept = sum(map(hull_volume, compact_hull(disc, 0.0))) / hull_volume(disc)
    assert (kept > 0.9) == whole


@pytest.mark.parametrize("leg", [0.8, 1.0, 1.4])
def test_a_triangular_plate_loses_nothing_where_it_is_cut_four_times(leg):
    """Six millimetres thick, and up to 330 times as long."""
    triangle = plate([[0.0, 0.0], [leg, 0.0], [0.0, leg]], 0.006)
    found = trim_hull(triangle)
    assert max(map(hull_aspect, found)) <= 60.0 + 1e-6
    assert sum(map(hull_volume, found)) == pytest.approx(hull_volume(triangle))


def test_the_tip_of_a_spike_is_left_out_once_it_has_been_halved_five_times():
    """The half with the tip holds a quarter of a spike, and is as oblong where its foot is slanted."""
    spike = plate([[0.0, 0.0], [0.0, 0.01], [-0.19, 0.355]], 0.006)
    kept = sum(map(hull_volume, trim_hull(spike))) / hull_volume(spike)
    assert 1.0 - kept == pytest.approx(0.25**5, rel=0.05)
