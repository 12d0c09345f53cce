"""Tests that a Ray run neither loses nor repeats objects when workers and the driver are killed.

Starts a Ray cluster on this machine and `artigen shape --runner ray` on it as a process of its own. A
random worker process of the cluster is killed with SIGKILL every few seconds, and once half of the objects
are there, the driver is. The same command then finishes the run while kills go on. In the end every
object must have one package, whole to the byte, and one line in the journal.

    python benchmarks/ray_kills.py --out out/ray_kills
"""

import json
import os
import random
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import psutil
import tyro

from artigen.api.batch import read_journal
from sim_export.files.write import manifest_problems


@dataclass(frozen=True, kw_only=True)
class Options:
    """How many objects, and how often something is killed."""

    out: Path
    """Folder for the packages; a new one."""
    category: str = "Oven"
    """Command-line options."""
    count: int = 500
    """Objects."""
    every: float = 20.0
    """Seconds between kills of a worker."""
    cores: int = 2
    """Cores of the cluster."""
    seed: int = 0
    """Of the choice of workers."""


def start_driver(options: Options, address: str) -> subprocess.Popen:
    """The run, in a process of its own."""
    command = ["shape", options.category, "-n", str(options.count), "-o", str(options.out)]
    return subprocess.Popen(
        [sys.executable, "-m", "artigen", *command, "--validation", "none", "--runner", "ray"],
        env=os.environ | {"RAY_ADDRESS": address},
    )


def list_workers() -> list[psutil.Process]:
    """Worker processes of the cluster that this process has started."""
    found = []
    for raylet in psutil.Process().children(recursive=True):
        if raylet.name() != "raylet":
            continue
        for process in raylet.children():
            try:
                if any(word.startswith("ray::_do") for word in process.cmdline()):
                    found.append(process)
            except psutil.NoSuchProcess:
                continue
    return found


def count_lines(out: Path) -> int:
    """Lines of the journal."""
    path = out / "run.jsonl"
    return len(path.read_text().splitlines()) if path.is_file() else 0


def disturb(options: Options, driver: subprocess.Popen, chance: random.Random, until: int | None) -> int:
    """Kills workers until the driver ends or ``until`` objects are done; returns how many were killed."""
    killed, last = 0, time.monotonic()
    while driver.poll() is None and (until is None or count_lines(options.out) < until):
        time.sleep(0.2)
        if time.monotonic() - last < options.every:
            continue
        workers = list_workers()
        if workers:
            chance.choice(workers).kill()
            killed, last = killed + 1, time.monotonic()
    return killed


def measure(options: Options) -> dict[str, object]:
    """Runs, kills, and counts."""
    import ray  # pyright: ignore[reportMissingImports]

    ray.init(address="local", num_cpus=options.cores, log_to_driver=False)
    address = ray.get_runtime_context().gcs_address
    chance, started = random.Random(options.seed), time.monotonic()
    first = start_driver(options, address)
    killed = disturb(options, first, chance, options.count // 2)
    ended_early = first.poll() is not None
    first.kill()
    first.wait()
    done_before = count_lines(options.out)
    second = start_driver(options, address)
    killed += disturb(options, second, chance, None)
    ray.shutdown()
    wanted = {f"{options.category}_{seed}" for seed in range(options.count)}
    there = {path.parent.name for path in options.out.glob("*/manifest.json")}
    lines = Counter(json.loads(line)["key"] for line in (options.out / "run.jsonl").read_text().splitlines())
    return {
        "objects": options.count,
        "workers killed": killed,
        "driver killed at": "not at all: it had ended" if ended_early else done_before,
        "exit code of the second driver": second.returncode,
        "lost": len(wanted - there) + len(wanted - read_journal(options.out).keys()),
        "foreign": len(there - wanted),
        "doubled": sum(count > 1 for count in lines.values()),
        "damaged": sum(bool(manifest_problems(options.out / key)) for key in there),
        "left over": sum(path.name.startswith(".") for path in options.out.iterdir()),
        "seconds": round(time.monotonic() - started),
    }


if __name__ == "__main__":
    result = measure(tyro.cli(Options))
    print(json.dumps(result, indent=1))
    sys.exit(any(result[name] for name in ("lost", "foreign", "doubled", "damaged", "left over")))
