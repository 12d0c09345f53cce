"""Stores and loads the reader's weights."""

from functools import lru_cache
from pathlib import Path

from artigen.models.description import read_description
from artigen.models.store import load_model, save_model
from artigen.reader.network import ReaderConfig, ReaderNetwork

NAME = "reader"


def save_reader(network: ReaderNetwork, folder: Path, described: dict[str, object]) -> list[Path]:
    """Writes weights in half precision with a description; returns the files of weights."""
    sizes = {"variant": network.cfg.variant, "width": network.cfg.width, "tuned_from": network.cfg.tuned_from}
    return save_model(network, folder, {**described, "sizes": sizes}, NAME)


@lru_cache(maxsize=2)
def load_reader(folder: Path) -> ReaderNetwork:
    """The reader of a folder, loaded once per process.

    Raises:
        SourceError: If the folder holds none, or a file is damaged.
    """
    import torch

    sizes = read_description(folder)[NAME]["sizes"]
    assert isinstance(sizes, dict)
    network = ReaderNetwork(ReaderConfig(**sizes))
    load_model(network, folder, NAME)
    network.requires_grad_(False)
    return network.to(memory_format=torch.channels_last)
