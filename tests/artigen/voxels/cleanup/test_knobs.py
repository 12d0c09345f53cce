"""Buttons fill their boxes, dials drawn as fragments become discs; whole ones stay."""

import numpy as np
import pytest
from cupboard import EDGE, row

from artigen.voxels.cleanup.knobs import shape_knobs

BODY = (slice(4, 28), slice(4, 28), slice(4, 28))
KNOB = (slice(1, 5), slice(10, 16), slice(10, 16))
"""Reaches one cell into the panel."""
OUTSIDE = (slice(1, 4), KNOB[1], KNOB[2])


def outline(joint: str) -> np.ndarray:
    return np.stack([row("base", BODY), row("knob", KNOB, joint, axis=(1, 0, 0), turn=1.0)])


@pytest.fixture
def panel() -> np.ndarray:
    owners = np.full((EDGE,) * 3, -1)
    owners[BODY] = 0
    return owners


@pytest.mark.parametrize("drawn", [OUTSIDE, (slice(2, 3), slice(10, 12), slice(10, 16))])
def test_a_button_fills_its_box_as_far_as_that_sticks_out(panel: np.ndarray, drawn: tuple[slice, ...]):
    wanted = panel.copy()
    wanted[OUTSIDE] = 1
    owners = panel.copy()
    owners[drawn] = 1
    made, notes = shape_knobs(owners, outline("prismatic"))
    assert (made == wanted).all()
    assert notes == (
        () if drawn == OUTSIDE else (f"1 knobs were made whole, by {(owners != wanted).sum()} cells",)
    )


def test_a_panel_that_swells_over_a_button_gives_way(panel: np.ndarray):
    owners = panel.copy()
    owners[1:4, 10:13, 10:16] = 0
    owners[1:4, 13:16, 10:16] = 1
    made, _ = shape_knobs(owners, outline("prismatic"))
    assert (made[OUTSIDE] == 1).all()
    assert (made[4:] == panel[4:]).all()


def test_a_fragment_of_a_dial_becomes_a_disc(panel: np.ndarray):
    owners = panel.copy()
    owners[1:4, 10:12, 10:12] = 1
    made, _ = shape_knobs(owners, outline("continuous"))
    disc = made[1] == 1
    y, z = np.argwhere(disc).T
    assert (np.hypot(y - 12.5, z - 12.5) <= 3.3).all()
    assert disc.sum() == pytest.approx(np.pi * 3**2, rel=0.15)
    assert (made[1:4] == made[1]).all()
    assert (made[4:] == panel[4:]).all()


def test_a_dial_that_is_most_of_its_disc_or_of_its_box_stays(panel: np.ndarray):
    whole = panel.copy()
    whole[1:4, 10:16, 11:15] = 1  # a bar across it
    made, notes = shape_knobs(whole, outline("revolute"))
    assert (made == whole).all()
    assert notes == ()


def test_other_parts_keep_their_cells(panel: np.ndarray):
    rows = np.concatenate(
        [outline("prismatic"), row("door", (slice(1, 3), slice(14, 20), slice(4, 28)))[None]]
    )
    owners = panel.copy()
    owners[1:3, 14:20, 4:28] = 2
    owners[1:4, 10:12, 10:16] = 1
    made, _ = shape_knobs(owners, rows)
    assert (made[owners == 2] == 2).all()
