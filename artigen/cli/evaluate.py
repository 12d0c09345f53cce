"""`artigen eval`: evaluates a trained model beside retrieval and the training set."""

import sys
from pathlib import Path
from typing import Literal

import tyro

from artigen.api.evaluate import evaluate_model
from artigen.cli.arguments import Out, Workers
from artigen.metrics.settings import AppearanceViews, EvaluateSettings
from artigen.runtime.cores import choose_workers
from artigen.weights import SHIPPED

EVALUATE, VIEWS = EvaluateSettings(), AppearanceViews()


def evaluate(
    what: tyro.conf.Positional[Literal["sketch", "structure", "appearance"]],
    out: Out,
    model: Path = SHIPPED,
    cfg: tyro.conf.OmitArgPrefixes[EvaluateSettings] = EVALUATE,
    workers: Workers = None,
    appearance: tyro.conf.OmitArgPrefixes[AppearanceViews] = VIEWS,
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
    table = evaluate_model(what, out, model, cfg, choose_workers(workers), appearance)
    sys.stdout.write(f"{table.read_text(encoding='utf-8')}\nwritten to {out}\n")
    return 0
