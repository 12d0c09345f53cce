"""Followers and springs of packages in a ManiSkill scene, at every step of it."""

from collections.abc import Collection
from functools import partial
from typing import TYPE_CHECKING, Any

from sim_export.package import SimPackage

from ..sim.articulation import act_before_steps, step_followers_and_springs
from ..sim.mechanism import Mechanism, find_mechanism

if TYPE_CHECKING:
    from mani_skill.envs.scene import ManiSkillScene
    from mani_skill.utils.structs import Articulation


def mechanism_of(articulation: "Articulation", package: SimPackage, held: Collection[str] = ()) -> Mechanism:
    """The mechanism of a loaded package by the articulation's joint vector (`find_mechanism`)."""
    return find_mechanism(package, [joint.name for joint in articulation.active_joints], held)


def add_mechanism(articulation: "Articulation", mechanism: Mechanism) -> None:
    """Makes followers follow and springs pull at every step of an articulation's scene.

    On the GPU springs are left out.
    """
    on_gpu = articulation.scene.gpu_sim_enabled
    if mechanism.followers or (mechanism.springs and not on_gpu):
        act_before_steps(articulation.scene, partial(_act, articulation, mechanism))


def _act(articulation: "Articulation", mechanism: Mechanism, scene: "ManiSkillScene") -> None:
    """Moves followers and springs of an object while it is in its scene."""
    if scene.articulations.get(articulation.name) is not articulation:
        return
    if scene.gpu_sim_enabled:
        _follow_on_gpu(articulation, mechanism)
        return
    for engine in articulation._objs:
        step_followers_and_springs(engine, mechanism)


def _follow_on_gpu(articulation: "Articulation", mechanism: Mechanism) -> None:
    """Sets the targets of all followers from the positions after the last step."""
    physics: Any = articulation.px
    physics.gpu_fetch_articulation_qpos()
    wanted = mechanism.complete(articulation.get_qpos())
    columns = [each.column for each in mechanism.followers]
    joints = [articulation.active_joints[column] for column in columns]
    articulation.set_joint_drive_targets(wanted[:, columns], joints)
    physics.gpu_apply_articulation_target_position()
