"""Gaussians and latents of the appearance networks: parametrisation, sampling, size, learning."""

from pathlib import Path

import numpy as np
import pytest
import torch
from sparse_voxels import draw_voxels, redraw
from torch.nn import functional

from artigen.models.appearance_presets import APPEARANCE_PRESETS
from artigen.models.appearance_vae import AppearanceVae
from artigen.models.conditions import StructureCondition, gather_conditions
from artigen.models.gaussian_decoder import GaussianDecoder, select_voxels, to_gaussians
from artigen.models.palette_flow import PaletteFlow
from artigen.models.slat_flow import SlatFlow, sample_slats
from artigen.models.slat_vae import SlatEncoder
from artigen.models.store import load_model, save_model
from artigen.sampling import SamplerConfig, diffuse, draw_times
from artigen.splats.colors import srgb_from_linear

TINY = APPEARANCE_PRESETS["tiny"]


@pytest.fixture(autouse=True)
def no_gradients():
    with torch.no_grad():
        yield


@pytest.fixture
def generator() -> torch.Generator:
    return torch.Generator().manual_seed(0)


def test_an_untrained_decoder_gives_the_biases_and_spreads_means_over_each_voxel():
    decoder = GaussianDecoder(APPEARANCE_PRESETS["tiny"].decoder)
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


def test_untrained_networks_with_a_way_around_give_each_gaussian_its_voxels_colour(
    generator: torch.Generator,
):
    small = APPEARANCE_PRESETS["small"]
    vae = AppearanceVae(small.encoder, small.decoder)
    coords = draw_voxels(generator, (40,), edge=64)
    feats = torch.randn(40, small.encoder.in_channels, generator=generator).clamp(-1.5, 1.5)
    made = vae(coords, feats, torch.zeros(40, 8)).splats.colors.unflatten(0, (40, -1))
    torch.testing.assert_close(made, (0.5 + 0.25 * feats[:, None, :3]).expand_as(made))


def test_decoded_gaussians_become_values_with_the_part_of_their_voxel(generator: torch.Generator):
    decoder = redraw(GaussianDecoder(TINY.decoder), generator)
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


def test_one_step_goes_along_the_guided_velocity(generator: torch.Generator):
    flow = SlatFlow(TINY.flow, TINY.conditions)
    redraw(flow.network, generator)
    flow.latent_mean.fill_(3.0)
    flow.latent_std.fill_(2.0)
    flow.latent_slope.normal_(generator=generator)
    coords = draw_voxels(generator, (80, 30), edge=32)
    noise = torch.randn(110, 8, generator=generator)
    attributes = torch.randn(110, flow.attribute_channels, generator=generator)
    named = [StructureCondition(category=name) for name in ("Oven", "Table")]
    asked = gather_conditions(named, TINY.conditions)
    nothing = gather_conditions([StructureCondition()] * 2, TINY.conditions)
    plan, start = flow.plan(coords, 2), torch.ones(2)
    with_condition = flow(noise, start, asked, plan, attributes)
    without = flow(noise, start, nothing, plan, attributes)
    cfg = SamplerConfig(steps=1, strength=2.0)
    drawn = sample_slats(flow, coords, asked, nothing, noise, cfg, attributes=attributes)
    expected = 2.0 * (noise - (3.0 * with_condition - 2.0 * without)) + 3.0 + attributes @ flow.latent_slope
    assert not torch.allclose(with_condition, without, atol=0.01)
    torch.testing.assert_close(drawn, expected, atol=1e-3, rtol=1e-4)
    back = flow.normalise(flow.restore(noise, attributes), attributes)
    torch.testing.assert_close(back, noise, atol=1e-5, rtol=0)
    with pytest.raises(ValueError, match="0 attributes per voxel, expected 15"):
        sample_slats(flow, coords, asked, nothing, noise, cfg)


@pytest.mark.parametrize("name", ["small", "compact"])
def test_weights_to_ship_are_small_enough(name):
    preset = APPEARANCE_PRESETS[name]
    assert preset.palette is not None
    with torch.device("meta"):
        networks = [
            SlatEncoder(preset.encoder),
            GaussianDecoder(preset.decoder),
            SlatFlow(preset.flow, preset.conditions),
            PaletteFlow(preset.palette, preset.conditions),
        ]
    assert 2 * sum(value.numel() for network in networks for value in network.state_dict().values()) < 16e6


def test_weights_come_back(tmp_path: Path, generator: torch.Generator):
    flow = redraw(SlatFlow(TINY.flow, TINY.conditions), generator)
    save_model(flow, tmp_path, {"preset": "tiny"}, "appearance_flow")
    again = load_model(SlatFlow(TINY.flow, TINY.conditions), tmp_path, "appearance_flow")
    for key, value in flow.state_dict().items():
        assert torch.equal(again.state_dict()[key], value.half().float()), key


def test_autoencoder_learns_the_colours_of_one_object(generator: torch.Generator):
    torch.manual_seed(0)
    encoder, decoder = SlatEncoder(TINY.encoder), GaussianDecoder(TINY.decoder)
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


def test_compact_flow_learns_the_latents_of_two_objects(generator: torch.Generator):
    torch.manual_seed(0)
    flow = SlatFlow(TINY.flow, TINY.conditions)
    coords = draw_voxels(generator, (60, 60), edge=32)
    latents = torch.randn(120, 8, generator=generator)
    attributes = torch.randn(120, flow.attribute_channels, generator=generator)
    asked = gather_conditions([StructureCondition()] * 2, TINY.conditions)
    plan = flow.plan(coords, 2)
    with torch.enable_grad():
        optimizer = torch.optim.Adam(flow.parameters(), lr=2e-3)
        for _ in range(80):
            times, noise = draw_times(2, generator), torch.randn(120, 8, generator=generator)
            x = diffuse(latents, noise, times[coords[:, 0].long()])
            clean = flow.network(x, times, plan, flow.conditions(asked), attributes)
            optimizer.zero_grad()
            ((clean - latents) ** 2).mean().backward()
            optimizer.step()
    noise = torch.randn(120, 8, generator=generator)
    cfg = SamplerConfig(steps=6, strength=0.0)
    drawn = sample_slats(flow, coords, asked, asked, noise, cfg, attributes=attributes)
    assert float((drawn - latents).abs().mean()) < 0.3
