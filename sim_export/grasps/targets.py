"""What a gripper shall hold: handles, parts that move without one, and loose objects."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.types import Joint
from sim_export.motion.kinematics import hanging_links, object_joints
from sim_export.package import HandleAnnotation, SimPackage
from sim_export.physics.annotations import joint_velocity

PUSHED_CLASSES = ("slider_button", "hinge_knob")
GRASPED_LABELS = ("door", "drawer", "tray", "knob", "handle")


@dataclass(frozen=True, kw_only=True, eq=False)
class Target:
    """What a gripper shall hold: a handle, or a whole link. ``joint`` opens it; None for a loose object."""

    link: str
    part: str
    joint: Joint | None
    region: Float[np.ndarray, "8 3"] | None = None
    normal: Float[np.ndarray, "3"] | None = None


def find_targets(package: SimPackage) -> tuple[Target, ...]:
    """What may be held: handles that are pulled or turned, else whole parts that move; a loose object."""
    movers = {joint.child: joint for joint in object_joints(package.joints)}
    if not movers:
        hulls = [link for link in package.links if link.hulls]
        up = np.array([0.0, 0.0, 1.0])
        return tuple(
            Target(link=link.name, part=link.parts[0], joint=None, normal=up) for link in hulls if link.parts
        )
    found = []
    for handle in package.handles:
        if handle.link not in movers or is_pushed(handle, movers[handle.link]):
            continue
        held = _find_lever(package, handle)
        found.append(
            Target(
                link=held.link, part=held.part, joint=movers[handle.link],
                region=held.corners, normal=held.normal,
            )
        )  # fmt: skip
    held = {handle.link for handle in package.handles}
    found += [
        Target(link=link.name, part=link.parts[0], joint=movers[link.name])
        for link in package.links
        if link.name in movers
        and link.label in GRASPED_LABELS
        and link.parts
        and not held & hanging_links(package.joints, link.name)
    ]
    return tuple(found)


def is_pushed(handle: HandleAnnotation, joint: Joint) -> bool:
    """Whether a handle is a button, a rocker or a pedal: a place of it moves against its normal as the joint
    opens, or it is hinged and springs back."""
    if handle.gapart not in PUSHED_CLASSES:
        return False
    ways = np.array([joint_velocity(joint, corner) for corner in handle.corners])
    against = (ways @ handle.normal).min() < -0.5 * np.linalg.norm(ways, axis=1).max()
    return bool(against or (joint.type == "revolute" and joint.spring > 0.0))


def _find_lever(package: SimPackage, handle: HandleAnnotation) -> HandleAnnotation:
    """The lever that hangs on a hinged knob and turns it, or the handle itself."""
    hung = hanging_links(package.joints, handle.link) - {handle.link}
    levers = (each for each in package.handles if each.link in hung and each.gapart == handle.gapart)
    return next(levers, handle) if handle.gapart == "hinge_knob" else handle
