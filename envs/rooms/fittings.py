"""Furniture without joints that no kind makes, of boxes: bed, sofa, armchair, bench, shower.

Corners are in the frame of a cluster: fronts face -x, backs are at x = 0, z is up; y is in widths.
"""

from dataclasses import dataclass

import numpy as np

from .pieces import Boxes, Piece

Corner = tuple[float, float, float]
WOOD, CLOTH, SEAM = (0.55, 0.41, 0.29), (0.50, 0.53, 0.50), (0.44, 0.47, 0.44)
STEEL = (0.72, 0.73, 0.74)


@dataclass(frozen=True, kw_only=True)
class Fitting:
    """Its width (m), and its boxes: name, lowest and highest corner, colour (sRGB in [0, 1])."""

    width: float
    parts: tuple[tuple[str, Corner, Corner, Corner], ...]


def _seat(seats: int, arm: float) -> tuple[tuple[str, Corner, Corner, Corner], ...]:
    """A sofa of as many seats, with arms of that width (in widths)."""
    edges = np.linspace(arm, 1.0 - arm, seats + 1)
    cushions = [
        part
        for number, (low, high) in enumerate(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))
        for part in (
            (f"seat_{number}", (-0.88, low + 0.004, 0.30), (-0.22, high - 0.004, 0.44), CLOTH),
            (f"cushion_{number}", (-0.40, low + 0.006, 0.44), (-0.22, high - 0.006, 0.80), CLOTH),
        )
    ]
    return (
        ("base", (-0.86, 0.01, 0.08), (-0.06, 0.99, 0.30), SEAM),
        ("back", (-0.22, 0.0, 0.30), (-0.04, 1.0, 0.78), SEAM),
        ("arm_right", (-0.88, 0.0, 0.30), (-0.22, arm, 0.60), SEAM),
        ("arm_left", (-0.88, 1.0 - arm, 0.30), (-0.22, 1.0, 0.60), SEAM),
        *(
            (f"foot_{name}", (x - 0.06, y, 0.0), (x, y + 0.03, 0.08), WOOD)
            for name, x, y in (("a", -0.78, 0.03), ("b", -0.78, 0.94), ("c", -0.08, 0.03), ("d", -0.08, 0.94))
        ),
        *cushions,
    )


FITTINGS = {
    "bed": Fitting(
        width=1.6,
        parts=(
            ("frame", (-2.05, 0.0, 0.06), (-0.07, 1.0, 0.28), (0.62, 0.47, 0.33)),
            ("mattress", (-2.02, 0.02, 0.28), (-0.07, 0.98, 0.50), (0.93, 0.92, 0.89)),
            ("blanket", (-2.03, 0.005, 0.36), (-0.75, 0.995, 0.52), (0.47, 0.55, 0.66)),
            ("pillow_a", (-0.58, 0.08, 0.50), (-0.12, 0.46, 0.62), (0.97, 0.97, 0.95)),
            ("pillow_b", (-0.58, 0.54, 0.50), (-0.12, 0.92, 0.62), (0.97, 0.97, 0.95)),
            ("headboard", (-0.07, -0.01, 0.0), (-0.01, 1.01, 1.02), WOOD),
        ),
    ),
    "sofa": Fitting(width=2.1, parts=_seat(3, 0.09)),
    "armchair": Fitting(width=0.9, parts=_seat(1, 0.17)),
    "shower": Fitting(
        width=0.9,
        parts=(
            ("tray", (-0.9, 0.0, 0.0), (-0.012, 1.0, 0.05), (0.94, 0.94, 0.93)),
            ("drain", (-0.5, 0.44, 0.05), (-0.4, 0.56, 0.052), STEEL),
            ("column", (-0.05, 0.48, 0.85), (-0.02, 0.52, 2.06), STEEL),
            ("valve", (-0.09, 0.4, 1.0), (-0.05, 0.6, 1.05), STEEL),
            ("arm", (-0.4, 0.48, 2.03), (-0.05, 0.52, 2.06), STEEL),
            ("head", (-0.44, 0.37, 2.0), (-0.22, 0.63, 2.03), STEEL),
            ("screen", (-0.88, 0.0, 0.05), (-0.012, 0.012, 1.98), (0.80, 0.88, 0.88)),
        ),
    ),
    "bench": Fitting(
        width=1.1,
        parts=(
            ("seat", (-0.37, 0.0, 0.42), (-0.01, 1.0, 0.46), WOOD),
            ("leg_right", (-0.35, 0.04, 0.0), (-0.03, 0.08, 0.42), WOOD),
            ("leg_left", (-0.35, 0.92, 0.0), (-0.03, 0.96, 0.42), WOOD),
            ("shelf", (-0.35, 0.08, 0.14), (-0.03, 0.92, 0.165), WOOD),
        ),
    ),
}
"""Fittings by their roles."""


def make_fitting(role: str) -> Piece:
    """A fitting as a piece against the wall."""
    fitting = FITTINGS[role]
    bodies = np.array([[low, high] for _, low, high, _ in fitting.parts]) * [1.0, fitting.width, 1.0]
    return Piece(role=role, entry=None, boxes=Boxes(bodies=bodies), face=float(bodies[:, 0, 0].min()))
