"""Trained models as folders: ``model.json`` and the weights in half precision, in files of limited size."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path

import torch
from torch import Tensor, nn

from artigen.errors import SourceError
from artigen.io import write_whole
from artigen.models.description import DESCRIPTION, read_description
from artigen.models.tensors import load_strictly, read_tensors

FILE_LIMIT = 16 * 2**20


def save_model(
    network: nn.Module,
    folder: Path,
    described: Mapping[str, object],
    name: str,
    convert: Callable[[dict[str, Tensor]], dict[str, Tensor]] | None = None,
) -> list[Path]:
    """Writes the weights of a network beside a description of the model they belong to.

    Args:
        network: Network; its floating-point tensors are stored in float16.
        folder: Folder of the model, which may hold other networks.
        described: Entry of the network in `model.json`: preset, training, data.
        name: Name of the network; its files are called ``name-<number>.safetensors``.
        convert: Converts the tensors of the network to those that are stored.

    Returns:
        Paths of the files of weights.
    """
    from safetensors.torch import save_file

    folder.mkdir(parents=True, exist_ok=True)
    files: list[dict[str, Tensor]] = [{}]
    filled = 0
    tensors = network.state_dict()
    for key, value in (tensors if convert is None else convert(tensors)).items():
        stored = (value.half() if value.is_floating_point() else value).contiguous().cpu()
        size = stored.numel() * stored.element_size()
        if filled + size > FILE_LIMIT - 65536 and files[-1]:
            files.append({})
            filled = 0
        files[-1][key] = stored
        filled += size
    for old in folder.glob(f"{name}-*.safetensors"):
        old.unlink()
    paths = [folder / f"{name}-{number}.safetensors" for number in range(len(files))]
    for path, tensors in zip(paths, files, strict=True):
        save_file(tensors, path)
    known = read_description(folder) if (folder / DESCRIPTION).is_file() else {}
    text = json.dumps({**known, name: dict(described)}, indent=1, sort_keys=True) + "\n"
    write_whole(folder / DESCRIPTION, text)
    return paths


def load_model(
    network: nn.Module,
    folder: Path,
    name: str,
    convert: Callable[[dict[str, Tensor]], dict[str, Tensor]] | None = None,
) -> nn.Module:
    """Loads the weights of a network, in float32, and returns it ready for use.

    Args:
        convert: Converts stored tensors to those of the network, where the layout differs.

    Raises:
        SourceError: If files are missing or truncated, or tensors differ in name or shape.
    """
    paths = sorted(folder.glob(f"{name}-*.safetensors"))
    if not paths:
        raise SourceError(f"{folder}: holds no {name}-*.safetensors")
    tensors = {key: value for path in paths for key, value in read_tensors(path).items()}
    tensors = {key: value.float() if value.is_floating_point() else value for key, value in tensors.items()}
    load_strictly(network, tensors if convert is None else convert(tensors), str(folder / name))
    return network.to(torch.float32).eval()
