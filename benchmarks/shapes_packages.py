"""Runs every check on packages of procedural objects, exact and rebuilt from voxels.

    python benchmarks/shapes_packages.py --count 200 --out out/shapes_packages

Resumable: a second run makes what is missing or failed. Writes ``packages.md``: pass rates, counts of failed
checks, and every failed object with the reasons.
"""

import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import tyro
from tqdm import tqdm

from artigen.api.batch import Finished, run_batch
from artigen.api.sample import ShapeJob, ShapeSettings, export_and_validate
from artigen.kind import kinds
from artigen.runtime.runner import choose_runner

Source = Literal["reference", "voxels"]


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    out: Path = Path("out/shapes_packages")
    """Folder for packages, journals and the table."""
    category: tuple[str, ...] = ()
    """Categories; all by default."""
    source: tuple[Source, ...] = ("reference", "voxels")
    """Exact primitives, or rebuilt from 64^3 voxels."""
    count: int = 200
    """Objects per category."""
    first: int = 0
    """Seed of the first object."""
    workers: int | None = None
    """Number of processes; default: one per core."""


def run_source(options: Options, source: Source) -> list[Finished]:
    """Exports and validates all objects from one source."""
    names = options.category or tuple(kinds())
    out = options.out / source
    jobs = [
        ShapeJob(category=name, seed=seed, out=out, cfg=ShapeSettings(source=source))
        for name in names
        for seed in range(options.first, options.first + options.count)
    ]
    with tqdm(total=len(jobs), desc=source, disable=not sys.stderr.isatty()) as bar:

        def show(_: Finished) -> None:
            bar.update()

        runner = choose_runner("local", options.workers)
        return run_batch(export_and_validate, jobs, out, runner=runner, on_done=show)


def failed_checks(finished: Finished) -> list[str]:
    """Ids of the failed checks, or the reason why there is no package."""
    if finished.error is not None:
        return ["no package"]
    return sorted({failure.split()[0] for failure in finished.failures})


def describe(results: list[Finished], source: Source) -> list[str]:
    """Two tables as Markdown lines."""
    names = sorted({finished.key.rpartition("_")[0] for finished in results})
    checks = sorted({check for finished in results for check in failed_checks(finished)})
    head = ["category", "objects", "pass everything", *checks, "s each, export / validation"]
    lines = [f"## {source}", "", "| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for name in names:
        own = [finished for finished in results if finished.key.rpartition("_")[0] == name]
        counts = Counter(check for finished in own for check in failed_checks(finished))
        passed = sum(bool(finished.passed) for finished in own)
        seconds = [dict(finished.seconds) for finished in own if finished.error is None]
        export = np.mean([sum(v for k, v in s.items() if k != "validate") for s in seconds] or [0.0])
        tried = np.mean([s.get("validate", 0.0) for s in seconds] or [0.0])
        cells = [name, str(len(own)), f"{passed} ({passed / len(own):.1%})"]
        cells += [str(counts[check]) for check in checks]
        lines.append("| " + " | ".join([*cells, f"{export:.1f} / {tried:.1f}"]) + " |")
    lines += ["", "| object | failed |", "|---|---|"]
    for finished in results:
        if not finished.good:
            said = finished.error or "; ".join(finished.failures)
            lines.append(f"| {finished.key} | {said} |")
    return [*lines, ""]


def main(options: Options) -> int:
    """Runs everything and writes the tables."""
    lines: list[str] = []
    good = True
    for source in options.source:
        results = run_source(options, source)
        good &= all(finished.good for finished in results)
        lines += describe(results, source)
    (options.out / "packages.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
