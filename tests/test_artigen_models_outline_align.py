"""Alignment of outlines: what is in line stays, what nearly is comes into line, what is not stays."""

import numpy as np
import pytest

from artigen.fields import DEFAULT_LAYOUT
from artigen.models.outline.align import align_outline
from artigen.models.outline.boxes import CELL, box_views
from artigen.types import PART_LABELS

COLUMNS, ROWS = 2, 3
WIDTH, HEIGHT = 20 * CELL, 12 * CELL
SLIT = 0.2 * CELL


def make_part(label: str, low: tuple[float, float, float], high: tuple[float, float, float]) -> np.ndarray:
    row = np.zeros((1, DEFAULT_LAYOUT.channels - 1))
    row[0, PART_LABELS.index(label)] = 1.0
    center, size = box_views(row)
    center[0], size[0] = (np.array(low) + high) / 2, np.array(high) - low
    return row


@pytest.fixture
def chest() -> np.ndarray:
    """A chest of drawers in a grid, each with a handle in its middle."""
    depth = 10 * CELL
    parts = [make_part("base", (0.0, 0.0, 0.0), (depth, COLUMNS * WIDTH, ROWS * HEIGHT))]
    for column in range(COLUMNS):
        for row in range(ROWS):
            y, z = column * WIDTH, row * HEIGHT
            low = (0.0, y + (SLIT if column else 0.0), z + (SLIT if row else 0.0))
            high = (depth, y + WIDTH, z + HEIGHT)
            middle = (np.array(low) + high) / 2
            parts.append(make_part("drawer", low, high))
            parts.append(
                make_part(
                    "handle",
                    (-2 * CELL, middle[1] - 3 * CELL, middle[2] - CELL),
                    (0.0, middle[1] + 3 * CELL, middle[2] + CELL),
                )
            )
    return np.concatenate(parts)


def edges_of(rows: np.ndarray, label: str) -> np.ndarray:
    center, size = box_views(rows)
    own = rows[:, PART_LABELS.index(label)] == 1.0
    return np.concatenate([(center - size / 2)[own], (center + size / 2)[own]], axis=1)


def test_a_chest_of_drawers_stays(chest: np.ndarray):
    before = chest.copy()
    assert align_outline(chest) == ""
    assert np.abs(chest - before).max() < 0.05 * CELL


@pytest.mark.parametrize("seed", range(3))
def test_a_chest_drawn_a_little_off_comes_back_into_line(chest: np.ndarray, seed: int):
    truth = chest.copy()
    center, size = box_views(chest)
    rng = np.random.default_rng(seed)
    center[1:] += rng.uniform(-0.3, 0.3, center[1:].shape) * CELL
    size[1:] += rng.uniform(-0.3, 0.3, size[1:].shape) * CELL
    assert "parts aligned" in align_outline(chest)
    found, meant = edges_of(chest, "drawer"), edges_of(truth, "drawer")
    assert np.abs(found - meant).max() < 0.45 * CELL
    for side in range(6):
        assert len(np.unique(found[:, side].round(9))) == len(np.unique(meant[:, side].round(9)))
    handles = edges_of(chest, "handle")
    assert np.ptp(handles[:, 3:] - handles[:, :3], axis=0).max() < 1e-9  # of one size
    middles = (handles[:, 1:3] + handles[:, 4:]) / 2
    assert np.abs(middles - (found[:, 1:3] + found[:, 4:]) / 2).max() < 1e-9


def test_a_gap_between_neighbours_is_closed_and_a_wide_one_stays(chest: np.ndarray):
    for gap, closed in ((3.0, True), (6.0, False)):
        rows = chest.copy()
        center, size = box_views(rows)
        tops = np.flatnonzero((rows[:, PART_LABELS.index("drawer")] == 1.0) & (center[:, 2] > 2.2 * HEIGHT))
        center[tops, 2] += gap * CELL / 2
        size[tops, 2] -= gap * CELL
        align_outline(rows)
        found = edges_of(rows, "drawer")
        upper, middle = (
            np.sort(np.unique(found[:, 2].round(6)))[-1],
            np.sort(np.unique(found[:, 5].round(6)))[1],
        )
        assert (upper - middle < 0.5 * CELL) == closed


def test_fronts_of_different_sizes_stay_apart(chest: np.ndarray):
    center, size = box_views(chest)
    first = int(np.flatnonzero(chest[:, PART_LABELS.index("drawer")] == 1.0)[0])
    center[first, 1] -= 2.5 * CELL
    size[first, 1] -= 5.0 * CELL  # its right edge lies five cells to the left of the others'
    align_outline(chest)
    assert len(np.unique(edges_of(chest, "drawer")[:, 4].round(6))) == COLUMNS + 1


def test_a_drawer_behind_the_others_is_not_in_line_with_them(chest: np.ndarray):
    inner = make_part("drawer", (3 * CELL, CELL, CELL), (9 * CELL, WIDTH - CELL, HEIGHT - CELL))
    rows = np.concatenate([chest, inner])
    align_outline(rows)
    assert np.abs(rows[-1] - inner[0]).max() < 1e-9


def test_knobs_of_one_size_are_level_and_others_stay():
    def knob(y: float, z: float, edge: float) -> np.ndarray:
        return make_part("knob", (-CELL, y * CELL, z * CELL), (0.0, (y + edge) * CELL, (z + edge) * CELL))

    rows = np.concatenate(
        [knob(0, 0, 3), knob(5, 1.9, 3), knob(10, 0.4, 3), knob(15, 2.0, 6), knob(22, 8, 3)]
    )
    align_outline(rows)
    center, _ = box_views(rows)
    heights = center[:, 2] / CELL
    np.testing.assert_allclose(heights[:3], 1.5 + (0 + 1.9 + 0.4) / 3, atol=1e-6)
    np.testing.assert_allclose(heights[3:], [5.0, 9.5], atol=1e-6)
