"""Handles and knobs that float near a carrier reach it; what touches, and what is far, stays."""

import numpy as np
import pytest

from artigen.fields import VoxelFields
from artigen.mending.rows import Owners, fields_of_owners
from artigen.mending.shafts import LONGEST, extend_shafts
from artigen.segment import SegmentationError, segment
from artigen.types import Asset


def float_knob(cabinet: Asset, owners: Owners, by: int) -> Owners:
    """The same cells with the knob, a layer thick, in front of its panel by so many free cells."""
    owners = owners.copy()
    knob = next(number for number, part in enumerate(cabinet.parts) if part.label == "knob")
    cells = np.argwhere(owners == knob)
    owners[tuple(cells.T)] = -1
    cells = cells[cells[:, 0] == cells[:, 0].max()]
    behind = {(y, z) for _, y, z in cells}
    cells[:, 0] = min(x for x, y, z in np.argwhere(owners >= 0) if (y, z) in behind) - 1 - by
    owners[tuple(cells.T)] = knob
    return owners


def test_what_touches_stays(cabinet_owners: Owners, cabinet_rows: np.ndarray):
    made, notes = extend_shafts(cabinet_owners, cabinet_rows)
    assert (made == cabinet_owners).all()
    assert notes == ()


def test_a_knob_in_front_of_its_panel_reaches_it(
    cabinet: Asset, cabinet_fields: VoxelFields, cabinet_owners: Owners, cabinet_rows: np.ndarray
):
    floating = float_knob(cabinet, cabinet_owners, 4)
    with pytest.raises(SegmentationError, match="may carry knob"):
        segment(
            fields_of_owners(floating, cabinet_rows, cabinet_fields), name="floating", scale=cabinet.scale
        )
    reaching, notes = extend_shafts(floating, cabinet_rows)
    assert notes == ("1 handles or knobs reach what carries them by shafts, of 4 cells at most",)
    added = (reaching != floating).sum()
    assert added > 0
    assert added % 4 == 0  # whole rows of cells
    found = segment(
        fields_of_owners(reaching, cabinet_rows, cabinet_fields), name="reaching", scale=cabinet.scale
    )
    assert sorted(part.label for part in found.parts) == sorted(part.label for part in cabinet.parts)
    assert extend_shafts(reaching, cabinet_rows)[1] == ()


def test_a_knob_far_from_everything_stays(cabinet: Asset, cabinet_owners: Owners, cabinet_rows: np.ndarray):
    floating = float_knob(cabinet, cabinet_owners, LONGEST + 1)
    made, notes = extend_shafts(floating, cabinet_rows)
    assert (made == floating).all()
    assert notes == ()
