"""Articulated voxel fields as their non-empty blocks of cells, the input of the compact networks.

A field of edge 64 is 16^3 patches of 4^3 cells, and about a fifth of them hold an occupied cell. Attributes
are constant within a part, so a patch stores the part of each cell, and a table the attributes of each part.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float, Int, UInt8
from torch import Tensor

from artigen.latent.volumes import gather_pixels, shuffle_pixels
from artigen.models.batch import TensorBatch
from artigen.types import Asset
from artigen.voxels.fields import ROW, tabulate_parts

PATCH = 4
CELLS = PATCH**3


@dataclass(frozen=True, kw_only=True, eq=False)
class PackedField:
    """One object's field: occupied patches and the attributes of its parts.

    ``index`` is the flat patch number (x slowest), ``rows`` the part of each cell plus one, 0 where the cell
    is empty, ``table`` the channels after occupancy of each part.
    """

    resolution: int
    index: Int[np.ndarray, "P"]
    rows: UInt8[np.ndarray, "P K"]
    table: Float[np.ndarray, "T C"]


@dataclass(frozen=True, kw_only=True, eq=False)
class PatchBatch(TensorBatch):
    """Packed fields of several objects as tensors.

    ``index`` counts patches through the batch (sample * patches + patch); row 0 of ``table`` is zero, for
    empty cells.
    """

    samples: int
    edge: int
    index: Int[Tensor, "P"]
    rows: Int[Tensor, "P K"]
    table: Float[Tensor, "T C"]

    def occupied(self) -> Tensor:
        """Mask of the occupied cells, bool [P, K]."""
        return self.rows > 0

    def attributes(self) -> Float[Tensor, "P K C"]:
        """The channels after occupancy of every cell of every patch; zero where a cell is empty."""
        return self.table[self.rows]

    def occupancy(self) -> Float[Tensor, "B N K"]:
        """Occupancy (0 or 1) of every cell of the whole grid, patch by patch."""
        dense = torch.zeros(self.samples * self.edge**3, CELLS, device=self.rows.device)
        dense[self.index] = self.occupied().float()
        return dense.reshape(self.samples, self.edge**3, CELLS)

    def labels(self) -> Int[Tensor, "T"]:
        """Part label of each row of the table; that of row 0, the empty row, is meaningless."""
        return self.table[:, ROW.label].argmax(dim=1)


def pack_asset(asset: Asset) -> PackedField:
    """Packs an asset's voxels.

    Raises:
        ValueError: If the asset has no voxels, more than 255 parts, or its grid is no multiple of a patch.
    """
    voxels = asset.voxels
    if voxels is None or voxels.resolution % PATCH or len(asset.parts) > 255:
        raise ValueError(
            f"asset {asset.name!r}: expected voxels on a grid with an edge divisible by {PATCH}, and at most "
            "255 parts"
        )
    edge = voxels.resolution // PATCH
    coords = voxels.coords.astype(np.int64)
    patch = np.ravel_multi_index(tuple((coords // PATCH).T), (edge,) * 3)
    cell = np.ravel_multi_index(tuple((coords % PATCH).T), (PATCH,) * 3)
    index, at = np.unique(patch, return_inverse=True)
    rows = np.zeros((len(index), CELLS), dtype=np.uint8)
    rows[at, cell] = voxels.part_ids + 1
    return PackedField(
        resolution=voxels.resolution,
        index=index.astype(np.int32),
        rows=rows,
        table=tabulate_parts(asset),
    )


def collate(fields: Sequence[PackedField]) -> PatchBatch:
    """Packed fields of equal resolution side by side."""
    edge = fields[0].resolution // PATCH
    counts = [len(field.table) for field in fields]
    starts = np.cumsum([0, *counts[:-1]])
    rows = [
        np.where(field.rows > 0, field.rows.astype(np.int64) + start, 0)
        for field, start in zip(fields, starts, strict=True)
    ]
    index = [field.index.astype(np.int64) + number * edge**3 for number, field in enumerate(fields)]
    table = np.concatenate([np.zeros((1, fields[0].table.shape[1]), np.float32), *(f.table for f in fields)])
    return PatchBatch(
        samples=len(fields),
        edge=edge,
        index=torch.from_numpy(np.concatenate(index)),
        rows=torch.from_numpy(np.concatenate(rows)),
        table=torch.from_numpy(table),
    )


def unfold(batch: PatchBatch) -> Float[Tensor, "B C X Y Z"]:
    """The dense field, occupancy first, as dense convolutions read it."""
    values = torch.cat([batch.occupied()[..., None].float(), batch.attributes()], dim=-1)
    dense = torch.zeros(batch.samples * batch.edge**3, values.shape[2], CELLS, device=values.device)
    dense[batch.index] = values.transpose(1, 2)
    volume = dense.reshape(batch.samples, *(batch.edge,) * 3, -1).movedim(-1, 1)
    return shuffle_pixels(volume, PATCH)


def fold(volume: Float[Tensor, "B C X Y Z"]) -> Float[Tensor, "B N K C"]:
    """Patches of a dense volume, cells and channels last: inverse of how `unfold` lays them out."""
    batch, channels = volume.shape[:2]
    stacked = gather_pixels(volume, PATCH).flatten(2).transpose(1, 2)
    return stacked.reshape(batch, -1, channels, CELLS).transpose(2, 3)


def as_patches(volume: Float[Tensor, "B X Y Z"]) -> Float[Tensor, "N K"]:
    """The cells of a volume as rows of patches."""
    return fold(volume[:, None])[..., 0].flatten(0, 1)


def from_patches(cells: Float[Tensor, "N K"], edge: int) -> Float[Tensor, "B X Y Z"]:
    """The volumes of ``edge^3`` patches each: inverse of `as_patches`."""
    stacked = cells.reshape(-1, edge, edge, edge, CELLS).movedim(-1, 1)
    return shuffle_pixels(stacked, PATCH)[:, 0]


def patch_centers(index: Int[Tensor, "P"], edge: int) -> Float[Tensor, "P 3"]:
    """Centres of patches in the unit cube."""
    return (unravel(index % edge**3, edge) + 0.5) / edge - 0.5


def unravel(flat: Int[Tensor, "N"], edge: int) -> Int[Tensor, "N 3"]:
    """Places in a cube of cells from their flat index, z fastest."""
    return torch.stack([flat // edge**2, flat // edge % edge, flat % edge], dim=1)


def relative(
    attributes: Float[Tensor, "P K C"], centers: Float[Tensor, "P 3"], sign: float
) -> Float[Tensor, "P K C"]:
    """Attributes with positions (joint origin, box centre) made relative to the patch (-1) or back (+1)."""
    shift = attributes.new_zeros(len(centers), attributes.shape[2])
    for place in (ROW.origin, slice(ROW.box.start, ROW.box.start + 3)):
        shift[:, place] = sign * centers.to(attributes.dtype)
    return attributes + shift[:, None, :]
