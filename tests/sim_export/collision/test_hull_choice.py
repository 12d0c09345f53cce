"""Of two hulls, the one is chosen that is worth more: volume against surface missed and too far away."""

import numpy as np
import pytest

from sim_export.collision.hull_choice import Cells, Offers, choose_hulls, pack_marks
from sim_export.geometry.hulls import box_hull

CELLS, POINTS = 1000, 1000
SMALL, LARGE = (box_hull(np.zeros(3), np.array([x, 1.0, 1.0])) for x in (0.5, 0.6))


def choose_large(more: int, missed: int, far: int) -> bool:
    """Whether the large hull is chosen, which holds ``more`` thousandths of the volume in addition, but
    leaves so many thousandths of the surface missed, and too far away."""
    windows = [(slice(0, stop), slice(0, 1), slice(0, 1)) for stop in (500, 500 + more)]
    marks = np.zeros((2, 2, POINTS), dtype=bool)
    marks[1, 0, :missed] = marks[1, 1, :far] = True
    offers = Offers(
        tiles=((SMALL,), (LARGE,)),
        costs=np.ones(2, dtype=np.int64),
        cells=tuple(Cells(window=window, mask=None) for window in windows),
        bounds=np.array([[(axis.start, axis.stop) for axis in window] for window in windows]),
        surplus=np.zeros(2),
        missing=np.stack([pack_marks(rows) for rows in marks]),
        points=POINTS,
        bulges=np.zeros(2),
        weights=np.full((CELLS, 1, 1), 1.0 / CELLS),
    )
    return choose_hulls(offers, 1)[0] == (LARGE,)


@pytest.mark.parametrize(
    ("missed", "far", "worth"),
    [
        (5, 0, 10),  # four thousandths may be missed for nothing
        (14, 0, 100),  # what is missed beyond them counts ten times
        (1, 1, 40),  # what is too far away counts forty times, however little
        (14, 2, 180),
    ],
)
def test_a_hull_is_worth_the_volume_that_it_holds_less_the_surface_that_it_leaves(missed, far, worth):
    assert choose_large(worth + 1, missed, far)
    assert not choose_large(worth - 1, missed, far)
