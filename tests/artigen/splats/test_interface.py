"""What the rasteriser promises around its pictures: backgrounds, empty views, errors."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import torch

from artigen.splats.colors import linear_from_srgb, srgb_from_linear
from artigen.splats.render import Cameras, RasterConfig, Splats, make_splats, rasterize
from artigen.types import Gaussians


@pytest.fixture
def splats() -> Splats:
    generator = torch.Generator().manual_seed(0)
    return Splats(
        means=torch.rand(60, 3, generator=generator) - 0.5,
        quats=torch.randn(60, 4, generator=generator),
        scales=0.02 + 0.1 * torch.rand(60, 3, generator=generator),
        opacities=torch.rand(60, generator=generator),
        colors=torch.rand(60, 3, generator=generator),
    )


@pytest.fixture
def cameras() -> Cameras:
    position = torch.tensor([[-2.0, 0.1, 0.3], [0.4, 1.8, 0.7]])
    return Cameras(
        position=position, target=torch.zeros(2, 3), fov=torch.tensor([40.0, 50.0]), width=30, height=21
    )


def test_backgrounds_shine_through_what_is_left(splats: Splats, cameras: Cameras):
    black, blue = rasterize(splats, cameras), torch.tensor([0.1, 0.2, 0.9])
    each = torch.stack([blue, 1.0 - blue])
    want = black.color + (1.0 - black.alpha)[..., None] * each[:, None, None]
    torch.testing.assert_close(rasterize(splats, cameras, background=each).color, want)
    plain = rasterize(splats, cameras, background=(0.1, 0.2, 0.9))
    torch.testing.assert_close(plain.color[0], want[0])
    assert torch.equal(plain.alpha, black.alpha)
    with pytest.raises(ValueError, match=r"background has shape \(2,\), expected \(3,\) or \(2, 3\)"):
        rasterize(splats, cameras, background=(0.1, 0.2))


def test_any_number_of_channels_is_blended_alike(splats: Splats, cameras: Cameras):
    five = replace(splats, colors=torch.cat([splats.colors, splats.colors[:, :2]], dim=1))
    got, want = rasterize(five, cameras).color, rasterize(splats, cameras).color
    torch.testing.assert_close(got, torch.cat([want, want[..., :2]], dim=-1))


def test_nothing_in_view_is_background(splats: Splats, cameras: Cameras):
    leaves = {name: value.requires_grad_() for name, value in vars(splats).items()}
    for shift, rows in ((100.0, 60), (0.0, 0)):
        some = Splats(**{name: value[:rows] for name, value in leaves.items()})
        picture = rasterize(replace(some, means=some.means + shift), cameras, background=(1.0, 0.5, 0.0))
        assert torch.equal(picture.color[1, 20, 29], torch.tensor([1.0, 0.5, 0.0]))
        assert float(picture.alpha.detach().abs().max()) == 0.0
        assert bool(torch.isinf(picture.depth).all())
        picture.color.sum().backward()
    assert all(bool((leaf.grad == 0).all()) for leaf in leaves.values() if leaf.grad is not None)


def test_degenerate_splats_have_finite_gradients(cameras: Cameras):
    """Points, needles seen from their end, splats in the camera's plane, full and no opacity."""
    leaves = {
        "means": torch.tensor([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [-2.0, 0.1, 0.31], [0.0, 0.1, 0.0]]),
        "quats": torch.tensor([[1.0, 0.0, 0.0, 0.0]]).repeat(4, 1),
        "scales": torch.tensor([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.1, 0.1, 0.1], [0.1, 0.2, 0.1]]),
        "opacities": torch.tensor([1.0, 1.0, 1.0, 0.0]),
        "colors": torch.ones(4, 3),
    }
    leaves = {name: value.requires_grad_() for name, value in leaves.items()}
    picture = rasterize(Splats(**leaves), cameras)
    (picture.color.sum() + picture.alpha.sum()).backward()
    assert bool(torch.isfinite(picture.color).all())
    for name, leaf in leaves.items():
        assert leaf.grad is not None
        assert bool(torch.isfinite(leaf.grad).all()), name


def test_precision_is_kept_within_autocast(splats: Splats, cameras: Cameras):
    want = rasterize(splats, cameras).color
    with torch.autocast("cpu", dtype=torch.bfloat16):
        assert torch.equal(rasterize(splats, cameras).color, want)
    leaf = splats.colors.clone().requires_grad_()
    grads = []
    for enabled in (False, True):
        leaf.grad = None
        with torch.autocast("cpu", dtype=torch.bfloat16, enabled=enabled):
            rasterize(replace(splats, colors=leaf), cameras).color.sum().backward()
        assert leaf.grad is not None
        grads.append(leaf.grad)
    assert torch.equal(grads[0], grads[1])


def test_linear_colours_become_srgb():
    light = np.linspace(0.0, 1.0, 1001)
    np.testing.assert_allclose(linear_from_srgb(srgb_from_linear(light)), light, atol=1e-12)
    assert float(srgb_from_linear(np.array(0.5))) == pytest.approx(0.735357, abs=1e-6)
    gaussians = Gaussians(
        means=np.zeros((1, 3)), quats=np.eye(4)[:1], scales=np.ones((1, 3)), opacities=np.array([0.5]),
        colors=np.array([[0.0, 0.5, 1.0]]), part_ids=np.array([0]),
    )  # fmt: skip
    splats = make_splats(gaussians, dtype=torch.float64)
    np.testing.assert_allclose(splats.colors.numpy(), [[0.0, 0.735357, 1.0]], atol=1e-6)
    assert splats.means.dtype == torch.float64


def test_wrong_arguments_are_named(splats: Splats, cameras: Cameras):
    with pytest.raises(ValueError, match="'means': 59"):
        replace(splats, means=splats.means[1:])
    with pytest.raises(ValueError, match=r"expected float32 or float64 on one device"):
        replace(splats, means=splats.means.half())
    with pytest.raises(ValueError, match="no cameras"):
        rasterize(
            splats,
            replace(cameras, position=cameras.position[:0], target=cameras.target[:0], fov=cameras.fov[:0]),
        )


@pytest.mark.parametrize(
    "build",
    [
        lambda: RasterConfig(min_alpha=0.0),
        lambda: RasterConfig(max_alpha=1.0),
        lambda: RasterConfig(min_transmittance=1.0),
        lambda: RasterConfig(near=0.0),
        lambda: RasterConfig(filter_variance=-0.1),
        lambda: RasterConfig(tile=0),
        lambda: RasterConfig(fragments=0),
    ],
)
def test_settings_out_of_range_are_refused(build: Callable[[], RasterConfig]):
    with pytest.raises(ValueError, match=r"rasteriser: .*expected"):
        build()


@pytest.mark.skipif(not torch.cuda.is_available(), reason="CUDA pictures need a GPU")
def test_gpus_draw_the_same(splats: Splats, cameras: Cameras):
    there = Splats(**{name: value.cuda() for name, value in vars(splats).items()})
    moved = replace(
        cameras, position=cameras.position.cuda(), target=cameras.target.cuda(), fov=cameras.fov.cuda()
    )
    got = rasterize(there, moved).color.cpu()
    assert (got - rasterize(splats, cameras).color).square().mean() < 1e-5  # 50 dB
