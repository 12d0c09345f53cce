"""Converts every object of a PartNet-Mobility folder and measures the results.

    python benchmarks/conversion.py OBJECTS -o out/bench --stages convert originals likeness table

``OBJECTS`` holds ``partnet_mobility/`` and ``splits.json``. Stages are resumable; the table is made of
what the others left in the output folder, and is what docs/reports/benchmarks.md shows.
"""

import json
import statistics
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Literal

import tyro
from likeness import measure_likeness
from tqdm import tqdm

import artigen
from artigen.api.batch import Finished, read_journal
from artigen.api.check import validate_packages
from artigen.runtime.runner import LocalRunner
from artigen.runtime.workers import Outcome, Worker, run_supervised
from envs.config import ValidateConfig
from sim_export.report import Report, report_from_json, report_to_json

Stage = Literal["convert", "originals", "likeness", "table"]
LEVELS = ("L0", "L1", "L2", "L3")
Groups = dict[str, list[str]]


def main(
    objects: tyro.conf.Positional[Path],
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])] = Path("out/bench"),
    stages: tuple[Stage, ...] = ("convert", "originals", "likeness", "table"),
    workers: int = 2,
    *,
    visual: Literal["voxels", "source"] = "voxels",
    mend: bool = False,
) -> None:
    """Runs the stages in the order given."""
    splits = json.loads((objects / "splits.json").read_text())
    groups = {"seven categories": sorted(splits["train"] + splits["val"]), "others": sorted(splits["other"])}
    sources = objects / "partnet_mobility"
    out.mkdir(parents=True, exist_ok=True)
    for stage in stages:
        if stage == "convert":
            folders = tuple(sources / key for keys in groups.values() for key in keys)
            artigen.convert(folders, visual=visual, mend=mend).export(out / "packages", workers=workers)
        elif stage == "originals":
            validate_originals(sources, groups, out / "originals", workers)
        elif stage == "likeness":
            measure_all(sources, groups, out, workers)
        else:
            text = table(groups, out)
            (out / "table.md").write_text(text)
            print(text)


def validate_originals(sources: Path, groups: Groups, out: Path, workers: int) -> None:
    """The same checks on the folders as they are."""
    out.mkdir(exist_ok=True)
    keys = [key for group in groups.values() for key in group if not (out / f"{key}.json").exists()]
    folders = [sources / key for key in keys]
    cfg, runner = ValidateConfig(output="none"), LocalRunner(workers=workers)
    for report in tqdm(validate_packages(folders, cfg, runner), total=len(folders)):
        (out / f"{report.package}.json").write_text(report_to_json(report))


def likeness_of(job: tuple[Path, Path]) -> dict:
    """Runs in a worker."""
    return asdict(measure_likeness(*job))


def measure_all(sources: Path, groups: Groups, out: Path, workers: int) -> None:
    """Distances and free space of every package, one JSON line each."""
    path = out / "likeness.jsonl"
    known = {json.loads(line)["key"] for line in path.read_text().splitlines()} if path.exists() else set()
    journal = read_journal(out / "packages")
    keys = [
        key for group in groups.values() for key in group
        if key not in known and key in journal and journal[key].error is None
    ]  # fmt: skip

    def handle(worker: Worker, key: str) -> tuple[str, Outcome[dict]]:
        return key, worker.call(likeness_of, (sources / key, out / "packages" / key), 300.0)

    with path.open("a") as lines:
        for key, outcome in tqdm(run_supervised(handle, keys, workers=workers), total=len(keys)):
            lines.write(json.dumps(outcome.value or {"key": key, "error": outcome.error}) + "\n")
            lines.flush()


def table(groups: Groups, out: Path) -> str:
    """All results as markdown."""
    journal = read_journal(out / "packages")
    likeness = {}
    if (out / "likeness.jsonl").exists():
        rows = [json.loads(line) for line in (out / "likeness.jsonl").read_text().splitlines()]
        likeness = {row["key"]: row for row in rows}
    return "\n".join(
        section
        for name, keys in groups.items()
        for section in (
            f"### {name} ({len(keys)} objects)\n",
            conversion_rows(keys, journal, out),
            likeness_rows(keys, likeness),
            timing_rows(keys, journal),
            failure_rows(keys, journal),
        )
    )


def load_report(path: Path) -> Report | None:
    """A report that a stage left, if it did."""
    return report_from_json(path.read_text()) if path.exists() else None


def share(count: int, total: int) -> str:
    """``118 of 122 (96.7 %)``."""
    return f"{count} of {total} ({100 * count / total:.1f} %)" if total else "-"


