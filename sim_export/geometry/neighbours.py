"""Extent of other parts at the faces of a part's cells.

A voxel says which cell a surface is in; a box says exactly where a part ends. Where a knob's back
meets a panel, the knob's box so tells where in its cell the panel lies.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.types import VoxelGrid

DIRECTIONS: tuple[tuple[int, int], ...] = ((0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1))
"""(axis, sign) of the six face normals, in the order in which faces are listed everywhere."""

_REACH = 1.25
"""Cells between a part's last layer of cells and its box, beyond which the box is not believed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NeighbourFaces:
    """Cell faces at which a neighbour's box ends, and its coordinate there, in lattice units.

    ``direction`` indexes `DIRECTIONS` and is that of the face of the part's own cell, which may or
    may not be there: the neighbour's cell itself, or the one before it.
    """

    direction: Int[np.ndarray, "N"]
    cell: Int[np.ndarray, "N 3"]
    coordinate: Float[np.ndarray, "N"]


def find_neighbour_faces(
    voxels: VoxelGrid, boxes: Sequence[Float[np.ndarray, "2 3"]], part_id: int
) -> NeighbourFaces:
    """Where the other parts' boxes end; ``boxes`` of all parts in lattice units."""
    directions, cells, coordinates = [], [], []
    for other, box in enumerate(boxes):
        if other == part_id:
            continue
        own = voxels.coords[voxels.part_ids == other]
        if not len(own):
            continue
        for number, (axis, sign) in enumerate(DIRECTIONS):
            # A face that looks up meets the neighbour's lower side, and the other way round.
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
