"""`artigen train structure`: generates data, trains, evaluates and stores weights.

Stages whose result is already in the run folder are skipped or resumed, so the same command can be repeated
after an interruption, or with a larger budget.
"""

import json
import logging
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from artigen.errors import SourceError
from artigen.examples.real import real_examples
from artigen.examples.shards import HELD_OUT, ShardConfig, make_shards
from artigen.examples.structure import StructureExample, make_shard, read_shard
from artigen.io import write_whole
from artigen.latent.presets import PRESETS, StructurePreset
from artigen.latent.structure_flow import StructureFlow
from artigen.latent.structure_vae import StructureVae
from artigen.metrics.structure import score_reconstruction, score_spread
from artigen.models.public_encoders import attach_encoders
from artigen.models.store import save_model
from artigen.models.tensors import load_strictly
from artigen.train.decoder import train_decoder
from artigen.train.loop import finished_steps
from artigen.train.presets import TRAINING
from artigen.train.run import RunConfig, Stage, claim_run, run_conditions
from artigen.train.stage import begin_stage, describe_stage, load_stage, plan_loop
from artigen.train.structure import encode_examples, train_structure_flow, train_structure_vae
from artigen.trellis.checkpoints import load_trellis

logger = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True, eq=False)
class RunData:
    """Examples for training and for evaluation."""

    trained: list[StructureExample]
    held_out: list[StructureExample]
    real: int
    """Number of real objects among the training examples."""


def train_everything(cfg: RunConfig, stage: Stage = "structure") -> dict[str, float]:
    """Runs the stages that are missing; returns the scores of the held-out objects.

    Args:
        stage: All networks, or one of them; the flow needs a VAE in the same folder, the decoder both.

    Raises:
        ArtigenError: If the configuration is invalid, or the folder lacks a stage or has other settings.
    """
    scores = cfg.folder / "reconstruction.json"  # written when the VAE is done
    if stage in ("structure-flow", "structure-decoder") and not scores.is_file():
        raise SourceError(f"{scores}: there is no finished VAE to train a flow on; train structure-vae first")
    flow_weights = cfg.folder / "flow" / "weights.safetensors"
    if stage == "structure-decoder" and not flow_weights.is_file():
        raise SourceError(f"{flow_weights}: there is no trained flow; train structure-flow first")
    claim_run(cfg)
    data = make_data(cfg)
    if stage in ("structure", "structure-vae"):
        train_vae(cfg, data)
    if stage in ("structure", "structure-flow", "structure-decoder"):
        vae = load_vae(cfg)
        latents = encode_examples(vae, data.trained)
        if stage != "structure-decoder":
            train_flow(cfg, latents, data)
        if stage != "structure-flow":
            tune_decoder(cfg, vae, latents, data)
    return json.loads(scores.read_text()) if scores.is_file() else {}


def make_data(cfg: RunConfig) -> RunData:
    """Makes missing examples and reads all."""
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


def train_vae(cfg: RunConfig, data: RunData) -> StructureVae:
    """Trains the VAE, stores it, and writes its reconstruction scores on held-out objects."""
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
    )
    _store_vae(cfg, vae, data)
    return vae


def load_vae(cfg: RunConfig) -> StructureVae:
    """The VAE that the run has trained, in full precision, before the tuning of its decoder.

    Raises:
        SourceError: If its weights are damaged or of another preset.
    """
    return load_stage(StructureVae(PRESETS[cfg.preset].vae), cfg.folder / "vae")


def train_flow(cfg: RunConfig, latents: tuple[Tensor, Tensor], data: RunData) -> StructureFlow:
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
    )
    _store(cfg, data, flow, "flow")
    return flow


def tune_decoder(cfg: RunConfig, vae: StructureVae, latents: tuple[Tensor, Tensor], data: RunData) -> None:
    """Trains the decoder on the flow's estimates, stores and scores it, if the preset includes this stage."""
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
    )
    _store_vae(cfg, vae, data)


def _store_vae(cfg: RunConfig, vae: StructureVae, data: RunData) -> None:
    """Stores a VAE, and writes its reconstruction scores on held-out objects."""
    _store(cfg, data, vae, "vae")
    scores = score_reconstruction(vae, data.held_out)
    spread = score_spread(vae, data.held_out)
    for name, values in (("reconstruction", scores), ("spread", spread)):
        write_whole(cfg.folder / f"{name}.json", json.dumps(values, indent=1) + "\n")
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
    paths = make_shards(cfg.folder / name, count, shards, make_shard, workers=cfg.workers)
    return [example for path in paths for example in read_shard(path)]


def _store(cfg: RunConfig, data: RunData, network: nn.Module, name: str) -> None:
    """Stores a network with a description of its training data and steps."""
    described = {
        "preset": cfg.preset,
        "objects": cfg.shards * cfg.objects,
        "real_objects": data.real,
        **describe_stage(cfg.folder / name, cfg.start, name),
    }
    tuning = finished_steps(cfg.folder / "decoder") if name == "vae" else 0
    save_model(network, cfg.folder / "model", described | ({"decoder_steps": tuning} if tuning else {}), name)
