"""Pictures of an asset's voxels, parts in different colours, closed or open."""

import colorsys

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.datasets.partnet_surface import FaceTable
from artigen.examples.mesh_pictures import FINE, picture_mesh
from artigen.files.wavefront import Material
from artigen.kinematics import articulate_points, qlimits
from artigen.types import PART_LABELS, Asset, PartLabel, VoxelGrid

HUES: dict[PartLabel, float | None] = {
    "base": None,
    "drawer": 0.58,
    "door": 0.09,
    "handle": 0.0,
    "knob": 0.83,
    "tray": 0.45,
    "shelf": 0.3,
    "wheel": 0.7,
}
"""Hue of each label, 0 to 1; None is grey."""
LIGHTNESS = (0.6, 0.74, 0.5)
"""Lightness of the parts of one label in turn, so that neighbours are distinguishable."""
VIEW = (-1.0, 0.55, 0.4)
"""Direction from the object to the camera: from the front left and above."""
_CORNERS = np.array(
    [
        [[side, *square] if axis == 0 else [square[0], side, square[1]] if axis == 1 else [*square, side]
         for square in ((0, 0), (1, 0), (1, 1), (0, 1))]
        for axis in range(3)
        for side in (0, 1)
    ],
    dtype=np.float64,
)  # fmt: skip
"""Corners of the six faces of a cell: low and high, along x, y and z."""


def draw_voxels(asset: Asset, opened: float, size: int) -> UInt8[np.ndarray, "H W 3"]:
    """Renders the cells of an asset in the colours of their parts, on white, from the front left.

    Args:
        asset: Object with voxels.
        opened: Share of its range by which every joint is open, 0 to 1.
        size: Edge of the picture in pixels.

    Raises:
        ValueError: If the asset has no occupied cell.
    """
    from artigen.shapes.render.cameras import frame_points

    if asset.voxels is None or not len(asset.voxels.coords):
        raise ValueError(f"asset {asset.name!r} has no occupied cell to draw")
    squares, part_ids = list_squares(asset.voxels)
    corners = articulate_points(
        asset, opened * qlimits(asset)[:, 1], squares.reshape(-1, 3), np.repeat(part_ids, 4)
    )
    first = 4 * np.arange(len(squares))[:, None]
    faces = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    mesh = FaceTable(
        vertices=corners,
        faces=faces,
        corners=corners[faces],
        uv=np.zeros((len(faces), 3, 2)),
        material_ids=np.tile(part_ids, 2),
        materials=tuple(Material(color=color) for color in _part_colors(asset)),
    )
    cameras = frame_points(asset.scale * corners, VIEW, width=FINE * size, height=FINE * size)
    seen = picture_mesh([mesh], asset.scale, cameras).rgba
    return seen[..., :3] + (255 - seen[..., 3:])


def list_squares(voxels: VoxelGrid) -> tuple[Float[np.ndarray, "N 4 3"], Int[np.ndarray, "N"]]:
    """Cell faces without a neighbouring cell of the same part, and the part of each; unit lengths."""
    edge = voxels.resolution + 2
    owners = np.full((edge, edge, edge), -1, dtype=np.int64)
    coords = voxels.coords.astype(np.int64)
    owners[tuple((coords + 1).T)] = voxels.part_ids
    squares, part_ids = [], []
    for number, corners in enumerate(_CORNERS):
        step = np.zeros(3, dtype=np.int64)
        step[number // 2] = 2 * (number % 2) - 1
        bare = owners[tuple((coords + 1 + step).T)] != voxels.part_ids
        squares.append((coords[bare][:, None] + corners) / voxels.resolution - 0.5)
        part_ids.append(voxels.part_ids[bare].astype(np.int64))
    return np.concatenate(squares), np.concatenate(part_ids)


def _part_colors(asset: Asset) -> list[tuple[float, float, float]]:
    """Colours of the parts: hue by label, lightness in turn."""
    seen = dict.fromkeys(PART_LABELS, 0)
    out = []
    for part in asset.parts:
        lightness = LIGHTNESS[seen[part.label] % len(LIGHTNESS)]
        seen[part.label] += 1
        hue = HUES[part.label]
        out.append(colorsys.hls_to_rgb(hue or 0.0, lightness, 0.0 if hue is None else 0.6))
    return out
