"""A flat as a value: rooms in frames in which each has its entrance in front, and all of them as one room."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.transforms import transform_points
from envs.rooms.recipes import RECIPES
from envs.rooms.room import (
    THICKNESS,
    Fixture,
    Item,
    Opening,
    Placement,
    Room,
    Side,
    along_wall,
    corner,
    pose_matrix_of,
    room_shell,
    rounded_quat,
    turn_matrix,
    wall_axis,
)

from .layout import Cell, FlatPlan

AROUND: tuple[Side, ...] = ("front", "right", "back", "left")
"""Sides in the order of quarter turns."""
HEIGHT = 2.6
"""Height (m) from floor to ceiling."""
SHELL = ("floor", "wall_")
"""Beginnings of the names of fixtures that a flat builds anew: walls that two rooms share."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """Where a room is: ``T`` maps its frame to that of the flat, by a quarter turn, ``size`` is its own."""

    T: Float[np.ndarray, "4 4"]
    size: tuple[float, float, float]
    quarters: int

    def side_in_flat(self, side: Side) -> Side:
        """The direction in the flat of one of the room's walls."""
        return AROUND[(AROUND.index(side) + self.quarters) % 4]

    def side_in_room(self, side: Side) -> Side:
        """The wall of the room in a direction of the flat."""
        return AROUND[(AROUND.index(side) - self.quarters) % 4]


@dataclass(frozen=True, kw_only=True, eq=False)
class Flat:
    """Rooms in the order of the plan's cells, each in its frame."""

    seed: int
    plan: FlatPlan
    rooms: tuple[Room, ...]
    provenance: tuple[tuple[str, str], ...]


def frame_of(cell: Cell) -> Frame:
    """The frame of a room, whose front is the wall with its entrance."""
    quarters = AROUND.index(cell.side)
    low, high = np.array(cell.zone.low), np.array(cell.zone.high)
    width, depth = (float(value) for value in (high - low)[[1, 0] if quarters % 2 else [0, 1]])
    T = turn_matrix(quarters * np.pi / 2.0)
    turned = T[:2, :2] @ np.array([[0.0, width], [0.0, depth]])
    T[:2, 3] = low - turned.min(axis=1)
    return Frame(T=T, size=(width, depth, HEIGHT), quarters=quarters)


def move_opening(
    opening: Opening,
    size: Sequence[float],
    T: Float[np.ndarray, "4 4"],
    side: Side,
) -> Opening:
    """An opening of a room of some size as one of the wall ``side`` in the frame to which ``T`` maps."""
    ends = (opening.start, 0.0, opening.bottom), (opening.stop, 0.0, opening.top)
    box = transform_points(T, along_wall(opening.side, size, *ends))
    return replace(opening, side=side, start=round(float(box[:, wall_axis(side)].min()), 6))


def join_rooms(flat: Flat) -> Room:
    """The flat as one room with its rooms as zones: ids begin with the name of the room, walls are shared."""
    placements: list[Placement] = []
    fixtures: list[Fixture] = []
    openings: list[Opening] = []
    contents = []
    whole = (*flat.plan.size, HEIGHT)
    for cell, room in zip(flat.plan.cells, flat.rooms, strict=True):
        frame, name = frame_of(cell), cell.zone.name
        placements += [_move_placement(room, placement, frame.T, name) for placement in room.placements]
        contents += [_move_item(item, frame.T, name) for item in room.contents]
        own = [fixture for fixture in room.fixtures if not fixture.name.startswith(SHELL)]
        fixtures += [_move_fixture(fixture, frame.T, name) for fixture in (*_shell(cell, room, frame), *own)]
        openings += [
            move_opening(hole, room.size, frame.T, frame.side_in_flat(hole.side))
            for hole in room.openings
            if frame.side_in_flat(hole.side) in cell.outer
        ]
    index, hub = next((index, cell) for index, cell in enumerate(flat.plan.cells) if cell.parent is None)
    entered = flat.rooms[index]
    return Room(
        kind="flat",
        seed=flat.seed,
        attempt=0,
        size=whole,
        entrance=move_opening(entered.entrance, entered.size, frame_of(hub).T, "front"),
        standing_radius=entered.standing_radius,
        fixtures=tuple(fixtures),
        placements=tuple(placements),
        provenance=flat.provenance,
        contents=tuple(contents),
        openings=tuple(openings),
        zones=tuple(cell.zone for cell in flat.plan.cells),
    )


def _shell(cell: Cell, room: Room, frame: Frame) -> tuple[Fixture, ...]:
    """Floor and walls of a room; of a wall between two rooms each has its half."""
    outer = {frame.side_in_room(side) for side in cell.outer}
    thickness: dict[Side, float] = {side: THICKNESS if side in outer else THICKNESS / 2.0 for side in AROUND}
    recipe = RECIPES[room.kind]
    holes = (room.entrance, *room.openings)
    return room_shell(room.size, holes, recipe.wall_color, recipe.floor, recipe.wall, thickness)


def _move_fixture(fixture: Fixture, T: Float[np.ndarray, "4 4"], name: str) -> Fixture:
    """A fixture in the frame of the flat; the first word of its name stays in front."""
    points = transform_points(T, np.array([fixture.low, fixture.high]))
    return replace(
        fixture,
        name=_move_name(fixture.name, name),
        low=corner(points.min(axis=0)),
        high=corner(points.max(axis=0)),
    )


def _move_name(fixture: str, name: str) -> str:
    first, _, rest = fixture.partition("_")
    return "_".join(part for part in (first, name, rest) if part)


def _move_placement(room: Room, placement: Placement, T: Float[np.ndarray, "4 4"], name: str) -> Placement:
    pose = T @ pose_matrix_of(placement)
    points = np.array([(x, y, 0.0) for x, y in placement.standing]).reshape(-1, 3)
    support = placement.support
    if support is not None:
        there = {each.id for each in room.placements}
        support = f"{name}_{support}" if support in there else _move_name(support, name)
    return replace(
        placement,
        id=f"{name}_{placement.id}",
        position=corner(pose[:3, 3]),
        quat=rounded_quat(pose[:3, :3]),
        standing=tuple((round(float(x), 4), round(float(y), 4)) for x, y, _ in transform_points(T, points)),
        support=support,
    )


def _move_item(item: Item, T: Float[np.ndarray, "4 4"], name: str) -> Item:
    """A thing in the frame of the flat; in that of its holder it stays where it is."""
    if item.holder is not None:
        return replace(item, id=f"{name}_{item.id}", holder=f"{name}_{item.holder}")
    pose = T @ pose_matrix_of(item)
    return replace(
        item, id=f"{name}_{item.id}", position=corner(pose[:3, 3]), quat=rounded_quat(pose[:3, :3])
    )


def with_neighbours(flat: Flat, index: int) -> Room:
    """A room of the flat in its own frame with the closed doors of the rooms to which it leads."""
    inverse = np.linalg.inv(frame_of(flat.plan.cells[index]).T)
    added = [
        _move_placement(room, placement, inverse @ frame_of(cell).T, cell.zone.name)
        for cell, room in zip(flat.plan.cells, flat.rooms, strict=True)
        if cell.parent == index
        for placement in room.placements
        if placement.role == "door"
    ]
    return replace(flat.rooms[index], placements=(*flat.rooms[index].placements, *added))
