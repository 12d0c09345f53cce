"""`artigen train appearance`: generates data, trains and stores weights.

Stages whose result is already in the run folder are skipped or resumed, so the same command can be repeated
after an interruption.
"""

import json
import logging

import torch
from torch import nn

from artigen.appearance.extractors import make_extractor
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.appearance.slat_flow import SlatFlow
from artigen.appearance.vae import APPEARANCE_FLOW, APPEARANCE_VAE, AppearanceVae
from artigen.errors import SourceError
from artigen.examples.appearance import (
    AppearanceExample,
    AppearanceShardConfig,
    make_appearance_shard,
    read_appearance_shard,
)
from artigen.examples.shards import HELD_OUT, make_shards
from artigen.io import write_whole
from artigen.metrics.appearance import score_vae
from artigen.models.store import save_model
from artigen.train.appearance.drawn import (
    DrawnShardConfig,
    DrawnVoxels,
    Resurface,
    make_drawn_shard,
    read_drawn_shard,
)
from artigen.train.appearance.flow import train_appearance_flow
from artigen.train.appearance.presets import APPEARANCE_TRAINING
from artigen.train.appearance.run import AppearanceRunConfig, AppearanceStage, claim_appearance_run
from artigen.train.appearance.vae import encode_appearance, train_appearance_vae
from artigen.train.stage import begin_stage, describe_stage, load_stage, plan_loop

logger = logging.getLogger(__name__)


def train_appearance(
    cfg: AppearanceRunConfig, stage: AppearanceStage = "appearance", *, resurface: Resurface | None = None
) -> dict[str, float]:
    """Runs the stages that are missing; returns the scores of the held-out objects.

    Args:
        stage: Both networks, or one of them; the flow needs a VAE in the same folder.
        resurface: Makes the surface of voxels that a structure model samples, as for a package; without it,
            the flow is trained on voxels as sampled.

    Raises:
        ArtigenError: If the configuration is invalid, or the folder lacks a stage or has other settings.
    """
    scores = cfg.home / "reconstruction.json"  # written when the VAE is done
    if stage == "appearance-flow" and not scores.is_file():
        raise SourceError(
            f"{scores}: there is no finished VAE to train a flow on; train appearance-vae first"
        )
    claim_appearance_run(cfg)
    make_extractor(cfg.extractor)  # rejects unfit weights before data is made
    trained = _examples(cfg, "train", cfg.shards, HELD_OUT)
    held_out = _examples(cfg, "held_out", cfg.held_out, 0)
    torch.manual_seed(0)
    vae = AppearanceVae(cfg.encoder, APPEARANCE_PRESETS[cfg.preset].decoder)
    if stage == "appearance-flow":
        load_stage(vae, cfg.home / "vae")
    else:
        _train_vae(cfg, vae, trained, held_out)
    if stage != "appearance-vae":
        _train_flow(cfg, vae, trained, resurface)
    return json.loads(scores.read_text())


def _train_vae(
    cfg: AppearanceRunConfig,
    vae: AppearanceVae,
    trained: list[AppearanceExample],
    held_out: list[AppearanceExample],
) -> None:
    training = APPEARANCE_TRAINING[cfg.preset]
    begin_stage(vae, cfg.start, APPEARANCE_VAE)
    train_appearance_vae(
        vae,
        trained,
        cfg.home / "vae",
        plan_loop(training.vae, cfg.minutes),
        batch=training.vae.batch,
        pictures=training.pictures,
        losses=training.losses,
    )
    _store(cfg, vae, APPEARANCE_VAE, cfg.shards * cfg.objects)
    scores = score_vae(vae, held_out)
    write_whole(cfg.home / "reconstruction.json", json.dumps(scores, indent=1) + "\n")
    logger.info("held-out reconstruction %s", scores)


def _train_flow(
    cfg: AppearanceRunConfig,
    vae: AppearanceVae,
    trained: list[AppearanceExample],
    resurface: Resurface | None,
) -> None:
    preset, training = APPEARANCE_PRESETS[cfg.preset], APPEARANCE_TRAINING[cfg.preset]
    drawn: list[DrawnVoxels] = []
    if preset.encoder.sided:
        shards = DrawnShardConfig(
            objects=cfg.objects,
            resolution=preset.encoder.resolution,
            image_size=0,
            timeout=3600.0,
            structure=cfg.structure,
            resurface=resurface,
        )
        paths = make_shards(cfg.home / "drawn", cfg.shards, shards, make_drawn_shard, workers=cfg.workers)
        drawn = [voxels for path in paths for voxels in read_drawn_shard(path)]
    torch.manual_seed(1)
    flow = begin_stage(SlatFlow(preset.flow, preset.conditions), cfg.start, APPEARANCE_FLOW)
    train_appearance_flow(
        flow,
        encode_appearance(vae, trained),
        trained,
        cfg.home / "flow",
        plan_loop(training.flow, cfg.minutes),
        batch=training.flow.batch,
        conditions=preset.conditions,
        noisiness=training.noisiness,
        drawn=drawn,
    )
    _store(cfg, flow, APPEARANCE_FLOW, cfg.shards * cfg.objects)


def _examples(cfg: AppearanceRunConfig, name: str, count: int, first_seed: int) -> list[AppearanceExample]:
    preset = APPEARANCE_PRESETS[cfg.preset]
    shards = AppearanceShardConfig(
        curation=cfg.curation,
        extractor=cfg.extractor,
        first_seed=first_seed,
        objects=cfg.objects,
        resolution=preset.encoder.resolution,
        image_size=preset.conditions.image_size,
    )
    paths = make_shards(cfg.home / name, count, shards, make_appearance_shard, workers=cfg.workers)
    return [example for path in paths for example in read_appearance_shard(path)]


def _store(cfg: AppearanceRunConfig, network: nn.Module, name: str, objects: int) -> None:
    """Stores a network with a description of its training data and steps."""
    described = {
        "preset": cfg.preset,
        "objects": objects,
        "articulated": cfg.articulated,
        "weighting": cfg.weighting,
        "features": cfg.features,
        **describe_stage(cfg.home / name.removeprefix("appearance-"), cfg.start, name),
    }
    save_model(network, cfg.folder / "model", described, name)
