"""The structured-latent networks against what TRELLIS' own classes computed."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from safetensors.torch import load_file, save_file
from sparse_voxels import redraw

from artigen.appearance.gaussian_decoder import GaussianDecoder, select_voxels, spread_offsets
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.appearance.slat_dit import SlatDit, SlatDitConfig
from artigen.appearance.slat_vae import SlatEncoder, SlatVaeConfig, WindowBlock
from artigen.appearance.sparse import coarsen, find_neighbours, merge_features, split_features
from artigen.appearance.sparse_conv import SparseConv3d, SparseResBlock3d
from artigen.appearance.windows import group_windows, plan_windows
from artigen.errors import SourceError
from artigen.latent.volumes import sample_gaussian
from artigen.models.rectified_flow import (
    SamplerConfig,
    diffuse,
    is_guided,
    plan_times,
    sample_flow,
    target_velocity,
)
from artigen.models.tensors import load_strictly
from artigen.trellis.checkpoints import build_trellis, load_trellis

FULL_SIZE = ("slat_enc_swin8_B_64l8", "slat_dec_gs_swin8_B_64l8gs32", "slat_flow_img_dit_L_64l8p2")
SMALL = SlatDitConfig(
    resolution=16, model_channels=32, cond_channels=24, num_blocks=2, num_heads=2, io_block_channels=(8, 16)
)
TINY = APPEARANCE_PRESETS["tiny"]


def record(folder: Path, name: str) -> dict[str, torch.Tensor]:
    return load_file(folder / f"{name}.io.safetensors")


def weights_of(io: dict[str, torch.Tensor], block: str) -> dict[str, torch.Tensor]:
    prefix = f"{block}.weights."
    return {key.removeprefix(prefix): value for key, value in io.items() if key.startswith(prefix)}


def shapes(network: torch.nn.Module) -> dict[str, list[int]]:
    return {key: list(value.shape) for key, value in network.state_dict().items()}


@pytest.mark.real
@pytest.mark.parametrize("name", FULL_SIZE)
def test_full_size_networks_have_exactly_the_public_tensors(trellis_reference: Path, name: str):
    said = json.loads((trellis_reference / f"keys_{name}.json").read_text())
    preset = APPEARANCE_PRESETS["paper"]
    with torch.device("meta"):
        network = build_trellis(said["name"], said["args"])
        ours = {
            SlatEncoder: lambda: SlatEncoder(preset.encoder),
            GaussianDecoder: lambda: GaussianDecoder(preset.decoder),
            SlatDit: lambda: SlatDit(preset.flow) if isinstance(preset.flow, SlatDitConfig) else None,
        }[type(network)]()
    public = {key: tensor["shape"] for key, tensor in said["tensors"].items()}
    assert shapes(network) == public
    assert ours is not None
    assert shapes(ours) == public
    assert sum(p.numel() for p in network.parameters()) == said["num_parameters"]


@pytest.mark.real
def test_encoder_repeats_the_reference(trellis_reference: Path):
    encoder, io = load_trellis(trellis_reference / "slat_enc"), record(trellis_reference, "slat_enc")
    mean, logvar = encoder(io["in.coords"], io["in.feats"])
    torch.testing.assert_close(mean, io["out.mean"], atol=2e-5, rtol=1e-4)
    torch.testing.assert_close(logvar, io["out.logvar"], atol=2e-5, rtol=1e-4)
    z = sample_gaussian(mean, logvar, io["in.eps"])
    torch.testing.assert_close(z, io["out.z_sampled"], atol=2e-5, rtol=1e-4)


@pytest.mark.real
def test_gaussian_decoder_repeats_the_reference_in_parametrisation_and_order(trellis_reference: Path):
    decoder, io = load_trellis(trellis_reference / "slat_dec_gs"), record(trellis_reference, "slat_dec_gs")
    assert isinstance(decoder, GaussianDecoder)
    coords = io["in.coords"]
    raw = decoder.transform(coords, io["in.feats"], None)
    torch.testing.assert_close(raw, io["out.raw_feats"], atol=2e-5, rtol=1e-4)
    decoded = decoder(coords, io["in.feats"])
    for sample in range(2):
        mine = select_voxels(decoded, coords[:, 0] == sample)
        for ours, theirs in (
            (mine.means, "xyz"),
            (mine.quats, "rotations"),
            (mine.scales, "scales"),
            (mine.opacities[:, None], "opacities"),
            (mine.colors, "colours"),
        ):
            torch.testing.assert_close(ours, io[f"out.{sample}.{theirs}"], atol=2e-6, rtol=1e-4)


@pytest.mark.real
def test_sparse_flow_repeats_the_reference(trellis_reference: Path):
    flow, io = load_trellis(trellis_reference / "slat_flow"), record(trellis_reference, "slat_flow")
    assert isinstance(flow, SlatDit)
    plan = flow.plan(io["in.coords"], 2)
    assert torch.equal(plan.coords[1], io["mid.blocks.0.coords"])
    said = flow(io["in.feats"], io["in.t_model"], plan, io["in.cond"])
    torch.testing.assert_close(said, io["out.v"], atol=1e-4, rtol=1e-4)
    io = record(trellis_reference, "loss_slat_flow")
    t = io["in.t"][io["in.coords"][:, 0].long()]
    x_t, target = diffuse(io["in.x_0"], io["in.noise"], t), target_velocity(io["in.x_0"], io["in.noise"])
    torch.testing.assert_close(x_t, io["out.x_t"], atol=1e-6, rtol=1e-6)
    torch.testing.assert_close(target, io["out.target_v"], atol=1e-6, rtol=1e-6)
    said = flow(x_t, 1000.0 * io["in.t"], flow.plan(io["in.coords"], 2), io["in.cond"])
    torch.testing.assert_close(((said - target) ** 2).mean(), io["out.mse"][0], atol=1e-4, rtol=1e-4)


@pytest.mark.real
def test_sampler_and_sparse_flow_together_repeat_the_reference(trellis_reference: Path):
    flow, io = load_trellis(trellis_reference / "slat_flow"), record(trellis_reference, "sampler_slat_flow")
    assert isinstance(flow, SlatDit)
    plan = flow.plan(io["in.coords"], 2)
    asked = [io[f"in.{name}"] for name in ("cond", "neg_cond")]
    cfg = SamplerConfig(steps=12, strength=3.0)
    states = []

    def velocity(x: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        states.append(x)
        return flow(x, 1000.0 * t, plan, asked[0])

    out = sample_flow(
        io["in.noise"],
        velocity,
        lambda x, t: (velocity(x, t), flow(x, 1000.0 * t, plan, asked[1])),
        cfg,
        samples=2,
    )
    assert [is_guided(t, cfg) for t in plan_times(cfg)[:-1]] == io["out.guided"].bool().tolist()
    torch.testing.assert_close(states[1], io["out.first_pred_x_t"], atol=1e-4, rtol=1e-4)
    torch.testing.assert_close(out, io["out.samples"], atol=1e-4, rtol=1e-4)


@pytest.mark.real
def test_single_operations_repeat_the_reference(trellis_reference: Path):
    io = record(trellis_reference, "ops")
    coords, feats = io["downsample2.in.coords"], io["downsample2.in.feats"]
    parents = coarsen(coords, 2)
    merged = merge_features(feats, parents)
    assert torch.equal(parents.coords, io["downsample2.out.coords"])
    torch.testing.assert_close(merged, io["downsample2.out.feats"], atol=2e-6, rtol=0)
    torch.testing.assert_close(split_features(merged, parents), io["upsample2.out.feats"], atol=2e-6, rtol=0)
    for window, shift in ((8, 0), (8, 4), (4, 2), (6, 3)):
        groups, first = group_windows(coords, window, shift), io[f"window{window}_shift{shift}.out.group"]
        lowest = torch.full((int(groups.max()) + 1,), len(groups))
        lowest = lowest.scatter_reduce(0, groups, torch.arange(len(groups)), "amin")
        assert torch.equal(lowest[groups], first.long())
    conv = SparseConv3d(5, 7)
    load_strictly(conv.conv, {key: io[f"subm_conv.{key}"] for key in ("weight", "bias")}, "subm_conv")
    said = conv(feats, find_neighbours(coords))
    torch.testing.assert_close(said, io["subm_conv.out.feats"], atol=2e-6, rtol=0)
    for count in (8, 32):
        theirs = io[f"offset_perturbation{count}_voxel1.5.out"]
        torch.testing.assert_close(spread_offsets(count, 1.5), theirs, atol=2e-6, rtol=0)


@pytest.mark.real
def test_single_blocks_repeat_the_reference(trellis_reference: Path):
    io = record(trellis_reference, "ops")
    coords = io["downsample2.in.coords"]
    parents = coarsen(coords, 2)
    for name, places in (("same", coords), ("down", parents.coords)):
        block = SparseResBlock3d(6, 10, 16)
        load_strictly(block, weights_of(io, f"res_block_{name}"), name)
        feats = io[f"res_block_{name}.in.feats"]
        given = feats if name == "same" else merge_features(feats, parents)
        said = block(given, io[f"res_block_{name}.in.emb"], places[:, 0], find_neighbours(places))
        torch.testing.assert_close(said, io[f"res_block_{name}.out.feats"], atol=2e-6, rtol=0)
    block = WindowBlock(SlatVaeConfig(model_channels=32, num_heads=2))
    load_strictly(block, weights_of(io, "swin_block_w4s2"), "swin_block")
    said = block(io["swin_block_w4s2.in.feats"], plan_windows(coords, 4, 2))
    torch.testing.assert_close(said, io["swin_block_w4s2.out.feats"], atol=2e-6, rtol=0)


def write_checkpoint(folder: Path, generator: torch.Generator, **changes: object) -> Path:
    flow = redraw(SlatDit(replace(SMALL, io_block_channels=(8,))), generator)
    args = {"resolution": 16, "in_channels": 8, "model_channels": 32, "cond_channels": 24, "num_blocks": 2}
    args |= {"num_heads": 2, "io_block_channels": [8], "qk_rms_norm": True, "use_fp16": True, **changes}
    (folder / "flow.json").write_text(json.dumps({"name": "SLatFlowModel", "args": args}))
    save_file(flow.state_dict(), folder / "flow.safetensors")
    return folder / "flow"


def test_kernels_load_in_either_layout(tmp_path: Path, generator: torch.Generator):
    path = write_checkpoint(tmp_path, generator)
    file = tmp_path / "flow.safetensors"
    tensors = load_file(file)
    turned = {
        key: value.permute(0, 4, 1, 2, 3).contiguous() if value.ndim == 5 else value
        for key, value in tensors.items()
    }
    for stored in (tensors, turned):
        save_file(stored, file)
        loaded = load_trellis(path).state_dict()
        assert all(torch.equal(loaded[key], value) for key, value in tensors.items())


def test_foreign_checkpoints_are_refused_by_name(tmp_path: Path, generator: torch.Generator):
    file = tmp_path / "flow.safetensors"
    path = write_checkpoint(tmp_path, generator)
    tensors = load_file(file)
    del tensors["out_layer.bias"]
    save_file({**tensors, "pos_emb": torch.zeros(1)}, file)
    with pytest.raises(SourceError, match=r"1 missing \(out_layer\.bias\); 1 unexpected \(pos_emb\)"):
        load_trellis(path)
    for wrong, message in (({"share_mod": True}, "share_mod"), ({"patch_size": 4}, "patch_size 4")):
        with pytest.raises(SourceError, match=message):
            load_trellis(write_checkpoint(tmp_path, generator, **wrong))
    with pytest.raises(SourceError, match="attn_mode 'full'"):
        build_trellis("SLatEncoder", {"model_channels": 64, "attn_mode": "full"})
    said = {"model_channels": 64, "representation_config": {"lr": {"_glow": 1.0}}}
    with pytest.raises(SourceError, match="_glow"):
        build_trellis("SLatGaussianDecoder", said)
