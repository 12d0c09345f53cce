"""The laws of sparse layers and networks: windows, neighbours, order, batches."""

from dataclasses import replace

import pytest
import torch
from sparse_voxels import draw_voxels, redraw
from torch.nn import functional

from artigen.appearance.gaussian_decoder import GaussianDecoder
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.appearance.slat_dit import SlatDit, SlatDitConfig
from artigen.appearance.slat_flow import SlatFlow
from artigen.appearance.slat_vae import SlatEncoder
from artigen.appearance.sparse import coarsen, find_neighbours, merge_features, plan_padding, split_features
from artigen.appearance.sparse_conv import SparseConv3d, SparseResBlock3d
from artigen.appearance.windows import attend_windows, plan_windows
from artigen.voxels.frames import FACINGS

SMALL = SlatDitConfig(
    resolution=16, model_channels=32, cond_channels=24, num_blocks=2, num_heads=2, io_block_channels=(8, 16)
)
TINY = APPEARANCE_PRESETS["tiny"]


@pytest.mark.parametrize(("window", "shift"), [(4, 0), (4, 2), (8, 4), (16, 0)])
def test_window_attention_is_dense_attention_under_a_mask(
    window: int, shift: int, generator: torch.Generator
):
    coords = draw_voxels(generator, (700, 9, 90))
    qkv = torch.randn(len(coords), 3, 2, 8, generator=generator)
    places = torch.cat([coords[:, :1], (coords[:, 1:] + shift) // window], dim=1)
    together = (places[:, None] == places[None]).all(dim=2)
    q, k, v = qkv.permute(1, 2, 0, 3)
    dense = functional.scaled_dot_product_attention(q, k, v, attn_mask=together)
    said = attend_windows(qkv, plan_windows(coords, window, shift))
    torch.testing.assert_close(said, dense.transpose(0, 1).flatten(1), atol=2e-6, rtol=1e-5)


def test_sparse_convolution_and_its_gradients_are_the_dense_ones_at_active_sites(
    generator: torch.Generator,
):
    coords = draw_voxels(generator, (60, 25), edge=6)
    conv = redraw(SparseConv3d(3, 5), generator)
    feats = torch.randn(len(coords), 3, generator=generator)
    wanted = torch.randn(len(coords), 5, generator=generator)
    at = tuple(coords.long().T)

    def dense(given: torch.Tensor) -> torch.Tensor:
        volume = torch.zeros(2, 6, 6, 6, 3).index_put(at, given).movedim(-1, 1)
        weight = conv.conv.weight.permute(0, 4, 1, 2, 3)
        return functional.conv3d(volume, weight, conv.conv.bias, padding=1).movedim(1, -1)[at]

    neighbours = find_neighbours(coords)
    results = []
    with torch.enable_grad():
        for answer in (dense, lambda given: conv(given, neighbours)):
            given = feats.clone().requires_grad_()
            said = answer(given)
            leaves = (given, conv.conv.weight, conv.conv.bias)
            results.append((said, *torch.autograd.grad((said * wanted).sum(), leaves)))
    for theirs, ours in zip(*results, strict=True):
        torch.testing.assert_close(ours, theirs, atol=2e-5, rtol=1e-4)


def test_a_parent_holds_the_sum_of_its_children_over_their_number_and_one():
    coords = torch.tensor([[0, 2, 2, 3], [0, 0, 0, 0], [0, 3, 3, 2]])
    parents = coarsen(coords, 2)
    assert parents.coords.tolist() == [[0, 0, 0, 0], [0, 1, 1, 1]]
    merged = merge_features(torch.tensor([[3.0], [5.0], [6.0]]), parents)
    assert merged.tolist() == [[2.5], [3.0]]
    assert split_features(merged, parents).tolist() == [[3.0], [2.5], [3.0]]


def test_padding_there_and_back_is_the_identity(generator: torch.Generator):
    samples = draw_voxels(generator, (5, 17, 17))[:, 0]
    feats = torch.randn(len(samples), 3, generator=generator)
    padding = plan_padding(samples)
    tokens = padding.pad(feats)
    assert tokens.shape == (3, 17, 3)
    assert padding.mask is not None
    assert padding.mask.sum(dim=(1, 2, 3)).tolist() == [5, 17, 17]
    assert torch.equal(padding.unpad(tokens), feats)
    assert plan_padding(samples[samples != 0] - 1).mask is None


def answer_all(coords: torch.Tensor, feats: torch.Tensor, batch: list[int]) -> dict[str, torch.Tensor]:
    """What every sparse network says about the samples of a batch, with the same weights on each call."""
    generator = torch.Generator().manual_seed(1)
    times = torch.tensor([0.9, 0.2, 0.5])[batch]
    small, wide = (torch.randn(3, 5, width, generator=generator)[batch] for width in (24, 64))
    trunk = replace(TINY.encoder, resolution=16, in_channels=8, latent_channels=8, window_size=4, sided=True)
    encoder = redraw(SlatEncoder(trunk), generator)
    decoder = redraw(GaussianDecoder(replace(TINY.decoder, trunk=trunk)), generator)
    dit = redraw(SlatDit(SMALL), generator)
    assert not isinstance(TINY.flow, SlatDitConfig)
    flow = SlatFlow(replace(TINY.flow, channels=8, resolution=16, attribute_channels=0), TINY.conditions)
    redraw(flow.network, generator)
    facings = coords[:, 1:].long().sum(dim=1) % FACINGS
    decoded = decoder(coords, feats, facings=facings)
    per_voxel = {name: value.reshape(len(coords), -1) for name, value in vars(decoded).items()}
    return per_voxel | {
        "latents": torch.cat(encoder(coords, feats, facings=facings), dim=1),
        "paper": dit(feats, 1000.0 * times, dit.plan(coords, len(batch)), small),
        "compact": flow.velocity(feats, times, wide, flow.network.plan(coords, len(batch))),
    }


def test_the_order_of_voxels_does_not_matter(generator: torch.Generator):
    coords = draw_voxels(generator, (300, 40, 7))
    feats = torch.randn(len(coords), 8, generator=generator)
    shuffled = torch.randperm(len(coords), generator=generator)
    plain = answer_all(coords, feats, [0, 1, 2])
    moved = answer_all(coords[shuffled], feats[shuffled], [0, 1, 2])
    for name, value in plain.items():
        assert value.std() > 1e-3, name
        torch.testing.assert_close(moved[name], value[shuffled], atol=5e-5, rtol=1e-4)


@pytest.mark.parametrize("sample", [0, 2])
def test_samples_of_a_batch_do_not_see_each_other(sample: int, generator: torch.Generator):
    coords = draw_voxels(generator, (300, 40, 7))
    feats = torch.randn(len(coords), 8, generator=generator)
    mine = coords[:, 0] == sample
    together = answer_all(coords, feats, [0, 1, 2])
    alone = answer_all(coords[mine] * torch.tensor([0, 1, 1, 1], dtype=torch.int32), feats[mine], [sample])
    for name, value in alone.items():
        torch.testing.assert_close(value, together[name][mine], atol=5e-5, rtol=1e-4)


def test_networks_start_quietly(generator: torch.Generator):
    coords = draw_voxels(generator, (50,))
    feats = torch.randn(50, 8, generator=generator)
    flow = SlatDit(SMALL)
    said = flow(feats, torch.tensor([500.0]), flow.plan(coords, 1), torch.randn(1, 3, 24))
    assert torch.count_nonzero(said) == 0
    block = SparseResBlock3d(8, 8, 4)
    assert torch.equal(block(feats, torch.randn(1, 4), coords[:, 0], find_neighbours(coords)), feats)


@pytest.mark.parametrize(
    ("coords", "samples", "message"),
    [
        ([[0, 1, 2, 16]], 1, "inside of 16"),
        ([[0, 1, 2, 3], [0, 1, 2, 3]], 1, "twice"),
        ([[0, 1, 2, 3], [2, 1, 2, 3]], 3, r"\[1, 0, 1\]"),
        ([[0, 1, 2, 3]], 2, r"\[1\]"),
    ],
)
def test_voxels_that_no_network_can_answer_for_are_refused(
    coords: list[list[int]], samples: int, message: str
):
    with pytest.raises(ValueError, match=message):
        SlatDit(SMALL).plan(torch.tensor(coords), samples)
