"""Seconds and memory for drawing one object, measured in a separate process."""

import statistics
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from artigen.errors import SegmentationError, SourceError
from artigen.latent.draw import GenerateConfig, generate_structure, load_structure_model
from artigen.models.conditions import StructureCondition
from artigen.runtime.workers import Worker
from artigen.types import Asset

TIMEOUT = 1800.0
REPEATS = 3
STATUS = Path("/proc/self/status")


@dataclass(frozen=True, kw_only=True)
class Footprint:
    """Time and memory of drawing one object, latent to parts."""

    seconds: float
    """Median of the repeats, after one warm-up draw."""
    cpu_seconds: float
    """The same in processor time of all threads, which depends less on the load of the machine."""
    peak_mib: float
    """Largest resident memory of the process, imports and model included."""


@dataclass(frozen=True, kw_only=True)
class FootprintJob:
    """Object to draw."""

    model: Path
    asked: StructureCondition
    boxes: Asset
    cfg: GenerateConfig


def measure_footprint(job: FootprintJob) -> Footprint:
    """Measures in a separate process.

    Raises:
        SourceError: If that process fails; gives the reason.
    """
    worker = Worker()
    outcome = worker.call(time_draws, job, TIMEOUT)
    worker.close()
    if outcome.value is None:
        raise SourceError(f"{job.model}: one object could not be timed: {outcome.error}")
    return outcome.value


def time_draws(job: FootprintJob) -> Footprint:
    """Times `REPEATS` draws after a warm-up; runs in a worker process."""
    model = load_structure_model(job.model)
    seconds, busy = [], []
    for seed in range(REPEATS + 1):
        started, worked = time.perf_counter(), time.process_time()
        with suppress(SegmentationError):  # quality is measured elsewhere
            generate_structure(model, job.asked, seed, job.cfg, boxes=job.boxes)
        seconds.append(time.perf_counter() - started)
        busy.append(time.process_time() - worked)
    return Footprint(
        seconds=statistics.median(seconds[1:]),
        cpu_seconds=statistics.median(busy[1:]),
        peak_mib=peak_memory(),
    )


def peak_memory() -> float:
    """Largest resident memory of this process so far in MiB, without that of its parent."""
    line = next(line for line in STATUS.read_text().splitlines() if line.startswith("VmHWM:"))
    return int(line.split()[1]) / 1024
