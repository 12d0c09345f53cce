"""Boundaries of how Gaussians are blended into texels; lengths in voxels, one place at the origin."""

import numpy as np
import pytest

from artigen.types import Gaussians
from sim_export.appearance.blending import Blended, Places, blend_places, find_near

BROAD = 100.0
"""Standard deviation of a Gaussian that is as dense at every place as at its centre."""
RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def one(mean, opacity: float, *, size: float = BROAD, color=RED) -> Gaussians:
    """A ball of a Gaussian."""
    return Gaussians(
        means=np.array([mean], dtype=float),
        quats=np.array([[1.0, 0.0, 0.0, 0.0]]),
        scales=np.full((1, 3), size),
        opacities=np.array([opacity]),
        colors=np.array([color]),
        part_ids=np.zeros(1, dtype=np.int64),
    )


def blend(*gaussians: Gaussians, facing=None, voxel: float = 1.0, texel: float = 1e-3) -> Blended:
    """What a place that faces up shows of Gaussians; with ``facing``, of such as face that way."""
    joined = Gaussians(
        **{name: np.concatenate([getattr(g, name) for g in gaussians]) for name in vars(gaussians[0])}
    )
    place = Places(points=np.zeros((1, 3)), normals=np.array([[0.0, 0.0, 1.0]]))
    normals = None if facing is None else np.tile(facing, (len(gaussians), 1))
    return blend_places(place, joined, voxel=voxel, texel=texel, normals=normals)


UP = (0.0, 0.0, 1.0)


def test_one_gaussian_hides_at_most_99_hundredths():
    assert blend(one((0, 0, 0), 1.0)).cover[0] == pytest.approx(0.99)


@pytest.mark.parametrize(("opacity", "on_top"), [(0.045, False), (0.055, True)])
def test_a_gaussian_is_the_top_sheet_from_an_alpha_of_a_twentieth(opacity, on_top):
    """Else it shares the place with the sheet below by their alphas: less than a sixteenth is red."""
    upper, lower = one((0, 0, 0.5), opacity), one((0, 0, 0), 0.9, color=BLUE)
    seen = blend(upper, lower, facing=UP)
    assert (seen.colors[0, 0] > 1 / 10) == on_top


@pytest.mark.parametrize(("density", "opacity"), [(0.095, 0.0), (0.105, 0.7)])
def test_a_place_has_an_opacity_from_a_summed_density_of_a_tenth(density, opacity):
    aside = np.sqrt(-2.0 * np.log(density))
    assert blend(one((aside, 0, 0), 0.7, size=1.0), voxel=2.0).opacity[0] == pytest.approx(opacity)


@pytest.mark.parametrize(("alpha", "closed"), [(0.29, False), (0.31, True)])
def test_a_sheet_is_closed_from_a_summed_alpha_of_three_tenths(alpha, closed):
    seen = blend(one((0, 0, 0.5), alpha), one((0, 0, 0), 0.9, color=BLUE), facing=UP)
    assert (seen.colors[0, 2] == 0.0) == closed


@pytest.mark.parametrize(("distance", "near"), [(1.99, True), (2.01, False)])
def test_what_is_two_64ths_of_the_extent_away_from_all_places_is_discarded(distance, near):
    places = np.array([[0.0, 0.0, 0.0], [64.0, 0.0, 0.0]])
    assert find_near(np.array([[distance, 0.0, 0.0]]), places, 0.01)[0] == near


def test_a_place_shows_the_16_nearest_gaussians():
    seen = blend(*[one((0, 0, 0), 0.02)] * 40)
    assert seen.cover[0] == pytest.approx(1.0 - 0.98**16, rel=1e-3)


@pytest.mark.parametrize(("height", "share"), [(0.75, 1.0), (0.85, 0.9375), (1.55, 0.0625), (1.65, 0.0)])
def test_gaussians_count_fully_within_four_fifths_of_a_voxel_and_not_at_all_beyond_twice_that(height, share):
    assert blend(one((0, 0, height), 0.5)).cover[0] == pytest.approx(0.5 * share, rel=1e-3)


def test_footprints_are_wider_by_a_tenth_of_a_square_texel():
    """A Gaussian of that size is half as dense in its centre."""
    seen = blend(one((0, 0, 0), 0.8, size=0.1**0.5), voxel=0.5, texel=1.0)
    assert seen.cover[0] == pytest.approx(0.4, rel=1e-3)


@pytest.mark.parametrize(("height", "shown"), [(0.95, True), (1.05, False)])
def test_heights_count_by_half_in_the_search_for_the_nearest(height, shown):
    beside = [one((0.5, 0, 0), 0.02)] * 16
    seen = blend(*beside, one((0, 0, height), 0.02, color=BLUE))
    assert (seen.colors[0, 2] > 0.0) == shown


def test_gaussians_at_bare_places_have_a_radius_of_at_least_35_hundredths_of_a_voxel():
    seen = blend(one((0.5, 0, 0), 0.9, size=0.01))
    assert seen.cover[0] == pytest.approx(0.9 * np.exp(-0.5 * (0.5 / 0.35) ** 2), rel=1e-3)


@pytest.mark.parametrize(("cover", "widened"), [(0.195, True), (0.205, False)])
def test_a_place_is_bare_if_less_than_a_fifth_of_it_is_hidden(cover, widened):
    aside = 0.1 * np.sqrt(2.0 * np.log(0.9 / cover))
    assert (blend(one((aside, 0, 0), 0.9, size=0.1)).cover[0] > 0.3) == widened


@pytest.mark.parametrize(("opacity", "clear"), [(0.48, True), (0.52, False)])
def test_places_are_panes_below_a_mean_opacity_of_a_half(opacity, clear):
    assert blend(one((0, 0, 0), opacity)).find_panes()[0] == clear


@pytest.mark.parametrize(("depth", "together"), [(0.038, True), (0.042, False)])
def test_gaussians_within_four_hundredths_of_a_voxel_are_one_sheet(depth, together):
    seen = blend(one((0, 0, 0), 0.5), one((0, 0, -depth), 0.5, color=BLUE), facing=UP)
    assert (seen.colors[0, 2] > 0.0) == together


@pytest.mark.parametrize(("cosine", "shown"), [(0.19, False), (0.21, True)])
def test_gaussians_show_if_the_cosine_to_their_normal_exceeds_a_fifth(cosine, shown):
    seen = blend(one((0, 0, 0), 0.5), facing=(np.sqrt(1.0 - cosine**2), 0.0, cosine))
    assert (seen.cover[0] > 0.0) == shown
