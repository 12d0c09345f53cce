"""A cell belongs to one of two links where a drawer is sunk into its carrier, and nothing else changes."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.types import FIXED, Asset, Joint, Part
from sim_export.geometry.joining import join_cells
from sim_export.geometry.occupancy import PartOccupancy
from sim_export.geometry.separation import separate_solids

UNIT = np.array([np.zeros(3), np.ones(3)])
SLIDE = Joint(type="prismatic", axis=np.array([-1.0, 0.0, 0.0]), origin=np.zeros(3), upper=0.3)


def solid(low, high) -> PartOccupancy:
    grid = np.zeros((24, 24, 24), dtype=bool)
    grid[tuple(slice(a, b) for a, b in zip(low, high, strict=True))] = True
    return PartOccupancy(occupancy=grid, shared=0, enclosed=0, joined=0)


def table(label="drawer", joint: Joint = SLIDE) -> Asset:
    parts = (
        Part(name="body", label="base", parent=-1, joint=FIXED, box=UNIT),
        Part(name="box", label=label, parent=0, joint=joint, box=UNIT),
    )
    return Asset(name="table", category="Table", scale=1.0, parts=parts)


APRON = solid((4, 2, 8), (6, 22, 14))


@pytest.mark.parametrize("depth", [3, 6, 13])
def test_a_sunk_drawer_has_its_cells_to_itself(depth):
    """Two layers in the apron, of up to thirteen; of fourteen it is hardly sunk."""
    drawer = solid((4, 6, 9), (4 + depth, 12, 13))
    (body, box), records = separate_solids(table(), (APRON, drawer), (0, 1))
    assert not (body.occupancy & box.occupancy).any()
    assert box is drawer
    np.testing.assert_array_equal(body.occupancy | (APRON.occupancy & drawer.occupancy), APRON.occupancy)
    np.testing.assert_array_equal(join_cells(body.occupancy, box.occupancy), body.occupancy)
    assert len(records) == 1


def test_what_is_hardly_sunk_moves_otherwise_or_is_of_one_link_stays():
    hardly, drawer = solid((4, 6, 9), (18, 12, 13)), solid((4, 6, 9), (7, 12, 13))
    turning = replace(SLIDE, type="revolute")
    for asset, mover, owners in (
        (table(), hardly, (0, 1)),
        (table("door", turning), drawer, (0, 1)),
        (table("drawer", FIXED), drawer, (0, 0)),
        (table(), drawer, (0, 0)),
    ):
        kept, records = separate_solids(asset, (APRON, mover), owners)
        assert kept == (APRON, mover)
        assert records == ()
