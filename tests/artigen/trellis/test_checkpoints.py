"""The structure networks and the sampler against what TRELLIS' own classes computed."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import load_file, save_file

from artigen.errors import SourceError
from artigen.latent.conv_vae import kl_divergence
from artigen.latent.structure_dit import StructureDit, StructureDitConfig
from artigen.latent.volumes import ResBlock3d, gather_pixels, sample_gaussian, shuffle_pixels
from artigen.models.embeddings import embed_positions, embed_times
from artigen.models.rectified_flow import (
    SamplerConfig,
    diffuse,
    is_guided,
    plan_times,
    predict_data,
    sample_flow,
    target_velocity,
)
from artigen.models.tensors import load_strictly
from artigen.trellis.checkpoints import build_trellis, load_trellis

FULL_SIZE = ("ss_enc_conv3d_16l8", "ss_dec_conv3d_16l8", "ss_flow_img_dit_L_16l8")
TINY = {"resolution": 4, "in_channels": 2, "model_channels": 32, "cond_channels": 8, "num_blocks": 2}


def record(folder: Path, name: str) -> dict[str, torch.Tensor]:
    return load_file(folder / f"{name}.io.safetensors")


@pytest.fixture(autouse=True)
def no_gradients():
    with torch.no_grad():
        yield


@pytest.mark.real
@pytest.mark.parametrize("name", FULL_SIZE)
def test_full_size_networks_have_exactly_the_public_tensors(trellis_reference: Path, name: str):
    said = json.loads((trellis_reference / f"keys_{name}.json").read_text())
    with torch.device("meta"):
        network = build_trellis(said["name"], said["args"])
    ours = {key: list(value.shape) for key, value in network.state_dict().items()}
    assert ours == {key: tensor["shape"] for key, tensor in said["tensors"].items()}
    assert sum(p.numel() for p in network.parameters()) == said["num_parameters"]


@pytest.mark.real
def test_encoder_and_decoder_repeat_the_reference(trellis_reference: Path):
    encoder, decoder = (load_trellis(trellis_reference / name) for name in ("ss_enc", "ss_dec"))
    io = record(trellis_reference, "ss_enc")
    mean, logvar = encoder(io["in.x"])
    torch.testing.assert_close(mean, io["out.mean"], atol=2e-5, rtol=1e-4)
    torch.testing.assert_close(logvar, io["out.logvar"], atol=2e-5, rtol=1e-4)
    z = sample_gaussian(mean, logvar, io["in.eps"])
    torch.testing.assert_close(z, io["out.z_sampled"], atol=2e-5, rtol=1e-4)
    io = record(trellis_reference, "ss_dec")
    torch.testing.assert_close(decoder(io["in.z"]), io["out.logits"], atol=2e-5, rtol=1e-4)


@pytest.mark.real
def test_kl_is_the_reference_mean(trellis_reference: Path):
    encoder = load_trellis(trellis_reference / "ss_enc")
    io = record(trellis_reference, "loss_ss_vae")
    torch.testing.assert_close(kl_divergence(*encoder(io["in.ss"])), io["out.kl"][0], atol=1e-5, rtol=1e-5)


@pytest.mark.real
def test_flow_repeats_the_reference(trellis_reference: Path):
    flow = load_trellis(trellis_reference / "ss_flow")
    assert isinstance(flow, StructureDit)
    io = record(trellis_reference, "ss_flow")
    said = flow(io["in.x"], io["in.t_model"], io["in.cond"])
    torch.testing.assert_close(said, io["out.v"], atol=1e-4, rtol=1e-4)
    io = record(trellis_reference, "loss_ss_flow")
    x_t = diffuse(io["in.x_0"], io["in.noise"], io["in.t"])
    target = target_velocity(io["in.x_0"], io["in.noise"])
    torch.testing.assert_close(x_t, io["out.x_t"], atol=1e-6, rtol=1e-6)
    torch.testing.assert_close(target, io["out.target_v"], atol=1e-6, rtol=1e-6)
    said = flow(x_t, 1000.0 * io["in.t"], io["in.cond"])
    torch.testing.assert_close(((said - target) ** 2).mean(), io["out.mse"][0], atol=1e-4, rtol=1e-4)


@pytest.mark.real
def test_single_operations_repeat_the_reference(trellis_reference: Path):
    io = record(trellis_reference, "ops")
    torch.testing.assert_close(shuffle_pixels(io["pixel_shuffle_3d.in"], 2), io["pixel_shuffle_3d.out"])
    torch.testing.assert_close(gather_pixels(io["patchify2.in"], 2), io["patchify2.out"])
    for width in (64, 96, 1024):
        places = io[f"ape{width}.in"].float()
        torch.testing.assert_close(embed_positions(places, width), io[f"ape{width}.out"], atol=2e-6, rtol=0)


@pytest.mark.real
@pytest.mark.parametrize("name", ["sampler_analytic", "sampler_analytic_full", "sampler_analytic_25"])
def test_sampler_repeats_the_reference_on_a_velocity_in_closed_form(trellis_reference: Path, name: str):
    from safetensors import safe_open

    io = record(trellis_reference, name)
    with safe_open(trellis_reference / f"{name}.io.safetensors", "pt") as file:
        said = json.loads(file.metadata()["params"])
    cfg = SamplerConfig(
        steps=said["steps"],
        strength=said["cfg_strength"],
        interval=tuple(said["cfg_interval"]),
        rescale=said["rescale_t"],
    )

    def velocity(x: torch.Tensor, t: torch.Tensor, cond: torch.Tensor) -> torch.Tensor:
        t = t.reshape(-1, 1, 1, 1, 1)
        return 0.7 * x + torch.tanh(cond) * torch.cos(3 * t) - 0.2 * t**2

    states = []

    def conditional(x: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        states.append(x)
        return velocity(x, t, io["in.cond"])

    out = sample_flow(
        io["in.noise"],
        conditional,
        lambda x, t: (conditional(x, t), velocity(x, t, io["in.neg_cond"])),
        cfg,
    )
    times = plan_times(cfg)
    assert np.array_equal(times, io["out.t_seq"].numpy())
    assert [is_guided(t, cfg) for t in times[:-1]] == io["out.guided"].bool().tolist()
    torch.testing.assert_close(torch.stack([*states[1:], out]), io["out.pred_x_t"], atol=1e-4, rtol=1e-4)
    torch.testing.assert_close(out, io["out.samples"], atol=1e-4, rtol=1e-4)


@pytest.mark.real
def test_sampler_and_flow_together_repeat_the_reference(trellis_reference: Path):
    flow = load_trellis(trellis_reference / "ss_flow")
    io = record(trellis_reference, "sampler_ss_flow")
    asked = [io[f"in.{name}"] for name in ("cond", "neg_cond")]
    out = sample_flow(
        io["in.noise"],
        lambda x, t: flow(x, 1000.0 * t, asked[0]),
        lambda x, t: (flow(x, 1000.0 * t, asked[0]), flow(x, 1000.0 * t, asked[1])),
        SamplerConfig(steps=12, strength=5.0),
    )
    torch.testing.assert_close(out, io["out.samples"], atol=1e-4, rtol=1e-4)


def test_euler_is_exact_on_a_straight_path():
    generator = torch.Generator().manual_seed(0)
    x_0, noise = (torch.randn(2, 3, 4, 4, 4, generator=generator) for _ in range(2))
    velocity = target_velocity(x_0, noise)
    for steps in (1, 7):
        cfg = SamplerConfig(steps=steps, strength=2.0, rescale=3.0)
        out = sample_flow(noise, lambda x, t: velocity, lambda x, t: (velocity, velocity), cfg)
        torch.testing.assert_close(out, x_0, atol=5e-5, rtol=0)
    t = torch.tensor([0.3, 0.8])
    x_t = diffuse(x_0, noise, t)
    torch.testing.assert_close(predict_data(x_t, velocity, t), x_0, atol=1e-5, rtol=0)


@pytest.mark.parametrize("factor", [2, 4])
def test_gathering_pixels_inverts_shuffling_them(factor: int):
    x = torch.randn(2, 3 * factor**3, 2, 3, 4)
    assert torch.equal(gather_pixels(shuffle_pixels(x, factor), factor), x)


def test_blocks_start_as_the_identity():
    x = torch.randn(1, 8, 4, 4, 4)
    assert torch.equal(ResBlock3d(8)(x), x)
    flow = StructureDit(StructureDitConfig(num_heads=2, **TINY))
    out = flow(torch.randn(1, 2, 4, 4, 4), torch.tensor([500.0]), torch.randn(1, 3, 8))
    assert torch.count_nonzero(out) == 0


def test_times_embed_as_cosines_then_sines():
    out = embed_times(torch.tensor([0.0, 1000.0]))
    assert torch.equal(out[0], torch.cat([torch.ones(128), torch.zeros(128)]))
    assert float(out[1, 128]) == pytest.approx(np.sin(1000.0), abs=1e-4)


def write_checkpoint(folder: Path, **changes: object) -> Path:
    flow = StructureDit(StructureDitConfig(num_heads=2, patch_size=1, **TINY))
    args = {**TINY, "num_heads": 2, "patch_size": 1, "qk_rms_norm": True, "use_fp16": False, **changes}
    (folder / "flow.json").write_text(json.dumps({"name": "ElasticSparseStructureFlowModel", "args": args}))
    save_file(flow.state_dict(), folder / "flow.safetensors")
    return folder / "flow"


def test_a_checkpoint_loads_as_written(tmp_path: Path):
    path = write_checkpoint(tmp_path)
    tensors = load_file(tmp_path / "flow.safetensors")
    assert all(torch.equal(value, tensors[key]) for key, value in load_trellis(path).state_dict().items())


def test_foreign_checkpoints_are_refused_by_name(tmp_path: Path):
    path = write_checkpoint(tmp_path)
    whole = (tmp_path / "flow.safetensors").read_bytes()
    (tmp_path / "flow.safetensors").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(SourceError, match="no complete safetensors file"):
        load_trellis(path)
    with pytest.raises(SourceError, match="no such description"):
        load_trellis(tmp_path / "other")
    with pytest.raises(SourceError, match="'Diffusion'"):
        build_trellis("Diffusion", {})
    with pytest.raises(SourceError, match="window_size"):
        load_trellis(write_checkpoint(tmp_path, window_size=8))


def test_keys_that_differ_are_listed():
    network = torch.nn.Linear(2, 3)
    wrong = {"weight": torch.zeros(3, 4), "gain": torch.zeros(3)}
    with pytest.raises(SourceError, match=r"1 missing \(bias\); 1 unexpected \(gain\); 1 of another shape"):
        load_strictly(network, wrong, "file")


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_weights_that_are_not_finite_are_refused(value: float):
    network = torch.nn.Linear(2, 3)
    with pytest.raises(SourceError, match=r"file: does not fit Linear: 1 not finite \(bias\)"):
        load_strictly(network, {"weight": torch.zeros(3, 2), "bias": torch.full((3,), value)}, "file")
