"""Depths of outlines: what lies inside starts behind its door, sliding doors pass, all else stays."""

import numpy as np
import pytest
from cupboard import BASE, EDGE, row

from artigen.fields import tabulate_parts
from artigen.models.outline.boxes import CELL, box_views
from artigen.models.outline.depths import order_depths
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import PAPER_CATEGORIES

DOOR = (slice(2, 4), slice(4, 28), slice(4, 28))
THICK = (slice(2, 6), slice(4, 28), slice(4, 28))


def inside(front: int) -> np.ndarray:
    return row(
        "drawer", (slice(front, 20), slice(6, 26), slice(6, 14)), "prismatic", axis=(-1, 0, 0), travel=9
    )


def front_of(rows: np.ndarray, number: int) -> float:
    center, size = box_views(rows)
    return float(center[number, 0] - size[number, 0] / 2)


@pytest.mark.parametrize("category", PAPER_CATEGORIES)
def test_procedural_outlines_stay(category: str):
    for seed in range(4):
        rows = tabulate_parts(shape_to_asset(draw_shape(category, seed), 32)).astype(float)
        before = rows.copy()
        assert order_depths(rows) == ""
        assert (rows == before).all()


@pytest.mark.parametrize("box", [DOOR, THICK])
def test_a_drawer_that_reaches_into_its_door_starts_behind_the_panel(box: tuple[slice, slice, slice]):
    door = row("door", box, "revolute", axis=(0, 0, 1), turn=0.25)
    rows = np.stack([BASE, door, inside(3), inside(8)]).astype(float)
    before = rows.copy()
    assert "1 parts put behind their doors" in order_depths(rows)
    deep = min(2.5 * CELL, 1.1 * (box[0].stop - box[0].start) / EDGE)
    assert front_of(rows, 2) - front_of(rows, 1) == pytest.approx(
        max(deep, 0.47 * box[0].stop / EDGE - 0.47 * 2 / EDGE)
    )
    (center, size), (centers, sizes) = box_views(rows), box_views(before)
    assert center[2, 0] + size[2, 0] / 2 == pytest.approx(centers[2, 0] + sizes[2, 0] / 2)  # its back stays
    rows[2], before[2] = 0.0, 0.0
    assert (rows == before).all()


def test_a_drawer_beside_a_door_keeps_its_front():
    door = row("door", (slice(2, 4), slice(4, 28), slice(4, 10)), "revolute", axis=(0, 0, 1), turn=0.25)
    rows = np.stack([BASE, door, inside(2)]).astype(float)
    assert order_depths(rows) == ""


def leaf(first: int, last: int) -> np.ndarray:
    place = (slice(2, 4), slice(first, last), slice(4, 28))
    return row("door", place, "revolute", axis=(0, 0, 1), turn=0.25)


def test_a_wide_drawer_starts_behind_both_doors_of_a_pair():
    rows = np.stack([BASE, leaf(4, 16), leaf(16, 28), inside(3)]).astype(float)
    before = rows[1:3].copy()
    assert "1 parts put behind their doors" in order_depths(rows)
    assert front_of(rows, 3) - front_of(rows, 1) == pytest.approx(2.5 * CELL)
    assert (rows[1:3] == before).all()
    assert order_depths(rows) == ""


def test_a_drawer_between_two_doors_keeps_its_front():
    rows = np.stack([BASE, leaf(4, 6), leaf(26, 28), inside(2)]).astype(float)
    assert order_depths(rows) == ""


def test_sliding_doors_in_one_track_are_parted():
    def slide(first: int, last: int) -> np.ndarray:
        place = (slice(2, 4), slice(first, last), slice(4, 28))
        return row("door", place, "prismatic", axis=(0, 1, 0), travel=10)

    rows = np.stack([BASE, slide(4, 17), slide(15, 28)]).astype(float)
    assert "1 pairs of sliding doors parted" in order_depths(rows)
    center, size = box_views(rows)
    near, far = sorted((1, 2), key=lambda number: center[number, 0])
    gap = center[far, 0] - size[far, 0] / 2 - center[near, 0] - size[near, 0] / 2
    assert gap == pytest.approx(0.2 * CELL)
    assert center[1:, 0].mean() * EDGE + EDGE / 2 == pytest.approx(3.0)
    assert order_depths(rows) == ""