def conversion_rows(keys: list[str], journal: dict[str, Finished], out: Path) -> str:
    """Conversion and validation, ours beside the originals."""
    written = [key for key in keys if key in journal and journal[key].error is None]
    ours = {key: load_report(out / "packages" / key / "validation.json") for key in written}
    theirs = {key: load_report(out / "originals" / f"{key}.json") for key in keys}
    lines = ["| | converted | original folders |", "|---|---|---|"]
    lines.append(f"| packages written | {share(len(written), len(keys))} | |")
    checks = (("loads in SAPIEN", "V301"), ("compiles in MuJoCo", "V308"), ("yourdfpy validates", "V002"))
    for title, check in checks:
        lines.append(f"| {title} ({check}) | {passing(ours, (check,))} | {passing(theirs, (check,))} |")
    for level in LEVELS:
        lines.append(f"| {level} | {passing_level(ours, (level,))} | {passing_level(theirs, (level,))} |")
    lines.append(
        f"| **L0 to L3** | **{passing_level(ours, LEVELS)}** | **{passing_level(theirs, LEVELS)}** |"
    )
    return "\n".join(lines) + "\n"


def passing(reports: dict[str, Report | None], ids: tuple[str, ...]) -> str:
    """How many reports have none of these checks failed."""
    good = [
        report is not None and all(c.verdict != "fail" for c in report.checks if c.id in ids)
        for report in reports.values()
    ]
    return share(sum(good), len(good))


def passing_level(reports: dict[str, Report | None], levels: tuple[str, ...]) -> str:
    """How many reports have no failed check of these levels."""
    good = [
        report is not None and all(c.verdict != "fail" for c in report.checks if c.level in levels)
        for report in reports.values()
    ]
    return share(sum(good), len(good))


def likeness_rows(keys: list[str], likeness: dict[str, dict]) -> str:
    """Distances in voxels, free space kept."""
    rows = [likeness[key] for key in keys if key in likeness and "error" not in likeness[key]]
    if not rows:
        return ""
    lines = ["| likeness, voxels | mean | median | worst | objects above 0.6 |", "|---|---|---|---|---|"]
    for name, title in (
        ("forth_closed", "export to source, closed"), ("forth_open", "export to source, five open states"),
        ("back_closed", "source to export, closed"), ("back_open", "source to export, five open states"),
    ):  # fmt: skip
        values = [row[name] for row in rows]
        worst = max(rows, key=lambda row: row[name])
        lines.append(
            f"| {title} | {statistics.mean(values):.2f} | {statistics.median(values):.2f} | "
            f"{worst[name]:.2f} ({worst['key']}) | {sum(value > 0.6 for value in values)} |"
        )
    hollow = [row for row in rows if row["cavity_cells"] > 0]
    kept = [row["cavity_kept"] for row in hollow]
    below = sorted(row["key"] for row in hollow if row["cavity_kept"] < 0.9)
    lines.append(
        f"\nFree space kept: mean {100 * statistics.mean(kept):.1f} % over {len(hollow)} hollow objects; "
        f"below 90 %: {', '.join(below) or 'none'}.\n"
    )
    return "\n".join(lines)


def timing_rows(keys: list[str], journal: dict[str, Finished]) -> str:
    """Seconds and memory per object, stage by stage."""
    done = [journal[key] for key in keys if key in journal and journal[key].seconds]
    if not done:
        return ""
    stages = [name for name, _ in done[0].seconds]
    lines = ["| stage, s per object | median | 90 % | worst |", "|---|---|---|---|"]
    columns = [(name, [dict(line.seconds).get(name, 0.0) for line in done]) for name in stages]
    columns.append(("**all**", [sum(spent for _, spent in line.seconds) for line in done]))
    for name, values in columns:
        ordered = sorted(values)
        worst = done[values.index(ordered[-1])].key
        lines.append(
            f"| {name} | {statistics.median(values):.2f} | {ordered[int(0.9 * (len(ordered) - 1))]:.2f} | "
            f"{ordered[-1]:.2f} ({worst}) |"
        )
    peak = max(line.peak_mib for line in done)
    lines.append(f"\nPeak memory of a worker process: {peak:.0f} MiB.\n")
    return "\n".join(lines)


def failure_rows(keys: list[str], journal: dict[str, Finished]) -> str:
    """Which checks failed how often, and every object that did not make it."""
    counts: Counter[str] = Counter()
    lines = []
    for key in keys:
        finished = journal.get(key)
        if finished is None or finished.good:
            continue
        counts.update({failure.split(" ")[0] for failure in finished.failures})
        why = "; ".join((*finished.failures, *finished.as_in_source))
        lines.append(f"| {key} | {finished.error or why} |")
    summary = ", ".join(f"{check} {count}" for check, count in counts.most_common())
    own = [key for key in keys if (line := journal.get(key)) and is_as_in_source(line)]
    explained = (
        f"As in the source: {share(len(own), len(keys))} fail only what the source fails: "
        f"{', '.join(own) or '-'}."
    )
    return "\n".join(
        [f"Failed checks: {summary or 'none'}.\n", explained, "", "| object | why |", "|---|---|", *lines, ""]
    )


def is_as_in_source(line: Finished) -> bool:
    """Whether a package fails checks, and the source is known to fail all of them."""
    failed = {failure.split(" ")[0] for failure in line.failures}
    return bool(failed) and failed <= {said.split(" ")[0] for said in line.as_in_source}


if __name__ == "__main__":
    tyro.cli(main)
