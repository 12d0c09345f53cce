"""Photographs to packages by ``artigen.generate``: does every one pass every check, and in what time?

    python benchmarks/photo_packages.py FOLDER OUT --sheet sheet.png

Every picture of the folder is taken through ``artigen.generate(image=...)`` with one seed; packages with
their reports are kept below OUT. Seconds are those of one core, from picture to validated package."""

import json
import time
from pathlib import Path

import numpy as np
import tyro

import artigen
from artigen.conditioning.image import open_picture
from artigen.errors import ArtigenError

TILE = 300
"""Edge of a picture of the sheet (pixels)."""
COLUMNS = 8
"""Pictures in a row of the sheet: photographs beside objects."""
ENDINGS = (".jpg", ".jpeg", ".png", ".webp", ".avif")


def main(
    folder: tyro.conf.Positional[Path],
    out: tyro.conf.Positional[Path],
    *,
    seed: int = 0,
    open_share: float = 0.0,
    sheet: Path | None = None,
) -> None:
    """Generates, checks and times an object of every picture.

    Args:
        folder: The pictures.
        out: Folder of the packages.
        seed: Of what is not seen.
        open_share: Share of its range to which every joint is open on the sheet.
        sheet: PNG to write: photographs beside objects.
    """
    from PIL import Image

    pictures = sorted(path for path in folder.iterdir() if path.suffix.lower() in ENDINGS)
    spent: list[float] = []
    passed = 0
    tiles: list[Image.Image] = []
    print("| photograph | kind | s | draws | failed checks |\n|---|---|---|---|---|")
    for path in pictures:
        start = time.process_time()
        try:
            made = artigen.generate(image=path, seed=seed)
        except ArtigenError as error:
            print(f"| {path.name} | | {time.process_time() - start:.1f} | | {error} |", flush=True)
            continue
        spent.append(time.process_time() - start)
        assert made.report is not None
        failed = [check.id for check in made.report.failures]
        passed += made.report.passed
        draws = len(json.loads(dict(made.package.provenance)["draws"]))
        print(f"| {path.name} | {made.kind} | {spent[-1]:.1f} | {draws} | {', '.join(failed)} |", flush=True)
        made.export(out / path.stem, existing="replace")
        if sheet is not None:
            photo = open_picture(path).convert("RGB")
            photo.thumbnail((TILE, TILE))
            tiles += [photo, Image.fromarray(made.render(q=open_share)).resize((TILE, TILE))]
    print(f"\n{passed} of {len(pictures)} pass every check")
    print(f"s of one core, median {np.median(spent):.1f}, most {max(spent):.1f}")
    if sheet is not None:
        paper = Image.new("RGB", (COLUMNS * TILE, -(-len(tiles) // COLUMNS) * TILE), (255, 255, 255))
        for index, tile in enumerate(tiles):
            paper.paste(tile, (index % COLUMNS * TILE, index // COLUMNS * TILE))
        paper.save(sheet)


if __name__ == "__main__":
    tyro.cli(main)
