"""Draws README's pictures of generated objects anew with the shipped model, sheets in catalogue light.

    python benchmarks/readme_pictures.py --out out/readme

generates the first seeds of every category, one object of every further kind, of twelve sentences, and one
for a picture of a held-out object of every category; nothing is picked. Packages stay in ``out``,
so a run that was stopped goes on. Prints which of them pass every check.
"""

import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import tyro
from jaxtyping import UInt8
from PIL import Image
from save_picture import save_picture

import artigen
from artigen.api.splats import draw_splats
from artigen.examples.photographs import photograph_shape
from artigen.kind import kinds, paper_kinds
from artigen.shapes.draw import draw_shape
from sim_export.files.read import read_package
from sim_export.picture.animation import write_animation
from sim_export.picture.preview import PreviewConfig, arrange_grid, contact_sheet, preview_package
from sim_export.picture.viewpoint import Viewpoint

SENTENCES = (
    ("a white fridge with black handles", 2),
    ("an oak cabinet with one door and one drawer", 0),
    ("a blue cabinet with two doors", 1),
    ("a black oven", 2),
)
"""What is asked for in words, and the seed."""
PLACES = (
    "a buffet with three drawers above three doors",
    "a desk with three drawers on the right",
    "a fridge with the freezer at the bottom, hinged on the left",
    "a bookcase with four shelves and two doors at the bottom",
    "a dresser with two small drawers above three wide drawers",
    "an island with six drawers, three on each side",
    "a wardrobe with three doors and two drawers at the bottom",
    "a nightstand with two drawers on castors",
)
"""Sentences that say where parts are; each is drawn with seed 0."""
EACH = 2
"""Objects of each category on the sheet."""
PHOTOGRAPH = 220
"""Edge of a photograph in pixels."""
SMALL = PreviewConfig(viewpoint=Viewpoint(width=220, height=220), light="catalogue")
"""How the objects of sheets are seen."""


def draw_categories(out: Path) -> list[Path]:
    """Packages of the first seeds of every category."""
    for category in paper_kinds():
        artigen.generate(kind=category, count=EACH).export(out, workers=EACH)
    return [out / f"{category}_{seed}" for category in paper_kinds() for seed in range(EACH)]


def draw_further_kinds(out: Path) -> list[Path]:
    """Packages of the first seed of every kind beside those of the paper."""
    further = [kind for kind in kinds() if kind not in paper_kinds()]
    for kind in further:
        artigen.generate(kind=kind, count=1, gaussians=False).export(out)
    return [out / f"{kind}_0" for kind in further]


def draw_sentences(out: Path) -> list[Path]:
    """One package for each sentence."""
    packages = []
    for number, (text, seed) in enumerate(SENTENCES):
        folder = out / str(number)
        artigen.generate(text, seed=seed, count=1).export(folder)
        packages += sorted(path.parent for path in folder.glob("*/mobility.urdf"))
    return packages


def draw_places(out: Path) -> list[Path]:
    """One package for each sentence about places."""
    for number, text in enumerate(PLACES):
        artigen.generate(text, count=1, gaussians=False).export(out / str(number))
    return [path.parent for path in sorted(out.glob("*/*/mobility.urdf"))]


def draw_photographs(out: Path) -> list[tuple[UInt8[np.ndarray, "H W 3"], Path]]:
    """Photographs of held-out procedural objects, and the packages that are made of them."""
    pairs = []
    for category in paper_kinds():
        folder, picture = out / category, out / f"{category}.png"
        folder.mkdir(parents=True, exist_ok=True)
        rgba = photograph_shape(draw_shape(category, 0), 0, PHOTOGRAPH)
        Image.fromarray(rgba).save(picture)
        artigen.generate(image=picture, count=1).export(folder)
        share = rgba[..., 3:] / 255.0
        shown = share * rgba[..., :3] + (1.0 - share) * SMALL.render.background
        package = next(path.parent for path in sorted(folder.glob("*/mobility.urdf")))
        pairs.append((np.rint(shown).astype(np.uint8), package))
    return pairs


def show_photographs(
    pairs: Sequence[tuple[UInt8[np.ndarray, "H W 3"], Path]],
) -> UInt8[np.ndarray, "H W 3"]:
    """Every photograph beside its object, closed and open, two in a row."""
    cells = []
    for photograph, folder in pairs:
        made = contact_sheet([read_package(folder)], SMALL)[:PHOTOGRAPH]
        cells.append(np.concatenate([photograph, made], axis=1))
    return arrange_grid(cells, PreviewConfig(columns=2))


def draw_kinds() -> UInt8[np.ndarray, "H W 3"]:
    """The first seed of every kind of the grammar, open."""
    cells = [artigen.sample(kind, 0).render(SMALL.viewpoint, q=0.8, light=SMALL.light) for kind in kinds()]
    return arrange_grid(cells, PreviewConfig(columns=6))


def main(out: Path = Path("out/readme"), images: Path = Path("docs/images")) -> int:
    """Draws everything.

    Args:
        out: Folder for the packages.
        images: Folder for the pictures.
    """
    save_picture(draw_kinds(), images / "kinds.jpg")
    sheet = draw_categories(out / "categories")
    save_picture(contact_sheet([read_package(folder) for folder in sheet], SMALL), images / "generated.jpg")
    further = draw_further_kinds(out / "kinds")
    wide = replace(SMALL, columns=4)
    save_picture(
        contact_sheet([read_package(folder) for folder in further], wide), images / "generated_kinds.jpg"
    )
    told = draw_sentences(out / "sentences")
    write_animation(told, images / "generated.gif", draw_splats=draw_splats)
    save_picture(preview_package(read_package(told[0]), draw_splats=draw_splats), images / "white_fridge.jpg")
    placed = draw_places(out / "places")
    save_picture(contact_sheet([read_package(folder) for folder in placed], wide), images / "said.jpg")
    shown = draw_photographs(out / "photographs")
    save_picture(show_photographs(shown), images / "photos.jpg")
    for folder in (*sheet, *further, *told, *placed, *(package for _, package in shown)):
        report = json.loads((folder / "validation.json").read_text())
        print(f"{folder}: {'passes' if report['passed'] else 'fails'}")
    return 0


if __name__ == "__main__":
    sys.exit(tyro.cli(main))
