"""Configuration and folder of an appearance training run."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from artigen.appearance.inputs import FeatureInputs
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.errors import ArtigenError, name_options
from artigen.latent.presets import PRESETS
from artigen.models.description import hash_model, read_description
from artigen.runtime.journal import claim_folder
from artigen.train.appearance.presets import APPEARANCE_TRAINING
from artigen.train.run import claim_start

AppearanceStage = Literal["appearance", "appearance-vae", "appearance-flow"]
"""Both networks, or one of them."""


@dataclass(frozen=True, kw_only=True)
class AppearanceRunConfig(FeatureInputs):
    """One appearance training run, from data to weights."""

    folder: Path
    """Folder with data and checkpoints in `appearance/`, weights in `model/`."""
    minutes: float = 30.0
    """Training time of both networks; making data takes additional time."""
    shards: int = 100
    """Shards of training data."""
    held_out: int = 2
    """Shards of held-out data."""
    objects: int = 16
    """Objects per shard."""
    start: Path | None = None
    """Folder of a model with the initial weights of every network."""
    structure: Path | None = None
    """Folder of the structure model that samples voxels for training the flow in addition to true ones;
    without one, roughened true voxels are used."""
    workers: int = 2
    """Processes that make data."""

    @property
    def home(self) -> Path:
        """Folder of data and checkpoints of the appearance model."""
        return self.folder / "appearance"


def claim_appearance_run(cfg: AppearanceRunConfig) -> None:
    """Checks a configuration and claims its folder; writes nothing if a check fails.

    Minutes and workers may change from one start to the next.

    Raises:
        ArtigenError: If a number is out of range, the preset cannot be trained, features lack their weights,
            or the folder was started with other settings.
    """
    if cfg.preset not in APPEARANCE_TRAINING:
        raise ArtigenError(f"preset {cfg.preset!r}, expected {name_options(cfg.preset, APPEARANCE_TRAINING)}")
    if not cfg.minutes > 0 or min(cfg.shards, cfg.held_out, cfg.objects, cfg.workers) < 1:
        raise ArtigenError(
            f"{cfg.minutes:g} minutes, {cfg.shards} + {cfg.held_out} shards of {cfg.objects} objects, "
            f"{cfg.workers} workers: expected more than 0 of each"
        )
    if (cfg.features == "dinov2") != (cfg.dinov2 is not None):
        raise ArtigenError(
            f"features {cfg.features} with weights of DINOv2 in {cfg.dinov2}: expected both or neither"
        )
    claim_folder(
        cfg.home / "config.json",
        {
            "preset": cfg.preset,
            "shards": cfg.shards,
            "held_out": cfg.held_out,
            "objects": cfg.objects,
            "articulated": cfg.articulated,
            "weighting": cfg.weighting,
            "features": cfg.features,
            "start": claim_start(cfg.start, cfg.preset),
            "structure": _claim_structure(cfg),
        },
    )


def _claim_structure(cfg: AppearanceRunConfig) -> str | None:
    """Hash of the structure model that samples voxels; None if there is none.

    Raises:
        ArtigenError: If there is no such model, it takes no outlines, or its resolution differs.
    """
    if cfg.structure is None:
        return None
    name = read_description(cfg.structure).get("flow", {}).get("preset")
    drawn = next((preset for key, preset in PRESETS.items() if key == name and preset.takes_outlines), None)
    wanted = APPEARANCE_PRESETS[cfg.preset].encoder.resolution
    if drawn is None or drawn.resolution != wanted:
        able = ", ".join(
            key for key, one in PRESETS.items() if one.takes_outlines and one.resolution == wanted
        )
        raise ArtigenError(
            f"{cfg.structure}: its structure is of preset {name!r}, but voxels of {wanted}^3 within outlines "
            f"need one of {able}; give such a model, or leave --structure out"
        )
    return hash_model(cfg.structure)
