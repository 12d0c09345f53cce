"""Public TRELLIS checkpoints: ``<name>.json`` (class and arguments) beside ``<name>.safetensors``.

Loading is strict: every tensor of the file must be there, have its shape and be expected.
"""

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn

from artigen.errors import SourceError
from artigen.models.conv_vae import ConvDecoder, ConvEncoder, ConvVaeConfig
from artigen.models.structure_dit import StructureDit, StructureDitConfig

SHOWN_KEYS = 6


def load_trellis(path: Path, *, dtype: torch.dtype = torch.float32) -> nn.Module:
    """Builds the network that a checkpoint describes and loads it.

    Args:
        path: the checkpoint without its suffix, for example ``ckpts/ss_flow_img_dit_L_16l8_fp16``.
        dtype: number type of the weights; float32 on a CPU, where half precision overflows in places.

    Raises:
        SourceError: If a file is missing or truncated, the class is unknown, an argument is not understood,
            or keys or shapes differ.
    """
    described = _read_description(path.with_name(path.name + ".json"))
    network = build_trellis(described["name"], described["args"])
    load_strictly(network, read_tensors(path.with_name(path.name + ".safetensors")), str(path))
    return network.to(dtype).eval()


def build_trellis(name: str, args: dict[str, Any]) -> nn.Module:
    """The network of a class name (with or without "Elastic") and its arguments, freshly initialised.

    Raises:
        SourceError: If the class is none of ours, or an argument asks for something else.
    """
    given = dict(args)
    given.pop("use_fp16", None)
    given.pop("use_checkpoint", None)
    match name.removeprefix("Elastic"):
        case "SparseStructureEncoder":
            return ConvEncoder(_conv_config(given, "in_channels"))
        case "SparseStructureDecoder":
            given["channels"] = list(reversed(given["channels"]))
            return ConvDecoder(_conv_config(given, "out_channels"))
        case "SparseStructureFlowModel":
            return StructureDit(_dit_config(given))
        case other:
            raise SourceError(
                f"checkpoint class {other!r}, expected SparseStructureEncoder, SparseStructureDecoder or "
                "SparseStructureFlowModel"
            )


def read_tensors(path: Path) -> dict[str, Tensor]:
    """All tensors of a safetensors file.

    Raises:
        SourceError: If the file is missing, truncated or no safetensors file.
    """
    from safetensors import SafetensorError
    from safetensors.torch import load_file

    if not path.is_file():
        raise SourceError(f"{path}: there is no such checkpoint")
    try:
        return load_file(path)
    except SafetensorError as error:
        raise SourceError(f"{path}: is no whole safetensors file ({error}); download it again") from error


def load_strictly(network: nn.Module, tensors: dict[str, Tensor], owner: str) -> None:
    """Loads tensors that match a network exactly, in names and shapes.

    Raises:
        SourceError: Lists what is missing, unexpected or of another shape.
    """
    expected = network.state_dict()
    shapes = [
        f"{key} is {list(tensors[key].shape)}, expected {list(expected[key].shape)}"
        for key in sorted(expected.keys() & tensors.keys())
        if tensors[key].shape != expected[key].shape
    ]
    found = [
        ("missing", sorted(expected.keys() - tensors.keys())),
        ("unexpected", sorted(tensors.keys() - expected.keys())),
        ("of another shape", shapes),
    ]
    wrong = [f"{len(keys)} {what} ({_list(keys)})" for what, keys in found if keys]
    if wrong:
        raise SourceError(f"{owner}: does not fit {type(network).__name__}: {'; '.join(wrong)}")
    network.load_state_dict(tensors)


def normalise_features(features: Float[Tensor, "B L C"]) -> Float[Tensor, "B L C"]:
    """What TRELLIS does to DINOv2's tokens before they condition a flow: layer norm without gain."""
    return nn.functional.layer_norm(features, features.shape[-1:])


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


def _conv_config(args: dict[str, Any], channels_key: str) -> ConvVaeConfig:
    known = {
        channels_key: "in_channels",
        "latent_channels": "latent_channels",
        "channels": "channels",
        "num_res_blocks": "res_blocks",
        "num_res_blocks_middle": "middle_blocks",
    }
    norm = args.pop("norm_type", "layer")
    if norm != "layer":
        raise SourceError(f"norm_type {norm!r}: the public checkpoints have 'layer'")
    _reject_unknown(args, known)
    renamed = {known[key]: value for key, value in args.items()}
    return ConvVaeConfig(**{**renamed, "channels": tuple(args["channels"])})


def _dit_config(args: dict[str, Any]) -> StructureDitConfig:
    if args.pop("pe_mode", "ape") != "ape":
        raise SourceError("pe_mode other than 'ape' is in no public checkpoint and not supported")
    out_channels = args.pop("out_channels", args["in_channels"])
    if out_channels != args["in_channels"]:
        raise SourceError(f"out_channels {out_channels} and in_channels {args['in_channels']} must be equal")
    head_channels = args.pop("num_head_channels", 64)
    given = {
        "patch_size": 2,
        "qk_rms_norm": False,
        "num_heads": args["model_channels"] // head_channels,
        **{key: value for key, value in args.items() if value is not None},
    }
    _reject_unknown(given, {field.name for field in fields(StructureDitConfig)})
    return StructureDitConfig(**given)


def _reject_unknown(args: dict[str, Any], known: Any) -> None:
    unknown = sorted(set(args) - set(known))
    if unknown:
        raise SourceError(f"checkpoint arguments {', '.join(unknown)} are not understood")


def _list(keys: list[str]) -> str:
    more = f" and {len(keys) - SHOWN_KEYS} more" if len(keys) > SHOWN_KEYS else ""
    return ", ".join(keys[:SHOWN_KEYS]) + more
