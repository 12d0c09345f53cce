"""Reads plain renderings of held-out objects of the grammar, and scores kinds and counts of fronts in view.

python benchmarks/read_renders.py [--count 10] [--model FOLDER]
"""

from collections import Counter
from pathlib import Path

import numpy as np
import torch
import tyro
from PIL import Image
from read_photos import SAME

from artigen.errors import SourceError
from artigen.examples.sketch_photos import take_photos
from artigen.reader.labels import KINDS
from artigen.reader.model import load_reader
from artigen.reader.read import read_image
from artigen.shapes.draw import draw_shape
from artigen.sketch.model import draw_header, encode_picture, load_sketch_network
from artigen.sketch.request import SketchRequest
from artigen.types import PART_LABELS
from artigen.weights import READER

PARTS = ("sketch_kind", "sketch_fronts", "sketch_both")


def main(
    count: int = 10,
    first: int = 5000,
    model: Path = READER,
    kinds: tuple[str, ...] = KINDS,
    sketch: Path | None = None,
) -> None:
    """Reads ``count`` objects of each kind, from seed ``first`` on; ``sketch`` is the folder of a network
    whose picture encoder reads them, too."""
    torch.set_num_threads(1)
    reader, right, total = load_reader(model), Counter[str](), 0
    encoder = None if sketch is None else load_sketch_network(sketch)
    wrong: Counter[str] = Counter()
    for kind in kinds:
        for seed in range(first, first + count):
            photo = take_photos([draw_shape(kind, seed)], np.random.default_rng([seed, 9]))[0]
            seen = Counter(PART_LABELS[int(label)] for label in photo.spots[:, 0])
            alpha = np.maximum(photo.rgba[..., 3:].astype(np.float32), 1)
            straight = np.clip(photo.rgba[..., :3] * (255.0 / alpha), 0, 255).astype(np.uint8)
            image = Image.fromarray(np.concatenate([straight, photo.rgba[..., 3:]], axis=2))
            total += 1
            if encoder is not None:
                picture = np.moveaxis(photo.rgba.astype(np.float32) / 255.0, -1, 0)
                header = draw_header(encoder, SketchRequest(), 0, encoded=encode_picture(encoder, picture))
                held = dict(header.counts)
                named = SAME.get(str(header.category), header.category) == SAME.get(kind, kind)
                counted = all(held.get(label, 0) == seen[label] for label in ("door", "drawer"))
                right.update(sketch_kind=named, sketch_fronts=counted, sketch_both=named and counted)
            try:
                reading = read_image(image, reader, f"{kind} {seed}")
            except SourceError:
                wrong[f"{kind}: nothing"] += 1
                continue
            named = SAME.get(reading.kind, reading.kind) == SAME.get(kind, kind)
            counted = all(reading.counts[label] == seen[label] for label in ("door", "drawer"))
            right.update(kind=named, fronts=counted, both=named and counted)
            if not named:
                wrong[f"{kind}: {reading.kind}"] += 1
    if encoder is not None:
        print("encoder of the sketch:", "  ".join(f"{k[7:]} {100 * right[k] / total:.0f} %" for k in PARTS))
    print(
        f"{total} renderings:",
        "  ".join(f"{k} {100 * right[k] / total:.0f} %" for k in ("kind", "fronts", "both")),
    )
    print("kinds misread:", ", ".join(f"{name} {times}" for name, times in wrong.most_common(12)))


if __name__ == "__main__":
    tyro.cli(main)
