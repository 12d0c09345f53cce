"""Rebuilds an object from voxels, on finer grids while its package fails."""

from collections.abc import Callable
from dataclasses import replace

from artigen.cli.batch import Finished, JobType, Made, make_and_validate
from artigen.runtime.workers import Worker

GRIDS = (64, 96, 128)
"""Cells along the longest edge of the grids from which an object is rebuilt, until its package passes."""


def make_on_grids(
    worker: Worker,
    on_grid: Callable[[int], JobType],
    make: Callable[[JobType], Made],
    *,
    timeout: float,
    validation: bool,
) -> Finished:
    """Makes and validates packages on `GRIDS` until one passes; a note says why coarser ones do not count.

    If none passes, the last one that could be made is kept.

    Args:
        worker: The process that works.
        on_grid: The job on a grid.
        make: Writes the package of a job.
        timeout: Time limit in seconds for one stage on one grid.
        validation: Whether packages are validated; otherwise one that can be made counts as passing.
    """
    finished = make_and_validate(worker, on_grid(GRIDS[0]), make, timeout=timeout, validation=validation)
    for grid in GRIDS[1:]:
        if finished.good:
            break
        tried = make_and_validate(worker, on_grid(grid), make, timeout=timeout, validation=validation)
        if tried.error is not None and finished.error is None:
            return replace(finished, notes=(*finished.notes, f"not made from {grid}^3 voxels: {tried.error}"))
        why = finished.error or "; ".join(finished.failures)
        note = f"made from {grid}^3 voxels, as coarser ones fail: {why}"
        finished = replace(tried, notes=(*tried.notes, note))
    return finished
