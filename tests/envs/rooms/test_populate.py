"""Furnished rooms: what they promise holds on the hulls, and a broken promise is found."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from box_furniture import FURNITURE, Furniture, build_furniture, write_proven
from hypothesis import given
from hypothesis import strategies as st

from artigen.api.scene import SceneSettings, furnish_room
from artigen.errors import ArtigenError
from artigen.shapes.families import choose_suite
from artigen.types import RoomKind
from envs.rooms import picture
from envs.rooms.ajar import open_some
from envs.rooms.arrange import Plan, fits
from envs.rooms.catalogue import Entry, PopulateError, read_catalogue
from envs.rooms.check import check_room
from envs.rooms.choose import Offer, Wall, choose_units, order_units
from envs.rooms.file import SceneFileError, read_room, write_room
from envs.rooms.footprints import (
    bounds_of,
    cached_package,
    carries,
    is_level,
    measure_footprint,
    read_footprint,
)
from envs.rooms.furnish import place_group
from envs.rooms.map import label_regions, start_place, way_to
from envs.rooms.openings import find_openings
from envs.rooms.pieces import Boxes
from envs.rooms.populate import PopulateConfig, choose_filler_color, populate
from envs.rooms.recipes import BASE, KITCHEN, RANGE, RECIPES, WINDOWS, Share
from envs.rooms.room import (
    SIDES,
    THICKNESS,
    Opening,
    Room,
    along_wall,
    from_wall,
    pose_matrix_of,
    room_shell,
    wall_length,
)
from envs.rooms.runs import Chooser, draw_shortlists
from envs.rooms.solids import fixture_solids, place_solid
from envs.rooms.sweeps import opening_joints, sweep_boxes, sweep_joint
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull
from sim_export.package import Hull

pytestmark = pytest.mark.slow

ROOMS: tuple[tuple[RoomKind, int], ...] = (
    ("kitchen", 0),
    ("kitchen", 1),
    ("office", 0),
    ("bedroom", 1),
    ("bathroom", 0),
    ("workshop", 0),
    ("living_room", 0),
    ("hall", 0),
    ("laundry", 0),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("packages")
    for kind in FURNITURE:
        write_proven(kind, out)
    write_proven(Furniture(name="broken", category="Oven", size=(0.6, 0.6, 0.9)), out, "fail")
    return out


@pytest.fixture(scope="module")
def rooms(folder: Path) -> dict[tuple[RoomKind, int], Room]:
    catalogue = read_catalogue(folder)
    return {(kind, seed): populate(kind, seed, catalogue) for kind, seed in ROOMS}


@pytest.mark.parametrize("key", ROOMS)
def test_a_room_keeps_its_promises(rooms, key):
    room = rooms[key]
    assert RECIPES[room.kind].least <= len(room.placements) <= 30
    assert check_room(room) == ()
    assert len({placement.id for placement in room.placements}) == len(room.placements)
    assert len({fixture.name for fixture in room.fixtures}) == len(room.fixtures)
    categories = {placement.role for placement in room.placements}
    assert {role.name for role in RECIPES[room.kind].needed} <= categories
    assert all(
        placement.category != "Oven" or placement.package.name == "range" for placement in room.placements
    )


def test_the_same_seed_gives_the_same_room_and_another_seed_another(folder, rooms):
    catalogue = read_catalogue(folder)
    assert populate("kitchen", 0, catalogue) == rooms["kitchen", 0]
    assert rooms["kitchen", 0].placements != rooms["kitchen", 1].placements


def test_backs_are_to_the_walls_and_fronts_to_the_room(rooms):
    room = rooms["kitchen", 0]
    for placement in room.placements:
        if placement.role not in ("base cabinet", "fridge", "range", "wall cabinet"):
            continue
        front = pose_matrix_of(placement)[:2, :3] @ np.array([-1.0, 0.0, 0.0])
        ahead = np.array(placement.position[:2]) + front
        center = np.array(room.size[:2]) / 2
        assert (
            np.linalg.norm(ahead - center) < np.linalg.norm(np.array(placement.position[:2]) - center) + 1e-9
        )
        back = np.array(placement.position[:2]) - front * placement.size[0] / 2
        assert min(*back, *(np.array(room.size[:2]) - back)) < 0.2


def test_what_stands_on_something_is_where_its_top_is(rooms):
    stacked = [
        (room, placement)
        for room in rooms.values()
        for placement in room.placements
        if placement.support is not None
    ]
    assert stacked
    for room, placement in stacked:
        below = [place_solid(one).boxes for one in room.placements if one.id == placement.support]
        slabs = [one for one in fixture_solids(room) if one.id.startswith(f"{placement.support}_")]
        box = bounds_of(np.concatenate([*below, *(slab.boxes for slab in slabs)]))
        above = placement.position[2] - placement.size[2] / 2 - box[1, 2]
        assert above == pytest.approx(4e-4, abs=5e-5)
        at = np.array(placement.position[:2])
        assert (at > box[0, :2]).all()
        assert (at < box[1, :2]).all()


def test_wall_cabinets_hang_a_metre_and_45_above_the_floor(rooms):
    hung = [entry for room in rooms.values() for entry in room.placements if entry.role == "wall cabinet"]
    assert hung
    for placement in hung:
        assert placement.position[2] - placement.size[2] / 2 == pytest.approx(1.45, abs=1e-4)


def move(room: Room, name: str, shift: tuple[float, float, float]) -> Room:
    """The room with one object pushed along in the room's frame."""
    moved = [
        replace(entry, position=tuple(np.add(entry.position, shift))) if entry.id == name else entry
        for entry in room.placements
    ]
    return replace(room, placements=tuple(moved))


