"""Exports and checks drawn assets (L0 to L3) in workers, for `artigen eval`."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from artigen.cli.batch import Finished, Laps, Made, make_and_validate
from artigen.runtime.runner import LocalRunner, run_jobs
from artigen.runtime.workers import Worker

if TYPE_CHECKING:
    from artigen.metrics.packages import Proof

TIMEOUT = 300.0
"""Time limit in seconds for exporting one object."""


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
