"""Converts a part's cells to a meshable solid: resolves contested, enclosed and badly connected cells.

Labelled surface cells differ from a solid in three ways. A cell that two parts touch is owned by one of them,
which leaves ragged layers where owners alternate. A closed box is hollow. Cells that meet only along an edge
or at a corner have no manifold surface. Every change is counted.
"""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from artigen.types import Asset, VoxelGrid
from sim_export.errors import DegeneratePart
from sim_export.geometry.grid import label_cells
from sim_export.geometry.joining import join_cells

_SMALL_HOLE = 16
"""Largest hole (cells) in a layer, filled by another part, that counts as the foot of a knob or handle."""
_RAGGED_SHARE = 0.15
"""Share of a layer at the part's box face that the part must own for the layer to be completed."""

MIN_LODGER = 8
"""Cells of other parts inside a cavity from which it stays free; fewer come from touching surfaces."""
SEAM_SHARE = 0.1
"""Largest share of surrounding cells, in rows, owned by others for a cavity to be the inside of a part."""
LEAF = 6
"""Largest width (cells) of cavities with seams: the inside of a door leaf."""
_OPENING = 3
"""Size (cells) of a square of others' cells around a cavity that counts as an opening of the part."""
_FACES = ndimage.generate_binary_structure(3, 1)


@dataclass(frozen=True, kw_only=True, eq=False)
class PartOccupancy:
    """The solid cells of one part, on the asset's whole grid, and the numbers of added cells.

    ``shared`` cells belong to another part whose surface runs through the same layer. ``enclosed`` cells were
    cavities without an exit. ``joined`` cells connect cells that touched only along an edge or at a corner.
    """

    occupancy: Bool[np.ndarray, "X Y Z"]
    shared: int
    enclosed: int
    joined: int

    @property
    def records(self) -> tuple[str, ...]:
        """One sentence for each kind of change."""
        kinds = (
            (self.shared, "cells shared with a neighbour completed its surface"),
            (self.enclosed, "cells of an enclosed cavity became solid"),
            (self.joined, "cells joined others that touched along an edge only"),
        )
        return tuple(f"{count} {what}" for count, what in kinds if count)


def require_voxels(asset: Asset) -> VoxelGrid:
    """The voxels of an asset; raises `ValueError` if it has none."""
    if asset.voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels; voxelize its surface first")
    return asset.voxels


def part_occupancy(
    voxels: VoxelGrid,
    part_id: int,
    box: Float[np.ndarray, "2 3"] | None = None,
    fittings: Collection[int] = (),
    *,
    leaf: bool = False,
) -> PartOccupancy:
    """Solid cells of a part: its own, those it shares in ragged layers, and enclosed cavities.

    ``box`` (lowest and highest corner in lattice units) tells how far the part extends into layers it
    contests with others; without it such layers stay ragged. ``fittings`` are parts that close the holes in
    which they sit, such as buttons. With ``leaf``, for doors and lids, cells of others within the box close
    the part's cavities, too. The result is well-composed: its boundary is a 2-manifold. Open cavities,
    like a drawer's, and cavities that contain other parts stay free; disconnected pieces stay separate.
    Raises `DegeneratePart` for a part without cells.
    """
    mine = voxels.part_ids == part_id
    if not mine.any():
        raise DegeneratePart(f"part {part_id}: owns 0 of {len(mine)} voxels, expected at least 1")
    whole = np.zeros((3, *(voxels.resolution,) * 3), dtype=bool)
    for grid, chosen in zip(whole, (mine, ~mine, np.isin(voxels.part_ids, list(fittings))), strict=True):
        grid[tuple(voxels.coords[chosen].T)] = True
    low = np.maximum(voxels.coords[mine].min(axis=0) - 1, 0)
    high = voxels.coords[mine].max(axis=0) + 2
    window = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
    own, others, plugs = (np.pad(grid[window], 2) for grid in whole)

    shared = own | _pits(own, others)
    if box is not None:
        shared |= _ragged_layers(shared, others, box - low + 2)
    within = np.zeros_like(own)
    if leaf and box is not None:
        first, last = np.ceil(box[0] - low + 2).astype(int), np.floor(box[1] - low + 2).astype(int)
        within[tuple(slice(max(a, 0), max(b, 0)) for a, b in zip(first, last, strict=True))] = True
    filled = _fill_cavities(shared, others, plugs, within)
    joined = join_cells(filled, others)
    solid = _fill_cavities(joined, others, plugs, within)
    inside = tuple(slice(2, -2) for _ in range(3))
    out = np.zeros(whole.shape[1:], dtype=bool)
    out[window] = solid[inside]
    return PartOccupancy(
        occupancy=out,
        shared=int(shared.sum() - own.sum()),
        enclosed=int(filled.sum() - shared.sum() + solid.sum() - joined.sum()),
        joined=int(joined.sum() - filled.sum()),
    )


