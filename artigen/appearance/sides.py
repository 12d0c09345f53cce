"""Colours and geometry of the two sides of voxels, for boards that are thinner than a voxel.

A mean over all views mixes the two sides, and an encoder would have to learn to separate them. Here every
view counts for the side that it shows, with a weight that falls as the view grazes the board.
"""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree
from torch import Tensor

from artigen.appearance.paint import VoxelPaint
from artigen.appearance.vae import COLOR_MIDDLE, COLOR_SPREAD, SIDE_CHANNELS
from artigen.appearance.visibility import SeenVoxels
from artigen.types import VoxelGrid
from artigen.voxels.frames import count_behind, facing_frames
from artigen.voxels.surface import PLACES, VoxelPlaces, describe_places

SURE = 0.5
"""Sum of view weights at which the seen colour of a side counts one half; a frontal view weighs 1."""
CLEAR = 0.1
"""Transmission above which a voxel counts as a pane."""
SHADES = 24
"""Steps per colour channel into which painted colours are grouped."""
FEW = 5
"""Sides that a shade needs for its seen colour to count."""
PLACED = (4, 8, 9, 10, 11, 12)
"""Side features that hold the position of the surface (`artigen.voxels.surface.describe_places`)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SideLooks:
    """Appearance of voxel sides in views: outer sides first, then inner ones."""

    colors: Float[Tensor, "2 N 3"]
    clear: Float[Tensor, "N"]
    """Transmission of each voxel."""


class SideMean:
    """Accumulates, view by view, the colours of both sides of voxels."""

    def __init__(self, voxels: VoxelGrid, facings: Int[np.ndarray, "N"]) -> None:
        self.voxels, self.facings = voxels, facings
        self.outward = torch.from_numpy(facing_frames()[facings][:, :, 0]).float()
        self.weights = torch.zeros(2, len(facings))
        self.colors = torch.zeros(2, len(facings), 3)
        self.clear = torch.zeros(len(facings))

    def add(self, seen: SeenVoxels) -> None:
        """Adds the voxels that one view shows."""
        ahead = (seen.toward * self.outward[seen.rows]).sum(dim=1)
        for side, sign in enumerate((1.0, -1.0)):
            weight = (sign * ahead).clamp(min=0.0) ** 2
            self.weights[side, seen.rows] += weight
            self.colors[side, seen.rows] += weight[:, None] * seen.color
            self.clear[seen.rows] += weight * seen.clear

    def finish(self, paint: VoxelPaint | None) -> SideLooks:
        """Means over the added views.

        The less a side was seen, the more it takes the seen colour of sides that are painted alike: few views
        look into an opening, and pixels at its rim mix with the surroundings. Panes have only their seen
        colour. A side that is neither seen nor painted takes the colour of the other side, and a voxel
        without either that of the nearest voxel of its part.

        Args:
            paint: Paint of the same voxels; when None, only views count.
        """
        known = self.weights / (self.weights + SURE)
        clear = self.clear / self.weights.sum(dim=0).clamp(min=1e-6)
        colors, colored = self.colors / self.weights.clamp(min=1e-6)[..., None], known > 0
        if paint is not None:
            painted = torch.from_numpy((paint.known.T > 0) & (paint.clear <= CLEAR)) & (clear <= CLEAR)
            own = torch.from_numpy(paint.colors).float().transpose(0, 1)
            trust = torch.where(painted, known, 1.0)[..., None]
            colors = trust * colors + (1.0 - trust) * see_alike(own, colors, painted & (known > 0.5))
            colored = colored | painted
        for side in range(2):
            alone = colored[1 - side] & ~colored[side]
            colors[side, alone] = colors[1 - side, alone]
        return SideLooks(
            colors=colors[:, torch.from_numpy(self._find_colored(colored.any(dim=0).numpy()))],
            clear=self._share_clear(clear),
        )

    def _find_colored(self, colored: np.ndarray) -> Int[np.ndarray, "N"]:
        """For every voxel the nearest one of its part that has a colour; itself where none has."""
        nearest, cells, part_ids = np.arange(len(colored)), self.voxels.coords, self.voxels.part_ids
        for part in np.unique(part_ids[~colored]):
            own = part_ids == part
            if (own & colored).any():
                rows = np.flatnonzero(own & colored)
                lost = np.flatnonzero(own & ~colored)
                nearest[lost] = rows[KDTree(cells[rows]).query(cells[lost])[1]]
        return nearest

    def _share_clear(self, clear: Float[Tensor, "N"]) -> Float[Tensor, "N"]:
        """Transmission of each single voxel, where several in a row form a pane that transmits ``clear``."""
        pane = (clear > CLEAR).numpy()
        cells, part_ids = self.voxels.coords[pane], self.voxels.part_ids[pane]
        behind = count_behind(cells, part_ids, self.facings[pane], self.voxels.resolution)
        shared = clear.clone()
        shared[pane] = clear[pane] ** (1.0 / torch.from_numpy(behind).float())
        return shared


def see_alike(
    painted: Float[Tensor, "2 N 3"], seen: Float[Tensor, "2 N 3"], sure: Bool[Tensor, "2 N"]
) -> Float[Tensor, "2 N 3"]:
    """Colours in which painted sides would be seen: light and gloss change each as others of its shade.

    A shade with fewer than `FEW` well-known sides takes the change of the nearest shade that has enough; if
    there is none, colours stay as painted.

    Args:
        painted: Surface colours of the sides.
        seen: Colours in which they are seen.
        sure: Mask of the sides whose seen colour is well known.
    """
    shades = torch.round(painted * SHADES)
    groups, number, count = torch.unique(shades[sure], dim=0, return_inverse=True, return_counts=True)
    many = count >= FEW
    if not bool(many.any()):
        return painted
    changes = torch.zeros(len(groups), 3).index_add_(0, number, seen[sure] - painted[sure])
    nearest = KDTree(groups[many].numpy()).query(shades.numpy())[1]
    return painted + (changes / count[:, None])[many][torch.from_numpy(nearest)]


def describe_sides(looks: SideLooks, places: VoxelPlaces) -> Float[Tensor, "N 13"]:
    """Features of voxels with two sides, scaled for the networks (`artigen.appearance.vae`).

    Transmission; colour and height of the outer side, then of the inner; middles of the surface across, and
    the logarithms of its widths. How well a side is known is left out on purpose: a network that recognises
    sides that no picture shows can shrink their Gaussians at no cost.
    """
    heights, across = torch.from_numpy(describe_places(places)).float().split([2, PLACES - 2], dim=1)
    colors = (looks.colors - COLOR_MIDDLE) / COLOR_SPREAD
    sides = torch.cat([colors, heights.T[..., None]], dim=2)
    return torch.cat([looks.clear[:, None], sides.transpose(0, 1).flatten(1), across], dim=1)


def recall_places(features: Float[np.ndarray, "N C"]) -> Float[np.ndarray, "N 6"]:
    """Surface positions from features that end with those of `describe_sides`."""
    return features[:, -SIDE_CHANNELS:][:, PLACED]
