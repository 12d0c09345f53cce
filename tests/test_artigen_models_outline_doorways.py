"""Doorways of outlines: an open door leaves what slides out behind it room; what has room stays."""

import numpy as np
import pytest
from cupboard import BASE, row

from artigen.fields import tabulate_parts
from artigen.models.outline.boxes import CELL, box_views
from artigen.models.outline.doorways import free_doorways
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import PAPER_CATEGORIES

DOOR = (slice(0, 6), slice(4, 28), slice(4, 28))


def drawer(first: int, last: int) -> np.ndarray:
    return row(
        "drawer", (slice(8, 24), slice(first, last), slice(6, 14)), "prismatic", axis=(-1, 0, 0), travel=15
    )


def door(turn: float) -> np.ndarray:
    return row("door", DOOR, "revolute", axis=(0, 0, 1), origin=(0, 4, 16), turn=turn)


def edges(rows: np.ndarray, number: int) -> np.ndarray:
    center, size = box_views(rows)
    return center[number, 1] + np.array([-0.5, 0.5]) * size[number, 1]


@pytest.mark.parametrize("category", PAPER_CATEGORIES)
def test_procedural_outlines_stay(category: str):
    for seed in range(12):
        rows = tabulate_parts(shape_to_asset(draw_shape(category, seed), 16)).astype(float)
        before = rows.copy()
        assert free_doorways(rows) == ""
        assert (rows == before).all()


@pytest.mark.parametrize("turn", [0.25, 0.3, 0.4])
def test_what_slides_passes_the_panel_of_the_open_door(turn: float):
    """The corner of a panel two cells thick, turned about the hinge, comes to stand beside the drawer."""
    rows = np.stack([BASE, door(turn), drawer(4, 26)]).astype(float)
    before = edges(rows, 2)
    assert "1 doorways freed" in free_doorways(rows)
    angle = 2 * np.pi * turn
    corner = np.array([2 * CELL, 0.0])  # from the hinge, inwards
    stands = edges(rows, 1)[0] + np.sin(angle) * corner[0] + np.cos(angle) * corner[1]
    low, high = edges(rows, 2)
    assert low == pytest.approx(stands)
    assert high == before[1]  # nothing turns there
    assert free_doorways(rows) == ""


def test_what_has_room_and_what_no_hinge_is_near_stay():
    rows = np.stack([BASE, door(0.25), drawer(8, 28)]).astype(float)
    assert free_doorways(rows) == ""


def test_doors_that_fall_open_and_what_does_not_slide_stay():
    falling = row("door", DOOR, "revolute", axis=(0, 1, 0), origin=(0, 16, 4), turn=0.25)
    rows = np.stack([BASE, falling, drawer(4, 28)]).astype(float)
    assert free_doorways(rows) == ""
    shelf = row("shelf", (slice(8, 24), slice(4, 28), slice(12, 14)))
    rows = np.stack([BASE, door(0.25), shelf]).astype(float)
    assert free_doorways(rows) == ""
