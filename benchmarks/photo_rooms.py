"""Photographs of kitchens beside the rooms that become of them, with their checks.

    python benchmarks/photo_rooms.py --folder PHOTOGRAPHS --out out/photo_rooms
    python benchmarks/photo_rooms.py --own 100 101 102 103 --out out/photo_rooms

Every picture of the folder is taken through ``artigen scene kitchen --image`` with one seed, in the order of
their names; nothing is picked. Without photographs that may be shown, ``--own`` renders kitchens of our own
seeds from their entrances instead. Writes ``photo_rooms.jpg``, each picture beside the room, and prints for
each what was built, how many packages pass every check, and what is missing."""

import json
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import tyro
from PIL import Image
from save_picture import save_picture

from artigen.api.photo_room import furnish_photographed
from artigen.api.scene import PACKAGES, furnish_room
from artigen.conditioning.image import open_picture
from artigen.errors import ArtigenError
from artigen.runtime.runner import choose_runner

WIDTH, HEIGHT = 460, 320
"""Size of a picture of the sheet in pixels."""
ENDINGS = (".jpg", ".jpeg", ".png", ".webp", ".avif")


def photograph_own(seeds: Sequence[int], out: Path, packages: Path | None) -> list[Path]:
    """Views of kitchens of our own from their entrances; those that are there already are kept."""
    shown = []
    for seed in seeds:
        shown.append(out / f"own_{seed}" / "entrance.png")
        if not shown[-1].exists():
            furnish_room("kitchen", shown[-1].parent, seed, packages)
    return shown


def fit(image: Image.Image) -> Image.Image:
    """A picture within one cell of the sheet."""
    image = image.convert("RGB")
    image.thumbnail((WIDTH, HEIGHT))
    cell = Image.new("RGB", (WIDTH, HEIGHT), (255, 255, 255))
    cell.paste(image, ((WIDTH - image.width) // 2, (HEIGHT - image.height) // 2))
    return cell


def main(
    folder: Path | None = None,
    own: tuple[int, ...] = (),
    out: Path = Path("out/photo_rooms"),
    packages: Path | None = None,
    seed: int = 0,
    columns: int = 2,
    workers: int | None = None,
) -> int:
    """Makes a room of every picture.

    Args:
        folder: Photographs.
        own: Seeds of kitchens to render instead.
        out: Folder of the rooms and of the sheet.
        packages: Packages for these kitchens; default: each draws its own.
        seed: Of what the pictures do not show.
        columns: Pairs in a row of the sheet.
        workers: Worker processes; default: one per available core.
    """
    if (folder is None) == (not own):
        raise SystemExit("give --folder PHOTOGRAPHS or --own SEEDS")
    if folder is None:
        pictures = photograph_own(own, out, packages)
    else:
        pictures = sorted(path for path in folder.iterdir() if path.suffix.lower() in ENDINGS)
    cells: list[Image.Image] = []
    whole = 0
    for number, path in enumerate(pictures):
        start, room = time.perf_counter(), out / f"{number:02d}_{path.parent.name}_{path.stem}"
        cells.append(fit(open_picture(path)))
        try:
            made = furnish_photographed(path, room, seed, runner=choose_runner("local", workers))
        except ArtigenError as error:
            print(f"{path.name}: {error}", flush=True)
            cells.append(Image.new("RGB", (WIDTH, HEIGHT), (255, 255, 255)))
            continue
        passed = [
            json.loads(report.read_text())["passed"] for report in (room / PACKAGES).glob("*/validation.json")
        ]
        whole += all(passed)
        print(
            f"{path.name}: {made.describe()}\n{sum(passed)} of {len(passed)} packages pass every check, "
            f"{time.perf_counter() - start:.0f} s\n",
            flush=True,
        )
        cells.append(fit(Image.open(room / "entrance.png")))
    print(f"{whole} of {len(pictures)} pictures became a room whose packages all pass every check")
    rows = [
        np.hstack([np.asarray(cell) for cell in cells[k : k + 2 * columns]])
        for k in range(0, len(cells), 2 * columns)
    ]
    rows[-1] = np.pad(
        rows[-1], ((0, 0), (0, rows[0].shape[1] - rows[-1].shape[1]), (0, 0)), constant_values=255
    )
    save_picture(np.vstack(rows), out / "photo_rooms.jpg")
    return 0


if __name__ == "__main__":
    raise SystemExit(tyro.cli(main))
