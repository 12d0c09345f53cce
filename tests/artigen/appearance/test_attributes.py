"""Attributes: what the flow is told of every voxel, and where it stands."""

import numpy as np
from drawer_chest import make_chest

from artigen.appearance.attributes import KIND, describe_kinds, describe_voxels
from artigen.appearance.paint import PAINT
from artigen.shapes.asset import shape_to_asset
from artigen.types import PART_LABELS
from artigen.voxels.fields import tabulate_parts
from artigen.voxels.frames import AROUND, FACINGS, SIDES
from artigen.voxels.surface import PLACES


def test_voxels_are_told_their_facing_the_label_of_their_part_their_places_and_their_paint():
    asset = shape_to_asset(make_chest(), 16)
    facings = np.arange(len(asset.voxels.coords)) % FACINGS
    paint, places = (np.random.default_rng(0).random((len(facings), width)) for width in (PAINT, PLACES))
    covered = np.stack([facings > 2, facings > 4], axis=1)
    joined = np.stack([covered, facings[:, None] < [1, 3]], axis=1)
    kinds = describe_kinds(tabulate_parts(asset), asset.voxels.part_ids, facings, covered, joined)
    told = describe_voxels(kinds, places, paint)
    assert told.shape == (len(asset.voxels.coords), KIND + PLACES + PAINT)
    first = FACINGS + len(PART_LABELS)
    np.testing.assert_array_equal(told[:, first : first + SIDES], covered)
    np.testing.assert_array_equal(told[:, first + SIDES : KIND], joined.reshape(-1, AROUND))
    np.testing.assert_allclose(told[:, KIND:-PAINT], places, atol=1e-6)
    np.testing.assert_array_equal(told[:, :FACINGS].argmax(axis=1), facings)
    np.testing.assert_array_equal(told[:, :FACINGS].sum(axis=1), 1.0)
    np.testing.assert_allclose(told[:, -PAINT:], paint, atol=1e-6)
    for row, part in zip(told, asset.voxels.part_ids, strict=True):
        assert PART_LABELS[row[FACINGS:first].argmax()] == asset.parts[part].label
