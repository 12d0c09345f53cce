"""Paint: colour and transmission of surface, and their means on both sides of a voxel."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int, UInt8
from scipy.spatial import KDTree

from artigen.errors import ArtigenError
from artigen.shapes.asset import part_owners
from artigen.shapes.sampling import paint_points, place_points, read_clear
from artigen.shapes.shape import Shape
from artigen.types import Asset, SurfaceSamples, VoxelGrid
from artigen.voxels.frames import SIDES, facing_frames
from artigen.voxels.layout import lay_out
from artigen.voxels.surface import AHEAD, SAMPLES, find_voxels

PAINT = 3 * SIDES + 1
"""Values that describe the paint of a voxel: colours of its outer and its inner side, and transmission."""
TURNED = 1 / 32
"""Unit-cube length that a difference of 1 between normals counts for: on a thin board, the nearest sample is
then one of the same face, even where that is a voxel away."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PaintedSurface:
    """Coloured samples of a surface."""

    samples: SurfaceSamples
    clear: Float[np.ndarray, "S"]
    """Transmission of the surface at each sample: share of what is behind that is visible through it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class VoxelPaint:
    """Surface colours (sRGB) of the outer and the inner side of every voxel."""

    colors: Float[np.ndarray, "N 2 3"]
    known: Int[np.ndarray, "N 2"]
    """Samples behind each colour; a side without any has the colour of the other side, voxel or part."""
    clear: Float[np.ndarray, "N"]
    """Transmission of the surface."""

    def packed(self) -> UInt8[np.ndarray, "N 7"]:
        """Colours and transmission in 8 bits each, one row per voxel."""
        values = np.concatenate([self.colors.reshape(len(self.clear), -1), self.clear[:, None]], axis=1)
        return np.rint(255.0 * values).astype(np.uint8)


def lay_painted(shape: Shape, asset: Asset) -> tuple[Asset, Int[np.ndarray, "N"], VoxelPaint]:
    """The voxels of a procedural object's Gaussians, with facings and paint from one set of samples.

    Returns:
        The asset with samples of its surface and voxels that cover it (`artigen.voxels.layout`), the
        directions of their outer sides, and the paint of both sides.

    Raises:
        ValueError: If the asset has no voxels.
    """
    if asset.voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels; voxelize its surface first")
    surface = paint_surface(shape, asset, 1.0 / (SAMPLES * asset.voxels.resolution))
    voxels, facings = lay_out(surface.samples, asset.voxels)
    laid = replace(asset, voxels=voxels, surface=surface.samples)
    return laid, facings, gather_paint(surface, voxels, facings)


def paint_surface(shape: Shape, asset: Asset, spacing: float) -> PaintedSurface:
    """Painted samples of the surface, ``spacing`` apart (unit-cube length), with their parts of the asset."""
    found = place_points(shape, spacing * asset.scale)
    surface = paint_points(shape, found, footprint=spacing * asset.scale)
    owned = replace(surface, part_ids=part_owners(shape, asset)[surface.part_ids])
    return PaintedSurface(samples=owned, clear=read_clear(shape, found))


def gather_paint(surface: PaintedSurface, voxels: VoxelGrid, facings: Int[np.ndarray, "N"]) -> VoxelPaint:
    """Mean paint of the samples of each voxel, of its own part, that face the way of either side.

    Args:
        surface: Painted samples; a part without any is black.
    """
    count, samples = len(voxels.coords), surface.samples
    rows, own = find_voxels(samples, voxels)
    normals, colors = samples.normals[own], samples.colors[own] / 255.0
    ahead = np.einsum("ki,ki->k", facing_frames()[facings][rows][:, :, 0], normals)
    known, means = np.empty((count, SIDES), dtype=np.int64), np.empty((count, SIDES, 3))
    for side, sign in enumerate((1.0, -1.0)):
        facing = sign * ahead > AHEAD
        known[:, side] = np.bincount(rows[facing], minlength=count)
        means[:, side] = _average(rows[facing], colors[facing], known[:, side])
    whole = np.bincount(rows, minlength=count)
    parts = np.bincount(samples.part_ids, minlength=int(voxels.part_ids.max()) + 1)
    of_part = _average(samples.part_ids, samples.colors / 255.0, parts)[voxels.part_ids]
    every = np.where(whole[:, None] > 0, _average(rows, colors, whole), of_part)
    for side in range(SIDES):
        lost, shown = known[:, side] == 0, known[:, 1 - side] > 0
        means[lost, side] = np.where(shown[:, None], means[:, 1 - side], every)[lost]
    clear = _average(rows, surface.clear[own][:, None], whole)[:, 0]
    return VoxelPaint(colors=means, known=known, clear=clear)


def repaint(surface: SurfaceSamples, like: PaintedSurface, names: Sequence[str]) -> PaintedSurface:
    """Paints samples of a surface like another surface of the same object.

    Each sample takes the paint of the nearest sample of its own part, where normals count as well (`TURNED`).

    Args:
        surface: Samples, such as those of meshes made from voxels.
        like: The other surface, painted.
        names: Names of the parts of both.

    Raises:
        ArtigenError: If the other surface has no sample of a part.
    """
    parts: list[int] = np.unique(surface.part_ids).tolist()
    lost = [names[part] for part in parts if not (like.samples.part_ids == part).any()]
    if lost:
        raise ArtigenError(
            f"{', '.join(lost)}: none of {len(like.samples.points)} painted samples of {len(names)} parts to "
            "take colours from, expected at least one of each part; sample the painted surface more densely"
        )
    places, wanted = (
        np.concatenate([one.points, TURNED * one.normals], axis=1) for one in (like.samples, surface)
    )
    nearest = np.empty(len(wanted), dtype=np.int64)
    for part in parts:
        own, rows = (np.flatnonzero(one.part_ids == part) for one in (like.samples, surface))
        nearest[rows] = own[np.asarray(KDTree(places[own]).query(wanted[rows])[1])]
    return PaintedSurface(
        samples=replace(surface, colors=like.samples.colors[nearest]), clear=like.clear[nearest]
    )


def _average(
    rows: Int[np.ndarray, "S"], values: Float[np.ndarray, "S C"], number: Int[np.ndarray, "N"]
) -> Float[np.ndarray, "N C"]:
    """Means of values by row; 0 where a row has none."""
    sums = [np.bincount(rows, weights=one, minlength=len(number)) for one in values.T]
    return np.stack(sums, axis=1) / np.maximum(number, 1)[:, None]
