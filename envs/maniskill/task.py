"""Common base of the tasks: objects from packages, a robot in front of one part, and that part's state.

Lengths in metres, angles in radians, everything batched over parallel scenes in the first dimension. All
random draws use the episode's own generators, so that a seed determines everything.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import sapien
import torch
from jaxtyping import Float
from mani_skill.agents.robots.fetch import FETCH_WHEELS_COLLISION_BIT
from mani_skill.envs.sapien_env import BaseEnv
from mani_skill.sensors.camera import CameraConfig
from mani_skill.utils import sapien_utils
from mani_skill.utils.building.ground import build_ground
from mani_skill.utils.geometry.rotation_conversions import quaternion_apply
from mani_skill.utils.structs import Articulation, Link
from mani_skill.utils.structs.types import GPUMemoryConfig, SimConfig

from artigen.shapes.restyle import draw_finishes
from artigen.transforms import inverse, transform_points, transform_vectors
from sim_export.appearance.dress import find_looks
from sim_export.files.folders import name_folders, pick_folder

from ..limits import rest_coordinate
from ..randomize import SEEDS, Randomization, randomize_package, read_randomization, set_masses
from ..sim.articulation import limit_screws
from ..sim.looks import wear_finishes
from .load import build_box, load_object, load_robot, place_robot
from .mechanisms import mechanism_of
from .objects import (
    HandleNeed,
    PartKind,
    TaskObject,
    TaskPart,
    Validation,
    on_plinth,
    read_objects,
)
from .placement import PATH_SAMPLES, Stand, find_stand, grip_path
from .robots import ROBOTS, RobotSpec
from .verbs import Verb, grip_direction

NOISE_POSITION = 0.02
NOISE_YAW = 0.05
NOISE_JOINT = 0.02
AWAY = sapien.Pose(p=[-4.0, 0.0, 0.0])
"""Initial position of the robot, far from every object."""


class PackageTask(BaseEnv):
    """A robot in front of one part of an object. Subclasses define the task.

    Objects stand at the origin, on the floor, front towards -x. Each scene samples one of the objects and one
    of its usable parts. Joints that the part requires to be open are open, all others are closed. With
    ``latched``, the part's latches are closed too, and the robot must operate them. With ``plinths``, low
    objects are raised.

    ``randomize`` varies friction, damping and masses whenever a scene is built, and looks at every reset.

    ``reset(options={"object": NAME})`` chooses the object, a list one for each parallel scene: the name of a
    package's folder, with as many folders above it as tell it apart. ``info["object"]`` are their names.
    """

    SUPPORTED_ROBOTS = ["panda", "fetch"]  # noqa: RUF012
    agent: Any
    full_reward: float
    """Dense reward on success."""
    SUPPORTED_REWARD_MODES = ("normalized_dense", "dense", "sparse", "none")

    def __init__(
        self,
        *args: Any,
        packages: str | Path | Sequence[str | Path],
        part: PartKind,
        joint: str | None,
        handles: HandleNeed,
        validation: Validation,
        initial_open: float,
        goal_open: float,
        verb: Verb = "open",
        latched: bool = False,
        plinths: bool = False,
        randomize: Randomization | Mapping[str, Any] | None = None,
        robot_uids: str = "panda",
        num_envs: int = 1,
        reconfiguration_freq: int | None = None,
        **kwargs: Any,
    ) -> None:
        for name, value in (("initial_open", initial_open), ("the goal's open fraction", goal_open)):
            if not 0.0 <= value <= 1.0:
                raise ValueError(f"{name} is {value}, expected a fraction in [0, 1]")
        if robot_uids not in ROBOTS:
            raise ValueError(f"robot_uids {robot_uids!r}, expected one of {', '.join(sorted(ROBOTS))}")
        self.robot_spec: RobotSpec = ROBOTS[robot_uids]
        self.objects: tuple[TaskObject, ...] = read_objects(
            packages, part, joint=joint, handles=handles, validation=validation, verb=verb
        )
        if plinths:
            self.objects = tuple(on_plinth(entry) for entry in self.objects)
        self.object_names = name_folders([entry.folder for entry in self.objects])
        """Name of every object that a scene may draw."""
        self.randomize = read_randomization(randomize)
        self.latched = latched
        self.initial_open, self.goal_open = initial_open, goal_open
        if reconfiguration_freq is None:
            reconfiguration_freq = 1 if num_envs == 1 else 0
        super().__init__(
            *args,
            robot_uids=robot_uids,
            num_envs=num_envs,
            reconfiguration_freq=reconfiguration_freq,
            **kwargs,
        )

    def reset(self, seed: Any = None, options: dict | None = None) -> tuple[Any, dict]:
        """Resets; a choice of objects builds the scenes anew.

        Raises:
            PackageError: If none or several of the objects have a name that was asked for.
        """
        if options and "object" in options:
            options = options | {"reconfigure": True}
        return super().reset(seed=seed, options=options)

    def get_info(self) -> dict:
        """What `evaluate` finds, and ``object``: a name for every parallel scene."""
        names = dict(zip(self.objects, self.object_names, strict=True))
        return super().get_info() | {"object": [names[entry] for entry, _ in self.drawn]}

    def get_language_instruction(self) -> list[str]:
        """What to do in each scene, in words."""
        return [self._say(entry, part) for entry, part in self.drawn]

    def _say(self, entry: TaskObject, part: TaskPart) -> str:
        """The task in words."""
        raise NotImplementedError

    @property
    def _default_sim_config(self) -> SimConfig:
        memory = GPUMemoryConfig(max_rigid_contact_count=2**21, max_rigid_patch_count=2**19)
        return SimConfig(spacing=5, gpu_memory_config=memory)

    @property
    def _default_human_render_camera_configs(self) -> CameraConfig:
        pose = sapien_utils.look_at(eye=[-1.8, -1.4, 1.6], target=[-0.2, 0.1, 0.4])
        return CameraConfig("render_camera", pose=pose, width=512, height=512, fov=1, near=0.01, far=100)

    @property
    def _default_sensor_configs(self) -> list[CameraConfig]:
        pose = sapien_utils.look_at(eye=[-1.5, -0.9, 1.4], target=[-0.2, 0.0, 0.4])
        return [CameraConfig("base_camera", pose=pose, width=128, height=128, fov=1.2, near=0.01, far=100)]

    def _load_agent(self, options: dict) -> None:  # type: ignore[override]
        self.agent = load_robot(self, self.robot_spec.name, AWAY)

    def _load_scene(self, options: dict) -> None:
        self.ground = build_ground(self.scene)
        if self.robot_spec.name == "fetch":
            self.ground.set_collision_group_bit(group=2, bit_idx=FETCH_WHEELS_COLLISION_BIT, bit=1)
        self.drawn: list[tuple[TaskObject, TaskPart]] = []
        self.into_links: list[np.ndarray] = []
        built, targets, grips, pulls = [], [], [], []
        asked = options.get("object", [])
        by_folder = {entry.folder: entry for entry in self.objects}
        chosen = [
            by_folder[pick_folder(tuple(by_folder), name)]
            for name in ([asked] if isinstance(asked, str) else asked)
        ] or [None]
        for index in range(self.num_envs):
            rng = self._batched_episode_rng[index]
            entry, part = self._draw(rng, chosen[index % len(chosen)])
            name = f"{entry.package.name}-{index}"
            if entry.raised > 0.0:
                low, high = np.array(entry.bounds)
                low[2], high[2] = 0.0, entry.raised
                build_box(self.scene, f"plinth-{index}", index, low, high)
            held = self._open_needs(part)
            other = randomize_package(entry.package, self.randomize, rng)
            articulation, frames = load_object(
                self.scene, replace(entry, package=other), name, index, held=held
            )
            if other is not entry.package:
                for engine in articulation._objs:
                    set_masses(engine.links, other, f"scene-{index}-{name}_")
            self.remove_from_state_dict_registry(articulation)
            into_link = inverse(frames[part.joint.child])
            grips.append(transform_points(into_link, part.grip[None])[0])
            pulls.append(transform_vectors(into_link, grip_direction(part.joint, part.grip)[None])[0])
            self.drawn.append((entry, part))
            built.append(articulation)
            self.into_links.append(into_link)
            targets.append(articulation.links_map[part.joint.child])
        self._adopt(built, targets, np.array(grips), np.array(pulls))

    def _draw(self, rng: np.random.RandomState, chosen: TaskObject | None) -> tuple[TaskObject, TaskPart]:
        """Samples an object, if none is chosen, and one of its parts with one scene's generator."""
        entry = chosen or self.objects[rng.randint(len(self.objects))]
        return entry, entry.parts[rng.randint(len(entry.parts))]

    def _opened(self, entry: TaskObject, part: TaskPart) -> float:
        """Initial open fraction of the part."""
        return self.initial_open

    def _open_needs(self, part: TaskPart) -> frozenset[str]:
        """Joints that stand open for the part, held there against their springs."""
        shut = {latch.part.joint.name for latch in part.latches} if self.latched else set()
        return frozenset(part.needs) - shut

    def _start(self, entry: TaskObject, part: TaskPart, articulation: Articulation) -> Float[np.ndarray, "Q"]:
        """Initial joint vector, padded to the object with the most joints in the batch; followers follow."""
        specs = {joint.name: joint for joint in limit_screws(entry.package).joints}
        wide = self._open_needs(part)
        qpos = np.zeros(self.object.max_dof)
        for column, joint in enumerate(articulation.active_joints):
            spec = specs[joint.name]
            qpos[column] = spec.upper if spec.name in wide else rest_coordinate(spec)
        opened = part.joint.lower + self._opened(entry, part) * part.span
        qpos[_column(articulation, part.joint.name)] = opened
        return mechanism_of(articulation, entry.package).complete(qpos)

    def _stand(self, entry: TaskObject, part: TaskPart) -> Stand:
        """Base position from which all of the grip's path is in reach."""
        fractions = np.linspace(self.initial_open, self.goal_open, PATH_SAMPLES)
        path = grip_path(entry, part, fractions)
        if self.latched:
            path = np.concatenate([path, *(grip_path(entry, x.part, fractions[:1]) for x in part.latches)])
        return find_stand(entry, part, self.robot_spec, fractions, path, self.robot_spec.forward)

    def _adopt(
        self, built: list[Articulation], targets: list[Link], grips: np.ndarray, pulls: np.ndarray
    ) -> None:
        """Creates batched views of the built objects, and tensors of values that are constant until the next
        build."""
        self.built = built
        self.object = Articulation.merge(built, name="object")
        self.add_to_state_dict_registry(self.object)
        self.target = Link.merge(targets, name="target")
        columns, starts, self.stands = [], [], []
        for (entry, part), articulation in zip(self.drawn, built, strict=True):
            columns.append(_column(articulation, part.joint.name))
            starts.append(self._start(entry, part, articulation))
            self.stands.append(self._stand(entry, part))
        lower = [part.joint.lower for _, part in self.drawn]
        span = [part.span for _, part in self.drawn]
        sliding = [part.joint.type == "prismatic" for _, part in self.drawn]
        self._rows = torch.arange(self.num_envs, device=self.device)
        self._columns = torch.tensor(columns, device=self.device)
        self._lower, self._span, self._starts, self._grips, self._pulls = (
            torch.tensor(np.array(values), dtype=torch.float32, device=self.device)
            for values in (lower, span, starts, grips, pulls)
        )
        self._still = torch.tensor([0.1 if flag else 1.0 for flag in sliding], device=self.device)

    def _initialize_episode(self, env_idx: torch.Tensor, options: dict) -> None:
        self.object.set_qpos(self._starts[env_idx])
        self.object.set_qvel(torch.zeros_like(self._starts[env_idx]))
        noise = self._batched_episode_rng[env_idx.cpu().numpy()].uniform(
            -1.0, 1.0, size=3 + len(self.robot_spec.arm)
        )
        scale = np.array([NOISE_POSITION, NOISE_POSITION, NOISE_YAW] + [NOISE_JOINT] * (noise.shape[1] - 3))
        stands = [self.stands[int(index)] for index in env_idx]
        self._place_robot(stands, noise * scale)
        if self.randomize.looks:
            for index in env_idx.tolist():
                self._dress(index)

    def _dress(self, index: int) -> None:
        """Gives the object of one scene the finishes of another one of its kind."""
        if not self.scene.can_render():
            raise ValueError("the scene cannot render, so it has no looks; make it with a render_backend")
        entry, _ = self.drawn[index]
        seed = int(self._batched_episode_rng[index].randint(SEEDS))
        looks = find_looks(draw_finishes(entry.package.category, seed, self.randomize.style))
        links = [link for engine in self.built[index]._objs for link in engine.links]
        wear_finishes(links, entry.folder, looks)

    def _place_robot(self, stands: list[Stand], noise: Float[np.ndarray, "B 3+A"]) -> None:
        """Places the base on its stand and the arm at its ready pose, both with noise."""
        spec = self.robot_spec
        base = np.array([[s.x, s.y, s.z, s.yaw] for s in stands])
        base[:, [0, 1, 3]] += noise[:, :3]
        names = [joint.name for joint in self.agent.robot.active_joints]
        qpos = np.array([[spec.opening / 2.0 if "finger" in name else 0.0 for name in names]] * len(stands))
        qpos[:, [names.index(name) for name in spec.arm]] = spec.ready + noise[:, 3:]
        if spec.name == "fetch":
            qpos[:, names.index("torso_lift_joint")] = [s.lift for s in stands]
        place_robot(self, qpos, base)

    @property
    def open_fraction(self) -> Float[torch.Tensor, "B"]:
        """Open fraction of the part, 0 at the lower limit and 1 at the upper."""
        return (self.object.get_qpos()[self._rows, self._columns] - self._lower) / self._span

    @property
    def grip_position(self) -> Float[torch.Tensor, "B 3"]:
        """Grasp point of the part, in the world."""
        pose = self.target.pose
        return quaternion_apply(pose.q, self._grips) + pose.p

    def _part_info(self) -> dict[str, torch.Tensor]:
        """State of the part, common to all tasks."""
        speed = self.object.get_qvel()[self._rows, self._columns].abs()
        return {
            "open_fraction": self.open_fraction,
            "grip_position": self.grip_position,
            "part_still": speed <= self._still,
        }

    def _get_obs_extra(self, info: dict) -> dict[str, torch.Tensor]:
        obs = {"tcp_pose": self.agent.tcp.pose.raw_pose}
        if "state" in self.obs_mode:
            pull = quaternion_apply(self.target.pose.q, self._pulls)
            obs |= {
                "open_fraction": info["open_fraction"][:, None],
                "grip_position": info["grip_position"],
                "tcp_to_grip": info["grip_position"] - self.agent.tcp.pose.p,
                "pull_direction": pull,
            }
        return obs

    def compute_normalized_dense_reward(self, obs: Any, action: torch.Tensor, info: dict) -> torch.Tensor:
        """The dense reward in [0, 1]."""
        return self.compute_dense_reward(obs, action, info) / self.full_reward


def _column(articulation: Articulation, joint: str) -> int:
    return [entry.name for entry in articulation.active_joints].index(joint)
