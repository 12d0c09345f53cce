"""Cleaning of generated voxel fields, a stage of its own: what hangs in the air is removed and recorded."""

from dataclasses import dataclass, fields, replace

import numpy as np
from jaxtyping import Bool
from scipy.ndimage import label

from artigen.fields import VoxelFields


@dataclass(frozen=True, kw_only=True)
class CleanConfig:
    """What counts as stray."""

    min_cells: int = 30
    """Pieces (26 neighbours) of fewer cells are removed."""
    min_share: float = 0.002
    """So are pieces that hold a smaller share of all cells."""


def remove_strays(found: VoxelFields, cfg: CleanConfig | None = None) -> tuple[VoxelFields, tuple[str, ...]]:
    """Fields without small loose pieces, and a note if there were any; the largest piece always stays."""
    cfg = cfg or CleanConfig()
    occupied = np.zeros((found.resolution,) * 3, dtype=bool)
    occupied[tuple(found.coords.T)] = True
    strays, notes = find_strays(occupied, cfg)
    return (select_cells(found, ~strays[tuple(found.coords.T)]), notes) if notes else (found, ())


def find_strays(
    occupied: Bool[np.ndarray, "X Y Z"], cfg: CleanConfig
) -> tuple[Bool[np.ndarray, "X Y Z"], tuple[str, ...]]:
    """The cells of small loose pieces, and a note if there are any; the largest piece is none."""
    if not occupied.any():
        return np.zeros_like(occupied), ()
    pieces = np.zeros(occupied.shape, dtype=np.int64)
    count = label(occupied, structure=np.ones((3, 3, 3)), output=pieces)
    sizes = np.bincount(pieces.ravel())[1:]
    loose = sizes < max(cfg.min_cells, cfg.min_share * np.count_nonzero(occupied))
    loose[sizes.argmax()] = False
    if not loose.any():
        return np.zeros_like(occupied), ()
    strays = np.concatenate([[False], loose])[pieces]
    note = f"{int(strays.sum())} cells in {int(loose.sum())} of {count} loose pieces were removed"
    return strays, (note,)


def select_cells(found: VoxelFields, stays: np.ndarray) -> VoxelFields:
    """The fields of some of the cells."""
    chosen = {
        field.name: getattr(found, field.name)[stays]
        for field in fields(found)
        if field.name not in ("resolution", "layout")
    }
    return replace(found, **chosen)
