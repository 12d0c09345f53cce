"""Neighbouring voxels, and the assignment of voxels to parts."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from artigen.types import PART_LABELS, PartLabel, frozen_array
from artigen.voxels.fields import VoxelFields

HALF_NEIGHBOURHOOD = np.array(
    [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) > (0, 0, 0)]
)
"""One of each pair of opposite directions among the 26 neighbours."""


def neighbour_pairs(coords: Int[np.ndarray, "N 3"], resolution: int) -> Int[np.ndarray, "2 E"]:
    """Index pairs of voxels that share a face, an edge or a corner; every pair once."""
    index = np.full((resolution + 2,) * 3, -1, dtype=np.int32)
    index[tuple((coords + 1).T)] = np.arange(len(coords))
    strides = np.array([(resolution + 2) ** 2, resolution + 2, 1])
    flat = (coords.astype(np.int64) + 1) @ strides
    found = []
    for step in HALF_NEIGHBOURHOOD @ strides:
        other = index.ravel()[flat + step]
        mine = np.flatnonzero(other >= 0)
        found.append(np.stack([mine, other[mine]]))
    return np.concatenate(found, axis=1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Partition:
    """Part of every voxel of a field, and the label of every part.

    Numbering is canonical: parts in the order of the labels, then from top to bottom, then
    along y, then along x. Every part owns at least one voxel.
    """

    part_ids: Int[np.ndarray, "N"]
    labels: tuple[PartLabel, ...]

    def __post_init__(self) -> None:
        ids = frozen_array(self.part_ids, np.int16, (None,), "partition part ids")
        object.__setattr__(self, "part_ids", ids)
        if set(np.unique(ids)) != set(range(len(self.labels))):
            raise ValueError(
                f"partition: {len(np.unique(ids))} parts own voxels, {len(self.labels)} labels given"
            )


def canonical_partition(
    fields: VoxelFields, groups: Int[np.ndarray, "N"], labels: Int[np.ndarray, "G"]
) -> Partition:
    """Renumbers ``groups`` canonically; ``labels`` gives each group's label number."""
    counts = np.bincount(groups, minlength=len(labels))
    used = np.flatnonzero(counts)
    middle = np.stack(
        [np.bincount(groups, weights=fields.coords[:, k], minlength=len(labels)) for k in range(3)]
    )
    middle = np.round(middle[:, used] / counts[used])  # 3 G, whole voxels so that noise does not reorder
    order = used[np.lexsort((used, middle[0], middle[1], -middle[2], labels[used]))]
    renumber = np.zeros(len(labels), dtype=np.int64)
    renumber[order] = np.arange(len(order))
    return Partition(part_ids=renumber[groups], labels=tuple(PART_LABELS[labels[index]] for index in order))
