"""Threads and workers: each worker has one thread, and there are as many as the machine has room for."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from artigen.errors import ArtigenError
from artigen.runtime import cores
from artigen.runtime.cores import (
    THREAD_VARIABLES,
    choose_workers,
    thread_environment,
)
from artigen.runtime.workers import Worker


def look(_: None) -> tuple[dict[str, str | None], int]:
    """In the child: its variables, and the threads that torch would use."""
    import torch

    return {name: os.environ.get(name) for name in THREAD_VARIABLES}, torch.get_num_threads()


def seen_by_a_worker() -> tuple[dict[str, str | None], int]:
    worker = Worker()
    try:
        value = worker.call(look, None, 60.0).value
        assert value is not None
        return value
    finally:
        worker.close()


def test_a_worker_has_one_thread_and_the_environment_here_stays(monkeypatch: pytest.MonkeyPatch):
    for name in THREAD_VARIABLES:
        monkeypatch.delenv(name, raising=False)
    before = dict(os.environ)
    variables, threads = seen_by_a_worker()
    assert set(variables.values()) == {"1"}
    assert threads == 1
    assert dict(os.environ) == before


def count_threads(_: None) -> tuple[int, int, int]:
    """Threads of this process before and after booleans of large solids, and the cores that it may use."""
    import manifold3d

    before = len(list(Path("/proc/self/task").iterdir()))
    ball = manifold3d.Manifold.sphere(1.0, 256)
    (ball - ball.translate((0.5, 0.0, 0.0))).volume()
    return before, len(list(Path("/proc/self/task").iterdir())), len(os.sched_getaffinity(0))


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="only Linux holds a process to a core")
def test_booleans_in_a_worker_start_no_threads_and_leave_its_cores(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    worker = Worker()
    try:
        before, after, cores = worker.call(count_threads, None, 60.0).value or (0, 1, 0)
    finally:
        worker.close()
    assert after == before
    assert cores == len(os.sched_getaffinity(0))


def test_omp_num_threads_of_the_user_holds_for_all_that_have_no_variable_set():
    told = {"OMP_NUM_THREADS": "3", "MKL_NUM_THREADS": "2"}
    given = thread_environment(told)
    assert given["MKL_NUM_THREADS"] == "2"
    assert {value for name, value in given.items() if name != "MKL_NUM_THREADS"} == {"3"}


@pytest.mark.parametrize(
    ("cores_there", "mib", "expected"),
    [(8, None, 8), (8, 100_000.0, 8), (8, 3000.0, 3), (8, 2999.0, 2), (8, 10.0, 1), (1, 100_000.0, 1)],
)
def test_workers_are_one_per_core_that_memory_suffices_for(
    monkeypatch: pytest.MonkeyPatch, cores_there: int, mib: float | None, expected: int
):
    monkeypatch.setattr(cores, "count_cores", lambda: cores_there)
    monkeypatch.setattr(cores, "available_mib", lambda: mib)
    monkeypatch.setattr(cores, "PEAK_MIB", 1000.0 * cores.MEMORY_SHARE)
    assert choose_workers(None) == expected
    assert choose_workers(5) == 5


def test_less_than_no_workers_are_refused():
    assert choose_workers(0) == 0
    with pytest.raises(ArtigenError, match="-1 workers: expected 0 or more"):
        choose_workers(-1)


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="affinity is Linux's")
def test_cores_are_those_of_the_affinity():
    one = min(os.sched_getaffinity(0))
    code = (
        f"import os; os.sched_setaffinity(0, {{{one}}})\n"
        "from artigen.runtime import cores; print(cores.count_cores())"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "1"


def write(folder: Path, **files: str) -> None:
    for name, text in files.items():
        (folder / name.replace("__", ".")).write_text(text + "\n")


def test_memory_is_what_the_container_has_left_besides_cached_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    mib = 2**20
    monkeypatch.setattr(cores, "CGROUP", tmp_path)
    write(
        tmp_path,
        memory__max=str(300 * mib),
        memory__current=str(250 * mib),
        memory__stat=f"anon {200 * mib}\ninactive_file {40 * mib}",
    )
    assert cores.available_mib() == pytest.approx(90.0)


def test_without_a_limit_the_memory_of_the_machine_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(cores, "CGROUP", tmp_path / "none")
    free = cores.available_mib()
    monkeypatch.setattr(cores, "CGROUP", tmp_path)
    write(tmp_path, memory__max="max", memory__current="1", memory__stat="anon 1")
    assert cores.available_mib() == (None if free is None else pytest.approx(free, rel=0.2))
