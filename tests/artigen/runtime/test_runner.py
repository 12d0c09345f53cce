"""Runs in parts and on runners: every job once, whatever is killed, in whatever parts."""

import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pytest

from artigen.api.batch import (
    Finished,
    Part,
    digest_settings,
    name_part,
    read_journal,
    read_shard,
    run_batch,
    take_part,
)
from artigen.errors import ArtigenError
from artigen.runtime.runner import LocalRunner, choose_runner, run_jobs
from artigen.runtime.workers import Worker


@dataclass(frozen=True, kw_only=True)
class Note:
    """A job that leaves a folder with a file."""

    key: str
    out: Path
    settings: str = "plain"


def write_note(job: Note) -> int:
    """In the child."""
    (job.out / job.key).mkdir(exist_ok=True)
    with (job.out / job.key / "times").open("a") as file:
        file.write("x")
    return os.getpid()


def do(worker: Worker, job: Note) -> Finished:
    outcome = worker.call(write_note, job, 60.0)
    return Finished(key=job.key, settings=digest_settings(job.settings), error=outcome.error, passed=True)


def notes(out: Path, count: int, settings: str = "plain") -> list[Note]:
    return [Note(key=f"n{number}", out=out, settings=settings) for number in range(count)]


def run(out: Path, jobs: list[Note], part: str | None = None) -> list[Finished]:
    return run_batch(
        do, jobs, out, runner=LocalRunner(workers=1), on_done=lambda _: None, part=read_shard(part)
    )


def times_done(out: Path) -> dict[str, int]:
    return {path.parent.name: len(path.read_text()) for path in out.glob("n*/times")}


@pytest.mark.parametrize("total", [1, 2, 3, 7, 20])
def test_parts_are_disjoint_and_together_the_whole(total: int):
    items = list(range(17))
    parts = [take_part(items, Part(number=number, total=total)) for number in range(1, total + 1)]
    assert sorted(item for part in parts for item in part) == items
    assert max(map(len, parts)) - min(map(len, parts)) <= 1


@pytest.mark.parametrize("text", ["0/4", "5/4", "1/0", "1", "a/b", "1/2/3", "-1/2", ""])
def test_a_shard_that_is_none_is_refused(text: str):
    with pytest.raises(ArtigenError, match="expected K/N"):
        read_shard(text)


@pytest.mark.parametrize("text", ["1/1", "1/4", "4/4"])
def test_shards_are_counted_from_one_to_the_last(text: str):
    part = read_shard(text)
    assert part is not None
    assert f"{part.number}/{part.total}" == text


def test_parts_have_files_of_their_own_that_sort_by_number(tmp_path: Path):
    names = [name_part(tmp_path / "run.jsonl", Part(number=n, total=12)).name for n in range(1, 13)]
    assert len(set(names)) == 12
    assert names == sorted(names)
    assert name_part(tmp_path / "run.jsonl", None).name == "run.jsonl"


def test_parts_do_every_job_once_and_the_whole_finds_nothing_left_to_do(tmp_path: Path):
    jobs = notes(tmp_path, 5)
    assert [line.key for line in run(tmp_path, jobs, "2/2")] == ["n1", "n3"]
    assert sorted(path.name for path in tmp_path.glob("*.jsonl")) == ["run.2-of-2.jsonl"]
    run(tmp_path, jobs, "1/2")
    run(tmp_path, jobs, "3/3")
    assert [line.key for line in run(tmp_path, jobs)] == [job.key for job in jobs]
    assert times_done(tmp_path) == {job.key: 1 for job in jobs}


def test_the_latest_line_of_any_journal_holds(tmp_path: Path):
    run(tmp_path, notes(tmp_path, 2), "1/1")
    run(tmp_path, notes(tmp_path, 2, "others"))  # the same packages, of other settings now
    assert {line.settings for line in read_journal(tmp_path).values()} == {digest_settings("others")}
    run(tmp_path, notes(tmp_path, 2), "1/1")
    assert times_done(tmp_path) == {"n0": 3, "n1": 3}


def test_what_a_killed_run_left_half_written_is_removed(tmp_path: Path):
    for name in (".n0.partial-abc", ".n1.old-abc", ".n10.partial-abc", ".cache"):
        (tmp_path / name).mkdir()
    run(tmp_path, notes(tmp_path, 2))
    assert sorted(path.name for path in tmp_path.glob(".*")) == [".cache", ".n10.partial-abc"]


def test_a_line_that_a_killed_run_cut_short_stays_a_line_of_its_own(tmp_path: Path):
    (tmp_path / "run.jsonl").write_text('{"key": "n0", "settings": "cut sh')
    run(tmp_path, notes(tmp_path, 2))
    lines = (tmp_path / "run.jsonl").read_text().splitlines()
    assert sorted(json.loads(line)["key"] for line in lines[1:]) == ["n0", "n1"]


PARENT = """
import multiprocessing, sys, time
sys.path.insert(0, {tests!r})
import test_runner as own
from artigen.runtime.workers import Worker
if __name__ == "__main__":
    worker = Worker()
    print(worker.call(own.say_pid, None, 60.0).value, flush=True)
    worker.call(time.sleep, 300, 400.0)
"""


def say_pid(_: None) -> int:
    return os.getpid()


def test_a_worker_ends_when_its_parent_is_killed(tmp_path: Path):
    script = tmp_path / "parent.py"
    script.write_text(PARENT.format(tests=str(Path(__file__).parent)))
    parent = subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    child = int(parent.stdout.readline())
    assert Path(f"/proc/{child}").exists() or sys.platform != "linux"
    parent.kill()
    parent.wait()
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline:
        try:
            os.kill(child, 0)
        except ProcessLookupError:
            return
        if _is_zombie(child):
            return
        time.sleep(0.05)
    pytest.fail(f"process {child} outlived its parent")


def _is_zombie(pid: int) -> bool:
    """Ended, and not yet collected by the process that inherited it."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return False


def test_local_jobs_are_answered_in_processes_of_their_own(tmp_path: Path):
    answers = list(run_jobs(do, notes(tmp_path, 3), LocalRunner(workers=2)))
    assert sorted(answer.key for answer in answers) == ["n0", "n1", "n2"]
    assert times_done(tmp_path) == {"n0": 1, "n1": 1, "n2": 1}


def test_without_workers_jobs_run_here_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Worker, "_start", lambda worker: pytest.fail("a process was started"))
    runner = choose_runner("local", 0).begin_with(Worker())
    assert [answer.key for answer in run_jobs(do, notes(tmp_path, 3), runner)] == ["n0", "n1", "n2"]
    assert times_done(tmp_path) == {"n0": 1, "n1": 1, "n2": 1}
