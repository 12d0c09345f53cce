"""Covers sampled cells with boxes, so that panels become flat, complete and straight at the rim.

A network draws the panels of furniture with dents, pinholes and ragged rims. Every part is rebuilt from the
boxes that its cells support most (`artigen.voxels.cleanup.boxes`): gaps in a box are filled, small pieces
outside all boxes are removed, and recesses and openings, which are boxes too, are cut out again.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import label as number_pieces

from artigen.types import PartLabel
from artigen.voxels.cleanup.boxes import fill_boxes, find_boxes, reach_box
from artigen.voxels.cleanup.rows import CERTAIN, Owners
from artigen.voxels.fields import ROW, name_joints, name_rows

SLACK = 0.25
"""Cells by which a board may exceed the box of its part."""

LEAST_BOARD = 20
"""Least evidence for a board, in cells that no other board holds."""
LEAST_CUT = 100
"""Least evidence that a recess or opening is empty; smaller ones are dents."""
EMPTY = 0.85
"""Least share of the cells that a cut removes which are empty by their logits."""
LEAST_REST = 100
"""Least cells of a piece outside all boards that is kept: round or slanted geometry."""
CONTESTED = 0.25
"""Evidence of each cell of another part against a board through it."""
ROUNDS = 2
"""Most rounds of cutting recesses and adding boards in them."""
EXEMPT: tuple[PartLabel, ...] = ("handle", "knob", "wheel")
"""Labels of small or round parts, which keep their cells within their boxes. Continuously rotating parts
are exempt as well."""


def make_boards(
    owners: Owners, logits: Float[np.ndarray, "X Y Z"], rows: Float[np.ndarray, "N C"]
) -> tuple[Owners, tuple[str, ...]]:
    """Rebuilds parts from boards; returns the new owners and a note of how much changed."""
    before = owners
    after = np.full_like(before, -1)
    evidence = (logits / CERTAIN).clip(-1.0, 1.0)
    boxes = rows[:, ROW.box]
    sizes = boxes[:, 3:].prod(axis=1)
    exempt = [
        number
        for number, (label, joint) in enumerate(zip(name_rows(rows), name_joints(rows), strict=True))
        if label in EXEMPT or joint == "continuous"
    ]
    for number in np.argsort(-sizes):  # smaller parts overwrite larger ones
        if number in exempt or not (before == number).any():
            continue
        box = reach_box(boxes[number], len(owners), SLACK)
        owned = before[box]
        within = (owned >= 0) & (sizes[owned] < sizes[number])
        after[box][_make_part(owned, number, evidence[box]) & ~within] = number
    for number in exempt:
        box = reach_box(boxes[number], len(owners))
        after[box][before[box] == number] = number
    if (after == before).all():
        return owners, ()
    filled, cleared = ((before < 0) & (after >= 0)).sum(), ((before >= 0) & (after < 0)).sum()
    note = f"boards: {filled} cells were filled and {cleared} cleared, of {(before >= 0).sum()}"
    return after, (note,)


def _make_part(
    owned: Int[np.ndarray, "X Y Z"], number: np.intp, evidence: Float[np.ndarray, "X Y Z"]
) -> Bool[np.ndarray, "X Y Z"]:
    """The cells of a part's boards, and of its larger pieces outside them."""
    mine = owned == number
    evidence = np.where((owned >= 0) & ~mine, -CONTESTED, evidence)
    solid = fill_boxes(mine.shape, find_boxes(evidence, LEAST_BOARD))
    for _ in range(ROUNDS):
        outside = np.where(evidence < 0, 0.0, -1.0)
        hollow = find_boxes(np.where(solid, -evidence, outside), LEAST_CUT)
        cuts = [box for box in hollow if (evidence[box][solid[box]] < 0).mean() >= EMPTY]
        if not cuts:
            break
        solid &= ~fill_boxes(mine.shape, cuts)
        solid |= fill_boxes(mine.shape, find_boxes(np.where(solid, 0.0, evidence), LEAST_BOARD))
    pieces = np.zeros(mine.shape, dtype=np.int64)
    number_pieces(mine & ~solid, structure=np.ones((3, 3, 3)), output=pieces)
    stays = np.bincount(pieces.ravel()) >= LEAST_REST
    stays[0] = False
    return solid | stays[pieces]
