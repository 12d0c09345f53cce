"""`Objects`: many objects, each made when it is asked for."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from numbers import Integral
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, overload

from artigen.api.batch import Finished, run_with_progress
from artigen.api.object import Object, load
from artigen.errors import ArtigenError
from artigen.runtime.runner import LocalRunner, choose_runner, run_jobs
from artigen.runtime.workers import InProcess, Worker

Handle = Callable[[Worker, Any], Finished]
"""Makes the package of a job in a worker; its folder is named by the job."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Objects(Sequence[Object]):
    """A lazy sequence of objects: indexing makes one, iterating makes one after the other.

    With ``workers`` above 0, iterating and `export` use as many processes; a script then needs the usual
    ``if __name__ == "__main__":``.
    """

    jobs: tuple[Any, ...]
    make: Callable[[Any], Object]
    """Makes the object of a job in this process."""
    handle: Handle
    """Makes and validates the package of a job."""
    write: Handle
    """Makes the package of a job with the checks that ``make`` runs."""
    workers: int = 0

    def __len__(self) -> int:
        return len(self.jobs)

    @overload
    def __getitem__(self, index: int) -> Object: ...
    @overload
    def __getitem__(self, index: slice) -> "Objects": ...
    def __getitem__(self, index: int | slice) -> "Object | Objects":
        if isinstance(index, slice):
            return replace(self, jobs=self.jobs[index])
        return self.make(self.jobs[index])

    def __iter__(self) -> Iterator[Object]:
        """Makes the objects in their order.

        Raises:
            ArtigenError: If one of them cannot be made.
        """
        if self.workers == 0:
            yield from map(self.make, self.jobs)
            return
        scratch = TemporaryDirectory()
        jobs = [replace(job, out=Path(scratch.name)) for job in self.jobs]
        done: dict[str, Finished] = {}
        waiting = [job.key for job in jobs]
        for finished in run_jobs(self.write, jobs, LocalRunner(workers=self.workers)):
            done[finished.key] = finished
            while waiting and waiting[0] in done:
                yield open_made(done.pop(waiting.pop(0)), scratch)

    def __repr__(self) -> str:
        return (
            f"<{len(self)} objects: {', '.join(job.key for job in self.jobs[:3])}{', ...' * (len(self) > 3)}>"
        )

    def export(self, folder: Path | str, *, workers: int | None = None) -> list[Finished]:
        """Writes and validates a package of every object below a folder, with a journal.

        Objects that are there already, of the same settings and without failures, are kept.

        Args:
            folder: Folder of the packages and the journal ``run.jsonl``.
            workers: Number of processes; default: as stated for the sequence.

        Returns:
            What became of each object: its ``error``, or whether it ``passed`` and its ``failures``.

        Raises:
            ArtigenError: If two objects have one name, or the folder cannot be written.
        """
        jobs = [replace(job, out=Path(folder)) for job in self.jobs]
        runner = choose_runner("local", self.workers if workers is None else workers)
        return run_with_progress(self.handle, jobs, Path(folder), runner=runner)


def make_here(job: Any, handle: Handle) -> Object:
    """Makes the object of one job in this process, in a temporary folder that lives as long as the object.

    Raises:
        ArtigenError: If it cannot be made.
    """
    scratch = TemporaryDirectory()
    return open_made(handle(InProcess(), replace(job, out=Path(scratch.name))), scratch)


def open_made(finished: Finished, scratch: "TemporaryDirectory[str]") -> Object:
    """The object of a package that was made in a temporary folder.

    Raises:
        ArtigenError: If it was not made.
    """
    if finished.error is not None:
        raise ArtigenError(finished.error)
    return load(Path(scratch.name) / finished.key, scratch=scratch)


def list_seeds(seed: int | Sequence[int], count: int | None) -> Sequence[int]:
    """The seeds of a sequence: those given, or ``count`` consecutive ones from ``seed`` on.

    Raises:
        ArtigenError: If there are to be fewer than one.
    """
    if count is not None and count < 1:
        raise ArtigenError(f"{count} objects: expected at least one")
    if not isinstance(seed, int | Integral):
        return tuple(map(int, seed))
    seed = int(seed)
    return range(seed, seed + (1 if count is None else count))
