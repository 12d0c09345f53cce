"""Loads a package into a ManiSkill scene: friction and damping in SI units, no visuals without a render
device. Followers, springs and chains act at every step of the scene, whatever environment it is part of."""

import shutil
from collections.abc import Collection, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import sapien
import torch
from jaxtyping import Float
from mani_skill.agents.robots import Fetch, Panda
from mani_skill.utils import sapien_utils
from mani_skill.utils.structs import Pose

from artigen.errors import ArtigenError
from sim_export.package import SimPackage

from ..sim.articulation import equip, prepare
from ..sim.hull_cache import forget_changed_hulls
from ..sim.urdf_text import without_visuals
from .mechanisms import add_mechanism, mechanism_of
from .objects import TaskObject

if TYPE_CHECKING:
    from mani_skill.agents.base_agent import BaseAgent
    from mani_skill.envs.sapien_env import BaseEnv
    from mani_skill.envs.scene import ManiSkillScene
    from mani_skill.utils.building.articulation_builder import ArticulationBuilder
    from mani_skill.utils.structs import Actor, Articulation

SURFACE = {"static_friction": 1.0, "dynamic_friction": 1.0, "restitution": 0.0}
"""Contact material of every object, as in ManiSkill's own cabinet tasks."""


class LoadError(ArtigenError):
    """The engine lost part of a package; the message names the link and what is missing."""


def load_object(
    scene: "ManiSkillScene",
    entry: TaskObject,
    name: str,
    scene_index: int,
    *,
    endless: Literal["turn", "hold"] = "turn",
    held: Collection[str] = (),
) -> tuple["Articulation", dict[str, Float[np.ndarray, "4 4"]]]:
    """Builds an object at the origin, on the floor, fixed to the world, in one of the parallel scenes.

    Args:
        scene: ManiSkill scene; visuals are built only if it can render.
        endless: Whether wheels and other joints without limits turn or are fixed at rest.
        held: Joints without their springs, because something keeps them where they are.

    Returns:
        The articulation, and ``T_object_link`` at rest of every link by name.

    Raises:
        LoadError: If a collision shape was lost.
    """
    builder = _parse(scene, entry.folder)
    package = prepare(builder, entry.package, entry.folder, 1 + len(scene.articulations))
    if endless == "hold":
        _hold_endless(builder, package)
    pose = sapien.Pose(p=[0.0, 0.0, -entry.floor])
    articulation = _build(builder, entry.folder, package, name, scene_index, pose, held)
    return articulation, _link_frames(builder)


def load_placed(
    scene: "ManiSkillScene", folder: Path, package: SimPackage, name: str, scene_index: int, pose: Pose
) -> "Articulation":
    """Builds a package fixed at ``pose``, all joints at 0; otherwise as `load_object`."""
    builder = _parse(scene, folder)
    package = prepare(builder, package, folder, 1 + len(scene.articulations))
    return _build(builder, folder, package, name, scene_index, pose)


def load_robot(env: "BaseEnv", name: str, pose: sapien.Pose) -> "BaseAgent":
    """The robot ``panda`` or ``fetch`` at an initial pose in an environment, without visuals if its scene
    cannot render: SAPIEN would look for a render device as soon as it reads a material."""
    agent: type[BaseAgent] = {"panda": Panda, "fetch": Fetch}[name]
    with ExitStack() as stack:
        # Only Fetch has materials; Panda's end-effector controllers also read its own file.
        if name == "fetch" and not env.scene.can_render():
            urdf = Path(str(agent.urdf_path))
            stripped = stack.enter_context(without_visuals(urdf))
            shutil.copy(urdf.with_suffix(".srdf"), stripped.parent)
            agent = type(agent.__name__, (agent,), {"urdf_path": str(stripped)})
        return agent(env.scene, env._control_freq, env._control_mode, initial_pose=pose)


def build_box(
    scene: "ManiSkillScene",
    name: str,
    scene_index: int,
    low: Float[np.ndarray, "3"],
    high: Float[np.ndarray, "3"],
    color: Sequence[float] | None = None,
) -> "Actor":
    """Builds a static box in one of the parallel scenes."""
    half = tuple(((high - low) / 2.0).tolist())
    builder = scene.create_actor_builder()
    builder.add_box_collision(half_size=half)
    if scene.can_render():
        paint = None if color is None else sapien.render.RenderMaterial(base_color=[*color, 1.0])
        builder.add_box_visual(half_size=half, material=paint)
    builder.set_scene_idxs([scene_index])
    builder.initial_pose = Pose.create(sapien.Pose(p=((high + low) / 2.0).tolist()))
    return builder.build_static(name=name)


