"""Training data of a procedural object: voxel features and target pictures.

Every joint state is rendered once. Features come from all pictures, and some pictures are kept as targets
(section 4.2.1 of the paper: 8 states, 48 views each).
"""

from dataclasses import dataclass, field, replace

import numpy as np
import torch
from jaxtyping import Int

from artigen.appearance.features import FeatureExtractor
from artigen.appearance.paint import VoxelPaint
from artigen.appearance.photographs import (
    Pictures,
    join_pictures,
    keep_pictures,
    look_at_surface,
    photograph,
    premultiply,
    shown_parts,
)
from artigen.appearance.sides import SideMean, describe_sides
from artigen.appearance.states import plan_fractions
from artigen.appearance.vae import SIDE_CHANNELS
from artigen.appearance.views import ViewConfig, pick_cameras, scale_cameras
from artigen.appearance.visibility import FeatureMean, StateViews, VoxelFeatures, Weighting
from artigen.shapes.asset import frame_shape
from artigen.shapes.render import build_scene
from artigen.shapes.shape import Shape
from artigen.types import Asset
from artigen.voxels.surface import measure_places

AT_ONCE = 16
"""Pictures whose features are in memory at once."""


@dataclass(frozen=True, kw_only=True)
class CurationConfig:
    """Joint states, views, and the features and pictures made of them."""

    states: int = 8
    """Joint states; 1 is the closed object alone."""
    staggered: bool = True
    """Whether joints open in different orders; the paper opens all together."""
    views: ViewConfig = field(default_factory=ViewConfig)
    """Pictures of one state."""
    kept: int = 6
    """Pictures of a state that are kept as targets."""
    weighting: Weighting = "seen"
    """Which views count for a voxel: those that show it, or all, as in the paper."""
    sided: bool = False
    """Whether features include the appearance of both sides of a voxel (`artigen.appearance.sides`)."""
    painted: bool = True
    """Whether sides that few views show take the colour of their surface; if not, views alone count."""

    def channels(self, extractor: FeatureExtractor) -> int:
        """Channels of a voxel's features."""
        return extractor.channels + (SIDE_CHANNELS if self.sided else 0)


def curate(
    shape: Shape,
    asset: Asset,
    facings: Int[np.ndarray, "N"],
    extractor: FeatureExtractor,
    cfg: CurationConfig,
    paint: VoxelPaint,
) -> tuple[VoxelFeatures, Pictures]:
    """Features of the asset's voxels, and the pictures kept of every state.

    Args:
        asset: The same object with voxels and, where they have sides, samples of its surface.

    Raises:
        ValueError: If the asset has no voxels, or needs surface samples and has none.
    """
    if asset.voxels is None:
        raise ValueError(f"asset {asset.name!r} has no voxels; voxelize its surface first")
    if cfg.sided and asset.surface is None:
        raise ValueError(
            f"asset {asset.name!r} has no surface samples; positions of voxel sides are measured on them"
        )
    scene = build_scene([shape])
    center, scale = frame_shape(shape)
    centers, part_ids, cell = asset.voxels.centers(), asset.voxels.part_ids, 1.0 / asset.voxels.resolution
    mean = FeatureMean(centers, part_ids, cell=cell, weighting=cfg.weighting)
    sides = SideMean(asset.voxels, facings) if cfg.sided else None
    fractions = plan_fractions(shape, cfg.states, staggered=cfg.staggered)
    kept = []
    for number, state in enumerate(photograph(scene, asset, fractions, cfg.views)):
        pictures = premultiply(state.images)
        cameras = scale_cameras(state.cameras, center, scale)
        parts = torch.from_numpy(shown_parts(state)).long()
        surface, clear = pictures, torch.zeros_like(state.images.depth)
        if cfg.sided:
            own, clear = look_at_surface(scene, state)
            surface = premultiply(replace(state.images, rgb=own))
        for rows in torch.arange(len(pictures)).split(AT_ONCE):
            views = StateViews(
                cameras=pick_cameras(cameras, rows),
                pictures=pictures[rows],
                depth=state.images.depth[rows] / scale,
                parts=parts[rows],
                surface=surface[rows],
                clear=clear[rows],
                displacements=state.displacements,
            )
            with torch.no_grad():
                maps = extractor(views.pictures)
            for seen in mean.add(views, maps):
                if sides is not None:
                    sides.add(seen)
        kept.append(keep_pictures(scene, state, number, cameras, _spread_rows(cfg)))
    features = mean.finish()
    if sides is not None and asset.surface is not None:
        looks = sides.finish(paint if cfg.painted else None)
        described = describe_sides(looks, measure_places(asset.surface, asset.voxels, facings))
        features = replace(features, values=np.concatenate([features.values, described.numpy()], axis=1))
    return features, join_pictures(kept)


def _spread_rows(cfg: CurationConfig) -> Int[np.ndarray, "K"]:
    """Rows of the views that are kept of a state: evenly from low to high, with alternating backgrounds."""
    order = np.arange(cfg.kept)
    rows = np.floor(order * cfg.views.count / max(cfg.kept, 1)).astype(np.int64)
    return np.minimum(rows + (rows - order) % 2, cfg.views.count - 1)
