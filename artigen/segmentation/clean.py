"""Cleaning of generated voxel fields, a stage of its own: what hangs in the air is removed and recorded."""

from dataclasses import dataclass, fields, replace

import numpy as np
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
    if not len(found.coords):
        return found, ()
    dense = np.zeros((found.resolution,) * 3, dtype=bool)
    dense[tuple(found.coords.T)] = True
    pieces = np.zeros(dense.shape, dtype=np.int64)
    count = label(dense, structure=np.ones((3, 3, 3)), output=pieces)
    sizes = np.bincount(pieces.ravel())[1:]
    kept = sizes >= max(cfg.min_cells, cfg.min_share * len(found.coords))
    kept[sizes.argmax()] = True
    if kept.all():
        return found, ()
    stays = kept[pieces[tuple(found.coords.T)] - 1]
    note = f"{int((~stays).sum())} cells in {int((~kept).sum())} of {count} loose pieces were removed"
    return select_cells(found, stays), (note,)


def select_cells(found: VoxelFields, stays: np.ndarray) -> VoxelFields:
    """The fields of some of the cells."""
    chosen = {
        field.name: getattr(found, field.name)[stays]
        for field in fields(found)
        if field.name not in ("resolution", "layout")
    }
    return replace(found, **chosen)
