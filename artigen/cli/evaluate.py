"""`artigen eval`: measures a trained model on held-out objects, beside retrieval and the training set."""

import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal

import tyro
from tqdm import tqdm

from artigen.cli.arguments import Out, Workers
from artigen.errors import ArtigenError
from artigen.runtime.cores import choose_workers
from artigen.weights import SHIPPED


@dataclass(frozen=True, kw_only=True)
class EvaluateSettings:
    """With what, and how many."""

    held_out: int = 70
    """Held-out procedural objects, categories in turn."""
    training: int = 350
    """Training objects that the baselines of structure look in."""
    partnet: Path | None = None
    """Folder with partnet_mobility/ and splits.json: its validation split is measured too."""
    steps: int = 6
    """Steps of the structure's sampler; appearance is drawn as the model's preset says."""
    strength: float = 0.0
    """Guidance; 0 is none."""
    seed: int = 0
    """Of the noise."""
    packages: int = 14
    """Held-out objects whose draws of structure by counts and size are exported and checked (L0 to L3); 0
    skips that."""
    redraws: int = 3
    """How often such an object is drawn again where its package fails."""
    pictured: int = 14
    """Draws by category that nearest.png shows beside their nearest training objects."""


@dataclass(frozen=True, kw_only=True)
class AppearanceViews:
    """What only appearance asks for."""

    states: int = 5
    """Joint states, from closed to the limits."""
    views: int = 8
    """Pictures of each state."""
    dinov2: Path | None = None
    """Folder with the weights of DINOv2, where the model or the distances between sets use it."""


def evaluate(
    what: tyro.conf.Positional[Literal["sketch", "structure", "appearance"]],
    out: Out,
    model: Path = SHIPPED,
    cfg: tyro.conf.OmitArgPrefixes[EvaluateSettings] = EvaluateSettings(),
    workers: Workers = None,
    appearance: tyro.conf.OmitArgPrefixes[AppearanceViews] = AppearanceViews(),
) -> int:
    """Measures a trained model and writes evaluation.json, evaluation.md and nearest.png.

    Objects that were drawn already are not drawn again when the same command is run again.

    Args:
        what: What to measure: the sketch network, the paper's latents within its boxes, or appearance.
        out: Folder for the results and the drawn objects.
        model: Folder of a trained model, model.json and its weights; left out, the one that ships.
        cfg: With what, and how many.
        workers: Processes that read real objects and make packages; left out, one per core that may be used.
        appearance: What only appearance asks for.
    """
    from artigen.cli.prove import prove_assets
    from artigen.metrics.asks import EvaluateConfig
    from artigen.metrics.evaluate import evaluate_sketch, evaluate_structure
    from artigen.metrics.report import write_report
    from artigen.models.rectified_flow import SamplerConfig

    if cfg.steps < 1 or cfg.strength < 0 or cfg.seed < 0:
        raise ArtigenError(
            f"{cfg.steps} steps, strength {cfg.strength:g}, seed {cfg.seed}: expected at least one step, and "
            "nothing below 0"
        )
    workers = choose_workers(workers)
    if what == "appearance":
        return _evaluate_appearance(out, model, cfg, appearance)
    settings = EvaluateConfig(
        held_out=cfg.held_out,
        training=cfg.training,
        sampler=SamplerConfig(steps=cfg.steps, strength=cfg.strength),
        seed=cfg.seed,
        partnet=cfg.partnet,
        packages=cfg.packages,
        redraws=cfg.redraws,
        pictured=cfg.pictured,
        workers=workers,
    )
    prove = partial(prove_assets, out=out / "packages", workers=workers)
    with tqdm(disable=not sys.stderr.isatty()) as bar:

        def on_progress(stage: str, done: int, total: int) -> None:
            bar.set_description(stage, refresh=False)
            bar.total, bar.n = total, done
            bar.refresh()

        if what == "sketch":
            evaluation = evaluate_sketch(model, out, settings, on_progress=on_progress)
        else:
            evaluation = evaluate_structure(model, out, settings, prove=prove, on_progress=on_progress)
    _, table = write_report(evaluation, out)
    sys.stdout.write(f"{table.read_text(encoding='utf-8')}\nwritten to {out}\n")
    return 0


def _evaluate_appearance(out: Path, model: Path, cfg: EvaluateSettings, own: AppearanceViews) -> int:
    from artigen.metrics.evaluate_appearance import EvaluateAppearanceConfig, evaluate_appearance
    from artigen.metrics.report_appearance import write_appearance_report

    settings = EvaluateAppearanceConfig(
        held_out=cfg.held_out,
        seed=cfg.seed,
        **vars(own),
    )
    with tqdm(disable=not sys.stderr.isatty()) as bar:

        def on_progress(stage: str, done: int, total: int) -> None:
            bar.set_description(stage, refresh=False)
            bar.total, bar.n = total, done
            bar.refresh()

        evaluation = evaluate_appearance(model, settings, on_progress=on_progress)
    _, table = write_appearance_report(evaluation, out)
    sys.stdout.write(f"{table.read_text(encoding='utf-8')}\nwritten to {out}\n")
    return 0
