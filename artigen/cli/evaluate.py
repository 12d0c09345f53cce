"""`artigen eval`: evaluates a trained model beside retrieval and the training set."""

import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal

import tyro

from artigen.cli.arguments import Out, Workers
from artigen.errors import ArtigenError
from artigen.metrics.settings import EvaluateSettings
from artigen.runtime.cores import choose_workers
from artigen.weights import SHIPPED

EVALUATE = EvaluateSettings()


@dataclass(frozen=True, kw_only=True)
class AppearanceViews:
    """Settings of appearance only."""

    states: int = 5
    """Number of joint states, from closed to fully open."""
    views: int = 8
    """Number of pictures per state."""
    dinov2: Path | None = None
    """Folder with the weights of DINOv2, for models and set distances that use it."""


def evaluate(
    what: tyro.conf.Positional[Literal["sketch", "structure", "appearance"]],
    out: Out,
    model: Path = SHIPPED,
    cfg: tyro.conf.OmitArgPrefixes[EvaluateSettings] = EVALUATE,
    workers: Workers = None,
    appearance: tyro.conf.OmitArgPrefixes[AppearanceViews] = AppearanceViews(),
) -> int:
    """Evaluate a trained model; writes evaluation.json and evaluation.md.

    Running the same command again reuses the objects that were already drawn.

    Args:
        what: Model to evaluate: the sketch network, the structure latents or appearance.
        out: Output folder for the results and the drawn objects.
        model: Folder of a trained model (model.json and weights); default: the shipped one.
        cfg: Number of objects and sampler settings.
        workers: Worker processes that read real objects and make packages; default: one per available core.
        appearance: Settings of appearance only.
    """
    from artigen.cli.prove import prove_assets
    from artigen.metrics.asks import EvaluateConfig
    from artigen.metrics.evaluate import evaluate_sketch, evaluate_structure
    from artigen.metrics.report import write_report

    if cfg.steps < 1 or cfg.strength < 0 or cfg.seed < 0:
        raise ArtigenError(
            f"{cfg.steps} steps, strength {cfg.strength:g}, seed {cfg.seed}: expected at least one step, and "
            "nothing below 0"
        )
    workers = choose_workers(workers)
    if what == "appearance":
        return _evaluate_appearance(out, model, cfg, appearance)
    settings = EvaluateConfig(workers=workers, **vars(cfg))
    prove = partial(prove_assets, out=out / "packages", workers=workers)
    if what == "sketch":
        evaluation = evaluate_sketch(model, out, settings)
    else:
        evaluation = evaluate_structure(model, out, settings, prove=prove)
    _, table = write_report(evaluation, out)
    sys.stdout.write(f"{table.read_text(encoding='utf-8')}\nwritten to {out}\n")
    return 0


def _evaluate_appearance(out: Path, model: Path, cfg: EvaluateSettings, own: AppearanceViews) -> int:
    from artigen.metrics.evaluate_appearance import EvaluateAppearanceConfig, evaluate_appearance
    from artigen.metrics.report_appearance import write_appearance_report

    settings = EvaluateAppearanceConfig(held_out=cfg.held_out, seed=cfg.seed, **vars(own))
    _, table = write_appearance_report(evaluate_appearance(model, settings), out)
    sys.stdout.write(f"{table.read_text(encoding='utf-8')}\nwritten to {out}\n")
    return 0
