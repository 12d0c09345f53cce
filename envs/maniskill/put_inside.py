"""``ArtiGen-PutInside-v1``: put a cube from a stand into an open drawer or compartment."""

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import sapien
import torch
from jaxtyping import Float
from mani_skill.utils.geometry.rotation_conversions import quaternion_apply, quaternion_invert
from mani_skill.utils.structs import Pose

from artigen.transforms import transform_points

from .containers import Container, room_when_open
from .hulls import object_field, open_above_ground, opened_qpos
from .load import SURFACE
from .objects import PartKind, TaskError, TaskObject, TaskPart, Validation, say_part
from .placement import Stand, find_stand, free_radius, part_motion
from .postures import Goal, Postures, find_putting_stand, sample_postures
from .solver.body import read_body
from .solver.chain import read_arm
from .solver.field import Field
from .task import PackageTask

REST_STEPS = 10
"""Control steps (20 per second) for which the cube must lie still inside."""
LET_GO = 0.06
"""Distance of the gripper from the cube's centre that counts as released, metres."""
STILL = 0.02
SPARE = 0.01
SIDE = {"panda": (np.radians(100.0), 0.45, 0.42), "fetch": (np.radians(75.0), 0.65, 0.50)}
"""Position of the cube: angle from straight ahead, distance, and height above the robot's base."""
CUBE_NOISE = 0.02
PLACES = (
    (0.0, 0.0), (0.4, 0.0), (0.7, 0.0), (0.0, 0.5), (0.0, -0.5),
    (0.4, 0.5), (0.4, -0.5), (0.7, 0.5), (0.7, -0.5),
)  # fmt: skip
"""Alternative positions of the cube on a floor: shares of the way to the front and to the sides."""
HOLD_IN, HOLD_DOWN = (0.04,), (0.04, 0.10, 0.15)
"""Height of the hand above the floor at which the arm needs clearance, metres; the cube may be dropped into a
deep drawer."""
COARSE = 0.06
"""Spacing of the points that represent the arm in the search for a base, metres."""
STAND_HALF = (0.025, 0.025, 1.0)


