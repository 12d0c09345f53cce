"""Both sides of the limits that networks share, and the sizes of the public ones."""

import pytest
import torch
from transformers import (
    Dinov2WithRegistersConfig,
    Dinov2WithRegistersModel,
)

from artigen.models.attention import plain_norm
from artigen.models.conditions import ConditionConfig, StructureCondition, gather_conditions
from artigen.models.embeddings import TimestepEmbedder, embed_times
from artigen.models.public_encoders import DinoConfig, DinoV2
from artigen.models.rectified_flow import diffuse, target_velocity


def test_a_norm_takes_a_variance_of_a_millionth_for_twice_that():
    x = torch.tensor([1e-3, -1e-3])
    torch.testing.assert_close(plain_norm(x), x / 2e-6**0.5)


def test_counts_from_24_on_are_one():
    asked = [StructureCondition(counts=(("drawer", count),)) for count in (22, 23, 24, 25, 100)]
    counts = gather_conditions(asked, ConditionConfig(image_size=0)).counts.amax(dim=1)
    assert counts.tolist() == [22, 23, 24, 24, 24]


def test_the_public_vision_transformer_is_the_large_one():
    """37 x 37 patches of 14 pixels, a class token and four registers."""
    cfg = DinoConfig()
    assert cfg.edge * cfg.patch == 518
    assert cfg.length == 1374
    with torch.device("meta"):
        network = Dinov2WithRegistersModel(
            Dinov2WithRegistersConfig(
                hidden_size=1024, num_hidden_layers=24, num_attention_heads=16, image_size=518, patch_size=14
            )
        )
        tokens = DinoV2(network, cfg).tokens(torch.zeros(1, 3, 518, 518))
    assert tokens.shape == (1, cfg.length, cfg.width)
    assert sum(value.numel() for value in network.parameters()) == 304_372_736


def test_a_time_has_128_frequencies_from_one_to_nearly_a_ten_thousandth():
    (waves,) = embed_times(torch.ones(1))
    assert len(waves) == 256
    rates = 10000.0 ** (-torch.arange(128) / 128)
    torch.testing.assert_close(waves, torch.cat([rates.cos(), rates.sin()]))
    assert TimestepEmbedder(8)(torch.ones(1)).shape == (1, 8)


def test_a_hundred_thousandth_of_the_noise_is_left_at_the_end_of_the_path():
    data, noise = torch.zeros(1, 1, dtype=torch.float64), torch.ones(1, 1, dtype=torch.float64)
    assert float(diffuse(data, noise, torch.zeros(1))) == pytest.approx(1e-5)
    assert 1.0 - float(target_velocity(data, noise)) == pytest.approx(1e-5)
