"""Gaussians of a voxel reach the neighbours that its part goes on in: no gaps along boards, rims and handles.

Drawn latents say only roughly how far surface reaches within a voxel: their mean leaves a little of every
voxel bare. Where the part goes on next door there is no end, so Gaussians are stretched to the border there.
"""

from dataclasses import replace

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.facings import facing_frames, find_joined
from artigen.splats.render.splats import Splats

MOST = 4.0
"""Largest factor by which Gaussians are widened."""


def reach_neighbours(
    splats: Splats,
    coords: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    facings: Int[np.ndarray, "N"],
    resolution: int,
    span: Float[Tensor, "2"],
) -> Splats:
    """Gaussians whose voxels have two sides, stretched across to the neighbours of the same part.

    Args:
        splats: Voxel after voxel, as `artigen.models.gaussian_decoder` decodes them.
        coords: Cells (x, y, z) of the voxels.
        part_ids: Part of each.
        facings: Directions of their outer sides.
        resolution: Edge of the grid.
        span: Voxels between the outermost means of one that is filled, along its frame's +y and +z.
    """
    count = len(splats.means) // len(coords)
    frames = torch.from_numpy(facing_frames()[facings]).to(splats.means)
    centers = (torch.from_numpy(coords).to(splats.means) + 0.5) / resolution - 0.5
    off = resolution * torch.einsum(
        "nij,nki->nkj", frames, splats.means.unflatten(0, (-1, count)) - centers[:, None]
    )
    scales = splats.scales.unflatten(0, (-1, count)).clone()
    joined = torch.from_numpy(find_joined(coords, part_ids, facings, resolution)).to(scales.device)
    for axis in (1, 2):
        place = off[:, :, axis]
        middle = (place.amax(dim=1) + place.amin(dim=1)) / 2
        width = ((place.amax(dim=1) - place.amin(dim=1)) / span[axis - 1]).clamp(1.0 / MOST, 1.0)
        low, high = (middle - width / 2).clamp(-0.5, 0.5), (middle + width / 2).clamp(-0.5, 0.5)
        low = torch.where(joined[:, axis - 1, 0], -0.5, low)
        high = torch.where(joined[:, axis - 1, 1], 0.5, high)
        ratio = ((high - low) / width).clamp(1.0, MOST)[:, None]
        moved = (low + high)[:, None] / 2 + ratio * (place - middle[:, None])
        stretched = joined[:, axis - 1].any(dim=1)[:, None]
        off[:, :, axis] = torch.where(stretched, moved, place)
        scales[:, :, axis] = torch.where(stretched, ratio * scales[:, :, axis], scales[:, :, axis])
    means = centers[:, None] + torch.einsum("nij,nkj->nki", frames, off) / resolution
    return replace(splats, means=means.flatten(0, 1), scales=scales.flatten(0, 1))
