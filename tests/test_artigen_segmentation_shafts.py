"""Handles and knobs that float near a carrier reach it; what touches, and what is far, stays."""

import numpy as np
import pytest

from artigen.fields import VoxelFields, decode, encode, tabulate_parts
from artigen.segment import SegmentationError, segment
from artigen.segmentation.rows import fields_of_owners, read_owners
from artigen.segmentation.shafts import LONGEST, extend_shafts
from artigen.types import Asset


@pytest.fixture(scope="module")
def rows(cabinet: Asset) -> np.ndarray:
    return tabulate_parts(cabinet)


@pytest.fixture(scope="module")
def fields(cabinet: Asset) -> VoxelFields:
    return decode(encode(cabinet))


def float_knob(cabinet: Asset, fields: VoxelFields, rows: np.ndarray, by: int) -> VoxelFields:
    """The same cells with the knob, a layer thick, in front of its panel by so many free cells."""
    owners = read_owners(fields, rows)
    knob = next(number for number, part in enumerate(cabinet.parts) if part.label == "knob")
    cells = np.argwhere(owners == knob)
    owners[tuple(cells.T)] = -1
    cells = cells[cells[:, 0] == cells[:, 0].max()]
    behind = {(y, z) for _, y, z in cells}
    cells[:, 0] = min(x for x, y, z in np.argwhere(owners >= 0) if (y, z) in behind) - 1 - by
    owners[tuple(cells.T)] = knob
    return fields_of_owners(owners, rows, fields)


def test_what_touches_stays(fields: VoxelFields, rows: np.ndarray):
    assert extend_shafts(fields, rows) == (fields, ())


def test_a_knob_in_front_of_its_panel_reaches_it(cabinet: Asset, fields: VoxelFields, rows: np.ndarray):
    floating = float_knob(cabinet, fields, rows, 4)
    with pytest.raises(SegmentationError, match="may carry knob"):
        segment(floating, name="floating", scale=cabinet.scale)
    reaching, notes = extend_shafts(floating, rows)
    assert notes == ("1 handles or knobs reach what carries them by shafts, of 4 cells at most",)
    added = len(reaching.coords) - len(floating.coords)
    assert added > 0
    assert added % 4 == 0  # whole rows of cells
    found = segment(reaching, name="reaching", scale=cabinet.scale)
    assert sorted(part.label for part in found.parts) == sorted(part.label for part in cabinet.parts)
    assert extend_shafts(reaching, rows) == (reaching, ())


def test_a_knob_far_from_everything_stays(cabinet: Asset, fields: VoxelFields, rows: np.ndarray):
    floating = float_knob(cabinet, fields, rows, LONGEST + 1)
    assert extend_shafts(floating, rows) == (floating, ())
