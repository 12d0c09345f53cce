"""Supervised processes: what one item does never reaches another."""

import os
import signal
import threading
import time

import pytest

from artigen.errors import SourceError
from artigen.runtime.workers import InProcess, Outcome, Worker, run_supervised


def act(item: str) -> str:
    """The item says what to do."""
    if item == "abort":
        os.abort()
    if item == "exit":
        os._exit(7)
    if item == "hang":
        time.sleep(60)
    if item == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    if item == "memory":
        bytearray(2**62)
    if item == "tensor":
        raise RuntimeError("DefaultCPUAllocator: can't allocate memory: you tried to allocate 8 bytes.")
    if item == "raise":
        raise SourceError("mobility.urdf: joint 'joint_0' has no parent")
    if item == "bug":
        raise KeyError("oops")
    return item.upper()


def handle(worker: Worker, item: str) -> tuple[str, Outcome]:
    """Everything that may fail happens in the worker."""
    return item, worker.call(act, item, 3.0)


def tell_worker(worker: Worker, item: str) -> tuple[Worker, tuple[str, Outcome]]:
    """Also says which worker it was."""
    return worker, handle(worker, item)


@pytest.fixture(scope="module")
def outcomes() -> dict:
    items = ["a", "abort", "b", "raise", "exit", "hang", "bug", "kill", "memory", "tensor", "c"]
    return dict(run_supervised(handle, items, workers=2))


def test_good_items_survive_their_neighbours(outcomes):
    assert {item: outcomes[item].value for item in "abc"} == {"a": "A", "b": "B", "c": "C"}


@pytest.mark.parametrize(
    ("item", "sentence"),
    [
        ("abort", "the worker process died: signal SIGABRT"),
        ("exit", "the worker process died: exit code 7"),
        (
            "kill",
            "the worker process died: signal SIGKILL, which is what systems out of memory send; "
            "free some, or run fewer --workers",
        ),
        ("memory", "memory ran out; free some, or run fewer --workers"),
        ("tensor", "memory ran out; free some, or run fewer --workers"),
        ("hang", "took longer than 3 s and was stopped"),
        ("raise", "mobility.urdf: joint 'joint_0' has no parent"),
        ("bug", "KeyError: 'oops'"),
    ],
)
def test_each_failure_is_one_sentence(outcomes, item, sentence):
    assert outcomes[item].value is None
    assert outcomes[item].error == sentence
    assert outcomes[item].stopped == (item in ("kill", "memory", "tensor", "hang"))


def test_in_process_only_unexpected_errors_are_raised_with_their_traceback():
    worker = InProcess()
    assert worker.call(act, "a", 0.0).value == "A"
    assert worker.call(act, "raise", 1.0).error == "mobility.urdf: joint 'joint_0' has no parent"
    with pytest.raises(KeyError, match="oops") as caught:
        worker.call(act, "bug", 1.0)
    assert any(entry.name == "act" for entry in caught.traceback)


def test_a_worker_is_replaced_after_a_crash():
    worker = Worker()
    try:
        assert worker.call(act, "abort", 10.0).error is not None
        assert worker.call(act, "fine", 10.0).value == "FINE"
    finally:
        worker.close()


def test_what_the_handler_itself_raises_ends_the_run():
    def broken(worker: Worker, item: int) -> int:
        raise ZeroDivisionError(item)

    with pytest.raises(ZeroDivisionError):
        list(run_supervised(broken, [1, 2], workers=1))


def test_a_run_that_is_left_stops_what_is_under_way_and_starts_nothing_more():
    calls = []

    def twice(worker: Worker, item: str) -> str | None:
        for _ in range(2):
            calls.append(worker.call(act, item, 30.0).error)
        return calls[-1]

    run = run_supervised(twice, ["a", "hang", "hang"], workers=2)
    next(run)
    started = time.monotonic()
    run.close()
    while len(calls) < 4 and time.monotonic() - started < 10.0:
        time.sleep(0.05)
    assert calls[-1] == "the run was stopped"
    assert time.monotonic() - started < 10.0


def test_many_threads_may_close_a_worker():
    worker, errors = Worker(), []
    assert worker.call(act, "fine", 10.0).value == "FINE"
    process, start = worker._process, threading.Barrier(8)

    def close() -> None:
        start.wait()
        try:
            worker.close()
        except OSError as error:
            errors.append(error)

    threads = [threading.Thread(target=close) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors
    assert process is not None
    assert not process.is_alive()


def test_a_worker_that_is_there_already_is_used_first_and_closed():
    for items in (["a"], []):
        first = Worker()
        assert first.call(act, "fine", 10.0).value == "FINE"
        process = first._process
        assert process is not None
        used = list(
            run_supervised(lambda worker, item: (worker, handle(worker, item)), items, workers=2, first=first)
        )
        assert used == [(first, (item, Outcome(value=item.upper()))) for item in items]
        assert not process.is_alive()