def kinds_of(room: Room, name: str) -> set[str]:
    return {problem.kind for problem in check_room(room) if name in (problem.id, problem.other)}


def test_the_check_finds_objects_in_walls_and_in_each_other(rooms):
    room = rooms["kitchen", 0]
    fridge = room.placement("fridge_1")
    back = pose_matrix_of(fridge)[:3, 0]
    assert {"overlap", "outside"} <= kinds_of(move(room, "fridge_1", tuple(0.05 * back)), "fridge_1")
    other = next(entry for entry in room.placements if entry.role == "base cabinet")
    onto = tuple(np.subtract(other.position, fridge.position) * [1, 1, 0])
    assert "overlap" in kinds_of(move(room, "fridge_1", onto), "fridge_1")


def test_the_check_finds_a_blocked_door_that_overlaps_nothing_at_rest(rooms):
    room = rooms["kitchen", 0]
    fridge = room.placement("fridge_1")
    front = -pose_matrix_of(fridge)[:3, 0]
    blocker = next(entry for entry in room.placements if entry.role == "base cabinet")
    # Its middle 0.15 m in front of the fridge's door, clear of the closed one.
    place = np.array(fridge.position) + front * (fridge.size[0] / 2 + 0.15 + max(blocker.size[:2]) / 2)
    shift = place - np.array(blocker.position)
    seeded = move(room, blocker.id, (shift[0], shift[1], 0.0))
    found = [
        problem for problem in check_room(seeded) if problem.id == "fridge_1" and problem.other == blocker.id
    ]
    assert {"sweep", "standing"} <= {problem.kind for problem in found}
    assert not any(problem.kind == "overlap" for problem in found)
    assert all(problem.depth > 0.01 for problem in found)
    assert any("fridge_1" in problem.message and "joint_0" in problem.message for problem in found)


