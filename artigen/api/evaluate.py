"""Evaluation of a trained model; packages of what it drew are made and checked."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from artigen.api.batch import Finished, Laps, Made, make_and_validate
from artigen.errors import ArtigenError
from artigen.metrics.settings import AppearanceViews, EvaluateSettings
from artigen.runtime.runner import LocalRunner, run_jobs
from artigen.runtime.workers import Worker

if TYPE_CHECKING:
    from artigen.metrics.packages import Proof

TIMEOUT = 300.0
"""Time limit in seconds for exporting one object."""


def evaluate_model(
    what: Literal["sketch", "structure", "appearance"],
    out: Path,
    model: Path,
    cfg: EvaluateSettings,
    workers: int = 1,
    appearance: AppearanceViews | None = None,
) -> Path:
    """Evaluates a trained model; writes ``evaluation.json`` and ``evaluation.md``, and returns the latter.

    Args:
        what: The sketch network, the structure latents or appearance.
        out: Folder for the results and the drawn objects; those that were drawn before are used again.
        model: Folder of the model.
        cfg: Number of objects and sampler settings.
        workers: Processes that read real objects and make packages.
        appearance: Settings of appearance only.

    Raises:
        ArtigenError: If a number is out of its range, or the model cannot be read.
    """
    from artigen.metrics.asks import EvaluateConfig
    from artigen.metrics.evaluate import evaluate_sketch, evaluate_structure
    from artigen.metrics.report import write_report

    if cfg.steps < 1 or cfg.strength < 0 or cfg.seed < 0:
        raise ArtigenError(
            f"{cfg.steps} steps, strength {cfg.strength:g}, seed {cfg.seed}: expected at least one step, and "
            "nothing below 0"
        )
    if what == "appearance":
        return _evaluate_appearance(out, model, cfg, appearance or AppearanceViews())
    settings = EvaluateConfig(workers=workers, **vars(cfg))
    prove = partial(prove_assets, out=out / "packages", workers=workers)
    if what == "sketch":
        evaluation = evaluate_sketch(model, out, settings)
    else:
        evaluation = evaluate_structure(model, out, settings, prove=prove)
    return write_report(evaluation, out)[1]


def _evaluate_appearance(out: Path, model: Path, cfg: EvaluateSettings, own: AppearanceViews) -> Path:
    from artigen.metrics.evaluate_appearance import (
        EvaluateAppearanceConfig,
        evaluate_appearance,
        write_appearance_report,
    )

    settings = EvaluateAppearanceConfig(held_out=cfg.held_out, seed=cfg.seed, **vars(own))
    return write_appearance_report(evaluate_appearance(model, settings), out)[1]


@dataclass(frozen=True, kw_only=True)
class ProveJob:
    """Export of one asset folder to a package."""

    source: Path
    out: Path

    @property
    def key(self) -> str:
        """Name of the asset folder and of the package."""
        return self.source.name

    @property
    def settings(self) -> str:
        """Empty settings: the asset alone determines the result."""
        return self.key


def prove_assets(folders: Sequence[Path], *, out: Path, workers: int) -> "Iterator[Proof]":
    """Makes and checks the package of every asset folder; packages stay in ``out`` with their reports."""
    from artigen.metrics.packages import Proof, name_cause

    jobs = [ProveJob(source=folder, out=out) for folder in folders]
    for finished in run_jobs(_prove, jobs, LocalRunner(workers=workers)):
        causes = tuple(sorted({failure.split()[0] for failure in finished.failures}))
        if finished.error is not None:
            causes = (name_cause("no package", finished.error),)
        yield Proof(key=finished.key, passed=bool(finished.passed), causes=causes)


def export_drawn(job: ProveJob) -> Made:
    """Exports one asset and writes its package; runs in a worker process."""
    from artigen import __version__
    from artigen.io import read_asset
    from sim_export.export import export_asset
    from sim_export.files.write import write_package

    laps = Laps()
    provenance = {"generator": f"artigen {__version__} eval", "source": job.key}
    package = export_asset(read_asset(job.source), provenance=provenance).package
    write_package(package, job.out / job.key, "replace")
    laps.end("export")
    return laps.made(package.records)


def _prove(worker: Worker, job: ProveJob) -> Finished:
    return make_and_validate(worker, job, export_drawn, timeout=TIMEOUT, validation=True)
