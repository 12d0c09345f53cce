"""Leaves some doors and drawers of a room open without contact."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from sim_export.motion.kinematics import link_displacements
from sim_export.package import SimPackage
from sim_export.physics.materials import GRAVITY

from .check import overlapping
from .footprints import cached_package
from .room import Room
from .sweeps import opening_joints

OPEN = (0.2, 0.9)
"""Range of open fractions."""
NUDGE = 1e-4
"""Half the step (rad or m) over which a potential is differentiated."""


def open_some(room: Room, share: float) -> Room:
    """The room with about ``share`` of its doors and drawers open, selected by its seed.

    Joints that require another one to be open stay closed, as do those that would cause contact or would not
    stay where they are left.
    """
    rng = np.random.default_rng([room.seed, room.attempt, 1])
    for placement in room.placements:
        package = cached_package(placement.package)
        for name, lower, upper in _free_joints(package):
            wanted, fraction = rng.random() < share, float(rng.uniform(*OPEN))
            if not wanted:
                continue
            now = room.placement(placement.id)
            opened = replace(now, joints=(*now.joints, (name, round(lower + fraction * (upper - lower), 6))))
            tried = replace(
                room, placements=tuple(opened if entry is now else entry for entry in room.placements)
            )
            if stays(package, dict(opened.joints), name) and not overlapping(tried, opened):
                room = tried
    return room


def stays(package: SimPackage, coordinates: Mapping[str, float], name: str) -> bool:
    """Whether friction holds a joint against the weight that it carries, in an upright object.

    The effort of gravity is the slope of the potential of all links along the joint, followers included.

    Args:
        coordinates: Of driven joints by name (rad or m); others are at 0.
        name: A driven joint.
    """
    (friction,) = (joint.friction for joint in package.joints if joint.name == name)
    at = coordinates.get(name, 0.0) + np.array([-NUDGE, NUDGE])
    T = link_displacements(package.links, package.joints, {**coordinates, name: at})
    heights = [
        link.inertial.mass * (T[:, index, 2, :3] @ link.inertial.com + T[:, index, 2, 3])
        for index, link in enumerate(package.links)
        if link.inertial is not None
    ]
    low, high = GRAVITY * np.sum(heights, axis=0)
    return abs(high - low) / (2.0 * NUDGE) <= friction


def _free_joints(package: SimPackage) -> list[tuple[str, float, float]]:
    """Name and limits of doors and drawers without opening requirements, and without springs that close
    them."""
    labels = {link.name: link.label for link in package.links}
    waiting = {need.joint for need in package.requires_open}
    return [
        (joint.name, joint.lower, joint.upper)
        for joint in opening_joints(package)
        if joint.name not in waiting
        and joint.type != "continuous"
        and joint.spring <= 0.0
        and labels[joint.child] in ("door", "drawer")
    ]
