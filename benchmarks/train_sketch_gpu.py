"""Trains the sketch network on one GPU, with data that the processor makes beside it (`sketch_stream`).

    python benchmarks/train_sketch_gpu.py OUT --start artigen/weights/small --seconds 590 --makers 11

Every step sums the losses of four batches: whole tables with and without photos, headers and finishes with
and without photos. OUT/sketch receives checkpoints and metrics, OUT/model the averaged weights at the end.
The same command resumes a run.
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
from sketch_stream import Album, Sizes, make_batches, make_objects, unpack

from artigen.examples.batches import prefetch
from artigen.examples.sketch import SketchBatch
from artigen.sketch.model import load_sketch_network, save_sketch_network
from artigen.sketch.network import SketchNetworkConfig
from artigen.train.growth import grow_network
from artigen.train.loop import LoopConfig, finished_steps, train
from artigen.train.sketch_losses import SketchLosses, sketch_losses

WEIGHTS = {"shown": 0.3, "plain": 0.25, "read": 0.35, "told": 0.1}
"""Weights of the losses of the four batches."""


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
    workers = [
        *(context.Process(target=make_objects, args=(cfg.scratch, k, cfg.makers)) for k in range(cfg.makers)),
        *(
            context.Process(target=make_batches, args=(cfg.scratch, cfg.tables, loaded, steps, sizes, k))
            for k in range(cfg.batchers)
        ),
    ]
    for worker in workers:
        worker.daemon = True
        worker.start()
    network = load_sketch_network(cfg.start)
    if network.cfg != SketchNetworkConfig():
        network = grow_network(network, SketchNetworkConfig())
    assert network.picture is not None
    album = Album(cfg.album, device)
    threading.Thread(target=_fill, args=(album, cfg.scratch, loaded), daemon=True).start()
    loop = LoopConfig(
        minutes=cfg.seconds / 60.0,
        learning_rate=cfg.rate,
        warmup=100,
        weight_decay=0.02,
        ema=0.995,
        report_every=50,
        checkpoint_minutes=2.0,
    )
    losses = partial(sketch_losses, edge=network.picture.cfg.edge)
    model, folder = SketchLosses(network.train()), cfg.out / "sketch"
    try:
        train(model, losses, prefetch(_fetch(steps, album), 3), folder, loop, WEIGHTS)
    finally:
        for worker in workers:
            worker.kill()
    count = finished_steps(folder)
    save_sketch_network(network.cpu(), cfg.out / "model", {"preset": "small", "steps": count})
    print(f"{count} steps, {album.size} photos", flush=True)


def _fill(album: Album, folder: Path, loaded: "ListProxy[str]") -> None:
    """Loads what makers write into the album until that is full."""
    known = set[Path]()
    while True:
        for path in sorted(set(folder.glob("photos-*.npz")) - known):
            if not album.load(path):
                return
            known.add(path)
            loaded.append(path.stem.removeprefix("photos-"))
        time.sleep(0.3)


def _fetch(steps: Any, album: Album) -> Iterator[dict[str, SketchBatch]]:
    """Batches on the device; photos of headers are mirrored at random."""
    mirror = torch.Generator(album.count.device).manual_seed(1)
    while True:
        step = steps.get(timeout=300.0)
        yield {name: unpack(rows, album, mirror if name == "read" else None) for name, rows in step.items()}


if __name__ == "__main__":
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("out", type=Path)
    parser.add_argument("--start", type=Path, required=True, help="model folder with the initial weights")
    parser.add_argument("--seconds", type=float, default=590.0, help="time of the training")
    parser.add_argument("--makers", type=int, default=11, help="processes that draw and photograph objects")
    parser.add_argument("--batchers", type=int, default=3, help="processes that make batches")
    parser.add_argument("--tables", type=Path, help="folder of tables made before")
    parser.add_argument("--scratch", type=Path, default=Path("/tmp/sketch_data"), help="folder of the makers")
    parser.add_argument("--album", type=int, default=80_000, help="most photos on the device")
    parser.add_argument("--rate", type=float, default=1.5e-3, help="peak learning rate")
    for field in fields(Sizes):
        parser.add_argument(f"--{field.name}", type=int, default=field.default)
    main(parser.parse_args())
