"""Compares procedural with real objects: counts, joints, ranges, sizes, occupancy, coverage of counts.

    python benchmarks/shapes_statistics.py ../shared/data/partnet_mobility --out out/shapes_statistics

Real objects are PartNet-Mobility folders and not part of this repository. Writes ``statistics.md``,
histograms as PNG, and ``features.json`` for `shapes_classifier.py`. Real objects are measured once: remove
``real.json`` to measure them again.
"""

import json
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np
import tyro
from PIL import Image, ImageDraw
from shapes_features import Features, describe_drawn, describe_real

from artigen.kind import kinds, paper_kinds
from artigen.shapes.draw import draw_shape
from artigen.types import JOINT_TYPES, PART_LABELS

PROCEDURAL, REAL = (196, 122, 52), (70, 110, 170)


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    real: tyro.conf.Positional[Path]
    """Folder of PartNet-Mobility objects."""
    out: Path = Path("out/shapes_statistics")
    """Folder for tables, plots and numbers."""
    count: int = 200
    """Procedural objects per category."""
    draws: int = 5_000
    """Procedural objects per category for the coverage of counts."""
    workers: int = 2
    """Number of processes."""


def measure_real(options: Options) -> list[Features]:
    """Features of the readable real objects of all known categories."""
    stored = options.out / "real.json"
    if stored.is_file():
        return [Features(**one) for one in json.loads(stored.read_text())]
    folders = [
        path
        for path in sorted(options.real.iterdir())
        if (path / "meta.json").is_file()
        and json.loads((path / "meta.json").read_text())["model_cat"] in kinds()
    ]
    with ProcessPoolExecutor(options.workers) as pool:
        real = [one for one in pool.map(describe_real, folders) if one is not None]
    stored.write_text(json.dumps([asdict(one) for one in real]))
    return real


def draw_counts(category: str, seed: int) -> tuple[int, ...]:
    """Number of parts by label of one object."""
    labels = [part.label for part in draw_shape(category, seed).parts]
    return tuple(labels.count(label) for label in PART_LABELS)


def quantiles(values: list[float]) -> str:
    """Median, 5 % and 95 % quantile."""
    if not values:
        return "-"
    low, middle, high = np.quantile(values, [0.05, 0.5, 0.95])
    return f"{middle:.3g} ({low:.3g} to {high:.3g})"


def compare(title: str, rows: dict[str, tuple[list[float], list[float]]]) -> list[str]:
    """A Markdown table of quantities, procedural and real."""
    lines = [f"### {title}", "", "| | procedural | real |", "|---|---|---|"]
    lines += [
        f"| {name} | {quantiles(ours)} | {quantiles(theirs)} |" for name, (ours, theirs) in rows.items()
    ]
    return [*lines, ""]


def quantities(ours: list[Features], theirs: list[Features]) -> dict[str, tuple[list[float], list[float]]]:
    """All quantities in the table of one category."""
    rows: dict[str, tuple[list[float], list[float]]] = {}

    def add(name: str, read) -> None:
        found = tuple([float(v) for one in group for v in read(one)] for group in (ours, theirs))
        if any(found[0]) or any(found[1]):
            rows[name] = (found[0], found[1])

    for label in PART_LABELS[1:]:
        add(f"{label}s", lambda one, label=label: [one.counts.get(label, 0)])
    for kind in JOINT_TYPES:
        add(f"{kind} joints", lambda one, kind=kind: [one.joints.get(kind, 0)])
    add("depth / longest", lambda one: [one.size[0]])
    add("width / longest", lambda one: [one.size[1]])
    add("height / longest", lambda one: [one.size[2]])
    add("occupied cells", lambda one: [one.occupied])
    add("share of cells inside", lambda one: [one.profile[-1]])
    add("door range, degrees", lambda one: one.ranges.get("door revolute", []))
    add("drawer range / longest", lambda one: one.ranges.get("drawer prismatic", []))
    add("tray range / longest", lambda one: one.ranges.get("tray prismatic", []))
    for label in ("drawer", "door", "handle", "knob"):
        for axis, what in enumerate(("depth", "width", "height")):
            add(
                f"{label} box, {what}",
                lambda one, label=label, axis=axis: [size[axis] for size in one.boxes.get(label, [])],
            )
    return rows