def test_the_check_is_exact_to_less_than_a_millimetre(rooms, folder):
    """A plank at the reach of a door, and just beyond it."""
    room = rooms["kitchen", 0]
    package = cached_package(folder / "fridge")
    joint = opening_joints(package)[0]
    arm = np.array([0.018, 0.7 - 0.006])
    reach = np.linalg.norm(arm)
    fridge = replace(
        room.placement("fridge_1"), position=(2.0, 2.0, 0.903), quat=(1.0, 0.0, 0.0, 0.0), standing=()
    )
    assert joint.upper > np.pi / 2
    for gap, blocked in ((1.5e-3, False), (-0.5e-3, True)):
        edge = 2.0 + float(joint.origin[0]) - float(reach) - gap
        plank = replace(room.fixtures[0], name="plank", low=(edge - 0.1, 1.0, 0.5), high=(edge, 3.0, 0.6))
        small = replace(room, placements=(fridge,), fixtures=(plank,), contents=(), standing_radius=0.0)
        assert [problem.kind for problem in check_room(small)] == (["sweep"] if blocked else [])


def test_a_robot_starts_near_the_entrance_on_free_floor(rooms):
    for room in rooms.values():
        x, y = start_place(room)
        assert y < 1.0
        assert room.entrance.start - 0.3 < x < room.entrance.start + room.entrance.width + 0.3
    assert way_to(np.array([[False, True]]), (0.025, 0.075)) == pytest.approx(0.0)


def test_a_walled_off_place_cannot_be_reached(rooms):
    room = rooms["bedroom", 1]
    width, depth, _ = room.size
    screen = replace(room.fixtures[0], name="screen", low=(0, 0.95, 0.001), high=(width, 0.97, 2.0))
    problems = check_room(replace(room, fixtures=(*room.fixtures, screen)))
    assert any(problem.kind == "unreachable" for problem in problems)
    assert label_regions(np.array([[1, 0, 1], [1, 0, 0]], dtype=bool)).max() == 2
    assert depth > 1.0


def test_boxes_of_a_sweep_hold_every_pose_of_it(folder):
    package = cached_package(folder / "wardrobe")
    for joint in opening_joints(package):
        sweep = sweep_joint(package, joint)
        boxes, columns = sweep_boxes(package, sweep, np.eye(4))
        slabs = measure_footprint(package).sweeps
        low, high = slabs[:, 0].min(axis=0), slabs[:, 1].max(axis=0)
        fine = sweep_joint(package, replace(joint, upper=joint.upper * 0.731))
        for column, (link, hull) in enumerate(columns):
            points = package.links[link].hulls[hull].vertices @ fine.T[-1, link, :3, :3].T
            points = points + fine.T[-1, link, :3, 3]
            step = int(0.731 * (len(sweep.T) - 1))
            box = boxes[step, column]
            assert (points >= box[0] - 1e-9).all()
            assert (points <= box[1] + 1e-9).all()
            assert (points >= low - 1e-9).all()
            assert (points <= high + 1e-9).all()


def test_points_on_a_top():
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    points = np.array([[0.5, 0.5], [1.2, 0.5], [1.0, 1.0]])
    assert carries((square,), points).tolist() == [True, False, True]


def test_a_scene_file_survives_a_round_trip_and_a_move(rooms, folder, tmp_path):
    room = open_some(rooms["office", 0], 0.5)
    assert any(placement.joints for placement in room.placements)
    path = write_room(room, tmp_path / "here")
    assert read_room(path) == room
    assert read_room(tmp_path / "here") == room == read_room(str(tmp_path / "here"))
    value = json.loads(path.read_text())
    assert value["version"] == 1
    assert not any(Path(entry["package"]).is_absolute() for entry in value["placements"])
    assert not list(path.parent.glob("*.partial"))
    assert write_room(read_room(path), tmp_path / "here").read_text() == path.read_text()
    value["placements"][0]["package"] = "gone/away"
    path.write_text(json.dumps(value))
    with pytest.raises(SceneFileError, match=r"1 of \d+ packages are missing, .*gone/away"):
        read_room(path)
    path.write_text(json.dumps(value | {"version": 99}))
    with pytest.raises(SceneFileError, match="version 1"):
        read_room(path)


