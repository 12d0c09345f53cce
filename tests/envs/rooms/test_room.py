"""Walls and floor of a room."""

import numpy as np

from envs.rooms.room import Opening, room_shell


def test_walls_and_floor_are_ten_centimetres_thick():
    boxes = np.array([[part.low, part.high] for part in room_shell((4.0, 3.0, 2.5), (), (1.0, 1.0, 1.0))])
    assert len(boxes) == 5
    np.testing.assert_allclose((boxes[:, 1] - boxes[:, 0]).min(axis=1), 0.1)
    np.testing.assert_allclose(boxes.min(axis=(0, 1)), -0.1)
    np.testing.assert_allclose(boxes.max(axis=(0, 1)), (4.1, 3.1, 2.5))


def test_an_opening_reaches_the_floor_unless_something_else_is_said():
    door = Opening(side="front", start=1.0, width=0.9, height=2.0)
    walls = [part for part in room_shell((4.0, 3.0, 2.5), (door,), (1.0, 1.0, 1.0)) if "front" in part.name]
    assert sorted(wall.low[2] for wall in walls) == [0.0, 0.0, 2.0]
