"""Every way of loading a package gives the same object: what follows, pulls, rubs or hangs in a chain does so
in engines of one's own, the checks' environments, tasks, ManiSkill's stock tasks and rooms alike."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import mujoco
import numpy as np
import pytest
from folding_cupboard import draw_folding
from sample_packages import SAMPLE_PARTS, build_package
from screw_jar import screw_package

from artigen.shapes.draw import Wish, draw_shape
from envs.rooms.file import read_room, write_room
from envs.rooms.footprints import read_footprint
from envs.rooms.mjcf import write_room_mjcf
from envs.rooms.room import Opening, Placement, Room, room_shell
from envs.sim.friction import CHAIN_ITERATIONS
from envs.sim.load import load
from envs.sim.mujoco import compile_model
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull
from sim_export.package import SimPackage
from sim_export.reference import build_reference

pytest.importorskip("mani_skill")
import torch

pytestmark = pytest.mark.sim
CPU = {"sim_backend": "physx_cpu", "render_backend": "none", "obs_mode": "state"}
RATIO = 2.0
"""Radians of the door per metre of the drawer that it follows."""
OPENED = 0.2
"""Metres."""


@dataclass(frozen=True, kw_only=True)
class Way:
    """An object in some simulation: ``pose`` sets the coordinates of all joints that are not at rest, and
    ``step`` takes 0.05 s."""

    pose: Callable[[dict[str, float]], None]
    step: Callable[[], object]
    positions: Callable[[], dict[str, float]]


def linked_package() -> SimPackage:
    """A cabinet on a foot whose door follows its drawer, which a spring closes against its friction."""
    package = build_package(SAMPLE_PARTS)
    corners = np.concatenate([hull.vertices for link in package.links for hull in link.hulls])
    low = corners.min(axis=0)
    foot = box_hull(low - [0.0, 0.0, 0.03], [*corners.max(axis=0)[:2], low[2]])
    links = tuple(
        replace(link, hulls=(*link.hulls, foot)) if link.label == "base" else link for link in package.links
    )
    drawer, door, *others = package.joints
    drawer = replace(drawer, spring=2.0 * drawer.friction)
    door = replace(
        door, follows=drawer.name, ratio=RATIO, upper=RATIO * drawer.upper, friction=0.0, damping=0.0
    )
    return replace(package, links=links, joints=(drawer, door, *others), requires_open=())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_package(linked_package(), tmp_path_factory.mktemp("ways") / "cabinet")


@pytest.fixture(scope="module")
def folding(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cabinet with a folding door: a leaf that hangs on a leaf."""
    package = build_reference(draw_folding())
    return write_package(package, tmp_path_factory.mktemp("ways") / "folding")


def furnish(package: Path, at: Path, **joints: float) -> Path:
    """A room with one object."""
    size = (4.0, 3.5, 2.6)
    entrance = Opening(side="front", start=1.5, width=0.9, height=2.0)
    body = read_footprint(package).body
    placement = Placement(
        id="cabinet_0", role="base cabinet", category="StorageFurniture", package=package.resolve(),
        position=(1.5, 2.5, float(-body[0, 2]) + 0.002), quat=(0.5**0.5, 0.0, 0.0, 0.5**0.5),
        size=(0.5, 0.5, 0.5), joints=tuple(joints.items()),
    )  # fmt: skip
    room = Room(
        kind="kitchen", seed=0, attempt=0, size=size, entrance=entrance, standing_radius=0.3,
        fixtures=room_shell(size, (entrance,), (0.9, 0.9, 0.9)), placements=(placement,),
    )  # fmt: skip
    return write_room(room, at)


def make(name: str, package: Path, at: Path, **kwargs: Any) -> gym.Env:
    """A reset environment of ManiSkill: a room if its name says so, a task otherwise."""
    if name == "ArtiGen-Room-v1":
        room = furnish(package, at, **kwargs)
        env = gym.make(name, scenes=room, reward_mode="none", robot_uids="panda", **CPU)  # type: ignore[arg-type]
    else:
        env = gym.make(name, packages=str(package), validation="any", **CPU, **kwargs)  # type: ignore[arg-type]
    env.reset(seed=0)
    return env


