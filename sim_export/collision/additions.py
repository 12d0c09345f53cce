"""Adding a hull to a link late in the export, without disturbing any sweep."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sim_export.collision.contacts import HullSet, signed_distances
from sim_export.collision.hull_limits import hull_aspect
from sim_export.collision.hulls import convex_hull
from sim_export.collision.motion import driven_joints, link_displacements, moved_links
from sim_export.collision.requirements import required_openings, sweep_coordinates
from sim_export.package import Hull, Link, PackageJoint, Requirement


@dataclass(frozen=True, kw_only=True)
class AdditionConfig:
    """What an added hull must keep to."""

    poses: int = 41
    """Samples of each joint's range that an added hull must not disturb."""
    gap: float = 2e-4
    """What stays free (m) around it; engines push apart what touches, however little."""
    tolerance: float = 2e-5
    """Depth (m) to which a stretched hull may enter another link; it may have touched that before."""
    max_hulls: int = 32
    """Most hulls of a link; where there would be one more, a hull is stretched instead."""
    max_vertices: int = 32
    """Most vertices of such a stretched hull."""
    max_aspect: float = 60.0
    """Its length over its thickness, at most."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep:
    """One joint's sweep: displacements of all links, and the indices of those it moves."""

    T: Float[np.ndarray, "P L 4 4"]
    moved: frozenset[int]


def read_sweeps(
    links: Sequence[Link], joints: Sequence[PackageJoint], requirements: Sequence[Requirement], poses: int
) -> tuple[Sweep, ...]:
    """Every driven joint's sweep, with what it requires open."""
    sweeps = []
    for joint in driven_joints(joints):
        q = sweep_coordinates(joint, poses)
        T = link_displacements(
            links, joints, {**required_openings(joint, joints, requirements), joint.name: q}
        )
        sweeps.append(Sweep(T=T, moved=frozenset(moved_links(links, joints, joint))))
    return tuple(sweeps)


def add_hull(
    sets: Sequence[HullSet],
    sweeps: Sequence[Sweep],
    slot: int,
    addition: Hull,
    stand: Hull,
    cfg: AdditionConfig,
) -> HullSet | None:
    """The hulls of link ``slot`` with one more, or ``None`` if that is in some link's way.

    ``stand`` is the hull that is stretched over ``addition`` where the link has as many as it may.
    """
    hulls, least = [*sets[slot].hulls, addition], cfg.gap
    if len(hulls) > cfg.max_hulls:
        addition = convex_hull(np.concatenate([stand.vertices, addition.vertices]))
        hulls, least = [addition if hull is stand else hull for hull in sets[slot].hulls], -cfg.tolerance
    fits = len(addition.vertices) <= cfg.max_vertices and hull_aspect(addition) <= cfg.max_aspect
    if not fits or not is_free(addition, slot, sets, sweeps, least):
        return None
    return HullSet(hulls=tuple(hulls))


def is_free(hull: Hull, slot: int, sets: Sequence[HullSet], sweeps: Sequence[Sweep], least: float) -> bool:
    """Whether a hull of link ``slot`` stays ``least`` (m) from all others, at rest and in every sweep."""
    alone, still = HullSet(hulls=(hull,)), np.eye(4)
    others = [index for index in range(len(sets)) if index != slot and sets[index].hulls]
    poses = [(other, still, still) for other in others]
    for sweep in sweeps:
        apart = [other for other in others if (slot in sweep.moved) != (other in sweep.moved)]
        poses += [(other, sweep.T[:, slot], sweep.T[:, other]) for other in apart]
    for other, T_hull, T_other in poses:
        found = signed_distances(alone, sets[other], T_hull, T_other, max(least, 0.0))
        if len(found.distance) and found.distance.min() < least:
            return False
    return True
