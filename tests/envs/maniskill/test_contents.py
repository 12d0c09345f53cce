"""Contents of drawers and cupboards lie free inside and ride along; the check finds those that do not."""

import json
from dataclasses import replace
from itertools import combinations, product
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from box_drawer import box_drawer
from sample_packages import SAMPLE_PARTS, build_package, double_door_parts

from artigen.types import RoomKind
from envs.rooms.check import check_contents, check_room
from envs.rooms.compartments import (
    CLEARANCE,
    SIDE,
    cached_compartments,
    find_compartments,
    largest_free,
)
from envs.rooms.contents import LIFT, SPACING, fill_room
from envs.rooms.file import SceneFileError, read_room, room_json, write_room
from envs.rooms.footprints import cached_package
from envs.rooms.picture import item_surfaces
from envs.rooms.room import Item, Opening, Placement, Room, room_shell
from envs.rooms.solids import item_hulls, item_motion, item_solid
from envs.rooms.things import THINGS, thing_hulls, thing_solids
from sim_export.files.write import write_package
from sim_export.geometry.contacts import HullSet, signed_distances
from sim_export.geometry.hulls import box_hull
from sim_export.picture.render import surface_points

SIZE = (4.0, 3.5, 2.6)
STILL = np.eye(4)


@pytest.fixture(scope="module")
def empty(tmp_path_factory: pytest.TempPathFactory) -> Room:
    """A room with one cabinet of each sample, a drawer of the second open."""
    base = tmp_path_factory.mktemp("packages").resolve()
    placements = []
    for index, parts in enumerate((SAMPLE_PARTS, double_door_parts())):
        folder = write_package(build_package(parts), base / f"cabinet_{index}").resolve()
        bottom = min(
            float(hull.vertices[:, 2].min()) for link in cached_package(folder).links for hull in link.hulls
        )
        placements.append(
            Placement(
                id=f"cabinet_{index}", role="base cabinet", category="StorageFurniture", package=folder,
                position=(1.0 + 1.5 * index, SIZE[1] - 0.5, 0.002 - bottom),
                quat=(0.5**0.5, 0.0, 0.0, 0.5**0.5), size=(0.5, 0.8, 0.7),
                joints=(("joint_0", 0.2),) if index else (),
            )
        )  # fmt: skip
    entrance = Opening(side="front", start=1.5, width=0.9, height=2.0)
    return Room(
        kind="kitchen", seed=1, attempt=0, size=SIZE, entrance=entrance, standing_radius=0.0,
        fixtures=room_shell(SIZE, (entrance,), (0.9, 0.9, 0.9)), placements=tuple(placements),
    )  # fmt: skip


@pytest.fixture(scope="module")
def full(empty: Room) -> Room:
    return fill_room(empty, 1.0)


def nearest(first: HullSet, second: HullSet, reach: float) -> np.ndarray:
    """Distances below ``reach`` and the normals' z, one pair per row."""
    found = signed_distances(first, second, STILL, STILL, reach)
    return np.column_stack([found.distance, found.normal[:, 2]])


def test_contents_touch_nothing_but_the_floor_below_them(full):
    assert len(full.contents) >= 12
    assert {item.link for item in full.contents} == {
        place.link for entry in full.placements for place in cached_compartments(entry.package)
    }
    for item in full.contents:
        hulls = HullSet(hulls=item_hulls(item))
        for link in cached_package(full.placement(item.holder).package).links:
            pairs = nearest(hulls, HullSet(hulls=link.hulls), CLEARANCE - 1e-5)
            if link.name == item.link:
                assert len(pairs)
            for distance, up in pairs:
                assert link.name == item.link
                assert up == pytest.approx(-1.0, abs=1e-6)
                assert distance == pytest.approx(LIFT, abs=2e-5) or distance > LIFT
    assert check_room(full) == ()


def test_contents_keep_their_distance_from_each_other(full):
    for one, other in combinations(full.contents, 2):
        if one.holder == other.holder and one.link == other.link:
            first, second = (HullSet(hulls=item_hulls(item)) for item in (one, other))
            assert not len(nearest(first, second, SPACING - 1e-4))


def test_the_seed_selects_the_contents_and_the_share_how_many_of_them(empty, full):
    assert fill_room(empty, 1.0) == full
    assert fill_room(empty, 0.0) == empty
    assert fill_room(replace(empty, seed=2), 1.0).contents != full.contents
    half = {replace(item, id="") for item in fill_room(empty, 0.5).contents}
    assert half < {replace(item, id="") for item in full.contents}


