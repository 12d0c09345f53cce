"""Gaussians and latents of the appearance networks: parametrisation, sampling, size, learning."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from sparse_voxels import draw_voxels, redraw
from torch.nn import functional

from artigen.appearance.gaussian_decoder import (
    GaussianConfig,
    GaussianDecoder,
    GaussianDecoderConfig,
    select_voxels,
    to_gaussians,
)
from artigen.appearance.linear_prior import KINDS, Expectation, find_kinds, fit_expectation
from artigen.appearance.paint import PAINT
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.appearance.slat_flow import SlatFlow, sample_slats
from artigen.appearance.slat_vae import SlatEncoder
from artigen.appearance.vae import COLOR_MIDDLE, COLOR_SPREAD, SIDE_CHANNELS, SIDE_LATENTS, AppearanceVae
from artigen.models.conditions import StructureCondition, gather_conditions
from artigen.models.rectified_flow import SamplerConfig, diffuse, draw_times
from artigen.models.store import load_model, save_model
from artigen.splats.colors import srgb_from_linear
from artigen.splats.render.splats import Splats
from artigen.transforms import matrix_from_quat
from artigen.types import PART_LABELS
from artigen.voxels.frames import AROUND, FACINGS, SIDES, facing_frames
from artigen.voxels.surface import MIDDLE_SPREAD, PLACES

TINY = APPEARANCE_PRESETS["tiny"]
PLAIN = GaussianDecoderConfig(
    trunk=replace(TINY.decoder.trunk, sided=False, latent_channels=8), gaussians=GaussianConfig(count=4)
)
"""Voxels without sides, as TRELLIS has them."""
MIDDLE, WIDTH = 0.2, 0.4
"""Of a strip of surface within a voxel."""


def test_an_untrained_decoder_gives_the_biases_and_spreads_means_over_each_voxel():
    decoder = GaussianDecoder(PLAIN)
    coords = torch.tensor([[0, 0, 5, 31], [0, 7, 7, 7]])
    decoded = decoder(coords, torch.randn(2, 8))
    centers = ((coords[:, 1:] + 0.5) / 32 - 0.5).repeat_interleave(4, dim=0)
    offsets = (decoded.means - centers) * 32
    hammersley = torch.tensor(
        [[0, 0, 0], [1 / 4, 1 / 2, 1 / 3], [1 / 2, 1 / 4, 2 / 3], [3 / 4, 3 / 4, 1 / 9]]
    )
    torch.testing.assert_close(offsets, (hammersley - 0.5).repeat(2, 1), atol=1e-5, rtol=0)
    torch.testing.assert_close(decoded.scales, torch.full((8, 3), (4e-3**2 + 9e-4**2) ** 0.5))
    torch.testing.assert_close(decoded.opacities, torch.full((8,), 0.1))
    assert torch.equal(decoded.quats, torch.tensor([1.0, 0.0, 0.0, 0.0]).expand(8, 4))
    assert torch.equal(decoded.colors, torch.full((8, 3), 0.5))


def read_covariances(splats: Splats) -> torch.Tensor:
    """Of the Gaussians, in the grid's frame."""
    R = torch.from_numpy(matrix_from_quat(splats.quats.numpy())).float()
    return R @ torch.diag_embed(splats.scales**2) @ R.transpose(1, 2)


def side_features(width: int, generator: torch.Generator) -> torch.Tensor:
    """Features of 40 voxels: noise, every other one clear; of either side its colour and its height; surface
    that fills them, but for the last eight, where it is a strip."""
    sides = torch.zeros(40, 2, 4)
    across = torch.zeros(40, 4)
    across[32:] = torch.tensor([MIDDLE / MIDDLE_SPREAD, 0.0, math.log(WIDTH), 0.0])
    clear = (torch.arange(40) % 2)[:, None]
    sides[..., :3] = (torch.rand(40, 2, 3, generator=generator) - COLOR_MIDDLE) / COLOR_SPREAD
    sides[..., 3] = torch.atanh(torch.tensor([0.4, -0.2]) / 0.75)
    noise = torch.randn(40, width - SIDE_CHANNELS, generator=generator)
    return torch.cat([noise, clear, sides.flatten(1), across], dim=1)


