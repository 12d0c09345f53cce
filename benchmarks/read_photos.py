"""Reads marked photographs and scores kinds, counts, boxes, hinges and pulls.

    python benchmarks/read_photos.py FOLDER [--model FOLDER] [--out FOLDER]

FOLDER has the photographs, ``index.csv`` (file, kind, category, doors, drawers, knobs_visible, handles) and
``fronts.json`` (per file the fronts: label, box as shares of width and height, hinge). Photographs may be
such that nothing of them may be trained on or published; the scores are all that leaves this script. With
``--out``, a JSON of every reading and a picture of its boxes are written.
"""

import csv
import json
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
import tyro

from artigen.conditioning.image import open_picture
from artigen.errors import SourceError
from artigen.reader.assemble import ReadSettings
from artigen.reader.boxes import overlap_boxes
from artigen.reader.drawing import draw_reading
from artigen.reader.model import Reader, load_reader
from artigen.reader.read import read_image
from artigen.reader.reading import Reading
from artigen.weights import READER

SAME = {
    "Dresser": "StorageFurniture", "Wardrobe": "StorageFurniture", "FilingCabinet": "StorageFurniture",
    "Dryer": "WashingMachine",
}  # fmt: skip
"""Kinds that count as one, as in PartNet-Mobility."""
OVERLAP = 0.5
"""Intersection over union from which a box is right."""


@dataclass(frozen=True, kw_only=True)
class Photo:
    """A photograph and what is in it."""

    path: Path
    kinds: frozenset[str]
    doors: int
    drawers: int
    pulls: int
    fronts: tuple[dict, ...] | None


def list_photos(folder: Path) -> list[Photo]:
    """The photographs of a folder with what was counted by eye."""
    marked = json.loads((folder / "fronts.json").read_text()) if (folder / "fronts.json").is_file() else {}
    with (folder / "index.csv").open() as file:
        rows = list(csv.DictReader(file))
    return [
        Photo(
            path=folder / row["file"],
            kinds=frozenset(SAME.get(row[name], row[name]) for name in ("kind", "category") if row.get(name)),
            doors=int(row["doors"]),
            drawers=int(row["drawers"]),
            pulls=int(row["handles"]) + int(row["knobs_visible"]),
            fronts=tuple(marked[row["file"]]["fronts"]) if row["file"] in marked else None,
        )
        for row in rows
        if row.get("is_photo", "photo") == "photo"
    ]


def match(reading: Reading, fronts: tuple[dict, ...]) -> list[tuple[int, int]]:
    """Pairs of fronts read and true, of one label, by falling overlap."""
    pairs = [
        (float(overlap_boxes(np.array([true["box"]]), read.box[None])[0, 0]), i, j)
        for i, read in enumerate(reading.fronts)
        for j, true in enumerate(fronts)
        if read.label == true["label"]
    ]
    used: tuple[set[int], set[int]] = (set(), set())
    out = []
    for overlap, i, j in sorted(pairs, reverse=True):
        if overlap >= OVERLAP and i not in used[0] and j not in used[1]:
            used[0].add(i)
            used[1].add(j)
            out.append((i, j))
    return out


def average_precision(photos: list[Photo], readings: list[Reading | None]) -> float:
    """Average precision of labelled fronts, over photographs with marked fronts."""
    rows, total = [], 0
    for photo, reading in zip(photos, readings, strict=True):
        if photo.fronts is None:
            continue
        total += len(photo.fronts)
        free = list(range(len(photo.fronts)))
        found = () if reading is None else sorted(reading.fronts, key=lambda part: -part.score)
        for part in found:
            near = [
                (float(overlap_boxes(np.array([photo.fronts[j]["box"]]), part.box[None])[0, 0]), j)
                for j in free
                if photo.fronts[j]["label"] == part.label
            ]
            right = bool(near) and max(near)[0] >= OVERLAP
            if right:
                free.remove(max(near)[1])
            rows.append((part.score, right))
    hit = np.array([right for _, right in sorted(rows, key=lambda row: -row[0])], dtype=float)
    precision = hit.cumsum() / np.arange(1, len(hit) + 1)
    precision = np.maximum.accumulate(precision[::-1])[::-1]
    return float((precision * hit).sum() / max(total, 1))


def score(photos: list[Photo], readings: list[Reading | None]) -> dict[str, float]:
    """Shares of what is right; boxes over photographs with marked fronts."""
    right: Counter[str] = Counter()
    for photo, reading in zip(photos, readings, strict=True):
        if reading is None:
            right["true"] += 0 if photo.fronts is None else len(photo.fronts)
            continue
        counts = reading.counts
        kind = SAME.get(reading.kind, reading.kind) in photo.kinds
        fronts = counts["door"] == photo.doors and counts["drawer"] == photo.drawers
        pulls = abs(counts["handle"] + counts["knob"] - photo.pulls) <= 1
        right.update(kind=kind, fronts=fronts, both=kind and fronts, pulls=pulls)
        if photo.fronts is None:
            continue
        good = match(reading, photo.fronts)
        right.update(found=len(reading.fronts), true=len(photo.fronts), hit=len(good))
        for i, j in good:
            if photo.fronts[j]["label"] == "door" and photo.fronts[j].get("hinge"):
                right.update(hinged=1, hinge=reading.fronts[i].hinge == photo.fronts[j]["hinge"])
    shares = {name: right[name] / len(photos) for name in ("kind", "fronts", "both", "pulls")}
    return shares | {
        "precision": right["hit"] / max(right["found"], 1),
        "recall": right["hit"] / max(right["true"], 1),
        "hinge": right["hinge"] / max(right["hinged"], 1),
    }


def read_all(photos: list[Photo], reader: Reader, settings: ReadSettings) -> list[Reading | None]:
    """The readings; None where nothing was found."""
    out: list[Reading | None] = []
    for photo in photos:
        try:
            out.append(read_image(open_picture(photo.path), reader, photo.path.name, settings=settings))
        except SourceError:
            out.append(None)
    return out


def main(folder: tyro.conf.Positional[Path], /, model: Path = READER, out: Path | None = None) -> None:
    """Reads and scores the photographs of a folder."""
    torch.set_num_threads(1)
    photos, reader = list_photos(folder), load_reader(model)
    started = time.perf_counter()
    readings = read_all(photos, reader, ReadSettings())
    seconds = (time.perf_counter() - started) / len(photos)
    # For the average precision, faint fronts count too, whatever is usual.
    faint = read_all(photos, reader, ReadSettings(middle=0.05, usual=0.0))
    said = score(photos, readings) | {"average precision": average_precision(photos, faint)}
    print(f"{len(photos)} photographs, {seconds:.2f} s each on one core")
    print("  ".join(f"{name} {100 * value:.0f} %" for name, value in said.items()))
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        for photo, reading in zip(photos, readings, strict=True):
            if reading is not None:
                (out / f"{photo.path.stem}.json").write_text(json.dumps(reading.to_json()))
                draw_reading(open_picture(photo.path), reading).save(out / f"{photo.path.stem}.png")


if __name__ == "__main__":
    tyro.cli(main)
