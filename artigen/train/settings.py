"""Settings of training runs that the command line offers; importing them loads no network."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class TrainSettings:
    """What to train, on which data and for how long."""

    preset: Literal["tiny", "small", "compact", "paper"] = "compact"
    """Network sizes."""
    minutes: float = 30.0
    """Training time of all networks together; data generation is not included."""
    shards: int = 100
    """Number of training shards."""
    held_out: int = 2
    """Number of held-out shards."""
    objects: int | None = None
    """Objects per shard; default: 256, or 16 for appearance."""
    partnet: Path | None = None
    """Folder with partnet_mobility/ and splits.json, whose training split is mixed in. The licence of the
    data restricts such weights to research."""
    real_share: float = 0.1
    """Share of real objects among the examples, reached by repeating them."""
    start: Path | None = None
    """Folder of a model to initialise from, such as artigen/weights/small."""
    trellis: Path | None = None
    """Public TRELLIS checkpoint, without suffix, to initialise the flow from (structure, preset paper)."""
    encoders: Path | None = None
    """Folder with the public weights of DINOv2 and CLIP; only structure, preset paper."""
