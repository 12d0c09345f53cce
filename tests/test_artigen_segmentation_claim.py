"""Handles and knobs without a cell claim those of their boxes; what has cells, and all else, stays."""

import numpy as np
import pytest

from artigen.fields import DEFAULT_LAYOUT, VoxelFields, decode, encode, part_attributes
from artigen.segment import segment
from artigen.segmentation.claim import claim_cells
from artigen.segmentation.clean import select_cells
from artigen.types import Asset


@pytest.fixture(scope="module")
def rows(cabinet: Asset) -> np.ndarray:
    table = np.stack([part_attributes(part, cabinet.category) for part in cabinet.parts])
    return table[:, DEFAULT_LAYOUT.occupancy.stop :].astype(np.float32)


@pytest.fixture(scope="module")
def fields(cabinet: Asset) -> VoxelFields:
    return decode(encode(cabinet))


def of_label(fields: VoxelFields, label: str) -> np.ndarray:
    return fields.label_probs.argmax(axis=1) == DEFAULT_LAYOUT.labels.index(label)


def test_nothing_happens_where_every_part_has_a_cell(fields: VoxelFields, rows: np.ndarray):
    assert claim_cells(fields, rows) == (fields, ())


def test_nothing_is_claimed_in_an_empty_field(fields: VoxelFields, rows: np.ndarray):
    empty = select_cells(fields, np.zeros(len(fields.coords), dtype=bool))
    assert claim_cells(empty, rows) == (empty, ())


def test_a_lost_knob_comes_back_where_it_was_and_is_found_again(
    cabinet: Asset, fields: VoxelFields, rows: np.ndarray
):
    lost = select_cells(fields, ~of_label(fields, "knob"))
    again, notes = claim_cells(lost, rows)
    assert notes == ("1 handles or knobs without cells were given those of their boxes",)
    place = again.centers()[of_label(again, "knob")]
    box = next(part.box for part in cabinet.parts if part.label == "knob")
    assert len(place)
    assert (np.abs(place - box[0]) <= box[1] / 2 + 1.0 / fields.resolution).all()
    assert len(again.coords) == len(np.unique(again.coords, axis=0))
    found = segment(again, name="again", scale=cabinet.scale)
    assert sorted(part.label for part in found.parts) == sorted(part.label for part in cabinet.parts)


def test_a_lost_drawer_is_not_made_up(fields: VoxelFields, rows: np.ndarray):
    lost = select_cells(fields, ~of_label(fields, "drawer"))
    assert claim_cells(lost, rows) == (lost, ())
