"""A kitchen with its walls, floor and entrance, and nothing in it."""

from envs.rooms.room import Opening, Room, room_shell

ENTRANCE = Opening(side="front", start=1.5, width=0.9, height=2.0)
SIZE = (4.0, 3.5, 2.6)
ROOM = Room(
    kind="kitchen", seed=0, attempt=0, size=SIZE, entrance=ENTRANCE, standing_radius=0.3,
    fixtures=room_shell(SIZE, (ENTRANCE,), (0.9, 0.9, 0.9)), placements=(),
)  # fmt: skip
