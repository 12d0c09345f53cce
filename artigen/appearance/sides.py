"""Colours and geometry of the two sides of voxels, for boards that are thinner than a voxel.

A mean over all views mixes the two, and an encoder would have to learn to take them apart. Here every view
counts for the side that it looks at, the more the less it looks along the board.
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
"""Weight of views (a view from straight ahead counts as 1) at which a side is as good as known."""
CLEAR = 0.1
"""Share of what is behind that is seen through a pane, at least."""
SHADES = 24
"""Steps of a colour's channels within which sides are painted alike."""
FEW = 5
"""Sides that a shade needs before it is told how it is seen."""
PLACED = (4, 8, 9, 10, 11, 12)
"""Which side features say where surface lies, as `artigen.voxels.surface.describe_places` does."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SideLooks:
    """Appearance of voxel sides in views: outer sides first, then inner ones."""

    colors: Float[Tensor, "2 N 3"]
    clear: Float[Tensor, "N"]
    """Share of what is behind a voxel that is seen through it."""


class SideMean:
    """Adds up, view by view, the colours of both sides of voxels; it has to remember, hence a class.

    Args:
        voxels: Of the object, at rest.
        facings: Direction of each voxel's outer side.
    """

    def __init__(self, voxels: VoxelGrid, facings: Int[np.ndarray, "N"]) -> None:
        self.voxels, self.facings = voxels, facings
        self.outward = torch.from_numpy(facing_frames()[facings][:, :, 0]).float()
        self.weights = torch.zeros(2, len(facings))
        self.colors = torch.zeros(2, len(facings), 3)
        self.clear = torch.zeros(len(facings))

    def add(self, seen: SeenVoxels) -> None:
        """Counts what one view shows."""
        ahead = (seen.toward * self.outward[seen.rows]).sum(dim=1)
        for side, sign in enumerate((1.0, -1.0)):
            weight = (sign * ahead).clamp(min=0.0) ** 2
            self.weights[side, seen.rows] += weight
            self.colors[side, seen.rows] += weight[:, None] * seen.color
            self.clear[seen.rows] += weight * seen.clear

    def finish(self, paint: VoxelPaint | None) -> SideLooks:
        """Means of what was added.

        The less a side was seen, the more it has the colour in which sides that are painted alike are seen:
        few views look into what is open, and pixels at its rim show what stands there. What shines on glass
        is seen alone. A side that is neither seen nor painted has the colour of the other one, a voxel
        without either that of the nearest voxel of its part.

        Args:
            paint: of the same voxels; without, views alone tell.
        """
        known = self.weights / (self.weights + SURE)
        clear = self.clear / self.weights.sum(dim=0).clamp(min=1e-6)
        colors, told = self.colors / self.weights.clamp(min=1e-6)[..., None], known > 0
        if paint is not None:
            painted = torch.from_numpy((paint.known.T > 0) & (paint.clear <= CLEAR)) & (clear <= CLEAR)
            own = torch.from_numpy(paint.colors).float().transpose(0, 1)
            trust = torch.where(painted, known, 1.0)[..., None]
            colors = trust * colors + (1.0 - trust) * see_alike(own, colors, painted & (known > 0.5))
            told = told | painted
        for side in range(2):
            alone = told[1 - side] & ~told[side]
            colors[side, alone] = colors[1 - side, alone]
        return SideLooks(
            colors=colors[:, torch.from_numpy(self._find_told(told.any(dim=0).numpy()))],
            clear=self._share_clear(clear),
        )

    def _find_told(self, told: np.ndarray) -> Int[np.ndarray, "N"]:
        """For every voxel the nearest one of its part that has a colour; itself where none has."""
        nearest, cells, part_ids = np.arange(len(told)), self.voxels.coords, self.voxels.part_ids
        for part in np.unique(part_ids[~told]):
            own = part_ids == part
            if (own & told).any():
                rows = np.flatnonzero(own & told)
                lost = np.flatnonzero(own & ~told)
                nearest[lost] = rows[KDTree(cells[rows]).query(cells[lost])[1]]
        return nearest

    def _share_clear(self, clear: Float[Tensor, "N"]) -> Float[Tensor, "N"]:
        """Transmission of each voxel where several share a pane that transmits ``clear``."""
        pane = (clear > CLEAR).numpy()
        cells, part_ids = self.voxels.coords[pane], self.voxels.part_ids[pane]
        behind = count_behind(cells, part_ids, self.facings[pane], self.voxels.resolution)
        shared = clear.clone()
        shared[pane] = clear[pane] ** (1.0 / torch.from_numpy(behind).float())
        return shared


def see_alike(
    painted: Float[Tensor, "2 N 3"], seen: Float[Tensor, "2 N 3"], sure: Bool[Tensor, "2 N"]
) -> Float[Tensor, "2 N 3"]:
    """The colours in which sides would be seen: light and gloss change them as they do others of the shade.

    Args:
        painted: colours of the sides.
        seen: colours in which they are seen.
        sure: whether that is well known; where few sides of a shade are, the nearest shade counts, and where
            there is none, what is painted.
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
    """Features of voxels with two sides, scaled as the networks want them (`artigen.appearance.vae`).

    How clear a voxel is; of the outer side, then the inner: colour and height; where the middle of the
    surface lies across, and the logarithms of its widths. Not how well a side is known: a network that can
    tell the sides that no picture shows lets their Gaussians shrink, which costs it nothing.
    """
    heights, across = torch.from_numpy(describe_places(places)).float().split([2, PLACES - 2], dim=1)
    colors = (looks.colors - COLOR_MIDDLE) / COLOR_SPREAD
    told = torch.cat([colors, heights.T[..., None]], dim=2)
    return torch.cat([looks.clear[:, None], told.transpose(0, 1).flatten(1), across], dim=1)


def recall_places(features: Float[np.ndarray, "N C"]) -> Float[np.ndarray, "N 6"]:
    """Surface position from features that end with those of `describe_sides`."""
    return features[:, -SIDE_CHANNELS:][:, PLACED]
