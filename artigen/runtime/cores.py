"""Number of worker processes of a run and of threads per worker.

Every worker has one thread. Two processes of one thread use two cores better than one process of two
threads, since much of the work is single-threaded Python; a pool of threads waits for its slowest
member, so that one busy core slows all of them; and sums of floating-point numbers do not depend on
how many cores a machine has. ``OMP_NUM_THREADS`` in the environment goes before all of this.
"""

import math
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
"""What libraries read when they are loaded to size their pools of threads."""
CGROUPS = Path("/sys/fs/cgroup")
PEAK_MIB = 1500.0
"""Resident memory of a worker that draws, exports and checks objects, in MiB (see docs/reports/speed.md)."""
MEMORY_SHARE = 0.9
"""Part of the available memory that workers may use by default."""


MEMORY_VARIABLES = {"MALLOC_MMAP_THRESHOLD_": str(2**32), "MALLOC_TRIM_THRESHOLD_": str(2**32)}
"""Lets glibc keep freed memory for the next array instead of asking the kernel for pages again, which clears
each of them: a third of the time of `artigen generate`, for 6 % more resident memory."""


def worker_environment(environ: Mapping[str, str]) -> dict[str, str]:
    """The variables that a worker starts with; those that ``environ`` has already keep their values."""
    kept = {name: environ.get(name, value) for name, value in MEMORY_VARIABLES.items()}
    return thread_environment(environ) | kept


def thread_environment(environ: Mapping[str, str]) -> dict[str, str]:
    """The variables that give a worker one thread; those that ``environ`` has already keep their values.

    An ``OMP_NUM_THREADS`` of the user holds for every library that has no variable of its own set.
    """
    threads = environ.get("OMP_NUM_THREADS") or "1"
    return {name: environ.get(name) or threads for name in THREAD_VARIABLES}


def start_pools(environ: Mapping[str, str]) -> None:
    """Starts the thread pools that no variable sizes, with as many threads as ``environ`` gives the others.

    oneTBB, which manifold3d computes with, makes a thread for every core that the process may use at the time
    of its first task. Solids as small as ours gain nothing from them, and they spin while they wait: a tenth
    more processor time for `artigen convert` on two cores.

    Only Linux can hold a process to some of its cores.
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


def choose_workers(asked: int | None, *, peak_mib: float = PEAK_MIB) -> int:
    """The number of worker processes: what is asked for, else one per core that memory suffices for.

    Args:
        asked: What the user says; None leaves it to the machine.
        peak_mib: Largest resident memory of one worker, in MiB.

    Raises:
        ArtigenError: If fewer than one are asked for.
    """
    if asked is not None:
        if asked < 1:
            raise ArtigenError(
                f"{asked} workers: expected at least one; leave --workers out for one per core"
            )
        return asked
    cores, memory = count_cores(), available_mib()
    return cores if memory is None else max(1, min(cores, int(MEMORY_SHARE * memory / peak_mib)))


def count_cores() -> int:
    """The cores that this process may use: its affinity, and the CPU quota of its cgroups."""
    affinity = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(1, min([affinity, *(math.ceil(quota) for quota in _cpu_quotas(own_cgroups()))]))


def available_mib() -> float | None:
    """Memory that can be had without swapping, in MiB: of the machine and within the cgroups.

    None where the system does not say (it is not Linux).
    """
    amounts = _cgroup_memory(own_cgroups())
    for line in _lines(Path("/proc/meminfo")):
        if line.startswith("MemAvailable:"):
            amounts.append(1024.0 * float(line.split()[1]))
    return min(amounts) / 2**20 if amounts else None


def own_cgroups(
    listing: Path = Path("/proc/self/cgroup"), root: Path = CGROUPS
) -> tuple[tuple[str, Path], ...]:
    """The folders of the cgroups of this process and of those around them, innermost first.

    Each comes with its controller: ``""`` (all) for version 2, ``"cpu"`` or ``"memory"`` for version 1.
    In a container, where the path names a group that is not mounted, the root stands for it.
    """
    found: list[tuple[str, Path]] = []
    for line in _lines(listing):
        _, controllers, path = line.split(":", 2)
        for controller in {"", "cpu", "memory"} & set(controllers.split(",")):
            top = root / controller
            inner = top / path.strip().lstrip("/")
            around = [one for one in (inner, *inner.parents) if one.is_relative_to(top) and one.is_dir()]
            found += [(controller, one) for one in around or [top]]
    return tuple(found)


def _cpu_quotas(groups: tuple[tuple[str, Path], ...]) -> list[float]:
    """Cores that the groups may use, where they limit them."""
    quotas = []
    for controller, folder in groups:
        if controller == "memory":
            continue
        names = ("cpu.cfs_quota_us", "cpu.cfs_period_us") if controller else ("cpu.max",)
        words = " ".join(line for name in names for line in _lines(folder / name)).split()
        if len(words) == 2 and words[0] not in ("max", "-1"):
            quotas.append(float(words[0]) / float(words[1]))
    return quotas


def _cgroup_memory(groups: tuple[tuple[str, Path], ...]) -> list[float]:
    """Bytes that the groups have left, where they limit them; cached files count as free."""
    left = []
    for controller, folder in groups:
        if controller == "cpu":
            continue
        new = controller == ""
        limit = "".join(_lines(folder / ("memory.max" if new else "memory.limit_in_bytes")))
        used = "".join(_lines(folder / ("memory.current" if new else "memory.usage_in_bytes")))
        if not limit.isdecimal() or not used.isdecimal():
            continue
        name = "inactive_file" if new else "total_inactive_file"
        cached = sum(
            float(line.split()[1]) for line in _lines(folder / "memory.stat") if line.split()[0] == name
        )
        left.append(float(limit) - float(used) + cached)
    return left


def _lines(path: Path) -> list[str]:
    """The lines of a file of the kernel; none where it is not there or not ours to read."""
    try:
        return path.read_text().splitlines()
    except OSError:
        return []
