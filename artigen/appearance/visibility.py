"""Voxel features as means over the views and states that show them (section 4.2.1 of the paper).

The paper averages over all views, including those in which a voxel is occluded. Here a view counts for a
voxel if the rendered depth and part there are the voxel's own; ``weighting="plain"`` is the paper's method.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch
from jaxtyping import Float, Int, Shaped
from torch import Tensor
from torch.nn import functional

from artigen.shapes.render.cameras import Cameras, camera_axes, pixel_sizes

Weighting = Literal["seen", "plain"]
TOLERANCE = 1.5
"""Largest difference of depths, in voxels, at which a view shows a voxel."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StateViews:
    """Pictures of one joint state with depths, parts and displacements, in unit lengths."""

    cameras: Cameras
    pictures: Float[Tensor, "V 4 H W"]
    """Colour and coverage, premultiplied on black."""
    depth: Float[Tensor, "V H W"]
    """Depth along the viewing direction; infinite at the background."""
    parts: Int[Tensor, "V H W"]
    """Part of the asset that each pixel shows."""
    surface: Float[Tensor, "V 4 H W"]
    """The pictures without what is visible through the nearest surface."""
    clear: Float[Tensor, "V H W"]
    """Transmission of the nearest surface at each pixel."""
    displacements: Float[np.ndarray, "P 4 4"]
    """Displacements of the parts from rest."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SeenVoxels:
    """Voxels that one view shows; directions in the frame of their part at rest."""

    rows: Int[Tensor, "K"]
    toward: Float[Tensor, "K 3"]
    """Unit directions to the camera."""
    color: Float[Tensor, "K 3"]
    """Colour of the surface alone, without what is visible through it."""
    clear: Float[Tensor, "K"]
    """Transmission of the surface."""


@dataclass(frozen=True, kw_only=True, eq=False)
class VoxelFeatures:
    """Mean features of voxels; zero for those that no view shows."""

    values: Float[np.ndarray, "N C"]
    views: Int[np.ndarray, "N"]
    """Number of views that counted for each voxel."""


class FeatureMean:
    """Accumulates features view by view."""

    def __init__(
        self,
        centers: Float[np.ndarray, "N 3"],
        part_ids: Int[np.ndarray, "N"],
        *,
        cell: float,
        weighting: Weighting = "seen",
    ) -> None:
        self.centers, self.part_ids = centers.astype(np.float64), part_ids.astype(np.int64)
        self.cell, self.weighting = cell, weighting
        self.views = torch.zeros(len(centers))
        self.sums: Tensor | None = None

    def add(self, views: StateViews, maps: Float[Tensor, "V C h w"]) -> list[SeenVoxels]:
        """Adds the views of a state with their feature ``maps``; returns the voxels that each view shows."""
        D = views.displacements[self.part_ids]
        moved = torch.from_numpy(np.einsum("nij,nj->ni", D[:, :3, :3], self.centers) + D[:, :3, 3])
        turn = torch.from_numpy(D[:, :3, :3]).float()
        place, depth = project_points(moved, views.cameras)
        counted = (place.abs() <= 1).all(dim=2) & (depth > 0)
        if self.weighting == "seen":
            counted &= (_read_pixels(views.depth, place) - depth).abs() <= TOLERANCE * self.cell
            counted &= _read_pixels(views.parts, place) == torch.from_numpy(self.part_ids)
        if self.sums is None:
            self.sums = torch.zeros(len(moved), maps.shape[1])
        clear = _read_pixels(views.clear, place)
        out = []
        for view, at in enumerate(place):
            rows = counted[view].nonzero()[:, 0]
            self.sums.index_add_(0, rows, _sample(maps[view], at[rows]))
            self.views[rows] += 1
            picture = _sample(views.surface[view], at[rows])
            toward = functional.normalize(views.cameras.position[view] - moved[rows], dim=1).float()
            out.append(
                SeenVoxels(
                    rows=rows,
                    toward=torch.einsum("nji,nj->ni", turn[rows], toward),
                    color=picture[:, :3] / picture[:, 3:].clamp(min=0.25),
                    clear=clear[view, rows],
                )
            )
        return out

    def finish(self) -> VoxelFeatures:
        """Means over the added views.

        Raises:
            ValueError: If no views were added.
        """
        if self.sums is None:
            raise ValueError("no views were added, expected at least one")
        values = self.sums / self.views.clamp(min=1.0)[:, None]
        return VoxelFeatures(values=values.numpy(), views=self.views.long().numpy())


def project_points(
    points: Float[Tensor, "N 3"], cameras: Cameras
) -> tuple[Float[Tensor, "V N 2"], Float[Tensor, "V N"]]:
    """Positions of points in each picture, from -1 to 1 along columns and rows, and their depths."""
    local = torch.einsum(
        "vij,vnj->vni", camera_axes(cameras), points.double()[None] - cameras.position.double()[:, None]
    )
    depth = local[:, :, 2]
    half = pixel_sizes(cameras)[:, None] / 2.0 * depth.clamp(min=1e-6)
    place = torch.stack(
        [local[:, :, 0] / (half * cameras.width), local[:, :, 1] / (half * cameras.height)], dim=2
    )
    return place.float(), depth.float()


def _read_pixels(values: Shaped[Tensor, "V H W"], place: Float[Tensor, "V N 2"]) -> Shaped[Tensor, "V N"]:
    """Values of the pixels at the given places; of the nearest border pixel for places outside."""
    height, width = values.shape[1:]
    column, row = (
        ((at + 1.0) / 2.0 * edge).floor().long().clamp(0, edge - 1)
        for at, edge in zip(place.unbind(2), (width, height), strict=True)
    )
    return values[torch.arange(len(values))[:, None], row, column]


def _sample(image: Float[Tensor, "C h w"], place: Float[Tensor, "N 2"]) -> Float[Tensor, "N C"]:
    found = functional.grid_sample(
        image[None], place[None, :, None], padding_mode="border", align_corners=False
    )
    return found[0, :, :, 0].T
