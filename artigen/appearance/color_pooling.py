"""Averages the residual colours of neighbouring sides that are painted alike.

Light comes evenly from all around in the pictures of training, so a figure has one colour. The flow, which
guesses patch by patch, mottles it.
"""

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.voxels.frames import SIDES
from artigen.voxels.regions import number_faces

ALIKE = 1.5 / 255
"""Difference of paint up to which two neighbours are painted alike: paint comes in steps of 1/255."""


def even_sides(
    drawn: Float[Tensor, "N C"],
    expected: Float[Tensor, "N C"],
    paint: Float[np.ndarray, "N 7"],
    edges: Int[np.ndarray, "E 2"],
) -> Float[Tensor, "N C"]:
    """Latents in which sides of one figure differ in colour from what is expected of them by the same.

    Args:
        drawn: Latents, which begin with the colours of both sides (`artigen.appearance.vae`).
        expected: What paint and places let one expect of them.
        paint: Colours of both sides of the voxels, and how clear they are.
        edges: Pairs of neighbours on one face (`artigen.voxels.regions.find_edges`).
    """
    out = drawn.clone()
    for side in range(SIDES):
        own = slice(3 * side, 3 * side + 3)
        told = np.concatenate([paint[:, own], paint[:, -1:]], axis=1)
        alike = np.abs(told[edges[:, 0]] - told[edges[:, 1]]).max(axis=1) <= ALIKE
        figures = torch.from_numpy(number_faces(len(paint), edges[alike]).astype(np.int64)).to(drawn.device)
        added = drawn[:, own] - expected[:, own]
        count = torch.bincount(figures).to(added.dtype)
        total = torch.zeros(len(count), added.shape[1], dtype=added.dtype, device=added.device)
        mean = total.index_add_(0, figures, added) / count[:, None]
        out[:, own] = expected[:, own] + mean[figures]
    return out
