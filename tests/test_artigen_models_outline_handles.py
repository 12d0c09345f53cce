"""Handles of outlines: what slipped to the door next door goes back; true handles stay where they are."""

import numpy as np
import pytest

from artigen.fields import tabulate_parts
from artigen.models.outline.boxes import CELL, box_views
from artigen.models.outline.handles import hand_out_handles
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import Asset


@pytest.fixture(scope="module")
def fridge() -> Asset:
    """Two doors side by side, with a handle each at the seam."""
    for seed in range(100):
        asset = shape_to_asset(draw_shape("Refrigerator", seed), 16)
        if len(find_pair(asset)) == 2:
            return asset
    raise AssertionError("no fridge has a pair of doors")


def find_pair(asset: Asset) -> dict[int, int]:
    """Handles of the doors of a pair, and their doors."""
    center, size = box_views(tabulate_parts(asset))
    doors = {n: part.parent for n, part in enumerate(asset.parts) if part.label == "handle"}
    pairs = [
        {one: doors[one], other: doors[other]}
        for one in doors
        for other in doors
        if center[one, 1] < center[other, 1]
        and center[other, 1] - center[one, 1] < 8 * CELL
        and {asset.parts[doors[n]].label for n in (one, other)} == {"door"}
        and abs(center[doors[one], 2] - center[doors[other], 2]) < CELL
        and min(size[one, 2], size[other, 2]) > 8 * CELL
    ]
    return pairs[0] if pairs else {}


def test_a_handle_that_slipped_over_the_seam_goes_back(fridge: Asset):
    rows = tabulate_parts(fridge)
    center, size = box_views(rows)
    (_, left), (handle, right) = find_pair(fridge).items()
    truth = center[handle].copy()
    center[handle, 1] = center[left, 1] + size[left, 1] / 2 - CELL
    assert "1 second handles" in hand_out_handles(rows)
    edge = center[right, 1] - size[right, 1] / 2
    assert center[handle, 1] - size[handle, 1] / 2 == pytest.approx(edge, abs=1e-6)
    np.testing.assert_allclose(center[handle, [0, 2]], truth[[0, 2]], atol=0.1 * CELL)
    assert hand_out_handles(rows) == ""


def test_a_second_handle_stays_where_no_bare_front_is_near(fridge: Asset):
    rows = tabulate_parts(fridge)
    center, size = box_views(rows)
    (own, left), (handle, _) = find_pair(fridge).items()
    center[[own, handle], 1] = center[left, 1] - size[left, 1] / 2 + CELL
    slipped = rows.copy()
    assert hand_out_handles(rows) == ""
    np.testing.assert_array_equal(rows, slipped)


@pytest.mark.parametrize("category", ["Refrigerator", "StorageFurniture", "Dishwasher", "Oven", "Table"])
def test_true_handles_stay(category: str):
    for seed in range(12):
        rows = tabulate_parts(shape_to_asset(draw_shape(category, seed), 16))
        truth = rows.copy()
        assert hand_out_handles(rows) == ""
        np.testing.assert_array_equal(rows, truth)
