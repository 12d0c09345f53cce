"""Foreign folders in PartNet-Mobility's layout: labels from names, and flat collision shapes."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from artigen.types import PartLabel

PLATE_THICKNESS = 1e-3
"""Thickness (m) that a flat collision shape is read with."""

LABEL_WORDS: tuple[tuple[str, PartLabel], ...] = (
    ("handle", "handle"),
    ("knob", "knob"),
    ("button", "knob"),
    ("switch", "knob"),
    ("drawer", "drawer"),
    ("door", "door"),
    ("lid", "door"),
    ("tray", "tray"),
    ("shelf", "shelf"),
    ("wheel", "wheel"),
    ("caster", "wheel"),
)
"""Labels for words in PartNet-Mobility's semantics; the first match counts."""


def label_of(text: str) -> PartLabel | None:
    """Label for a PartNet-Mobility name that contains a known word; else None."""
    for word, label in LABEL_WORDS:
        if word in text:
            return label
    return None


def read_semantics(path: Path) -> dict[str, PartLabel]:
    """Label of every link with known semantics; none where there is no file."""
    return parse_semantics(path.read_text(errors="replace")) if path.is_file() else {}


def parse_semantics(text: str) -> dict[str, PartLabel]:
    """The same for what the file holds; links that do not move are the base."""
    labels: dict[str, PartLabel] = {}
    for line in text.splitlines():
        fields = line.split()
        if len(fields) < 3:
            continue
        link, kind, name = fields[:3]
        known = label_of(name)
        if kind in ("heavy", "static") or (kind == "free" and known != "wheel"):
            known = "base"
        if known is not None:
            labels[link] = known
    return labels


def thicken(points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "M 3"]:
    """Offsets points by half of `PLATE_THICKNESS` both ways along every direction in which they are flat."""
    centered = points - points.mean(axis=0)
    _, _, directions = np.linalg.svd(np.concatenate([centered, np.zeros((3, 3))]), full_matrices=False)
    for direction in directions:
        if np.ptp(points @ direction) < PLATE_THICKNESS:
            offset = direction * PLATE_THICKNESS / 2
            points = np.concatenate([points - offset, points + offset])
    return points
