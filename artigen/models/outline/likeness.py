"""Does an outline lie where a picture shows its parts? The best of cameras near the front says how well."""

from dataclasses import dataclass

import numpy as np
import torch
from jaxtyping import Float
from torch.nn import functional

from artigen.datasets.mesh_raster import Pinhole, project_points
from artigen.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy
from artigen.models.outline.boxes import box_views
from artigen.shapes.render.cameras import camera_axes, frame_points, pixel_sizes
from artigen.types import PART_LABELS, PartLabel

CORNERS = np.stack(np.meshgrid(*3 * [[-0.5, 0.5]], indexing="ij"), axis=-1).reshape(-1, 3)


@dataclass(frozen=True, kw_only=True)
class LikenessConfig:
    """From where pictures are looked at, and what counts."""

    turns: tuple[float, ...] = tuple(np.linspace(-0.6, 0.6, 9).tolist())
    """Turns of the camera to the side (radians)."""
    lifts: tuple[float, ...] = (0.0, 0.08, 0.17, 0.25)
    """Lifts of the camera (radians)."""
    labels: tuple[PartLabel, ...] = ("door", "drawer", "handle", "knob")
    """Parts that are looked for."""
    least: float = 1e-3
    """What a map is taken to say, per cell, where it says nothing."""


def measure_likeness(
    rows: Float[np.ndarray, "N C"],
    density: Float[np.ndarray, "L h w"],
    cfg: LikenessConfig,
    layout: FieldLayout = DEFAULT_LAYOUT,
) -> float:
    """Mean logarithm, over the parts that are looked for, of the map of their label where they would be seen.

    Args:
        rows: Channels after occupancy of each part.
        density: Parts of each label per cell of a square picture that the object fills
            (`artigen.models.picture_reader`).
        cfg: From where, and what.
        layout: Of the rows.
    """
    label = rows[:, after_occupancy(layout.label)].argmax(axis=1)
    center, size = box_views(rows, layout)
    kinds = [PART_LABELS.index(name) for name in cfg.labels]
    looked = np.isin(label, kinds)
    if not looked.any():
        return 0.0
    edge = density.shape[-1]
    corners = (center[:, None] + CORNERS * size[:, None]).reshape(-1, 3)
    middles = center[looked] - size[looked] * [0.5, 0.0, 0.0]  # of the sides that face the front
    logs = torch.from_numpy(np.log(density + cfg.least)[label[looked]])[:, None].float()
    best = -np.inf
    for turn in cfg.turns:
        for lift in cfg.lifts:
            across, up = np.cos(lift), np.sin(lift)
            way = (float(-np.cos(turn) * across), float(np.sin(turn) * across), float(up))
            camera = frame_points(corners, way, width=edge, height=edge)
            seen, _ = project_points(
                middles,
                Pinhole(
                    position=camera.position[0].numpy(),
                    axes=camera_axes(camera)[0].numpy(),
                    pixel=float(pixel_sizes(camera)[0]),
                    width=edge,
                    height=edge,
                ),
            )
            grid = torch.from_numpy(2.0 * seen / edge - 1.0).float()[:, None, None]
            found = functional.grid_sample(logs, grid, padding_mode="border", align_corners=False)
            best = max(best, float(found.mean()))
    return best
