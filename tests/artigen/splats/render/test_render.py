"""The rasteriser of splats against a plain one over all pixels, finite differences and closed forms."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from artigen.camera import frame_points
from artigen.kinematics import articulate_gaussians, displacements, qlimits
from artigen.shapes.draw import draw_shape
from artigen.shapes.render import build_scene, render
from artigen.shapes.sampling import place_points
from artigen.splats.motion import transform_gaussians
from artigen.splats.parts import merge_gaussians, select_gaussians
from artigen.splats.render import (
    Cameras,
    RasterConfig,
    Splats,
    batch_cameras,
    make_splats,
    move_splats,
    rasterize,
)
from artigen.splats.render.projection import View, list_views
from artigen.splats.render.rasterize import rasterize_view
from artigen.transforms import matrix_from_quat, quat_from_matrix, rotation_about, screw_motion
from artigen.types import Asset, Gaussians

EXACT = RasterConfig(min_transmittance=0.0)
SMOOTH = RasterConfig(min_transmittance=0.0, min_alpha=1e-12)
"""Without cut-offs, pictures are smooth functions of the splats."""
TURN = rotation_about(np.array([2.0, -1.0, 3.0]) / np.sqrt(14.0), np.array(0.8))


def random_splats(
    count: int,
    seed: int = 0,
    *,
    scale: tuple[float, float] = (0.01, 0.1),
    dtype: torch.dtype = torch.float64,
    opacity: tuple[float, float] = (0.1, 1.0),
) -> Splats:
    """Splats of all shapes in the unit cube; every second one flat."""
    rng = np.random.default_rng(seed)
    scales = np.exp(rng.uniform(np.log(scale[0]), np.log(scale[1]), (count, 3)))
    scales[::2, 0] *= 0.05
    arrays = {
        "means": rng.uniform(-0.5, 0.5, (count, 3)),
        "quats": rng.normal(size=(count, 4)),
        "scales": scales,
        "opacities": rng.uniform(opacity[0], opacity[1], count),
        "colors": rng.uniform(0, 1, (count, 3)),
    }
    return Splats(**{name: torch.tensor(array, dtype=dtype) for name, array in arrays.items()})


def random_gaussians(asset: Asset, count: int, seed: int = 0) -> Gaussians:
    rng = np.random.default_rng(seed)
    splats = random_splats(count, seed, scale=(0.02, 0.08))
    quats = splats.quats / splats.quats.norm(dim=1, keepdim=True)
    arrays = {name: value.numpy() for name, value in vars(replace(splats, quats=quats)).items()}
    return Gaussians(**arrays, part_ids=rng.integers(0, len(asset.parts), count))


def cameras_at(*positions: Sequence[float], width: int = 52, height: int = 37, fov: float = 40.0) -> Cameras:
    position = torch.tensor(positions, dtype=torch.float64)
    return Cameras(
        position=position,
        target=torch.tensor([[0.05, -0.02, 0.03]], dtype=torch.float64).expand_as(position),
        fov=torch.full((len(position),), fov, dtype=torch.float64),
        width=width,
        height=height,
    )


AROUND = cameras_at((-1.7, 0.3, 0.8), (0.9, 1.4, -0.6), (0.2, 0.5, 0.1))
"""The last stands among the splats."""


def draw_plainly(
    splats: Splats, view: View, background: Tensor, cfg: RasterConfig
) -> tuple[Tensor, Tensor, Tensor]:
    """Colour, alpha, depth: every splat over every pixel, from the formulas of the papers, in float64."""
    arrays = {name: value.detach().double().numpy() for name, value in vars(splats).items()}
    W, focal = view.axes.double().numpy(), float(view.focal)
    column, row = np.meshgrid(np.arange(view.width) + 0.5, np.arange(view.height) + 0.5)
    color = np.zeros((view.height, view.width, arrays["colors"].shape[1]))
    depth, covered, through = np.zeros(column.shape), np.zeros(column.shape), np.ones(column.shape)
    local = (arrays["means"] - view.position.double().numpy()) @ W.T
    for k in np.argsort(local[:, 2], kind="stable"):
        x, y, z = local[k]
        if z <= cfg.near:
            continue
        R = matrix_from_quat(arrays["quats"][k] / np.linalg.norm(arrays["quats"][k]))
        spread = R @ np.diag(arrays["scales"][k] ** 2) @ R.T
        wide, high = (1.3 * size / (2.0 * focal) for size in (view.width, view.height))
        u, v = np.clip(x / z, -wide, wide), np.clip(y / z, -high, high)
        J = focal / z * np.array([[1.0, 0.0, -u], [0.0, 1.0, -v]])
        plain = J @ W @ spread @ W.T @ J.T
        filtered = plain + cfg.filter_variance * np.eye(2)
        strength = arrays["opacities"][k] * np.sqrt(np.linalg.det(plain) / np.linalg.det(filtered))
        offset = np.stack(
            [column - focal * x / z - view.width / 2, row - focal * y / z - view.height / 2], axis=-1
        )
        power = np.einsum("hwi,ij,hwj->hw", offset, np.linalg.inv(filtered), offset)
        alpha = np.minimum(strength * np.exp(-0.5 * power), cfg.max_alpha)
        alpha[alpha <= cfg.min_alpha] = 0.0
        color += (through * alpha)[:, :, None] * arrays["colors"][k]
        depth += through * alpha * z
        covered += through * alpha
        through *= 1.0 - alpha
    color += through[:, :, None] * background.double().numpy()
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(covered > 0, depth / covered, np.inf)
    return torch.tensor(color), torch.tensor(covered), torch.tensor(mean)


@pytest.mark.parametrize("cfg", [EXACT, replace(EXACT, tile=5, fragments=300, pairs=1), SMOOTH])
def test_pictures_are_those_of_the_plain_rasteriser(cfg: RasterConfig):
    splats, background = random_splats(150), torch.tensor([0.2, 0.5, 0.9], dtype=torch.float64)
    got = rasterize(splats, AROUND, background=background, cfg=cfg)
    for k, view in enumerate(list_views(AROUND, splats)):
        color, alpha, depth = draw_plainly(splats, view, background, cfg)
        torch.testing.assert_close(got.color[k], color, rtol=0, atol=1e-10)
        torch.testing.assert_close(got.alpha[k], alpha, rtol=0, atol=1e-10)
        torch.testing.assert_close(got.depth[k], depth, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize(("count", "scale"), [(1200, (0.006, 0.03)), (400, (0.02, 0.3))])
def test_single_precision_and_early_ends_cost_nothing_that_can_be_seen(count: int, scale):
    splats = random_splats(count, scale=scale, dtype=torch.float32)
    view = list_views(AROUND, splats)[0]
    got = rasterize(splats, AROUND)
    color, alpha, _ = draw_plainly(splats, view, torch.zeros(3), RasterConfig())
    for one, other in ((got.color[0], color), (got.alpha[0], alpha)):
        error = (one.double() - other).square().mean()
        assert -10 * torch.log10(error) > 70  # dB
        assert (one.double() - other).abs().max() < 1.1 / 255  # one splat on the edge of min_alpha


@pytest.mark.parametrize("cfg", [SMOOTH, RasterConfig(tile=4, fragments=3000, pairs=100)])
def test_gradients_are_finite_differences(cfg: RasterConfig):
    splats = random_splats(8, seed=3, scale=(0.05, 0.2), opacity=(0.5, 1.0))
    splats.scales[0], splats.opacities[0] = 0.8, 1.0  # more than max_alpha in the middle
    cameras = cameras_at((-1.2, 0.3, 0.5), (0.5, 0.9, -0.4), width=10, height=7)
    generator = torch.Generator().manual_seed(0)
    weights = [
        torch.rand(2, 7, 10, *size, dtype=torch.float64, generator=generator) for size in ((3,), (), ())
    ]

    def score(values: dict[str, Tensor], position: Tensor) -> Tensor:
        got = rasterize(
            Splats(**values), replace(cameras, position=position), background=(0.3, 0.1, 0.8), cfg=cfg
        )
        depth = torch.where(got.alpha > 0.05, got.depth, 0.0)
        pictures = (got.color, got.alpha, depth)
        return torch.stack([(w * x).sum() for w, x in zip(weights, pictures, strict=True)]).sum()

    values = {name: value.clone().requires_grad_() for name, value in vars(splats).items()}
    position = cameras.position.clone().requires_grad_()
    score(values, position).backward()
    for name, tensor in {**values, "position": position}.items():
        assert tensor.grad is not None
        found = torch.zeros_like(tensor)
        with torch.no_grad():
            for index in np.ndindex(*tensor.shape):
                kept = tensor[index].clone()
                sides = []
                for step in (1e-6, -1e-6):
                    tensor[index] = kept + step
                    sides.append(score(values, position))
                tensor[index] = kept
                found[index] = (sides[0] - sides[1]) / 2e-6
        assert (found - tensor.grad).norm() < 1e-3 * found.norm(), name
        assert found.norm() > 0


def test_what_is_hidden_contributes_nothing():
    front = random_splats(6)
    opaque = {"means": torch.zeros(6, 3), "opacities": torch.ones(6), "scales": torch.full((6, 3), 2.0)}
    front = replace(front, **{name: value.double() for name, value in opaque.items()})
    behind = random_splats(200, seed=1)
    behind = replace(behind, means=behind.means + torch.tensor([4.0, 0.0, 0.0]))
    both = Splats(**{name: torch.cat([value, vars(front)[name]]) for name, value in vars(behind).items()})
    camera = cameras_at((-3.0, 0.0, 0.1))
    leaf = replace(both, colors=both.colors.clone().requires_grad_())
    picture = rasterize(leaf, camera)
    torch.testing.assert_close(picture.color, rasterize(front, camera).color, rtol=0, atol=1e-10)
    picture.color.sum().backward()
    assert leaf.colors.grad is not None
    assert leaf.colors.grad[:200].abs().max() < 1e-9 < leaf.colors.grad[200:].abs().min()


@pytest.mark.parametrize(("left", "seen"), [(1.15e-4, 1.0), (0.85e-4, 0.0)])
def test_splats_count_until_a_ten_thousandth_of_the_light_is_left(left: float, seen: float):
    """Three layers let ``left`` of the light through; a bright one stands behind them."""
    layers = torch.arange(4.0).double()
    opacities = torch.full((4,), 1.0 - left ** (1 / 3)).double()
    splats = Splats(
        means=torch.stack([1.0 + 0.1 * layers, 0 * layers, 0 * layers], dim=1),
        quats=torch.tensor([[1.0, 0.0, 0.0, 0.0]]).double().expand(4, 4),
        scales=torch.full((4, 3), 100.0).double(),
        opacities=opacities,
        colors=(layers == 3).double()[:, None].expand(4, 3),
    )
    camera = cameras_at((-1.7, 0.0, 0.0))
    pictures = [
        rasterize(splats, camera, cfg=RasterConfig(fragments=1, min_transmittance=least)).color
        for least in (RasterConfig().min_transmittance, 0.0)
    ]
    assert float(pictures[1].min()) == pytest.approx(left * float(opacities[0]), rel=0.01)
    torch.testing.assert_close(pictures[0], seen * pictures[1])


def test_rows_have_no_order():
    splats, order = random_splats(300), torch.randperm(300, generator=torch.Generator().manual_seed(0))
    mixed = Splats(**{name: value[order] for name, value in vars(splats).items()})
    torch.testing.assert_close(rasterize(mixed, AROUND).color, rasterize(splats, AROUND).color)


def test_turning_the_camera_is_turning_the_splats_back():
    splats = random_splats(200)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = TURN, (0.3, -0.2, 0.1)
    moved = move_splats(splats, torch.zeros(200, dtype=torch.int64), T[None])
    R, t = torch.tensor(T[:3, :3]), torch.tensor(T[:3, 3])
    for view in list_views(AROUND, splats):
        turned = replace(view, axes=view.axes @ R.T, position=R @ view.position + t)
        torch.testing.assert_close(
            rasterize_view(moved, turned, EXACT), rasterize_view(splats, view, EXACT), rtol=0, atol=1e-9
        )


@pytest.mark.parametrize("variance", [0.1, 0.5])
@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.37, -0.21)])
def test_a_footprint_covers_what_the_closed_form_says(variance: float, shift: tuple[float, float]):
    """The sum over the picture is 2 pi o sqrt(det), filtered or not; the filter adds to the variance."""
    view = View(
        axes=torch.tensor(TURN), position=torch.tensor([0.1, 0.2, 0.3]).double(),
        focal=torch.tensor(60.0).double(), width=64, height=64,
    )  # fmt: skip
    z, scales = 1.5, np.array([0.04, 0.07, 0.02])
    R = rotation_about(np.array([1.0, 2.0, 2.0]) / 3.0, np.array(1.1))
    splat = Splats(
        means=(view.position + z * view.axes[2])[None],
        quats=torch.tensor(quat_from_matrix(R))[None],
        scales=torch.tensor(scales)[None],
        opacities=torch.tensor([0.6]).double(),
        colors=torch.ones(1, 1).double(),
    )
    J = 60.0 / z * np.array([[1.0, 0.0, -shift[0] / 60.0], [0.0, 1.0, -shift[1] / 60.0]])
    pixels = J @ TURN @ R @ np.diag(scales**2) @ R.T @ TURN.T @ J.T
    cfg = replace(SMOOTH, filter_variance=variance)
    step = torch.tensor(shift).double() * z / 60.0
    moved = replace(view, position=view.position - step @ view.axes[:2])
    alpha = rasterize_view(splat, moved, cfg)[..., -1].numpy()
    column, row = np.meshgrid(np.arange(64) + 0.5, np.arange(64) + 0.5)
    total = alpha.sum()
    center = np.array([(alpha * column).sum(), (alpha * row).sum()]) / total
    offset = np.stack([column, row], axis=-1) - center
    spread = np.einsum("hw,hwi,hwj->ij", alpha, offset, offset) / total
    assert total == pytest.approx(0.6 * 2.0 * np.pi * np.sqrt(np.linalg.det(pixels)), rel=1e-6)
    np.testing.assert_allclose(center, 32.0 + np.array(shift), atol=1e-6)
    np.testing.assert_allclose(spread, pixels + variance * np.eye(2), rtol=1e-5)


def test_an_articulated_set_looks_like_its_parts_moved(cabinet: Asset):
    gaussians = random_gaussians(cabinet, 300)
    limits = qlimits(cabinet)
    camera = batch_cameras([frame_points(gaussians.means * 1.5, (-1.0, 0.6, 0.5), width=48, height=40)])
    for share in (0.0, 0.6, 1.0):
        qpos = limits[:, 0] + share * (limits[:, 1] - limits[:, 0])
        D = displacements(cabinet, qpos)
        splats = make_splats(gaussians, dtype=torch.float64)
        moved = move_splats(splats, torch.tensor(gaussians.part_ids).long(), D)
        placed = [
            transform_gaussians(select_gaussians(gaussians, gaussians.part_ids == part), T)
            for part, T in enumerate(D)
        ]
        want = rasterize(moved, camera, cfg=EXACT).color
        for other in (articulate_gaussians(cabinet, qpos, gaussians), merge_gaussians(placed)):
            got = rasterize(make_splats(other, dtype=torch.float64), camera, cfg=EXACT).color
            torch.testing.assert_close(got, want, rtol=0, atol=2e-5)
        assert want.sum() > 10
    opened = rasterize(make_splats(articulate_gaussians(cabinet, limits[:, 1], gaussians)), camera).color
    assert (opened - rasterize(make_splats(gaussians), camera).color).abs().max() > 0.1


def test_moving_the_object_is_moving_the_camera(cabinet: Asset):
    gaussians = random_gaussians(cabinet, 200)
    T = screw_motion(np.array([0.0, 0.0, 1.0]), np.array([0.2, 0.4, 0.0]), np.array(0.7), np.array(0.3))
    position, target = (value.numpy() @ T[:3, :3].T + T[:3, 3] for value in (AROUND.position, AROUND.target))
    followed = replace(AROUND, position=torch.tensor(position), target=torch.tensor(target))
    got = rasterize(make_splats(transform_gaussians(gaussians, T), dtype=torch.float64), followed, cfg=EXACT)
    want = rasterize(make_splats(gaussians, dtype=torch.float64), AROUND, cfg=EXACT)
    torch.testing.assert_close(got.color, want.color, rtol=0, atol=2e-5)


def test_both_renderers_see_the_same_object_from_the_same_camera():
    shape = draw_shape("StorageFurniture", 0)
    spacing = 0.012
    points = place_points(shape, spacing)
    at = np.asarray(points.points, dtype=np.float32)
    camera = batch_cameras([frame_points(at, (-1.0, 0.5, 0.4), width=96, height=80)])
    exact = render(build_scene([shape]), camera, [np.zeros(len(shape.parts))])
    count = len(at)
    splats = Splats(
        means=torch.tensor(at), quats=torch.tensor([[1.0, 0.0, 0.0, 0.0]]).expand(count, 4),
        scales=torch.full((count, 3), 0.5 * spacing), opacities=torch.full((count,), 0.9),
        colors=torch.ones(count, 1),
    )  # fmt: skip
    got = rasterize(splats, camera)
    seen, mask = got.alpha[0] > 0.5, exact.mask[0]
    assert not (seen & ~_grow(mask)).any()
    assert not (mask & ~_grow(seen)).any()
    middles = [found.nonzero().double().mean(0) for found in (seen, mask)]
    torch.testing.assert_close(*middles, rtol=0, atol=0.25)
    assert (got.depth[0] - exact.depth[0])[seen & mask].abs().median() < spacing


def _grow(mask: Tensor) -> Tensor:
    """The mask with the pixels beside it."""
    return torch.nn.functional.max_pool2d(mask[None].float(), 3, 1, 1)[0] > 0
