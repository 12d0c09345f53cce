"""What the two sides of voxels look like, and where they are: a thin board shows both of them in one voxel.

A mean over all views mixes the two, and an encoder would have to learn to take them apart. Here every view
counts for the side that it looks at, the more the less it looks along the board.
"""

import numpy as np
import torch
from jaxtyping import Float, Int
from scipy.spatial import KDTree
from torch import Tensor

from artigen.facings import facing_frames
from artigen.models.appearance_vae import COLOR_MIDDLE, COLOR_SPREAD, HEIGHT_REACH
from artigen.train.appearance.visibility import SeenVoxels

SURE = 0.5
"""Weight of views (a view from straight ahead counts as 1) at which a side is as good as known."""
HEIGHT = 0.3
"""Voxels that a side lies off the voxel's middle where no view says so."""
FARTHEST = 0.9
"""Share of their reach that Gaussians are moved by at most."""


class SideMean:
    """Adds up, view by view, colour and place of both sides of voxels; it has to remember, hence a class.

    Args:
        centers: Of the voxels, at rest.
        part_ids: Part that each voxel moves with.
        facings: Direction of each voxel's outer side.
        cell: Edge of a voxel.
    """

    def __init__(
        self,
        centers: Float[np.ndarray, "N 3"],
        part_ids: Int[np.ndarray, "N"],
        facings: Int[np.ndarray, "N"],
        cell: float,
    ) -> None:
        self.centers, self.part_ids, self.cell = centers, part_ids, cell
        self.outward = torch.from_numpy(facing_frames()[facings][:, :, 0]).float()
        self.weights = torch.zeros(2, len(centers))
        self.colors = torch.zeros(2, len(centers), 3)
        self.heights = torch.zeros(2, len(centers))
        self.clear = torch.zeros(len(centers))

    def add(self, seen: SeenVoxels) -> None:
        """Counts what one view shows."""
        ahead = (seen.toward * self.outward[seen.rows]).sum(dim=1)
        height = (seen.off * self.outward[seen.rows]).sum(dim=1) / self.cell
        self.clear[seen.rows] = torch.maximum(self.clear[seen.rows], seen.clear)
        for side, sign in enumerate((1.0, -1.0)):
            weight = (sign * ahead).clamp(min=0.0) ** 2
            self.weights[side, seen.rows] += weight
            self.colors[side, seen.rows] += weight[:, None] * seen.color
            self.heights[side, seen.rows] += weight * height

    def finish(self) -> Float[Tensor, "N 11"]:
        """How clear a voxel is; of the outer side, then the inner: colour, height, how well it is known.

        Heights are those over the voxel's middle. Colours and heights are scaled as the networks want them
        (`artigen.models.appearance_vae`). A side that no view shows has the colour of the other one, a voxel
        of which none shows either that of the nearest voxel of its part.
        """
        known = self.weights > 0
        weights = self.weights.clamp(min=1e-6)
        colors = self.colors / weights[..., None]
        heights = self.heights / weights
        for side, sign in enumerate((1.0, -1.0)):
            alone = known[1 - side] & ~known[side]
            colors[side, alone] = colors[1 - side, alone]
            heights[side, ~known[side]] = sign * HEIGHT
        colors = colors[:, torch.from_numpy(self._find_known(known.any(dim=0).numpy()))]
        reach = (heights / HEIGHT_REACH).clamp(-FARTHEST, FARTHEST)
        told = torch.cat(
            [
                (colors - COLOR_MIDDLE) / COLOR_SPREAD,
                torch.atanh(reach)[..., None],
                (self.weights / (self.weights + SURE))[..., None],
            ],
            dim=2,
        )
        return torch.cat([self.clear[:, None], told.transpose(0, 1).flatten(1)], dim=1)

    def _find_known(self, known: np.ndarray) -> Int[np.ndarray, "N"]:
        """For every voxel the nearest one of its part that was seen; itself where none was."""
        nearest = np.arange(len(known))
        for part in np.unique(self.part_ids[~known]):
            own = self.part_ids == part
            if (own & known).any():
                rows = np.flatnonzero(own & known)
                lost = np.flatnonzero(own & ~known)
                nearest[lost] = rows[KDTree(self.centers[rows]).query(self.centers[lost])[1]]
        return nearest
