"""`fit_outline`: the proportions of an object from its outline, and from where it is seen.

The outline of a cuboid is a hexagon at most, whose sides are its edges as they are seen: it tells how wide,
deep and high the cuboid is, but for its size, as far as the view lets it be seen."""

import numpy as np
from jaxtyping import Bool, Float
from scipy.optimize import least_squares
from scipy.spatial import ConvexHull

from artigen.camera import project_points
from artigen.reader.layout.frontal import place_camera

DIRECTIONS = 48
"""Directions in which the extents of outlines are compared."""
EXACT = 0.03
"""Standard deviation of an extent, as a share of the largest one: objects are not quite cuboids."""
FACE = (0.03, 0.25)
"""The same of the ends of the fronts on their face, which are a frame's width within it."""
LENGTHS = 0.2
"""The same of the logarithm of a length that was read."""
VIEW = (0.3, 0.08, 0.05)
"""The same of yaw and pitch (radians), and of the logarithm of half the diagonal over the distance."""
TURNS = (-0.4, 0.0, 0.4)
"""Yaws (radians) from which the search starts, beside the read one: outlines of either side differ little."""
NEAR = 1e-3
"""Least half of the diagonal over the distance."""

Lengths = tuple[float, float, float]


def fit_outline(
    outline: Bool[np.ndarray, "H W"], size: Lengths, view: Lengths, ends: tuple[float, float] | None = None
) -> tuple[Lengths, Lengths]:
    """Lengths and view of the cuboid with an outline that are nearest to those that were read.

    Args:
        outline: Pixels of the whole object, square.
        size: Width, depth and height (m), as usual for what is seen.
        view: Yaw, pitch (radians) and half the diagonal over the distance, as read.
        ends: Left and right end of the fronts, as shares of the width; None where there are none.

    Returns:
        The same of the cuboid; the product of its lengths is as it was read, since a picture has no scale.
    """
    turns = np.linspace(0.0, 2.0 * np.pi, DIRECTIONS, endpoint=False)
    along = np.stack([np.cos(turns), np.sin(turns)])
    rows, columns = np.nonzero(outline)
    pixels = np.stack([columns, rows], axis=1).astype(np.float64)
    seen = (pixels[ConvexHull(pixels).vertices] @ along).max(axis=0)
    scale = float((seen + np.roll(seen, DIRECTIONS // 2)).max())
    start = np.array([view[0], view[1], np.log(max(view[2], NEAR))])
    logs = np.log(size)

    def differ(values: Float[np.ndarray, "6"]) -> Float[np.ndarray, "R"]:
        width, depth, height = np.exp(logs + values[:3])
        yaw, pitch, near = start + values[3:]
        half = np.array([depth, width, height]) / 2
        camera = place_camera(-half, half, (yaw, pitch, float(np.exp(near))))
        signs = np.stack(np.meshgrid(*[(-1.0, 1.0)] * 3), axis=-1).reshape(-1, 3)
        cuboid = (project_points(camera, signs * half)[:, :2] @ along).max(axis=0)
        linear = np.concatenate([cuboid[None], along])
        fitted = np.linalg.lstsq(linear.T, seen, rcond=None)[0]
        placed = fitted @ linear
        terms = [(placed - seen) / (EXACT * scale), values[:3] / LENGTHS, values[3:] / np.array(VIEW)]
        if ends is not None:
            face = project_points(camera, np.array([(-1.0, 1.0, 0.0), (-1.0, -1.0, 0.0)]) * half)[:, 0]
            at = fitted[0] * face + fitted[1]
            beyond = (at - np.array(ends) * outline.shape[1]) * (1.0, -1.0) / scale
            terms.append(np.where(beyond > 0, beyond / FACE[0], beyond / FACE[1]))
        return np.concatenate(terms)

    tried = [least_squares(differ, np.array([0.0, 0.0, 0.0, turn, 0.0, 0.0]), max_nfev=30) for turn in TURNS]
    found = min(tried, key=lambda one: one.cost).x
    width, depth, height = np.exp(logs + found[:3] - found[:3].mean()).tolist()
    yaw, pitch, near = (start + found[3:]).tolist()
    return (width, depth, height), (yaw, pitch, float(np.exp(near)))
