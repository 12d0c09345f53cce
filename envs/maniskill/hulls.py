"""Collision hulls of an object at given joint coordinates."""

from collections.abc import Mapping, Sequence

import numpy as np

from artigen.transforms import transform_points
from sim_export.geometry.hulls import box_hull, move_hull
from sim_export.motion.kinematics import driven_joints, hanging_links, link_displacements
from sim_export.package import Hull

from .objects import TaskObject, TaskPart
from .placement import part_motion
from .solver.field import Field, build_field

CLEAR_OF_GROUND = 0.001
FRACTIONS = 41
GROUND = 0.02
"""Thickness of the slab that represents the ground, metres."""


def hulls_at(
    entry: TaskObject, part: TaskPart, qpos: Mapping[str, float]
) -> tuple[tuple[Hull, ...], tuple[Hull, ...]]:
    """All hulls in the object frame: those that move with the part, and the others.

    Args:
        qpos: Joint coordinates by name, m or rad; joints that are not named are at 0, and followers follow.
    """
    links = entry.package.links
    driven = {joint.name for joint in driven_joints(entry.package.joints)}
    T = link_displacements(
        links, entry.package.joints, {name: value for name, value in qpos.items() if name in driven}
    )
    inside = hanging_links(entry.package.joints, part.joint.child)
    carried: list[Hull] = []
    others: list[Hull] = []
    for link, displacement in zip(links, T, strict=True):
        group = carried if link.name in inside else others
        group += [move_hull(hull, displacement) for hull in link.hulls]
    return tuple(carried), tuple(others)


def object_field(entry: TaskObject, part: TaskPart, qpos: Mapping[str, float]) -> Field:
    """Distances to all hulls of an object and to the ground below them; ``qpos`` as for `hulls_at`."""
    carried, others = hulls_at(entry, part, qpos)
    hulls = carried + others
    return build_field((*hulls, ground_under(entry, hulls)))


def opened_qpos(entry: TaskObject, part: TaskPart, opened: float) -> dict[str, float]:
    """Joint coordinates with the part at a fraction of its range, its required joints fully open, and all
    others closed."""
    out = {joint.name: joint.upper for joint in entry.package.joints if joint.name in part.needs}
    return out | {part.joint.name: part.joint.lower + opened * part.span}


def open_above_ground(entry: TaskObject, part: TaskPart, wanted: float) -> float:
    """Largest opening of the part, at most ``wanted``, at which it stays above the object's lowest point; the
    handle of a leaf that folds down may reach below it."""
    fractions = np.linspace(0.0, wanted, FRACTIONS)
    heights = transform_points(part_motion(part, fractions), part.moved[None])[..., 2].min(axis=1)
    below = np.flatnonzero(heights < min(entry.floor, float(heights[0])) - CLEAR_OF_GROUND)
    return float(fractions[max(0, below[0] - 1)]) if len(below) else wanted


def ground_under(entry: TaskObject, hulls: Sequence[Hull]) -> Hull:
    """A slab of ground below an object's hulls, in the object frame."""
    corners = np.concatenate([hull.vertices for hull in hulls])
    low, high = corners.min(axis=0), corners.max(axis=0)
    low[2], high[2] = entry.floor - GROUND, entry.floor
    return box_hull(low, high)


def plinth_under(entry: TaskObject) -> Hull:
    """The plinth of a raised object, in the object frame."""
    low, high = entry.bounds
    return box_hull(np.array([*low[:2], entry.floor]), np.array([*high[:2], low[2]]))
