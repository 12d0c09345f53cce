"""Transfers paint and latents from true voxels to those that a model samples instead."""

from dataclasses import replace

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree
from torch import Tensor

from artigen.appearance.slat_flow import SlatFlow
from artigen.appearance.vae import SIDE_CHANNELS
from artigen.train.appearance.drawn import DrawnVoxels
from artigen.train.appearance.examples import AppearanceExample


def find_models(
    example: AppearanceExample, drawn: DrawnVoxels
) -> tuple[Int[np.ndarray, "M"], Bool[np.ndarray, "M"]]:
    """The true voxel that every drawn one takes its looks from, and whether it really looks like it.

    Strays, which look like none, take those of the nearest true voxel of their part, whatever it is.
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
    """The example with drawn voxels, each with the paint and the places of its model.

    Of features those of sides remain, which say where surface lies (`AppearanceExample.places`).
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
    """Latents of drawn voxels: what is expected of them, and as far off as their models are; strays are not.

    Args:
        flow: knows what is expected of voxels.
        mean: latents of the true ones.
        told: attributes of the true voxels and of the drawn ones.
        models: the true voxel that each drawn one takes its looks from.
        sure: whether it looks like it.
    """
    true, drawn = (torch.from_numpy(one) for one in told)
    off = flow.normalise(mean, true)[models]
    off[torch.from_numpy(~sure)] = 0.0
    return flow.restore(off, drawn)
