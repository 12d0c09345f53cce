"""Sides of boxes moved to edges of the picture: a front ends where the picture changes along its side."""

import numpy as np
from jaxtyping import Float, UInt8

NEAR = 0.1
"""Standard deviation of the true side around the one that was read, as a share of the box's extent across
it; a side moves by twice as much at most."""
INNER = 0.1
"""Share of a side that is left out at either end, where other edges meet it."""


def snap_boxes(
    pixels: UInt8[np.ndarray, "H W 3"], boxes: Float[np.ndarray, "N 4"]
) -> Float[np.ndarray, "N 4"]:
    """Boxes (left, top, right, bottom; pixels) whose sides lie at edges near them.

    Each side moves to where the mean change of the picture across it is largest, weighted by how near that
    is.
    """
    smooth = _blur(pixels)
    across, along = (np.abs(np.gradient(smooth, axis=axis)).max(axis=2) for axis in (1, 0))
    out = boxes.astype(np.float64).copy()
    for box in out:
        sides = [
            _find_edge(change, box[order], far)
            for far in (False, True)
            for change, order in ((across, [0, 1, 2, 3]), (along.T, [1, 0, 3, 2]))
        ]
        box[:] = sides
    return out


def _find_edge(change: Float[np.ndarray, "H W"], box: Float[np.ndarray, "4"], far: bool) -> float:  # noqa: FBT001
    """Where a box's left side is, or its right one (``far``)."""
    left, top, right, bottom = box
    place, inner = right if far else left, INNER * (bottom - top)
    spread = NEAR * (right - left)
    rows = change[max(0, int(top + inner)) : int(bottom - inner)]
    first, last = max(0, int(place - 2 * spread)), min(change.shape[1], int(place + 2 * spread) + 1)
    if last - first < 2 or rows.size == 0:
        return float(place)
    middles = np.arange(first, last) + 0.5
    nearness = np.exp(-0.5 * ((middles - place) / spread) ** 2)
    weighted = rows[:, first:last].mean(axis=0) * nearness
    return float(middles[int(np.argmax(weighted))]) if weighted.max() > 0 else float(place)


def _blur(pixels: UInt8[np.ndarray, "H W 3"]) -> Float[np.ndarray, "H W 3"]:
    """A binomial filter of five pixels."""
    from scipy.ndimage import convolve1d

    weights = np.array([1.0, 4.0, 6.0, 4.0, 1.0], np.float32) / 16
    rows = convolve1d(pixels.astype(np.float32), weights, axis=0, mode="nearest")
    return convolve1d(rows, weights, axis=1, mode="nearest")
