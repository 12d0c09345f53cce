"""``ArtiGen/Settle-v0``: a free-standing object drops a little and must come to rest upright."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
import sapien

from sim_export.physics.materials import GRAVITY

from .base import SUBSTEPS, PackageEnv, Packages, open_fractions
from .hand import pose_matrix
from .randomize import Randomization
from .trials import center_of_mass, local_vertices, quat_about, world_vertices


@dataclass(frozen=True, kw_only=True)
class SettleConfig:
    """Initial state of the object, and criteria of being settled."""

    drop_height: float = 0.02
    """Initial distance (m) between the floor and the object's lowest point."""
    lean_degrees: float = 1.0
    """Largest initial tilt (degrees), in a random direction."""
    push_ratio: float = 0.2
    """Force of a full action as a share of the object's weight."""
    upright_degrees: float = 2.0
    """Largest tilt (degrees) at which the object counts as upright."""
    fallen_degrees: float = 45.0
    """Tilt (degrees) from which the object has fallen over, which ends the episode."""
    rest_speed: float = 0.01
    """Speed (m/s, and rad/s) below which it is at rest."""
    rest_steps: int = 10
    """Consecutive control steps at rest and upright that count as success."""


class SettleEnv(PackageEnv):
    """The object stands freely on the ground; joints have the friction and damping of the package.

    **Action** ``[3]`` in [-1, 1]: a force on the body (the root) through the object's centre of mass, as a
    share of ``cfg.push_ratio`` times its weight; zero applies no force.

    **Observation** ``height [1]`` of the lowest point above the ground (m), ``up [3]`` the object's z axis in
    the world, ``linear_velocity [3]`` (m/s) and ``angular_velocity [3]`` (rad/s) of the body, and
    ``open_fraction [J]``.

    **Reward** 1 for every step that ends upright and at rest, else 0.

    **Success** (``info["success"]``, ends the episode): upright and at rest for ``cfg.rest_steps``
    consecutive steps. The episode also ends, without success, when the object has fallen over.

    **Reset** joints at rest, the lowest point ``cfg.drop_height`` above the ground, tilted by a random angle
    up to ``cfg.lean_degrees`` in a random direction.

    Version history: v0 first version.
    """

    base = "free"
    least = 0

    def __init__(
        self,
        package: Packages,
        cfg: SettleConfig | None = None,
        render_mode: str | None = None,
        randomize: Randomization | Mapping[str, Any] | None = None,
    ) -> None:
        self.cfg = cfg or SettleConfig()
        super().__init__(package, render_mode, randomize)
        self.action_space = gym.spaces.Box(-1.0, 1.0, (3,), np.float32)
        unbounded = gym.spaces.Box(-np.inf, np.inf, (3,), np.float32)
        self.observation_space = gym.spaces.Dict(
            {
                "height": gym.spaces.Box(-np.inf, np.inf, (1,), np.float32),
                "up": gym.spaces.Box(-1.0, 1.0, (3,), np.float32),
                "linear_velocity": unbounded,
                "angular_velocity": unbounded,
                "open_fraction": gym.spaces.Box(-np.inf, np.inf, (self.width,), np.float32),
            }
        )
        self._resting = 0

    def _adopt(self) -> None:
        self._weight = GRAVITY * sum(float(link.mass) for link in self.loaded.articulation.links)
        self._local = local_vertices(self.loaded)

    def reset(self, *, seed: int | None = None, options: dict | None = None):
        """Lifts and tilts the object, and releases it."""
        self._rebuild(seed, options)
        self._resting = 0
        self.loaded.reset()
        lean = np.radians(self.cfg.lean_degrees) * self.np_random.uniform()
        heading = self.np_random.uniform(0.0, 2.0 * np.pi)
        axis = np.array([np.cos(heading), np.sin(heading), 0.0])
        quat = quat_about(axis, lean)
        self.loaded.articulation.set_root_pose(sapien.Pose(q=quat))
        lowest = float(world_vertices(self.loaded, self._local)[:, 2].min())
        self.loaded.articulation.set_root_pose(
            sapien.Pose(p=[0.0, 0.0, self.cfg.drop_height - lowest], q=quat)
        )
        return self._observe(), self._info()

    def step(self, action: np.ndarray):
        """Five physics steps with a constant force."""
        push = np.clip(np.asarray(action, dtype=np.float64), -1.0, 1.0)
        force = self.cfg.push_ratio * self._weight * push
        root = self.loaded.articulation.links[0]
        for _ in range(SUBSTEPS):
            if force.any():
                root.add_force_at_point(force.tolist(), center_of_mass(self.loaded).tolist())
            self.loaded.step()
        info = self._info()
        settled = info["tilt_degrees"] < self.cfg.upright_degrees and info["speed"] < self.cfg.rest_speed
        self._resting = self._resting + 1 if settled else 0
        info["success"] = self._resting >= self.cfg.rest_steps
        fallen = not info["tilt_degrees"] < self.cfg.fallen_degrees
        return self._observe(), float(settled), bool(info["success"] or fallen), False, info

    def _observe(self) -> dict[str, np.ndarray]:
        root = self.loaded.articulation.links[0]
        up = pose_matrix(root.entity_pose)[:3, 2]
        return {
            "height": np.array([world_vertices(self.loaded, self._local)[:, 2].min()], dtype=np.float32),
            "up": np.clip(up, -1.0, 1.0).astype(np.float32),
            "linear_velocity": np.asarray(root.linear_velocity, dtype=np.float32),
            "angular_velocity": np.asarray(root.angular_velocity, dtype=np.float32),
            "open_fraction": self.pad(open_fractions(self.loaded)),
        }

    def _info(self) -> dict:
        root = self.loaded.articulation.links[0]
        up = pose_matrix(root.entity_pose)[2, 2]
        speed = max(np.linalg.norm(root.linear_velocity), np.linalg.norm(root.angular_velocity))
        return {
            "success": False,
            "object": self.object_name,
            "tilt_degrees": float(np.degrees(np.arccos(np.clip(up, -1.0, 1.0)))),
            "speed": float(speed),
        }
