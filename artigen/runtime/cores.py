"""Number of worker processes of a run and of threads per worker.

Every worker has one thread, for three reasons. Much of the work is single-threaded Python, so two
processes of one thread use two cores better than one process of two threads. A pool of threads waits for
its slowest member, so one busy core slows all of them. And sums of floating-point numbers do not depend
on the number of cores. ``OMP_NUM_THREADS`` in the environment takes precedence.
"""

import os
from collections.abc import Mapping
from pathlib import Path

from artigen.errors import ArtigenError

THREAD_VARIABLES = (
    "OMP_NUM_THREADS",  # PyTorch, CoACD, scikit-learn
    "OPENBLAS_NUM_THREADS",  # NumPy and SciPy of PyPI
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)
"""Variables that libraries read at load time to size their thread pools."""
CGROUP = Path("/sys/fs/cgroup")
"""The control group that a container sees as its own."""
PEAK_MIB = 1500.0
"""Resident memory of a worker that draws, exports and checks objects, in MiB (see docs/reports/speed.md)."""
MEMORY_SHARE = 0.9
"""Share of the available memory that workers may use by default."""
MEMORY_VARIABLES = {"MALLOC_MMAP_THRESHOLD_": str(2**32), "MALLOC_TRIM_THRESHOLD_": str(2**32)}
"""Lets glibc keep freed memory for the next array. Otherwise the kernel clears new pages each time, which
takes a third of the time of `artigen generate`. Resident memory grows by 6 %."""


def worker_environment(environ: Mapping[str, str]) -> dict[str, str]:
    """Environment variables for a worker; those already in ``environ`` keep their values."""
    kept = {name: environ.get(name, value) for name, value in MEMORY_VARIABLES.items()}
    return thread_environment(environ) | kept


def thread_environment(environ: Mapping[str, str]) -> dict[str, str]:
    """Environment variables that give a worker one thread; those already in ``environ`` keep their values.

    ``OMP_NUM_THREADS`` in ``environ`` applies to every library without a variable of its own.
    """
    threads = environ.get("OMP_NUM_THREADS") or "1"
    return {name: environ.get(name) or threads for name in THREAD_VARIABLES}


def start_pools(environ: Mapping[str, str]) -> None:
    """Starts the thread pools that no variable sizes, with as many threads as ``environ`` gives the others.

    oneTBB, which manifold3d uses, creates a thread for every core that the process may use at the time of its
    first task. Small solids gain nothing from these threads, which spin while they wait and cost `artigen
    convert` a tenth more processor time on two cores.

    Does nothing except on Linux, which alone can restrict a process to some of its cores.
    """
    if not hasattr(os, "sched_setaffinity"):
        return
    import manifold3d

    asked = thread_environment(environ)["OMP_NUM_THREADS"].split(",")[0].strip()
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, sorted(cores)[: max(1, int(asked)) if asked.isdecimal() else 1])
    try:
        cube = manifold3d.Manifold.cube((1.0, 1.0, 1.0))
        (cube - cube.translate((0.5, 0.5, 0.5))).volume()
    finally:
        os.sched_setaffinity(0, cores)


def choose_workers(asked: int | None) -> int:
    """Number of worker processes: the requested one, else one per core as far as memory suffices.

    Args:
        asked: Requested number, 0 for no process of its own; None derives it from the machine.

    Raises:
        ArtigenError: If fewer than none are requested.
    """
    if asked is not None:
        if asked < 0:
            raise ArtigenError(
                f"{asked} workers: expected 0 or more, where 0 runs everything in this process; leave "
                "--workers out for one per core"
            )
        return asked
    cores, memory = count_cores(), available_mib()
    return cores if memory is None else max(1, min(cores, int(MEMORY_SHARE * memory / PEAK_MIB)))


def count_cores() -> int:
    """Number of cores that this process may use, by its affinity and the CPU quota of its cgroup."""
    from joblib import cpu_count

    return cpu_count()


def available_mib() -> float | None:
    """Memory available without swapping, in MiB: on the machine, and within a limit of the container.

    None if the system does not report it (other than Linux).
    """
    amounts = [
        1024.0 * float(line.split()[1])
        for line in _lines(Path("/proc/meminfo"))
        if line.startswith("MemAvailable:")
    ]
    limit, used = ("".join(_lines(CGROUP / name)) for name in ("memory.max", "memory.current"))
    if limit.isdecimal() and used.isdecimal():
        facts = dict(line.split() for line in _lines(CGROUP / "memory.stat"))
        amounts.append(float(limit) - float(used) + float(facts.get("inactive_file", 0)))  # cached files
    return min(amounts) / 2**20 if amounts else None


def _lines(path: Path) -> list[str]:
    """Lines of a kernel file; none if it is missing or not readable."""
    try:
        return path.read_text().splitlines()
    except OSError:
        return []
