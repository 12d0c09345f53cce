"""`python -m artigen.train.everything`: generates data, trains, evaluates and stores weights.

Every stage is skipped or gone on with where the run folder already holds its result, so the same command
can be given again after an interruption, or in portions of a budget. `artigen train` is the same with a
progress bar.
"""

import argparse
import json
import logging
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import Tensor, nn

from artigen.errors import SourceError
from artigen.io import write_whole
from artigen.latent.presets import PRESETS, StructurePreset
from artigen.latent.structure_flow import StructureFlow
from artigen.latent.structure_vae import StructureVae
from artigen.metrics.structure import score_reconstruction, score_spread
from artigen.models.public_encoders import attach_encoders
from artigen.models.store import save_model
from artigen.models.tensors import load_strictly
from artigen.train.decoder import train_decoder
from artigen.train.examples import StructureExample
from artigen.train.loop import finished_steps
from artigen.train.presets import TRAINING
from artigen.train.real import real_examples
from artigen.train.run import RunConfig, Stage, claim_run, run_conditions
from artigen.train.shards import HELD_OUT, ShardConfig, make_shard, make_shards, read_shard
from artigen.train.stage import begin_stage, describe_stage, load_stage, log_metrics, plan_loop
from artigen.train.structure import encode_examples, train_structure_flow, train_structure_vae
from artigen.trellis.checkpoints import load_trellis

logger = logging.getLogger(__name__)
Report = Callable[[str, Mapping[str, float]], None]
"""Called with the network in training and a line of its metrics."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RunData:
    """Examples to train with, and examples to measure with."""

    trained: list[StructureExample]
    held_out: list[StructureExample]
    real: int
    """Real objects among the trained ones."""


def train_everything(
    cfg: RunConfig, stage: Stage = "structure", *, on_report: Report | None = None
) -> dict[str, float]:
    """Runs what is missing and returns the scores of the held-out objects.

    Args:
        cfg: The run.
        stage: All networks, or one of them; the flow needs a VAE in the same folder, the decoder both.
        on_report: Called with every line of metrics; logged when None.

    Raises:
        ArtigenError: If the configuration or the folder does not allow it.
    """
    scores = cfg.folder / "reconstruction.json"  # written when the VAE is done
    if stage in ("structure-flow", "structure-decoder") and not scores.is_file():
        raise SourceError(f"{scores}: there is no finished VAE to train a flow on; train structure-vae first")
    flow_weights = cfg.folder / "flow" / "weights.safetensors"
    if stage == "structure-decoder" and not flow_weights.is_file():
        raise SourceError(f"{flow_weights}: there is no flow that guesses; train structure-flow first")
    claim_run(cfg)
    report = on_report or log_metrics
    data = make_data(cfg)
    if stage in ("structure", "structure-vae"):
        train_vae(cfg, data, report)
    if stage in ("structure", "structure-flow", "structure-decoder"):
        vae = load_vae(cfg)
        latents = encode_examples(vae, data.trained)
        if stage != "structure-decoder":
            train_flow(cfg, latents, data, report)
        if stage != "structure-flow":
            tune_decoder(cfg, vae, latents, data, report)
    return json.loads(scores.read_text()) if scores.is_file() else {}


def make_data(cfg: RunConfig) -> RunData:
    """Makes the examples that are missing and reads all."""
    preset = PRESETS[cfg.preset]
    trained = _examples(cfg, preset, "train", cfg.shards, HELD_OUT)
    held_out = _examples(cfg, preset, "held_out", cfg.held_out, 0)
    if cfg.partnet is None:
        return RunData(trained=trained, held_out=held_out, real=0)
    real = real_examples(
        cfg.partnet,
        cfg.folder / "real",
        preset.resolution,
        image_size=run_conditions(cfg).image_size,
        workers=cfg.workers,
    )
    wanted = cfg.real_share / (1.0 - cfg.real_share) * len(trained)
    repeated = real * max(1, round(wanted / len(real)))
    logger.info("%d real objects, %d times among %d", len(real), len(repeated) // len(real), len(trained))
    return RunData(trained=[*trained, *repeated], held_out=held_out, real=len(real))


def train_vae(cfg: RunConfig, data: RunData, report: Report) -> StructureVae:
    """Trains the VAE, stores it, and writes how well it reconstructs held-out objects."""
    training = TRAINING[cfg.preset]
    torch.manual_seed(0)
    vae = begin_stage(StructureVae(PRESETS[cfg.preset].vae), cfg.start, "vae")
    train_structure_vae(
        vae,
        data.trained,
        cfg.folder / "vae",
        plan_loop(training.vae, cfg.minutes),
        batch=training.vae.batch,
        losses=training.losses,
        on_report=lambda line: report("VAE", line),
    )
    _store_vae(cfg, vae, data)
    return vae


def load_vae(cfg: RunConfig) -> StructureVae:
    """The VAE that the run has trained, in full precision, its decoder not yet tuned.

    Raises:
        SourceError: If its weights are damaged or of another preset.
    """
    return load_stage(StructureVae(PRESETS[cfg.preset].vae), cfg.folder / "vae")


def train_flow(
    cfg: RunConfig, latents: tuple[Tensor, Tensor], data: RunData, report: Report
) -> StructureFlow:
    """Trains the flow on the VAE's latents and stores it."""
    preset, training = PRESETS[cfg.preset], TRAINING[cfg.preset]
    torch.manual_seed(1)
    flow = begin_stage(StructureFlow(preset.flow, preset.conditions), cfg.start, "flow")
    if cfg.trellis is not None:
        load_strictly(flow.network, load_trellis(cfg.trellis).state_dict(), str(cfg.trellis))
    if cfg.encoders is not None:
        attach_encoders(flow, cfg.encoders)
    train_structure_flow(
        flow,
        latents,
        data.trained,
        cfg.folder / "flow",
        plan_loop(training.flow, cfg.minutes),
        batch=training.flow.batch,
        conditions=run_conditions(cfg),
        time_mean=training.time_mean,
        on_report=lambda line: report("flow", line),
    )
    _store(cfg, data, flow, "flow")
    return flow


