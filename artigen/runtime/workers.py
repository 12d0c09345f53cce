"""Supervised worker processes: a failing item does not affect others.

Some libraries can abort the whole process (physics engines on a degenerate mesh, convex decomposition),
and any stage may hang. Items therefore run in spawned processes that are supervised: a crash or a timeout
becomes the outcome of that one item, and the process is replaced. Each process has the number of threads
that `artigen.runtime.cores` chooses, and ends with the process that started it. `InProcess` runs items
without supervision where they are called, to debug them.
"""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from queue import SimpleQueue
from typing import Generic, TypeVar

from artigen.errors import ArtigenError
from artigen.runtime.cores import start_pools, worker_environment

LESS_MEMORY = "free some, or run fewer --workers"
Item = TypeVar("Item")
Value = TypeVar("Value")
_STARTING = threading.Lock()
"""Held while this process has the environment of a child that is about to start."""


@dataclass(frozen=True, kw_only=True)
class Outcome(Generic[Value]):
    """A value, or one sentence with the reason why there is none."""

    value: Value | None = None
    error: str | None = None
    stopped: bool = False
    """Whether time or memory ran out, which says nothing about the item: another try may succeed."""


def _serve(connection: Connection) -> None:
    """Runs in the child: replies to each (function, item) with an outcome until the pipe closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles interrupts
    threading.Thread(target=_end_with_parent, daemon=True).start()
    start_pools(os.environ)
    while True:
        try:
            function, item = connection.recv()
        except EOFError:
            return
        try:
            connection.send(Outcome(value=function(item)))
        except ArtigenError as error:
            connection.send(Outcome(error=str(error)))
        except Exception as error:
            # The boundary of the process: any other exception is the outcome of this item, with its type.
            connection.send(Outcome(error=_explain(error), stopped=_lacks_memory(error)))


def _end_with_parent() -> None:
    """Ends this process as soon as its parent is gone, so that it does not disturb a resumed run."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)


def _explain(error: Exception) -> str:
    """One sentence; if memory ran out (a `RuntimeError` in PyTorch), with advice."""
    return f"memory ran out; {LESS_MEMORY}" if _lacks_memory(error) else f"{type(error).__name__}: {error}"


def _lacks_memory(error: Exception) -> bool:
    return isinstance(error, MemoryError) or "can't allocate memory" in str(error)


@contextmanager
def _environment(values: Mapping[str, str]) -> Iterator[None]:
    """Sets environment variables for children started in the block; libraries read them at load time."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


class Worker:
    """One supervised process, started on first use."""

    def __init__(self) -> None:
        self._process: BaseProcess | None = None
        self._connection: Connection | None = None
        self._closing = threading.Lock()
        self._retired = False

    def call(self, function: Callable[[Item], Value], item: Item, timeout: float) -> Outcome[Value]:
        """Runs ``function(item)`` in the process; failures there become outcomes, never exceptions.

        Args:
            function: Module-level function, so that the child can import it.
            item: Picklable argument.
            timeout: Seconds after which the process is stopped.
        """
        if self._retired:
            return Outcome(error="the run was stopped", stopped=True)
        connection = self._start()
        try:
            connection.send((function, item))
            if not connection.poll(timeout):
                self.close()
                return Outcome(error=f"took longer than {timeout:g} s and was stopped", stopped=True)
            return connection.recv()
        except (EOFError, OSError):  # of a process that died, or of a connection closed by another thread
            code = self._exit_code()
            self.close()
            said, killed = _explain_exit(code)
            return Outcome(error=f"the worker process died: {said}", stopped=killed)

    def close(self) -> None:
        """Ends the process; the next call starts another. Idempotent and thread-safe."""
        with self._closing:
            connection, process = self._connection, self._process
            self._process = self._connection = None
        if connection is not None:
            connection.close()
        if process is not None and process.is_alive():
            process.kill()
            process.join()

    def retire(self) -> None:
        """Ends the process for good: further calls fail."""
        self._retired = True
        self.close()

    def _start(self) -> Connection:
        if self._connection is None:
            context = multiprocessing.get_context("spawn")
            self._connection, child = context.Pipe()
            self._process = context.Process(target=_serve, args=(child,), daemon=False)
            with _STARTING, _environment(worker_environment(os.environ)):
                self._process.start()
            child.close()
        return self._connection

    def _exit_code(self) -> int | None:
        if self._process is None:
            return None
        self._process.join(timeout=5)
        return self._process.exitcode


def _explain_exit(code: int | None) -> tuple[str, bool]:
    """How a process ended, and whether the system killed it."""
    if code is None or code >= 0:
        return f"exit code {code}", False
    killed = -code == signal.SIGKILL
    advice = f", which is what systems out of memory send; {LESS_MEMORY}" if killed else ""
    return f"signal {signal.Signals(-code).name}{advice}", killed


class InProcess(Worker):
    """Runs items in the calling process, without time limits: unexpected exceptions have their traceback."""

    def call(self, function: Callable[[Item], Value], item: Item, timeout: float) -> Outcome[Value]:
        """As `Worker.call`, but only an `ArtigenError` becomes an outcome, and ``timeout`` does not count."""
        try:
            return Outcome(value=function(item))
        except ArtigenError as error:
            return Outcome(error=str(error))


def run_supervised(
    handle: Callable[[Worker, Item], Value],
    items: Iterable[Item],
    *,
    workers: int,
    first: Worker | None = None,
) -> Iterator[Value]:
    """Yields the result of ``handle`` for every item as it finishes, in no particular order.

    Once every item has been handled, all processes have ended when the iteration does.

    Args:
        handle: Called in a thread with a worker of its own. It calls the worker for everything that may
            fail, so that it has a result for every item. An exception from it ends the run.
        workers: Number of threads, each with one process.
        first: Running worker to use as the first one; retired at the end.
    """
    work = list(items)
    crew = [first or Worker(), *(Worker() for _ in range(workers - 1))]
    idle: SimpleQueue[Worker] = SimpleQueue()
    for worker in crew:
        idle.put(worker)

    def do(item: Item) -> Value:
        worker = idle.get()
        try:
            return handle(worker, item)
        finally:
            idle.put(worker)

    pool = ThreadPoolExecutor(workers)
    try:
        for done in as_completed([pool.submit(do, item) for item in work]):
            yield done.result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for worker in crew:
            worker.retire()