@pytest.mark.parametrize("wrong", [3, None, ["a"]])
def test_a_provenance_that_is_no_text_is_named_by_its_key(folder, tmp_path, wrong):
    path = write_room(populate("kitchen", 3, read_catalogue(folder)), tmp_path)
    written = json.loads(path.read_text())
    for owner, entry in (("the room", written), (written["placements"][1]["id"], written["placements"][1])):
        kept = entry["provenance"]
        entry["provenance"] = kept | {"origin": wrong}
        path.write_text(json.dumps(written))
        with pytest.raises(SceneFileError, match=f"'provenance' of {owner}: 'origin' is .*, expected a text"):
            read_room(path)
        entry["provenance"] = wrong
        path.write_text(json.dumps(written))
        with pytest.raises(SceneFileError, match=f"'provenance' of {owner} is .*, expected an object"):
            read_room(path)
        entry["provenance"] = kept


@pytest.mark.parametrize("depth", [1, 2, 3])
def test_packages_are_found_at_any_depth_but_not_in_hidden_folders(tmp_path, depth):
    inner = tmp_path.joinpath(*(["sub"] * (depth - 1)))
    write_proven(FURNITURE[0], inner)
    write_proven(FURNITURE[1], tmp_path / ".hidden")
    assert [entry.name for entry in read_catalogue(tmp_path).entries] == [FURNITURE[0].name]


def test_open_doors_touch_nothing(rooms):
    room = open_some(rooms["kitchen", 1], 0.6)
    opened = sum(len(placement.joints) for placement in room.placements)
    assert opened >= 3
    assert not [problem for problem in check_room(room) if problem.kind in ("overlap", "outside")]
    assert open_some(rooms["kitchen", 1], 0.0) == rooms["kitchen", 1]


def test_less_can_be_asked_for(folder):
    cfg = PopulateConfig(sweeps="any", standing_radius=0.0, width=4.2, depth=3.8)
    room = populate("kitchen", 5, read_catalogue(folder), cfg)
    assert room.size[:2] == (4.2, 3.8)
    assert not any(placement.standing for placement in room.placements)
    assert not [problem for problem in check_room(room) if problem.kind == "overlap"]


def test_a_run_is_as_full_as_its_wall_allows():
    entry = read_catalogue_entry("base", (0.6, 0.6, 0.88))
    stove = read_catalogue_entry("stove", (0.62, 0.6, 0.9))
    shares = (Share(role=BASE, least=1, wanted=3, most=9), Share(role=RANGE, least=1, wanted=1, most=1))
    offers = [Offer(share=0, entry=entry), Offer(share=1, entry=stove)]
    rng = np.random.default_rng(0)
    (units,) = choose_units(offers, shares, [Wall(length=3.1)], rng) or [[]]
    assert len(units) == 5 - 0
    assert sum(unit.share == 1 for unit in units) == 1
    assert choose_units(offers, shares, [Wall(length=1.0)], rng) is None
    tall = Offer(share=0, entry=replace(entry, size=(0.6, 0.6, 1.9)))
    ordered = order_units([offers[0], tall, offers[0], offers[0]], rng, corners=[0])
    assert ordered[-1] is tall


def read_catalogue_entry(name: str, size: tuple[float, float, float]):

    return Entry(
        folder=Path(name), name=name, category="StorageFurniture", size=size, kinds=(), provenance=()
    )


