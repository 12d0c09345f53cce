"""Decorated rooms: seats face their tables, nothing is in the way, and what is wrong is found."""

from collections import Counter
from dataclasses import replace
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pytest
from bare_room import ROOM
from box_furniture import solid_link
from sample_packages import SAMPLE_PARTS, build_package

from envs.rooms.check import check_room
from envs.rooms.decor import decorate_room
from envs.rooms.floor import SEATS, stand_on_floor
from envs.rooms.footprints import read_footprint
from envs.rooms.map import STEP, free_map
from envs.rooms.room import (
    Fixture,
    Opening,
    Placement,
    Room,
    along_wall,
    corner,
    pose_matrix_of,
    room_shell,
)
from envs.rooms.solids import fixture_solids, object_solids, place_solid
from envs.rooms.things import THINGS, thing_hulls
from envs.rooms.views import find_lamps, find_views
from sim_export.files.write import write_package
from sim_export.package import SimPackage

WINDOW = Opening(side="right", start=1.2, width=0.9, bottom=0.95, height=1.1)


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Room:
    """A kitchen with a window and a drawer unit as an island in its middle."""
    folder = write_package(
        build_package(SAMPLE_PARTS), tmp_path_factory.mktemp("floor").resolve() / "cabinet"
    )
    body = read_footprint(folder).body
    island = Placement(
        id="island_1", role="island", category="StorageFurniture", package=folder,
        position=(2.0, 1.9, 0.002 - float(body[0, 2])), quat=(0.5**0.5, 0.0, 0.0, 0.5**0.5),
        size=(0.5, 0.8, 0.7),
    )  # fmt: skip
    holes = (ROOM.entrance, WINDOW)
    return replace(
        ROOM, fixtures=room_shell(ROOM.size, holes, (0.9, 0.9, 0.9)), openings=(WINDOW,), placements=(island,)
    )


def dressed(room: Room) -> Room:
    return stand_on_floor(decorate_room(room))


@pytest.mark.parametrize(
    "kind", ["kitchen", "living_room", "bedroom", "office", "hall", "bathroom", "laundry"]
)
def test_a_dressed_room_keeps_its_promises(room: Room, kind):
    full = dressed(replace(room, kind=kind))
    assert check_room(full) == ()
    assert len(full.fixtures) > len(room.fixtures) + 3
    assert dressed(replace(room, kind=kind)) == full


def test_seats_face_what_they_stand_at_and_leave_its_front_to_the_drawers(room: Room):
    full = dressed(room)
    stools = [item for item in full.contents if item.thing == SEATS["island"].thing]
    assert stools
    (island,) = full.placements
    for stool in stools:
        T = pose_matrix_of(stool)
        assert -T[:2, 0] @ (np.array(island.position[:2]) - T[:2, 3]) > 0.2
        to_stool = pose_matrix_of(island)[:3, :3].T @ (T[:3, 3] - island.position)
        assert to_stool[0] > -0.3  # drawers open towards -x


def test_a_robot_stands_beside_the_chair_of_a_desk(room: Room, tmp_path: Path):
    boards = [((-0.35, y, -0.37), (0.35, y + 0.02, 0.35)) for y in (-0.7, 0.68)]
    body = solid_link("body", "base", [*boards, ((-0.35, -0.7, 0.35), (0.35, 0.7, 0.37))])
    package = SimPackage(name="desk", category="Table", visual="voxels", links=(body,), joints=())
    desk = replace(
        room.placements[0], id="desk_1", role="desk", package=write_package(package, tmp_path / "desk"),
        position=(2.0, 2.6, 0.372), size=(0.7, 1.4, 0.74), standing=((2.0, 1.9),),
    )  # fmt: skip
    full = stand_on_floor(replace(room, kind="office", placements=(desk,)))
    (chair,) = (item for item in full.contents if item.thing == "office_chair")
    ((x, y),) = full.placements[0].standing
    assert chair.position[1] < 2.3
    assert (0.0 < abs(x - 2.0) <= 0.5, y) == (True, 1.9)
    assert check_room(full) == ()


def test_a_low_table_stands_on_a_rug_with_what_is_on_it(room: Room):
    table = replace(room.placements[0], role="low table")
    high = corner(table.position + np.array([0.0, 0.0, 0.8]))
    both = table, replace(table, id="lamp_1", role="lamp", support=table.id, position=high)
    full = decorate_room(replace(room, kind="living_room", placements=both))
    (rug,) = (each for each in full.fixtures if each.name == "rug")
    body = place_solid(full.placements[0]).boxes
    assert (body[:, 0, :2] > rug.low[:2]).all()
    assert (body[:, 1, :2] < rug.high[:2]).all()
    assert rug.high[2] < body[:, 0, 2].min() < rug.high[2] + 0.003
    for before, after in zip(both, full.placements, strict=True):
        assert after.position[2] - before.position[2] == pytest.approx(rug.high[2])
    assert check_room(replace(full, placements=full.placements[:1])) == ()


