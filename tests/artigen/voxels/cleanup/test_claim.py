"""Handles and knobs without a cell claim those of their boxes; what has cells, and all else, stays."""

import numpy as np

from artigen.types import Asset
from artigen.voxels.cleanup.claim import claim_cells
from artigen.voxels.cleanup.rows import Owners
from artigen.voxels.fields import name_rows


def lose(owners: Owners, rows: np.ndarray, label: str) -> Owners:
    return np.where(np.isin(owners, np.flatnonzero(np.array(name_rows(rows)) == label)), -1, owners)


def test_nothing_happens_where_every_part_has_a_cell(cabinet_owners: Owners, cabinet_rows: np.ndarray):
    made, notes = claim_cells(cabinet_owners, cabinet_rows)
    assert (made == cabinet_owners).all()
    assert notes == ()


def test_a_lost_knob_comes_back_where_it_was(
    cabinet: Asset, cabinet_owners: Owners, cabinet_rows: np.ndarray
):
    knob = name_rows(cabinet_rows).index("knob")
    again, notes = claim_cells(lose(cabinet_owners, cabinet_rows, "knob"), cabinet_rows)
    assert notes == ("1 small parts without cells were given those of their boxes",)
    place = (np.argwhere(again == knob) + 0.5) / len(again) - 0.5
    center, size = cabinet.parts[knob].box
    assert len(place)
    assert (np.abs(place - center) <= size / 2 + 1.0 / len(again)).all()
    assert ((again != cabinet_owners) <= ((again == knob) | (cabinet_owners == knob))).all()


def test_a_lost_drawer_is_not_made_up(cabinet_owners: Owners, cabinet_rows: np.ndarray):
    lost = lose(cabinet_owners, cabinet_rows, "drawer")
    made, notes = claim_cells(lost, cabinet_rows)
    assert (made == lost).all()
    assert notes == ()