def test_errors_name_what_was_found_and_what_was_needed(folder, tmp_path):
    with pytest.raises(PopulateError, match="no such folder"):
        read_catalogue(tmp_path / "nowhere")
    with pytest.raises(PopulateError, match="holds no package"):
        read_catalogue(tmp_path)
    write_proven(FURNITURE[0], tmp_path / "failed", "fail")
    with pytest.raises(PopulateError, match=r"1 packages and none .* base_a \(failed V203\)"):
        read_catalogue(tmp_path / "failed")
    write_proven(FURNITURE[1], tmp_path / "few")
    with pytest.raises(PopulateError, match=r"fridge .*; range .* that the kitchen needs; it has 1 Storage"):
        populate("kitchen", 0, read_catalogue(tmp_path / "few"))
    small = PopulateConfig(width=2.0, depth=1.8, attempts=2)
    with pytest.raises(PopulateError, match=r"no kitchen of 2 x 1.8 m .* needed are 10"):
        populate("kitchen", 0, read_catalogue(folder), small)
    with pytest.raises(ValueError, match="least 12, most 3 objects"):
        PopulateConfig(least=12, most=3)


def test_no_more_objects_than_asked_for(folder):
    room = populate("kitchen", 2, read_catalogue(folder), PopulateConfig(least=8, most=11))
    assert 8 <= len(room.placements) <= 11


def test_pictures_show_the_room(rooms, monkeypatch):
    for name, value in (("WIDTH", 160), ("HEIGHT", 120), ("SCALE", 40.0)):
        monkeypatch.setattr(picture, name, value)
    for room in (rooms["kitchen", 0], rooms["bedroom", 1]):
        view, plan = picture.draw_room(room), picture.draw_plan(room)
        assert view.shape == (120, 160, 3)
        assert view.std() > 15
        assert plan.shape[1] == int((room.size[0] + 0.6) * 40)
        assert len(np.unique(plan.reshape(-1, 3), axis=0)) > 20


def test_furnishing_writes_scene_and_plan(folder, tmp_path):
    cfg = SceneSettings(ajar=0.3, contents=1.0)
    made = furnish_room("bedroom", tmp_path / "room", 1, folder, cfg, pictures="plan")
    room, said = read_room(tmp_path / "room"), made.describe()
    assert f"{len(room.placements)} objects" in said
    assert f"with {len(room.contents)} loose things" in said
    assert {"wardrobe_1"} <= {item.holder for item in room.contents}
    with pytest.raises(ArtigenError, match=r"contents 1\.5: expected .* shares from 0 to 1"):
        furnish_room("bedroom", tmp_path / "room", 1, folder, SceneSettings(contents=1.5), pictures="none")
    assert (tmp_path / "room" / "plan.png").stat().st_size > 5000
    assert not (tmp_path / "room" / "room.png").exists()
    assert dict(room.provenance)["packages"].startswith(f"{len(FURNITURE)} proven packages")
    assert room.placements[0].provenance[0] == ("source", f"a box called {room.placements[0].package.name}")


def test_panels_have_the_colour_of_the_suite_of_most_units(folder, tmp_path):
    entries = read_catalogue(folder).entries
    suite = (("family", "shaker"), ("suite", "0"))
    suited = [replace(entry, provenance=(*entry.provenance, *suite)) for entry in entries]
    front = choose_suite("shaker", 0).finishes["furniture"]["front"].color
    more, fewer = len(entries) // 2 + 1, len(entries) // 2 - 1
    assert choose_filler_color([*suited[:more], *entries[more:]]) == front
    assert choose_filler_color([*suited[:fewer], *entries[fewer:]]) != front
    assert choose_filler_color(entries) != front
    with pytest.raises(ArtigenError, match="family shaker with packages"):
        furnish_room("kitchen", tmp_path / "room", 0, folder, SceneSettings(family="shaker"), pictures="none")


def test_an_unknown_look_of_a_room_is_refused_before_anything_is_drawn(tmp_path):
    with pytest.raises(ArtigenError, match=r"family 'shakr' is not known, .*did you mean shaker"):
        furnish_room("kitchen", tmp_path / "room", cfg=SceneSettings(family="shakr"))
    assert not (tmp_path / "room").exists()


