"""Runs over many objects: workers or machines, a progress bar, journals to resume from.

A journal in the output folder holds one line per finished object, written as it finishes: ``run.jsonl``,
or ``run.03-of-64.jsonl`` for the part of a run. All journals of the folder count, so a rerun with the same
settings, in other parts or as a whole, does only what is missing or failed before.
"""

import hashlib
import os
import shutil
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Protocol, TypeVar

from tqdm import tqdm

from artigen.cli.shard import Part, name_part, take_part
from artigen.errors import ArtigenError
from artigen.runtime.journal import append_line, read_lines
from artigen.runtime.runner import Runner, run_jobs
from artigen.runtime.workers import Worker

JOURNAL = "run.jsonl"


class Job(Protocol):
    """One job of a batch."""

    @property
    def key(self) -> str:
        """Unique name of the object in this run; the name of its folder."""
        ...

    @property
    def settings(self) -> str:
        """Everything besides the source that decides the result, as text."""
        ...

    @property
    def out(self) -> Path:
        """Folder of all packages."""
        ...


JobType = TypeVar("JobType", bound=Job)


@dataclass(frozen=True, kw_only=True)
class Finished:
    """A line of the journal: what became of one object."""

    key: str
    settings: str
    error: str | None = None
    passed: bool | None = None
    failures: tuple[str, ...] = ()
    seconds: tuple[tuple[str, float], ...] = ()
    peak_mib: float = 0.0
    notes: tuple[str, ...] = ()
    as_in_source: tuple[str, ...] = ()
    """Failed checks that the source fails as well, each with its evidence."""
    at: float = 0.0
    """Unix time when it was finished; of two lines of one object, the later one holds."""

    @property
    def good(self) -> bool:
        """Written, and not failed by validation."""
        return self.error is None and self.passed is not False


@dataclass(frozen=True, kw_only=True)
class Made:
    """Time, memory and notes of making one package."""

    seconds: tuple[tuple[str, float], ...]
    peak_mib: float
    notes: tuple[str, ...]


def digest_settings(text: str) -> str:
    """A short name for settings; equal settings have equal names."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def read_journal(out: Path) -> dict[str, Finished]:
    """The last line of every object in the journals of ``out``, those of parts included.

    A line cut short by a killed run is left out, so its object is done again.
    """
    name = Path(JOURNAL)
    done: dict[str, Finished] = {}
    for path in (out / name, *sorted(out.glob(f"{name.stem}.*-of-*{name.suffix}"))):
        for value in read_lines(path):
            value["seconds"] = tuple((name, spent) for name, spent in value["seconds"])
            value["failures"] = tuple(value["failures"])
            value["notes"] = tuple(value["notes"])
            value["as_in_source"] = tuple(value.get("as_in_source", ()))
            line = Finished(**value)
            if line.key not in done or done[line.key].at <= line.at:
                done[line.key] = line
    return done


def make_and_validate(
    worker: Worker, job: JobType, make: Callable[[JobType], Made], *, timeout: float, validation: bool
) -> Finished:
    """Makes one package and tries it (L0 to L3), both in a supervised process."""
    from envs.config import ValidateConfig
    from envs.validate import validate

    settings = digest_settings(job.settings)
    outcome = worker.call(make, job, timeout)
    if outcome.value is None:
        return Finished(key=job.key, settings=settings, error=outcome.error)
    made = Finished(
        key=job.key,
        settings=settings,
        seconds=outcome.value.seconds,
        peak_mib=outcome.value.peak_mib,
        notes=outcome.value.notes,
    )
    if not validation:
        return made
    before = time.perf_counter()
    report = validate(job.out / job.key, ValidateConfig(), worker)
    return replace(
        made,
        passed=report.passed,
        failures=tuple(f"{check.id} {check.where}: {check.message}" for check in report.failures),
        seconds=(*made.seconds, ("validate", time.perf_counter() - before)),
    )


def run_batch(
    handle: Callable[[Worker, JobType], Finished],
    jobs: Sequence[JobType],
    out: Path,
    *,
    runner: Runner,
    on_done: Callable[[Finished], None],
    part: Part | None = None,
) -> list[Finished]:
    """Runs every job that no journal knows as good; returns all, in the order of ``jobs``.

    Args:
        handle: See `artigen.runtime.runner.run_jobs`.
        jobs: All jobs of the run.
        out: Folder of all packages and of the journals.
        runner: Where jobs are done.
        on_done: Called for every job of the part, with those that were done before first.
        part: Of the jobs, the part to do; None for all.

    Raises:
        ArtigenError: Two jobs of one name, or an output folder that cannot be written.
    """
    twice = sorted(key for key, count in Counter(job.key for job in jobs).items() if count > 1)
    if twice:
        raise ArtigenError(
            f"several sources are called {', '.join(twice)}; convert them into different folders"
        )
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ArtigenError(f"cannot make the output folder {out}: {error.strerror}") from error
    if not os.access(out, os.W_OK):
        raise ArtigenError(f"the output folder {out} cannot be written; choose another with -o")
    jobs = take_part(jobs, part)
    done = read_journal(out)

    def is_done(job: JobType) -> bool:
        line = done.get(job.key)
        same = line is not None and line.settings == digest_settings(job.settings)
        return same and line is not None and line.good and (out / job.key).is_dir()

    results = {job.key: done[job.key] for job in jobs if is_done(job)}
    for finished in results.values():
        on_done(finished)
    waiting = [job for job in jobs if job.key not in results]
    remove_leftovers(out, {job.key for job in waiting})
    journal = name_part(out / JOURNAL, part)
    for finished in run_jobs(handle, waiting, runner):
        append_line(journal, asdict(replace(finished, at=time.time())))
        results[finished.key] = finished
        on_done(finished)
    return [results[job.key] for job in jobs]


def remove_leftovers(out: Path, keys: Iterable[str]) -> None:
    """Removes what killed runs have left of packages of ``keys``: ``.KEY.partial-*`` and ``.KEY.old-*``."""
    wanted = set(keys)
    for path in out.glob(".*"):
        name, _, rest = path.name[1:].rpartition(".")
        if name in wanted and rest.startswith(("partial-", "old-")):
            shutil.rmtree(path, ignore_errors=True)


def run_shown(
    handle: Callable[[Worker, JobType], Finished],
    jobs: Sequence[JobType],
    out: Path,
    *,
    runner: Runner,
    part: Part | None = None,
) -> list[Finished]:
    """`run_batch` with a progress bar, and a line on stderr for every object that failed."""
    total = len(take_part(jobs, part))
    with tqdm(total=total, unit="object", disable=not sys.stderr.isatty() and total > 1) as bar:

        def on_done(finished: Finished) -> None:
            bar.update()
            if not finished.good:
                said = finished.error or "; ".join(finished.failures)
                bar.write(f"{finished.key}: {said}", file=sys.stderr)

        return run_batch(handle, jobs, out, runner=runner, on_done=on_done, part=part)
