"""Motion of package links: kinematics, sweeps of joints, and what must be open first.

Links and joints are given in the object frame at rest, so that the displacement of a link is its parent's
displacement times its own joint's motion, as in `artigen.kinematics`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from artigen.kinematics import displace
from artigen.types import FIXED, Joint
from sim_export.errors import InvalidKinematics
from sim_export.package import Link, Requirement

MOVING_TYPES = ("revolute", "prismatic", "continuous")
STEP = 4e-3
"""Farthest (m) that a point may move from one pose of a sweep to the next where hulls are cut or added: what
is left of cut hulls is thin, and the edge of a door would jump over it."""
SWEEP_POSES = (41, 401)
"""Fewest and most poses of such a sweep."""


def driven_joints(joints: Sequence[Joint]) -> tuple[Joint, ...]:
    """The joints with a coordinate of their own: those that move and mimic no other."""
    return tuple(joint for joint in joints if joint.type in MOVING_TYPES and joint.follows is None)


def object_joints(joints: Sequence[Joint]) -> tuple[Joint, ...]:
    """The driven joints as those of the object: the two joints of a screw as one with a pitch."""
    travels = {joint.follows: joint for joint in joints if joint.is_travel}
    found = []
    for joint in driven_joints(joints):
        travel = travels.get(joint.name)
        joint = replace(joint, type=joint.kind, of_screw=False)
        if travel is not None:
            pitch = travel.ratio * float(np.sign(joint.axis @ travel.axis))
            joint = replace(joint, pitch=pitch, child=travel.child)
        found.append(joint)
    return tuple(found)


def box_sides(links: Sequence[Link]) -> Float[np.ndarray, "3"]:
    """Sides (m) of the box around all hulls at rest; 0 without hulls."""
    chunks = [hull.vertices for link in links for hull in link.hulls]
    return np.ptp(np.concatenate(chunks), axis=0) if chunks else np.zeros(3)


def link_displacements(
    links: Sequence[Link], joints: Sequence[Joint], qpos: Mapping[str, ArrayLike]
) -> Float[np.ndarray, "*B L 4 4"]:
    """Displacement of every link from rest, in the order of ``links`` and in the object frame.

    Args:
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
    movers = {joint.child: joint for joint in joints}
    own = [movers.get(link.name, FIXED) for link in links]
    try:
        return displace([joint.name for joint in own], _parents(links, joints), own, qpos)
    except ValueError as error:
        roots = {link.name for link in links} - {joint.child for joint in joints}
        hanging = frozenset[str]().union(*(hanging_links(joints, root) for root in roots))
        cycle = ", ".join(joint.name for joint in joints if joint.child not in hanging)
        raise InvalidKinematics(f"joints form a cycle: {cycle}" if cycle else str(error)) from error


def moved_links(links: Sequence[Link], joints: Sequence[Joint], joint: Joint) -> tuple[int, ...]:
    """Indices of the links that ``joint`` moves: its child, what follows it, and all that hangs from them."""
    moved = frozenset().union(*(hanging_links(joints, one.child) for one in led_joints(joints, joint)))
    return tuple(index for index, link in enumerate(links) if link.name in moved)


def led_joints(joints: Sequence[Joint], joint: Joint) -> list[Joint]:
    """A joint, those that follow it, and those that follow these."""
    found = [joint]
    for leader in found:
        found += [one for one in joints if one.follows == leader.name and one not in found]
    return found


def hanging_links(joints: Sequence[Joint], link: str) -> frozenset[str]:
    """Names of a link and all its descendants."""
    found: set[str] = set()
    front = {link}
    while front:
        found |= front
        front = {joint.child for joint in joints if joint.parent in front} - found
    return frozenset(found)


