"""Separates drawers and trays from overlapping carriers, and latches from frames.

Where surfaces of two parts run through the same layer of cells, both parts may complete it
(`sim_export.geometry.occupancy`), and clearance trims the overlap later. A flat drawer with its front in an
apron, or a tray embedded in a floor, would share much of its volume with its carrier, which cutting cannot
fix. The carrier therefore yields those cells and gets an opening there, unless it would fall apart.

The tongue of a latch and its keep are smaller than cells. What cells make of them holds nothing, but jams:
engines predict contacts, and a corner 25 mm below a lever's axis moves 2.5 mm towards the frame in a step of
1/60 s, as much as clearance leaves free.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from artigen.types import Asset
from sim_export.geometry.grid import label_cells
from sim_export.geometry.joining import join_cells
from sim_export.geometry.lone_cells import LONE
from sim_export.geometry.occupancy import PartOccupancy

SUNK = 0.15
"""Share of a drawer's or tray's cells inside another link's part from which it counts as sunk."""
SLIDING_LABELS = ("drawer", "tray")
LATCH_LABEL, LATCH_JOINTS = "knob", ("revolute", "prismatic")
"""Buttons, levers and bolts on what moves itself."""
MIN_LATCH = 0.4
"""Least share of a latch's cells that is left."""


def separate_solids(
    asset: Asset, solids: Sequence[PartOccupancy], owners: Sequence[int]
) -> tuple[tuple[PartOccupancy, ...], tuple[str, ...]]:
    """Removes the cells of sunk drawers and trays from the solids around them; one sentence per change.

    Args:
        solids: The solid cells of every part.
        owners: The part that leads each part's link (`sim_export.physics.links.link_owners`).
    """
    out, records = list(solids), []
    for mover, part in enumerate(asset.parts):
        if part.label not in SLIDING_LABELS or part.joint.type == "fixed":
            continue
        body = solids[mover].occupancy
        for other, carrier in enumerate(asset.parts):
            if owners[other] == owners[mover] or carrier.label in SLIDING_LABELS:
                continue
            common = out[other].occupancy & body
            if common.sum() < SUNK * body.sum() or common.sum() == out[other].occupancy.sum():
                continue
            left = _without_crumbs(out[other].occupancy & ~body, common)
            if label_cells(left)[1] > label_cells(out[other].occupancy)[1]:
                continue  # legs under a board that is as low as the drawer
            left = join_cells(left, body)
            taken = int(out[other].occupancy.sum() - left.sum())
            out[other] = replace(out[other], occupancy=left)
            records.append(f"{carrier.name}: {taken} cells yielded to {part.name}, which is sunk into it")
    return tuple(out), tuple(records)


def _without_crumbs(left: Bool[np.ndarray, "X Y Z"], taken: Bool[np.ndarray, "X Y Z"]) -> np.ndarray:
    """What is left of a solid without pieces that held by the cells taken from it and lie in their box."""
    pieces, count = label_cells(left)
    beside = pieces[np.asarray(ndimage.binary_dilation(taken, np.ones((3, 3, 3))), dtype=bool)]
    crumbs = np.zeros(count + 1, dtype=bool)
    crumbs[beside] = True
    outside = pieces.copy()
    outside[ndimage.find_objects(taken.view(np.uint8))[0]] = 0
    crumbs[outside] = False
    crumbs[np.bincount(pieces.ravel(), minlength=count + 1)[1:].argmax() + 1] = False
    return left & ~crumbs[pieces]


def free_latches(
    asset: Asset, solids: Sequence[PartOccupancy], owners: Sequence[int]
) -> tuple[Asset, tuple[PartOccupancy, ...], tuple[str, ...]]:
    """Removes the cells of latches beside all but the leaves that carry them.

    Args:
        solids: The solid cells of every part.
        owners: As in `separate_solids`.

    Returns:
        The asset, in which the boxes of such latches end where their cells do, the solids, and one sentence
        per change.
    """
    parts, out, records = list(asset.parts), list(solids), []
    for index, part in enumerate(asset.parts):
        leaf = owners[part.parent]
        carried = asset.parts[leaf].joint.type != "fixed"
        if part.label != LATCH_LABEL or part.joint.type not in LATCH_JOINTS or not carried:
            continue
        others = [k for k, owner in enumerate(owners) if owner not in (index, leaf)]
        frame = np.any([solids[k].occupancy for k in others], axis=0)
        body = solids[index].occupancy
        near = body & np.asarray(ndimage.binary_dilation(frame, np.ones((3, 3, 3))), dtype=bool)
        pieces, count = label_cells(body & ~near)
        sizes = np.bincount(pieces.ravel(), minlength=count + 1)[1:]
        if not near.any() or sizes.max(initial=0) < MIN_LATCH * body.sum():
            continue
        if np.count_nonzero(sizes > LONE) > 1:
            continue  # a shaft with a lever at either end
        left = join_cells(np.pad(pieces == 1 + int(sizes.argmax()), 1), np.pad(frame, 1))[1:-1, 1:-1, 1:-1]
        out[index] = replace(out[index], occupancy=left)
        parts[index] = replace(part, box=_shorten_box(part.box, left))
        records.append(
            f"{part.name}: {int(body.sum() - left.sum())} cells beside what it latches to left out"
        )
    return replace(asset, parts=tuple(parts)), tuple(out), tuple(records)


def _shorten_box(box: Float[np.ndarray, "2 3"], cells: Bool[np.ndarray, "X Y Z"]) -> Float[np.ndarray, "2 3"]:
    """What a box (centre and size in the unit cube) has in common with that of cells."""
    at = np.argwhere(cells)
    low = np.maximum(box[0] - box[1] / 2, at.min(axis=0) / len(cells) - 0.5)
    high = np.minimum(box[0] + box[1] / 2, (at.max(axis=0) + 1) / len(cells) - 0.5)
    return np.stack([(low + high) / 2, high - low])
