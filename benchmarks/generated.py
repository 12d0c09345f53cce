"""Measures generated objects by category: passed checks, number of draws, cost.

    python benchmarks/generated.py --out out/generated --each 10

generates the first seeds of every category as `artigen generate` does, then asks for the header of as many
held-out procedural objects (all counts, all extents) and measures whether it is met. Nothing is picked.
Packages stay in ``out``, so a run that was stopped goes on. Writes generated.json and prints a table.
"""

import json
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tyro

import artigen
from artigen.api.batch import read_journal
from artigen.api.generate import GenerateSettings
from artigen.kind import paper_kinds
from artigen.shapes.draw import draw_shape
from artigen.shapes.solids import list_solids
from artigen.sketch.draw import DrawConfig
from artigen.sketch.model import SketchConfig, draw_object, load_sketch_network
from artigen.sketch.network import SketchNetwork
from artigen.sketch.request import SketchRequest
from artigen.types import PART_LABELS
from artigen.weights import SHIPPED


@dataclass(frozen=True, kw_only=True)
class Row:
    """What was measured of one category; counts of objects, and means."""

    category: str
    objects: int
    first: int
    """Passed every check as first drawn."""
    within: int
    """Passed within the redraws."""
    counts: int
    """Delivered all counts of a held-out header."""
    extents: int
    """Met all its extents within 1 %."""
    sound: int
    """Drawn of such a header without a fault."""
    draw_seconds: float
    """Processor seconds from a header to a `Shape`."""
    package_seconds: float
    """Wall seconds from category to written package, checks aside."""


def measure_packages(category: str, out: Path, each: int, workers: int) -> tuple[int, int, float]:
    """Packages that pass at once and in the end, and mean seconds of the draw that stayed."""
    artigen.generate(kind=category, count=each).export(out, workers=workers)
    lines = [line for key, line in read_journal(out).items() if key.startswith(f"{category}_")]
    origins = [
        json.loads((out / line.key / "provenance.json").read_text()) for line in lines if line.error is None
    ]
    draws = [json.loads(origin["draws"]) for origin in origins]
    passed = [bool(line.passed) for line in lines if line.error is None]
    seconds = [sum(spent for name, spent in line.seconds if name != "validate") for line in lines]
    first = sum(good and len(said) == 1 for good, said in zip(passed, draws, strict=True))
    return first, sum(passed), float(np.mean(seconds))


def measure_headers(network: SketchNetwork, category: str, each: int) -> tuple[int, int, int, float]:
    """Objects that deliver held-out counts and extents, those without faults, and seconds per object."""
    counts = extents = sound = 0
    spent = 0.0
    for seed in range(each):
        asked = draw_shape(category, seed).condition
        held = dict(asked.counts)
        request = SketchRequest(
            category=category,
            counts=tuple((label, held.get(label, 0)) for label in PART_LABELS),
            depth=asked.depth,
            width=asked.width,
            height=asked.height,
        )
        started = time.process_time()
        drawn = draw_object(
            network,
            request,
            seed,
            SketchConfig(draw=DrawConfig(temperature=GenerateSettings().temperature)),
        )
        spent += time.process_time() - started
        solids = list_solids(drawn.shape)
        have = solids.high.max(axis=0) - solids.low.min(axis=0)
        want = np.array([asked.depth, asked.width, asked.height])
        counts += dict(drawn.shape.condition.counts) == {k: v for k, v in held.items() if v}
        extents += bool((np.abs(have - want) <= 0.01 * want).all())
        sound += not drawn.faults
    return counts, extents, sound, spent / each


def write_table(rows: Sequence[Row]) -> str:
    """The rows as a Markdown table, totals last."""
    lines = [
        "| category | pass at first | within redraws | counts | extents | s to `Shape` | s to package |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        checks = f"{row.first} of {row.objects} | {row.within} of {row.objects}"
        seconds = f"{row.draw_seconds:.1f} | {row.package_seconds:.1f}"
        lines.append(f"| {row.category} | {checks} | {row.counts} | {row.extents} | {seconds} |")
    total = sum(row.objects for row in rows)
    first, within, counts, extents = (
        sum(getattr(row, name) for row in rows) for name in ("first", "within", "counts", "extents")
    )
    lines.append(f"| all | {first} of {total} | {within} of {total} | {counts} | {extents} | | |")
    return "\n".join(lines)


def main(out: Path, each: int = 10, workers: int = 2, model: Path = SHIPPED) -> int:
    """Measures generated objects of the seven categories.

    Args:
        out: Folder for packages and results.
        each: Objects of each category.
        workers: Processes side by side.
        model: Folder of the model whose headers are measured; packages are of the one that ships.
    """
    network = load_sketch_network(model)
    rows = []
    for category in paper_kinds():
        first, within, package_seconds = measure_packages(category, out, each, workers)
        counts, extents, sound, draw_seconds = measure_headers(network, category, each)
        rows.append(
            Row(
                category=category,
                objects=each,
                first=first,
                within=within,
                counts=counts,
                extents=extents,
                sound=sound,
                draw_seconds=draw_seconds,
                package_seconds=package_seconds,
            )
        )
        sys.stdout.write(f"{rows[-1]}\n")
    (out / "generated.json").write_text(json.dumps([vars(row) for row in rows], indent=1))
    sys.stdout.write(f"\n{write_table(rows)}\n")
    return 0


if __name__ == "__main__":
    sys.exit(tyro.cli(main))
