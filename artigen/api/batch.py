"""Runs over many objects: workers or machines, a progress bar, journals to resume from.

A journal in the output folder has one line per finished object, appended as it finishes: ``run.jsonl``, or
``run.03-of-64.jsonl`` for one part of a run. All journals of the folder count. A rerun with the same
settings, in other parts or as a whole, processes only objects that are missing or failed.
"""

import hashlib
import os
import re
import resource
import shutil
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Protocol, TypeVar

from tqdm import tqdm

from artigen.errors import ArtigenError
from artigen.runtime.journal import append_line, read_lines
from artigen.runtime.runner import Runner, run_jobs
from artigen.runtime.stopwatch import Stopwatch
from artigen.runtime.workers import Worker

Item = TypeVar("Item")

JOURNAL = "run.jsonl"


@dataclass(frozen=True, kw_only=True)
class Part:
    """The ``number``-th of ``total`` parts, counted from 1."""

    number: int
    total: int


def read_shard(text: str | None) -> Part | None:
    """Parses a part such as ``3/64``; None for the whole run.

    Raises:
        ArtigenError: If the text is not of the form K/N with K from 1 to N.
    """
    if text is None:
        return None
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    part = Part(number=int(found[1]), total=int(found[2])) if found else None
    if part is None or not 1 <= part.number <= part.total:
        raise ArtigenError(f"shard {text!r}: expected K/N with K from 1 to N, such as 3/64")
    return part


def take_part(items: Sequence[Item], part: Part | None) -> Sequence[Item]:
    """Every ``total``-th item; the parts are disjoint and together contain all items."""
    return items if part is None else items[part.number - 1 :: part.total]


def name_part(path: Path, part: Part | None) -> Path:
    """File name of a part: ``run.jsonl`` becomes ``run.03-of-64.jsonl``."""
    if part is None:
        return path
    width = len(str(part.total))
    return path.with_name(f"{path.stem}.{part.number:0{width}d}-of-{part.total}{path.suffix}")


class Job(Protocol):
    """One job of a batch."""

    @property
    def key(self) -> str:
        """Unique name of the object in this run; the name of its folder."""
        ...

    @property
    def settings(self) -> str:
        """Everything besides the source that determines the result, as text."""
        ...

    @property
    def out(self) -> Path:
        """Folder of all packages."""
        ...


JobType = TypeVar("JobType", bound=Job)


@dataclass(frozen=True, kw_only=True)
class Finished:
    """A line of the journal: the outcome for one object."""

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
    stopped: bool = False
    """Whether time or memory ran out, which says nothing about the object."""
    at: float = 0.0
    """Unix time of completion; the latest line of an object is valid."""

    @property
    def good(self) -> bool:
        """Whether the package was written and did not fail validation."""
        return self.error is None and self.passed is not False


@dataclass(frozen=True, kw_only=True)
class Made:
    """Time, memory and notes of one export."""

    seconds: tuple[tuple[str, float], ...]
    peak_mib: float
    notes: tuple[str, ...]


class Laps(Stopwatch):
    """Seconds of the stages of one export, by name."""

    def end(self, name: str, *inner: tuple[str, float]) -> None:
        """Ends the stage ``name``; with ``inner`` stages, which were timed elsewhere, these are listed."""
        self.lap(name)
        self.laps[-1:] = inner or self.laps[-1:]

    def made(self, notes: tuple[str, ...]) -> Made:
        """The stages so far, with the peak memory of this process."""
        peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        return Made(seconds=tuple(self.laps), peak_mib=peak_mib, notes=notes)


def digest_settings(text: str) -> str:
    """Short hash of settings; equal settings have equal hashes."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def read_journal(out: Path) -> dict[str, Finished]:
    """The latest line of every object in the journals of ``out``, those of parts included.

    A line truncated by a killed run is skipped, so its object is processed again.
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


def make_supervised(
    worker: Worker, job: JobType, make: Callable[[JobType], Made], timeout: float
) -> Finished:
    """Does one job in a supervised process."""
    settings = digest_settings(job.settings)
    outcome = worker.call(make, job, timeout)
    if outcome.value is None:
        return Finished(key=job.key, settings=settings, error=outcome.error, stopped=outcome.stopped)
    made = outcome.value
    return Finished(
        key=job.key, settings=settings, seconds=made.seconds, peak_mib=made.peak_mib, notes=made.notes
    )


def make_and_validate(
    worker: Worker, job: JobType, make: Callable[[JobType], Made], *, timeout: float, validation: bool
) -> Finished:
    """Makes one package and validates it (L0 to L3), both in a supervised process."""
    from envs.config import ValidateConfig
    from envs.validate import validate

    made = make_supervised(worker, job, make, timeout)
    if made.error is not None or not validation:
        return made
    before = time.perf_counter()
    report = validate(job.out / job.key, ValidateConfig(), worker)
    return replace(
        made,
        passed=report.passed,
        stopped=report.stopped,
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
    """Runs every job without a successful journal entry; returns all results in the order of ``jobs``.

    Args:
        handle: See `artigen.runtime.runner.run_jobs`.
        jobs: All jobs of the run.
        out: Folder of all packages and of the journals.
        runner: Where jobs are run.
        on_done: Called for every job of the part, first for those that were finished before.
        part: Part of the jobs to run; None for all.

    Raises:
        ArtigenError: If two jobs have the same name, or the output folder cannot be written.
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
    """Removes leftovers of killed runs for the packages ``keys``: ``.KEY.partial-*`` and ``.KEY.old-*``."""
    wanted = set(keys)
    for path in out.glob(".*"):
        name, _, rest = path.name[1:].rpartition(".")
        if name in wanted and rest.startswith(("partial-", "old-")):
            shutil.rmtree(path, ignore_errors=True)


def run_with_progress(
    handle: Callable[[Worker, JobType], Finished],
    jobs: Sequence[JobType],
    out: Path,
    *,
    runner: Runner,
    part: Part | None = None,
    unit: str = "object",
) -> list[Finished]:
    """`run_batch` with a progress bar in units of a job, and a line on stderr for every one that failed."""
    total = len(take_part(jobs, part))
    often = 0.1 if sys.stderr.isatty() else 30.0  # seconds; a log needs fewer lines than a terminal
    with tqdm(total=total, unit=unit, mininterval=often) as bar:

        def on_done(finished: Finished) -> None:
            bar.update()
            if not finished.good:
                said = finished.error or "; ".join(finished.failures)
                bar.write(f"{finished.key}: {said}", file=sys.stderr)

        return run_batch(handle, jobs, out, runner=runner, on_done=on_done, part=part)
