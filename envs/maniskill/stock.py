"""ManiSkill's own cabinet tasks on packages: ``ArtiGen-OpenCabinetDrawer-v1`` and ``...Door-v1``.

    import envs, gymnasium
    env = gymnasium.make("ArtiGen-OpenCabinetDrawer-v1", packages="out/packages", robot_uids="fetch")
    env.reset(seed=0)

Initial positions, observations, success and rewards are ManiSkill's. Only the loading differs: cabinets come
from packages and handles from their annotations instead of from render shapes, so that neither a download nor
a render device is needed. Joints without limits are fixed, because their limit -inf would become the
cabinet's pose.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import sapien
import torch
from mani_skill.envs.tasks.mobile_manipulation.open_cabinet_drawer import (
    OpenCabinetDoorEnv,
    OpenCabinetDrawerEnv,
)
from mani_skill.utils.structs import Articulation, Link

from artigen.transforms import inverse, transform_points
from sim_export.files.folders import name_folders

from ..sim.mechanism import Mechanism
from .load import load_object, load_robot
from .mechanisms import mechanism_of
from .objects import TaskError, Validation, read_objects
from .task import AWAY


class _FromPackages:
    """Replaces the loading of cabinets and of the robot in ManiSkill's cabinet tasks."""

    def __init__(
        self,
        *args: Any,
        packages: str | Path | Sequence[str | Path],
        validation: Validation = "passed",
        **kwargs: Any,
    ) -> None:
        types = getattr(self, "handle_types")  # noqa: B009
        objects = read_objects(packages, "any", handles="required", validation=validation)
        fitting = [
            (entry, tuple(part for part in entry.parts if part.joint.type in types)) for entry in objects
        ]
        self.choices = [(entry, parts) for entry, parts in fitting if parts]
        if not self.choices:
            found = sorted({part.joint.type for entry in objects for part in entry.parts})
            raise TaskError(
                f"{len(objects)} packages have parts with handles on {', '.join(found)} joints and none on "
                f"{' or '.join(types)} ones, which {type(self).__name__} opens"
            )
        super().__init__(*args, **kwargs)

    def _load_agent(self: Any, options: dict) -> None:
        self.agent = load_robot(self, "fetch", AWAY)

    def _load_cabinets(self: Any, joint_types: list[str]) -> None:
        self._cabinets: list[Articulation] = []
        self._heights: list[float] = []
        self._mechanisms: list[Mechanism] = []
        self._names: list[str] = []
        folders = [entry.folder for entry, _ in self.choices]
        named = dict(zip(folders, name_folders(folders), strict=True))
        links: list[Link] = []
        grips = []
        for index in range(self.num_envs):
            rng = self._batched_episode_rng[index]
            entry, parts = self.choices[rng.randint(len(self.choices))]
            part = parts[rng.randint(len(parts))]
            name = f"{entry.package.name}-{index}"
            cabinet, frames = load_object(self.scene, entry, name, index, endless="hold")
            self.remove_from_state_dict_registry(cabinet)
            grips.append(transform_points(inverse(frames[part.joint.child]), part.grip[None])[0])
            links.append(cabinet.links_map[part.joint.child])
            self._cabinets.append(cabinet)
            self._heights.append(-entry.floor)
            self._names.append(named[entry.folder])
            self._mechanisms.append(mechanism_of(cabinet, entry.package))
        self.cabinet = Articulation.merge(self._cabinets, name="cabinet")
        self.add_to_state_dict_registry(self.cabinet)
        self.handle_link = Link.merge(links, name="handle_link")
        self.handle_link_pos = torch.tensor(np.array(grips), dtype=torch.float32, device=self.device)
        self.handle_link_goal = _build_goal(self.scene)

    def get_info(self: Any) -> dict:
        """What ManiSkill says, and ``object``: a name for every parallel scene."""
        return super().get_info() | {"object": self._names}  # type: ignore[misc]

    def _after_reconfigure(self: Any, options: dict) -> None:
        """ManiSkill takes an object's height from its shapes in the world, where it stands on the floor."""
        super()._after_reconfigure(options)  # type: ignore[misc]
        self.cabinet_zs = torch.tensor(self._heights, dtype=torch.float32, device=self.device)

    def _initialize_episode(self: Any, env_idx: torch.Tensor, options: dict) -> None:
        """ManiSkill closes all joints by their lower limits; followers go where their leaders put them."""
        super()._initialize_episode(env_idx, options)  # type: ignore[misc]
        for index in env_idx.tolist():
            if mechanism := self._mechanisms[index]:
                cabinet = self._cabinets[index]
                cabinet.set_qpos(mechanism.complete(cabinet.get_qpos()))


class PackageDrawerEnv(_FromPackages, OpenCabinetDrawerEnv):
    """ManiSkill's OpenCabinetDrawer with the sliding parts of packages that have handles."""

    handle_types = ["prismatic"]  # noqa: RUF012


class PackageDoorEnv(_FromPackages, OpenCabinetDoorEnv):
    """ManiSkill's OpenCabinetDoor with the turning parts of packages that have handles."""

    handle_types = ["revolute"]  # noqa: RUF012


def _build_goal(scene: Any) -> Any:
    """ManiSkill's marker sphere at the handle; without a render device an empty actor."""
    builder = scene.create_actor_builder()
    if scene.can_render():
        material = sapien.render.RenderMaterial(base_color=[0, 1, 0, 1])
        builder.add_sphere_visual(radius=0.02, material=material)
    builder.initial_pose = sapien.Pose()
    return builder.build_kinematic(name="handle_link_goal")