def coverage(theirs: list[Features], seen: list[tuple[int, ...]]) -> list[str]:
    """Number of real objects whose counts lie in the range of the drawn ones, by label and together."""
    span = np.array(seen)
    low, high = span.min(axis=0), span.max(axis=0)
    known = set(seen)
    lines, inside, exact = [], 0, 0
    for one in theirs:
        counts = tuple(one.counts.get(label, 0) for label in PART_LABELS)
        beyond = [
            f"{count} {label} ({low[k]} to {high[k]})"
            for k, (label, count) in enumerate(zip(PART_LABELS, counts, strict=True))
            if not low[k] <= count <= high[k]
        ]
        inside += not beyond
        exact += counts in known
        if beyond:
            lines.append(f"| {one.name} | {', '.join(beyond)} |")
    head = (
        f"{inside} of {len(theirs)} real objects have counts inside the span drawn, {exact} have exactly the "
        f"counts of one of {len(seen)} drawn objects."
    )
    return [head, "", *(["| beyond | counts (drawn) |", "|---|---|", *lines, ""] if lines else [])]


def plot_histograms(rows: dict[str, tuple[list[float], list[float]]], path: Path) -> None:
    """Writes a PNG of small histograms, procedural above and real below."""
    tile, across = (260, 130), 4
    names = list(rows)
    sheet = Image.new("RGB", (across * tile[0], -(-len(names) // across) * tile[1]), "white")
    pen = ImageDraw.Draw(sheet)
    for number, name in enumerate(names):
        left, top = number % across * tile[0] + 10, number // across * tile[1] + 8
        pen.text((left, top), name, fill="black")
        both = rows[name]
        values = np.array([*both[0], *both[1]])
        edges = np.linspace(values.min(), values.max() + 1e-9, 25)
        for group, color, base, sign in ((both[0], PROCEDURAL, top + 58, -1), (both[1], REAL, top + 62, 1)):
            if not group:
                continue
            share = np.histogram(group, edges)[0] / len(group)
            for k, value in enumerate(share / share.max()):
                x = left + 10 * k
                end = base + sign * round(42 * float(value))
                pen.rectangle((x, min(base, end), x + 8, max(base, end)), fill=color)
        pen.text((left, top + 106), f"{edges[0]:.3g}", fill="gray")
        pen.text((left + 205, top + 106), f"{edges[-1]:.3g}", fill="gray")
    sheet.save(path)


def main(options: Options) -> int:
    """Measures and compares, and writes the results."""
    options.out.mkdir(parents=True, exist_ok=True)
    real = measure_real(options)
    lines: list[str] = []
    kept: dict[str, list[dict]] = {"procedural": [], "real": []}
    with ProcessPoolExecutor(options.workers) as pool:
        for name in kinds():
            theirs = [one for one in real if one.category == name]
            ours = list(pool.map(partial(describe_drawn, name), range(options.count), chunksize=8))
            kept["procedural"] += [asdict(one) for one in ours]
            kept["real"] += [asdict(one) for one in theirs]
            rows = quantities(ours, theirs)
            lines += compare(f"{name}: {len(ours)} procedural, {len(theirs)} real", rows)
            plot_histograms(rows, options.out / f"{name.lower()}.png")
            if theirs:
                seen = list(pool.map(partial(draw_counts, name), range(options.draws), chunksize=64))
                lines += coverage(theirs, seen)
            print(f"{name} done", file=sys.stderr, flush=True)
    (options.out / "features.json").write_text(json.dumps(kept))
    (options.out / "statistics.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    return 0 if set(paper_kinds()) <= set(kinds()) else 1


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
