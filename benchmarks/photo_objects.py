"""Photographs to objects: is every front of a photograph met by one of the object, seen from the same place?

    python benchmarks/photo_objects.py FOLDER --sheet sheet.png

The folder holds photographs, ``index.csv`` with a column ``kind``, and ``fronts.json``: by file width and
height (pixels), and fronts with label, box (shares of width and height, y down), hinge and open. Every
photograph is read and built as by ``artigen generate --image``; the camera that was read is fitted to the
fronts that were read (`lay_over`), never to the marks. A marked front is met by a front of the same label
whose box overlaps with its own by at least `MET` (intersection over union). Superfluous fronts count, too."""

import json
import time
from pathlib import Path

import numpy as np
import tyro

from artigen.conditioning.image import open_picture
from artigen.errors import ArtigenError
from artigen.reader.comparison import draw_over, scale_camera
from artigen.reader.layout.build import build_from_reading
from artigen.reader.layout.overlay import MET, lay_over, rate_fronts
from artigen.reader.looks import look_closer
from artigen.reader.model import load_reader
from artigen.reader.read import read_image
from artigen.weights import READER

TILE = 220
"""Edge of a picture of the sheet (pixels)."""


def main(folder: tyro.conf.Positional[Path], *, seed: int = 0, sheet: Path | None = None) -> None:
    """Reads, builds and compares every photograph.

    Args:
        folder: Photographs, index.csv and fronts.json.
        seed: Of what is not seen.
        sheet: PNG to write: photographs beside objects over them.
    """
    from PIL import Image

    marks = json.loads((folder / "fronts.json").read_text())
    reader = load_reader(READER)
    good, met_fronts, total, more = 0, 0, 0, 0
    spent: list[float] = []
    tiles: list[Image.Image] = []
    print("| photograph | kind | met | overlaps | superfluous | s |\n|---|---|---|---|---|---|")
    for name, own in marks.items():
        image = open_picture(folder / name)
        start = time.process_time()
        try:
            reading = look_closer(read_image(image, reader, name), image)
            shape, _ = build_from_reading(reading, seed)
        except ArtigenError as error:
            print(f"| {name} | {error} |")
            total += len(own["fronts"])
            continue
        spent.append(time.process_time() - start)
        overlay = lay_over(reading, shape)
        true = [(front["label"], np.array(front["box"])) for front in own["fronts"]]
        overlaps = rate_fronts(true, overlay.parts)
        met = sum(value >= MET for value in overlaps)
        good, met_fronts, total = good + (met == len(true)), met_fronts + met, total + len(true)
        said = " ".join(f"{value:.2f}" for value in overlaps)
        extra = max(0, len(overlay.parts) - len(true))
        more += extra
        print(
            f"| {name} | {shape.category} | {met} of {len(true)} | {said} | {extra} | {spent[-1]:.1f} |",
            flush=True,
        )
        if sheet is not None:
            photo = image.convert("RGBA")
            photo.thumbnail((TILE, TILE))
            over = draw_over(photo, scale_camera(overlay.camera, photo.size), shape)
            tiles += [photo.convert("RGB"), over]
    print(f"\n{good} of {len(marks)} photographs met in full, {met_fronts} of {total} fronts; {more} more")
    print(f"s to read and build, median {np.median(spent):.1f}, most {max(spent):.1f}")
    if sheet is not None:
        paper = Image.new("RGB", (8 * TILE, -(-len(tiles) // 8) * TILE), (255, 255, 255))
        for index, tile in enumerate(tiles):
            paper.paste(tile, (index % 8 * TILE, index // 8 * TILE))
        paper.save(sheet)


if __name__ == "__main__":
    tyro.cli(main)