def change(room: Room, item: Item, **values) -> tuple[tuple[str, str, str], ...]:
    """Kind and names of the problems of a room after a change of one item."""
    contents = tuple(replace(entry, **values) if entry is item else entry for entry in room.contents)
    return tuple(
        (problem.kind, problem.id, problem.other)
        for problem in check_contents(replace(room, contents=contents))
    )


def first_in(room: Room, kind: str) -> tuple[Item, Item]:
    """The first two items in one compartment of a kind in the first cabinet."""
    holder = room.placements[0]
    links = [place.link for place in cached_compartments(holder.package) if place.kind == kind]
    one, other, *_ = [item for item in room.contents if item.holder == holder.id and item.link == links[0]]
    return one, other


def test_the_check_finds_an_item_in_a_wall_in_another_item_and_in_the_air(full):
    one, other = first_in(full, "drawer")
    x, y, z = one.position
    place = next(place for place in cached_compartments(full.placements[0].package) if place.link == one.link)
    assert ("overlap", one.id, one.holder) in change(full, one, position=(x, place.high[1] + 0.005, z))
    assert ("overlap", one.id, other.id) in change(full, one, position=other.position)
    assert change(full, one, position=(x, y, z + 0.0014)) == ()  # 1.9 mm above its floor, and 2.1 mm
    assert change(full, one, position=(x, y, z + 0.0016)) == (("unsupported", one.id, one.holder),)


def test_the_check_finds_items_in_the_way_that_touch_nothing_at_rest(full):
    shelved, _ = first_in(full, "shelf")
    x, y, z = shelved.position
    front = change(full, shelved, position=(x - 0.6, y, z))  # in front of the closed door
    assert ("sweep", shelved.holder, shelved.id) in front
    assert all(kind != "overlap" for kind, *_ in front)
    riding, _ = first_in(full, "drawer")  # behind the closed door, but as if a drawer moved it
    others = tuple(item for item in full.contents if item not in (shelved, riding))
    rest = replace(full, contents=(*others, riding))
    found = change(rest, riding, position=shelved.position, size=shelved.size, thing=shelved.thing)
    assert ("sweep", riding.id, riding.holder) in found
    assert all(kind != "overlap" for kind, *_ in found)


def test_a_scene_file_holds_the_contents_and_is_unchanged_without_them(empty, full, tmp_path):
    path = write_room(full, tmp_path)
    assert read_room(path) == full
    value, bare = json.loads(path.read_text()), json.loads(room_json(empty, tmp_path))
    assert {key for key in value if key not in bare} == {"contents"}
    value["contents"][0]["holder"] = "attic"
    path.write_text(json.dumps(value))
    with pytest.raises(SceneFileError, match="lies in 'attic'"):
        read_room(path)


def test_pictures_show_contents_where_the_open_drawer_has_them(full):
    moved = [item for item in full.contents if item.holder == "cabinet_1" and item.link == "link_0"]
    assert moved
    for item in moved:
        T = item_motion(full, item)
        points = surface_points(item_surfaces(full, item))
        solid = item_solid(item, T).hulls.vertices
        assert np.allclose(np.ptp(points, axis=0), np.ptp(solid, axis=0))
        assert np.allclose(points.min(axis=0), solid.min(axis=0))
        shut = replace(full, placements=tuple(replace(entry, joints=()) for entry in full.placements))
        assert np.linalg.norm((T - item_motion(shut, item))[:3, 3]) == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("name", "least"),
    [("depth", 0.1 + 2 * 0.005), ("rim", 0.025), ("room", 0.035 + 0.005)],
)
def test_a_drawer_needs_floor_walls_and_space_above(name, least):
    (found,) = find_compartments(box_drawer(**{name: least + 1e-3}))
    assert found.link == "slide"
    assert find_compartments(box_drawer(**{name: least - 1e-3})) == ()


def test_a_compartment_ends_below_everything_that_it_passes_on_its_way_out():
    package = box_drawer()
    slide, body = package.links
    bar = box_hull(np.array([-0.1, 0.0, 0.08]), np.array([-0.09, 0.3, 0.3]))  # in front of the closed drawer
    barred = replace(package, links=(slide, replace(body, hulls=(*body.hulls, bar))))
    (free,), (low,) = find_compartments(package), find_compartments(barred)
    assert (free.high[2], low.high[2]) == pytest.approx((0.105, 0.075))
    assert (free.low, free.high[:2]) == (low.low, low.high[:2])
    assert free.low == pytest.approx((0.005, 0.005, 0.01))
    assert free.high[:2] == pytest.approx((0.295, 0.295))


