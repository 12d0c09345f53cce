"""Measures the colours of objects drawn by pictures against the finishes in the pictures.

    python benchmarks/picture_colors.py --each 2

photographs held-out procedural objects of every category, draws an object by each picture as
`artigen generate --image` does, and compares the colours of the finishes that both have (mean absolute
difference, sRGB in [0, 1]): as the network says them, and as they are read off the picture.
"""

import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
import tyro

from artigen.examples.photographs import photograph_shape
from artigen.kind import paper_kinds
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape
from artigen.sketch.model import (
    COOLEST,
    PICTURE_EDGE,
    PICTURED,
    SketchConfig,
    draw_object,
    encode_picture,
    load_sketch_network,
)
from artigen.sketch.overlay import View
from artigen.sketch.picture_colors import read_colors
from artigen.sketch.request import SketchRequest
from artigen.weights import SHIPPED

SEEN = ("body", "front", "top", "handle")
"""Roles of finishes that a picture of a closed object shows."""


def compare_finishes(found: Shape, truth: Shape) -> dict[str, float]:
    """Mean absolute difference of the colours of the finishes that both have, by role."""
    ours, theirs = dict(found.finishes), dict(truth.finishes)
    return {
        role: float(np.abs(np.subtract(ours[role].color, theirs[role].color)).mean())
        for role in SEEN
        if role in ours and role in theirs
    }


def main(model: Path = SHIPPED, first: int = 0, each: int = 2) -> int:
    """Measures colours by pictures.

    Args:
        model: Folder of the model.
        first: Seed of the first object of each category.
        each: Objects of each category.
    """
    network = load_sketch_network(model)
    cfg = SketchConfig(header=PICTURED, coolest=COOLEST)
    of_drawn: dict[str, list[float]] = defaultdict(list)
    read: dict[str, list[float]] = defaultdict(list)
    for category in paper_kinds():
        for seed in range(first, first + each):
            truth = draw_shape(category, seed)
            rgba = photograph_shape(truth, seed, PICTURE_EDGE)
            picture = rgba.transpose(2, 0, 1).astype(np.float32) / 255.0
            encoded = encode_picture(network, picture)
            drawn = draw_object(network, SketchRequest(), seed, cfg, encoded).shape
            view = View(*encoded[0].view[0].tolist())
            labels = encoded[0].labels[0].softmax(dim=0).numpy()
            colored = read_colors(drawn, picture, view, labels=labels)
            for errors, shape in ((of_drawn, drawn), (read, colored)):
                for role, error in compare_finishes(shape, truth).items():
                    errors[role].append(error)
    for role in (*SEEN, "all"):
        ours, theirs = (
            np.concatenate([errors[one] for one in ((role,) if role != "all" else SEEN)])
            for errors in (of_drawn, read)
        )
        sys.stdout.write(f"{role:8} drawn {ours.mean():.4f}  read {theirs.mean():.4f}  of {len(ours)}\n")
    return 0


if __name__ == "__main__":
    sys.exit(tyro.cli(main))
