"""Classifies procedural against real objects by simple features.

    python benchmarks/shapes_classifier.py out/shapes_statistics/features.json

reads the features measured by `shapes_statistics.py`, takes equally many procedural and real objects of each
category, and reports the cross-validated accuracy of a random forest and of logistic regression (0.5 is
chance) and the most important features of the forest.
"""

import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tyro
from shapes_features import Features, feature_names, feature_row
from sklearn.ensemble import RandomForestClassifier
from sklearn.linear_model import LogisticRegression
from sklearn.model_selection import StratifiedKFold, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    features: tyro.conf.Positional[Path]
    """``features.json`` of shapes_statistics.py."""
    out: Path = Path("out/shapes_statistics/classifier.md")
    """File of the table."""
    least: int = 8
    """Categories with fewer real objects are omitted."""
    repeats: int = 5
    """Number of draws of procedural objects and of folds."""


def balance(
    kept: dict[str, list[Features]], category: str | None, least: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Rows and labels (1: procedural), with equally many of both in every category."""
    rng = np.random.default_rng(seed)
    rows, labels = [], []
    names = sorted({one.category for one in kept["real"]})
    for name in names if category is None else [category]:
        theirs = [one for one in kept["real"] if one.category == name]
        ours = [one for one in kept["procedural"] if one.category == name]
        if len(theirs) < least:
            continue
        chosen = rng.choice(len(ours), size=min(len(theirs), len(ours)), replace=False)
        rows += [feature_row(one) for one in theirs] + [feature_row(ours[k]) for k in chosen]
        labels += [0] * len(theirs) + [1] * len(chosen)
    return np.array(rows), np.array(labels)


def models(seed: int) -> dict:
    """The two classifiers."""
    return {
        "forest": RandomForestClassifier(n_estimators=100, random_state=seed, n_jobs=1),
        "logistic": make_pipeline(StandardScaler(), LogisticRegression(max_iter=2000, C=0.3)),
    }


def score(rows: np.ndarray, labels: np.ndarray, seed: int) -> dict[str, float]:
    """Cross-validated accuracy of each classifier."""
    folds = StratifiedKFold(n_splits=5, shuffle=True, random_state=seed)
    return {
        name: float(cross_val_score(model, rows, labels, cv=folds).mean())
        for name, model in models(seed).items()
    }


def tell_tales(rows: np.ndarray, labels: np.ndarray) -> list[tuple[str, float, float]]:
    """Features by importance in the forest, with their means over procedural and real objects."""
    gains = models(0)["forest"].fit(rows, labels).feature_importances_
    ours, theirs = rows[labels == 1].mean(axis=0), rows[labels == 0].mean(axis=0)
    return [(feature_names()[k], float(ours[k]), float(theirs[k])) for k in np.argsort(-gains)]


def main(options: Options) -> int:
    """Scores all categories together and each separately."""
    stored = json.loads(options.features.read_text())
    kept = {kind: [Features(**one) for one in found] for kind, found in stored.items()}
    names = sorted({one.category for one in kept["real"]} & {one.category for one in kept["procedural"]})
    lines = ["| objects | of each kind | forest | logistic | important features (procedural / real mean) |"]
    lines.append("|---|---|---|---|---|")
    for name in (None, *names):
        scores: dict[str, list[float]] = {"forest": [], "logistic": []}
        rows, labels = balance(kept, name, options.least, 0)
        if not len(rows):
            continue
        for seed in range(options.repeats):
            drawn = balance(kept, name, options.least, seed)
            for model, value in score(*drawn, seed).items():
                scores[model].append(value)
        tales = tell_tales(rows, labels)[:6]
        told = "; ".join(f"{what} ({ours:.2g} / {theirs:.2g})" for what, ours, theirs in tales)
        cells = [f"{np.mean(scores[model]):.2f}" for model in ("forest", "logistic")]
        lines.append(f"| {name or 'all'} | {int((labels == 0).sum())} | {' | '.join(cells)} | {told} |")
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
