"""``ArtiGen-Room-v1``: a furnished room from scene.json in ManiSkill, and its scene builder.

The builder is registered as ``ArtiGenRoom``. Without a render device no visuals are created.
"""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import sapien
import torch
from mani_skill.agents.robots.fetch import FETCH_BASE_COLLISION_BIT, FETCH_WHEELS_COLLISION_BIT
from mani_skill.envs.sapien_env import BaseEnv
from mani_skill.sensors.camera import CameraConfig
from mani_skill.utils import sapien_utils
from mani_skill.utils.scene_builder import SceneBuilder
from mani_skill.utils.scene_builder.registration import register_scene_builder
from mani_skill.utils.structs import Actor, Articulation, Pose
from mani_skill.utils.structs.types import GPUMemoryConfig, SimConfig

from envs.goals.file import GOALS_FILE, read_goals
from envs.goals.goal import Goal, State, is_reached, start_room
from envs.goals.sample import GOALS, sample_goals
from envs.rooms.file import read_room
from envs.rooms.footprints import cached_package
from envs.rooms.map import start_place
from envs.rooms.room import Fixture, Room
from envs.rooms.solids import item_poses
from envs.rooms.views import find_lamps, find_views

from .load import load_robot, place_robot
from .mechanisms import mechanism_of
from .objects import TaskError
from .room_objects import load_fixture, load_item, load_placement

Rooms = str | Path | Sequence[str | Path]
AWAY = sapien.Pose(p=[0.0, -4.0, 0.0])
"""Initial position of the robot, outside of every room."""


def room_builder(scenes: Rooms) -> "type[RoomSceneBuilder]":
    """A scene builder class for some rooms, for environments that take a class, such as ManiSkill's own.

    Args:
        scenes: One scene.json (or its folder), or several to sample from.
    """
    given = [scenes] if isinstance(scenes, str | Path) else list(scenes)
    if not given:
        raise ValueError("scenes is an empty list; give at least one scene.json")
    rooms = [read_room(Path(path)) for path in given]
    return type("RoomSceneBuilder", (RoomSceneBuilder,), {"build_configs": rooms})


class RoomSceneBuilder(SceneBuilder):
    """Builds one of ``build_configs``, which are rooms, in every parallel scene.

    After building, ``rooms`` are the chosen ones, ``placed`` the articulations of each by id, ``contents``
    the loose things of each by id, ``starts`` the robot's start in each, and ``scene_objects`` the walls,
    floor and other fixtures.
    """

    build_configs: list[Room] | None = None

    def build(self, build_config_idxs: list[int] | None = None) -> None:
        """Builds fixtures and objects; raises `LoadError` if the engine loses a shape."""
        if not self.build_configs:
            raise ValueError("ArtiGenRoom has no rooms; make the builder with room_builder(scenes)")
        chosen = self.sample_build_config_idxs() if build_config_idxs is None else build_config_idxs
        count = self.env.num_envs
        self._covers = TemporaryDirectory()  # is removed with the builder
        self.rooms = [self.build_configs[chosen[index % len(chosen)]] for index in range(count)]
        self.placed: list[dict[str, Articulation]] = []
        self.contents: list[dict[str, Actor]] = []
        self.scene_objects, self.movable_objects, self.articulations = {}, {}, {}
        for index, room in enumerate(self.rooms):
            for fixture in room.fixtures:
                actor = self._build_fixture(fixture, index)
                self.scene_objects[actor.name] = actor
            built, loose = {}, {}
            for placement in room.placements:
                articulation = load_placement(self.scene, placement, f"{placement.id}-{index}", index)
                built[placement.id] = self.articulations[articulation.name] = articulation
            poses = item_poses(room)
            for item in room.contents:
                pose = Pose.create(sapien.Pose(poses[item.id]))
                actor = load_item(self.scene, item, pose, f"{item.id}-{index}", index)
                loose[item.id] = self.movable_objects[actor.name] = actor
            if count > 1:  # a state has one row per scene, and these objects exist in one of them
                for each in (*built.values(), *loose.values()):
                    self.env.remove_from_state_dict_registry(each)
            self.placed.append(built)
            self.contents.append(loose)
        self.starts = [start_place(room) for room in self.rooms]

    def initialize(self, env_idx: torch.Tensor, init_config_idxs: list[int] | None = None) -> None:
        """Sets all joints to their coordinates in the rooms and all contents to their places, at rest."""
        for index in env_idx.tolist():
            for placement in self.rooms[index].placements:
                articulation = self.placed[index][placement.id]
                wanted = dict(placement.joints)
                qpos = torch.tensor([[wanted.get(joint.name, 0.0) for joint in articulation.active_joints]])
                if qpos.numel():
                    mechanism = mechanism_of(articulation, cached_package(placement.package))
                    articulation.set_qpos(mechanism.complete(qpos).to(self.env.device))
                    articulation.set_qvel(torch.zeros_like(qpos, device=self.env.device))
            for name, pose in item_poses(self.rooms[index]).items():
                actor = self.contents[index][name]
                actor.set_pose(Pose.create(sapien.Pose(pose)))
                actor.set_linear_velocity(torch.zeros((1, 3), device=self.env.device))
                actor.set_angular_velocity(torch.zeros((1, 3), device=self.env.device))

    def _build_fixture(self, fixture: Fixture, index: int) -> Actor:
        actor = load_fixture(
            self.scene, fixture, f"{fixture.name}-{index}", index, Path(self._covers.name) / str(index)
        )
        if fixture.name.startswith(("floor", "rug")):  # Fetch's base has no joint upwards
            for bit in (FETCH_WHEELS_COLLISION_BIT, FETCH_BASE_COLLISION_BIT):
                actor.set_collision_group_bit(group=2, bit_idx=bit, bit=1)
        return actor


