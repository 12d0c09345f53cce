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
    grid = found.voxels.part_grid()
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


def restore_tree(source: Asset, found: Asset) -> Asset:
    """Gives the parts of ``found`` the names and parents that they have in ``source``.

    A found part is a source part where each holds most of the other's cells. It hangs from what the source
    part hangs from, or from the nearest ancestor of that which was found; other parts stay as they are.

    Raises:
        ValueError: If either has no voxels.
    """
    if source.voxels is None or found.voxels is None:
        raise ValueError(f"asset {source.name!r}: voxels of both are needed")
    owners = source.voxels.part_grid()[tuple(found.voxels.coords.T)]
    shared = np.zeros((len(source.parts), len(found.parts)), dtype=np.int64)
    known = owners >= 0
    np.add.at(shared, (owners[known], found.voxels.part_ids[known]), 1)
    best = shared.argmax(axis=1)
    twins = {part: int(row) for part, row in enumerate(best) if shared[:, row].argmax() == part}
    twins = {part: row for part, row in twins.items() if shared[part, row] and row != found.root}
    twins[source.root] = found.root
    parts, notes = list(found.parts), []
    for part, row in twins.items():
        above = source.parts[part].parent
        while above != -1 and above not in twins:
            above = source.parts[above].parent
        parent, old = -1 if above == -1 else twins[above], found.parts[row].parent
        parts[row] = replace(parts[row], name=source.parts[part].name, parent=parent)
        if parent != old:
            notes.append(
                f"{parts[row].name} hangs from {source.parts[above].name} as in the source; its voxels hang "
                f"from {found.parts[old].name}"
            )
    names = [part.name for part in parts]
    for row in set(range(len(parts))) - set(twins.values()):
        while names.count(names[row]) > 1:
            names[row] += "_found"
    parts = [replace(part, name=name) for part, name in zip(parts, names, strict=True)]
    return replace(found, parts=tuple(parts), notes=(*found.notes, *notes))
