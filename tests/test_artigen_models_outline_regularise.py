"""Regularising of outlines: what is meant stays, what nearly is becomes it, what is not is left alone."""

import numpy as np
import pytest

from artigen.fields import DEFAULT_LAYOUT, part_attributes
from artigen.models.outline.boxes import CELL
from artigen.models.outline.regularise import regularise_outline
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import PAPER_CATEGORIES, Asset

AXIS, ORIGIN, BOX = (
    slice(channels.start - 1, channels.stop - 1)
    for channels in (DEFAULT_LAYOUT.axis, DEFAULT_LAYOUT.origin, DEFAULT_LAYOUT.box)
)


def table_of(asset: Asset) -> np.ndarray:
    rows = np.stack([part_attributes(part, asset.category) for part in asset.parts])
    return rows[:, DEFAULT_LAYOUT.occupancy.stop :].astype(np.float32)


@pytest.fixture(scope="module")
def rows(cabinet: Asset) -> np.ndarray:
    return table_of(cabinet)


def row_of(asset: Asset, label: str) -> int:
    return next(number for number, part in enumerate(asset.parts) if part.label == label)


@pytest.mark.parametrize("category", PAPER_CATEGORIES)
def test_what_procedural_objects_mean_stays_to_two_thirds_of_a_cell(category: str):
    for seed in (1, 2):
        truth = table_of(shape_to_asset(draw_shape(category, seed), 32))
        kept, _ = regularise_outline(truth)
        assert np.abs(kept - truth).max() < 0.67 * CELL


def test_an_axis_that_is_nearly_upright_becomes_upright_and_a_slanted_one_stays(
    cabinet: Asset, rows: np.ndarray
):
    door = row_of(cabinet, "door")
    for degrees, straightened in ((8.0, True), (40.0, False)):
        turned = rows.copy()
        turned[door, AXIS] = [np.sin(np.radians(degrees)), 0.0, np.cos(np.radians(degrees))]
        fixed, notes = regularise_outline(turned)
        assert (np.abs(fixed[door, AXIS]).max() == pytest.approx(1.0, abs=1e-6)) == straightened
        assert any(f"by {degrees:.1f} degrees" in note for note in notes) == straightened
        assert np.linalg.norm(fixed[door, AXIS]) == pytest.approx(1.0, abs=1e-6)


def test_a_hinge_comes_to_the_edge_of_its_door_only_from_near(cabinet: Asset, rows: np.ndarray):
    door = row_of(cabinet, "door")
    truth = regularise_outline(rows)[0][door, ORIGIN]
    for off, found in ((3.0 * CELL, True), (6.0 * CELL, False)):
        moved = rows.copy()
        moved[door, ORIGIN] += [0.0, off, 0.0]
        fixed = regularise_outline(moved)[0][door, ORIGIN]
        assert np.allclose(fixed, truth, atol=1e-6) == found


def test_fronts_that_overlap_a_little_meet_and_their_outer_edges_stay(cabinet: Asset, rows: np.ndarray):
    door, drawer = row_of(cabinet, "door"), row_of(cabinet, "drawer")
    base, _ = regularise_outline(rows)
    grown, edge = rows.copy(), BOX.start + 2  # the drawer is above the door
    top_of_door = rows[door, edge] + rows[door, edge + 3] / 2
    top_of_drawer = rows[drawer, edge] + rows[drawer, edge + 3] / 2
    grown[drawer, edge] = (top_of_drawer + top_of_door - 2 * CELL) / 2
    grown[drawer, edge + 3] = top_of_drawer - top_of_door + 2 * CELL
    fixed, notes = regularise_outline(grown)
    top_of_door = fixed[door, BOX][2] + fixed[door, BOX][5] / 2
    bottom_of_drawer = fixed[drawer, BOX][2] - fixed[drawer, BOX][5] / 2
    assert any("1 pairs of fronts parted" in note for note in notes)
    assert top_of_door <= bottom_of_drawer + 1e-6
    assert fixed[door, BOX][2] - fixed[door, BOX][5] / 2 == pytest.approx(
        base[door, BOX][2] - base[door, BOX][5] / 2, abs=1e-6
    )


@pytest.mark.parametrize(("axis", "off"), [(0, -2.0), (0, 2.0), (2, 30.0)])
def test_a_handle_sits_on_its_front_and_within_it(cabinet: Asset, rows: np.ndarray, axis: int, off: float):
    truth, _ = regularise_outline(rows)
    handle = next(n for n, part in enumerate(cabinet.parts) if part.label == "handle")
    front = cabinet.parts[handle].parent
    moved = truth.copy()
    moved[handle, BOX][axis] += (
        off * CELL if axis == 0 else moved[front, BOX][5] / 2 - moved[handle, BOX][5] / 4
    )
    fixed, notes = regularise_outline(moved)
    assert any("put to their panels" in note for note in notes)
    (low, high), (front_low, front_high) = (
        (row[BOX][:3] - row[BOX][3:] / 2, row[BOX][:3] + row[BOX][3:] / 2)
        for row in (fixed[handle], fixed[front])
    )
    assert high[0] == pytest.approx(front_low[0], abs=1e-5)
    assert (low[1:] >= front_low[1:] - 1e-5).all()
    assert (high[1:] <= front_high[1:] + 1e-5).all()


def test_the_object_gets_the_extents_that_are_asked_for(rows: np.ndarray):
    asked = np.array([0.5, 1.2, 2.0])
    fitted, notes = regularise_outline(rows, extents=asked)
    low, high = (
        fitted[:, BOX][:, :3] - fitted[:, BOX][:, 3:] / 2,
        fitted[:, BOX][:, :3] + fitted[:, BOX][:, 3:] / 2,
    )
    assert high.max(axis=0) - low.min(axis=0) == pytest.approx(asked / 2.0, abs=1e-5)
    assert high.max(axis=0) + low.min(axis=0) == pytest.approx(np.zeros(3), abs=1e-5)
    assert any("to the size asked for" in note for note in notes)
    again, notes = regularise_outline(fitted, extents=asked)
    assert again == pytest.approx(fitted, abs=1e-5)


def test_the_input_is_not_touched(rows: np.ndarray):
    moved = rows + np.float32(0.01)
    before = moved.copy()
    regularise_outline(moved)
    assert np.array_equal(moved, before)
