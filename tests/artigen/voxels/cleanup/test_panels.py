"""Knobs over holes get a panel behind them; those that sit on one, or are near nothing, stay."""

import numpy as np
import pytest
from cupboard import EDGE, row

from artigen.voxels.cleanup.panels import back_knobs

BODY = (slice(4, 28), slice(4, 28), slice(4, 28))
FRONT, TOP = (slice(2, 4), slice(10, 14), slice(10, 14)), (slice(14, 18), slice(14, 18), slice(28, 30))


def outline(joint: str = "continuous") -> np.ndarray:
    return np.stack(
        [
            row("base", BODY),
            row("knob", FRONT, joint, axis=(1, 0, 0), turn=1.0),
            row("knob", TOP, joint, axis=(0, 0, 1), turn=1.0),
        ]
    )


@pytest.fixture
def box() -> np.ndarray:
    """A hollow box of walls of two cells, with a knob in front and one on top."""
    owners = np.full((EDGE,) * 3, -1)
    owners[BODY] = 0
    owners[6:26, 6:26, 6:26] = -1
    owners[FRONT], owners[TOP] = 1, 2
    return owners


def test_knobs_on_a_panel_stay(box: np.ndarray):
    made, notes = back_knobs(box, outline())
    assert (made == box).all()
    assert notes == ()


@pytest.mark.parametrize("joint", ["continuous", "prismatic"])
def test_a_hole_behind_a_knob_is_closed_a_cell_wider_than_it(box: np.ndarray, joint: str):
    torn = box.copy()
    torn[4:6, 9:15, 9:15] = -1
    torn[13:19, 13:19, 26:28] = -1
    made, notes = back_knobs(torn, outline(joint))
    assert (made[4, 9:15, 9:15] == 0).all()
    assert (made[13:19, 13:19, 27] == 0).all()
    assert (made != torn).sum() == 2 * 36  # and nothing else
    assert notes == ("2 knobs were given a panel behind them",)
    assert back_knobs(made, outline(joint))[1] == ()


def test_a_knob_far_from_everything_stays(box: np.ndarray):
    lost = box.copy()
    lost[4:10] = -1
    made, _ = back_knobs(lost, outline())
    assert (made == lost).all()


def test_a_knob_at_the_rim_of_the_grid_stays():
    owners = np.full((EDGE,) * 3, -1)
    owners[30:32, 10:14, 10:14] = 1
    owners[28:32, 4:9, 4:28] = 0
    assert (back_knobs(owners, outline())[0] == owners).all()
