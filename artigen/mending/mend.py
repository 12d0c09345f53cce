"""All stages that drawn cells go through before parts are found, in their order."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from jaxtyping import Float

from artigen.fields import VoxelFields
from artigen.mending.boards import BoardsConfig, make_boards
from artigen.mending.claim import claim_cells
from artigen.mending.clean import CleanConfig, find_strays, remove_strays
from artigen.mending.doorways import clear_doorways
from artigen.mending.faces import even_faces
from artigen.mending.feet import extend_feet
from artigen.mending.fronts import fill_fronts
from artigen.mending.knobs import shape_knobs
from artigen.mending.legs import extend_legs
from artigen.mending.panels import back_knobs
from artigen.mending.paths import clear_paths
from artigen.mending.portholes import round_portholes
from artigen.mending.revolve import revolve_parts
from artigen.mending.rows import Owners, fields_of_owners, read_owners
from artigen.mending.shafts import extend_shafts

Stage = Callable[[Owners], tuple[Owners, tuple[str, ...]]]
"""Other owners of the cells, and notes of what was changed."""


@dataclass(frozen=True, kw_only=True)
class MendConfig:
    """What is mended."""

    boards: BoardsConfig | None = field(default_factory=BoardsConfig)
    """What counts as a board, where outlines are drawn; None: cells stay as they are."""
    clean: CleanConfig = field(default_factory=CleanConfig)
    """What counts as a stray piece."""


def mend_cells(
    fields: VoxelFields,
    logits: Float[np.ndarray, "X Y Z"],
    rows: Float[np.ndarray, "N C"] | None,
    cfg: MendConfig | None = None,
) -> tuple[VoxelFields, tuple[str, ...]]:
    """Drawn cells made whole, and notes of what was done; without an outline, only strays are removed.

    Args:
        fields: what was decoded.
        logits: of occupancy, of all cells.
        rows: an outline, the channels after occupancy, one row per part.
        cfg: what is mended.
    """
    cfg = cfg or MendConfig()
    if rows is None:
        return remove_strays(fields, cfg.clean)
    stages: list[Stage] = [
        partial(fill_fronts, rows=rows),
        partial(round_portholes, rows=rows),
        partial(even_faces, logits=logits, rows=rows),
        partial(clear_paths, logits=logits, rows=rows),
        partial(clear_doorways, rows=rows),
        partial(_clear_strays, cfg=cfg.clean),
        partial(claim_cells, rows=rows),
        partial(shape_knobs, rows=rows),
        partial(extend_shafts, rows=rows),
        partial(extend_legs, rows=rows),
        partial(extend_feet, rows=rows),
        partial(revolve_parts, rows=rows),
        partial(back_knobs, rows=rows),
    ]
    if cfg.boards is not None:
        stages.insert(0, partial(make_boards, logits=logits, rows=rows, cfg=cfg.boards))
    owners, notes = read_owners(fields, rows), []
    for stage in stages:
        owners, said = stage(owners)
        notes += said
    return fields_of_owners(owners, rows, fields), tuple(notes)


def _clear_strays(owners: Owners, cfg: CleanConfig) -> tuple[Owners, tuple[str, ...]]:
    strays, said = find_strays(owners >= 0, cfg)
    return np.where(strays, -1, owners), said
