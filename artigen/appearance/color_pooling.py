"""Averages the residual colours of neighbouring sides that are painted alike.

Training pictures are lit evenly from all around, so a region of one paint has one colour. The flow predicts
patch by patch and mottles it.
"""

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.voxels.frames import SIDES
from artigen.voxels.regions import number_faces

ALIKE = 1.5 / 255
"""Largest difference of paint between neighbours that are painted alike; paint comes in steps of 1/255."""


def even_sides(
    drawn: Float[Tensor, "N C"],
    expected: Float[Tensor, "N C"],
    paint: Float[np.ndarray, "N 7"],
    edges: Int[np.ndarray, "E 2"],
) -> Float[Tensor, "N C"]:
    """Latents whose deviation in colour from the linear prior is averaged over each region of one paint.

    Args:
        drawn: Sampled latents, which begin with the colours of both sides (`artigen.appearance.vae`).
        edges: Pairs of neighbours on one face (`artigen.voxels.regions.find_edges`).
    """
    out = drawn.clone()
    for side in range(SIDES):
        own = slice(3 * side, 3 * side + 3)
        painted = np.concatenate([paint[:, own], paint[:, -1:]], axis=1)
        alike = np.abs(painted[edges[:, 0]] - painted[edges[:, 1]]).max(axis=1) <= ALIKE
        regions = torch.from_numpy(number_faces(len(paint), edges[alike]).astype(np.int64)).to(drawn.device)
        residual = drawn[:, own] - expected[:, own]
        count = torch.bincount(regions).to(residual.dtype)
        total = torch.zeros(len(count), residual.shape[1], dtype=residual.dtype, device=residual.device)
        mean = total.index_add_(0, regions, residual) / count[:, None]
        out[:, own] = expected[:, own] + mean[regions]
    return out