@pytest.mark.parametrize("name", ["tiny", "small", "compact"])
def test_untrained_networks_put_flat_gaussians_of_the_right_colours_on_both_sides(
    name: str, generator: torch.Generator
):
    preset = APPEARANCE_PRESETS[name]
    edge = preset.encoder.resolution
    vae = AppearanceVae(preset.encoder, preset.decoder)
    coords = draw_voxels(generator, (40,), edge=edge)
    feats = side_features(preset.encoder.in_channels, generator)
    facings = torch.arange(40) % FACINGS
    made = vae(coords, feats, torch.zeros(40, SIDE_LATENTS), facings).splats
    outward = torch.tensor(facing_frames()).float()[facings][:, :, 0]
    centers = (coords[:, 1:] + 0.5) / edge - 0.5
    off = edge * (made.means.unflatten(0, (40, -1)) - centers[:, None])
    heights = torch.einsum("nkj,nj->nk", off, outward)
    colors = made.colors.unflatten(0, (40, -1))
    spread = read_covariances(made).unflatten(0, (40, -1))
    thickness = torch.einsum("ni,nkij,nj->nk", outward, spread, outward).sqrt()
    widest = torch.linalg.eigvalsh(spread)[..., -1].sqrt()
    assert (thickness[:32] < 0.35 * widest[:32]).all()
    half = vae.decoder.gaussians.count // 2
    for side, height, rows in ((0, 0.4, slice(0, half)), (1, -0.2, slice(half, None))):
        told = (
            feats[:, 1 - SIDE_CHANNELS : -4].unflatten(1, (2, 4))[:, side, :3] * COLOR_SPREAD + COLOR_MIDDLE
        )
        torch.testing.assert_close(colors[:, rows], told[:, None].expand_as(colors[:, rows]))
        torch.testing.assert_close(heights[:, rows], torch.full_like(heights[:, rows], height))
    opacities = made.opacities.unflatten(0, (40, -1))
    assert opacities[0::2].min() > 0.85
    assert opacities[1::2].max() < 0.03
    covered = off - heights[..., None] * outward[:, None]
    for rows in (slice(0, half), slice(half, None)):  # evenly over the face
        assert covered[:32, rows].mean(dim=1).abs().max() < 0.26
        assert covered[:32, rows].norm(dim=2).max() < 0.75
    along = torch.tensor(facing_frames()).float()[facings][:, :, 1]
    place = torch.einsum("nkj,nj->nk", covered, along)[32:]
    assert place.min() > MIDDLE - WIDTH / 2 - 0.02
    assert place.max() < MIDDLE + WIDTH / 2 + 0.02
    narrow = torch.einsum("ni,nkij,nj->nk", along, spread, along).sqrt()
    torch.testing.assert_close(narrow[32:], WIDTH * narrow[:8, :1].expand_as(narrow[32:]), rtol=0.2, atol=0.0)


def test_a_voxel_looks_the_same_in_the_frame_of_its_outer_side(generator: torch.Generator):
    decoder = redraw(GaussianDecoder(TINY.decoder), generator)
    coords = torch.tensor([[0, 15, 15, 15]])
    raw = torch.randn(1, decoder.out_layer.out_features, generator=generator)
    center = (coords[0, 1:] + 0.5) / 32 - 0.5
    seen = []
    for facing, frame in enumerate(torch.tensor(facing_frames()).float()):
        made = decoder.read(coords, raw, torch.tensor([facing]))
        spread = frame.T @ read_covariances(made) @ frame
        seen.append(torch.cat([(made.means - center) @ frame, spread.flatten(1), made.colors], dim=1))
        assert torch.linalg.det(frame) == pytest.approx(1.0)
    for other in seen[1:]:
        torch.testing.assert_close(other, seen[0], atol=1e-6, rtol=0)


def test_sides_need_facings_and_even_numbers(generator: torch.Generator):
    coords = draw_voxels(generator, (5,), edge=32)
    with pytest.raises(ValueError, match="facings of voxels are missing"):
        GaussianDecoder(TINY.decoder)(coords, torch.zeros(5, SIDE_LATENTS))
    with pytest.raises(ValueError, match="facings of voxels are given"):
        GaussianDecoder(PLAIN)(coords, torch.zeros(5, 8), facings=torch.zeros(5).long())
    with pytest.raises(ValueError, match="3 Gaussians for the two sides"):
        GaussianDecoder(replace(TINY.decoder, gaussians=GaussianConfig(count=3)))


