"""Wheels get the legs that were not drawn; those that have one, or have no body above, stay."""

import numpy as np
import pytest
from cupboard import EDGE, row

from artigen.mending.legs import extend_legs

TOP = (slice(4, 28), slice(4, 28), slice(20, 22))
WHEELS = [(slice(x, x + 3), slice(y, y + 2), slice(0, 3)) for x in (5, 24) for y in (5, 25)]
ROWS = np.stack(
    [
        row("base", (slice(4, 28), slice(4, 28), slice(3, 22))),
        *(row("wheel", wheel, "continuous", axis=(0, 1, 0), turn=1.0) for wheel in WHEELS),
    ]
)


@pytest.fixture
def table() -> np.ndarray:
    """A table top on four legs with a wheel each."""
    owners = np.full((EDGE,) * 3, -1)
    owners[TOP] = 0
    for number, (x, y, z) in enumerate(WHEELS):
        owners[x, y, z] = number + 1
        owners[x, y, 3:20] = 0
    return owners


def test_a_table_with_its_legs_stays(table: np.ndarray):
    made, notes = extend_legs(table, ROWS)
    assert (made == table).all()
    assert notes == ()


@pytest.mark.parametrize("lost", [(3, 20), (3, 12), (3, 6)])
def test_a_lost_leg_comes_back(table: np.ndarray, lost: tuple[int, int]):
    x, y, _ = WHEELS[1]
    torn = table.copy()
    torn[x, y, lost[0] : lost[1]] = -1
    made, notes = extend_legs(torn, ROWS)
    assert (made == table).all()
    assert notes == (f"1 wheels were given legs, of {lost[1] - lost[0]} cells at most",)


def test_other_parts_are_not_built_over(table: np.ndarray):
    x, y, _ = WHEELS[1]
    torn = table.copy()
    torn[x, y, 3:20] = -1
    torn[x, y, 10:12] = 4
    made, _ = extend_legs(torn, ROWS)
    assert (made[x, y, 10:12] == 4).all()
    assert (made[x, y, 3:10] == 0).all()


def test_a_wheel_without_a_body_above_stays(table: np.ndarray):
    x, y, _ = WHEELS[0]
    torn = table.copy()
    torn[x, y, 3:22] = -1
    made, notes = extend_legs(torn, ROWS)
    assert (made == torn).all()
    assert notes == ()


def test_without_a_body_wheels_stay():
    x, y, z = WHEELS[0]
    owners = np.full((EDGE,) * 3, -1)
    owners[x, y, z] = 0
    made, notes = extend_legs(owners, ROWS[1:2])
    assert (made == owners).all()
    assert notes == ()
