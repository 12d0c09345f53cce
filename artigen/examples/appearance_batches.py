"""Batches of appearance examples: voxels of several objects, their pictures, and pictures of Gaussians."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from artigen.appearance.gaussian_decoder import select_voxels
from artigen.appearance.vae import AppearanceVae
from artigen.appearance.views import pick_cameras
from artigen.examples.appearance import AppearanceExample
from artigen.models.batch import TensorBatch
from artigen.shapes.render import Cameras
from artigen.splats.render import RasterConfig, move_splats, rasterize
from artigen.splats.render.splats import Splats

CPU_FRAGMENTS, GPU_FRAGMENTS = 1 << 19, 1 << 24


@dataclass(frozen=True, kw_only=True, eq=False)
class PictureBatch(TensorBatch):
    """Voxels of several objects, and target pictures, equally many of each."""

    coords: Int[Tensor, "N 4"]
    """Sample, x, y, z."""
    feats: Float[Tensor, "N C"]
    facings: Int[Tensor, "N"]
    """Directions of outer sides."""
    part_ids: Int[Tensor, "N"]
    """Part of each voxel, counted within its sample."""
    rgb: Float[Tensor, "B M H W 3"]
    exposed: Bool[Tensor, "B M H W"]
    """Pixels of surface that the closed object hides."""
    background: Float[Tensor, "B M 3"]
    cameras: tuple[Cameras, ...]
    """Cameras of each sample."""
    displacements: tuple[Float[np.ndarray, "M P 4 4"], ...]
    """Displacements of each sample's parts, picture by picture."""


def voxel_batch(
    examples: Sequence[AppearanceExample],
) -> tuple[Int[Tensor, "N 4"], Float[Tensor, "N C"], Int[Tensor, "N"]]:
    """Coordinates (sample, x, y, z), features and facings of all voxels, sample after sample."""
    feats, facings = (
        torch.from_numpy(np.concatenate([getattr(one, name) for one in examples]))
        for name in ("features", "facings")
    )
    return place_batch(examples), feats.float(), facings.long()


def place_batch(examples: Sequence[AppearanceExample]) -> Int[Tensor, "N 4"]:
    """Sample, x, y, z of all voxels, sample after sample."""
    coords = [
        np.column_stack([np.full(len(one.coords), number), one.coords.astype(np.int64)])
        for number, one in enumerate(examples)
    ]
    return torch.from_numpy(np.concatenate(coords))


def picture_batch(
    examples: Sequence[AppearanceExample], chosen: Sequence[Int[np.ndarray, "M"]]
) -> PictureBatch:
    """Batch of objects with the chosen pictures of each, equally many."""
    coords, feats, facings = voxel_batch(examples)
    taken = [(one.pictures, rows) for one, rows in zip(examples, chosen, strict=True)]
    part_ids = np.concatenate([one.part_ids for one in examples]).astype(np.int64)
    rgb, background = (
        torch.from_numpy(np.stack([getattr(pictures, name)[rows] for pictures, rows in taken])).float() / 255
        for name in ("rgb", "background")
    )
    return PictureBatch(
        coords=coords,
        feats=feats,
        facings=facings,
        part_ids=torch.from_numpy(part_ids),
        rgb=rgb,
        exposed=torch.from_numpy(np.stack([pictures.exposed[rows] for pictures, rows in taken])),
        background=background,
        cameras=tuple(pictures.cameras(rows) for pictures, rows in taken),
        displacements=tuple(pictures.displacements[pictures.state[rows]] for pictures, rows in taken),
    )


def draw_pictures(splats: Splats, batch: PictureBatch, cfg: RasterConfig) -> Float[Tensor, "B M H W 3"]:
    """Pictures of a batch: the Gaussians of each object, moved with their parts, from its cameras.

    Args:
        splats: Gaussians of all voxels of the batch, voxel after voxel.
    """
    out = []
    for sample, cameras in enumerate(batch.cameras):
        mine = batch.coords[:, 0] == sample
        own, part_ids = select_voxels(splats, mine), batch.part_ids[mine]
        owners = part_ids.repeat_interleave(len(own.means) // len(part_ids))
        pictures = [
            rasterize(
                move_splats(own, owners, displacements),
                pick_cameras(cameras, torch.tensor([picture])),
                background=batch.background[sample, picture],
                cfg=cfg,
            ).color[0]
            for picture, displacements in enumerate(batch.displacements[sample])
        ]
        out.append(torch.stack(pictures))
    return torch.stack(out)


def raster_config(vae: AppearanceVae, device: torch.device) -> RasterConfig:
    """Rasteriser configuration for a decoder's Gaussians, with working memory for the device."""
    return RasterConfig(
        filter_variance=vae.decoder.gaussians.screen_filter,
        fragments=GPU_FRAGMENTS if device.type == "cuda" else CPU_FRAGMENTS,
    )


def draw_picture_batches(
    examples: Sequence[AppearanceExample], size: int, pictures: int, seed: int, *, start: int = 0
) -> Iterator[PictureBatch]:
    """Endless batches, each a function of its number, so that a run can resume at any batch.

    Args:
        size: Objects per batch; every epoch holds each object once, in a new order.
        pictures: Pictures of each object, drawn without repetition if there are enough.
        start: Number of the first batch.
    """
    number = start
    while True:
        rng = np.random.default_rng([seed, 1, number])
        objects = [
            _draw_order(len(examples), seed, at // len(examples))[at % len(examples)]
            for at in range(number * size, (number + 1) * size)
        ]
        batch = [examples[index] for index in objects]
        rows = [
            rng.choice(len(one.pictures.rgb), pictures, replace=len(one.pictures.rgb) < pictures)
            for one in batch
        ]
        yield picture_batch(batch, rows)
        number += 1


def _draw_order(count: int, seed: int, epoch: int) -> Int[np.ndarray, "K"]:
    return np.random.default_rng([seed, 0, epoch]).permutation(count)