def test_decoded_gaussians_become_values_with_the_part_of_their_voxel(generator: torch.Generator):
    decoder = redraw(GaussianDecoder(PLAIN), generator)
    coords = draw_voxels(generator, (20, 30), edge=32)
    decoded = decoder(coords, 50.0 * torch.randn(50, 8, generator=generator))
    second = coords[:, 0] == 1
    part_ids = np.arange(30) % 3
    out = to_gaussians(select_voxels(decoded, second), part_ids)
    assert out.part_ids.tolist() == np.repeat(part_ids, 4).tolist()
    centers = ((coords[second][:, 1:] + 0.5) / 32 - 0.5).numpy().repeat(4, axis=0)
    assert np.abs(out.means - centers).max() <= 0.75 / 32 + 1e-6
    shown = select_voxels(decoded, second).colors.clamp(max=1.0).numpy()
    np.testing.assert_allclose(srgb_from_linear(out.colors), shown, atol=1e-5)
    assert float(decoded.colors.max()) > 1
    with pytest.raises(ValueError, match="200 Gaussians for 30 voxels"):
        to_gaussians(decoded, part_ids)


def describe(count: int, generator: torch.Generator) -> torch.Tensor:
    """Attributes of voxels of all kinds: facing, label, covered sides, places, paint."""
    facing, label = (
        torch.eye(kinds)[torch.randint(kinds, (count,), generator=generator)]
        for kinds in (FACINGS, len(PART_LABELS))
    )
    near = torch.randint(2, (count, SIDES + AROUND), generator=generator).float()
    places = torch.randn(count, PLACES, generator=generator)
    return torch.cat([facing, label, near, places, torch.rand(count, PAINT, generator=generator)], dim=1)


def test_expectations_keep_their_digits_where_networks_are_trained_in_few(generator: torch.Generator):
    attributes = describe(100, generator)
    expectation = Expectation(3)
    expectation.weight.copy_(torch.randn(expectation.weight.shape, generator=generator))
    with torch.autocast("cpu", torch.bfloat16):
        few = expectation(attributes)
    assert torch.equal(few, expectation(attributes))


def test_which_of_two_colours_a_covered_side_has_is_expected(generator: torch.Generator):
    """Doors have their first colour outside, and inside the second where nothing stands before it."""
    attributes = describe(40_000, generator)
    first, second = attributes[:, -PAINT:-1].chunk(2, dim=1)
    door = attributes[:, FACINGS + PART_LABELS.index("door")] > 0
    turned = door & (attributes[:, FACINGS + len(PART_LABELS) + 1] == 0)
    latents = torch.cat([first, torch.where(turned[:, None], second, first)], dim=1)
    latents = latents + 0.1 * torch.randn(latents.shape, generator=generator)
    expectation = Expectation(6)
    halves = (slice(0, 15_000), slice(15_000, None))
    weight = fit_expectation(((attributes[half], latents[half]) for half in halves), 0.0)
    expectation.weight.copy_(weight)
    rest = latents - expectation(attributes)
    assert rest.std() == pytest.approx(0.1, rel=0.15)
    for some in (turned, door & ~turned, ~door):
        assert rest[some].mean().abs() < 0.02
    kinds = find_kinds(attributes)
    assert int(kinds.min()) >= 0
    assert len(kinds.unique()) == KINDS


def test_where_a_part_ends_and_its_surface_lies_is_expected_whatever_its_paint(generator: torch.Generator):
    attributes = describe(40_000, generator)
    sure = attributes[:, -AROUND - PLACES - PAINT : -PAINT]
    latents = sure @ torch.linspace(-0.2, 0.3, AROUND + PLACES)[:, None]
    expectation = Expectation(1)
    expectation.weight.copy_(fit_expectation([(attributes, latents)], 0.05))
    torch.testing.assert_close(expectation(attributes), latents, atol=0.01, rtol=0)


def test_a_kind_without_voxels_is_expected_to_be_like_all(generator: torch.Generator):
    attributes = describe(5_000, generator)
    known = attributes[:, FACINGS] == 0
    latents = attributes[:, -PAINT:-4]
    expectation = Expectation(3)
    expectation.weight.copy_(fit_expectation([(attributes[known], latents[known])], 0.0))
    torch.testing.assert_close(expectation(attributes[~known]), latents[~known], atol=0.01, rtol=0)


