"""Guesses the unit of lengths where an object would be as long as a street in metres."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from artigen.datasets.partnet_meshes import PieceMesh
from artigen.datasets.sizes import estimate_size

LONGEST = 40.0
"""No object is longer (m); its unit is another one."""
UNITS = {"millimetres": 0.001, "centimetres": 0.01, "inches": 0.0254}
SHARE = 0.01
"""Offsets and travels of joints below this share of the object's longest edge are in metres all the same."""


def guess_unit(extents: np.ndarray, category: str) -> tuple[float, str]:
    """Metres per length of a file and a sentence; the unit that brings an object nearest to its usual size.

    Args:
        extents: Depth, width and height, as if in metres.
    """
    longest = float(extents.max())
    if longest <= LONGEST:
        return 1.0, ""
    usual, _ = estimate_size(category, extents)
    unit = min(UNITS, key=lambda name: abs(np.log(UNITS[name] * longest / usual)))
    said = f"lengths are read as {unit}: in metres, the object would be {longest:,.0f} m long"
    return UNITS[unit], said


def scale_meshes(pieces: Sequence[PieceMesh], factor: float) -> tuple[PieceMesh, ...]:
    """The pieces with their files scaled, each about its own origin."""
    scaled = []
    for piece in pieces:
        origin = piece.T_tree_file[:3, 3]
        vertices = factor * (piece.mesh.vertices - origin) + origin
        scaled.append(replace(piece, mesh=replace(piece.mesh, vertices=vertices), scale=factor * piece.scale))
    return tuple(scaled)
