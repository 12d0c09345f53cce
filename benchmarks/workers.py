"""Measures objects per minute by number of workers, on an idle and on a busy machine.

Every count of workers does the same objects in the same run, so that the ratios hold on any machine. Rounds
go through all counts in turn, and the best round of each counts: what else runs on the machine disturbs all.

    python benchmarks/workers.py --out out/workers --commands shape generate
    python benchmarks/workers.py --out out/workers --commands convert --sources PATH/TO/partnet_mobility/*
"""

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tyro

from artigen.runtime.cores import count_cores

Command = Literal["shape", "generate", "convert"]


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    out: Path
    """Folder for packages, which are removed after each run, and for workers.json."""
    commands: tuple[Command, ...] = ("shape", "generate")
    """Subcommands."""
    workers: tuple[int, ...] = (1, 2, 4)
    """Counts of workers."""
    count: int = 8
    """Objects of each run."""
    category: str = "StorageFurniture"
    """Command-line options."""
    sources: tuple[Path, ...] = ()
    """Objects that convert reads, ``count`` of them."""
    busy: tuple[int, ...] = (0, 1)
    """Processes that each keep a core busy meanwhile."""
    rounds: int = 1
    """Runs of each kind."""


@contextmanager
def keep_busy(count: int) -> Iterator[None]:
    """Processes that compute without end."""
    running = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for process in running:
            process.kill()
            process.wait()


def arguments(command: Command, options: Options, out: Path) -> list[str]:
    """Of the subcommand, but for the number of workers."""
    if command == "convert":
        return [command, *map(str, options.sources[: options.count]), "-o", str(out)]
    return [command, options.category, "-n", str(options.count), "-o", str(out)]


def measure(command: Command, options: Options, workers: int | None) -> tuple[float, float]:
    """Objects per minute and processor seconds per object of one run, start and imports included."""
    out = options.out / "run"
    shutil.rmtree(out, ignore_errors=True)
    extra = [] if workers is None else ["--workers", str(workers)]
    before, started = os.times(), time.monotonic()
    subprocess.run(
        [sys.executable, "-m", "artigen", *arguments(command, options, out), *extra],
        check=False,  # an object that fails a check is done all the same
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    spent, after = time.monotonic() - started, os.times()
    done = len(list(out.glob("*/mobility.urdf")))
    shutil.rmtree(out, ignore_errors=True)
    processor = after.children_user + after.children_system - before.children_user - before.children_system
    return 60.0 * done / spent, processor / max(done, 1)


def main(options: Options) -> None:
    """Measures, prints a table and writes workers.json."""
    results = []
    for command in options.commands:
        for busy in options.busy:
            best: dict[int, tuple[float, float]] = {}
            for _ in range(options.rounds):
                for workers in options.workers:
                    with keep_busy(busy):
                        best[workers] = max(best.get(workers, (0.0, 0.0)), measure(command, options, workers))
            most = max(rate for rate, _ in best.values())
            for workers, (rate, processor) in best.items():
                line = {
                    "command": command,
                    "busy cores": busy,
                    "workers": workers,
                    "default": workers == count_cores(),
                    "objects per minute": round(rate, 2),
                    "over the first": round(rate / best[options.workers[0]][0], 2),
                    "best over this": round(most / rate, 2),
                    "processor seconds per object": round(processor, 2),
                }
                results.append(line)
                print(json.dumps(line), flush=True)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "workers.json").write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main(tyro.cli(Options))
