"""Assignment of voxels to parts, the result of every segmentation recipe."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from artigen.types import PART_LABELS, PartLabel, frozen_array
from artigen.voxels.fields import VoxelFields


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
