"""Looks of true voxels on drawn ones: the same where these are true, those of the nearest elsewhere."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from drawer_chest import make_chest, make_example

from artigen.appearance.slat_flow import SlatFlow
from artigen.appearance.slat_patch_dit import SlatPatchDitConfig
from artigen.examples.appearance import AppearanceExample
from artigen.models.conditions import ConditionConfig
from artigen.train.appearance.drawn import DrawnVoxels, read_drawn_shard, roughen, write_drawn_shard
from artigen.train.appearance.flow import find_models, measure_slats, redraw_slats, transfer_looks
from artigen.types import Asset

CHANNELS = 5


@pytest.fixture(scope="module")
def chest() -> tuple[Asset, AppearanceExample]:
    return make_example(make_chest(), sided=True)


def rough(asset: Asset, example: AppearanceExample, seed: int = 0) -> DrawnVoxels:
    assert asset.voxels is not None
    return roughen(asset.voxels, example.facings.astype(int), np.random.default_rng(seed))


def make_flow(example: AppearanceExample, mean: torch.Tensor, std: torch.Tensor) -> SlatFlow:
    """Knows what to expect of the example's voxels."""
    cfg = SlatPatchDitConfig(channels=CHANNELS, resolution=16, stem=8, width=32, blocks=1, heads=2)
    flow = SlatFlow(cfg, ConditionConfig(width=32, image_size=0))
    measured = measure_slats([mean], [std], [example.attributes()])
    flow.latent_mean.copy_(measured.mean)
    flow.latent_std.copy_(measured.std)
    assert flow.expectation is not None
    flow.expectation.weight.copy_(measured.expected)
    return flow


def test_what_is_kept_looks_as_it_did(chest: tuple[Asset, AppearanceExample]):
    asset, example = chest
    assert asset.voxels is not None
    every = np.arange(len(example.coords))
    kept = DrawnVoxels(
        coords=asset.voxels.coords,
        part_ids=asset.voxels.part_ids.astype(int),
        facings=example.facings.astype(int),
        rows=every,
        like=every,
    )
    models, sure = find_models(example, kept)
    assert sure.all()
    other = transfer_looks(example, kept, models)
    np.testing.assert_array_equal(other.attributes(), example.attributes())
    torch.manual_seed(0)
    mean, std = torch.randn(len(sure), CHANNELS), torch.rand(len(sure), CHANNELS)
    flow = make_flow(example, mean, std)
    _, again, deviation = redraw_slats(flow, example, (mean, std), kept)
    torch.testing.assert_close(again, mean, atol=1e-4, rtol=0)
    assert torch.equal(deviation, std)


def test_strays_look_as_the_nearest_of_their_part_and_are_as_expected(
    chest: tuple[Asset, AppearanceExample],
):
    asset, example = chest
    drawn = rough(asset, example)
    lost = np.arange(0, len(drawn.rows), 7)
    drawn = replace(drawn, rows=np.delete(drawn.rows, lost), like=np.delete(drawn.like, lost))
    models, sure = find_models(example, drawn)
    assert np.flatnonzero(~sure).tolist() == lost.tolist()
    assert (models[drawn.rows] == drawn.like).all()
    assert (example.part_ids[models] == drawn.part_ids).all()
    cells = example.coords.astype(int)
    for row in lost:
        apart = np.abs(cells - drawn.coords[row])[example.part_ids == drawn.part_ids[row]]
        nearest = (apart**2).sum(axis=1).min()
        assert ((cells[models[row]] - drawn.coords[row]) ** 2).sum() == nearest
    other = transfer_looks(example, drawn, models)
    np.testing.assert_array_equal(other.coords, drawn.coords)
    np.testing.assert_array_equal(other.paint, example.paint[models])
    np.testing.assert_array_equal(other.places(), example.places()[models])
    torch.manual_seed(1)
    mean, std = torch.randn(len(cells), CHANNELS), torch.rand(len(cells), CHANNELS)
    flow = make_flow(example, mean, std)
    _, latents, _ = redraw_slats(flow, example, (mean, std), drawn)
    off = flow.normalise(latents, torch.from_numpy(other.attributes()))
    true = flow.normalise(mean, torch.from_numpy(example.attributes()))
    torch.testing.assert_close(off[lost], torch.zeros(len(lost), CHANNELS), atol=1e-4, rtol=0)
    torch.testing.assert_close(off[drawn.rows], true[drawn.like], atol=1e-4, rtol=0)


def test_shards_give_back_what_was_written(chest: tuple[Asset, AppearanceExample], tmp_path: Path):
    drawn = [rough(*chest, seed=seed) for seed in range(3)]
    write_drawn_shard(tmp_path / "shard.npz", drawn)
    for one, again in zip(drawn, read_drawn_shard(tmp_path / "shard.npz"), strict=True):
        for name, value in vars(one).items():
            np.testing.assert_array_equal(getattr(again, name), value)
