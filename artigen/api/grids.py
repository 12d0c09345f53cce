"""Objects rebuilt from voxels, on finer grids while their package fails validation."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol, TypeVar

from artigen.api.batch import Finished, Job, Made, make_and_validate
from artigen.runtime.workers import Worker

GRIDS = (64, 96, 128)
"""Cells along the longest edge of the grids from which an object is rebuilt, until its package passes."""


class GridJob(Job, Protocol):
    """A job that makes a package from voxels."""

    @property
    def grid(self) -> int:
        """Cells along the longest edge."""
        ...


GridJobType = TypeVar("GridJobType", bound=GridJob)


def make_on_grids(
    worker: Worker,
    jobs: Sequence[GridJobType],
    make: Callable[[GridJobType], Made],
    *,
    timeout: float,
    validation: bool,
) -> Finished:
    """Makes and validates one object from the first of its ``jobs``, and from each next one while it fails.

    The last package that could be made stays; if none could, the first error does.

    Args:
        worker: Supervised process in which packages are made.
        jobs: The same object on one grid or more, the coarsest first.
        make: Makes a package; see `make_and_validate`.
        timeout: Time limit in seconds for one stage of one attempt.
        validation: Whether packages are validated; otherwise the first that can be made is good.
    """
    finished = make_and_validate(worker, jobs[0], make, timeout=timeout, validation=validation)
    for job in jobs[1:]:
        if finished.good or finished.stopped:
            break
        tried = make_and_validate(worker, job, make, timeout=timeout, validation=validation)
        if tried.error:
            said = f"not made from {job.grid}^3 voxels: {tried.error}"
            notes = finished.notes if tried.error == finished.error else (*finished.notes, said)
            finished = replace(finished, notes=notes)
        else:
            failed = finished.error or "; ".join(finished.failures)
            said = f"made from {job.grid}^3 voxels, as coarser ones fail: {failed}"
            finished = replace(tried, notes=(*tried.notes, said))
    return finished
