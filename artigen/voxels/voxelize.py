"""Voxelises surfaces: labels by area majority, small parts preserved.

`encode` and `decode` (the dense field and back) are re-exported from `artigen.voxels.fields`.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from jaxtyping import Float, Int

from artigen.types import Asset, SurfaceSamples, VoxelGrid
from artigen.voxels.fields import decode, encode
from artigen.voxels.frames import gather_voxels, mark_voxels

__all__ = ["assign_cells", "decode", "drop_unresolved", "encode", "find_heirs", "voxelize", "voxelize_again"]

LEAST_SHARE = 0.5
"""Share of its area that a part's own cells should hold; below it the part may claim cells."""
FAIR_SHARE = 0.8
"""The same for claims on the cells of larger parts. `voxelize_again` keeps to `LEAST_SHARE`: its
surface can go to the cell beneath."""
LARGER = 1.25
"""Ratio of areas from which a part is larger: of two boards of one size that lie on each other, such as base
and lid of a laptop, one owns the layer between them."""
SAME = 1e-3
"""Areas of two parts in a cell that differ by less are the same, or noise would divide layers in stripes."""
TAKEN = 2.0
"""Loss, in voxels, of surface that has no usable cell beneath it (`weigh_losses`)."""


def voxelize(surface: SurfaceSamples, resolution: int = 64) -> VoxelGrid:
    """Marks every cell that holds a sample and gives it to one part, as `assign_cells` does.

    Every sample counts as the same area.
    """
    cells = find_cells(surface, resolution)
    return assign_cells(cells, surface.part_ids, np.ones(len(cells)), resolution)


def find_cells(surface: SurfaceSamples, resolution: int) -> Int[np.ndarray, "N 3"]:
    """The cell of every sample; points on the far faces of the unit cube count to the last one."""
    cells = np.floor((surface.points.astype(np.float64) + 0.5) * resolution).astype(np.int64)
    return np.clip(cells, 0, resolution - 1)


def weigh_losses(surface: SurfaceSamples, resolution: int) -> Float[np.ndarray, "N"]:
    """Loss to each sample's part if the sample's cell went to another part, in voxels.

    It is the distance to the next cell beneath the sample, or `TAKEN` where that cell lies outside the grid
    or holds surface of other parts only.
    """
    cells, part_ids = find_cells(surface, resolution), surface.part_ids.astype(np.int64)
    points = (surface.points.astype(np.float64) + 0.5) * resolution
    every, axes = np.arange(len(points)), np.abs(surface.normals).argmax(axis=1)
    signs = np.where(surface.normals[every, axes] > 0, 1, -1)
    into = points[every, axes] - cells[every, axes]
    beneath = cells.copy()
    beneath[every, axes] -= signs
    inside = ((beneath >= 0) & (beneath < resolution)).all(axis=1)
    shape, parts = (resolution,) * 3, int(part_ids.max(initial=0)) + 1
    here = np.ravel_multi_index(tuple(cells.T), shape)
    there = np.ravel_multi_index(tuple(beneath.clip(0, resolution - 1).T), shape)
    free = ~np.isin(there, here) | np.isin(there * parts + part_ids, here * parts + part_ids)
    return np.where(inside & free, np.where(signs > 0, into, 1.0 - into), TAKEN)


def voxelize_again(surface: SurfaceSamples, voxels: VoxelGrid) -> VoxelGrid:
    """Voxelises the surface of meshes that were made from voxels, as `voxelize` does that of an object.

    Generated voxels may be thick, so that the meshes made from them miss some. Of two parts in one cell, the
    one that would lose more owns it (`weigh_losses`); the surface of the other goes to the cell beneath
    (`artigen.voxels.layout.cover_surface`). A part that is left without a cell keeps the cells that it had.
    """
    cells, weights = find_cells(surface, voxels.resolution), weigh_losses(surface, voxels.resolution)
    found = assign_cells(cells, surface.part_ids, weights, voxels.resolution, LEAST_SHARE)
    lost = np.isin(voxels.part_ids, np.setdiff1d(voxels.part_ids, found.part_ids))
    if not lost.any():
        return found
    owners = mark_voxels(found.coords, found.part_ids, voxels.resolution)
    owners[tuple(voxels.coords[lost].T)] = voxels.part_ids[lost]
    return gather_voxels(owners)


