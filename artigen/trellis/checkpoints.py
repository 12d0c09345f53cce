"""Public TRELLIS checkpoints: ``<name>.json`` (class and arguments) beside ``<name>.safetensors``.

Loading is strict: names and shapes of the tensors in the file must match the network exactly.
"""

import json
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from typing import Any

from torch import Tensor, nn

from artigen.appearance.gaussian_decoder import GaussianConfig, GaussianDecoder, GaussianDecoderConfig
from artigen.appearance.slat_dit import SlatDit, SlatDitConfig
from artigen.appearance.slat_vae import SlatEncoder, SlatVaeConfig
from artigen.appearance.sparse_conv import KernelWeights
from artigen.errors import SourceError
from artigen.latent.conv_vae import ConvDecoder, ConvEncoder, ConvVaeConfig
from artigen.latent.structure_dit import StructureDit, StructureDitConfig
from artigen.models.tensors import load_strictly, read_tensors

HEAD_CHANNELS = 64
"""Channels of an attention head if the number of heads is not given."""


def load_trellis(path: Path) -> nn.Module:
    """Builds the network that a checkpoint describes and loads it.

    Args:
        path: Checkpoint without its suffix, for example ``ckpts/ss_flow_img_dit_L_16l8_fp16``.

    Raises:
        SourceError: If a file is missing or truncated, the class or an argument is unknown, or keys or shapes
            differ.
    """
    described = _read_description(path.with_name(path.name + ".json"))
    network = build_trellis(described["name"], described["args"])
    tensors = orient_kernels(network, read_tensors(path.with_name(path.name + ".safetensors")))
    load_strictly(network, tensors, str(path))
    return network.float().eval()


def build_trellis(name: str, args: dict[str, Any]) -> nn.Module:
    """The network of a class name (with or without "Elastic") and its arguments, freshly initialised.

    Raises:
        SourceError: If the class or an argument is unknown, or a value is not supported.
    """
    given = dict(args)
    given.pop("use_fp16", None)
    given.pop("use_checkpoint", None)
    match name.removeprefix("Elastic"):
        case "SparseStructureEncoder":
            return ConvEncoder(conv_config(given, "in_channels"))
        case "SparseStructureDecoder":
            given["channels"] = list(reversed(given["channels"]))
            return ConvDecoder(conv_config(given, "out_channels"))
        case "SparseStructureFlowModel":
            return StructureDit(structure_dit_config(given))
        case "SLatEncoder":
            return SlatEncoder(slat_vae_config(given))
        case "SLatGaussianDecoder":
            return GaussianDecoder(gaussian_decoder_config(given))
        case "SLatFlowModel":
            return SlatDit(slat_dit_config(given))
        case other:
            raise SourceError(
                f"checkpoint class {other!r}, expected SparseStructureEncoder, SparseStructureDecoder, "
                "SparseStructureFlowModel, SLatEncoder, SLatGaussianDecoder or SLatFlowModel"
            )


def orient_kernels(network: nn.Module, tensors: dict[str, Tensor]) -> dict[str, Tensor]:
    """Tensors with sparse kernels as (out, x, y, z, in), converted where a file has (out, in, x, y, z)."""
    out = dict(tensors)
    for name, module in network.named_modules():
        key = f"{name}.weight"
        if isinstance(module, KernelWeights) and key in out and out[key].ndim == 5:
            turned = out[key].permute(0, 2, 3, 4, 1)
            if out[key].shape != module.weight.shape == turned.shape:
                out[key] = turned
    return out


def _read_description(path: Path) -> dict[str, Any]:
    try:
        described = json.loads(path.read_text())
    except FileNotFoundError as error:
        raise SourceError(f"{path}: there is no such description of a checkpoint") from error
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise SourceError(f"{path}: is no JSON ({error})") from error
    if not isinstance(described, dict) or not {"name", "args"} <= described.keys():
        raise SourceError(f"{path}: expected an object with the keys name and args")
    return described


