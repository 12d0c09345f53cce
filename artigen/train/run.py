"""Configuration and folder of a structure training run."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from artigen.errors import ArtigenError, name_options
from artigen.examples.real import list_split
from artigen.latent.presets import PRESETS
from artigen.latent.structure_dit import StructureDitConfig
from artigen.models.conditions import ConditionConfig
from artigen.models.description import hash_model, read_description
from artigen.models.public_encoders import find_encoders
from artigen.runtime.journal import claim_folder
from artigen.train.settings import TrainSettings

Stage = Literal["structure", "structure-vae", "structure-flow", "structure-decoder"]
"""All networks, or one of them."""


@dataclass(frozen=True, kw_only=True)
class RunConfig(TrainSettings):
    """One structure training run, from data to weights."""

    folder: Path
    """Folder for data, checkpoints and weights."""
    objects: int = 256
    """Objects per shard."""
    workers: int = 2
    """Processes that make data."""


def claim_run(cfg: RunConfig) -> None:
    """Checks a configuration and claims its folder; writes nothing if a check fails.

    Minutes and workers may change from one start to the next.

    Raises:
        ArtigenError: If a number is out of range, the preset is unknown, real objects are requested but
            missing, or the folder was started with other settings.
    """
    if cfg.preset not in PRESETS:
        raise ArtigenError(f"preset {cfg.preset!r}, expected {name_options(cfg.preset, PRESETS)}")
    if not cfg.minutes > 0 or min(cfg.shards, cfg.held_out, cfg.objects) < 1 or cfg.workers < 0:
        raise ArtigenError(
            f"{cfg.minutes:g} minutes, {cfg.shards} + {cfg.held_out} shards of {cfg.objects} objects, "
            f"{cfg.workers} workers: expected more than 0 of each, and no fewer than 0 workers"
        )
    if not 0 < cfg.real_share < 1:
        raise ArtigenError(f"share of real objects {cfg.real_share:g}, expected between 0 and 1")
    if cfg.start is not None and cfg.trellis is not None:
        raise ArtigenError(f"the flow cannot start from both {cfg.start} and {cfg.trellis}; give one")
    if cfg.trellis is not None and not isinstance(PRESETS[cfg.preset].flow, StructureDitConfig):
        raise ArtigenError(f"{cfg.trellis}: preset {cfg.preset!r} has another flow than TRELLIS; train paper")
    if cfg.partnet is not None:
        list_split(cfg.partnet, "train")
    claim_folder(
        cfg.folder / "config.json",
        {
            "preset": cfg.preset,
            "shards": cfg.shards,
            "held_out": cfg.held_out,
            "objects": cfg.objects,
            "real_share": None if cfg.partnet is None else cfg.real_share,
            "start": claim_start(cfg.start, cfg.preset),
            "trellis": None if cfg.trellis is None else cfg.trellis.name,
            "encoders": None if cfg.encoders is None else " and ".join(find_encoders(cfg.encoders)),
        },
    )


def run_conditions(cfg: RunConfig) -> ConditionConfig:
    """Conditions of a run's examples: pictures and sentences only where an encoder reads them."""
    conditions = PRESETS[cfg.preset].conditions
    found = () if cfg.encoders is None else find_encoders(cfg.encoders)
    if conditions.dino is not None and "image" not in found:
        conditions = replace(conditions, image_size=0)
    if conditions.clip is not None and "text" not in found:
        conditions = replace(conditions, clip=None)
    return conditions


def claim_start(start: Path | None, preset: str) -> str | None:
    """Hash of the model that a run starts from; None if it starts from none.

    Raises:
        ArtigenError: If there is no such model, or one of its networks has another preset.
    """
    if start is None:
        return None
    for name, entry in read_description(start).items():
        if entry.get("preset") != preset:
            raise ArtigenError(
                f"{start}: {name} has the sizes of preset {entry.get('preset')!r}, but the run has those of "
                f"{preset!r}; use the former preset, or leave --start out"
            )
    return hash_model(start)
