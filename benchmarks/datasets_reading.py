"""Measures how fast a data set is opened, streamed and unpacked, and what its bytes consist of.

python benchmarks/datasets_reading.py out/household
"""

import json
import time
from collections.abc import Callable
from pathlib import Path

import tyro

from artigen.datasets import open_shards
from artigen.datasets.shards import Shards, StoredObject


def rate(shards: Shards, use: Callable[[StoredObject], object]) -> float:
    """Objects per second of one pass, opening included."""
    started = time.perf_counter()
    again = open_shards(shards.folder)
    count = sum(1 for item in again if use(item) is not None)
    return count / (time.perf_counter() - started)


def main(folder: tyro.conf.Positional[Path]) -> None:
    """Prints rates and bytes per object.

    Args:
        folder: A data set.
    """
    started = time.perf_counter()
    shards = open_shards(folder)
    ids = shards.ids
    opened = time.perf_counter() - started
    started = time.perf_counter()
    some = ids[:: max(1, len(ids) // 200)]
    for name in some:
        shards[name].files()
    looked_up = len(some) / (time.perf_counter() - started)
    print(f"{len(ids)} objects; opened, ids read: {1000 * opened:.0f} ms")
    print(f"streamed, bytes only: {rate(shards, lambda item: item.members):.0f} objects/s")
    print(f"streamed, JSON read: {rate(shards, lambda item: item.sample):.0f} objects/s")
    print(f"streamed, whole packages: {rate(shards, lambda item: item.files()):.0f} objects/s")
    print(f"by id, whole packages: {looked_up:.0f} objects/s")
    files = json.loads((folder / "dataset.json").read_text())["files"]
    groups = ("shards/", "shared", "manifest.parquet", "example/", "images/")
    rest = sum(one["bytes"] for one in files.values())
    for group in groups:
        size = sum(one["bytes"] for name, one in files.items() if name.startswith(group))
        rest -= size
        print(f"{group:18s} {size / len(ids) / 1e3:7.2f} kB per object")
    print(f"{'the rest':18s} {rest / len(ids) / 1e3:7.2f} kB per object, {len(files)} files in all")
    table = shards.manifest("packed_bytes", "size", "unpacked_bytes", "shared").to_pydict()
    for name in ("packed_bytes", "size", "unpacked_bytes"):
        print(f"{name:18s} {sum(table[name]) / len(ids) / 1e3:7.2f} kB per object")
    used = sum(len(row) for row in table["shared"])
    print(f"{len(shards.shared_places)} shared files, used {used / len(shards.shared_places):.1f} times each")


if __name__ == "__main__":
    tyro.cli(main)
