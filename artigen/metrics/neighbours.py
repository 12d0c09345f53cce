"""Drawn objects and their nearest training objects, as numbers and as a picture.

A model that copies shows the same object twice in a row of the sheet.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from artigen.metrics.instantiation import (
    InstantiationConfig,
    PosedObject,
    instantiation_distance,
    pose_object,
)
from artigen.metrics.subjects import Subject
from artigen.metrics.voxel_pictures import draw_voxels
from artigen.types import Asset

CAPTION = 14
"""Height of a line of text in pixels."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Neighbour:
    """A training object and its instantiation distance."""

    asset: Asset
    distance: float


def pose_library(
    library: Sequence[Subject], cfg: InstantiationConfig
) -> dict[str, list[tuple[Asset, PosedObject]]]:
    """Training objects by category, posed once for all that is compared with them."""
    out: dict[str, list[tuple[Asset, PosedObject]]] = {}
    for subject in library:
        posed = (subject.asset, pose_object(subject.asset, cfg))
        out.setdefault(subject.asset.category, []).append(posed)
    return out


def find_neighbours(
    asset: Asset,
    library: dict[str, list[tuple[Asset, PosedObject]]],
    cfg: InstantiationConfig,
    count: int,
) -> list[Neighbour]:
    """The nearest training objects of the asset's category, the nearest first.

    Args:
        asset: The object, with voxels.
        library: From `pose_library` with the same ``cfg``.
        cfg: How finely objects are compared.
        count: How many at most.
    """
    own = pose_object(asset, cfg)
    distances = [
        Neighbour(asset=other, distance=instantiation_distance(own, posed))
        for other, posed in library.get(asset.category, [])
    ]
    return sorted(distances, key=lambda one: one.distance)[:count]


def draw_neighbours(
    rows: Sequence[tuple[Asset, Sequence[Neighbour]]], size: int = 128
) -> UInt8[np.ndarray, "H W 3"]:
    """A sheet: each row an object and its neighbours, each closed and open, with names and distances.

    Args:
        rows: At least one; all with the same number of neighbours, or fewer.
        size: Edge of a picture in pixels.

    Raises:
        ValueError: If there is no row.
    """
    if not rows:
        raise ValueError("a sheet has at least one row")
    columns = 1 + max(len(neighbours) for _, neighbours in rows)
    lines = []
    for asset, neighbours in rows:
        tiles = [_draw_tile(asset, f"drawn: {asset.category}", size)]
        tiles += [_draw_tile(one.asset, f"{one.asset.name}  {one.distance:.4f}", size) for one in neighbours]
        tiles += [np.full_like(tiles[0], 255)] * (columns - len(tiles))
        lines.append(np.concatenate(tiles, axis=1))
    return np.concatenate(lines, axis=0)


def write_sheet(sheet: UInt8[np.ndarray, "H W 3"], path: Path) -> None:
    """Writes a picture as PNG, whole or not at all."""
    from PIL import Image

    scratch = path.with_name(f".{path.name}")
    Image.fromarray(sheet).save(scratch, format="PNG")
    scratch.replace(path)


def _draw_tile(asset: Asset, caption: str, size: int) -> UInt8[np.ndarray, "H W 3"]:
    from PIL import Image, ImageDraw

    pictures = np.concatenate([draw_voxels(asset, opened, size) for opened in (0.0, 0.7)], axis=1)
    tile = Image.new("RGB", (2 * size, size + CAPTION), (255, 255, 255))
    tile.paste(Image.fromarray(pictures), (0, 0))
    ImageDraw.Draw(tile).text((4, size), caption, fill=(0, 0, 0))
    return np.asarray(tile)