def farthest_travel(joint: Joint, moved: Sequence[Float[np.ndarray, "N 3"]]) -> float:
    """Length (m) of the way that the farthest of the points that a joint moves goes over its whole range."""
    travel = joint.upper - joint.lower
    if joint.type == "prismatic" or not moved:
        return travel
    arms = np.concatenate(moved) - joint.origin
    return travel * float(np.linalg.norm(np.cross(joint.axis, arms), axis=1).max())


def _parents(links: Sequence[Link], joints: Sequence[Joint]) -> list[int]:
    """Index of the link that carries each link; -1 for those without a joint."""
    children = [joint.child for joint in joints]
    slot = {link.name: index for index, link in enumerate(links)}
    strangers = sorted(({joint.parent for joint in joints} | set(children)) - slot.keys())
    if strangers or len(set(children)) != len(children):
        raise InvalidKinematics(
            f"joints name links that are not there ({', '.join(strangers) or 'none'}) or move one twice"
        )
    carriers = {joint.child: slot[joint.parent] for joint in joints}
    return [carriers.get(link.name, -1) for link in links]


def sweep_coordinates(joint: Joint, poses: int) -> Float[np.ndarray, "P"]:
    """Evenly spaced coordinates from closed to fully open."""
    return np.linspace(joint.lower, joint.upper, poses)


def needed_fractions(joint: str, requirements: Sequence[Requirement]) -> dict[str, float]:
    """Share of its range to which every joint must be open before ``joint`` moves, by name in their order.

    Requirements are followed recursively; the largest share of a joint counts. ``joint`` itself is never
    included, even if a foreign file makes it require itself.
    """
    fractions: dict[str, float] = {}
    waiting = [joint]
    while waiting:
        name = waiting.pop()
        for need in requirements:
            if need.joint == name and need.needs != joint and need.fraction > fractions.get(need.needs, -1.0):
                fractions[need.needs] = need.fraction
                waiting.append(need.needs)
    return dict(sorted(fractions.items()))


def required_openings(
    joint: Joint, joints: Sequence[Joint], requirements: Sequence[Requirement]
) -> dict[str, float]:
    """Coordinates of the joints that must be open for ``joint`` to move, requirements of theirs included."""
    by_name = {other.name: other for other in joints}
    return {
        name: by_name[name].lower + fraction * (by_name[name].upper - by_name[name].lower)
        for name, fraction in needed_fractions(joint.name, requirements).items()
    }


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep:
    """One joint's sweep: displacements of all links, and the indices of those it moves."""

    T: Float[np.ndarray, "P L 4 4"]
    moved: frozenset[int]


def sample_sweep(links: Sequence[Link], joints: Sequence[Joint], joint: Joint) -> Float[np.ndarray, "P"]:
    """Coordinates of a joint from closed to fully open, close enough for all hulls that it moves."""
    moved = [hull.vertices for slot in moved_links(links, joints, joint) for hull in links[slot].hulls]
    return sample_range(joint, moved, STEP, SWEEP_POSES)


def sample_range(
    joint: Joint, moved: Sequence[Float[np.ndarray, "N 3"]], step: float, poses: tuple[int, int]
) -> Float[np.ndarray, "P"]:
    """Coordinates of a joint from closed to fully open between which no point that it moves goes farther than
    ``step`` (m); ``poses`` are the fewest and the most."""
    steps = int(np.ceil(farthest_travel(joint, moved) / step))
    return sweep_coordinates(joint, int(np.clip(steps + 1, *poses)))


def read_sweeps(
    links: Sequence[Link], joints: Sequence[Joint], requirements: Sequence[Requirement]
) -> tuple[Sweep, ...]:
    """Every driven joint's sweep, with what it requires open."""
    sweeps = []
    for joint in driven_joints(joints):
        q = sample_sweep(links, joints, joint)
        T = link_displacements(
            links, joints, {**required_openings(joint, joints, requirements), joint.name: q}
        )
        sweeps.append(Sweep(T=T, moved=frozenset(moved_links(links, joints, joint))))
    return tuple(sweeps)