def place_robot(env: "BaseEnv", qpos: Float[np.ndarray, "B Q"], base: Float[np.ndarray, "B 4"]) -> None:
    """Sets the joints of an environment's robots and their bases: x, y, z and yaw.

    The base of Fetch moves by its first three joints, on the floor.
    """
    p, q = np.zeros((len(base), 3)), np.zeros((len(base), 4))
    q[:, 0] = 1.0
    if env.robot_uids == "fetch":
        qpos[:, :3] = base[:, [0, 1, 3]]
    else:
        p, yaw = base[:, :3], base[:, 3]
        q[:, 0], q[:, 3] = np.cos(yaw / 2.0), np.sin(yaw / 2.0)
    env.agent.reset(torch.tensor(qpos, dtype=torch.float32, device=env.device))
    pose = Pose.create_from_pq(torch.tensor(p).float(), torch.tensor(q).float(), device=env.device)
    env.agent.robot.set_pose(pose)  # type: ignore[arg-type]


def _parse(scene: "ManiSkillScene", folder: Path) -> "ArticulationBuilder":
    """The builder of a package's articulation, with a fixed root."""
    forget_changed_hulls(folder)
    loader = scene.create_urdf_loader()
    loader.fix_root_link = True
    loader.load_multiple_collisions_from_file = True
    sapien_utils.apply_urdf_config(loader, sapien_utils.parse_urdf_config({"material": SURFACE}))
    urdf, srdf = folder / "mobility.urdf", str(folder / "mobility.srdf")
    if scene.can_render():
        return loader.parse(str(urdf), srdf)["articulation_builders"][0]
    with without_visuals(urdf) as stripped:
        return loader.parse(str(stripped), srdf)["articulation_builders"][0]


def _hold_endless(builder: "ArticulationBuilder", package: SimPackage) -> None:
    """Replaces joints without limits, and what follows them, with fixed ones at rest."""
    held = {joint.name for joint in package.joints if joint.type == "continuous"}
    held |= {joint.name for joint in package.joints if joint.follows in held}
    for link in builder.link_builders:
        if link.joint_record.name in held:
            link.joint_record.joint_type = "fixed"


def _build(
    builder: "ArticulationBuilder",
    folder: Path,
    package: SimPackage,
    name: str,
    scene_index: int,
    pose: sapien.Pose | Pose,
    held: Collection[str] = (),
) -> "Articulation":
    builder.set_scene_idxs([scene_index])
    builder.initial_pose = pose
    articulation = builder.build(name=name, build_mimic_joints=False)
    prefix = f"scene-{scene_index}-{name}_"
    for engine in articulation._objs:
        equip(engine, package, prefix=prefix)
    add_mechanism(articulation, mechanism_of(articulation, package, held))
    _compare(articulation, folder, package, prefix)
    return articulation


def _link_frames(builder: "ArticulationBuilder") -> dict[str, Float[np.ndarray, "4 4"]]:
    """``T_object_link`` at rest of every link, by name, from an articulation builder."""
    frames: dict[str, np.ndarray] = {}
    for link in builder.link_builders:
        if link.parent is None:
            frames[link.name] = np.eye(4)
            continue
        local = link.joint_record.pose_in_parent * link.joint_record.pose_in_child.inv()
        local = np.asarray(local.to_transformation_matrix(), dtype=np.float64)
        frames[link.name] = frames[link.parent.name] @ local
    return frames


def _compare(articulation: "Articulation", folder: Path, package: SimPackage, prefix: str) -> None:
    wanted = {link.name: len(link.hulls) for link in package.links}
    for link in articulation._objs[0].links:
        name = link.name.removeprefix(prefix)
        if len(link.collision_shapes) < wanted[name]:
            raise LoadError(
                f"{folder}: link {name!r} has {len(link.collision_shapes)} collision shapes in the "
                f"engine, the package has {wanted[name]}; run artigen validate on it"
            )
