"""``ArtiGen/Actuate-v0``: open one joint by pulling at its handle."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, shift, transform_points

from .base import SUBSTEPS, PackageEnv, Packages, open_fractions
from .hand import ON_AXIS, measure_moved, pose_matrix
from .plan import plan_trials
from .randomize import Randomization
from .sim.loaded import LoadedJoint


@dataclass(frozen=True, kw_only=True)
class ActuateConfig:
    """Target joint and success."""

    joint: str | None = None
    """Name of the joint; ``None`` samples one at every reset."""
    success_fraction: float = 0.9
    """Share of the range (of a full turn without limits) that counts as open."""


class ActuateEnv(PackageEnv):
    """The object has a fixed base and starts at rest; joints that the target requires to be open are open.

    **Action** ``[1]`` in [-1, 1]: force at the handle in its direction of motion as the joint opens, as a
    share of the hand's largest force (30 N on a drawer, 20 N m on a door and at most 30 N at its handle, 10 N
    on a button, 1 N m on a knob; the weight of what is lifted is added). A handle on the joint's axis, such
    as a knob, is turned by a torque instead.

    **Observation** ``open_fraction [J]``, ``joint_velocity [J]`` in ranges per second, ``target [J]``
    one-hot, and for the target's handle ``handle_position [3]`` (m) and ``opening_direction [3]`` (unit),
    both in the world; for a handle on the axis the direction is the axis. If the package has no handle
    annotation, the point farthest from the axis is used, and for sliding parts their centre of mass.

    **Reward** the change of the target's open fraction in this step: the return of an episode is the fraction
    by which the joint was opened.

    **Success** (``info["success"]``, ends the episode): the target is open to ``cfg.success_fraction``.

    **Reset** all joints at rest, the target at its lower limit, the joints it requires at their upper limits;
    without ``cfg.joint`` the target is random.

    Version history: v0 first version.
    """

    def __init__(
        self,
        package: Packages,
        cfg: ActuateConfig | None = None,
        render_mode: str | None = None,
        randomize: Randomization | Mapping[str, Any] | None = None,
    ) -> None:
        self.cfg = cfg or ActuateConfig()
        super().__init__(package, render_mode, randomize)
        count = self.width
        self.action_space = gym.spaces.Box(-1.0, 1.0, (1,), np.float32)
        free = gym.spaces.Box(-np.inf, np.inf, (count,), np.float32)
        self.observation_space = gym.spaces.Dict(
            {
                "open_fraction": free,
                "joint_velocity": free,
                "target": gym.spaces.MultiBinary(count),
                "handle_position": gym.spaces.Box(-np.inf, np.inf, (3,), np.float32),
                "opening_direction": gym.spaces.Box(-1.0, 1.0, (3,), np.float32),
            }
        )
        self._target = 0
        self._grip = np.zeros(3)
        self._travel = 0.0

    def _adopt(self) -> None:
        if self.cfg.joint is not None:
            self.loaded.joint(self.cfg.joint)
        self._plans = plan_trials(self.loaded).joints

    def reset(self, *, seed: int | None = None, options: dict | None = None):
        """Closes all joints, opens those that the target requires, and grasps the handle."""
        self._rebuild(seed, options)
        names = [joint.spec.name for joint in self.loaded.joints]
        drawn = int(self.np_random.integers(len(names)))
        self._target = drawn if self.cfg.joint is None else names.index(self.cfg.joint)
        joint = self._joint
        start = {other.spec.name: other.lower for other in self.loaded.joints}
        start |= {name: self.loaded.joint(name).spec.upper for name in self._plans[self._target].needs}
        self.loaded.reset(start)
        T_link_world = inverse(pose_matrix(joint.engine.child_link.entity_pose))
        self._grip = transform_points(T_link_world, self._grasp_point()[None])[0]
        self._travel = 0.0
        return self._observe(), self._info()

    def step(self, action: np.ndarray):
        """Five physics steps with the force following the handle."""
        joint, plan = self._joint, self._plans[self._target]
        push = float(np.clip(np.asarray(action, dtype=np.float64), -1.0, 1.0)[0])
        effort = push * plan.effort(push)
        before = self._opened()
        for _ in range(SUBSTEPS):
            point, direction, lever = self._handle()
            if lever > 0.0:
                force = effort / lever * direction
                joint.engine.child_link.add_force_at_point(force.tolist(), point.tolist())
            else:
                joint.engine.child_link.add_force_torque([0.0, 0.0, 0.0], (effort * direction).tolist())
            self.loaded.step()
            self._travel += float(self.loaded.articulation.qvel[joint.index]) * self.scene.timestep
        info = self._info()
        return self._observe(), self._opened() - before, info["success"], False, info

    @property
    def _joint(self) -> LoadedJoint:
        return self.loaded.joints[self._target]

    def _opened(self) -> float:
        """Open fraction of the target; for a joint without limits the accumulated angle counts."""
        joint = self._joint
        if joint.limited:
            return float(open_fractions(self.loaded)[self._target])
        return self._travel / joint.span

    def _grasp_point(self) -> Float[np.ndarray, "3"]:
        """Grasp point in the world at the pose of the reset."""
        joint = self._joint
        moved = measure_moved(joint)
        if joint.handle is not None:
            # Annotations are in the object frame at rest; the link may have moved since.
            T = pose_matrix(joint.engine.child_link.entity_pose)
            center = joint.handle.corners.mean(axis=0)
            return transform_points(T @ inverse(shift(joint.spec.origin)), center[None])[0]
        if joint.spec.type == "prismatic" or not len(moved.vertices):
            return moved.com
        arms = np.cross(moved.axis, moved.vertices - moved.origin)
        return moved.vertices[int(np.argmax(np.linalg.norm(arms, axis=1)))]

    def _handle(self) -> tuple[np.ndarray, np.ndarray, float]:
        """Current position and direction of motion of the handle, and metres per unit of the joint; for a
        handle on the axis 0 metres and the axis as direction."""
        joint = self._joint
        frame = pose_matrix(joint.engine.global_pose)
        axis, origin = frame[:3, 0], frame[:3, 3]
        T = pose_matrix(joint.engine.child_link.entity_pose)
        point = transform_points(T, self._grip[None])[0]
        if joint.spec.type == "prismatic":
            return point, axis, 1.0
        motion = np.cross(axis, point - origin)
        lever = float(np.linalg.norm(motion))
        return (point, axis, 0.0) if lever < ON_AXIS else (point, motion / lever, lever)

    def _observe(self) -> dict[str, np.ndarray]:
        point, direction, _ = self._handle()
        qvel = np.asarray(self.loaded.articulation.qvel, dtype=np.float64)
        target = np.zeros(self.width, dtype=np.int8)
        target[self._target] = 1
        return {
            "open_fraction": self.pad(open_fractions(self.loaded)),
            "joint_velocity": self.pad(
                np.array([qvel[each.index] / max(each.span, 1e-9) for each in self.loaded.joints], np.float32)
            ),
            "target": target,
            "handle_position": point.astype(np.float32),
            "opening_direction": np.clip(direction, -1.0, 1.0).astype(np.float32),
        }

    def _info(self) -> dict:
        opened = self._opened()
        return {
            "success": bool(opened >= self.cfg.success_fraction),
            "object": self.object_name,
            "joint": self._joint.spec.name,
            "opened": opened,
        }
