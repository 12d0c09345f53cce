"""Friction, damping, effort and velocity of joints, from the masses that they carry."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from artigen.types import Joint, PartLabel
from sim_export.geometry.wheels import STEEPEST_AXLE
from sim_export.motion.kinematics import driven_joints, hanging_links, link_displacements
from sim_export.package import Inertial, Link
from sim_export.physics.inertia import inertia_about, subtree_inertial
from sim_export.physics.materials import GRAVITY, joint_resistance, rolling_resistance

HOLD_SLOPE = 0.09
TRIED_POSES = 9
"""Positions of each joint of a chain that are tried for the greatest moment."""
LATCH_HOLD = 2.0
"""Holding force of a latch relative to its load under gravity: it has a spring, and the leaf it holds pushes
on it too."""
STAY_FORCE = 15.0
"""Largest force (N) at the far edge of a lid with which the friction of its stays resists a hand, and largest
weight of what slides down. Springs carry the rest of a heavy lid, such as a freezer's, and two thirds of a
heavy sash."""
SHORTEST_DECAY = 0.1
"""Smallest time constant of damping (seconds); engines exaggerate damping that stops a body within a few
steps of 1/60 s."""


def opening_pull(joint: Joint, moved: Inertial) -> float:
    """Largest force (N) or torque (N m) with which gravity opens a closed joint on a sloping floor; 0 if it
    closes it.

    Catches, seals and runners keep furniture shut on floors that slope by 5 degrees in any direction;
    `HOLD_SLOPE` is slightly larger.
    """
    weight = moved.mass * GRAVITY
    arm = np.asarray(moved.com) - joint.origin
    moving = np.asarray(joint.axis) if joint.type == "prismatic" else np.cross(joint.axis, arm)
    if joint.type == "continuous":  # it may start from any position; a level turntable only feels the slope
        return weight * float(np.linalg.norm(moving)) * (float(np.hypot(*joint.axis[:2])) + HOLD_SLOPE)
    level = -weight * float(moving[2])
    return max(0.0, level + HOLD_SLOPE * weight * float(np.hypot(moving[0], moving[1])))


def greatest_moment(links: Sequence[Link], joints: Sequence[Joint], joint: Joint) -> float:
    """Greatest gravity moment (N m) about a turning joint, over all its positions and those of the joints
    that hang from it.

    It is what the hinge of a lamp's arm holds when the arms are stretched, found by moving one joint after
    the other to where the moment is greatest.
    """
    inside = hanging_links(joints, joint.child)
    held = [(k, link.inertial) for k, link in enumerate(links) if link.name in inside and link.inertial]
    hanging = [other for other in driven_joints(joints) if other.parent in inside]
    qpos: dict[str, ArrayLike] = {}

    def moment() -> Float[np.ndarray, "*B"]:
        T = link_displacements(links, joints, qpos)
        arms = [own.mass * (T[..., k, :3, :3] @ own.com + T[..., k, :3, 3] - joint.origin) for k, own in held]
        return GRAVITY * np.linalg.norm(np.cross(joint.axis, sum(arms)), axis=-1)

    for other in (*hanging, *hanging):
        tried = np.linspace(other.lower, other.upper, TRIED_POSES)
        qpos[other.name] = tried
        qpos[other.name] = tried[int(moment().argmax())]
    return float(moment())


def resist_joints(
    links: Sequence[Link],
    joints: Sequence[Joint],
    latched: frozenset[str] = frozenset(),
    stays: frozenset[str] = frozenset(),
) -> tuple[Joint, ...]:
    """Friction, damping, effort and velocity of every movable joint.

    ``latched`` are parts held shut by a latch, ``stays`` parts whose hinges hold them wherever they are left.
    """
    held = {link.name for link in links if latched & set(link.parts[:1])}
    stayed = {link.name for link in links if stays & set(link.parts[:1])}
    labels: dict[str, PartLabel | None] = {link.name: link.label for link in links}
    leads = {joint.follows: joint for joint in joints if joint.follows is not None}
    by_name = {link.name: link for link in links}
    rolling = _rolling_loads(links, joints)
    out = []
    for joint in joints:
        follower = leads.get(joint.name)
        label = labels[follower.child if follower is not None else joint.child]
        if joint.type == "fixed" or label is None:
            out.append(joint)
            continue
        if joint.follows is not None:  # the turning joint has the resistance of both
            out.append(replace(joint, friction=0.0, damping=0.0, effort=100.0, velocity=1.0))
            continue
        moved = subtree_inertial(links, joints, joint.child)
        if joint.child in held:
            hold = 0.0
        elif joint.child in stayed:
            moment = (1.0 + HOLD_SLOPE) * greatest_moment(links, joints, joint)
            hold = min(moment, STAY_FORCE * _reach(by_name[joint.child], joint))
            joint = replace(joint, spring=min(0.0, hold - moment))  # counterbalances the rest
        elif joint.type == "revolute" and (label == "handle" or joint.parent in held):
            # Arms of lamps, bails and the levers of latches stay where they are put.
            hold = (1.0 + HOLD_SLOPE) * greatest_moment(links, joints, joint)
        else:
            hold = opening_pull(joint, moved)
            sinks = -moved.mass * GRAVITY * float(joint.axis[2])
            if joint.type == "prismatic" and joint.upper > 0.0 and sinks > STAY_FORCE:
                # The upper sash of a window has a balance: a spring carries its weight half way down.
                joint = replace(joint, spring=sinks / 1.5)
                hold = (1.0 + HOLD_SLOPE) * (hold - joint.spring)
        if joint.parent in held:  # a latch, loaded by its leaf
            hold *= LATCH_HOLD
        if follower is not None:  # an upright screw is self-locking
            climb = abs(float(follower.axis[2])) * follower.ratio
            hold += (1.0 + HOLD_SLOPE) * moved.mass * GRAVITY * climb
        hold = max(hold, rolling.get(joint.name, 0.0))
        resist = joint_resistance(label, joint.kind, moved.mass, hold)
        turning = float(joint.axis @ inertia_about(moved, joint.origin) @ joint.axis)
        moment = moved.mass if joint.type == "prismatic" else turning
        out.append(
            replace(
                joint,
                friction=resist.friction,
                damping=min(resist.damping, moment / SHORTEST_DECAY),
                effort=resist.effort,
                velocity=resist.velocity,
            )
        )
    return tuple(out)


def _rolling_loads(links: Sequence[Link], joints: Sequence[Joint]) -> dict[str, float]:
    """Torque (N m) by joint that turns each wheel of an object which stands on all of them."""
    by_name = {link.name: link for link in links}
    wheels = [
        joint
        for joint in joints
        if by_name[joint.child].label == "wheel"
        and by_name[joint.child].hulls
        and abs(joint.axis[2]) <= STEEPEST_AXLE
    ]
    mass = sum(link.inertial.mass for link in links if link.inertial is not None)
    out = {}
    for joint in wheels:
        out[joint.name] = rolling_resistance(mass / len(wheels), _reach(by_name[joint.child], joint))
    return out


def _reach(link: Link, joint: Joint) -> float:
    """Largest distance (m) of a link's hulls from the axis of its joint."""
    points = np.concatenate([np.zeros((0, 3)), *(hull.vertices for hull in link.hulls)]) - joint.origin
    return float(np.linalg.norm(np.cross(joint.axis, points), axis=1).max(initial=0.0))
