"""Separates drawers and trays from the carrier that they overlap.

Where surfaces of two parts run through the same layer of cells, both parts may complete it
(`sim_export.geometry.occupancy`), and clearance trims the overlap later. A flat drawer whose front
stands in an apron, or a tray that lies in a floor, would share much of itself with its carrier, and
no cut frees that; so the carrier gives those cells up and has an opening there.
"""

from collections.abc import Sequence
from dataclasses import replace

from artigen.types import Asset
from sim_export.geometry.joining import join_cells
from sim_export.geometry.occupancy import PartOccupancy

SUNK = 0.15
"""Share of a drawer's or tray's cells from which they count as sunk into another link's part."""
SLIDING_LABELS = ("drawer", "tray")


def separate_solids(
    asset: Asset, solids: Sequence[PartOccupancy], owners: Sequence[int]
) -> tuple[tuple[PartOccupancy, ...], tuple[str, ...]]:
    """Solids without the cells that sunk drawers and trays have in them; one sentence per change.

    Args:
        asset: The parts.
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
            left = join_cells(out[other].occupancy & ~body, body)
            taken = int(out[other].occupancy.sum() - left.sum())
            out[other] = replace(out[other], occupancy=left)
            records.append(f"{carrier.name}: {taken} cells given up to {part.name}, which is sunk into it")
    return tuple(out), tuple(records)
