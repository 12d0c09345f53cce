"""Transfers paint and latents from true voxels to those that a model samples."""

from dataclasses import replace

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree
from torch import Tensor

from artigen.appearance.slat_flow import SlatFlow
from artigen.appearance.vae import SIDE_CHANNELS
from artigen.examples.appearance import AppearanceExample
from artigen.train.appearance.drawn import DrawnVoxels


def find_models(
    example: AppearanceExample, drawn: DrawnVoxels
) -> tuple[Int[np.ndarray, "M"], Bool[np.ndarray, "M"]]:
    """Row of the true voxel whose appearance each sampled one takes, and a mask of those that match it.

    Strays, which match none, take the nearest true voxel of their part.
    """
    count = len(drawn.coords)
    models, sure = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=bool)
    models[drawn.rows], sure[drawn.rows] = drawn.like, True
    for part in np.unique(drawn.part_ids[~sure]):
        strays = np.flatnonzero((drawn.part_ids == part) & ~sure)
        own = np.flatnonzero(example.part_ids == part)
        models[strays] = own[KDTree(example.coords[own]).query(drawn.coords[strays])[1]]
    return models, sure


def transfer_looks(
    example: AppearanceExample, drawn: DrawnVoxels, models: Int[np.ndarray, "M"]
) -> AppearanceExample:
    """The example with sampled voxels, each with paint and surface position of its model voxel.

    Only the side features remain, because they hold the surface positions (`AppearanceExample.places`).
    """
    return replace(
        example,
        coords=drawn.coords.astype(np.uint8),
        part_ids=drawn.part_ids.astype(np.uint8),
        facings=drawn.facings.astype(np.uint8),
        paint=example.paint[models],
        features=example.features[models, -SIDE_CHANNELS:],
        views=example.views[models],
    )


@torch.no_grad()
def transfer_latents(
    flow: SlatFlow,
    mean: Float[Tensor, "N D"],
    told: tuple[Float[np.ndarray, "N A"], Float[np.ndarray, "M A"]],
    models: Int[np.ndarray, "M"],
    sure: Bool[np.ndarray, "M"],
) -> Float[Tensor, "M D"]:
    """Latents of sampled voxels: their linear prior plus the residual of their model voxel; zero for strays.

    Args:
        told: Attributes of the true voxels and of the sampled ones.
        models: Row of the true voxel whose appearance each sampled one takes.
        sure: Mask of the sampled voxels that match it.
    """
    true, drawn = (torch.from_numpy(one) for one in told)
    off = flow.normalise(mean, true)[models]
    off[torch.from_numpy(~sure)] = 0.0
    return flow.restore(off, drawn)
