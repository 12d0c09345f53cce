"""Sizes of pictures of rooms."""

from envs.maniskill.rooms.picture import draw_plan, draw_room
from envs.maniskill.rooms.room import Opening, Room, room_shell

SIZE = (4.0, 3.5, 2.6)
ENTRANCE = Opening(side="front", start=1.5, width=0.9, height=2.0)
ROOM = Room(
    kind="kitchen", seed=0, attempt=0, size=SIZE, entrance=ENTRANCE, standing_radius=0.3,
    fixtures=room_shell(SIZE, (ENTRANCE,), (0.9, 0.9, 0.9)), placements=(),
)  # fmt: skip


def test_plans_have_120_pixels_per_metre_and_thirty_centimetres_around_the_room():
    assert draw_plan(ROOM).shape == (round(120 * 4.1) - 1, 120 * 4.6, 3)


def test_views_are_1100_pixels_wide_and_760_high():
    assert draw_room(ROOM).shape == (760, 1100, 3)
