"""Sizes of pictures of rooms."""

from bare_room import ROOM

from envs.rooms.picture import draw_plan, draw_room


def test_plans_have_120_pixels_per_metre_and_thirty_centimetres_around_the_room():
    assert draw_plan(ROOM).shape == (round(120 * 4.1) - 1, 120 * 4.6, 3)


def test_views_are_1100_pixels_wide_and_760_high():
    assert draw_room(ROOM).shape == (760, 1100, 3)
