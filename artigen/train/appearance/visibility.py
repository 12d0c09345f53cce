"""Features of voxels: means over the views and joint states that show them (section 4.2.1 of the paper).

The paper averages over all views, also those in which something else stands in front of a voxel. Here, a
view counts for a voxel if the depth that was rendered there is the voxel's own; ``weighting="plain"`` is the
paper's way.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor
from torch.nn import functional

from artigen.shapes.render.cameras import Cameras, camera_axes, pixel_sizes

Weighting = Literal["seen", "plain"]
MOMENTS = 12
"""Channels that say from where a voxel was seen, and how its colour depends on that."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StateViews:
    """Pictures of one joint state: what they show, and how parts have moved; all in unit lengths."""

    cameras: Cameras
    pictures: Float[Tensor, "V 4 H W"]
    """Colour and coverage, premultiplied on black."""
    depth: Float[Tensor, "V H W"]
    """Along the viewing direction; infinite where nothing is seen."""
    displacements: Float[np.ndarray, "P 4 4"]
    """Of the parts, from rest."""


@dataclass(frozen=True, kw_only=True, eq=False)
class VoxelFeatures:
    """Mean features of voxels; zero for those that no view counted for."""

    values: Float[np.ndarray, "N C"]
    views: Int[np.ndarray, "N"]
    """Views that counted."""


class FeatureMean:
    """Adds up features view by view; it has to remember, hence a class.

    Args:
        centers: Of the voxels, at rest.
        part_ids: Part that each voxel moves with.
        cell: Edge of a voxel.
        weighting: Which views count for a voxel.
        tolerance: Largest difference of depths in voxels at which a voxel counts as seen.
        directional: Whether `MOMENTS` channels are appended: the mean direction that a voxel was seen from,
            in the part's own frame, and the covariance of colour and direction. A thin board has two sides
            in one voxel.
    """

    def __init__(
        self,
        centers: Float[np.ndarray, "N 3"],
        part_ids: Int[np.ndarray, "N"],
        *,
        cell: float,
        weighting: Weighting = "seen",
        tolerance: float = 1.5,
        directional: bool = False,
    ) -> None:
        self.centers, self.part_ids = centers.astype(np.float64), part_ids.astype(np.int64)
        self.cell, self.weighting, self.tolerance = cell, weighting, tolerance
        self.directional = directional
        self.views = torch.zeros(len(centers))
        self.sums: Tensor | None = None
        self.directions = torch.zeros(len(centers), 3)
        self.colors = torch.zeros(len(centers), 3)
        self.products = torch.zeros(len(centers), 3, 3)

    def add(self, views: StateViews, maps: Float[Tensor, "V C h w"]) -> None:
        """Counts the views of a state; ``maps`` are the features of its pictures."""
        D = views.displacements[self.part_ids]
        moved = torch.from_numpy(np.einsum("nij,nj->ni", D[:, :3, :3], self.centers) + D[:, :3, 3])
        place, depth = project_points(moved, views.cameras)
        counted = find_seen(place, depth, views.depth, self.tolerance * self.cell)
        if self.weighting == "plain":
            counted = (place.abs() <= 1).all(dim=2) & (depth > 0)
        if self.sums is None:
            self.sums = torch.zeros(len(moved), maps.shape[1])
        turn = torch.from_numpy(D[:, :3, :3]).float()
        for view, at in enumerate(place):
            rows = counted[view].nonzero()[:, 0]
            self.sums[rows] += _sample(maps[view], at[rows])
            self.views[rows] += 1
            if self.directional:
                away = views.cameras.position[view] - moved[rows]
                away = functional.normalize(away, dim=1).float()
                away = torch.einsum("nji,nj->ni", turn[rows], away)
                color = _sample(views.pictures[view, :3], at[rows])
                self.directions[rows] += away
                self.colors[rows] += color
                self.products[rows] += color[:, :, None] * away[:, None, :]

    def finish(self) -> VoxelFeatures:
        """Means over what was counted.

        Raises:
            ValueError: If nothing was added.
        """
        if self.sums is None:
            raise ValueError("no views were added, expected at least one")
        count = self.views.clamp(min=1.0)[:, None]
        values = self.sums / count
        if self.directional:
            direction, color = self.directions / count, self.colors / count
            spread = self.products / count[:, :, None] - color[:, :, None] * direction[:, None, :]
            values = torch.cat([values, direction, spread.flatten(1)], dim=1)
        return VoxelFeatures(values=values.numpy(), views=self.views.long().numpy())


def project_points(
    points: Float[Tensor, "N 3"], cameras: Cameras
) -> tuple[Float[Tensor, "V N 2"], Float[Tensor, "V N"]]:
    """Where points are in each picture, from -1 to 1 across and along, and their depths."""
    local = torch.einsum(
        "vij,vnj->vni", camera_axes(cameras), points.double()[None] - cameras.position.double()[:, None]
    )
    depth = local[:, :, 2]
    half = pixel_sizes(cameras)[:, None] / 2.0 * depth.clamp(min=1e-6)
    place = torch.stack(
        [local[:, :, 0] / (half * cameras.width), local[:, :, 1] / (half * cameras.height)], dim=2
    )
    return place.float(), depth.float()


def find_seen(
    place: Float[Tensor, "V N 2"],
    depth: Float[Tensor, "V N"],
    rendered: Float[Tensor, "V H W"],
    tolerance: float,
) -> Bool[Tensor, "V N"]:
    """Whether the surface that was rendered where a point is lies at its depth, within ``tolerance``."""
    there = functional.grid_sample(
        rendered[:, None], place[:, :, None], mode="nearest", padding_mode="border", align_corners=False
    )[:, 0, :, 0]
    inside = (place.abs() <= 1).all(dim=2) & (depth > 0)
    return inside & ((there - depth).abs() <= tolerance)


def _sample(image: Float[Tensor, "C h w"], place: Float[Tensor, "N 2"]) -> Float[Tensor, "N C"]:
    found = functional.grid_sample(
        image[None], place[None, :, None], padding_mode="border", align_corners=False
    )
    return found[0, :, :, 0].T
