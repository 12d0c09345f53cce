"""From nothing to weights: `python -m artigen.train.everything` makes data, trains, evaluates and stores.

Every stage is skipped or gone on with where the run folder already holds its result, so the same command
can be given again after an interruption, or in portions of a budget.
"""

import argparse
import json
import logging
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import torch

from artigen.metrics.structure import score_reconstruction
from artigen.models.presets import PRESETS, PresetName, StructurePreset
from artigen.models.store import save_model
from artigen.models.structure_flow import StructureFlow
from artigen.models.structure_vae import StructureVae
from artigen.train.examples import StructureExample
from artigen.train.loop import LoopConfig
from artigen.train.presets import TRAINING, StageConfig
from artigen.train.shards import HELD_OUT, ShardConfig, make_shards, read_shard
from artigen.train.structure import encode_examples, train_structure_flow, train_structure_vae

logger = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class RunConfig:
    """One run from nothing to weights."""

    folder: Path
    """Data, checkpoints and weights."""
    preset: PresetName = "compact"
    """Sizes."""
    minutes: float = 30.0
    """Budget of the training of both networks; making data comes on top."""
    shards: int = 100
    """Shards of training data, 256 objects each."""
    held_out: int = 2
    """Shards of held-out data."""
    objects: int = 256
    """Objects per shard."""
    workers: int = 2
    """Processes that make data."""


def train_everything(cfg: RunConfig) -> dict[str, float]:
    """Runs what is missing and returns the scores of the held-out objects."""
    preset, training = PRESETS[cfg.preset], TRAINING[cfg.preset]
    trained, held_out = (
        _examples(cfg, preset, "train", cfg.shards, HELD_OUT),
        _examples(cfg, preset, "held_out", cfg.held_out, 0),
    )
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    torch.manual_seed(0)
    vae = StructureVae(preset.vae)
    train_structure_vae(
        vae,
        trained,
        cfg.folder / "vae",
        _loop(training.vae, cfg.minutes),
        batch=training.vae.batch,
        losses=training.losses,
        on_report=_say,
    )
    described = {"preset": cfg.preset, "objects": len(trained), "minutes": cfg.minutes}
    save_model(vae, cfg.folder / "model", described, "vae")
    vae.to(device)
    scores = score_reconstruction(vae, held_out)
    (cfg.folder / "reconstruction.json").write_text(json.dumps(scores, indent=1) + "\n")
    logger.info("held-out reconstruction %s", scores)
    flow = StructureFlow(preset.flow, preset.conditions)
    train_structure_flow(
        flow,
        encode_examples(vae, trained),
        trained,
        cfg.folder / "flow",
        _loop(training.flow, cfg.minutes),
        batch=training.flow.batch,
        conditions=preset.conditions,
        on_report=_say,
    )
    save_model(flow, cfg.folder / "model", described, "flow")
    return scores


def _examples(
    cfg: RunConfig, preset: StructurePreset, name: str, count: int, first_seed: int
) -> list[StructureExample]:
    shards = ShardConfig(
        first_seed=first_seed,
        objects=cfg.objects,
        resolution=preset.resolution,
        image_size=preset.conditions.image_size,
    )
    started = time.monotonic()
    paths = make_shards(
        cfg.folder / name,
        count,
        shards,
        workers=cfg.workers,
        on_done=lambda path: logger.info("%s after %.0f s", path.name, time.monotonic() - started),
    )
    return [example for path in paths for example in read_shard(path)]


def _loop(stage: StageConfig, minutes: float) -> LoopConfig:
    return LoopConfig(
        minutes=minutes * stage.share,
        learning_rate=stage.learning_rate,
        warmup=stage.warmup,
        decay=stage.decay,
        ema=stage.ema,
    )


def _say(line: Mapping[str, float]) -> None:
    logger.info(" ".join(f"{name}={value:.4g}" for name, value in line.items()))


def main() -> None:
    """Parses arguments with the standard library alone: training machines are bare."""
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(message)s", datefmt="%H:%M:%S")
    parser = argparse.ArgumentParser(prog="python -m artigen.train.everything", description=__doc__)
    parser.add_argument("folder", type=Path, help="run folder")
    parser.add_argument("--preset", choices=sorted(PRESETS), default="compact")
    parser.add_argument("--minutes", type=float, default=30.0, help="training time of both networks")
    parser.add_argument("--shards", type=int, default=100, help="shards of training data")
    parser.add_argument("--held-out", type=int, default=2, help="shards of held-out data")
    parser.add_argument("--objects", type=int, default=256, help="objects per shard")
    parser.add_argument("--workers", type=int, default=2, help="processes that make data")
    train_everything(RunConfig(**vars(parser.parse_args())))


if __name__ == "__main__":
    main()
