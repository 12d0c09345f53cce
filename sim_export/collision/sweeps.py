"""Samples joint motions finely enough that no contact is skipped."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sim_export.collision.motion import driven_joints, farthest_travel, link_displacements, moved_links
from sim_export.collision.requirements import required_openings, sweep_coordinates
from sim_export.package import Link, PackageJoint, Requirement


@dataclass(frozen=True, kw_only=True)
class SweepConfig:
    """How closely a joint's range is sampled."""

    poses: int = 41
    """Fewest samples."""
    step: float = 4e-3
    """Farthest (m) that a point may move from one sample to the next: what is left of cut hulls is thin, and
    the edge of a door would jump over it."""
    max_poses: int = 401
    """Most samples."""


FINE = SweepConfig()
"""What hulls are cut and added by."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep:
    """One joint's sweep: displacements of all links, and the indices of those it moves."""

    T: Float[np.ndarray, "P L 4 4"]
    moved: frozenset[int]


def sample_sweep(
    links: Sequence[Link], joints: Sequence[PackageJoint], joint: PackageJoint, cfg: SweepConfig = FINE
) -> Float[np.ndarray, "P"]:
    """Coordinates of a joint from closed to fully open, close enough for all hulls that it moves."""
    moved = [hull.vertices for slot in moved_links(links, joints, joint) for hull in links[slot].hulls]
    return sample_range(joint, moved, cfg)


def sample_range(
    joint: PackageJoint, moved: Sequence[Float[np.ndarray, "N 3"]], cfg: SweepConfig
) -> Float[np.ndarray, "P"]:
    """Coordinates of a joint from closed to fully open, close enough for points that it moves."""
    steps = int(np.ceil(farthest_travel(joint, moved) / cfg.step))
    return sweep_coordinates(joint, int(np.clip(steps + 1, cfg.poses, cfg.max_poses)))


def read_sweeps(
    links: Sequence[Link],
    joints: Sequence[PackageJoint],
    requirements: Sequence[Requirement],
    cfg: SweepConfig = FINE,
) -> tuple[Sweep, ...]:
    """Every driven joint's sweep, with what it requires open."""
    sweeps = []
    for joint in driven_joints(joints):
        q = sample_sweep(links, joints, joint, cfg)
        T = link_displacements(
            links, joints, {**required_openings(joint, joints, requirements), joint.name: q}
        )
        sweeps.append(Sweep(T=T, moved=frozenset(moved_links(links, joints, joint))))
    return tuple(sweeps)