@pytest.mark.parametrize("legs", [False, True])
@pytest.mark.parametrize("covered", [False, True])
def test_legs_and_rails_of_a_cabinet_are_not_level(tmp_path, legs, covered):
    package = build_furniture(next(item for item in FURNITURE if item.name == "hung"))
    body = package.links[-1]
    top = max(range(len(body.hulls)), key=lambda k: body.hulls[k].vertices[:, 2].min())
    body = replace(body, hulls=body.hulls if covered else body.hulls[:top] + body.hulls[top + 1 :])
    corners = np.concatenate([hull.vertices for hull in body.hulls])
    low, high = corners.min(axis=0), corners.max(axis=0)
    feet = [
        box_hull(np.array([x, y, low[2] - 0.1]), np.array([x + 0.03, y + 0.03, low[2]]))
        for x in (low[0], high[0] - 0.03)
        for y in (low[1], high[1] - 0.03)
    ]
    body = replace(body, hulls=(*body.hulls, *(feet if legs else ())))
    folder = write_package(replace(package, links=(*package.links[:-1], body)), tmp_path / "hung")
    assert is_level(folder, "bottom") != legs
    assert is_level(folder, "top") == covered


def test_hulls_of_the_test_furniture_are_closed():
    package = build_furniture(FURNITURE[0])
    assert all(isinstance(hull, Hull) for link in package.links for hull in link.hulls)


def _walls_behind(room, placement):
    """Walls in which the middle of a window lies."""
    T, body = pose_matrix_of(placement), read_footprint(placement.package).body
    middle = T[:3, :3] @ body.mean(axis=0) + T[:3, 3]
    middle += T[:3, 0] * (body[1, 0] - body.mean(axis=0)[0] - 0.01)
    assert not (np.zeros(2) < middle[:2]).all() or not (middle[:2] < room.size[:2]).all()
    walls = [fixture for fixture in room.fixtures if fixture.name.startswith("wall")]
    return [wall.name for wall in walls if (wall.low < middle).all() and (middle < wall.high).all()]


@given(
    holes=st.lists(
        st.tuples(st.floats(0.0, 3.0), st.floats(0.05, 1.5), st.floats(0.0, 1.5), st.floats(0.05, 1.0)),
        max_size=4,
    ),
    side=st.sampled_from(SIDES),
)
def test_walls_and_openings_fill_a_wall_without_overlap(holes, side):
    rounded = [[round(value, 5) for value in hole] for hole in holes]  # as corners of walls are
    openings = [Opening(side=side, start=a, width=w, bottom=b, height=h) for a, w, b, h in rounded]
    size = (4.0, 5.0, 2.6)
    walls = [f for f in room_shell(size, openings, (1, 1, 1)) if f.name.startswith(f"wall_{side}")]
    boxes = from_wall(side, size, np.array([[f.low, f.high] for f in walls]))
    points = np.random.default_rng(0).uniform((0.0, 0.0), (wall_length(side, size), size[2]), (500, 2))
    inside = [
        sum(bool((box[0, [0, 2]] < point).all() and (point < box[1, [0, 2]]).all()) for box in boxes)
        for point in points
    ]
    cut = [
        any(hole.start < x < hole.stop and hole.bottom < z < hole.top for hole in openings) for x, z in points
    ]
    assert inside == [int(not hole) for hole in cut]


@pytest.mark.parametrize("side", SIDES)
def test_a_box_comes_back_from_a_wall(side):
    low, high, size = (0.5, -0.1, 0.2), (1.5, 0.3, 0.9), (4.0, 5.0, 2.6)
    box = along_wall(side, size, low, high)
    np.testing.assert_allclose(from_wall(side, size, box[None])[0], [low, high], atol=1e-12)


