"""A stage of a run, whatever is trained in it: its loop, the weights it leaves, a line of its metrics."""

import logging
from collections.abc import Mapping
from pathlib import Path
from typing import TypeVar

import torch
from torch import nn

from artigen.models.trellis import load_strictly, read_tensors
from artigen.train.loop import LoopConfig
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
