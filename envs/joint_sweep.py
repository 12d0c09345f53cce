"""``ArtiGen/JointSweep-v0``: move every joint through its range without penetration."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np

from sim_export.errors import DegeneratePart
from sim_export.geometry.contacts import HullSet, penetration_depths
from sim_export.geometry.hulls import convex_hull

from .base import PackageEnv, Packages
from .hand import pose_matrix, shape_vertices
from .randomize import Randomization
from .sim.loaded import set_open_fraction


@dataclass(frozen=True, kw_only=True)
class JointSweepConfig:
    """Thresholds of a sweep."""

    step: float = 0.1
    """Share of its range by which a full action moves a joint."""
    bins: int = 10
    """Equal intervals that each range is divided into; a sweep visits all of them."""
    tolerance: float = 0.002
    """Penetration (m) beyond the overlap at rest that is tolerated."""

    def __post_init__(self) -> None:
        if not (0.0 < self.step <= 1.0 and self.bins >= 2 and self.tolerance >= 0.0):
            raise ValueError(
                f"step {self.step} in (0, 1], bins {self.bins} >= 2, tolerance {self.tolerance} >= 0"
            )


class JointSweepEnv(PackageEnv):
    """Joints are posed, not driven: the environment is kinematic.

    **Action** ``[J]`` in [-1, 1]: moves joint j by ``cfg.step`` of its range, opening if positive; positions
    stop at the limits, joints without limits stop at 0 and at one full turn.

    **Observation** ``open_fraction [J]`` in [0, 1], and ``penetration [1]``: the deepest overlap (m) of any
    two links at this pose beyond their overlap at rest, parents and children included, exact for the hulls
    that the engine uses.

    **Reward** the share of all bins of all joints, except the starting ones, that this step visits for the
    first time, and -1 for a pose that penetrates by more than ``cfg.tolerance``. A perfect sweep returns 1.

    **Success** (``info["success"]``, ends the episode): every bin of every joint has been visited and no pose
    of the episode penetrated. Joints that require another one to be open must wait for it.

    **Reset** all joints at their lower limits; deterministic.

    Version history: v0 first version.
    """

    def __init__(
        self,
        package: Packages,
        cfg: JointSweepConfig | None = None,
        render_mode: str | None = None,
        randomize: Randomization | Mapping[str, Any] | None = None,
    ) -> None:
        self.cfg = cfg or JointSweepConfig()
        super().__init__(package, render_mode, randomize)
        self.action_space = gym.spaces.Box(-1.0, 1.0, (self.width,), np.float32)
        self.observation_space = gym.spaces.Dict(
            {
                "open_fraction": gym.spaces.Box(0.0, 1.0, (self.width,), np.float32),
                "penetration": gym.spaces.Box(0.0, np.inf, (1,), np.float32),
            }
        )

    def _adopt(self) -> None:
        count = len(self.loaded.joints)
        self._hulls = {
            link.name: _hull_set(link) for link in self.loaded.articulation.links if link.collision_shapes
        }
        self._fractions = np.zeros(count)
        self._visited = np.zeros((count, self.cfg.bins), dtype=bool)
        self._clean = True
        set_open_fraction(self.loaded, 0.0)
        self._rest = self._overlaps()

    def reset(self, *, seed: int | None = None, options: dict | None = None):
        """Closes every joint and resets the visited bins."""
        self._rebuild(seed, options)
        self._fractions = np.zeros(len(self._fractions))
        self._visited = np.zeros_like(self._visited)
        self._clean = True
        set_open_fraction(self.loaded, 0.0)
        self._visit()
        return self._observe(0.0), self._info()

    def step(self, action: np.ndarray):
        """Poses the joints and measures every pair of links."""
        push = np.clip(np.asarray(action, dtype=np.float64), -1.0, 1.0)[: len(self._fractions)]
        self._fractions = np.clip(self._fractions + self.cfg.step * push, 0.0, 1.0)
        set_open_fraction(self.loaded, self._fractions)
        depth = max((depth - self._rest[pair] for pair, depth in self._overlaps().items()), default=0.0)
        depth = max(0.0, depth)
        dirty = depth > self.cfg.tolerance
        reward = self._visit() / (self._visited.size - len(self._visited)) - float(dirty)
        self._clean = self._clean and not dirty
        info = self._info()
        return self._observe(depth), reward, info["success"], False, info

    def _visit(self) -> int:
        """Marks the bins of the current pose; returns the number of new ones."""
        columns = np.minimum((self._fractions * self.cfg.bins + 1e-9).astype(int), self.cfg.bins - 1)
        rows = np.arange(len(columns))
        new = int((~self._visited[rows, columns]).sum())
        self._visited[rows, columns] = True
        return new

    def _overlaps(self) -> dict[tuple[str, str], float]:
        """Depth (m) of every pair of links that have hulls."""
        links = [link for link in self.loaded.articulation.links if link.name in self._hulls]
        poses = {link.name: pose_matrix(link.entity_pose) for link in links}
        names = sorted(poses)
        return {
            (a, b): float(penetration_depths(self._hulls[a], self._hulls[b], poses[a], poses[b])[0])
            for index, a in enumerate(names)
            for b in names[index + 1 :]
        }

    def _observe(self, depth: float) -> dict[str, np.ndarray]:
        return {
            "open_fraction": self.pad(self._fractions.astype(np.float32)),
            "penetration": np.array([depth], dtype=np.float32),
        }

    def _info(self) -> dict:
        return {
            "success": bool(self._visited.all() and self._clean),
            "object": self.object_name,
            "covered": float(self._visited.mean()),
        }


def _hull_set(link) -> HullSet:
    hulls = []
    for shape in link.collision_shapes:
        try:
            hulls.append(convex_hull(shape_vertices(shape)))
        except DegeneratePart:
            continue  # a flat shape of a foreign package has no volume to penetrate
    return HullSet(hulls=tuple(hulls))
