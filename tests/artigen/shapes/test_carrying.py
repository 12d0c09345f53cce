"""Handles to pull and push by: a hand fits behind them, and wheels roll the way they are pushed."""

import numpy as np
import pytest

from artigen.kinds.cart import STYLES as CARTS
from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.fittings.carrying import make_pull_handle
from artigen.shapes.fittings.hardware import FINGER_ROOM, GAP
from artigen.shapes.primitives import place_vertices
from artigen.transforms import transform_points


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


@pytest.mark.parametrize("style", CARTS)
@pytest.mark.parametrize("seed", range(3))
def test_wheels_of_carts_roll_away_from_their_handles(style, seed):
    shape = draw_shape("Cart", seed, Wish(style=style))
    wheels = [part for part in shape.parts if part.name.startswith("wheel")]
    assert {tuple(map(abs, part.joint.axis)) for part in wheels} == {(1.0, 0.0, 0.0)}
    for wheel in wheels:
        low, high = wheel.bounds()
        assert high[1] - low[1] == pytest.approx(high[2] - low[2], rel=0.03)  # a disc across the way
    left = {part.name: part.bounds()[1, 1] for part in shape.parts}
    assert max(left, key=left.__getitem__) == ("push_bar" if "push_bar" in left else "body")


@pytest.mark.parametrize("seed", range(4))
def test_a_wheelbarrow_stands_on_its_wheel_and_two_legs_and_tips_about_the_axle(seed):
    shape = draw_shape("Cart", seed, Wish(style="wheelbarrow"))
    body, wheel = shape.parts
    legs = [piece for piece in map(place_vertices, body.primitives) if piece[:, 2].min() < 1e-6]
    assert sorted(np.sign(leg[:, 0].mean()) for leg in legs) == [-1.0, 1.0]
    assert wheel.bounds()[0, 2] == pytest.approx(0.0, abs=1e-9)
    axle = np.array(wheel.joint.origin)
    T = np.eye(4)
    turn = np.radians(20.0)  # handles raised
    T[1:3, 1:3] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    T[:3, 3] = axle - T[:3, :3] @ axle
    points = np.concatenate([place_vertices(piece) for piece in body.primitives])
    assert transform_points(T, points)[:, 2].min() > 0.05
