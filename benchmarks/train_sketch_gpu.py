"""Trains the sketch network on one GPU, with data that the processor makes beside it (`sketch_stream`).

    python benchmarks/train_sketch_gpu.py OUT --start artigen/weights/small --seconds 590 --makers 14

Every step sums the losses of three batches: whole tables with photos, headers and finishes with photos, and
in turn whole tables or headers and finishes without photos. OUT/sketch receives checkpoints and metrics,
OUT/model the averaged weights at the end. The same command resumes a run.
"""

import argparse
import threading
import time
from collections.abc import Iterator
from dataclasses import fields
from functools import partial
from multiprocessing import get_context
from multiprocessing.managers import ListProxy
from pathlib import Path
from typing import Any

import torch
from sketch_steps import SketchStep, StepLosses, step_losses
from sketch_stream import Sizes, Store, list_steps, list_tables, make_objects

from artigen.examples.batches import prefetch
from artigen.examples.shards import load_shard
from artigen.examples.sketch import TABLES, unpack_tables
from artigen.sketch.model import load_sketch_network, save_sketch_network
from artigen.sketch.network import SketchNetworkConfig
from artigen.sketch.part_counts import collect_part_counts
from artigen.train.growth import grow_network
from artigen.train.loop import LoopConfig, finished_steps, train

WEIGHTS = {"shown": 0.3, "plain": 0.5, "read": 0.35, "told": 0.2}
"""Weights of the losses of the batches; a step has either of those without photos."""
TABLE_ROWS = 90
"""Rows per table for which there is room; most have fewer, 60 in the mean."""


def main(cfg: argparse.Namespace) -> None:
    """Trains until the time is up, and writes the averaged weights."""
    torch.set_num_threads(1)
    torch.backends.cuda.matmul.allow_tf32 = torch.backends.cudnn.allow_tf32 = True
    torch.backends.cudnn.benchmark = True
    cfg.scratch.mkdir(parents=True, exist_ok=True)
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    context = get_context("spawn")
    loaded, steps = context.Manager().list(), context.Queue(6)
    sizes = Sizes(**{field.name: getattr(cfg, field.name) for field in fields(Sizes)})
    makers = [
        context.Process(target=make_objects, args=(cfg.scratch, cfg.files, k, cfg.makers), daemon=True)
        for k in range(cfg.makers)
    ]
    for maker in makers:
        maker.start()
    network = load_sketch_network(cfg.start)
    if network.cfg != SketchNetworkConfig():
        network = grow_network(network, SketchNetworkConfig())
    assert network.picture is not None
    plain = list_tables(cfg.scratch, cfg.files)
    most = 1000 * cfg.files + cfg.album
    store = Store(TABLE_ROWS * most, most, cfg.album, device)
    network.part_counts = frozenset()  # those of today's objects alone
    for path in plain:
        _wait_for(rows := cfg.scratch / path.name.replace("plain", "rows"), makers)
        store.add_tables(rows)
        network.part_counts |= collect_part_counts(unpack_tables(load_shard(path, TABLES)))
    store.plain = store.tables
    print(f"{store.plain} tables", flush=True)
    lister = context.Process(
        target=list_steps, args=(cfg.scratch, cfg.files, loaded, steps, sizes, time.time_ns()), daemon=True
    )
    lister.start()
    threading.Thread(target=_fill, args=(store, cfg.scratch, loaded), daemon=True).start()
    loop = LoopConfig(
        minutes=cfg.seconds / 60.0,
        learning_rate=cfg.rate,
        warmup=100,
        weight_decay=0.02,
        ema=cfg.ema,
        report_every=50,
        checkpoint_minutes=2.0,
    )
    losses = partial(step_losses, edge=network.picture.cfg.edge)
    model, folder = StepLosses(network.train(), WEIGHTS), cfg.out / "sketch"
    try:
        train(model, losses, prefetch(_make(steps, store), 2), folder, loop)
    finally:
        for worker in (*makers, lister):
            worker.kill()
    count = finished_steps(folder)
    save_sketch_network(network.cpu(), cfg.out / "model", {"preset": "small", "steps": count})
    print(f"{count} steps, {store.tables - store.plain} photos", flush=True)


def _wait_for(path: Path, makers: list[Any]) -> None:
    """Waits for a file that makers write.

    Raises:
        RuntimeError: If a maker has failed.
    """
    while not path.is_file():
        if any(maker.exitcode is not None for maker in makers):
            raise RuntimeError(f"{path}: missing, and a process that makes such files has failed")
        time.sleep(0.2)


def _fill(store: Store, folder: Path, loaded: "ListProxy[str]") -> None:
    """Loads what makers write into the store until that is full."""
    known = set[Path]()
    while True:
        for path in sorted(set(folder.glob("photos-*.npz")) - known):
            if not store.add_photos(path):
                return
            known.add(path)
            loaded.append(path.stem.removeprefix("photos-"))
        time.sleep(0.3)


def _make(steps: Any, store: Store) -> Iterator[SketchStep]:
    """Batches on the device; photos of headers are mirrored at random."""
    mirror = torch.Generator(store.device).manual_seed(1)
    while True:
        step = steps.get(timeout=300.0)
        made = {name: store.make(one, mirror if name == "read" else None) for name, one in step.items()}
        yield SketchStep(batches=made)


if __name__ == "__main__":
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("out", type=Path)
    parser.add_argument("--start", type=Path, required=True, help="model folder with the initial weights")
    parser.add_argument("--seconds", type=float, default=590.0, help="time of the training")
    parser.add_argument("--makers", type=int, default=14, help="processes that draw and photograph objects")
    parser.add_argument("--files", type=int, default=140, help="files of 975 objects without photos")
    parser.add_argument("--scratch", type=Path, default=Path("/tmp/sketch_data"), help="folder of the makers")
    parser.add_argument("--album", type=int, default=200_000, help="most photos on the device")
    parser.add_argument("--rate", type=float, default=1.5e-3, help="peak learning rate")
    parser.add_argument("--ema", type=float, default=0.998, help="decay of the averaged weights")
    for field in fields(Sizes):
        parser.add_argument(f"--{field.name}", type=int, default=field.default)
    main(parser.parse_args())
