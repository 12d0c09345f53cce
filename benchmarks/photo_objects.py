"""Photographs to objects: is every front of a photograph met by one of the object, seen from the same place?

    python benchmarks/photo_objects.py FOLDER --sheet sheet.png

The folder holds photographs, ``index.csv`` and ``fronts.json`` as of `photo_layouts.py`. Every photograph is
read and built as by ``artigen generate --image``; the camera that was read is fitted to the fronts that were
read (`lay_over`), never to the marks. A marked front is met by a front of the same label whose box overlaps
with its own by at least `MET` (intersection over union). Superfluous fronts are counted, too. Colours are
those of the finishes of body and fronts against the medians of their pixels (CIE76)."""

import json
import time
from pathlib import Path

import numpy as np
import tyro
from jaxtyping import Float

from artigen.conditioning.image import open_picture
from artigen.errors import ArtigenError
from artigen.reader.comparison import draw_over, scale_camera
from artigen.reader.layout.build import build_from_reading
from artigen.reader.layout.nearest import overlap_boxes
from artigen.reader.layout.overlay import MET, lay_over, match_fronts
from artigen.reader.looks import look_closer
from artigen.reader.model import load_reader
from artigen.reader.read import read_image
from artigen.weights import READER

TILE = 220
"""Edge of a picture of the sheet (pixels)."""


def to_lab(color: Float[np.ndarray, "*N 3"]) -> Float[np.ndarray, "*N 3"]:
    """CIELAB (D65) of sRGB in [0, 1]."""
    linear = np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)
    matrix = np.array([(0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)])
    xyz = linear @ matrix.T / (0.9505, 1.0, 1.089)
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    x, y, z = np.moveaxis(f, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


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
    apart: list[float] = []
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
        overlaps = [0.0] * len(true)
        for i, j in match_fronts(true, overlay.parts):
            overlaps[i] = float(overlap_boxes(true[i][1][None], overlay.parts[j][1][None])[0, 0])
        met = sum(value >= MET for value in overlaps)
        good, met_fronts, total = good + (met == len(true)), met_fronts + met, total + len(true)
        more += max(0, len(overlay.parts) - len(true))
        finishes = dict(shape.finishes)
        colors = [front.color for front in reading.fronts if front.color is not None and not front.pane]
        for role, seen in (("body", [reading.color]), ("front", colors)):
            if role in finishes and seen:
                pixel = np.median(np.array(seen, dtype=np.float64), axis=0) / 255.0
                apart.append(float(np.linalg.norm(to_lab(pixel) - to_lab(np.array(finishes[role].color)))))
        said = " ".join(f"{value:.2f}" for value in overlaps)
        extra = max(0, len(overlay.parts) - len(true))
        print(
            f"| {name} | {shape.category} | {met} of {len(true)} | {said} | {extra} | {spent[-1]:.1f} |",
            flush=True,
        )
        if sheet is not None:
            photo = image.convert("RGBA")
            photo.thumbnail((TILE, TILE))
            tiles += [photo.convert("RGB"), draw_over(photo, scale_camera(overlay.camera, photo.size), shape)]
    print(
        f"\n{good} of {len(marks)} photographs with every front met, {met_fronts} of {total} fronts, {more} more"
    )
    print(f"s to read and build, median {np.median(spent):.1f}, most {max(spent):.1f}")
    print(f"colours apart (CIE76), median {np.median(apart):.1f}")
    if sheet is not None:
        paper = Image.new("RGB", (8 * TILE, -(-len(tiles) // 8) * TILE), (255, 255, 255))
        for index, tile in enumerate(tiles):
            paper.paste(tile, (index % 8 * TILE, index // 8 * TILE))
        paper.save(sheet)


if __name__ == "__main__":
    tyro.cli(main)
