"""Boxes marked by eye in photographs to objects: is every front in its place, and how fast?

    python benchmarks/photo_layouts.py FOLDER --sheet sheet.png --out packages

The folder holds photographs, ``index.csv`` with a column ``kind``, and ``fronts.json``: by file width and
height (pixels), and fronts with label, box (shares of width and height, y down), hinge and open; optionally
``object``, the box of the object; without it, kinds that divide their front end with their fronts, and others
fill the photograph. Nothing but boxes, labels and hinges is given to the grammar. A front is in
its place if the object's fronts, projected on its front plane, have the same order in rows and columns, the
same labels and the same hinges."""

import csv
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tyro

from artigen.kind import kinds
from artigen.reader.boxes import overlap_boxes
from artigen.reader.layout.build import build_from_reading
from artigen.reader.layout.cutting import Tree, cut_rectangles, list_leaves
from artigen.reader.layout.frontal import read_shape
from artigen.reader.layout.fronts import view_fronts
from artigen.reader.reading import Reading, ReadPart
from artigen.shapes.shape import Shape


def find_height(kind: str, aspect: float) -> float:
    """Usual height (m) of an object, since the marks have none, by its height over its width."""
    rule = next(rule for rule in kinds()[kind].size if aspect <= rule.up_to)
    return rule.metres * (
        aspect if rule.extent == "width" or (rule.extent == "longest" and aspect < 1) else 1
    )


def make_reading(marks: dict[str, Any], kind: str, handles: int) -> Reading:
    """The reading of a photograph's marks; handles are put on the fronts where there is one for each."""
    parts = [
        ReadPart(
            label=front["label"],
            score=1.0,
            box=np.array(front["box"]),
            hinge=front["hinge"],
            open=front["open"],
        )
        for front in marks["fronts"]
    ]
    boxes = np.stack([part.box for part in parts if not part.open] or [part.box for part in parts])
    hull = np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)])
    box = np.array(marks.get("object", hull if kinds()[kind].laid_out else (0.0, 0.0, 1.0, 1.0)))
    wide, high = (box[2:] - box[:2]) * (marks["width"], marks["height"])
    height = find_height(kind, float(high / wide))
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


def is_like(marked: Reading, shape: Shape) -> tuple[bool, float]:
    """Whether the object has every marked front in its place, and the least overlap (IoU) of the two.

    Fronts are compared in the order of the cuts, on the front plane: the same tree of rows and columns,
    labels, and hinges where they are marked; and no two fronts that are apart in the photograph change
    places."""
    view, built = view_fronts(marked), read_shape(shape).fronts
    boxes = np.stack([front.box for front in built])
    cutting = cut_rectangles(boxes, [front.label == "drawer" for front in built])
    assert view.tree is not None
    order, own = list_leaves(view.tree), list_leaves(cutting.tree)
    if len(order) != len(own):
        return False, 0.0
    pairs = [(view.fronts[index], built[other]) for index, other in zip(order, own, strict=True)]
    alike = all(
        seen.part.label == made.label and seen.part.hinge in (None, made.hinge) for seen, made in pairs
    )
    same = describe_tree(view.tree, [""] * len(order)) == describe_tree(cutting.tree, [""] * len(own))
    kept = all(
        made.box[axis] < later.box[axis]
        for first, made in pairs
        for second, later in pairs
        for axis in (0, 1)
        if not (first.part.open or second.part.open) and first.part.box[axis + 2] <= second.part.box[axis]
    )
    scale = np.array([view.size[0], view.size[2]] * 2)
    least = min(
        float(overlap_boxes(made.box[None], (seen.bounds / scale)[None])[0, 0]) for seen, made in pairs
    )
    return alike and same and kept, least


def check(shape: Shape, folder: Path) -> str:
    """Writes a package and runs the static checks and the sweeps; what failed."""
    from envs.validate import validate
    from sim_export.files.write import write_package
    from sim_export.reference import build_reference

    report = validate(write_package(build_reference(shape), folder, "replace"))
    return "passes" if report.passed else "FAILS"


def main(
    folder: tyro.conf.Positional[Path],
    *,
    seed: int = 0,
    sheet: Path | None = None,
    out: Path | None = None,
    packages: int = 6,
) -> None:
    """Builds an object from the marks of every photograph, and compares.

    Args:
        folder: Photographs, index.csv and fronts.json.
        seed: Of what is not marked.
        sheet: PNG to write: the objects in order.
        out: Folder for packages, which are validated.
        packages: Number of packages, evenly spread over the photographs.
    """
    with (folder / "index.csv").open() as file:
        index = {row["file"]: row for row in csv.DictReader(file)}
    marks = json.loads((folder / "fronts.json").read_text())
    shapes: dict[str, Shape] = {}
    good, spent = 0, []
    build_from_reading(make_reading(next(iter(marks.values())), "Dresser", 0), 0)  # loads what is needed
    print("| photograph | kind | fronts | in place | least IoU | ms | notes |\n|---|---|---|---|---|---|---|")
    for name, own in marks.items():
        kind = index[name]["kind"]
        reading = make_reading(own, kind, int(index[name]["handles"] or 0))
        start = time.process_time()
        shape, notes = build_from_reading(reading, seed)
        spent.append(1e3 * (time.process_time() - start))
        shapes[name] = shape
        like, least = is_like(reading, shape)
        good += like
        said = "; ".join(notes)
        print(
            f"| {name} | {kind} | {len(reading.fronts)} | {like} | {least:.2f} | {spent[-1]:.0f} | {said} |",
            flush=True,
        )
    print(f"\n{good} of {len(shapes)} with every front in its place")
    print(f"ms, median {np.median(spent):.0f}, most {max(spent):.0f}")
    if sheet is not None:
        from PIL import Image

        from artigen.shapes.sheet import draw_sheet

        Image.fromarray(draw_sheet(list(shapes.values()), 0.0, 200, columns=7)).save(sheet)
    if out is not None:
        every = list(shapes)[:: max(1, len(shapes) // packages)]
        for name in every:
            print(name, check(shapes[name], out / Path(name).stem), flush=True)


if __name__ == "__main__":
    tyro.cli(main)