@pytest.mark.parametrize("side", [None, -1.0, 1.0])
def test_curtains_hang_on_both_sides_of_a_window_or_a_blind_above_it(room: Room, side: float | None):
    """Furniture beside the window leaves no room for one of the two."""
    x = (WINDOW.start + WINDOW.stop) / 2.0 + (side or 0.0) * (WINDOW.width / 2.0 + 0.3)
    low, high = along_wall(WINDOW.side, room.size, (x - 0.28, 0.0, 0.0), (x + 0.28, 0.5, 2.2))
    tall = Fixture(name="wardrobe", low=corner(low), high=corner(high), color=(0.5, 0.4, 0.3))
    dressed_room = decorate_room(
        replace(room, kind="bedroom", fixtures=room.fixtures + ((tall,) if side else ()))
    )
    hung = Counter(
        each.name.rpartition("_")[2] for each in dressed_room.fixtures if each.name.startswith("curtain")
    )
    assert hung == ({"blind": 1} if side else {"rod": 1, "left": 5, "right": 5})


@pytest.mark.parametrize(("shift", "kind"), [((0.0, 0.0, 0.01), "unsupported"), ((0.0, 0.4, 0.0), "overlap")])
def test_a_seat_that_floats_or_stands_in_the_way_is_found(room: Room, shift, kind):
    full = dressed(room)
    stool = next(item for item in full.contents if item.thing == "stool")
    x, y, _ = pose_matrix_of(stool)[:3, :3] @ [-shift[1], 0.0, 0.0]
    at = stool.position
    moved = replace(stool, position=(at[0] + x, at[1] + y, at[2] + shift[2]))
    broken = replace(full, contents=tuple(moved if item is stool else item for item in full.contents))
    assert kind in {problem.kind for problem in check_room(broken) if problem.id == stool.id}


def test_a_seat_where_a_robot_stands_is_found(room: Room):
    full = dressed(room)
    stool = next(item for item in full.contents if item.thing == "stool")
    island = replace(full.placements[0], standing=(stool.position[:2],))
    problems = check_room(replace(full, placements=(island,)))
    assert (stool.id, "standing") in {(problem.other, problem.kind) for problem in problems}


@pytest.mark.parametrize(("thickness", "free"), [(STEP - 1e-4, True), (STEP + 1e-4, False)])
def test_a_robot_drives_over_what_is_lower_than_a_centimetre(thickness: float, free: object):
    rug = Fixture(name="rug", low=(1.5, 1.5, 0.0), high=(2.5, 2.5, thickness), color=(0.5, 0.5, 0.5))
    bare, laid = (
        free_map(room, fixture_solids(room)) for room in (ROOM, replace(ROOM, fixtures=(*ROOM.fixtures, rug)))
    )
    assert bool((bare == laid).all()) == free


@pytest.mark.parametrize("thing", THINGS, ids=lambda thing: thing.name)
@pytest.mark.parametrize("end", ["low", "high"])
def test_things_stand_at_zero_within_their_size(thing, end):
    size = getattr(thing, end)
    points = np.concatenate([hull.vertices for hull in thing_hulls(thing.name, size)])
    assert points[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    assert points[:, 2].max() == pytest.approx(size[2], rel=0.02)
    assert (np.abs(points[:, :2]) <= np.array(size[:2]) / 2 + 1e-6).all()


def test_lamps_share_all_light_and_the_corner_is_not_behind_furniture(room: Room):
    full = dressed(room)
    lamps = find_lamps(full)
    assert sum(lamp.share for lamp in lamps) == pytest.approx(1.0)
    _, corner = find_views(full)
    wardrobe = Fixture(
        name="tall", low=(*np.array(corner.camera.position[:2]) - 0.2, 0.0),
        high=(*np.array(corner.camera.position[:2]) + 0.2, 2.0), color=(0.5, 0.5, 0.5),
    )  # fmt: skip
    _, other = find_views(replace(full, fixtures=(*full.fixtures, wardrobe)))
    assert not np.allclose(other.camera.position, corner.camera.position)
    assert len(object_solids(full)) == 1


def test_scenes_with_things_on_the_floor_are_read_as_written(room: Room, tmp_path: Path):
    from envs.rooms.file import read_room, write_room

    full = dressed(room)
    assert read_room(write_room(full, tmp_path)) == full


def test_pictures_are_four_centimetres_apart():
    gaps = []
    for seed, depth in product(range(80), (1.7, 2.2)):
        hung = decorate_room(replace(ROOM, kind="living_room", seed=seed, size=(2.4, depth, 2.6))).fixtures
        frames = [one for one in hung if one.name.startswith("picture") and one.name.endswith("frame")]
        gaps += [
            max((np.array(a.low) - b.high).max(), (np.array(b.low) - a.high).max())
            for a, b in combinations(frames, 2)
            if a.name.split("_")[1] == b.name.split("_")[1]
        ]
    assert 0.04 - 1e-9 <= min(gaps) < 0.055
