"""Faults of outlines: no procedural object has one, what cannot be is found, and another is drawn for it."""

from collections.abc import Sequence

import numpy as np
import pytest
import torch
from cupboard import BASE, EDGE, row

import artigen.models.outline.draw
from artigen.fields import DEFAULT_LAYOUT, after_occupancy, name_rows, tabulate_parts
from artigen.models.outline.batch import OutlineBatch
from artigen.models.outline.boxes import CELL
from artigen.models.outline.draw import OutlineConfig, draw_outline
from artigen.models.outline.faults import find_faults
from artigen.models.outline.regularise import regularise_outline
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import PAPER_CATEGORIES, Asset

BOX, ORIGIN = after_occupancy(DEFAULT_LAYOUT.box), after_occupancy(DEFAULT_LAYOUT.origin)
BOTH = {"door_0", "drawer_0"}


@pytest.fixture(scope="module")
def rows(cabinet: Asset) -> np.ndarray:
    return regularise_outline(tabulate_parts(cabinet))[0]


def row_of(rows: np.ndarray, label: str) -> int:
    return name_rows(rows).index(label)


@pytest.mark.parametrize("category", PAPER_CATEGORIES)
def test_procedural_objects_have_none(category: str):
    for seed in range(3):
        truth = tabulate_parts(shape_to_asset(draw_shape(category, seed), 32))
        assert find_faults(truth) == ()
        assert find_faults(regularise_outline(truth)[0]) == ()


def test_a_front_that_covers_part_of_another_is_found(rows: np.ndarray):
    wrong, door = rows.copy(), row_of(rows, "door")
    wrong[door, BOX][2] += 4 * CELL  # the drawer is above the door
    (fault,) = (fault for fault in find_faults(wrong) if set(fault.what.split()) >= BOTH)
    assert 3.0 < fault.cells <= 4.0  # there was a slit between them
    wrong[door, BOX][0] += 6 * CELL  # well behind the drawer it may be
    assert not any(set(fault.what.split()) >= BOTH for fault in find_faults(wrong))


def test_what_hangs_in_the_air_is_found(rows: np.ndarray):
    wrong, handle = rows.copy(), row_of(rows, "handle")
    wrong[handle, BOX][0] -= 6 * CELL
    (fault,) = find_faults(wrong)
    assert "could carry it" in fault.what
    assert fault.cells == pytest.approx(6.0, abs=0.5)


def test_a_hinge_in_the_middle_of_its_door_is_found(rows: np.ndarray):
    wrong, door = rows.copy(), row_of(rows, "door")
    wrong[door, ORIGIN] = wrong[door, BOX][:3]
    (fault,) = find_faults(wrong)
    assert fault.what.startswith("the hinge of door_0")
    assert fault.cells * CELL == pytest.approx(wrong[door, BOX][4] / 2, rel=1e-5)


@pytest.mark.parametrize(("first", "found"), [(12, 1), (16, 0), (4, 0)])
def test_what_slides_out_behind_two_doors_one_above_the_other_is_found(first: int, found: int):
    def leaf(low: int, high: int) -> np.ndarray:
        place = (slice(2, 4), slice(4, 28), slice(low, high))
        return row("door", place, "revolute", axis=(0, 0, 1), turn=0.25)

    place = (slice(8, 20), slice(6, 26), slice(first, first + 8))
    drawer = row("drawer", place, "prismatic", axis=(-1, 0, 0), travel=9)
    rows = np.stack([BASE, leaf(4, 16), leaf(16, 28), drawer]).astype(float)
    said = [fault for fault in find_faults(rows) if "behind a second door" in fault.what]
    assert len(said) == found
    assert all(fault.cells == pytest.approx(4 * 64 / EDGE) for fault in said)


def draw(outlines: Sequence[np.ndarray], monkeypatch: pytest.MonkeyPatch, draws: int):
    """What is made of a network that draws these outlines in turn, and how many it was asked for."""
    left = iter(outlines)
    asked = []

    def sample(*_: object) -> OutlineBatch:
        asked.append(None)
        table = torch.from_numpy(next(left))[None].float()
        return OutlineBatch(rows=table, given=torch.ones(table.shape[:2], dtype=torch.bool))

    monkeypatch.setattr(artigen.models.outline.draw, "sample_outlines", sample)
    nothing = torch.Generator()
    drawn = draw_outline(None, None, None, nothing, OutlineConfig(draws=draws))  # type: ignore[arg-type]
    return drawn.rows, drawn.notes, len(asked)


def test_another_is_drawn_until_one_has_no_fault(rows: np.ndarray, monkeypatch: pytest.MonkeyPatch):
    bad = rows.copy()
    bad[row_of(rows, "handle"), BOX][0] -= 6 * CELL
    kept, notes, asked = draw([bad, bad, rows, rows], monkeypatch, draws=8)
    assert asked == 3
    assert np.allclose(kept, rows, atol=1e-6)
    assert any("3 were drawn, of the first handle_0 is" in note for note in notes)
    kept, notes, asked = draw([rows], monkeypatch, draws=8)
    assert asked == 1
    assert not any("drawn" in note for note in notes)


def test_where_all_have_faults_the_least_is_kept_and_said(rows: np.ndarray, monkeypatch: pytest.MonkeyPatch):
    bad, worse = rows.copy(), rows.copy()
    handle = row_of(rows, "handle")
    bad[handle, BOX][0] -= 5 * CELL
    worse[handle, BOX][0] -= 9 * CELL
    kept, notes, asked = draw([worse, bad, worse], monkeypatch, draws=3)
    assert asked == 3
    assert kept[handle, BOX][0] == pytest.approx(regularise_outline(bad)[0][handle, BOX][0])
    assert any("1 faults are left" in note for note in notes)