def object_in(env: gym.Env) -> Any:
    """The articulation of an environment's object."""
    task: Any = env.unwrapped
    if hasattr(task, "furnished"):
        return task.furnished.placed[0]["cabinet_0"]
    return task.built[0] if hasattr(task, "built") else task._cabinets[0]


def led_by_joint_0(reset: Callable[[dict[str, float]], None]) -> Callable[[dict[str, float]], None]:
    """A reset that takes the leader's coordinate alone."""
    return lambda coordinates: reset({"joint_0": coordinates["joint_0"]})


def way_of_engine(engine: Any, package: Path) -> Way:
    simulation = load(package, engine)

    def step() -> None:
        for _ in range(5):
            simulation.step()

    return Way(pose=led_by_joint_0(simulation.reset), step=step, positions=simulation.positions)


def way_of_mujoco_room(package: Path, at: Path) -> Way:
    room = read_room(furnish(package, at))
    model = compile_model(write_room_mjcf(room, at))
    data = mujoco.MjData(model)
    names = [model.joint(index).name.removeprefix("cabinet_0/") for index in range(model.njnt)]

    def pose(coordinates: dict[str, float]) -> None:
        mujoco.mj_resetData(model, data)
        data.qpos[:] = [coordinates.get(name, 0.0) for name in names]

    return Way(
        pose=pose,
        step=lambda: mujoco.mj_step(model, data, round(0.05 / model.opt.timestep)),
        positions=lambda: dict(zip(names, data.qpos.tolist(), strict=True)),
    )


def way_of_actuate(package: Path) -> Way:
    env = gym.make("ArtiGen/Actuate-v0", package=package)
    env.reset(seed=0)
    loaded = env.unwrapped.loaded  # type: ignore[attr-defined]
    return Way(
        pose=led_by_joint_0(loaded.reset),
        step=lambda: env.unwrapped.step(np.zeros(1, np.float32)),
        positions=loaded.positions,
    )


def way_of_maniskill(env: gym.Env) -> Way:
    thing = object_in(env)
    names = [joint.name for joint in thing.active_joints]

    def positions() -> dict[str, float]:
        return dict(zip(names, thing.get_qpos()[0].tolist(), strict=True))

    def pose(coordinates: dict[str, float]) -> None:
        thing.set_qpos(torch.tensor([[coordinates.get(name, 0.0) for name in names]]))
        thing.set_qvel(torch.zeros((1, len(names))))

    rest = torch.zeros(env.unwrapped.single_action_space.shape)  # type: ignore[attr-defined]
    return Way(pose=pose, step=lambda: env.step(rest), positions=positions)


TASKS = ("ArtiGen-OpenPart-v1", "ArtiGen-OpenCabinetDrawer-v1", "ArtiGen-Room-v1")
WAYS = ("sapien", "mujoco", "scene.xml", "ArtiGen/Actuate-v0", *TASKS)


@pytest.fixture
def way(request: pytest.FixtureRequest, folder: Path, tmp_path: Path) -> Iterator[Way]:
    name = request.param
    if name in TASKS:
        env = make(name, folder, tmp_path, **({"part": "drawer"} if "OpenPart" in name else {}))
        yield way_of_maniskill(env)
        env.close()
    elif name == "scene.xml":
        yield way_of_mujoco_room(folder, tmp_path)
    elif "/" in name:
        yield way_of_actuate(folder)
    else:
        yield way_of_engine(name, folder)


@pytest.mark.parametrize("way", WAYS, indirect=True)
def test_the_spring_closes_the_drawer_and_the_door_follows_in_proportion(way: Way):
    way.pose({"joint_0": OPENED, "joint_1": RATIO * OPENED})
    for _ in range(40):
        way.step()
        now = way.positions()
        assert now["joint_1"] == pytest.approx(RATIO * now["joint_0"], abs=0.02)
    assert way.positions()["joint_0"] == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize("name", ["ArtiGen-OpenPart-v1", "ArtiGen-OpenCabinetDoor-v1", "ArtiGen-Room-v1"])
