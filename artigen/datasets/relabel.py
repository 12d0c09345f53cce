"""Transfers the colours of a source object to the parts found in its voxels."""

from dataclasses import replace

import numpy as np

from artigen.types import Asset


def carry_surface(source: Asset, found: Asset) -> Asset:
    """Gives ``found`` the surface samples of ``source``, relabelled to the parts of ``found``.

    Every source part goes as a whole to the found part that owns most of the cells its samples lie
    in: inside a cell that two parts share, each keeps its own colours.

    Raises:
        ValueError: If ``source`` has no surface or ``found`` no voxels.
    """
    if source.surface is None or found.voxels is None:
        raise ValueError(f"asset {source.name!r}: surface samples and found voxels are both needed")
    grid = np.full((found.voxels.resolution,) * 3, -1)
    grid[tuple(found.voxels.coords.T)] = found.voxels.part_ids
    cells = np.floor((source.surface.points.astype(np.float64) + 0.5) * found.voxels.resolution)
    owners = grid[tuple(np.clip(cells, 0, found.voxels.resolution - 1).astype(np.int64).T)]
    inside = owners >= 0
    votes = np.zeros((len(source.parts), len(found.parts)), dtype=np.int64)
    np.add.at(votes, (source.surface.part_ids[inside], owners[inside]), 1)
    heirs = votes.argmax(axis=1)
    kept = votes.sum(axis=1)[source.surface.part_ids] > 0
    surface = replace(
        source.surface,
        points=source.surface.points[kept],
        normals=source.surface.normals[kept],
        colors=source.surface.colors[kept],
        part_ids=heirs[source.surface.part_ids[kept]],
    )
    return replace(found, surface=surface)
