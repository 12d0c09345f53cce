"""Jobs as tasks of a real Ray cluster on this machine."""

import os
import signal
from pathlib import Path

import pytest

pytest.importorskip("ray", reason="Ray is an extra")

from artigen.errors import ArtigenError
from artigen.runtime.ray_runner import make_ray_runner
from artigen.runtime.runner import choose_runner, run_jobs
from artigen.runtime.workers import Outcome, Worker


def act(item: str) -> str:
    """In the supervised child: the item says what to do."""
    if item == "abort":
        os.abort()
    return item.upper()


def handle(worker: Worker, item: str) -> tuple[str, Outcome]:
    """In the Ray worker."""
    return item, worker.call(act, item, 60.0)


def handle_or_lose(worker: Worker, item: Path) -> str:
    """Kills its own Ray worker the first time it is called for an item."""
    if not item.exists():
        item.write_text("lost once")
        os.kill(os.getpid(), signal.SIGKILL)
    return worker.call(act, item.name, 60.0).value or ""


def refuse(worker: Worker, item: str) -> str:
    """What a handler raises is a fault of the run, not of an item."""
    raise ArtigenError(f"no {item}")


@pytest.fixture(scope="module")
def cluster():
    import ray

    ray.init(address="local", num_cpus=1, log_to_driver=False, include_dashboard=False)
    yield
    ray.shutdown()


@pytest.mark.slow
@pytest.mark.usefixtures("cluster")
def test_tasks_survive_their_neighbours_and_lost_workers(tmp_path: Path):
    runner = choose_runner("ray", 2)
    found = dict(run_jobs(handle, ["a", "abort", "b"], runner))
    assert {item: found[item].value for item in "ab"} == {"a": "A", "b": "B"}
    assert found["abort"].error == "the worker process died: signal SIGABRT"
    assert list(run_jobs(handle_or_lose, [tmp_path / "c"], runner)) == ["C"]
    with pytest.raises(ArtigenError, match="no d"):
        list(run_jobs(refuse, ["d"], runner))


def test_no_workers_are_refused():
    with pytest.raises(ArtigenError, match="0 workers"):
        make_ray_runner(0)
