"""Photographs to objects: are stand, panels, pulls and finishes right, and how far off are the colours?

    python benchmarks/photo_style.py FOLDER --sheet sheet.png

The folder holds photographs and ``fronts.json`` as of `photo_objects.py`. `photo_looks.csv` beside this file
says what each photograph shows, judged by eye: what the object stands on (furniture only), the fields of its
doors and of its drawers, its pulls and the material of its fronts; ``a/b`` where both are fair, ``-`` where
nothing can be told. Doors or drawers that are missing in the object are wrong.

Colours are compared where the object covers the photograph as it is seen from the camera that was read: the
medians of the pixels of every marked front and of the body, without the marked fronts and the outer
`EDGE` of each, with those of the object in even light (CIEDE2000)."""

import csv
import json
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import tyro
from jaxtyping import Float

from artigen.conditioning.image import open_picture
from artigen.errors import ArtigenError
from artigen.reader.comparison import draw_over, render_over, scale_camera
from artigen.reader.ground import find_outline
from artigen.reader.layout.build import build_from_reading
from artigen.reader.layout.frontal import LONG
from artigen.reader.layout.overlay import Overlay, lay_over, match_fronts
from artigen.reader.layout.relief import find_field, measure_depths
from artigen.reader.looks import look_closer
from artigen.reader.model import load_reader
from artigen.reader.read import read_image
from artigen.shapes.render.shading import EVEN_LIGHT
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.color_difference import ciede2000, convert_to_lab
from artigen.weights import READER

if TYPE_CHECKING:
    from PIL import Image

TILE, COLUMNS = 260, 8
"""Edge of a picture of the sheet (pixels), and pictures in a row."""
LOOKS = Path(__file__).with_name("photo_looks.csv")
EDGE = 0.15
"""Share of a region at each side that may belong to something else."""
LOOKED = ("stand", "doors", "drawers", "pull", "finish")
RAISED = 0.06
"""Height (m) below the lowest front from which a closed base is a plinth: the board that carries the lowest
front, and the least plinth of the grammar."""
CLOSED = 0.7
"""Share of an object's width that its base covers just above the floor from which it stands on no legs."""
PULLED = 0.3
"""Share of fronts with pulls below which these are strays."""
FILLED = 0.5
"""Share of a pull's box that a cup covers where it stands out; bows and pendants are open."""
THICK = 0.018
"""Thickness (m) across that no short bar has."""
LONGEST = 0.2
"""Length (m) that no cup has."""


def name_stand(shape: Shape) -> str:
    """What an object stands on, by its shape: castors, legs, plinth or floor."""
    if any(part.label == "wheel" for part in shape.parts):
        return "castors"
    low, high = shape.bounds()
    at = low[2] + 0.02
    held = [
        solid
        for part in shape.parts
        for solid in part.primitives
        if solid.center[2] - solid.size[2] / 2 <= at <= solid.center[2] + solid.size[2] / 2
    ]
    steps = np.linspace(low[1], high[1], 400)
    covered = np.zeros(len(steps), bool)
    for solid in held:
        covered |= np.abs(steps - solid.center[1]) <= solid.size[1] / 2
    if covered.mean() < CLOSED:
        return "legs"
    lowest = min((part.bounds()[0, 2] for part in list_fronts(shape)), default=low[2])
    return "plinth" if lowest - low[2] >= RAISED else "floor"


def list_fronts(shape: Shape) -> list[ShapePart]:
    return [part for part in shape.parts if part.label in ("door", "drawer")]


def name_panel(part: ShapePart) -> str:
    """The field of a front: flat, framed, slats or glass."""
    field = find_field(part)
    return "glass" if field is None else "slats" if field == "planks" else field


def name_pull(shape: Shape) -> str:
    """The commonest pulls of an object's doors and drawers; none where fewer than `PULLED` have any."""
    found = Counter[str]()
    for front in list_fronts(shape):
        own = [part for part in shape.parts if part.label == "handle" and part.parent == front.name]
        found[_name_handle(own[0]) if own else "none"] += 1
    if found.total() - found["none"] < PULLED * found.total() or not found:
        return "none"
    return max((name for name in found if name != "none"), key=lambda name: found[name])


def _name_handle(part: ShapePart) -> str:
    """A knob is about as wide as high, a cup is filled where it stands out, an edge is one thin board."""
    size = np.ptp(part.bounds(), axis=0)
    if len(part.primitives) == 1:
        return "edge"
    if size[1:].max() < LONG * size[1:].min():
        return "knob"
    depth, _ = measure_depths(part)
    filled = np.mean(depth < part.bounds()[0, 0] + size[0] / 2) > FILLED
    return "cup" if filled and size[1:].min() > THICK and size[1:].max() < LONGEST else "bar"


def describe_shape(shape: Shape) -> dict[str, str]:
    """What an object shows, as in `photo_looks.csv`."""
    said = {"stand": name_stand(shape), "pull": name_pull(shape)}
    for label, column in (("door", "doors"), ("drawer", "drawers")):
        found = Counter(name_panel(part) for part in list_fronts(shape) if part.label == label)
        said[column] = found.most_common(1)[0][0] if found else "missing"
    finishes = dict(shape.finishes)
    worn = Counter(part.primitives[0].finish for part in list_fronts(shape))
    role = worn.most_common(1)[0][0] if worn else "body"
    return said | {"finish": finishes[role].kind}


