"""Training of a model, from one description of data and time for all of them."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal

from artigen.errors import ArtigenError
from artigen.train.settings import TrainSettings


@dataclass(frozen=True, kw_only=True)
class AppearanceSettings:
    """Settings of appearance only."""

    articulated: bool = True
    """Render objects in all joint states, or closed only (as many pictures)."""
    weighting: Literal["seen", "plain"] = "seen"
    """Views that count for the features of a voxel: those that see it, or all."""
    features: Literal["pyramid", "dinov2"] = "pyramid"
    """Image features."""
    dinov2: Path | None = None
    """Folder with the weights of DINOv2, for --features dinov2."""
    structure: Path | None = None
    """Folder of a structure model whose samples the flow is trained on besides true voxels; without one, true
    voxels are perturbed instead."""


@dataclass(frozen=True, kw_only=True)
class ReaderSettings:
    """Settings of the reader only."""

    photos: Path | None = None
    """Folder of marked photographs: labels.json and images. Without one, rendered views alone are used."""
    trunk: Path | None = None
    """ImageNet weights of EfficientNet-Lite2; default: those of the package that artigen[reader] installs."""
    render_on: Literal["cpu", "cuda"] = "cpu"
    """Device that renders views; the worker processes share it."""


Generator = Literal[
    "sketch",
    "structure",
    "structure-vae",
    "structure-flow",
    "structure-decoder",
    "appearance",
    "appearance-vae",
    "appearance-flow",
]
What = Literal["reader"] | Generator


def prepare_training(
    what: What,
    run: Path,
    cfg: TrainSettings,
    workers: int,
    appearance: AppearanceSettings | None = None,
    reader: ReaderSettings | None = None,
) -> Callable[[], dict[str, float]]:
    """The function that trains a model and returns its scores of held-out objects.

    Args:
        what: The model, or one of its networks.
        run: Folder for data, checkpoints, metrics and weights.
        cfg: What to train, on which data and for how long.
        workers: Worker processes that generate data.
        appearance: Settings of appearance only.
        reader: Settings of the reader only.

    Raises:
        ArtigenError: If a setting does not apply to the model.
    """
    if what == "reader":
        return _prepare_reader(run, cfg, workers, reader or ReaderSettings())
    return _prepare(what, run, cfg, workers, appearance or AppearanceSettings())


def _prepare(
    what: Generator, run: Path, cfg: TrainSettings, workers: int, appearance: AppearanceSettings
) -> Callable[[], dict[str, float]]:
    """Builds the training function for the arguments."""
    given = {name: value for name, value in vars(cfg).items() if value is not None}
    if what == "sketch":
        return _prepare_sketch(run, cfg, workers)
    if what in ("appearance", "appearance-vae", "appearance-flow"):
        from artigen.train.appearance.everything import train_appearance
        from artigen.train.appearance.run import AppearanceRunConfig
        from sim_export.geometry.surface import sample_surface

        if cfg.partnet is not None:
            raise ArtigenError("appearance cannot be trained on real objects yet: omit --partnet")
        if cfg.trellis is not None or cfg.encoders is not None:
            raise ArtigenError("--trellis and --encoders apply to structure only; appearance has --dinov2")
        shared = {
            name: given[name]
            for name in ("preset", "minutes", "shards", "held_out", "objects", "start")
            if name in given
        }
        return partial(
            train_appearance,
            AppearanceRunConfig(folder=run, workers=workers, **shared, **vars(appearance)),
            what,
            resurface=sample_surface,
        )
    from artigen.train.everything import train_everything
    from artigen.train.run import RunConfig

    return partial(train_everything, RunConfig(folder=run, workers=workers, **given), what)


def _prepare_reader(
    run: Path, cfg: TrainSettings, workers: int, reader: ReaderSettings
) -> Callable[[], dict[str, float]]:
    """Builds the training function of the reader of photographs."""
    from artigen.train.reader import ReaderRunConfig, train_reader

    for name in ("partnet", "trellis", "encoders", "objects"):
        if getattr(cfg, name) is not None:
            raise ArtigenError(
                f"the reader is trained on views of the grammar and on photographs: omit --{name}"
            )
    shared = {name: getattr(cfg, name) for name in ("minutes", "shards", "start")}
    return partial(train_reader, ReaderRunConfig(folder=run, workers=workers, **shared, **vars(reader)))


def _prepare_sketch(run: Path, cfg: TrainSettings, workers: int) -> Callable[[], dict[str, float]]:
    """Builds the training function of the sketch network, which supports fewer options than the other
    models."""
    from artigen.train.sketch import SketchRunConfig, train_sketch

    for name in ("partnet", "trellis", "encoders", "objects"):
        if getattr(cfg, name) is not None:
            raise ArtigenError(f"the sketch network is trained on the grammar only: omit --{name}")
    shared = {name: getattr(cfg, name) for name in ("preset", "minutes", "shards", "start")}
    return partial(train_sketch, SketchRunConfig(folder=run, workers=workers, **shared))