class PutInsideEnv(PackageTask):
    """A robot takes a cube from a narrow stand beside it and puts it into an open drawer or compartment.

    **Randomizations:** those of ``ArtiGen-OpenPart-v1``, and the cube's place (2 cm) and yaw on its stand.

    **Success:** the cube lies inside for half a second, slower than 2 cm/s, and the gripper is at least 6 cm
    away from its centre.

    **Observations:** robot state, ``tcp_pose``; with states also the part's, ``cube_pose``, ``cube_to_aim``
    and ``tcp_to_cube``.

    Args:
        packages: A folder of packages, one package, or a list of either.
        part: ``drawer``, ``door`` (the compartment behind it) or ``any``.
        joint: Only parts on a joint with this name.
        initial_open: Open fraction of the part; less if it would reach below the ground.
        cube_size: Edge of the cube, metres.
        validation: ``any`` accepts packages without a passed ``validation.json``.
        kwargs: Arguments of ManiSkill's environments.

    Raises:
        TaskError: If there is no package, one failed validation, none has the part, or no part has room.
    """

    full_reward = 6.0

    def __init__(
        self,
        *args: Any,
        packages: str | Path | Sequence[str | Path],
        part: PartKind = "any",
        joint: str | None = None,
        initial_open: float = 1.0,
        cube_size: float = 0.04,
        validation: Validation = "passed",
        **kwargs: Any,
    ) -> None:
        if not 0.01 <= cube_size <= 0.06:
            raise ValueError(f"cube_size {cube_size} m, expected 0.01 to 0.06, the range of the grippers")
        self.cube_size = cube_size
        self._known_stands: dict[tuple[Path, str], Stand] = {}
        self._known_fields: dict[tuple[Path, str], Field] = {}
        super().__init__(
            *args, packages=packages, part=part, joint=joint, handles="optional", validation=validation,
            initial_open=initial_open, goal_open=initial_open, **kwargs,
        )  # fmt: skip

    def _draw(self, rng: np.random.RandomState, chosen: TaskObject | None) -> tuple[TaskObject, TaskPart]:
        objects = self.objects if chosen is None else (chosen,)
        for entry in rng.permutation(np.array(objects, dtype=object)):
            for part in rng.permutation(np.array(entry.parts, dtype=object)):
                if self.container_of(entry, part) is not None:
                    return entry, part
        parts = sum(len(entry.parts) for entry in objects)
        raise TaskError(
            f"{len(objects)} packages have {parts} drawers and doors, and none has room for a cube of "
            f"{self.cube_size} m and half as much again; give other packages or a smaller cube"
        )

    def _say(self, entry: TaskObject, part: TaskPart) -> str:
        where = "" if part.kind == "drawer" else "compartment behind "
        return f"put the cube into {'the ' * bool(where)}{where}{say_part(entry, part)}"

    def container_of(self, entry: TaskObject, part: TaskPart) -> Container | None:
        """The space of a part for this task."""
        return room_when_open(entry, part, self.initial_open, self.cube_size)

    def _opened(self, entry: TaskObject, part: TaskPart) -> float:
        return open_above_ground(entry, part, self.initial_open)

    def _stand(self, entry: TaskObject, part: TaskPart) -> Stand:
        """Base position with the most clearance for holding the cube inside; cached for equal parts."""
        key = (entry.folder, part.joint.name)
        if key not in self._known_stands:
            self._known_stands[key] = self._look_for_stand(entry, part)
        return self._known_stands[key]

    def _look_for_stand(self, entry: TaskObject, part: TaskPart) -> Stand:
        container, opened = self.container_of(entry, part), self._opened(entry, part)
        assert container is not None
        places = resting_places(entry, part, container, opened)
        heights = HOLD_DOWN if container.down else HOLD_IN
        hands = np.concatenate([places + np.array([0.0, 0.0, height]) for height in heights])
        found = find_putting_stand(
            entry, part, self.robot_spec, postures=self._postures, opened=opened,
            field=self._field(entry, part),
            goal=Goal(places=hands, inwards=container.inwards, down=container.down),
        )  # fmt: skip
        if found is not None:
            return found
        depth = float(container.region[1, 2] - container.region[0, 2])
        top = depth + 0.1 if container.down else 0.15
        path = places[0] + np.array([[0.0, 0.0, 0.05], [0.0, 0.0, top]])
        reach = self.robot_spec.down if container.down else self.robot_spec.forward
        return find_stand(entry, part, self.robot_spec, np.array([opened]), path, reach)

    def solid_at_start(self, index: int) -> Field:
        """Distances to one scene's object and to the ground at the start of an episode, in the object
        frame."""
        return self._field(*self.drawn[index])

    def _field(self, entry: TaskObject, part: TaskPart) -> Field:
        key = (entry.folder, part.joint.name)
        if key not in self._known_fields:
            qpos = opened_qpos(entry, part, self._opened(entry, part))
            self._known_fields[key] = object_field(entry, part, qpos)
        return self._known_fields[key]

    @functools.cached_property
    def _postures(self) -> Postures:
        arm = self.agent.robot._objs[0]
        chain = read_arm(arm, self.robot_spec)
        body = read_body(arm, chain, self.robot_spec.hand, COARSE)
        return sample_postures(chain, body, self.robot_spec)

    def _load_scene(self, options: dict) -> None:
        super()._load_scene(options)
        half = self.cube_size / 2.0
        material = sapien.physx.PhysxMaterial(**SURFACE)
        cube, stand = self.scene.create_actor_builder(), self.scene.create_actor_builder()
        cube.add_box_collision(half_size=(half, half, half), material=material, density=500.0)
        stand.add_box_collision(half_size=STAND_HALF)
        if self.scene.can_render():
            red, grey = ([0.8, 0.2, 0.1, 1.0], [0.4, 0.4, 0.4, 1.0])
            for builder, color, size in ((cube, red, (half, half, half)), (stand, grey, STAND_HALF)):
                paint = sapien.render.RenderMaterial(base_color=color)
                builder.add_box_visual(half_size=size, material=paint)
        cube.initial_pose = Pose.create(sapien.Pose(p=[-3.0, 2.0, 1.0]))
        stand.initial_pose = Pose.create(sapien.Pose(p=[-3.0, 3.0, 0.0]))
        self.cube, self.cube_stand = cube.build(name="cube"), stand.build_kinematic(name="cube_stand")
        regions, moving, aims, spots = [], [], [], []
        self.containers: list[Container] = []
        for (entry, part), place, into_link in zip(self.drawn, self.stands, self.into_links, strict=True):
            container = self.container_of(entry, part)
            assert container is not None
            moving.append(container.link == part.joint.child)
            if moving[-1]:
                regions.append(np.sort(transform_points(into_link, container.region), axis=0))
            else:
                regions.append(container.region - [0.0, 0.0, entry.floor])
            aims.append(resting_places(entry, part, container, self._opened(entry, part))[0])
            spots.append(self._cube_spot(entry, part, place))
            self.containers.append(container)
        self._regions, self.aims, self._spots = (
            torch.tensor(np.array(values), dtype=torch.float32, device=self.device)
            for values in (regions, aims, spots)
        )
        self._moves = torch.tensor(moving, device=self.device)[:, None]
        self._rest_steps = torch.zeros(self.num_envs, dtype=torch.int32, device=self.device)

    def resting_places(self, index: int) -> Float[np.ndarray, "A 3"]:
        """Positions in the world where the cube of one scene may come to rest, the preferred one first."""
        entry, part = self.drawn[index]
        return resting_places(entry, part, self.containers[index], self._opened(entry, part))

    def _cube_spot(self, entry: TaskObject, part: TaskPart, place: Stand) -> np.ndarray:
        """Top of the cube's stand, on the side of the robot with more free space."""
        angle, distance, height = SIDE[self.robot_spec.name]
        yaws = place.yaw + np.array([angle, -angle])
        spots = np.stack([place.x + distance * np.cos(yaws), place.y + distance * np.sin(yaws)], axis=1)
        spots = np.c_[spots, np.full(2, place.z)]
        room = free_radius(entry, part, spots, height + 0.1, np.array([self._opened(entry, part)]))
        return spots[int(room.argmax())] + [0.0, 0.0, height + place.lift]

    def _initialize_episode(self, env_idx: torch.Tensor, options: dict) -> None:
        super()._initialize_episode(env_idx, options)
        noise = self._batched_episode_rng[env_idx.cpu().numpy()].uniform(-1.0, 1.0, size=3)
        noise = torch.tensor(noise * [CUBE_NOISE, CUBE_NOISE, np.pi / 4.0], device=self.device).float()
        p = self._spots[env_idx].clone()
        p[:, :2] += noise[:, :2]
        q = torch.zeros((len(env_idx), 4), device=self.device)
        q[:, 0], q[:, 3] = torch.cos(noise[:, 2] / 2.0), torch.sin(noise[:, 2] / 2.0)
        low = torch.tensor([0.0, 0.0, STAND_HALF[2]], device=self.device)
        self.cube_stand.set_pose(Pose.create_from_pq(p - low, q))
        p[:, 2] += self.cube_size / 2.0
        self.cube.set_pose(Pose.create_from_pq(p, q))
        self._rest_steps[env_idx] = 0

    def _after_control_step(self) -> None:
        rests = self._inside() & self._cube_still()
        self._rest_steps = torch.where(rests, self._rest_steps + 1, torch.zeros_like(self._rest_steps))

    def _inside(self) -> torch.Tensor:
        """Whether the cube's centre is in the region; its lower half may be slightly below."""
        position, part = self.cube.pose.p, self.target.pose
        in_part = quaternion_apply(quaternion_invert(part.q), position - part.p)
        local = torch.where(self._moves, in_part, position)
        low, high = self._regions[:, 0] - SPARE, self._regions[:, 1] + SPARE
        return ((local >= low) & (local <= high)).all(dim=1)

    def _cube_still(self) -> torch.Tensor:
        return torch.linalg.norm(self.cube.linear_velocity, dim=1) <= STILL

    def evaluate(self) -> dict[str, torch.Tensor]:
        """Named booleans, the part's state and the cube's, batched."""
        info = self._part_info()
        distance = torch.linalg.norm(self.agent.tcp.pose.p - self.cube.pose.p, dim=1)
        released = distance >= LET_GO
        return info | {
            "inside": self._inside(),
            "cube_still": self._cube_still(),
            "released": released,
            "success": (self._rest_steps >= REST_STEPS) & released,
        }

    def _get_obs_extra(self, info: dict) -> dict[str, torch.Tensor]:
        obs = super()._get_obs_extra(info)
        if "state" in self.obs_mode:
            obs |= {
                "cube_pose": self.cube.pose.raw_pose,
                "cube_to_aim": self.aims - self.cube.pose.p,
                "tcp_to_cube": self.cube.pose.p - self.agent.tcp.pose.p,
            }
        return obs

    def compute_dense_reward(self, obs: Any, action: torch.Tensor, info: dict) -> torch.Tensor:
        """Up to 1 for reaching the cube, 2 for bringing it near, 1 for having it inside, 6 on success."""
        reached = 1.0 - torch.tanh(5.0 * torch.linalg.norm(self.agent.tcp.pose.p - self.cube.pose.p, dim=1))
        near = 1.0 - torch.tanh(3.0 * torch.linalg.norm(self.aims - self.cube.pose.p, dim=1))
        inside = info["inside"].float()
        reward = torch.where(info["inside"], torch.ones_like(reached), reached) + 2.0 * near + inside
        return torch.where(info["success"], torch.full_like(reward, self.full_reward), reward)


def resting_places(
    entry: TaskObject, part: TaskPart, container: Container, opened: float
) -> Float[np.ndarray, "A 3"]:
    """Positions on the container's floor where a cube may lie, the aim first, then some nearer to the front
    or the sides; in the world, for an object at the origin with the part open."""
    inwards = container.inwards
    side = np.array([-inwards[1], inwards[0], 0.0])
    spare = np.minimum(container.aim - container.region[0], container.region[1] - container.aim)
    deep, wide = (float(np.abs(direction) @ spare) for direction in (inwards, side))
    aims = container.aim + np.array([-a * deep * inwards + b * wide * side for a, b in PLACES])
    if container.link != part.joint.parent:
        aims = transform_points(part_motion(part, np.array([opened]))[0], aims)
    return aims - [0.0, 0.0, entry.floor]