def assign_cells(
    cells: Int[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
    areas: Float[np.ndarray, "N"],
    resolution: int,
    share: float = FAIR_SHARE,
) -> VoxelGrid:
    """Gives every cell that surface passes through to one part.

    The part with the largest area in a cell owns it; ties go to the lower part id. A part smaller than
    a cell would lose every cell to the panel it sits on (the buttons of a microwave). Therefore parts
    whose cells hold less than `LEAST_SHARE` of their own area claim the cells where they have most area
    until they reach that share, the smallest part first, and then cells of larger parts up to ``share``.
    A claimed cell is not claimed again. A part can still end up without a cell when several lie inside
    one; see `drop_unresolved`.
    """
    shape = (resolution,) * 3
    parts = int(part_ids.max()) + 1 if len(part_ids) else 1
    pairs = np.ravel_multi_index(tuple(cells.T), shape) * parts + part_ids
    keys, row = np.unique(pairs, return_inverse=True)
    held = np.bincount(row.ravel(), weights=areas, minlength=len(keys))
    held = np.where(held > SAME, SAME * np.round(held / SAME), held)
    flat, part = np.divmod(keys, parts)  # one row per (cell, part) that meet, sorted by cell, then part
    order = np.lexsort((part, -held, flat))
    owned, first = np.unique(flat[order], return_index=True)
    cell = np.searchsorted(owned, flat)
    owners = _claim(cell, part, held, part[order][first], share)
    return VoxelGrid(
        resolution=resolution, coords=np.stack(np.unravel_index(owned, shape), axis=1), part_ids=owners
    )


def _claim(
    cell: np.ndarray, part: np.ndarray, areas: np.ndarray, owners: np.ndarray, share: float
) -> np.ndarray:
    """Lets starved parts take cells; rows of ``cell``, ``part``, ``areas`` are the (cell, part) pairs."""
    totals = np.bincount(part, weights=areas)
    held = np.bincount(part, weights=areas * (owners[cell] == part), minlength=len(totals))
    starved = np.flatnonzero((totals > 0) & (held < share * totals))
    owners = owners.copy()
    claimed = np.zeros(len(owners), dtype=bool)
    for index in starved[np.argsort(totals[starved], kind="stable")]:
        mine = np.flatnonzero(part == index)
        for wanted, larger in ((min(share, LEAST_SHARE), 0.0), (share, LARGER)):
            holders = owners[cell[mine]]
            open_to_it = ~claimed[cell[mine]] & (totals[holders] >= larger * totals[index])
            rows = mine[(holders != index) & open_to_it]
            rows = rows[np.argsort(-areas[rows], kind="stable")]
            before = areas[mine][holders == index].sum() + np.cumsum(areas[rows]) - areas[rows]
            taken = cell[rows[before < wanted * totals[index]]]
            owners[taken] = index
            claimed[taken] = True
    return owners


def find_heirs(parents: Mapping[str, str | None], asset: Asset) -> Int[np.ndarray, "P"]:
    """Index of the part that each named part became: itself, or the ancestor that it was merged into.

    Args:
        parents: Name of the parent of every part before merging, in order; None for the root.
        asset: Asset after `drop_unresolved`.
    """
    row = {part.name: index for index, part in enumerate(asset.parts)}

    def heir(name: str) -> int:
        parent = parents[name]
        return row[name] if name in row or parent is None else heir(parent)

    return np.array([heir(name) for name in parents])


def drop_unresolved(asset: Asset) -> Asset:
    """Merges every part that owns no voxel into its parent, and notes it.

    Such a part is below the grid's resolution and cannot be recovered from the voxels. Its surface
    samples, Gaussians and children go to the parent; a movable part stops moving.

    Raises:
        ValueError: If the asset has no voxels, or the root owns none.
    """
    if asset.voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels; voxelize its surface first")
    counts = np.bincount(asset.voxels.part_ids, minlength=len(asset.parts))
    if counts[asset.root] == 0:
        raise ValueError(
            f"asset {asset.name!r}: the root part {asset.parts[asset.root].name!r} owns no voxel"
        )
    if (counts > 0).all():
        return asset

    def heir(index: int) -> int:
        while counts[index] == 0:
            index = asset.parts[index].parent
        return index

    kept = np.flatnonzero(counts)
    renumber = np.full(len(asset.parts), -1)
    renumber[kept] = np.arange(len(kept))
    new_ids = np.array([renumber[heir(index)] for index in range(len(asset.parts))])
    parts = tuple(
        replace(part, parent=-1 if part.parent == -1 else int(new_ids[part.parent]))
        for part in (asset.parts[index] for index in kept)
    )
    notes = tuple(
        f"{part.name} ({part.label}, {part.joint.type}) is below the voxel resolution "
        f"{asset.voxels.resolution} and was merged into {asset.parts[heir(index)].name}"
        for index, part in enumerate(asset.parts)
        if counts[index] == 0
    )
    holders = {
        name: None if holder is None else replace(holder, part_ids=new_ids[holder.part_ids])
        for name, holder in (
            ("voxels", asset.voxels),
            ("surface", asset.surface),
            ("gaussians", asset.gaussians),
        )
    }
    return replace(asset, parts=parts, notes=asset.notes + notes, **holders)
