"""Writes an evaluation: everything as JSON, tables as Markdown."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from artigen.io import write_whole
from artigen.metrics.evaluate import Evaluation
from artigen.metrics.packages import PackageReport

RECONSTRUCTION = (
    ("occupancy_recall", "occupancy recall", "percent", "98.94 %"),
    ("occupancy_precision", "occupancy precision", "percent", ""),
    ("occupancy_iou", "occupancy IoU", "percent", ""),
    ("label", "part type", "percent", "96.27 %"),
    ("small_label", "part type of handles and knobs", "percent", ""),
    ("joint_type", "joint type", "percent", "99.17 %"),
    ("moving_joint_type", "joint type of moving parts", "percent", ""),
    ("axis", "axis (degrees)", "plain", "1.14"),
    ("origin", "origin", "plain", "0.10"),
    ("line", "origin to the true axis line", "plain", ""),
    ("rotation", "range of rotation (degrees)", "plain", "7.37"),
    ("travel", "range of travel", "plain", "0.0159"),
    ("box_center", "box centre", "plain", "0.0357"),
    ("box_size", "box size", "plain", "0.0832"),
)
"""Key, name, form, and the paper's Table 3 (PartNet-Mobility test set)."""
SPREAD = (
    ("box_center", "box centre", (0.0211, 0.0159, 0.0277)),
    ("box_size", "box size", (0.0377, 0.0260, 0.0391)),
    ("axis", "axis", (0.1012, 0.0972, 0.0875)),
    ("origin", "origin", (0.0392, 0.0233, 0.0384)),
    ("rotation", "range of rotation (degrees)", (6.96, 7.56)),
    ("travel", "range of travel", (0.007, 0.0123)),
)
"""Key, name, and the paper's Table 4, which gives both limits; here the lower one is 0 by convention."""
ROWS = (
    ("valid", "valid", "percent"),
    ("category", "category", "percent"),
    ("counts", "counts exact", "percent"),
    ("size", "size within 5 %", "percent"),
    ("strict_rest", "RS strict", "plain"),
    ("strict_articulated", "AS strict", "plain"),
    ("strict_whole_rest", "whole, closed", "plain"),
    ("strict_whole_articulated", "whole, five states", "plain"),
    ("strict_rest_matched", "RS matched", "plain"),
    ("strict_articulated_matched", "AS matched", "plain"),
    ("compat_rest", "RS compat", "plain"),
    ("compat_articulated", "AS compat", "plain"),
    ("mmd", "MMD", "plain"),
    ("coverage", "COV", "percent"),
    ("one_nna", "1-NNA", "percent"),
    ("nearest_training", "to nearest training object", "plain"),
)
READING = {"counts": "counts of every label at once", "extents": "mean error of an extent"}
"""Names of scores whose keys are not self-explanatory."""


def write_report(evaluation: Evaluation, out: Path) -> tuple[Path, Path]:
    """Writes ``evaluation.json`` and ``evaluation.md``, each whole or not at all."""
    return write_evaluation(asdict(evaluation), format_report(evaluation), out)


def write_evaluation(found: Mapping[str, object], table: str, out: Path) -> tuple[Path, Path]:
    """Writes ``evaluation.json`` and ``evaluation.md``, each whole or not at all, and returns their paths."""
    out.mkdir(parents=True, exist_ok=True)
    text = json.dumps(dict(found), indent=1) + "\n"
    return write_whole(out / "evaluation.json", text), write_whole(out / "evaluation.md", table)


def format_report(evaluation: Evaluation) -> str:
    """Markdown tables: reconstruction, deviations within parts, draws and baselines."""
    lines = [f"Model {evaluation.model[:12]}, device {evaluation.device}."]
    if evaluation.reconstruction:
        lines += _format_reconstruction(evaluation)
    if evaluation.reading:
        read, sets = next(iter(evaluation.reading.values())), list(evaluation.reading)
        lines += ["", "## Pictures read", ""]
        lines += format_table(
            ("share of pictures read right", *sets),
            [
                (
                    READING.get(key, key),
                    *(format_score(evaluation.reading[one][key], "percent") for one in sets),
                )
                for key in read
            ],
        )
    lines += ["", "## First draws", ""]
    used = [row for row in ROWS if any(row[0] in one.scores for one in evaluation.rows)]
    lines += format_table(
        ("asked for", "method", "objects", *(name for _, name, _ in used)),
        [
            (
                one.ask,
                one.method,
                str(one.objects),
                *(format_score(one.scores.get(key), form) for key, _, form in used),
            )
            for one in evaluation.rows
        ],
    )
    lines += [
        "",
        "Strict and compat distances follow different protocols and are not comparable. Distances are",
        "squared: strict ones in the unit cube, compat ones in a cube of edge 2. 1-NNA: 50 % is perfect.",
        *_format_packages(evaluation.packages),
    ]
    if evaluation.left_out:
        lines += ["", "Real objects left out:", ""]
        lines += [f"- {name}: {reason}" for name, reason in sorted(evaluation.left_out.items())]
    return "\n".join(lines) + "\n"


def _format_reconstruction(evaluation: Evaluation) -> list[str]:
    """Results in the form of Tables 3 and 4 of the paper, beside the published values."""
    sets = list(evaluation.reconstruction)
    lines = ["", "## Reconstruction", ""]
    lines += format_table(
        ("held-out objects", *sets, "paper, its own data"),
        [
            (name, *(format_score(evaluation.reconstruction[one].get(key), form) for one in sets), paper)
            for key, name, form, paper in RECONSTRUCTION
        ],
    )
    lines += ["", "Standard deviation within a part, mean over parts:", ""]
    return lines + format_table(
        ("of", *sets, "paper, its own data"),
        [
            (name, *(_triple(evaluation.spread[one].get(key, ())) for one in sets), _triple(paper))
            for key, name, paper in SPREAD
        ],
    )


def _format_packages(report: PackageReport | None) -> list[str]:
    """Pass rates of packages by category, and causes of failures."""
    if report is None:
        return []
    lines = ["", "## Packages (counts and size asked for, checks L0 to L3)", ""]
    redrawn = f"within {report.redraws} redraws"
    lines += format_table(
        ("category", "objects", "a tree at once", "passes at once", redrawn, "draws"),
        [
            (
                name,
                str(one.objects),
                *(format_score(share, "percent") for share in (one.valid, one.first, one.within)),
                f"{one.draws:.2f}",
            )
            for name, one in report.scores.items()
        ],
    )
    if report.causes:
        lines += ["", "Draws that failed, by cause (one draw may have several):", ""]
        lines += format_table(
            ("cause", "first draws", "all draws"),
            [(cause, str(report.first_causes.get(cause, 0)), str(n)) for cause, n in report.causes.items()],
        )
    return lines


def format_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Lines of a Markdown table."""
    return [
        "| " + " | ".join(head) + " |",
        "|" + "---|" * len(head),
        *("| " + " | ".join(row) + " |" for row in rows),
    ]


def format_score(value: float | None, form: str) -> str:
    """A share in percent, other values with four digits, an empty string for None."""
    if value is None:
        return ""
    return f"{100 * value:.2f} %" if form == "percent" else f"{value:.4g}"


def _triple(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.4g}" for value in values)
