"""Trains the sketch network on one GPU, with data that the processor makes beside it (`sketch_stream`).

    python benchmarks/train_sketch_gpu.py OUT --start artigen/weights/small --seconds 590 --makers 11

Every step sums the losses of four batches: whole tables with and without photos, headers and finishes with
and without photos. OUT receives the averaged weights as a model folder, every two minutes and at the end, and
a line of losses every 50 steps.
"""

import argparse
import json
import queue
import threading
import time
from dataclasses import fields
from functools import partial
from multiprocessing import get_context
from multiprocessing.managers import ListProxy
from pathlib import Path
from typing import Any

import numpy as np
import torch
from sketch_stream import Album, Sizes, make_batches, make_objects, unpack

from artigen.errors import ArtigenError
from artigen.models.precision import autocast_type
from artigen.sketch.model import load_sketch_network, save_sketch_network
from artigen.sketch.network import SketchNetwork, SketchNetworkConfig
from artigen.train.growth import grow_network
from artigen.train.sketch_examples import SketchBatch
from artigen.train.sketch_losses import SketchLosses, sketch_losses

WEIGHTS = {"shown": 0.3, "plain": 0.25, "read": 0.35, "told": 0.1}
"""Weights of the losses of the four batches."""
WARMUP, DECAY, EMA = 100, 0.02, 0.995
"""Steps to the peak learning rate, weight decay, and decay of the averaged weights."""
REPORT, SAVE = 50, 120.0
"""Steps between lines of losses, and seconds between savings of the weights."""


def main(cfg: argparse.Namespace) -> None:
    """Trains until the time is up, and writes the averaged weights."""
    torch.set_num_threads(1)
    torch.backends.cuda.matmul.allow_tf32 = torch.backends.cudnn.allow_tf32 = True
    torch.backends.cudnn.benchmark = True
    cfg.out.mkdir(parents=True, exist_ok=True)
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
    album = Album(cfg.album, device)
    ready: queue.Queue[dict[str, SketchBatch]] = queue.Queue(3)
    for task in (partial(_fill, album, cfg.scratch, loaded), partial(_fetch, steps, album, ready)):
        threading.Thread(target=task, daemon=True).start()
    try:
        train(network.to(device), ready, album, cfg)
    finally:
        for worker in workers:
            worker.kill()


def train(
    network: SketchNetwork,
    ready: "queue.Queue[dict[str, SketchBatch]]",
    album: Album,
    cfg: argparse.Namespace,
) -> None:
    """The loop; the learning rate falls linearly to zero."""
    assert network.picture is not None
    model, edge, device = SketchLosses(network.train()), network.picture.cfg.edge, album.count.device
    values = list(network.parameters())
    average = [value.detach().clone() for value in values]
    optimizer = torch.optim.AdamW(values, lr=cfg.rate, weight_decay=DECAY, betas=(0.9, 0.99), fused=True)
    generator, number_type = torch.Generator(device).manual_seed(0), autocast_type(device)
    begun = saved = since = time.monotonic()
    step, sums = 0, dict[str, torch.Tensor]()
    while (share := (time.monotonic() - begun) / cfg.seconds) < 1.0:
        for group in optimizer.param_groups:
            group["lr"] = cfg.rate * min(1.0, (step + 1) / WARMUP) * (1.0 - share)
        for name, batch in ready.get(timeout=300.0).items():
            with torch.autocast(device.type, number_type or torch.bfloat16, enabled=number_type is not None):
                terms = sketch_losses(model, batch, generator, edge)
            (WEIGHTS[name] * torch.stack(list(terms.values())).sum()).backward()
            for term, value in terms.items():
                key = f"{name} {term}"
                sums[key] = sums.get(key, torch.zeros((), device=device)) + value.detach()
        norm = torch.nn.utils.clip_grad_norm_(values, 1.0)
        optimizer.step()
        optimizer.zero_grad()
        with torch.no_grad():
            for mean, value in zip(average, values, strict=True):
                mean.lerp_(value, 1.0 - min(EMA, (1 + step) / (10 + step)))
        step += 1
        if step % REPORT == 0:
            line = {name: float(value) / REPORT for name, value in sums.items()}
            pace = (time.monotonic() - since) / REPORT
            said = {"step": step, "share": share, "seconds_per_step": pace, "photos": album.size}
            line = {**said, "gradient": float(norm), **line}
            with (cfg.out / "metrics.jsonl").open("a") as file:
                file.write(json.dumps(line) + "\n")
            print(" ".join(f"{name}={value:.4g}" for name, value in line.items()), flush=True)
            if not np.isfinite(list(line.values())).all():
                raise ArtigenError(f"losses at step {step}: {line}")
            sums, since = {}, time.monotonic()
        if time.monotonic() - saved > SAVE:
            _save(network, average, cfg.out / "model", step)
            saved = time.monotonic()
    _save(network, average, cfg.out / "model", step)
    print(f"{step} steps, {album.size} photos", flush=True)


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


def _fetch(steps: Any, album: Album, ready: "queue.Queue[dict[str, SketchBatch]]") -> None:
    """Moves batches to the device ahead of their use; photos of headers are mirrored at random."""
    mirror = torch.Generator(album.count.device).manual_seed(1)
    while True:
        step = steps.get()
        ready.put(
            {name: unpack(rows, album, mirror if name == "read" else None) for name, rows in step.items()}
        )


def _save(network: SketchNetwork, average: list[torch.Tensor], folder: Path, step: int) -> None:
    """Writes the averaged weights as a model folder."""
    mean = SketchNetwork(network.cfg)
    mean.categories = network.categories
    mean.load_state_dict(network.state_dict())
    for value, one in zip(mean.parameters(), average, strict=True):
        value.data.copy_(one)
    save_sketch_network(mean, folder, {"preset": "small", "steps": step})


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
