"""What the arguments in TRELLIS' checkpoint descriptions mean for our networks.

Arguments that ask for anything that no public checkpoint has are refused by name.
"""

from collections.abc import Iterable
from dataclasses import fields
from typing import Any

from artigen.appearance.gaussian_decoder import GaussianConfig, GaussianDecoderConfig
from artigen.appearance.slat_dit import SlatDitConfig
from artigen.appearance.slat_vae import SlatVaeConfig
from artigen.errors import SourceError
from artigen.latent.conv_vae import ConvVaeConfig
from artigen.latent.structure_dit import StructureDitConfig

HEAD_CHANNELS = 64
"""Channels of an attention head where the number of heads is not given."""


def conv_config(args: dict[str, Any], channels_key: str) -> ConvVaeConfig:
    """Arguments of a structure encoder or decoder; ``channels_key`` names the field's channels."""
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
    """Arguments of a structure flow."""
    given = _flow_args({"patch_size": 2, **args})
    _reject_unknown(given, {field.name for field in fields(StructureDitConfig)})
    return StructureDitConfig(**given)


def slat_dit_config(args: dict[str, Any]) -> SlatDitConfig:
    """Arguments of a sparse flow."""
    given = _flow_args({"patch_size": 2, "share_mod": False, "io_block_channels": None, **args})
    _require(given, share_mod=False)
    channels, patch = tuple(given.pop("io_block_channels", ())), given.pop("patch_size")
    if patch != 2 ** len(channels):
        raise SourceError(f"patch_size {patch} does not go with {len(channels)} io_block_channels")
    _reject_unknown(given, {field.name for field in fields(SlatDitConfig)})
    return SlatDitConfig(io_block_channels=channels, **given)


def slat_vae_config(args: dict[str, Any]) -> SlatVaeConfig:
    """Arguments of a structured-latent encoder, or of the trunk of a decoder."""
    given = _with_heads(
        {"attn_mode": "swin", "pe_mode": "ape", "qk_rms_norm": False, "window_size": 8, **args}
    )
    _require(given, attn_mode="swin", pe_mode="ape", qk_rms_norm=False)
    _reject_unknown(given, {field.name for field in fields(SlatVaeConfig)})
    return SlatVaeConfig(**given)


def gaussian_decoder_config(args: dict[str, Any]) -> GaussianDecoderConfig:
    """Arguments of a Gaussian decoder."""
    given = dict(args)
    said = {"scaling_activation": "softplus", **given.pop("representation_config")}
    _require(said, scaling_activation="softplus")
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
    factors = said.pop("lr", {})
    _reject_unknown(factors, rates)
    _reject_unknown(said, known)
    renamed = {known[key]: value for key, value in said.items()}
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
    """Takes out arguments of which only one value is supported."""
    for key, wanted in supported.items():
        if (value := given.pop(key)) != wanted:
            raise SourceError(f"{key} {value!r}: supported, and in all public checkpoints, is {wanted!r}")


def _reject_unknown(args: Iterable[str], known: Iterable[str]) -> None:
    unknown = sorted(set(args) - set(known))
    if unknown:
        raise SourceError(f"checkpoint arguments {', '.join(unknown)} are not understood")
