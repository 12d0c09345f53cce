"""Skirting, tiles and clutter: they touch nothing, cover what is bare, and leave every door its way."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bare_room import ROOM
from sample_packages import SAMPLE_PARTS, build_package

from envs.rooms import clutter
from envs.rooms.check import check_room
from envs.rooms.clutter import PER_AREA, clutter_room
from envs.rooms.footprints import read_footprint
from envs.rooms.room import Placement, Room, wall_length
from envs.rooms.solids import fixture_solids
from envs.rooms.things import THINGS
from envs.rooms.trim import GAP, SKIRTING, trim_room
from sim_export.files.write import write_package


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Room:
    """A kitchen with a cabinet against its back wall and one in its middle."""
    folder = write_package(build_package(SAMPLE_PARTS), tmp_path_factory.mktemp("trim").resolve() / "cabinet")
    body = read_footprint(folder).body
    spots = ((2.0, ROOM.size[1] - 0.003 - float(body[1, 0])), (1.0, 1.6))
    placements = tuple(
        Placement(
            id=f"base_cabinet_{index}", role="base cabinet", category="StorageFurniture", package=folder,
            position=(x, y, 0.002 - float(body[0, 2])), quat=(0.5**0.5, 0.0, 0.0, 0.5**0.5),
            size=(0.5, 0.8, 0.7),
        )
        for index, (x, y) in enumerate(spots)
    )  # fmt: skip
    return replace(ROOM, placements=placements, standing_radius=0.0)


def trim(room: Room, name: str) -> list[np.ndarray]:
    return [np.array([f.low, f.high]) for f in trim_room(room).fixtures if f.name.startswith(name)]


def test_a_bare_room_has_skirting_along_all_walls_but_its_entrance():
    boards = trim(ROOM, "skirting")
    width, depth = ROOM.size[:2]
    inset = 2 * (SKIRTING[1] + GAP)
    expected = 2 * depth + 2 * (width - inset) - ROOM.entrance.width - 2 * GAP
    length = sum(float(np.sort(board[1] - board[0])[-1]) for board in boards)
    assert len(boards) == 5
    assert length == pytest.approx(expected, abs=2e-3)
    assert wall_length("front", ROOM.size) == width


def test_trim_and_clutter_violate_no_condition_of_the_room(room: Room):
    assert not check_room(room)
    full = clutter_room(trim_room(room), "messy")
    assert len(full.contents) >= 4
    assert not check_room(full)


def test_trim_does_not_overlap_itself(room: Room):
    boxes = np.array([solid.boxes[0] for solid in fixture_solids(trim_room(room))])
    added = boxes[len(room.fixtures) :]
    for index, box in enumerate(added):
        others = np.delete(boxes, len(room.fixtures) + index, axis=0)
        deep = np.minimum(box[1], others[:, 1]) - np.maximum(box[0], others[:, 0])
        assert not (deep > 1e-4).all(axis=1).any()


def test_a_board_or_tile_before_a_door_is_left_out(room: Room, tmp_path: Path):
    """The cabinet in a corner whose door swings along the side wall."""
    (cabinet, _) = room.placements
    beside = float(read_footprint(cabinet.package).body[1, 1]) + 0.004
    for x in (beside, room.size[0] - beside):
        alone = replace(room, placements=(replace(cabinet, position=(x, *cabinet.position[1:])),))
        problems = {problem.other for problem in check_room(trim_room(alone))}
        assert not {name for name in problems if name.startswith(("skirting", "tiles"))}


def test_more_clutter_means_more_things_and_the_same_room_the_same(room: Room):
    counts = [len(clutter_room(room, amount).contents) for amount in PER_AREA]
    assert counts[0] == 0
    assert counts == sorted(counts)
    assert counts[-1] > counts[1]
    assert clutter_room(room, "lived") == clutter_room(room, "lived")


@pytest.mark.parametrize(("longest", "once"), [(0.199, False), (0.201, True)])
def test_a_thing_from_twenty_centimetres_on_is_on_a_top_once(
    room: Room,
    monkeypatch: pytest.MonkeyPatch,
    longest: float,
    once: bool,  # noqa: FBT001
):
    size = (0.05, longest, 0.05)
    monkeypatch.setattr(clutter, "THINGS", (replace(THINGS[0], where=("kitchen top",), low=size, high=size),))
    rooms = [clutter_room(replace(room, seed=seed), "messy") for seed in range(4)]
    most = max(max(Counter(item.holder for item in full.contents).values(), default=0) for full in rooms)
    assert (most == 1) == once
