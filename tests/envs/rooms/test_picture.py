"""Sizes of pictures of rooms."""

from dataclasses import replace

import numpy as np
from bare_room import ROOM

from artigen.camera import project_points
from envs.rooms.picture import draw_masks, draw_plan, draw_room, draw_view
from envs.rooms.room import Fixture
from envs.rooms.views import find_views


def test_plans_have_120_pixels_per_metre_and_thirty_centimetres_around_the_room():
    assert draw_plan(ROOM).shape == (round(120 * 4.1) - 1, 120 * 4.6, 3)


def test_views_are_1100_pixels_wide_and_760_high():
    assert draw_room(ROOM).shape == (760, 1100, 3)


def test_masks_show_what_stands_where_the_camera_projects_it():
    post = Fixture(name="post", low=(2.0, 2.0, 0.5), high=(2.1, 2.1, 1.5), color=(0.5, 0.5, 0.5))
    room = replace(ROOM, fixtures=(*ROOM.fixtures, post))
    for view in find_views(room):
        mask, names = draw_masks(room, view)
        column, row, _ = project_points(view.camera, np.array([[2.05, 2.05, 1.0]]))[0]
        assert names[mask[int(row), int(column)] - 1] == "post"
        assert {names[value - 1].split("_")[0] for value in np.unique(mask) if value} == {
            "post",
            "wall",
            "floor",
        }


def test_a_wall_in_pieces_looks_like_a_whole_one():
    (whole,) = (each for each in ROOM.fixtures if each.name == "wall_back")
    (_, y0, z0), (_, y1, z1) = whole.low, whole.high
    pieces = (
        replace(whole, name="wall_back_0", high=(2.03, y1, z1)),
        replace(whole, name="wall_back_1", low=(2.03, y0, z0)),
    )
    others = tuple(each for each in ROOM.fixtures if each is not whole)
    entrance = find_views(ROOM)[0]
    first, second = (
        draw_view(replace(ROOM, fixtures=fixtures), entrance).astype(float)
        for fixtures in ((*others, whole), (*others, *pieces))
    )
    assert np.abs(first - second).mean() < 1e-3
