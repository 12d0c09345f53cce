"""Reads files of tensors, and loads them into networks strictly."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import torch
from torch import Tensor, nn

from artigen.errors import SourceError, list_some

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
    faults = {
        "missing": sorted(expected.keys() - tensors.keys()),
        "unexpected": sorted(tensors.keys() - expected.keys()),
        "of another shape": shapes,
        "not finite": [key for key in shared if not torch.isfinite(tensors[key]).all()],
    }
    require_fit(faults, f"{owner}: does not fit {type(network).__name__}")
    network.load_state_dict(tensors)


def require_fit(faults: Mapping[str, Sequence[str]], said: str) -> None:
    """Refuses tensors that have faults.

    Args:
        faults: Names of tensors by what is wrong with them.
        said: Beginning of the error.

    Raises:
        SourceError: If there are any; lists them.
    """
    wrong = [f"{len(keys)} {what} ({list_some(keys, SHOWN_KEYS)})" for what, keys in faults.items() if keys]
    if wrong:
        raise SourceError(f"{said}: {'; '.join(wrong)}")
