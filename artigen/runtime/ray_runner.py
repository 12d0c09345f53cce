"""Jobs as tasks of a Ray cluster (`pip install "artigen[ray]"`).

A task calls its job's function with a supervised child process of the Ray worker, as a local run does,
so that a library that aborts costs one object and not the Ray worker. Where Ray loses a worker or a
machine, it does the task again elsewhere. All machines need artigen installed and the output folder
at the same path (a shared file system).
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

# Ray is an extra, which may not be installed where types are checked.
# pyright: reportMissingImports=false

Job = TypeVar("Job")
Value = TypeVar("Value")
AHEAD = 2
"""Tasks in flight per core of the cluster: one at work, one that its worker can go on with at once."""
RETRIES = 20
"""How often a task is done again whose worker or machine was lost."""
WAIT = 5.0
"""Seconds after which the cluster is asked again how many cores it has."""


@dataclass(frozen=True, kw_only=True)
class RayRunner:
    """Tasks of one core each on the cluster that this process is connected to."""

    in_flight: int | None = None
    """Tasks handed to Ray at one time; None for `AHEAD` per core of the cluster."""

    def run(self, handle: Callable[[Worker, Job], Value], jobs: Sequence[Job]) -> Iterator[Value]:
        """As `artigen.runtime.runner.Runner.run`; jobs are handed out as others finish.

        Raises:
            ArtigenError: After all others are done, if the workers of a job were lost again and again.
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
                "look at the logs of Ray for what ended them, then run the same command again"
            )

    def begin_with(self, worker: Worker) -> "RayRunner":
        """As `artigen.runtime.runner.Runner.begin_with`; jobs have workers of their own where they run."""
        worker.close()
        return self

    def _limit(self) -> int:
        """Tasks that may be in flight now; the cluster may have grown."""
        import ray

        if self.in_flight is not None:
            return self.in_flight
        return max(1, AHEAD * int(ray.cluster_resources().get("CPU", 1)))


def make_ray_runner(workers: int | None) -> RayRunner:
    """Connects to the cluster that ``RAY_ADDRESS`` names or this machine belongs to, or starts one here.

    Raises:
        ArtigenError: If fewer than one worker are asked for, or Ray is not installed or not reached.
    """
    if workers is not None and workers < 1:
        raise ArtigenError(f"{workers} workers: expected at least one, or none said for all of the cluster")
    try:
        import ray
    except ImportError as error:
        raise ArtigenError('Ray is not installed; run pip install "artigen[ray]"') from error
    if not ray.is_initialized():
        try:
            ray.init(log_to_driver=False, logging_level=logging.WARNING)
        except ConnectionError as error:
            raise ArtigenError(f"no Ray cluster is reached: {error}") from error
    return RayRunner(in_flight=workers)


def _do(handle: Callable[[Worker, Job], Value], job: Job) -> Value:
    """The task: one job, in the supervised child of this Ray worker."""
    return handle(_own_worker(), job)


@cache
def _own_worker() -> Worker:
    """The supervised child of this process, kept from task to task."""
    # Spawned children run the script of their parent again. That of a Ray worker only loads Ray.
    script = sys.modules["__main__"]
    script.__spec__ = None
    vars(script).pop("__file__", None)
    return Worker()
