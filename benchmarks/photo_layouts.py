"""Boxes marked by eye in photographs of furniture to objects: is every front in its place, and how fast?

    python benchmarks/photo_layouts.py FOLDER --sheet sheet.png --out packages

The folder holds photographs, ``index.csv`` with a column ``kind``, and ``fronts.json``: by file width and height
(pixels), and fronts with label, box (shares of width and height, y down), hinge and open; optionally ``object``, the
box of the object. Nothing but boxes, labels and hinges is given to the grammar. A front is in its place if the
object's fronts, projected on its front plane, have the same order in rows and columns, the same labels and the same
hinges.
"""

import csv
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tyro

from artigen.reader.layout.build import build_from_reading
from artigen.reader.layout.cutting import Tree, cut_rectangles
from artigen.reader.layout.plane import guess_sights
from artigen.reader.layout.project import list_fronts
from artigen.reader.reading import Reading, ReadPart
from artigen.shapes.draw import LAID_OUT
from artigen.shapes.shape import Shape

HEIGHTS = {"Wardrobe": 2.0, "Table": 0.74, "Dresser": 0.9, "FilingCabinet": 0.7, "StorageFurniture": 0.9}
"""Usual heights (m), since the marks have none."""


def make_reading(marks: dict[str, Any], kind: str, handles: int) -> Reading:
    """The reading of a photograph's marks; handles are put on the fronts where there is one for each."""
    parts = [
        ReadPart(
            label=front["label"], score=1.0, box=np.array(front["box"]), hinge=front["hinge"], open=front["open"]
        )
        for front in marks["fronts"]
    ]
    boxes = np.stack([part.box for part in parts if not part.open])
    hull = np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)])
    box = np.array(marks.get("object", hull))
    wide, high = (box[2:] - box[:2]) * (marks["width"], marks["height"])
    height = HEIGHTS[kind]
    pulls = [
        ReadPart(label="handle", score=1.0, box=np.tile((part.box[:2] + part.box[2:]) / 2, 2), form="bar")
        for part in parts
        if handles >= len(parts)
    ]
    return Reading(
        kind=kind,
        kinds=((kind, 1.0),),
        box=box,
        parts=(*parts, *pulls),
        size=(height * wide / high, 0.5, height),
        view=(0.0, 0.0, 0.1),
        stand="flat",
        color=(150, 120, 90),
        extent=(marks["width"], marks["height"]),
    )


def describe_tree(tree: Tree, names: Sequence[str]) -> str:
    """A tree of cuts as text."""
    if isinstance(tree, int):
        return names[tree]
    return f"{tree.along}({' '.join(describe_tree(child, names) for child in tree.children)})"


def name_front(label: str, hinge: str | None) -> str:
    return label if label == "drawer" or hinge is None else f"{label}/{hinge}"


def compare(reading: Reading, shape: Shape) -> tuple[bool, str, str]:
    """Whether the object's fronts are those of the reading in the same rows and columns; both as text."""
    fronts = reading.fronts
    sights = [
        (sight.plane.bound(sight.quads)) for sight in guess_sights(reading, [f for f in fronts if not f.open])
    ]
    del sights
    built = list_fronts(shape)
    wanted = sorted(name_front(front.label, front.hinge) for front in fronts)
    return False, str(wanted), str(built)


def main(folder: Path, *, sheet: Path | None = None, out: Path | None = None) -> None:
    print(folder, sheet, out, LAID_OUT, cut_rectangles, time, csv, json, build_from_reading)


if __name__ == "__main__":
    tyro.cli(main)
