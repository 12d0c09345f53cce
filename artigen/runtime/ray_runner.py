"""Jobs as tasks of a Ray cluster (`pip install "artigen[ray]"`).

As in a local run, a task calls its job's function with a supervised child process of the Ray worker, so
that a library that aborts costs one object and not the Ray worker. If Ray loses a worker or a machine, it
repeats the task elsewhere. All machines need artigen installed and the output folder at the same path (a
shared file system).
"""

import logging
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import islice
from typing import Any, TypeVar

from artigen.errors import ArtigenError
from artigen.runtime.workers import Worker

# Ray is an optional extra that may be missing where types are checked.
# pyright: reportMissingImports=false

Job = TypeVar("Job")
Value = TypeVar("Value")
AHEAD = 2
"""Tasks in flight per core of the cluster: one running, one queued."""
RETRIES = 20
"""Retries of a task whose worker or machine was lost."""
WAIT = 5.0
"""Seconds between queries of the cluster's number of cores."""


@dataclass(frozen=True, kw_only=True)
class RayRunner:
    """Runs jobs as tasks of one core each on the cluster that this process is connected to."""

    in_flight: int | None = None
    """Most tasks submitted to Ray at a time; None for `AHEAD` per core of the cluster."""

    def run(self, handle: Callable[[Worker, Job], Value], jobs: Sequence[Job]) -> Iterator[Value]:
        """As `artigen.runtime.runner.Runner.run`; jobs are submitted as others finish.

        Raises:
            ArtigenError: If the workers of a job were lost at every retry; raised after all other jobs.
        """
        import ray
        from ray.exceptions import OutOfMemoryError, RayTaskError, WorkerCrashedError

        task = ray.remote(num_cpus=1, max_retries=RETRIES)(_do)
        function = ray.put(handle)
        waiting = iter(jobs)
        flying: dict[Any, Job] = {}
        lost: list[str] = []
        try:
            while True:
                room = self._limit() - len(flying)
                flying |= {task.remote(function, job): job for job in islice(waiting, max(room, 0))}
                if not flying:
                    break
                for done in ray.wait(list(flying), num_returns=1, timeout=WAIT)[0]:
                    job = flying.pop(done)
                    try:
                        value = ray.get(done)
                    except RayTaskError as error:
                        raise error.cause from error
                    except (WorkerCrashedError, OutOfMemoryError) as error:
                        lost.append(f"{getattr(job, 'key', job)} ({type(error).__name__})")
                        continue
                    yield value
        finally:
            for reference in flying:
                ray.cancel(reference)
        if lost:
            raise ArtigenError(
                f"Ray lost the workers of {len(lost)} jobs {RETRIES + 1} times each: {', '.join(lost[:10])}; "
                "see the logs of Ray for the reason, then run the same command again"
            )

    def begin_with(self, worker: Worker) -> "RayRunner":
        """As `artigen.runtime.runner.Runner.begin_with`; closes the worker, because Ray has its own."""
        worker.close()
        return self

    def _limit(self) -> int:
        """Most tasks in flight now; queried each time, because the cluster may grow."""
        import ray

        if self.in_flight is not None:
            return self.in_flight
        return max(1, AHEAD * int(ray.cluster_resources().get("CPU", 1)))


def make_ray_runner(workers: int | None) -> RayRunner:
    """Connects to the cluster that ``RAY_ADDRESS`` names or this machine belongs to, or starts one here.

    Raises:
        ArtigenError: If fewer than one worker is requested, or Ray is not installed or not reachable.
    """
    if workers is not None and workers < 1:
        raise ArtigenError(
            f"{workers} workers: expected at least one; leave --workers out to use the whole cluster"
        )
    try:
        import ray
    except ImportError as error:
        raise ArtigenError('Ray is not installed; run pip install "artigen[ray]"') from error
    if not ray.is_initialized():
        try:
            ray.init(log_to_driver=False, logging_level=logging.WARNING)
        except ConnectionError as error:
            raise ArtigenError(f"no Ray cluster is reachable: {error}") from error
    return RayRunner(in_flight=workers)


def _do(handle: Callable[[Worker, Job], Value], job: Job) -> Value:
    """Runs one job in the supervised child of this Ray worker."""
    return handle(_own_worker(), job)


@cache
def _own_worker() -> Worker:
    """The supervised child of this process, reused by all tasks."""
    # Spawned children import the script of their parent, which for a Ray worker only loads Ray.
    script = sys.modules["__main__"]
    script.__spec__ = None
    vars(script).pop("__file__", None)
    return Worker()