def _pits(own: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Cells of others in gaps up to two cells wide, or in small holes, of a layer of this part.

    Only where the surface of the other part lies in that layer. A panel that stands in a slot occupies the
    layers before and behind as well, and the slot is kept.
    """
    pits = np.zeros_like(own)
    for normal in range(3):
        deep = np.roll(others, 1, normal) & np.roll(others, -1, normal)
        grid = own
        for axis in [a for a in range(3) if a != normal]:
            grid = grid | np.roll(grid, 1, axis) | np.roll(grid, -1, axis)
        for axis in [a for a in range(3) if a != normal]:
            grid = grid & np.roll(grid, 1, axis) & np.roll(grid, -1, axis)
        pits |= grid & others & ~deep
        pits |= _small_holes(own, others, normal) & ~deep
    return pits


def _small_holes(own: np.ndarray, others: np.ndarray, normal: int) -> np.ndarray:
    """In-plane components of others' cells, up to `_SMALL_HOLE` in size, that are surrounded by this part
    alone."""
    labels, count = label_cells(~own, _in_plane(normal))
    ids = labels.ravel()
    size = np.bincount(ids, minlength=count + 1)
    foreign = np.bincount(ids, weights=others.ravel(), minlength=count + 1)
    small = (size <= _SMALL_HOLE) & (foreign == size)
    small[0] = False
    return small[labels]


def _ragged_layers(own: np.ndarray, others: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Cells of others in the outermost layer of this part that lies within its box.

    Only over cells of this part, and only in connected regions of which it owns `_RAGGED_SHARE`.
    """
    out = np.zeros_like(own)
    for axis in range(3):
        layers = np.flatnonzero(own.any(axis=tuple(a for a in range(3) if a != axis)))
        for layer, inward, depth in (
            (layers[0], 1, layers[0] + 1 - box[0, axis]),
            (layers[-1], -1, box[1, axis] - layers[-1]),
        ):
            if not 0.05 <= depth <= 1.05:
                continue
            mine, theirs = np.take(own, layer, axis), np.take(others, layer, axis)
            wanted = theirs & np.take(own, layer + inward, axis)
            labels, count = label_cells(mine | wanted)
            held = np.bincount(labels.ravel(), weights=mine.ravel(), minlength=count + 1)
            total = np.bincount(labels.ravel(), minlength=count + 1)
            np.moveaxis(out, axis, 0)[layer] |= wanted & np.greater_equal(held, _RAGGED_SHARE * total)[labels]
    return out


def _in_plane(normal: int) -> np.ndarray:
    """Connectivity of cells that share a face within a layer."""
    structure = ndimage.generate_binary_structure(3, 1)
    np.moveaxis(structure, normal, 0)[[0, 2]] = False
    return structure


def _fill_cavities(grid: np.ndarray, others: np.ndarray, plugs: np.ndarray, within: np.ndarray) -> np.ndarray:
    """Fills empty cells that are not connected to the outside through cell faces; ``plugs`` close openings.

    A cavity that contains another part (the rack of a closed oven) stays free. The inside of a door leaf is
    also filled if its only openings are rows of cells that a neighbour owns in a shared layer, or cells
    ``within`` its box.
    """
    grid = grid | _seamed_cavities(grid, others, within)
    holes = np.asarray(ndimage.binary_fill_holes(grid | plugs), dtype=bool) & ~(grid | plugs)
    if not (holes & others).any():
        return grid | holes
    labels, count = label_cells(holes)
    lodgers = np.bincount(labels[others & holes], minlength=count + 1)
    return grid | (holes & (lodgers[labels] < MIN_LODGER))


def _seamed_cavities(grid: np.ndarray, others: np.ndarray, within: np.ndarray) -> np.ndarray:
    """Cavities between this part and others that belong to this part's inside, except for seams and for what
    others own ``within`` its box, such as the rim on which a lid with a plug lies."""
    closed = grid | others
    labels, count = label_cells(np.asarray(ndimage.binary_fill_holes(closed), dtype=bool) & ~closed)
    seamed = np.zeros(count + 1, dtype=bool)
    for index, window in enumerate(ndimage.find_objects(labels), start=1):
        if min(s.stop - s.start for s in window) > LEAF:
            continue
        near = tuple(slice(s.start - 1, s.stop + 1) for s in window)
        wall = np.asarray(ndimage.binary_dilation(labels[near] == index, _FACES), dtype=bool) & closed[near]
        foreign = wall & ~grid[near] & ~within[near]
        if foreign.sum() <= SEAM_SHARE * wall.sum():
            seamed[index] = not any(
                ndimage.binary_erosion(foreign, np.ones(np.where(np.arange(3) == normal, 1, _OPENING))).any()
                for normal in range(3)
            )
    return seamed[labels]
