"""`choose_wall`: the fronts of a photograph that are on one wall, and the proportions of its plane."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from artigen.reader.layout.plane import Plane, frame_box
from artigen.reader.reading import ReadPart

FOCAL = 0.8
"""Focal length of a photograph of a room over its longer edge: that of a phone's main camera."""
TURN = 1.0
"""Growth of a front's height, per width of the picture, from which it is on a wall at an angle to the
picture: about 40 degrees."""


def list_corners(fronts: Sequence[ReadPart]) -> Float[np.ndarray, "N 4 2"]:
    return np.stack([frame_box(part.box) if part.corners is None else part.corners for part in fronts])


def choose_wall(
    fronts: Sequence[ReadPart], extent: Float[np.ndarray, "2"]
) -> tuple[tuple[ReadPart, ...], int]:
    """The fronts on the wall with most of them by area, and the number of others."""
    if not fronts:
        return (), 0
    quads = list_corners(fronts) * extent
    left, right = (np.linalg.norm(quads[:, a] - quads[:, b], axis=1) for a, b in ((3, 0), (2, 1)))
    across = (quads[:, 1:3, 0].mean(axis=1) - quads[:, [0, 3], 0].mean(axis=1)) / extent[0]
    turn = np.log(np.maximum(right, 1.0) / np.maximum(left, 1.0)) / np.maximum(across, 0.05)
    sides = np.digitize(turn, (-TURN, TURN))
    areas = np.prod(np.ptp(quads, axis=1), axis=1)
    chosen = int(np.argmax([areas[sides == side].sum() for side in range(3)]))
    kept = tuple(front for front, side in zip(fronts, sides, strict=True) if side == chosen)
    return kept, len(fronts) - len(kept)


def find_aspect(plane: Plane, extent: Float[np.ndarray, "2"]) -> float:
    """Length of a unit of x over that of a unit of y on a plane, by the focal length."""
    focal = FOCAL * extent.max()
    columns = np.diag([*extent, 1.0]) @ np.linalg.inv(plane.matrix)
    rays = np.array(
        [[1 / focal, 0, -extent[0] / 2 / focal], [0, 1 / focal, -extent[1] / 2 / focal], [0, 0, 1]]
    )
    across, along = np.linalg.norm(rays @ columns[:, :2], axis=0)
    return float(across / along)
