"""Recovers parts and joints from the voxels of real objects: both recipes, true and noisy fields.

    python benchmarks/segmentation.py --data ../shared/data --out out/segmentation

reads every object of ``splits.json``, voxelises and encodes it, adds the noise of each row of
`NOISES`, segments the field with each recipe, and compares with the truth. Writes ``segmentation.json``
(every object) and ``segmentation.md`` (the tables of docs/reports/structure.md). One seed per object.
"""

import json
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import tyro
from field_noise import TABLE_4, TABLES_3_AND_4, FieldNoise, add_noise
from segment_score import PartScore, score_segmentation

from artigen.datasets.partnet_mobility import read_object
from artigen.errors import ArtigenError, SourceError
from artigen.types import Asset
from artigen.voxels.fields import VoxelFields, decode, encode
from artigen.voxels.segmentation.segment import SegmentConfig, segment
from artigen.voxels.voxelize import drop_unresolved, voxelize

NOISES: dict[str, FieldNoise | None] = {
    "true fields": None,
    "Table 4 noise": TABLE_4,
    "Tables 3 and 4": TABLES_3_AND_4,
    "Tables 3 and 4, smooth": replace(TABLES_3_AND_4, correlation=2.0),
}
RECIPES = ("paper", "robust")


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    data: Path
    """Folder with partnet_mobility/ and splits.json."""
    out: Path = Path("out/segmentation")
    """Folder for the results."""
    workers: int = 1
    """Objects at a time."""
    only: tuple[str, ...] = ()
    """Ids to run; all when empty."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One object, one noise, one recipe."""

    key: str
    category: str
    seven: bool
    noise: str
    recipe: str
    parts: tuple[PartScore, ...] = ()
    found_parts: int = 0
    complete: bool = False
    seconds: float = 0.0
    problem: str = ""


def run_object(folder: Path, *, seven: bool) -> list[Trial]:
    """All trials of one object."""
    try:
        asset = read_object(folder).asset
    except SourceError as err:
        return [
            Trial(key=folder.name, category="unreadable", seven=seven, noise="", recipe="", problem=str(err))
        ]
    assert asset.surface is not None
    asset = drop_unresolved(replace(asset, voxels=voxelize(asset.surface), surface=None))
    fields = decode(encode(asset))
    trials = []
    for name, noise in NOISES.items():
        rng = np.random.default_rng(int(folder.name))
        noisy = fields if noise is None else add_noise(fields, noise, rng)
        trials += [run_trial(asset, noisy, noise=name, recipe=recipe, seven=seven) for recipe in RECIPES]
    return trials


def run_trial(asset: Asset, fields: VoxelFields, *, noise: str, recipe: str, seven: bool) -> Trial:
    """Segments one field; parts without a parent in reach count against the tree, not the parts."""
    cfg = SegmentConfig(recipe="paper" if recipe == "paper" else "robust", detached="note")
    common = {"key": asset.name, "category": asset.category, "seven": seven, "noise": noise, "recipe": recipe}
    start = time.process_time()
    try:
        found = segment(fields, cfg, name=asset.name, scale=asset.scale, category=asset.category)
    except ArtigenError as err:
        return Trial(**common, problem=str(err))
    seconds = time.process_time() - start
    score = score_segmentation(asset, found)
    return Trial(
        **common,
        parts=score.parts,
        found_parts=score.found_parts,
        complete=score.complete,
        seconds=seconds,
    )


def describe(trials: list[Trial]) -> list[str]:
    """Numbers of one table row: objects, parts, joints, tree, boxes, seconds."""
    parts = [part for trial in trials for part in trial.parts]
    moving = [part for part in parts if part.axis_degrees is not None]

    def tail(values: list[float | None]) -> str:
        known = [value for value in values if value is not None]
        if not known:
            return "-"
        return " / ".join(f"{np.quantile(known, level):.2f}" for level in (0.5, 0.95, 1.0))

    def share(flags: list[bool | None]) -> str:
        known = [flag for flag in flags if flag is not None]
        return f"{100 * np.mean(known):.1f} %" if known else "-"

    return [
        f"{sum(trial.complete for trial in trials)} / {len(trials)}",
        share([trial.complete for trial in trials]),
        share([part.found for part in parts]),
        share([part.joint_type_right for part in parts]),
        tail([part.axis_degrees for part in moving]),
        tail([part.line_voxels for part in moving]),
        tail([None if part.range_error is None else 100 * part.range_error for part in moving]),
        share([part.parent_right for part in parts]),
        tail([part.box_voxels for part in parts if part.found]),
        tail([trial.seconds for trial in trials if trial.seconds]),
    ]


