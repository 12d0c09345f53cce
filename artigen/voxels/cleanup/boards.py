"""Covers sampled cells with boxes, so that panels become flat, complete and straight at the rim.

A network draws the panels of furniture with dents, pinholes and ragged rims. Every part is told anew as the
boxes that its cells speak for most (`artigen.voxels.cleanup.boxes`): what is missing in one is filled, what
sticks out of all of them goes, and recesses and openings, which are boxes too, are cut again.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import label as number_pieces

from artigen.types import PartLabel
from artigen.voxels.cleanup.boxes import fill_boxes, find_boxes, reach_box
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import DEFAULT_LAYOUT, FieldLayout, after_occupancy, name_joints, name_rows

SLACK = 0.25
"""Cells that a board may reach out of the box of its part."""


@dataclass(frozen=True, kw_only=True)
class BoardsConfig:
    """Thresholds for boards. Evidence is counted in certain cells."""

    certain: float = 4.0
    """Logits beyond this count as certain."""
    least_board: int = 20
    """Certain cells in a board that no other holds."""
    least_cut: int = 100
    """Certain empty cells in a recess or opening: smaller ones are dents."""
    empty: float = 0.85
    """Share of a cut whose cells say empty."""
    least_rest: int = 100
    """Cells in a piece beside all boards that stays: what is round or slanted."""
    contested: float = 0.25
    """What a cell of another part speaks against a board through it, in certain cells."""
    rounds: int = 2
    """How often boards and cuts take turns."""
    exempt: tuple[PartLabel, ...] = ("handle", "knob", "wheel")
    """Parts that stay as they were drawn, within their boxes: small, or round. So do parts that turn without
    end."""


def make_boards(
    owners: Owners,
    logits: Float[np.ndarray, "X Y Z"],
    rows: Float[np.ndarray, "N C"],
    cfg: BoardsConfig | None = None,
    layout: FieldLayout = DEFAULT_LAYOUT,
) -> tuple[Owners, tuple[str, ...]]:
    """Owners by which parts are made of boards, and a note of how much that changed.

    Args:
        owners: a row per cell, -1 where nothing is.
        logits: of occupancy, of all cells.
        rows: an outline, the channels after occupancy, one row per part.
        cfg: what counts as a board.
        layout: channels.
    """
    cfg, before = cfg or BoardsConfig(), owners
    after = np.full_like(before, -1)
    evidence = (logits / cfg.certain).clip(-1.0, 1.0)
    boxes = rows[:, after_occupancy(layout.box)]
    sizes = boxes[:, 3:].prod(axis=1)
    exempt = [
        number
        for number, (label, joint) in enumerate(
            zip(name_rows(rows, layout), name_joints(rows, layout), strict=True)
        )
        if label in cfg.exempt or joint == "continuous"
    ]
    for number in np.argsort(-sizes):  # the smaller of two parts is drawn over the larger
        if number in exempt or not (before == number).any():
            continue
        box = reach_box(boxes[number], len(owners), SLACK)
        owned = before[box]
        within = (owned >= 0) & (sizes[owned] < sizes[number])
        after[box][_make_part(owned, number, evidence[box], cfg) & ~within] = number
    for number in exempt:
        box = reach_box(boxes[number], len(owners))
        after[box][before[box] == number] = number
    if (after == before).all():
        return owners, ()
    filled, cleared = ((before < 0) & (after >= 0)).sum(), ((before >= 0) & (after < 0)).sum()
    note = f"boards: {filled} cells were filled and {cleared} cleared, of {(before >= 0).sum()}"
    return after, (note,)


def _make_part(
    owned: Int[np.ndarray, "X Y Z"],
    number: np.intp,
    evidence: Float[np.ndarray, "X Y Z"],
    cfg: BoardsConfig,
) -> Bool[np.ndarray, "X Y Z"]:
    """The cells of a part made of boards, and of its larger pieces beside them."""
    mine = owned == number
    evidence = np.where((owned >= 0) & ~mine, -cfg.contested, evidence)
    solid = fill_boxes(mine.shape, find_boxes(evidence, cfg.least_board))
    for _ in range(cfg.rounds):
        unsaid = np.where(evidence < 0, 0.0, -1.0)
        hollow = find_boxes(np.where(solid, -evidence, unsaid), cfg.least_cut)
        cuts = [box for box in hollow if (evidence[box][solid[box]] < 0).mean() >= cfg.empty]
        if not cuts:
            break
        solid &= ~fill_boxes(mine.shape, cuts)
        solid |= fill_boxes(mine.shape, find_boxes(np.where(solid, 0.0, evidence), cfg.least_board))
    pieces = np.zeros(mine.shape, dtype=np.int64)
    number_pieces(mine & ~solid, structure=np.ones((3, 3, 3)), output=pieces)
    stays = np.bincount(pieces.ravel()) >= cfg.least_rest
    stays[0] = False
    return solid | stays[pieces]
