"""Swept space of doors and drawers: sampled poses and bounds between them."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from artigen.types import Joint
from sim_export.geometry.contacts import HullSet
from sim_export.motion.kinematics import (
    driven_joints,
    led_joints,
    link_displacements,
    moved_links,
    required_openings,
)
from sim_export.package import SimPackage

STILL_LABELS = ("knob", "wheel", "handle")
"""Parts that turn or are pressed in place, for which no space is kept free."""
STEP = np.radians(3.0)
"""Largest rotation between two poses of a sweep (radians)."""
MAX_POSES = 720


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep:
    """The links that one joint moves, along its whole range.

    ``T`` are displacements from rest in the object frame. Between two poses every moved point stays within
    ``slack`` metres of the straight line between its two positions.
    """

    joint: Joint
    label: str | None
    links: tuple[int, ...]
    T: Float[np.ndarray, "P L 4 4"]
    slack: float


def opening_joints(package: SimPackage) -> tuple[Joint, ...]:
    """Driven joints of parts that need space to move, themselves or by followers, as the lid of a pedal: not
    knobs, buttons and wheels."""
    labels = {link.name: link.label for link in package.links}
    carried = {joint.follows: labels.get(joint.child) for joint in package.joints if joint.is_travel}
    return tuple(
        joint
        for joint in driven_joints(package.joints)
        if joint.upper > joint.lower
        and any(
            label not in STILL_LABELS
            for label in (
                carried.get(joint.name) or labels.get(joint.child),
                *(
                    labels.get(led.child)
                    for led in led_joints(package.joints, joint)[1:]
                    if not led.is_travel
                ),
            )
        )
    )


def find_sweeps(package: SimPackage) -> Iterator[Sweep]:
    """The sweeps of all parts that need space to move."""
    return (sweep_joint(package, joint) for joint in opening_joints(package))


def sweep_joint(package: SimPackage, joint: Joint) -> Sweep:
    """The sweep of one joint, with its required joints open and all others closed."""
    links = moved_links(package.links, package.joints, joint)
    turn = 0.0 if joint.type == "prismatic" else joint.upper - joint.lower
    poses = min(int(np.ceil(turn / STEP)) + 1, MAX_POSES) if turn else 2
    opened: dict[str, ArrayLike] = {joint.name: np.linspace(joint.lower, joint.upper, poses)}
    opened |= required_openings(joint, package.joints, package.requires_open)
    arms = [hull.vertices - joint.origin for index in links for hull in package.links[index].hulls]
    radius = np.linalg.norm(np.cross(np.concatenate([np.zeros((0, 3)), *arms]), joint.axis), axis=1)
    half = turn / (poses - 1) / 2.0
    label = next((link.label for link in package.links if link.name == joint.child), None)
    return Sweep(
        joint=joint,
        label=label,
        links=links,
        T=link_displacements(package.links, package.joints, opened),
        slack=float(radius.max(initial=0.0) * (1.0 - np.cos(half))),
    )


def sweep_boxes(
    package: SimPackage, sweep: Sweep, T: Float[np.ndarray, "4 4"]
) -> tuple[Float[np.ndarray, "S H 2 3"], list[tuple[int, int]]]:
    """Bounds of every moved hull between each pose and the next, after ``T``, slack included.

    Returns:
        The boxes, one row per step and one column per hull, and (link, hull) of every column.
    """
    columns, boxes = [], []
    for index in sweep.links:
        hulls = HullSet(hulls=package.links[index].hulls)
        if not hulls.hulls:
            continue
        bounds = hulls.bounds(T @ sweep.T[:, index])  # P H 2 3
        low = np.minimum(bounds[:-1, :, 0], bounds[1:, :, 0]) - sweep.slack
        high = np.maximum(bounds[:-1, :, 1], bounds[1:, :, 1]) + sweep.slack
        boxes.append(np.stack([low, high], axis=2))
        columns += [(index, place) for place in range(len(hulls.hulls))]
    empty = np.zeros((len(sweep.T) - 1, 0, 2, 3))
    return np.concatenate([empty, *boxes], axis=1), columns
