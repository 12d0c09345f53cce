"""Public TRELLIS checkpoints: ``<name>.json`` (class and arguments) beside ``<name>.safetensors``.

Loading is strict: names and shapes of the tensors in the file must match the network exactly.
"""

import json
from pathlib import Path
from typing import Any

from torch import Tensor, nn

from artigen.appearance.gaussian_decoder import GaussianDecoder
from artigen.appearance.slat_dit import SlatDit
from artigen.appearance.slat_vae import SlatEncoder
from artigen.appearance.sparse_conv import KernelWeights
from artigen.errors import SourceError
from artigen.latent.conv_vae import ConvDecoder, ConvEncoder
from artigen.latent.structure_dit import StructureDit
from artigen.models.tensors import load_strictly, read_tensors
from artigen.trellis.arguments import (
    conv_config,
    gaussian_decoder_config,
    slat_dit_config,
    slat_vae_config,
    structure_dit_config,
)


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
