"""Both sides of the limits of runs: memory of a worker, and tasks under way on a cluster."""

import sys
from collections.abc import Sequence
from types import ModuleType, SimpleNamespace

import pytest

from artigen.runtime import cores
from artigen.runtime.cores import choose_workers
from artigen.runtime.ray_runner import RayRunner
from artigen.runtime.workers import Worker


@pytest.mark.parametrize(("mib", "workers"), [(3280.0, 1), (3390.0, 2), (16_600.0, 9), (16_700.0, 10)])
def test_a_worker_takes_1500_mib_of_nine_tenths_of_the_memory(
    monkeypatch: pytest.MonkeyPatch, mib: float, workers: int
):
    monkeypatch.setattr(cores, "count_cores", lambda: 64)
    monkeypatch.setattr(cores, "available_mib", lambda: mib)
    assert choose_workers(None) == workers


def repeat(_: Worker, job: str) -> str:
    return job


def test_two_tasks_are_under_way_for_each_core_of_a_cluster(monkeypatch: pytest.MonkeyPatch):
    """A cluster of three cores, in this process: the task that is waited for first is done first."""
    under_way: list[list[str]] = []

    def wait(tasks: Sequence[str], **_: object) -> tuple[list[str], list[str]]:
        under_way.append(list(tasks))
        return [tasks[0]], list(tasks[1:])

    ray, exceptions = ModuleType("ray"), ModuleType("ray.exceptions")
    for name in ("OutOfMemoryError", "RayTaskError", "WorkerCrashedError"):
        setattr(exceptions, name, type(name, (Exception,), {}))
    vars(ray).update(
        remote=lambda **_: lambda _: SimpleNamespace(remote=lambda _, job: job),
        put=lambda value: value,
        get=lambda task: task.upper(),
        wait=wait,
        cluster_resources=lambda: {"CPU": 3.0},
    )
    monkeypatch.setitem(sys.modules, "ray", ray)
    monkeypatch.setitem(sys.modules, "ray.exceptions", exceptions)
    assert list(RayRunner().run(repeat, list("abcdefgh"))) == list("ABCDEFGH")
    assert [len(tasks) for tasks in under_way] == [6, 6, 6, 5, 4, 3, 2, 1]
