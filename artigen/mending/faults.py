"""Faults of drawn objects that show before anything is exported: they cannot stand, a front is full of holes.

Cells take seconds to draw, a package half a minute to export and check. Thresholds are such that procedural
objects have none.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int
from scipy.spatial import ConvexHull

from artigen.mending.fronts import view_front
from artigen.types import Asset, Part, VoxelGrid


@dataclass(frozen=True, kw_only=True)
class AssetFaultsConfig:
    """What no object has."""

    layers: int = 3
    """Lowest layers of cells that an object stands on; levelling makes up for what is missing in them."""
    margin: float = 2.5
    """Cells between its middle and the edge of what it stands on, at least."""
    whole: float = 0.7
    """Share of the front of a door or drawer that its cells show, at least."""


def find_asset_faults(asset: Asset, cfg: AssetFaultsConfig | None = None) -> tuple[str, ...]:
    """What is wrong with the voxels of an object; nothing, if nothing is.

    Args:
        asset: an object with voxels.
        cfg: tolerances.

    Raises:
        ValueError: If it has no voxels.
    """
    cfg, voxels = cfg or AssetFaultsConfig(), asset.voxels
    if voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels to judge; voxelize its surface first")
    faults = []
    margin = measure_stand(voxels.coords, cfg.layers)
    if margin < cfg.margin:
        faults.append(f"its middle lies {margin:.1f} cells within what it stands on")
    for number, part in enumerate(asset.parts):
        if part.label in ("door", "drawer"):
            shown = _share_of_front(voxels, number, part)
            if shown < cfg.whole:
                faults.append(f"{part.name} shows {100 * shown:.0f} % of its front")
    return tuple(faults)


def measure_stand(coords: Int[np.ndarray, "N 3"], layers: int) -> float:
    """Cells from the mean of all cells to the edge of the hull of the lowest, below 0 outside of it.

    Args:
        coords: Cells (x, y, z), at least one.
        layers: How many layers count as the lowest.
    """
    lowest = coords[coords[:, 2] < coords[:, 2].min() + layers, :2]
    corners = (lowest[:, None] + np.array([[0, 0], [0, 1], [1, 0], [1, 1]])).reshape(-1, 2)
    sides = ConvexHull(corners).equations
    middle = coords[:, :2].mean(axis=0) + 0.5
    return float(-(sides[:, :2] @ middle + sides[:, 2]).max())


def _share_of_front(voxels: VoxelGrid, number: int, part: Part) -> float:
    """Share of a front that its cells cover, seen along its depth; of a lid, along its least edge."""
    mine = np.zeros((voxels.resolution,) * 3, dtype=bool)
    mine[tuple(voxels.coords[voxels.part_ids == number].T)] = True
    return float(view_front(mine, *part.box).any(axis=0).mean())
