"""Articulated objects as points with part ids, at rest and opened.

All objects, true ones included, are sampled from their voxels in the same way: a generated object has only
voxels, and differences to a finer surface are below a cell.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

from artigen.kinematics import articulate_points, qlimits
from artigen.types import Asset, VoxelGrid


@dataclass(frozen=True, kw_only=True, eq=False)
class PartCloud:
    """Points at rest (unit-cube lengths) with the part they lie on."""

    asset: Asset
    points: Float[np.ndarray, "N 3"]
    part_ids: Int[np.ndarray, "N"]

    def opened(self, share: float) -> Float[np.ndarray, "N 3"]:
        """The points with every joint at ``share`` of its range; children follow their parents."""
        return articulate_points(self.asset, share * qlimits(self.asset)[:, 1], self.points, self.part_ids)


def sample_cells(asset: Asset, count: int, seed: int = 0) -> PartCloud:
    """Points spread evenly over all occupied cells, uniform inside each; equal seeds, equal points.

    Raises:
        ValueError: If the asset has no occupied cell.
    """
    voxels = _occupied(asset)
    rng = np.random.default_rng(seed)
    whole, rest = divmod(count, len(voxels.coords))
    rows = np.concatenate(
        [
            np.repeat(np.arange(len(voxels.coords)), whole),
            rng.choice(len(voxels.coords), rest, replace=False),
        ]
    )
    return _place(asset, rows, rng)


def sample_every_part(asset: Asset, per_part: int) -> PartCloud:
    """The same number of points on every part that owns a cell.

    Raises:
        ValueError: If the asset has no occupied cell.
    """
    voxels = _occupied(asset)
    rng = np.random.default_rng(0)
    rows = [
        rng.choice(np.flatnonzero(voxels.part_ids == part), per_part)
        for part in np.unique(voxels.part_ids).tolist()
    ]
    return _place(asset, np.concatenate(rows), rng)


def _occupied(asset: Asset) -> VoxelGrid:
    if asset.voxels is None or not len(asset.voxels.coords):
        raise ValueError(f"asset {asset.name!r} has no occupied cell to sample points from")
    return asset.voxels


def _place(asset: Asset, rows: Int[np.ndarray, "N"], rng: np.random.Generator) -> PartCloud:
    assert asset.voxels is not None
    inside = asset.voxels.coords[rows] + rng.random((len(rows), 3))
    return PartCloud(
        asset=asset,
        points=inside / asset.voxels.resolution - 0.5,
        part_ids=asset.voxels.part_ids[rows].astype(np.int64),
    )


def chamfer(first: Float[np.ndarray, "N 3"], second: Float[np.ndarray, "M 3"]) -> float:
    """``mean_a min_b |a - b|^2 + mean_b min_a |a - b|^2``, in squared units of the points.

    Sum and squares are as in pytorch3d, with which the published numbers were computed (SINGAPO
    ``metrics/cd.py``, Particulate ``evaluation_utils.py``).

    Raises:
        ValueError: If a cloud is empty.
    """
    if not len(first) or not len(second):
        raise ValueError(f"clouds of {len(first)} and {len(second)} points, expected some in both")
    there = KDTree(second).query(first)[0]
    back = KDTree(first).query(second)[0]
    return float(np.mean(there**2) + np.mean(back**2))