def _choose_goals(path: Path, room: Room, goal: str) -> tuple[Goal, ...]:
    """The goals of a room with some words, or all of them."""
    folder = path if path.is_dir() else path.parent
    known = (folder / GOALS_FILE).is_file()
    goals = read_goals(folder) if known else sample_goals(room, room.seed, GOALS)
    found = tuple(each for each in goals if goal in ("sampled", each.words))
    if not found:
        listed = "; ".join(each.words for each in goals) or "it has none"
        raise TaskError(f"{path}: no goal {goal!r}; expected 'sampled' or one of: {listed}")
    return found


register_scene_builder("ArtiGenRoom")(RoomSceneBuilder)


class RoomEnv(BaseEnv):
    """``ArtiGen-Room-v1``: a robot in the entrance of a furnished room or flat, with or without a goal.

    With a goal, each episode begins in the goal's first state, ``goals`` holds one for every scene, and
    success is when it is reached; a sparse reward is 1 then.

    Besides the robot's state, the state observation has ``room_qpos [J]``: the joints of all objects in the
    order of scene.json (padded with 0 to the largest room). ``furnished.placed`` gives the articulations.

    Args:
        scenes: One scene.json (or its folder), or several; each parallel scene samples one of them.
        robot_uids: ``fetch`` or ``panda``.
        goal: ``none``, ``sampled`` by the seed of the episode from the room's ``goals.json`` (without one,
            from what the room has), or the words of one of these.

    Raises:
        TaskError: If a room has no goal, or none with these words.
    """

    SUPPORTED_ROBOTS = ["fetch", "panda"]  # noqa: RUF012
    SUPPORTED_REWARD_MODES = ("none", "sparse")

    def __init__(
        self,
        *args: Any,
        scenes: Rooms,
        robot_uids: str = "fetch",
        num_envs: int = 1,
        goal: str = "none",
        reconfiguration_freq: int | None = None,
        **kwargs: Any,
    ) -> None:
        if robot_uids not in self.SUPPORTED_ROBOTS:
            raise ValueError(f"robot_uids {robot_uids!r}, expected fetch or panda")
        self.furnished: RoomSceneBuilder = room_builder(scenes)(self)
        given = [scenes] if isinstance(scenes, str | Path) else scenes
        rooms = self.furnished.build_configs or []
        self._choices = [
            _choose_goals(Path(path), room, goal) if goal != "none" else ()
            for path, room in zip(given, rooms, strict=True)
        ]
        self.goals: list[Goal | None] = [None] * num_envs
        if reconfiguration_freq is None:
            several = len(self.furnished.build_configs or ()) > 1
            reconfiguration_freq = 1 if several and num_envs == 1 else 0
        super().__init__(
            *args,
            robot_uids=robot_uids,
            num_envs=num_envs,
            reconfiguration_freq=reconfiguration_freq,
            **kwargs,
        )

    @property
    def _default_sim_config(self) -> SimConfig:
        memory = GPUMemoryConfig(max_rigid_contact_count=2**23, max_rigid_patch_count=2**21)
        return SimConfig(spacing=20, gpu_memory_config=memory)

    @property
    def _default_human_render_camera_configs(self) -> CameraConfig:
        _, corner, *_ = find_views(self.furnished.rooms[0])
        camera = corner.camera
        pose = sapien_utils.look_at(eye=camera.position.tolist(), target=camera.target.tolist())
        return CameraConfig(
            "render_camera", pose=pose, width=camera.width, height=camera.height, fov=np.radians(camera.fov),
            near=0.01, far=100,
        )  # fmt: skip

    @property
    def _default_sensor_configs(self) -> list[CameraConfig]:
        return []

    def _load_lighting(self, options: dict) -> None:
        self.scene.set_ambient_light([0.45, 0.45, 0.45])
        for lamp in find_lamps(self.furnished.rooms[0]):
            self.scene.add_point_light(list(lamp.position), [3.0 * lamp.share] * 3)

    def _load_agent(self, options: dict) -> None:  # type: ignore[override]
        self.agent = load_robot(self, str(self.robot_uids), AWAY)

    def _load_scene(self, options: dict) -> None:
        self._drawn = [
            int(self._batched_episode_rng[index].randint(len(self.furnished.build_configs or ())))
            for index in range(self.num_envs)
        ]
        self.furnished.build(self._drawn)

    def _initialize_episode(self, env_idx: torch.Tensor, options: dict) -> None:
        for index in env_idx.tolist():
            choices = self._choices[self._drawn[index]]
            if choices:
                goal = choices[int(self._batched_episode_rng[index].randint(len(choices)))]
                self.goals[index] = goal
                configs = self.furnished.build_configs or []
                self.furnished.rooms[index] = start_room(configs[self._drawn[index]], goal)
        self.furnished.initialize(env_idx)
        base = np.array([(*self.furnished.starts[index], 0.0, np.pi / 2.0) for index in env_idx.tolist()])
        place_robot(self, np.tile(np.asarray(self.agent.keyframes["rest"].qpos), (len(base), 1)), base)

    def evaluate(self) -> dict:
        """``success [B]``: whether each scene's goal is reached; empty without goals."""
        if not any(self._choices):
            return {}
        reached = [
            goal is not None and is_reached(goal, room, self.read_state(index, goal))
            for index, (goal, room) in enumerate(zip(self.goals, self.furnished.rooms, strict=True))
        ]
        return {"success": torch.tensor(reached, device=self.device)}

    def read_state(self, index: int, goal: Goal) -> State:
        """Joints and things of one of the parallel scenes that a goal is about."""
        joints = {}
        for name in {each.object for each in (*goal.joints, *goal.items)}:
            articulation = self.furnished.placed[index][name]
            coordinates = articulation.get_qpos()[0].tolist()
            active = [joint.name for joint in articulation.active_joints]
            joints |= {(name, joint): q for joint, q in zip(active, coordinates, strict=True)}
        items = {
            each.item: self.furnished.contents[index][each.item]
            .pose.to_transformation_matrix()[0]
            .cpu()
            .numpy()
            for each in (*goal.items, *goal.lifts)
        }
        links = self.agent.robot.links_map
        x, y, _ = links.get("base_link", self.agent.robot.root).pose.p[index].tolist()
        return State(joints=joints, items=items, base=(x, y))

    def get_language_instruction(self) -> list[str]:
        """The words of each scene's goal."""
        return ["" if goal is None else goal.words for goal in self.goals]

    def _get_obs_extra(self, info: dict) -> dict[str, torch.Tensor]:
        if "state" not in self.obs_mode:
            return {}
        rows = [
            torch.cat([articulation.get_qpos()[0] for articulation in built.values()])
            for built in self.furnished.placed
        ]
        return {"room_qpos": torch.nn.utils.rnn.pad_sequence(rows, batch_first=True)}
