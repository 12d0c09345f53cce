"""Extent of other parts at the faces of a part's cells.

A voxel gives the cell of a surface, but a box gives exactly where a part ends. Where a knob's back meets a
panel, the knob's box therefore locates the panel within its cell.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.types import VoxelGrid

DIRECTIONS: tuple[tuple[int, int], ...] = ((0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1))
"""(axis, sign) of the six face normals, in the order in which faces are listed everywhere."""

_REACH = 1.25
"""Distance (cells) between a part's last layer of cells and its box above which the box is not trusted."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NeighbourFaces:
    """Cell faces at which a neighbour's box ends, and its coordinate there, in lattice units.

    ``direction`` indexes `DIRECTIONS` and is that of the face of the part's own cell, which may not exist:
    the neighbour's cell itself, or the one before it.
    """

    direction: Int[np.ndarray, "N"]
    cell: Int[np.ndarray, "N 3"]
    coordinate: Float[np.ndarray, "N"]


def find_neighbour_faces(
    voxels: VoxelGrid, boxes: Sequence[Float[np.ndarray, "2 3"]], part_id: int
) -> NeighbourFaces:
    """Faces at which the boxes of other parts end; ``boxes`` of all parts in lattice units."""
    directions, cells, coordinates = [], [], []
    for other, box in enumerate(boxes):
        if other == part_id:
            continue
        own = voxels.coords[voxels.part_ids == other]
        if not len(own):
            continue
        for number, (axis, sign) in enumerate(DIRECTIONS):
            # An upward face meets the neighbour's lower side, and vice versa.
            side = float(box[0 if sign > 0 else 1, axis])
            last = int(own[:, axis].min() if sign > 0 else own[:, axis].max())
            if abs(side - last - (sign < 0)) > _REACH:
                continue
            layer = own[own[:, axis] == last]
            before = layer.copy()
            before[:, axis] -= sign
            for at in (layer, before):
                directions.append(np.full(len(at), number))
                cells.append(at)
                coordinates.append(np.full(len(at), side))
    return NeighbourFaces(
        direction=np.concatenate([np.zeros(0, dtype=np.int64), *directions]),
        cell=np.concatenate([np.zeros((0, 3), dtype=np.int64), *cells]),
        coordinate=np.concatenate([np.zeros(0), *coordinates]),
    )