def tune_decoder(
    cfg: RunConfig, vae: StructureVae, latents: tuple[Tensor, Tensor], data: RunData, report: Report
) -> None:
    """Trains the decoder on the flow's guesses, stores and measures it, where the preset says so."""
    preset, training = PRESETS[cfg.preset], TRAINING[cfg.preset]
    if training.decoder is None:
        return
    train_decoder(
        vae,
        load_stage(StructureFlow(preset.flow, preset.conditions), cfg.folder / "flow"),
        latents,
        data.trained,
        cfg.folder / "decoder",
        plan_loop(training.decoder, cfg.minutes),
        batch=training.decoder.batch,
        losses=training.losses,
        conditions=preset.conditions,
        on_report=lambda line: report("decoder", line),
    )
    _store_vae(cfg, vae, data)


def _store_vae(cfg: RunConfig, vae: StructureVae, data: RunData) -> None:
    """Stores a VAE, and writes how well it reconstructs held-out objects."""
    _store(cfg, data, vae, "vae")
    scores = score_reconstruction(vae, data.held_out)
    spread = score_spread(vae, data.held_out)
    for name, said in (("reconstruction", scores), ("spread", spread)):
        write_whole(cfg.folder / f"{name}.json", json.dumps(said, indent=1) + "\n")
    logger.info("held-out reconstruction %s", scores)


def _examples(
    cfg: RunConfig, preset: StructurePreset, name: str, count: int, first_seed: int
) -> list[StructureExample]:
    shards = ShardConfig(
        first_seed=first_seed,
        objects=cfg.objects,
        resolution=preset.resolution,
        image_size=run_conditions(cfg).image_size,
    )
    started = time.monotonic()
    paths = make_shards(
        cfg.folder / name,
        count,
        shards,
        make_shard,
        workers=cfg.workers,
        on_done=lambda path: logger.info("%s after %.0f s", path.name, time.monotonic() - started),
    )
    return [example for path in paths for example in read_shard(path)]


def _store(cfg: RunConfig, data: RunData, network: nn.Module, name: str) -> None:
    """Stores a network with what it was trained on and for how long."""
    described = {
        "preset": cfg.preset,
        "objects": cfg.shards * cfg.objects,
        "real_objects": data.real,
        **describe_stage(cfg.folder / name, cfg.start, name),
    }
    tuning = finished_steps(cfg.folder / "decoder") if name == "vae" else 0
    save_model(network, cfg.folder / "model", described | ({"decoder_steps": tuning} if tuning else {}), name)


def main() -> None:
    """Parses arguments with the standard library alone: training machines are bare."""
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(message)s", datefmt="%H:%M:%S")
    parser = argparse.ArgumentParser(prog="python -m artigen.train.everything", description=__doc__)
    parser.add_argument("folder", type=Path, help="run folder")
    parser.add_argument("--preset", choices=sorted(PRESETS), default="compact")
    parser.add_argument("--minutes", type=float, default=30.0, help="training time of all networks")
    parser.add_argument("--shards", type=int, default=100, help="shards of training data")
    parser.add_argument("--held-out", type=int, default=2, help="shards of held-out data")
    parser.add_argument("--objects", type=int, default=256, help="objects per shard")
    parser.add_argument("--partnet", type=Path, help="folder with real objects to mix in")
    parser.add_argument("--real-share", type=float, default=0.1, help="share of real objects")
    parser.add_argument(
        "--start", type=Path, help="folder of a model whose weights every network begins with"
    )
    parser.add_argument(
        "--trellis", type=Path, help="checkpoint of TRELLIS that the flow's network begins with"
    )
    parser.add_argument("--encoders", type=Path, help="folder with the public weights of DINOv2 and CLIP")
    parser.add_argument("--workers", type=int, default=2, help="processes that make data")
    train_everything(RunConfig(**vars(parser.parse_args())))


if __name__ == "__main__":
    main()
