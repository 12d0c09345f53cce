"""Forward kinematics of package links.

Links and joints are given in the object frame at rest, so that the displacement of a link is its
parent's displacement times its own joint's motion, as in `artigen.kinematics`.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from artigen.transforms import screw_motion
from sim_export.errors import InvalidKinematics
from sim_export.package import Link, PackageJoint
from sim_export.tree import hanging_links

MOVING_TYPES = ("revolute", "prismatic", "continuous")


def driven_joints(joints: Sequence[PackageJoint]) -> tuple[PackageJoint, ...]:
    """The joints with a coordinate of their own: those that move and mimic no other."""
    return tuple(joint for joint in joints if joint.type in MOVING_TYPES and joint.mimic is None)


def longest_side(links: Sequence[Link]) -> float:
    """Longest side (m) of the box around all hulls at rest; 0 without hulls."""
    chunks = [hull.vertices for link in links for hull in link.hulls]
    return float(np.ptp(np.concatenate(chunks), axis=0).max()) if chunks else 0.0


def box_diagonal(links: Sequence[Link]) -> float:
    """Diagonal (m) of the box around all hulls at rest; 0 without hulls."""
    chunks = [hull.vertices for link in links for hull in link.hulls]
    return float(np.linalg.norm(np.ptp(np.concatenate(chunks), axis=0))) if chunks else 0.0


def package_joint_motion(joint: PackageJoint, q: Float[np.ndarray, "*B"]) -> Float[np.ndarray, "*B 4 4"]:
    """Displacement by one joint at its own coordinate ``q`` (rad or m)."""
    still = np.zeros_like(np.asarray(q, dtype=np.float64))
    match joint.type:
        case "fixed":
            return screw_motion(joint.axis, joint.origin, still, still)
        case "prismatic":
            return screw_motion(joint.axis, joint.origin, still, q)
        case "revolute" | "continuous":
            return screw_motion(joint.axis, joint.origin, q, still)


def link_displacements(
    links: Sequence[Link], joints: Sequence[PackageJoint], qpos: Mapping[str, object]
) -> Float[np.ndarray, "*B L 4 4"]:
    """Displacement of every link from rest, in the order of ``links`` and in the object frame.

    Args:
        links: The links of a package.
        joints: Its joints.
        qpos: Coordinate of driven joints by name, numbers or arrays of poses that broadcast;
            joints that are not named stay at 0, mimicking ones follow theirs.

    Raises:
        InvalidKinematics: if joints and links do not form a tree.
        ValueError: if ``qpos`` names a joint that is not driven.
    """
    driven = {joint.name for joint in driven_joints(joints)}
    unknown = sorted(set(qpos) - driven)
    if unknown:
        raise ValueError(f"qpos names {', '.join(unknown)}; driven joints are {', '.join(sorted(driven))}")
    coordinates = {name: np.asarray(value, dtype=np.float64) for name, value in qpos.items()}
    poses = np.broadcast_shapes(*(value.shape for value in coordinates.values()))
    out = np.tile(np.eye(4), (*poses, len(links), 1, 1))
    slot = {link.name: index for index, link in enumerate(links)}
    for joint in _parents_first(links, joints):
        source, ratio = (joint.name, 1.0) if joint.mimic is None else (joint.mimic, joint.mimic_multiplier)
        own = package_joint_motion(joint, ratio * coordinates.get(source, np.zeros(())))
        out[..., slot[joint.child], :, :] = out[..., slot[joint.parent], :, :] @ own
    return out


def moved_links(
    links: Sequence[Link], joints: Sequence[PackageJoint], joint: PackageJoint
) -> tuple[int, ...]:
    """Indices of the links that ``joint`` moves: its child, what follows it, and all that hangs from them."""
    moving = [joint.child, *(other.child for other in joints if other.mimic == joint.name)]
    moved = frozenset().union(*(hanging_links(joints, link) for link in moving))
    return tuple(index for index, link in enumerate(links) if link.name in moved)


def farthest_travel(joint: PackageJoint, moved: Sequence[Float[np.ndarray, "N 3"]]) -> float:
    """Length (m) of the way that the farthest of the points that a joint moves goes over its whole range."""
    travel = joint.upper - joint.lower
    if joint.type == "prismatic" or not moved:
        return travel
    arms = np.concatenate(moved) - joint.origin
    return travel * float(np.linalg.norm(np.cross(joint.axis, arms), axis=1).max())


def _parents_first(links: Sequence[Link], joints: Sequence[PackageJoint]) -> list[PackageJoint]:
    """Joints ordered so that each comes after the joint that moves its parent."""
    children = [joint.child for joint in joints]
    names = {link.name for link in links}
    strangers = sorted(({joint.parent for joint in joints} | set(children)) - names)
    if strangers or len(set(children)) != len(children):
        raise InvalidKinematics(
            f"joints name links that are not there ({', '.join(strangers) or 'none'}) or move one twice"
        )
    placed = names - set(children)
    ordered: list[PackageJoint] = []
    waiting = list(joints)
    while waiting:
        ready = [joint for joint in waiting if joint.parent in placed]
        if not ready:
            raise InvalidKinematics(f"joints form a cycle: {', '.join(joint.name for joint in waiting)}")
        ordered += ready
        placed |= {joint.child for joint in ready}
        waiting = [joint for joint in waiting if joint.child not in placed]
    return ordered
