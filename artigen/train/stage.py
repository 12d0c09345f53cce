"""One stage of a training run: its loop, initial weights and resulting weights."""

import logging
from collections.abc import Mapping
from pathlib import Path
from typing import TypeVar

import torch
from torch import nn

from artigen.models.description import read_description
from artigen.models.store import load_model
from artigen.models.tensors import load_strictly, read_tensors
from artigen.train.loop import LoopConfig, finished_steps
from artigen.train.presets import StageConfig

logger = logging.getLogger(__name__)
Network = TypeVar("Network", bound=nn.Module)


def plan_loop(stage: StageConfig, minutes: float) -> LoopConfig:
    """The loop of a stage that has its share of a budget."""
    return LoopConfig(
        minutes=minutes * stage.share,
        learning_rate=stage.learning_rate,
        warmup=stage.warmup,
        decay=stage.decay,
        ema=stage.ema,
    )


def begin_stage(network: Network, start: Path | None, name: str) -> Network:
    """A network as its stage finds it: as it was made, or with the weights of a model to go on from.

    Args:
        network: new.
        start: Folder of the model; None leaves the network as it is.
        name: What the model calls the network.

    Raises:
        SourceError: If the model has no such network, or one of other sizes.
    """
    if start is not None:
        load_model(network, start, name)
    return network.train()


def describe_stage(folder: Path, start: Path | None, name: str) -> dict[str, object]:
    """How far a stage has come, and what the model it began with says of itself."""
    steps: dict[str, object] = {"steps": finished_steps(folder)}
    return steps if start is None else {**steps, "start": read_description(start)[name]}


def load_stage(network: Network, folder: Path) -> Network:
    """A network with the weights that its stage has left, in full precision, where it runs fastest.

    Raises:
        SourceError: If the weights are damaged or of another network.
    """
    weights = folder / "weights.safetensors"
    load_strictly(network, read_tensors(weights), str(weights))
    return network.to("cuda" if torch.cuda.is_available() else "cpu").eval()


def log_metrics(name: str, line: Mapping[str, float]) -> None:
    """Logs a line of metrics of the network called ``name``."""
    logger.info("%s %s", name, " ".join(f"{key}={value:.4g}" for key, value in line.items()))