def compare_colors(
    image: "Image.Image", marks: list[dict[str, object]], shape: Shape, overlay: Overlay
) -> dict[str, float]:
    """CIEDE2000 of every marked front that the object has, and of the body."""
    small = image.convert("RGB")
    small.thumbnail((512, 512))
    pixels = np.asarray(small, dtype=np.float64) / 255.0
    seen = render_over(scale_camera(overlay.camera, small.size), shape, EVEN_LIGHT)
    boxes = [(str(mark["label"]), np.array(mark["box"], dtype=np.float64)) for mark in marks]
    parts = list_fronts(shape)
    names = [part.name for part in shape.parts]
    differences: dict[str, float] = {}
    for i, j in match_fronts(boxes, overlay.parts):
        own = seen.rgb[seen.part_ids == names.index(parts[j].name)]
        if len(own):
            inside = _mask(boxes[i][1], pixels.shape)
            differences[f"front {i}"] = _differ(pixels[inside], own)
    body = (seen.part_ids == 0) & seen.mask
    outline = find_outline(image)
    if outline is not None and outline.shape == body.shape:
        body &= outline
    for _, box in boxes:
        body &= ~_mask(box, pixels.shape, edge=-0.02)
    if body.sum() > 50:
        differences["body"] = _differ(pixels[body], seen.rgb[(seen.part_ids == 0) & seen.mask])
    return differences


def _mask(box: Float[np.ndarray, "4"], shape: tuple[int, ...], edge: float = EDGE) -> np.ndarray:
    """The inner pixels of a box (shares)."""
    inset = edge * np.tile(box[2:] - box[:2], 2) * (1, 1, -1, -1)
    at = (box + inset) * np.tile((shape[1], shape[0]), 2)
    x0, y0, x1, y1 = np.clip(np.round(at), 0, np.tile((shape[1], shape[0]), 2)).astype(int)
    out = np.zeros(shape[:2], bool)
    out[y0 : max(y1, y0 + 1), x0 : max(x1, x0 + 1)] = True
    return out


def _differ(one: np.ndarray, other: np.ndarray) -> float:
    first, last = (convert_to_lab(np.median(pixels, axis=0)) for pixels in (one, other))
    return float(ciede2000(first, last))


def main(
    folder: tyro.conf.Positional[Path],
    *,
    looks: Path = LOOKS,
    seed: int = 0,
    sheet: Path | None = None,
) -> None:
    """Reads, builds and judges every photograph.

    Args:
        folder: Photographs and fronts.json.
        looks: What they show.
        seed: Of what is not seen.
        sheet: PNG to write: photographs beside objects over them.
    """
    from PIL import Image

    marks = json.loads((folder / "fronts.json").read_text())
    reader = load_reader(READER)
    right, told = Counter[str](), Counter[str]()
    fronts: list[float] = []
    bodies: list[float] = []
    tiles: list[Image.Image] = []
    print("| photograph | kind | " + " | ".join(LOOKED) + " | fronts | body |")
    print("|" + "---|" * (4 + len(LOOKED)))
    for row in csv.DictReader(looks.read_text().splitlines()):
        name = row["file"]
        image = open_picture(folder / name)
        try:
            reading = look_closer(read_image(image, reader, name), image)
            shape, _ = build_from_reading(reading, seed)
        except ArtigenError as error:
            print(f"| {name} | {error} |")
            told.update(what for what in LOOKED if row[what] != "-")
            continue
        made = describe_shape(shape)
        cells = []
        for what in LOOKED:
            if row[what] == "-":
                cells.append("")
                continue
            good = made[what] in row[what].split("/")
            told[what] += 1
            right[what] += good
            cells.append(made[what] if good else f"**{made[what]}** ({row[what]})")
        overlay = lay_over(reading, shape)
        off = compare_colors(image, marks[name]["fronts"], shape, overlay)
        bodies += [value for region, value in off.items() if region == "body"]
        own = [value for region, value in off.items() if region != "body"]
        fronts += own
        cells += [f"{np.median(own):.1f}" if own else "", f"{off['body']:.1f}" if "body" in off else ""]
        print(f"| {name} | {shape.category} | {' | '.join(cells)} |", flush=True)
        if sheet is not None:
            photo = image.convert("RGBA")
            photo.thumbnail((TILE, TILE))
            over = draw_over(photo, scale_camera(overlay.camera, photo.size), shape)
            tiles += [photo.convert("RGB"), over]
    print()
    for what in LOOKED:
        print(f"{what}: {right[what]} of {told[what]} ({right[what] / max(1, told[what]):.0%})")
    print(
        f"CIEDE2000, median: fronts {np.median(fronts):.1f} ({len(fronts)}), bodies {np.median(bodies):.1f} "
        f"({len(bodies)}), all {np.median(fronts + bodies):.1f}"
    )
    if sheet is not None:
        paper = Image.new("RGB", (COLUMNS * TILE, -(-len(tiles) // COLUMNS) * TILE), (255, 255, 255))
        for index, tile in enumerate(tiles):
            paper.paste(tile, (index % COLUMNS * TILE, index // COLUMNS * TILE))
        paper.save(sheet)


if __name__ == "__main__":
    tyro.cli(main)