def spell_sizes(sizes: list[int]) -> str:
    """One size, or the span of several."""
    return str(min(sizes)) if min(sizes) == max(sizes) else f"{min(sizes)} to {max(sizes)}"


def lost_parts(trial: Trial) -> str:
    """The parts that were not found, by label, with their sizes in voxels."""
    lost: dict[str, list[int]] = {}
    for part in trial.parts:
        if not part.found:
            lost.setdefault(part.label, []).append(part.voxels)
    said = [f"{len(sizes)} {label} ({spell_sizes(sizes)} voxels)" for label, sizes in sorted(lost.items())]
    return "lost: " + (", ".join(said) or "none, but one or more too many")


def failures(trials: list[Trial]) -> Iterator[str]:
    """One line per incomplete object of the robust recipe."""
    for trial in trials:
        if trial.recipe != "robust" or trial.complete:
            continue
        reason = trial.problem or f"{len(trial.parts)} parts, {trial.found_parts} found; {lost_parts(trial)}"
        yield f"| {trial.noise} | {trial.key} | {trial.category} | {reason} |"


def write_tables(trials: list[Trial], path: Path) -> None:
    """The Markdown tables."""
    names = (
        "fields", "recipe", "objects", "whole", "parts", "joint type", "axis, degrees", "line, voxels",
        "range, %", "parent", "box, voxels", "CPU seconds",
    )  # fmt: skip
    head = "| " + " | ".join(names) + " |"
    lines = []
    for title, seven in (("Seven categories (train and val)", True), ("Others", False)):
        lines += [f"### {title}", "", head, "|" + "---|" * 12]
        for noise in NOISES:
            for recipe in RECIPES:
                rows = [t for t in trials if t.seven == seven and t.noise == noise and t.recipe == recipe]
                if rows:
                    lines.append("| " + " | ".join([noise, recipe, *describe(rows)]) + " |")
        lines.append("")
    lines += ["### Objects that the robust recipe does not find whole", ""]
    lines += ["| fields | object | category | what |", "|---|---|---|---|"]
    lines += [
        *failures(sorted(trials, key=lambda t: (list(NOISES).index(t.noise) if t.noise else -1, t.key)))
    ]
    unread = sorted(t.key for t in trials if t.category == "unreadable")
    lines += ["", f"Not readable, hence in no row: {', '.join(unread) or 'none'}."]
    path.write_text("\n".join(lines) + "\n")


def main(options: Options) -> int:
    """Runs the objects and writes the results."""
    splits = json.loads((options.data / "splits.json").read_text())
    wanted = [
        (key, split != "other")
        for split in ("train", "val", "other")
        for key in sorted(map(str, splits[split]))
    ]
    wanted = [(key, seven) for key, seven in wanted if not options.only or key in options.only]
    options.out.mkdir(parents=True, exist_ok=True)
    trials: list[Trial] = []
    with ProcessPoolExecutor(options.workers) as pool:
        waiting = [
            pool.submit(run_object, options.data / "partnet_mobility" / key, seven=seven)
            for key, seven in wanted
        ]
        for number, job in enumerate(waiting, 1):
            trials += job.result()
            print(f"\r{number} of {len(waiting)} objects", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    (options.out / "segmentation.json").write_text(json.dumps([asdict(trial) for trial in trials], indent=1))
    write_tables(trials, options.out / "segmentation.md")
    print((options.out / "segmentation.md").read_text())
    return 0


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
