"""Telescopic handles can be held: a hand fits between their grip and what it is mounted on."""

import numpy as np
import pytest

from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.fittings.carrying import make_pull_handle
from artigen.shapes.fittings.hardware import FINGER_ROOM, GAP
from artigen.shapes.primitives import place_vertices


@pytest.mark.parametrize("seed", range(4))
def test_fingers_fit_behind_the_grip_of_a_rolling_tool_box(seed):
    shape = draw_shape("ToolBox", seed, Wish(style="rolling"))
    handle = next(part for part in shape.parts if part.name == "pull_handle")
    grip = next(piece for piece in handle.primitives if piece.finish == "rubber")
    vertices = place_vertices(grip)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    others = [piece for part in shape.parts if part is not handle for piece in part.primitives]
    gaps = []
    for corners in map(place_vertices, others):
        beside = (corners.min(axis=0)[1:] < high[1:]) & (corners.max(axis=0)[1:] > low[1:])
        if beside.all() and corners[:, 0].min() < low[0]:
            gaps.append(low[0] - corners[:, 0].max())
    assert gaps
    assert min(gaps) >= FINGER_ROOM


@pytest.mark.parametrize("out", [0.0, 0.03])
def test_a_grip_stands_off_its_rods_by_as_much_as_was_asked(out):
    handle = make_pull_handle(0.1, 0.2, (0.0, 0.4), 0.2, out=out)
    grip = next(piece for piece in handle.primitives if piece.finish == "rubber")
    assert place_vertices(grip)[:, 0].min() == pytest.approx(0.1 + GAP + out)
    rods = [place_vertices(piece) for piece in handle.primitives if piece is not grip]
    reach = max(corners[:, 0].max() for corners in rods)
    assert len(rods) == (4 if out else 2)
    np.testing.assert_allclose(handle.bounds()[1, 2], 0.4)
    assert (reach == pytest.approx(0.1 + GAP + out)) == (out > 0.0)
