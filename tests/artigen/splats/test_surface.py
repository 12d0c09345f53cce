"""Discs on a surface: where the samples are, as large as what each stands for, and not over the edge."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from artigen.api.sample import make_package
from artigen.camera import look_at
from artigen.shapes.draw import draw_shape
from artigen.splats.colors import linear_from_srgb
from artigen.splats.render import Cameras, make_splats, rasterize
from artigen.splats.render.picture import draw_gaussians
from artigen.splats.surface import SurfaceSplatConfig, splat_surface, thin_samples
from artigen.transforms import matrix_from_quat
from artigen.types import Asset, SurfaceSamples


def sheet(count: int = 6000, edge: float = 0.6, seed: float = 0.0) -> SurfaceSamples:
    """A square that faces the camera at -x, evenly sampled."""
    steps = np.arange(1, count + 1)[:, None] * [0.7548776662466927, 0.5698402909980532]
    flat = (np.modf(steps + seed)[0] - 0.5) * edge
    return SurfaceSamples(
        points=np.column_stack([np.zeros(count), flat]),
        normals=np.tile([-1.0, 0.0, 0.0], (count, 1)),
        colors=np.tile(np.array([200, 30, 60], dtype=np.uint8), (count, 1)),
        part_ids=np.full(count, 2),
    )


def test_every_sample_has_a_flat_disc_that_faces_its_way(cabinet: Asset):
    assert cabinet.surface is not None
    rows = slice(None, None, 20)
    surface = SurfaceSamples(**{name: value[rows] for name, value in vars(cabinet.surface).items()})
    gaussians = splat_surface(surface, SurfaceSplatConfig(apart=0.0))
    np.testing.assert_array_equal(gaussians.means, surface.points)
    np.testing.assert_array_equal(gaussians.part_ids, surface.part_ids)
    np.testing.assert_allclose(gaussians.colors, linear_from_srgb(surface.colors / 255.0), atol=1e-6)
    assert (gaussians.opacities == 1).all()
    thin = matrix_from_quat(gaussians.quats)[:, :, 2]
    lengths = np.linalg.norm(surface.normals, axis=1, keepdims=True)
    np.testing.assert_allclose(thin, surface.normals / lengths, atol=1e-4)
    assert (gaussians.scales[:, 2] < 0.5 * gaussians.scales[:, :2].min(axis=1)).all()
    assert len(np.unique(surface.part_ids)) > 1


@pytest.mark.parametrize("normal", [[0, 0, 1], [0, 0, -1], [0, 1, 0], [0.6, 0, -0.8], [1e-5, 0, -1]])
def test_any_direction_is_a_normal(normal: list[float]):
    one = replace(sheet(50), normals=np.tile(np.array(normal, dtype=float), (50, 1)))
    thin = matrix_from_quat(splat_surface(one).quats)[:, :, 2]
    np.testing.assert_allclose(thin, one.normals / np.linalg.norm(normal), atol=2e-3)


def test_discs_grow_with_the_distance_between_samples():
    small, large = sheet(), replace(sheet(), points=3.0 * sheet().points)
    np.testing.assert_allclose(splat_surface(large).scales, 3.0 * splat_surface(small).scales, rtol=1e-3)
    inner = np.abs(small.points[:, 1:]).max(axis=1) < 0.25
    wanted = SurfaceSplatConfig().spread * 0.6 / np.sqrt(len(small.points))
    np.testing.assert_allclose(np.median(splat_surface(small).scales[inner, 0]), wanted, rtol=0.15)


def test_a_sheet_is_closed_and_ends_at_its_edge():
    edge, count = 0.6, 6000
    splats = make_splats(splat_surface(sheet(count, edge)))
    kind = {"dtype": torch.float64}
    camera = Cameras(
        position=torch.tensor([[-4.0, 0.0, 0.0]], **kind),
        target=torch.zeros(1, 3, **kind),
        fov=torch.tensor([2 * np.degrees(np.arctan(0.5 / 4.0))], **kind),
        width=256,
        height=256,
    )
    alpha = rasterize(splats, camera).alpha[0].numpy()
    places = np.abs((np.arange(256) + 0.5) / 256 - 0.5)
    beyond = np.maximum(places[:, None], places[None]) - edge / 2
    spacing = edge / np.sqrt(count)
    assert alpha[beyond < -2 * spacing].min() > 0.85
    assert alpha[beyond < -2 * spacing].mean() > 0.98
    assert alpha[beyond > 1.5 * spacing].max() < 0.35
    assert alpha[beyond > 2.5 * spacing].max() < 0.05
    # The covered area is that of the sheet.
    assert alpha.mean() == pytest.approx(edge**2, rel=0.03)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_sheet_without_thickness_shows_the_side_one_looks_at(side: float):
    one, count = sheet(6000), 6000
    both = SurfaceSamples(
        points=np.concatenate([one.points, sheet(6000, seed=0.37).points]),
        normals=np.concatenate([one.normals, -one.normals]),
        colors=np.repeat(np.array([[200, 30, 60], [20, 60, 220]], dtype=np.uint8), count, axis=0),
        part_ids=np.zeros(2 * count, dtype=np.int64),
    )
    discs = splat_surface(both)
    spacing = 0.6 / np.sqrt(count)
    np.testing.assert_allclose(np.abs(discs.means[:, 0]), 0.5 * spacing, rtol=0.15)
    camera = look_at(np.array([side * 4.0, 1.5, 1.0]), np.zeros(3), fov=5.0, width=96, height=96)
    picture = draw_gaussians(discs, camera).astype(float)
    wanted = both.colors[0 if side < 0 else -1].astype(float)
    wrong = np.abs(picture - wanted).max(axis=2)
    assert np.median(wrong) < 12
    assert np.percentile(wrong, 95) < 60


def test_what_cannot_be_a_disc_is_an_error():
    none = SurfaceSamples(**{name: value[:0] for name, value in vars(sheet(4)).items()})
    with pytest.raises(ValueError, match="no samples"):
        splat_surface(none)
    with pytest.raises(ValueError, match="of length 0"):
        splat_surface(replace(sheet(4), normals=np.zeros((4, 3))))
    with pytest.raises(ValueError, match="sample the surface more densely"):
        splat_surface(replace(sheet(3), part_ids=np.arange(3)))


def test_thinning_keeps_at_most_so_many_and_all_if_there_are_no_more():
    surface = sheet(1000)
    assert len(thin_samples(surface, 1000).points) == 1000
    assert len(thin_samples(surface, 999).points) == 500
    assert 2 * 100 > len(thin_samples(surface, 150).points) > 100


def test_a_procedural_package_can_hold_discs_where_its_meshes_are():
    package = make_package(draw_shape("Safe", 2), "reference", splats=True)
    assert any("discs on the exact faces" in record for record in package.records)
    shown = [link for link in package.links if link.visuals]
    assert len(shown) > 1
    for link in shown:
        assert link.splats is not None
        corners = np.concatenate([visual.mesh.vertices for visual in link.visuals])
        means = link.splats.means
        assert (means > corners.min(axis=0) - 1e-3).all()
        assert (means < corners.max(axis=0) + 1e-3).all()
        reached = (means.max(axis=0) - means.min(axis=0)) / np.ptp(corners, axis=0)
        assert reached.min() > 0.8
