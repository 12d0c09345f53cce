"""Writes an evaluation of an appearance model: everything as JSON, a table as Markdown."""

from dataclasses import asdict
from pathlib import Path

from artigen.metrics.evaluate_appearance import AppearanceEvaluation
from artigen.metrics.report import format_score, format_table, write_evaluation

ROWS = (
    ("psnr", "PSNR (dB)", "plain"),
    ("ssim", "SSIM", "plain"),
    ("object", "PSNR of the object's pixels", "plain"),
    ("exposed", "of newly exposed pixels", "plain"),
    ("rest", "of its other pixels", "plain"),
    ("exposed_share", "newly exposed share", "percent"),
    ("frechet", "Fréchet distance", "plain"),
    ("kernel", "kernel distance", "plain"),
)
"""Key, name, form."""


def write_appearance_report(evaluation: AppearanceEvaluation, out: Path) -> tuple[Path, Path]:
    """Writes ``evaluation.json`` and ``evaluation.md``, each whole or not at all."""
    return write_evaluation(asdict(evaluation), format_appearance(evaluation), out)


def format_appearance(evaluation: AppearanceEvaluation) -> str:
    """One row per joint state, and one for all."""
    said = ", ".join(f"{name} {value}" for name, value in sorted(evaluation.description.items()))
    rows = {**evaluation.states, "all": evaluation.total}
    lines = [f"Model {evaluation.model[:12]} ({said}), device {evaluation.device}.", ""]
    lines += ["## Autoencoded held-out objects", ""]
    lines += format_table(
        ("joints open by", *(name for _, name, _ in ROWS)),
        [
            (share, *(format_score(scores.get(key), form) for key, _, form in ROWS))
            for share, scores in rows.items()
        ],
    )
    lines += [
        "",
        f"{len(evaluation.objects)} objects, {evaluation.pictures} pictures in each of the two sets. PSNR is",
        f"a mean over objects. Distances between sets are those of {evaluation.extractor} features: compare",
        "them only with results that have the same features and as many pictures.",
    ]
    lines += [
        "",
        f"Gaussians to the true surface (Chamfer, squared, unit cube, whole object): closed (RS) "
        f"{evaluation.total['shape_rest']:.4g}, mean over states (AS) "
        f"{evaluation.total['shape_articulated']:.4g}.",
    ]
    if evaluation.drawn:
        keys = [row for row in ROWS if row[0] in ("psnr", "ssim", "object", "exposed", "rest")]
        lines += ["", "## Drawn on true voxels", ""]
        lines += format_table(
            ("told", *(name for _, name, _ in keys)),
            [("paint", *(format_score(evaluation.drawn.get(key), form) for key, _, form in keys))],
        )
    lines += ["", "## Colours of parts", ""]
    lines += format_table(
        ("Gaussians are", "error of the mean colour of a part"),
        [(name, format_score(value, "plain")) for name, value in evaluation.colors.items()],
    )
    lines += [
        "",
        "Mean absolute difference of sRGB values in [0, 1], over the parts that the closed object shows.",
        "The flow draws on the true voxels, told the paint of both of their sides.",
    ]
    return "\n".join(lines) + "\n"
