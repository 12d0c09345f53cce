"""What a package states and SAPIEN's loader leaves out, set on builders and articulations of any scene.

Shared by scenes of SAPIEN and of ManiSkill. `equip` sets what lasts: friction, damping, speed limits, drives
of followers, iterations for chains. `act_before_steps` adds to a scene what acts anew at every step.
"""

import weakref
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from artigen.types import Joint
from sim_export.package import SimPackage

from .friction import apply_resistance, drive_follower, hold_chains, pull_spring
from .ignored_links import ignore_links
from .mechanism import Mechanism

if TYPE_CHECKING:
    from sapien.physx import PhysxArticulation


def prepare(builder: Any, package: SimPackage, folder: Path, own: int) -> SimPackage:
    """Readies SAPIEN's builder of a package: no tendons between joints, threads with ends, own contacts.

    Args:
        folder: The package's; its SRDF names pairs of links whose contacts are ignored.
        own: Number of the object in its scene, from 1.

    Returns:
        The package with every screw's turn limited to the ends of its thread.
    """
    package = limit_screws(package)
    builder.mimic_joint_records.clear()
    leaders = {joint.follows for joint in package.joints if joint.follows is not None}
    limits = {joint.name: [[joint.lower, joint.upper]] for joint in package.joints if joint.name in leaders}
    for link in builder.link_builders:
        record = link.joint_record
        if record.name in limits and record.joint_type == "revolute":
            record.joint_type, record.limits = "revolute_unwrapped", limits[record.name]
        # SAPIEN ignores contact of links that share a bit of group 2 and the number in group 3, robots' too.
        link.collision_groups[3] = own
    if (folder / "mobility.srdf").is_file():
        ignore_links(builder, folder / "mobility.srdf")
    return package


def equip(
    articulation: "PhysxArticulation",
    package: SimPackage,
    *,
    prefix: str = "",
    resistance: Literal["package", "engine"] = "package",
) -> None:
    """Sets on an articulation what its package states beyond SAPIEN's loader.

    Args:
        prefix: What the engine's names of joints have before the package's.
        resistance: ``engine`` keeps SAPIEN's reading of friction and damping.
    """
    specs = {prefix + joint.name: joint for joint in package.joints}
    for joint in articulation.active_joints:
        spec = specs[joint.name]
        if spec.follows is not None:
            drive_follower(joint, spec, package)
        elif resistance == "package":
            apply_resistance(articulation, joint, spec)
    if resistance == "package":
        hold_chains(articulation, package)


def step_followers_and_springs(articulation: "PhysxArticulation", mechanism: Mechanism) -> None:
    """Moves followers towards their places and applies the forces of springs, for one step on the CPU."""
    joints, qpos = articulation.active_joints, articulation.qpos
    for each in mechanism.followers:
        joints[each.column].set_drive_target(each.follow(float(qpos[each.leader])))
    for each in mechanism.springs:
        pull_spring(joints[each.column], each.spec, float(qpos[each.column]))


def act_before_steps(scene: Any, act: Callable[[Any], None]) -> None:
    """Makes every ``scene.step()`` call ``act`` with the scene first, whoever calls it.

    Args:
        scene: Scene of SAPIEN or ManiSkill. Neither has a hook, so the scene gets a ``step`` of its own,
            which calls what was added in order, and then the step of its class.
    """
    acts: list[Callable[[Any], None]] | None = vars(scene).get("_acts_before_steps")
    if acts is None:
        acts = scene._acts_before_steps = []
        whole = weakref.ref(scene)  # a scene that holds itself would be freed late

        def step() -> None:
            here = whole()
            assert here is not None
            for each in acts:
                each(here)
            type(here).step(here)

        scene.step = step
    acts.append(act)


def limit_screws(package: SimPackage) -> SimPackage:
    """Limits every screw's turn to the ends of its thread."""
    followers = {joint.follows: joint for joint in package.joints if joint.follows is not None}

    def limit(joint: Joint) -> Joint:
        follower = followers.get(joint.name)
        if follower is None or joint.type != "continuous" or follower.ratio == 0.0:
            return joint
        travel = (follower.lower - follower.offset, follower.upper - follower.offset)
        ends = sorted(end / follower.ratio for end in travel)
        return replace(joint, type="revolute", lower=ends[0], upper=ends[1])

    return replace(package, joints=tuple(limit(joint) for joint in package.joints))