def test_a_folding_door_has_the_iterations_of_the_check(name: str, folding: Path, tmp_path: Path):
    env = make(name, folding, tmp_path)
    (engine,) = object_in(env)._objs
    assert engine.get_solver_position_iterations() == CHAIN_ITERATIONS
    checked = load(folding)
    assert checked.articulation.get_solver_position_iterations() == CHAIN_ITERATIONS
    env.close()


@pytest.mark.parametrize("name", TASKS)
def test_a_reset_puts_followers_where_their_leader_is(name: str, tmp_path: Path):
    """Also one that moves against its leader, and so has its leader's rest at its upper limit."""
    package = linked_package()
    drawer, door, *others = package.joints
    door = replace(door, axis=-door.axis, ratio=-RATIO, lower=-RATIO * drawer.upper, upper=0.0)
    against = write_package(replace(package, joints=(drawer, door, *others)), tmp_path / "against")
    extra = {"OpenPart": {"part": "drawer", "initial_open": 0.5}, "Room": {"joint_0": OPENED}}
    given = next((value for key, value in extra.items() if key in name), {})
    env = make(name, against, tmp_path / "room", **given)
    thing = object_in(env)
    now = dict(zip((joint.name for joint in thing.active_joints), thing.get_qpos()[0].tolist(), strict=True))
    assert now["joint_1"] == pytest.approx(-RATIO * now["joint_0"], abs=1e-5)
    assert (now["joint_0"] > 0.1) == bool(given)
    env.close()


@pytest.mark.parametrize("name", TASKS)
def test_an_object_stands_on_the_floor_or_its_plinth(name: str, folder: Path, tmp_path: Path):
    env = make(name, folder, tmp_path)
    (engine,) = object_in(env)._objs
    lowest = min(link.get_global_aabb_fast()[0, 2] for link in engine.links if link.collision_shapes)
    raised = env.unwrapped.drawn[0][0].raised if "OpenPart" in name else 0.0  # type: ignore[attr-defined]
    assert lowest == pytest.approx(raised, abs=3e-3)
    env.close()


def test_a_latch_that_stands_open_is_held_against_its_spring(tmp_path: Path):
    """A pedal bin, whose bucket is lifted while the pedal is down and the lid open."""
    package = build_reference(draw_shape("TrashCan", 0, Wish(style="pedal")))
    lid = next(joint for joint in package.joints if joint.follows is not None)
    pedal = next(joint for joint in package.joints if joint.name == lid.follows)
    bin_folder = write_package(package, tmp_path / "bin")
    env = make("ArtiGen-LiftPart-v1", bin_folder, tmp_path, part="any", latches="open")
    thing = object_in(env)
    names = [joint.name for joint in thing.active_joints]
    for _ in range(10):
        now = dict(zip(names, thing.get_qpos()[0].tolist(), strict=True))
        assert now[pedal.name] == pytest.approx(pedal.upper, rel=0.02)
        assert now[lid.name] == pytest.approx(lid.ratio * now[pedal.name], abs=0.01)
        assert float(thing.get_qvel().abs().max()) < 0.1
        env.step(torch.zeros(env.unwrapped.single_action_space.shape))  # type: ignore[attr-defined]
    env.close()


def test_a_cap_rises_on_its_thread_as_it_is_turned_in_a_room(tmp_path: Path):
    """By a centimetre per turn; the scene is stepped as any environment around it may step it."""
    env = make("ArtiGen-Room-v1", write_package(screw_package(), tmp_path / "jar"), tmp_path / "room")
    thing = object_in(env)
    (engine,) = thing._objs
    assert [joint.name for joint in thing.active_joints] == ["joint_0", "joint_0_travel"]
    carrier = next(link for link in engine.links if link.name.endswith("carrier"))
    for _ in range(300):
        carrier.add_force_torque([0.0, 0.0, 0.0], [0.0, 0.0, 0.021])
        env.unwrapped.scene.step()  # type: ignore[attr-defined]
        turn, travel = engine.qpos
        assert travel == pytest.approx(0.01 * turn / (2.0 * np.pi), abs=1e-3)
    assert turn > np.pi
    env.close()
