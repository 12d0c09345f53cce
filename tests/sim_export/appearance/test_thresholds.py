"""Boundaries of images: sizes of texels, charts and bands, and what counts as one colour or as a speck."""

import numpy as np
import pytest

from artigen.types import Gaussians
from sim_export.appearance.atlas import make_atlas
from sim_export.appearance.texture import bake_mesh, color_atlas
from sim_export.package import Mesh


def plate(length: float, width: float) -> Mesh:
    """A rectangle that faces up."""
    corners = np.array([[0, 0, 0], [length, 0, 0], [length, width, 0], [0, width, 0]], dtype=float)
    return Mesh(vertices=corners, faces=np.array([[0, 1, 2], [0, 2, 3]]))


def dots(means: np.ndarray, levels: np.ndarray, size: float) -> Gaussians:
    """Opaque grey balls of Gaussians."""
    shares = levels / 255.0
    linear = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    return Gaussians(
        means=means,
        quats=np.tile([1.0, 0.0, 0.0, 0.0], (len(means), 1)),
        scales=np.full((len(means), 3), size),
        opacities=np.ones(len(means)),
        colors=np.repeat(linear[:, None], 3, axis=1),
        part_ids=np.zeros(len(means), dtype=np.int64),
    )


def test_every_chart_has_a_border_of_one_texel():
    """11 x 6 texel centres lie on the rectangle."""
    assert make_atlas(plate(1.0, 0.5), 0.1, 512).shape == (8, 13)


@pytest.mark.parametrize(("outside", "covered"), [(0.9e-4, True), (1.1e-4, False)])
def test_a_texel_is_covered_within_a_ten_thousandth_of_a_texel_of_a_triangle(outside, covered):
    """The right side of the triangle passes the texel (7, 5) on the left."""
    corners = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [4.0 - 2.0 * outside, 10.0, 0.0]])
    atlas = make_atlas(Mesh(vertices=corners, faces=np.array([[0, 1, 2]])), 1.0, 512)
    assert ([6, 8] in atlas.texels.tolist()) == covered


def test_no_texel_of_a_baked_image_is_darker_than_four_levels():
    atlas = make_atlas(plate(1.0, 0.5), 0.1, 512)
    painted = color_atlas(plate(1.0, 0.5), atlas, np.zeros((len(atlas.texels), 3), dtype=np.uint8))
    assert painted.texture is not None
    assert np.unique(painted.texture).tolist() == [4]


def test_a_voxel_is_two_and_a_half_texels_long():
    ends = dots(np.array([[0.0, 0, 0], [1.0, 0.5, 0]]), np.array([50.0, 200.0]), 0.1)
    baked = bake_mesh(plate(1.0, 0.5), ends, voxel=0.25).mesh
    assert baked.texture is not None
    assert baked.texture.shape[:2] == (8, 13)


@pytest.mark.parametrize(("length", "width"), [(509.0, 512), (510.0, 489)])
def test_texels_grow_by_a_twentieth_where_an_image_exceeds_512(length, width):
    ends = dots(np.array([[0.0, 0, 0], [length, 1, 0]]), np.array([50.0, 200.0]), 1.0)
    baked = bake_mesh(plate(length, 1.0), ends, voxel=2.5).mesh
    assert baked.texture is not None
    assert baked.texture.shape[1] == width


@pytest.mark.parametrize(("level", "kept"), [(125, True), (126, False)])
def test_a_texel_is_a_speck_if_it_differs_by_more_than_24_levels(level, kept):
    """One Gaussian per texel; a 37th of what a texel shows is that of its neighbours."""
    means = np.stack([*np.meshgrid(np.arange(9.0), np.arange(7.0)), np.zeros((7, 9))], axis=2).reshape(-1, 3)
    levels = np.where((means == [4, 3, 0]).all(axis=1), level, 100.0)
    baked = bake_mesh(
        plate(8.0, 6.0), dots(means, levels, 0.1), voxel=2.5, normals=np.tile([0, 0, 1.0], (63, 1))
    )
    assert baked.mesh.texture is not None
    assert baked.mesh.texture.max() == (124 if kept else 100)


def test_a_part_of_one_colour_has_no_texels():
    baked = bake_mesh(plate(1.0, 0.5), dots(np.zeros((1, 3)), np.array([90.0]), 0.1), voxel=0.1)
    assert (baked.mesh.texture, baked.texels, baked.covered) == (None, 0, 0)
