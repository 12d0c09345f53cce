"""One stage of a training run: its loop, initial weights and resulting weights."""

from dataclasses import fields
from pathlib import Path
from typing import TypeVar

import torch
from torch import nn

from artigen.models.description import read_description
from artigen.models.store import load_model
from artigen.models.tensors import load_strictly, read_tensors
from artigen.train.loop import LoopConfig, Rates, finished_steps
from artigen.train.presets import StageConfig

Network = TypeVar("Network", bound=nn.Module)


def plan_loop(stage: StageConfig, minutes: float) -> LoopConfig:
    """Loop configuration of a stage, with its share of the budget."""
    rates = {one.name: getattr(stage, one.name) for one in fields(Rates)}
    return LoopConfig(minutes=minutes * stage.share, **rates)


def begin_stage(network: Network, start: Path | None, name: str) -> Network:
    """A network in training mode, with the weights of a model if there is one to start from.

    Args:
        start: Folder of the model; None keeps the initial weights.

    Raises:
        SourceError: If the model has no such network, or one of other sizes.
    """
    if start is not None:
        load_model(network, start, name)
    return network.train()


def describe_stage(folder: Path, start: Path | None, name: str) -> dict[str, object]:
    """Steps of a stage, and the description of the network that it started from."""
    steps: dict[str, object] = {"steps": finished_steps(folder)}
    return steps if start is None else {**steps, "start": read_description(start)[name]}


def load_stage(network: Network, folder: Path) -> Network:
    """A network with the weights of its stage, in full precision, on the GPU if there is one.

    Raises:
        SourceError: If the weights are damaged or of another network.
    """
    weights = folder / "weights.safetensors"
    load_strictly(network, read_tensors(weights), str(weights))
    return network.to("cuda" if torch.cuda.is_available() else "cpu").eval()
