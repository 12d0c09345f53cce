"""How well the painter tells which colour the sides of voxels have, on true voxels and on drawn ones.

    python benchmarks/painter.py --out out/painter

gives the painter the true palettes of held-out procedural objects, once on their own voxels and once on those
that the structure model draws within their outlines, and compares what it paints with the surface. Sides
count where samples show them. A pair of neighbours on one surface is torn where the painter gives them
different colours and the surface does not: islands and frayed borders. Writes ``painter.md``.
"""

import sys
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tyro
from jaxtyping import Float, Int

from artigen.appearance import load_appearance_model
from artigen.facings import SIDES
from artigen.fields import tabulate_parts
from artigen.figures import find_edges
from artigen.generate import load_structure_model
from artigen.metrics.report import format_table
from artigen.models.painter import paint_voxels
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.train.appearance.drawn import DrawnVoxels, keep_voxels, redraw
from artigen.train.appearance.examples import lay_true_voxels, paint_parts
from artigen.train.appearance.paint import VoxelPaint, read_paint
from artigen.types import PAPER_CATEGORIES
from artigen.weights import SHIPPED
from sim_export.geometry.surface import sample_surface

ALIKE = 0.08
"""Root mean square difference of sRGB within which two colours are alike."""
ENOUGH = 4
"""Samples that show a side."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """What to run."""

    model: Path = SHIPPED
    """Folder of the trained appearance model."""
    structure: Path = SHIPPED
    """Folder of the structure model that draws."""
    out: Path = Path("out/painter")
    """Where the table goes."""
    objects: int = 28
    """Held-out objects, categories in turn."""


def score(
    painted: Float[np.ndarray, "N 7"], drawn: DrawnVoxels, paint: VoxelPaint, edges: Int[np.ndarray, "E 2"]
) -> dict[str, Float[np.ndarray, "K"]]:
    """Squared errors, sides that are right, panes that are, and pairs of neighbours that are torn."""
    rows, like = drawn.rows, drawn.like
    colors = painted[:, :-1].reshape(-1, SIDES, 3)
    shown = paint.known[like] >= ENOUGH
    squared = ((colors[rows] - paint.colors[like]) ** 2).mean(axis=2)[shown]
    true = np.full((len(painted), SIDES, 3), np.nan)
    true[rows] = np.where(shown[..., None], paint.colors[like], np.nan)
    apart = [_differ(one[edges[:, 0]], one[edges[:, 1]]) for one in (colors, true)]
    known = ~np.isnan(apart[1])
    return {
        "squared": squared,
        "right": squared <= ALIKE**2,
        "panes": (painted[rows, -1] > 0) == (paint.clear[like] > 0.02),
        "torn": (apart[0] > ALIKE)[known] & (apart[1] <= ALIKE)[known],
    }


def _differ(one: Float[np.ndarray, "E 2 3"], other: Float[np.ndarray, "E 2 3"]) -> Float[np.ndarray, "E 2"]:
    return np.sqrt(((one - other) ** 2).mean(axis=2))


def main(options: Options) -> int:
    """Runs all objects and writes the table."""
    model, structure = load_appearance_model(options.model), load_structure_model(options.structure)
    if model.painter is None:
        raise SystemExit(f"{options.model}: preset without a painter")
    edge, found = model.preset.decoder.trunk.resolution, defaultdict(list)
    for number in range(options.objects):
        kinds = len(PAPER_CATEGORIES)
        shape = draw_shape(PAPER_CATEGORIES[number % kinds], number // kinds)
        asset, facings = lay_true_voxels(shape, shape_to_asset(shape, edge))
        assert asset.voxels is not None
        paint, palettes, table = (
            read_paint(shape, asset, facings),
            paint_parts(shape, asset),
            tabulate_parts(asset),
        )
        ways = {
            "true": keep_voxels(asset.voxels, facings),
            "drawn": redraw(structure, asset, facings, np.random.default_rng(number), sample_surface),
        }
        for name, drawn in ways.items():
            places = (drawn.coords, drawn.part_ids, drawn.facings)
            painted = paint_voxels(model.painter, *places, table, palettes, edge)
            found[name].append(score(painted, drawn, paint, find_edges(*places, edge)))
        print(f"{number + 1} of {options.objects}: {asset.name}", file=sys.stderr)
    table = []
    for name, scores in found.items():
        means = {key: np.array([one[key].mean() for one in scores]) for key in scores[0]}
        table.append(
            (
                name,
                f"{np.sqrt(means['squared']).mean():.3f}",
                *(f"{100 * means[key].mean():.1f} %" for key in ("right", "panes")),
                f"{100 * means['torn'].mean():.2f} %",
            )
        )
    head = ("voxels", "root mean square error of sRGB", f"sides within {ALIKE}", "panes right", "pairs torn")
    text = "\n".join(format_table(head, table)) + "\n"
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "painter.md").write_text(text)
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