@pytest.mark.parametrize("side", SIDES)
def test_openings_follow_what_lies_in_a_wall(side):
    size = (4.0, 5.0, 2.6)
    sill, frame, lever = (
        along_wall(side, size, low, high)
        for low, high in (
            ((1.0, -0.09, 0.9), (2.0, 0.1, 0.92)),
            ((1.1, -0.09, 0.92), (1.9, 0.0, 1.9)),
            ((1.4, 0.01, 1.4), (1.5, 0.05, 2.2)),
        )
    )
    low, high = find_openings(np.stack([sill, frame, lever]), side, size)
    assert (low.start, low.stop, low.bottom, low.top) == pytest.approx((1.0, 2.0, 0.9, 0.92), abs=1e-3)
    assert (high.start, high.stop, high.bottom, high.top) == pytest.approx((1.1, 1.9, 0.92, 1.9), abs=1e-3)
    assert find_openings(lever[None], side, size) == ()


def test_windows_hang_in_walls_and_small_things_stand_on_their_roles(rooms):
    seen = set()
    for room in rooms.values():
        roles = {placement.id: placement.role for placement in room.placements}
        for placement in room.placements:
            T = pose_matrix_of(placement)
            low = float(T[2, 3] + read_footprint(placement.package).body[0, 2])
            if placement.role == "window":
                assert low == pytest.approx(WINDOWS.height)
                assert placement.support is None
                assert _walls_behind(room, placement) == []
                seen.add("window")
            for share in RECIPES[room.kind].tops:
                if share.on and share.role.name == placement.role:
                    assert placement.support is not None
                    assert roles[placement.support] in share.on
                    seen.add(placement.role)
    assert {"window", "laptop"} <= seen


@pytest.mark.parametrize(
    ("away", "above", "free"),
    [
        (0.0, -1e-3, True),
        (0.0, 1e-3, False),
        (0.649, 0.5, False),
        (0.651, 0.5, True),
    ],
)
def test_what_is_before_a_window_is_lower_than_its_sill(folder, away, above, free):
    rng = np.random.default_rng(0)
    lists = draw_shortlists(KITCHEN, read_catalogue(folder), rng, 5, alike=False)
    chooser = Chooser(shortlists=lists, rng=rng, radius=0.0, sweeps="free", most=30)
    empty = Plan(size=(5.0, 4.0, 2.6), entrance=Opening(side="front", start=1.5, width=0.9, height=2.0))
    plan = place_group(empty, KITCHEN, WINDOWS, chooser, whole=True)
    assert plan is not None
    place = plan.places[0]
    assert place.side is not None
    assert WINDOWS.height is not None
    top = WINDOWS.height + above
    middle = from_wall(place.side, plan.size, place.boxes.bodies).mean(axis=(0, 1))[0]
    box = along_wall(place.side, plan.size, (middle, away, 0.0), (middle + 0.05, away + 0.05, top))
    none = np.zeros((0, 2, 3))
    sweeps = place.boxes.sweeps[-1:]  # without those of the leaf
    against = Boxes(bodies=none, sweeps=sweeps, stands=none)
    assert fits(empty, Boxes(bodies=box[None], sweeps=none, stands=none), against) == free


def test_a_door_fills_its_entrance_and_swings_into_the_room(rooms):
    for room in rooms.values():
        door, way = room.placement("door_1"), room.entrance
        low, high = place_solid(door).boxes[:, 0].min(axis=0), place_solid(door).boxes[:, 1].max(axis=0)
        assert (low[0], high[0]) == pytest.approx(
            (way.start + 0.003, way.start + way.width - 0.003), abs=1e-4
        )
        assert high[2] == pytest.approx(way.height - 0.003, abs=1e-4)
        assert low[1] < -THICKNESS
        assert high[1] > 0.0
        package = cached_package(door.package)
        sweep = sweep_joint(package, opening_joints(package)[0])
        assert sweep_boxes(package, sweep, pose_matrix_of(door))[0][..., 1, 1].max() > 0.7


def test_only_what_is_in_the_entrance_may_reach_out_of_the_room(rooms):
    room = rooms["kitchen", 0]
    assert "outside" in kinds_of(move(room, "door_1", (0.05, 0.0, 0.0)), "door_1")
    assert "outside" in kinds_of(move(room, "door_1", (0.0, -0.5, 0.0)), "door_1")