def test_the_largest_free_rectangle_is_that_of_an_exhaustive_search():
    rng = np.random.default_rng(0)
    cells = 7
    for _ in range(40):
        corner = rng.integers(0, cells, size=(4, 2))
        taken = np.stack([corner, np.minimum(corner + rng.integers(1, 4, size=(4, 2)), cells)], axis=1)
        best = 0
        for x0, y0 in product(range(cells), repeat=2):
            for x1, y1 in product(range(x0 + 1, cells + 1), range(y0 + 1, cells + 1)):
                meets = (np.minimum(taken[:, 1], (x1, y1)) > np.maximum(taken[:, 0], (x0, y0))).all(axis=1)
                best = max(best, 0 if meets.any() else (x1 - x0) * (y1 - y0))
        unit = 2 * SIDE
        free = largest_free(np.array([[0.0, 0.0], [cells, cells]]) * unit, taken * unit)
        assert free is not None
        assert np.prod(free[1] - free[0]) == pytest.approx(best * unit**2)


@pytest.mark.parametrize("thing", THINGS, ids=lambda thing: thing.name)
def test_a_thing_stands_in_its_box(thing):
    for size in (thing.low, thing.high):
        points = np.concatenate([hull.vertices for hull in thing_hulls(thing.name, size)])
        assert points[:, 2].min() == pytest.approx(0.0, abs=1e-9)
        assert points[:, 2].max() == pytest.approx(size[2], abs=1e-3)
        assert (np.abs(points[:, :2]).max(axis=0) < np.array(size[:2]) / 2 + 2e-3).all()
        assert all(color < 2 for _, color in thing_solids(thing.name, size))


def test_every_kind_of_room_has_things_for_drawers_shelves_and_tops():
    places = {place for thing in THINGS for place in thing.where}
    wanted = {f"{kind} {place}" for kind in get_args(RoomKind) for place in ("drawer", "shelf", "top")}
    assert places == wanted | {"fridge"}
    with pytest.raises(ValueError, match="expected one of cup"):
        thing_solids("unicorn", (0.1, 0.1, 0.1))


@pytest.mark.sim
def test_contents_ride_along_when_drawers_open_and_close(full, tmp_path: Path):
    """All drawers open to nine tenths in a second, and close in another."""
    gym = pytest.importorskip("gymnasium")
    torch = pytest.importorskip("torch")
    pytest.importorskip("mani_skill")
    import envs  # noqa: F401 - registers the environments

    room = replace(full, placements=tuple(replace(entry, joints=()) for entry in full.placements))
    env = gym.make(
        "ArtiGen-Room-v1", scenes=write_room(room, tmp_path), robot_uids="panda", obs_mode="state",
        sim_backend="physx_cpu", render_backend="none", reward_mode="none",
    )  # fmt: skip
    env.reset(seed=0)
    furnished = env.unwrapped.furnished
    drives = []
    for entry in room.placements:
        package, articulation = cached_package(entry.package), furnished.placed[0][entry.id]
        drawers = {link.name for link in package.links if link.label == "drawer"}
        upper = {joint.name: joint.upper for joint in package.joints if joint.child in drawers}
        joints = [joint for joint in articulation.active_joints if joint.name in upper]
        for joint in joints:
            joint.set_drive_properties(stiffness=1e4, damping=1e3)
        drives.append((articulation, joints, torch.tensor([[upper[joint.name] for joint in joints]])))

    def move_to(shares: np.ndarray) -> Room:
        """Moves all drawers through shares of their ranges; returns the room as it then is."""
        for share in shares:
            for articulation, joints, upper in drives:
                articulation.set_joint_drive_targets(float(share) * upper, joints)
            env.unwrapped.scene.step()
        now = []
        for entry in room.placements:
            articulation = furnished.placed[0][entry.id]
            names = [joint.name for joint in articulation.active_joints]
            qpos = articulation.get_qpos()[0].tolist()
            now.append(replace(entry, joints=tuple(zip(names, qpos, strict=True))))
        return replace(room, placements=tuple(now))

    way = 0.45 * (1.0 - np.cos(np.linspace(0.0, np.pi, 100)))
    for shares, reached in ((way, 0.9), (way[::-1], 0.0)):
        now = move_to(shares)
        for articulation, joints, upper in drives:
            qpos = articulation.get_qpos()[0, [articulation.active_joints.index(joint) for joint in joints]]
            assert torch.allclose(qpos / upper[0], torch.full_like(qpos, reached), atol=0.05)
        for item in room.contents:
            actor = furnished.contents[0][item.id]
            assert float(actor.mass[0]) == pytest.approx(item.mass, rel=0.01)
            place = np.linalg.solve(item_motion(now, item), [*actor.pose.p[0].tolist(), 1.0])[:3]
            moved = np.abs(place - item.position)
            assert moved[:2].max() < 0.03, item
            assert moved[2] < 0.003, item
    env.close()
