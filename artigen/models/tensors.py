"""Reads files of tensors, and loads them into networks strictly."""

from collections.abc import Sequence
from pathlib import Path
from pickle import UnpicklingError

import torch
from torch import Tensor, nn

from artigen.errors import SourceError

SHOWN_KEYS = 6
"""Most keys that an error lists."""


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
        raise SourceError(f"{path}: is no complete safetensors file ({error}); download it again") from error


def read_pickle(path: Path) -> dict[str, Tensor]:
    """All tensors of a torch file that holds nothing else.

    Raises:
        SourceError: If the file is damaged, or holds anything else.
    """
    try:
        stored = torch.load(path, map_location="cpu", weights_only=True)
    except (UnpicklingError, RuntimeError, EOFError) as error:
        raise SourceError(f"{path}: is no complete torch file of plain tensors ({error})") from error
    if not isinstance(stored, dict) or not all(isinstance(value, Tensor) for value in stored.values()):
        raise SourceError(f"{path}: expected a state dict, tensors by name")
    return stored


def read_published(folder: Path, files: Sequence[str]) -> tuple[Path, dict[str, Tensor]]:
    """The first of some weight files that a folder holds, and its tensors.

    Raises:
        SourceError: If the folder holds none of the files, or the file is damaged.
    """
    found = [folder / name for name in files if (folder / name).is_file()]
    if not found:
        raise SourceError(f"{folder}: holds neither {' nor '.join(files)}")
    path = found[0]
    return path, read_tensors(path) if path.suffix == ".safetensors" else read_pickle(path)


def load_strictly(network: nn.Module, tensors: dict[str, Tensor], owner: str) -> None:
    """Loads tensors that match a network exactly, in names and shapes.

    Raises:
        SourceError: If tensors are missing, unexpected, of another shape or not finite; lists them.
    """
    expected = network.state_dict()
    shared = sorted(expected.keys() & tensors.keys())
    shapes = [
        f"{key} is {list(tensors[key].shape)}, expected {list(expected[key].shape)}"
        for key in shared
        if tensors[key].shape != expected[key].shape
    ]
    found = [
        ("missing", sorted(expected.keys() - tensors.keys())),
        ("unexpected", sorted(tensors.keys() - expected.keys())),
        ("of another shape", shapes),
        ("not finite", [key for key in shared if not torch.isfinite(tensors[key]).all()]),
    ]
    wrong = [f"{len(keys)} {what} ({_list(keys)})" for what, keys in found if keys]
    if wrong:
        raise SourceError(f"{owner}: does not fit {type(network).__name__}: {'; '.join(wrong)}")
    network.load_state_dict(tensors)


def _list(keys: list[str]) -> str:
    more = f" and {len(keys) - SHOWN_KEYS} more" if len(keys) > SHOWN_KEYS else ""
    return ", ".join(keys[:SHOWN_KEYS]) + more