def test_one_step_goes_along_the_guided_velocity(generator: torch.Generator):
    flow = SlatFlow(TINY.flow, TINY.conditions)
    redraw(flow.network, generator)
    flow.latent_mean.fill_(3.0)
    flow.latent_std.fill_(2.0)
    assert flow.expectation is not None
    flow.expectation.weight.normal_(generator=generator)
    coords = draw_voxels(generator, (80, 30), edge=32)
    noise = torch.randn(110, SIDE_LATENTS, generator=generator)
    attributes = describe(110, generator)
    named = [StructureCondition(category=name) for name in ("Oven", "Table")]
    asked = gather_conditions(named, TINY.conditions)
    nothing = gather_conditions([StructureCondition()] * 2, TINY.conditions)
    plan, start = flow.network.plan(coords, 2), torch.ones(2)
    with_condition = flow(noise, start, asked, plan, attributes)
    without = flow(noise, start, nothing, plan, attributes)
    cfg = SamplerConfig(steps=1, strength=2.0)
    drawn = sample_slats(flow, coords, asked, nothing, noise, cfg, attributes=attributes)
    expected = 2.0 * (noise - (3.0 * with_condition - 2.0 * without)) + 3.0
    expected = expected + flow.expectation(attributes)
    assert not torch.allclose(with_condition, without, atol=0.01)
    torch.testing.assert_close(drawn, expected, atol=1e-3, rtol=1e-4)
    back = flow.normalise(flow.restore(noise, attributes), attributes)
    torch.testing.assert_close(back, noise, atol=1e-5, rtol=0)
    with pytest.raises(ValueError, match="0 attributes per voxel, expected 33"):
        sample_slats(flow, coords, asked, nothing, noise, cfg)


@pytest.mark.parametrize("name", ["small", "compact"])
def test_weights_to_ship_are_small_enough(name):
    preset = APPEARANCE_PRESETS[name]
    with torch.device("meta"):
        networks = [
            SlatEncoder(preset.encoder),
            GaussianDecoder(preset.decoder),
            SlatFlow(preset.flow, preset.conditions),
        ]
    assert 2 * sum(value.numel() for network in networks for value in network.state_dict().values()) < 11e6


def test_weights_come_back(tmp_path: Path, generator: torch.Generator):
    flow = redraw(SlatFlow(TINY.flow, TINY.conditions), generator)
    save_model(flow, tmp_path, {"preset": "tiny"}, "appearance_flow")
    again = load_model(SlatFlow(TINY.flow, TINY.conditions), tmp_path, "appearance_flow")
    for key, value in flow.state_dict().items():
        assert torch.equal(again.state_dict()[key], value.half().float()), key


def test_autoencoder_learns_the_colours_of_one_object(generator: torch.Generator):
    torch.manual_seed(0)
    encoder, decoder = SlatEncoder(replace(PLAIN.trunk, in_channels=16)), GaussianDecoder(PLAIN)
    coords = draw_voxels(generator, (150,), edge=32)
    colors = torch.rand(150, 3, generator=generator)
    feats = functional.pad(colors, (0, 13))
    plans = encoder.plan(coords)
    with torch.enable_grad():
        parameters = [*encoder.parameters(), *decoder.parameters()]
        optimizer = torch.optim.Adam(parameters, lr=3e-3)
        errors = []
        for _ in range(60):
            mean, _ = encoder(coords, feats, plans)
            said = decoder(coords, mean, plans).colors.reshape(150, 4, 3)
            loss = (said - colors[:, None]).abs().mean()
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            errors.append(loss.item())
    assert errors[-1] < 0.2 * errors[0]


@pytest.mark.slow
def test_compact_flow_learns_the_latents_of_two_objects(generator: torch.Generator):
    torch.manual_seed(0)
    flow = SlatFlow(TINY.flow, TINY.conditions)
    coords = draw_voxels(generator, (20, 20), edge=32)
    latents = torch.randn(40, SIDE_LATENTS, generator=generator)
    attributes = torch.randn(40, flow.attribute_channels, generator=generator)
    asked = gather_conditions([StructureCondition()] * 2, TINY.conditions)
    plan = flow.network.plan(coords, 2)
    with torch.enable_grad():
        optimizer = torch.optim.Adam(flow.parameters(), lr=5e-3)
        for _ in range(80):
            times, noise = draw_times(2, generator), torch.randn(40, SIDE_LATENTS, generator=generator)
            x = diffuse(latents, noise, times[coords[:, 0].long()])
            clean = x - times[coords[:, 0].long()][:, None] * flow(x, times, asked, plan, attributes)
            optimizer.zero_grad()
            ((clean - latents) ** 2).mean().backward()
            optimizer.step()
    noise = torch.randn(40, SIDE_LATENTS, generator=generator)
    cfg = SamplerConfig(steps=6, strength=0.0)
    drawn = sample_slats(flow, coords, asked, asked, noise, cfg, attributes=attributes)
    assert float((drawn - latents).abs().mean()) < 0.2