def conv_config(args: dict[str, Any], channels_key: str) -> ConvVaeConfig:
    """Configuration of a structure encoder or decoder; ``channels_key`` names the field's channels."""
    given = {"norm_type": "layer", **args}
    _require(given, norm_type="layer")
    known = {
        channels_key: "in_channels",
        "latent_channels": "latent_channels",
        "channels": "channels",
        "num_res_blocks": "res_blocks",
        "num_res_blocks_middle": "middle_blocks",
    }
    _reject_unknown(given, known)
    renamed = {known[key]: value for key, value in given.items()}
    return ConvVaeConfig(**{**renamed, "channels": tuple(given["channels"])})


def structure_dit_config(args: dict[str, Any]) -> StructureDitConfig:
    """Configuration of a structure flow."""
    given = _flow_args({"patch_size": 2, **args})
    _reject_unknown(given, {field.name for field in fields(StructureDitConfig)})
    return StructureDitConfig(**given)


def slat_dit_config(args: dict[str, Any]) -> SlatDitConfig:
    """Configuration of a sparse flow."""
    given = _flow_args({"patch_size": 2, "share_mod": False, "io_block_channels": None, **args})
    _require(given, share_mod=False)
    channels, patch = tuple(given.pop("io_block_channels", ())), given.pop("patch_size")
    if patch != 2 ** len(channels):
        raise SourceError(
            f"patch_size {patch} with {len(channels)} io_block_channels, expected {2 ** len(channels)}"
        )
    _reject_unknown(given, {field.name for field in fields(SlatDitConfig)})
    return SlatDitConfig(io_block_channels=channels, **given)


def slat_vae_config(args: dict[str, Any]) -> SlatVaeConfig:
    """Configuration of a structured-latent encoder, or of the trunk of a decoder."""
    given = _with_heads(
        {"attn_mode": "swin", "pe_mode": "ape", "qk_rms_norm": False, "window_size": 8, **args}
    )
    _require(given, attn_mode="swin", pe_mode="ape", qk_rms_norm=False)
    _reject_unknown(given, {field.name for field in fields(SlatVaeConfig)})
    return SlatVaeConfig(**given)


def gaussian_decoder_config(args: dict[str, Any]) -> GaussianDecoderConfig:
    """Configuration of a Gaussian decoder."""
    given = dict(args)
    representation = {"scaling_activation": "softplus", **given.pop("representation_config")}
    _require(representation, scaling_activation="softplus")
    rates = {
        "_xyz": "offset_rate",
        "_features_dc": "color_rate",
        "_scaling": "scale_rate",
        "_rotation": "quat_rate",
        "_opacity": "opacity_rate",
    }
    known = {
        "num_gaussians": "count",
        "voxel_size": "reach",
        "perturb_offset": "perturb",
        "scaling_bias": "scale_bias",
        "opacity_bias": "opacity_bias",
        "3d_filter_kernel_size": "filter_scale",
        "2d_filter_kernel_size": "screen_filter",
    }
    factors = representation.pop("lr", {})
    _reject_unknown(factors, rates)
    _reject_unknown(representation, known)
    renamed = {known[key]: value for key, value in representation.items()}
    renamed |= {rates[key]: value for key, value in factors.items()}
    return GaussianDecoderConfig(trunk=slat_vae_config(given), gaussians=GaussianConfig(**renamed))


def _flow_args(args: dict[str, Any]) -> dict[str, Any]:
    given = _with_heads({"pe_mode": "ape", "qk_rms_norm": False, "out_channels": args["in_channels"], **args})
    _require(given, pe_mode="ape", out_channels=given["in_channels"])
    return given


def _with_heads(args: dict[str, Any]) -> dict[str, Any]:
    """The arguments without those that are None, and with a number of heads."""
    given = {key: value for key, value in args.items() if value is not None}
    head = given.pop("num_head_channels", HEAD_CHANNELS)
    return {"num_heads": given["model_channels"] // head, **given}


def _require(given: dict[str, Any], **supported: object) -> None:
    """Removes arguments with a single supported value; raises `SourceError` on any other."""
    for key, wanted in supported.items():
        if (value := given.pop(key)) != wanted:
            raise SourceError(f"{key} {value!r}: only {wanted!r}, as in all public checkpoints, is supported")


def _reject_unknown(args: Iterable[str], known: Iterable[str]) -> None:
    unknown = sorted(set(args) - set(known))
    if unknown:
        raise SourceError(
            f"unknown checkpoint arguments {', '.join(unknown)}, expected some of {', '.join(sorted(known))}"
        )
