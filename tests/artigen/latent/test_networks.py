"""The compact structure networks: what goes in, what comes out, and what must not matter."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from artigen.errors import SourceError
from artigen.latent.conv_vae import ConvVaeConfig
from artigen.latent.latent_dit import EARLIEST, SETTLED, velocity_of, weigh_times
from artigen.latent.outline import gather_outlines
from artigen.latent.patches import PackedField, PatchBatch, collate, fold, pack_asset, patch_centers, unfold
from artigen.latent.presets import PRESETS
from artigen.latent.structure_dit import StructureDitConfig
from artigen.latent.structure_flow import StructureFlow, sample_latents
from artigen.latent.structure_vae import StructureVae, decode_cells
from artigen.models.conditions import (
    ConditionConfig,
    ConditionEncoder,
    StructureCondition,
    drop_conditions,
    gather_conditions,
    isolate_pictures,
)
from artigen.models.rectified_flow import SamplerConfig, diffuse, target_velocity
from artigen.models.store import load_model, save_model
from artigen.train.structure_losses import PAPER_LOSS, StructureLossConfig, dice_loss, structure_losses
from artigen.types import Asset
from artigen.voxels.fields import FIELD, ROW, encode
from artigen.voxels.voxelize import voxelize

TINY = PRESETS["tiny"]
BIG = 40.0
"""A logit that leaves no doubt."""


@pytest.fixture(scope="module")
def small(cabinet: Asset) -> Asset:
    assert cabinet.surface is not None
    return replace(cabinet, voxels=voxelize(cabinet.surface, TINY.resolution))


@pytest.fixture(scope="module")
def packed(small: Asset) -> PackedField:
    return pack_asset(small)


@pytest.fixture(scope="module")
def patches(packed: PackedField) -> PatchBatch:
    return collate([packed, packed])


def perfect(patches: PatchBatch) -> tuple[torch.Tensor, torch.Tensor]:
    """Logits and attributes that say exactly the truth."""
    attributes = patches.attributes().clone()
    for classes in (FIELD.label, FIELD.joint_type, FIELD.category):
        attributes[..., classes.start - 1 : classes.stop - 1] *= BIG
    return BIG * (2.0 * patches.occupancy().flatten(0, 1) - 1.0), attributes


def test_unfolded_patches_are_the_encoded_field(small: Asset, patches: PatchBatch):
    dense = unfold(patches)
    assert torch.equal(dense[0], dense[1])
    assert torch.equal(dense[1], torch.from_numpy(encode(small)))
    assert torch.equal(fold(dense)[..., 0], patches.occupancy())


def test_patch_centers_are_the_means_of_their_cells(small: Asset, packed: PackedField):
    assert small.voxels is not None
    edge = TINY.resolution // 4
    inside = np.abs(
        small.voxels.centers()[:, None] - patch_centers(torch.from_numpy(packed.index), edge).numpy()
    ).max(axis=2)
    assert (inside.min(axis=1) < 0.5 / edge).all()


def test_a_perfect_reconstruction_costs_nothing_and_reads_back(small: Asset, patches: PatchBatch):
    logits, attributes = perfect(patches)
    for cfg in (StructureLossConfig(), PAPER_LOSS):
        terms = structure_losses(logits, attributes, patches, cfg)
        assert all(float(term) < 1e-4 for term in terms.values()), terms

    class Oracle(StructureVae):
        def decode(self, z, index=None, outlines=None, steady=None):
            return logits, attributes, patches.index

    oracle = Oracle(TINY.vae)
    fields = decode_cells(oracle, torch.zeros(2, 1, 1, 1, 1))[0][1]
    from artigen.voxels.fields import decode

    truth = decode(encode(small))
    assert np.array_equal(fields.coords, truth.coords)
    for name in ("label_probs", "joint_probs", "axis", "origin", "ranges", "box"):
        np.testing.assert_allclose(getattr(fields, name), getattr(truth, name), atol=1e-5)


@pytest.mark.parametrize("name", ["axis", "origin", "range", "box", "label", "joint_type", "category"])
def test_each_mistake_costs_in_its_own_term_only(patches: PatchBatch, name: str):
    logits, attributes = perfect(patches)
    chosen, wrong = getattr(ROW, name), attributes.clone()
    wrong[..., chosen] = wrong[..., chosen].roll(1, dims=-1) + 0.1
    terms = structure_losses(logits, wrong, patches, StructureLossConfig())
    assert float(terms[name]) > 1e-3
    assert all(float(term) < 1e-4 for other, term in terms.items() if other != name)


def test_dice_is_one_minus_the_overlap():
    said = torch.tensor([[1.0, 1.0, 0.0, 0.0]])
    truth = torch.tensor([[1.0, 0.0, 1.0, 0.0]])
    assert float(dice_loss(said, truth, torch.ones(1, 4))) == pytest.approx(1 - 3 / 5)


@pytest.mark.slow
@pytest.mark.parametrize(
    "cfg", [TINY.vae, ConvVaeConfig(channels=(4, 8, 8), res_blocks=1, middle_blocks=1)], ids=["patch", "conv"]
)
def test_both_vaes_have_one_interface_and_learn(patches: PatchBatch, packed: PackedField, cfg):
    torch.manual_seed(0)
    vae = StructureVae(cfg)
    mean, logvar = vae.encode(patches)
    edge = TINY.resolution // 4
    assert mean.shape == logvar.shape == (2, 8, edge, edge, edge)
    torch.testing.assert_close(mean[0], mean[1])
    optimizer = torch.optim.Adam(vae.parameters(), lr=3e-3)
    seen = []
    for _ in range(12):
        made = vae(patches, torch.zeros_like(mean), outlines=gather_outlines([packed.table] * 2))
        loss = torch.stack(
            list(structure_losses(made.logits, made.attributes, patches, StructureLossConfig()).values())
        ).sum()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        seen.append(float(loss.detach()))
    assert seen[-1] < 0.7 * seen[0]


def test_order_of_objects_in_a_batch_does_not_matter(packed: PackedField):
    torch.manual_seed(0)
    vae = StructureVae(TINY.vae)
    fewer = replace(packed, index=packed.index[5:], rows=packed.rows[5:])
    with torch.no_grad():
        one, two = (vae.encode(collate(pair))[0] for pair in ([packed, fewer], [fewer, packed]))
    torch.testing.assert_close(one, two.flip(0), atol=1e-5, rtol=1e-5)


def test_a_velocity_from_the_clean_latent_is_the_path_s():
    x_0, noise = torch.randn(2, 8, 4, 4, 4), torch.randn(2, 8, 4, 4, 4)
    times = torch.tensor([0.3, 0.9])
    said = velocity_of(diffuse(x_0, noise, times), x_0, times)
    torch.testing.assert_close(said, target_velocity(x_0, noise), atol=2e-4, rtol=1e-4)
    early = torch.full((2,), EARLIEST / 10)
    assert torch.isfinite(velocity_of(noise, x_0, 0.0 * early)).all()


def make_flow() -> StructureFlow:
    torch.manual_seed(0)
    flow = StructureFlow(TINY.flow, TINY.conditions).eval()
    for parameter in flow.parameters():  # what starts at zero would hide what it is multiplied with
        if not parameter.any():
            torch.nn.init.normal_(parameter, std=0.1)
    return flow


def test_late_errors_count_as_errors_of_the_velocity_and_early_ones_as_errors_of_the_clean_latent():
    """A guess that is off by one costs the same at every time before `SETTLED`."""
    x, clean = torch.randn(5, 2, 4, 4, 4), torch.randn(5, 2, 4, 4, 4)
    times = torch.tensor([EARLIEST, 0.1, 0.3, SETTLED, 1.0])
    off = velocity_of(x, clean + 1.0, times) - velocity_of(x, clean, times)
    cost = weigh_times(times) * (off**2).mean(dim=(1, 2, 3, 4))
    assert torch.allclose(cost, torch.tensor([1 / SETTLED**2] * 4 + [1.0]), rtol=1e-4)
    tiny = StructureFlow(TINY.flow, TINY.conditions)
    narrow = StructureDitConfig(model_channels=64, cond_channels=64, num_blocks=1, num_heads=2)
    paper = StructureFlow(narrow, TINY.conditions)
    assert torch.equal(tiny.weights(times), weigh_times(times))
    assert torch.equal(paper.weights(times), torch.ones(5))


def test_latents_are_normalised_and_restored():
    flow = make_flow()
    flow.latent_mean.copy_(torch.linspace(-1, 1, 8))
    flow.latent_std.copy_(torch.linspace(1, 3, 8))
    z = torch.randn(2, 8, 4, 4, 4)
    torch.testing.assert_close(flow.restore(flow.normalise(z)), z)


def test_a_sample_depends_on_noise_and_condition_and_on_nothing_else():
    flow, cfg = make_flow(), TINY.conditions
    asked = gather_conditions(
        [StructureCondition(category="Oven"), StructureCondition(category="Table")], cfg
    )
    nothing = gather_conditions([StructureCondition()] * 2, cfg)
    noise = torch.randn(1, 8, 8, 8, 8).repeat(2, 1, 1, 1, 1)
    sampler = SamplerConfig(steps=3, strength=2.0)
    both = sample_latents(flow, asked, nothing, noise, sampler)
    assert not torch.allclose(both[0], both[1], atol=1e-3)
    alone = sample_latents(
        flow,
        gather_conditions([StructureCondition(category="Table")], cfg),
        gather_conditions([StructureCondition()], cfg),
        noise[:1],
        sampler,
    )
    torch.testing.assert_close(alone[0], both[1], atol=1e-4, rtol=1e-4)


def test_open_fields_do_not_look_at_their_values():
    cfg = ConditionConfig(width=32, image_size=16, image_patch=8, image_width=32, image_blocks=1)
    encoder = ConditionEncoder(cfg).eval()
    picture = np.random.default_rng(0).random((4, 16, 16)).astype(np.float32)
    full = StructureCondition(
        category="Oven", counts=(("door", 1), ("knob", 30)), size=(0.6, 0.6, 0.9), image=picture
    )
    batch = gather_conditions([full], cfg)
    dropped = drop_conditions(batch, 1.0, torch.Generator())
    kept = drop_conditions(batch, 0.0, torch.Generator())
    nothing = gather_conditions([StructureCondition()], cfg)
    assert torch.equal(encoder(dropped), encoder(nothing))
    assert torch.equal(encoder(kept), encoder(batch))
    assert not torch.allclose(encoder(batch), encoder(nothing), atol=1e-3)


def test_pictures_stand_alone_as_often_as_asked_for():
    cfg = ConditionConfig(width=32, image_size=16, image_patch=8, image_width=32, image_blocks=1)
    picture = np.zeros((4, 16, 16), dtype=np.float32)
    said = {"category": "Oven", "counts": (("door", 1),), "size": (0.6, 0.6, 0.9)}
    pictured, plain = StructureCondition(**said, image=picture), StructureCondition(**said)
    batch = gather_conditions([pictured, plain] * 500, cfg)
    isolated = isolate_pictures(batch, 0.25, torch.Generator().manual_seed(0))
    alone = (isolated.category < 0) & (isolated.counts < 0).all(dim=1) & ~isolated.has_size
    assert not alone[1::2].any()
    assert 0.2 < float(alone[::2].float().mean()) < 0.3
    assert torch.equal(isolated.category[~alone], batch.category[~alone])
    assert torch.equal(isolated.has_image, batch.has_image)


def test_wrong_conditions_are_refused():
    with pytest.raises(ValueError, match="'Sofa' is not one of"):
        gather_conditions([StructureCondition(category="Sofa")], TINY.conditions)
    with pytest.raises(ValueError, match="-1 parts called door"):
        gather_conditions([StructureCondition(counts=(("door", -1),))], TINY.conditions)


def test_the_shipped_size_fits_its_limit():
    preset = PRESETS["compact"]
    with torch.device("meta"):
        networks = [StructureVae(preset.vae), StructureFlow(preset.flow, preset.conditions)]
    assert 2 * sum(value.numel() for network in networks for value in network.state_dict().values()) < 40e6


def test_models_are_stored_and_loaded(tmp_path: Path):
    flow = make_flow()
    save_model(flow, tmp_path, {"preset": "tiny"}, "flow")
    again = load_model(StructureFlow(TINY.flow, TINY.conditions), tmp_path, "flow")
    for key, value in flow.state_dict().items():
        torch.testing.assert_close(again.state_dict()[key], value, atol=1e-3, rtol=1e-3)
    (tmp_path / "flow-0.safetensors").write_bytes(b"\0" * 100)
    with pytest.raises(SourceError, match="no complete safetensors file"):
        load_model(flow, tmp_path, "flow")
    with pytest.raises(SourceError, match=r"holds no vae-\*"):
        load_model(flow, tmp_path, "vae")
