"""Runners for jobs: supervised processes on this machine, or tasks of a Ray cluster.

Both call the same function of a worker and a job for every job, and yield its results as they arrive.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol, TypeVar

from artigen.runtime.cores import choose_workers
from artigen.runtime.workers import InProcess, Worker, run_supervised

Job = TypeVar("Job")
Value = TypeVar("Value")
RunnerName = Literal["local", "ray"]


class Runner(Protocol):
    """Runs jobs in parallel."""

    def run(self, handle: Callable[[Worker, Job], Value], jobs: Sequence[Job]) -> Iterator[Value]:
        """Yields the result of ``handle`` for every job as it finishes, in no particular order."""
        ...

    def begin_with(self, worker: Worker) -> "Runner":
        """The same runner for one run; it uses a running worker of this machine if it can, and closes it."""
        ...


@dataclass(frozen=True, kw_only=True)
class LocalRunner:
    """Supervised processes on this machine."""

    workers: int
    """Number of processes; with 0, jobs run one after the other in this one."""
    first: Worker | None = None
    """A running worker to use as one of them; when None, all are started."""

    def run(self, handle: Callable[[Worker, Job], Value], jobs: Sequence[Job]) -> Iterator[Value]:
        """As `Runner.run`."""
        if self.workers == 0:
            worker = InProcess()
            return (handle(worker, job) for job in jobs)
        return run_supervised(handle, jobs, workers=self.workers, first=self.first)

    def begin_with(self, worker: Worker) -> "LocalRunner":
        """As `Runner.begin_with`."""
        if self.workers == 0:
            worker.close()
            return self
        return replace(self, first=worker)


def choose_runner(name: RunnerName = "local", workers: int | None = None) -> Runner:
    """A runner by name.

    Args:
        name: ``local``, or ``ray`` for the cluster that ``RAY_ADDRESS`` names or this machine belongs to;
            without one, a local cluster is started.
        workers: Number of concurrent jobs; 0 for none but this process, and None derives it from the machine
            or the cluster.

    Raises:
        ArtigenError: If there are no workers, or Ray is not installed.
    """
    if name == "local":
        return LocalRunner(workers=choose_workers(workers))
    from artigen.runtime.ray_runner import make_ray_runner

    return make_ray_runner(workers)


def run_jobs(handle: Callable[[Worker, Job], Value], jobs: Sequence[Job], runner: Runner) -> Iterator[Value]:
    """Yields the result of ``handle`` for every job as it finishes, in no particular order.

    Args:
        handle: Module-level function (or a ``partial`` of one) of a worker and a job. It calls the worker
            for everything that may fail and returns a result for every job. It may be called again for a
            job whose machine was lost, so it must be idempotent.
        jobs: Picklable values.
        runner: See `choose_runner`.
    """
    return runner.run(handle, jobs)
