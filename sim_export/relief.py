"""Freeing two overlapping hulls of each other by half-space cuts, at all poses in which they meet."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, transform_points
from sim_export.contacts import HullSet, signed_distances
from sim_export.hulls import clip_hull, hull_volume, hull_width
from sim_export.package import Hull


@dataclass(frozen=True, kw_only=True)
class ReliefConfig:
    """How far hulls may be cut back."""

    margin: float = 0.0003
    """Gap (m) that a cut leaves, so that poses between the sampled ones are free too."""
    max_depth: float = 0.03
    """Deepest cut (m), about two voxels; deeper overlaps are errors of the object, not of its hulls."""
    max_removed: float = 0.5
    """Greatest share of a hull's volume that all its cuts together may remove."""
    sliver: float = 0.005
    """A hull below this share of its link's volume may be dropped where it cannot be cut."""
    min_width: float = 0.001
    """Hulls that a cut leaves thinner (m) than this are dropped, if a cut may remove that much."""
    max_cuts: int = 24
    """Most cuts per pair of hulls; swings need several."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Relief:
    """The two hulls afterwards, cuts and deepest cut (m) of each, and why they still overlap (or "")."""

    hulls: tuple[Hull | None, Hull | None]
    cuts: tuple[int, int]
    depths: tuple[float, float]
    reason: str


def relieve_pair(
    hulls: tuple[Hull, Hull],
    poses: tuple[Float[np.ndarray, "P 4 4"], Float[np.ndarray, "P 4 4"]],
    volumes: tuple[float, float],
    slivers: tuple[bool, bool],
    tolerance: float,
    cfg: ReliefConfig,
) -> Relief:
    """Cuts two hulls until they overlap by no more than ``tolerance`` (m) at any of the poses.

    At the deepest pose the separating plane of the contact cuts the hull that loses the smaller
    share of its volume.

    Args:
        hulls: The two hulls, each in its link's rest frame.
        poses: Displacements of the two links.
        volumes: Volumes before anything was cut, of which the removed share counts.
        slivers: Whether each of the two may be dropped.
        tolerance: Depth that may stay.
        cfg: Limits of cutting.
    """
    current: list[Hull | None] = list(hulls)
    cuts, depths = [0, 0], [0.0, 0.0]
    for _ in range(cfg.max_cuts):
        first, second = current
        if first is None or second is None:
            return _relief(current, cuts, depths, "")
        found = signed_distances(HullSet(hulls=(first,)), HullSet(hulls=(second,)), *poses)
        if not len(found.distance) or -found.distance.min() <= tolerance:
            return _relief(current, cuts, depths, "")
        at = int(found.distance.argmin())
        depth, pose = -float(found.distance[at]), int(found.pose[at])
        options = []
        for side in range(2):
            outward = found.normal[at] if side == 0 else -found.normal[at]
            option = _cut(current, side, outward, (poses[0][pose], poses[1][pose]), cfg)
            lost = 1.0 if option is None else 1.0 - hull_volume(option) / volumes[side]
            if depth <= cfg.max_depth and lost <= cfg.max_removed:
                options.append((lost * volumes[side], side, option))
        dropping = [(volumes[side], side, None) for side in range(2) if slivers[side]]
        if not options and not dropping:
            reason = (
                f"a cut of {1000 * depth:.1f} mm is deeper than {1000 * cfg.max_depth:.0f} mm"
                if depth > cfg.max_depth
                else f"a cut would take more than {cfg.max_removed:.0%} of a hull"
            )
            return _relief(current, cuts, depths, reason)
        _, side, option = min(options or dropping, key=lambda entry: entry[:2])
        current[side] = option
        cuts[side] += 1
        depths[side] = max(depths[side], depth)
    return _relief(current, cuts, depths, f"{cfg.max_cuts} cuts were not enough")


def _relief(hulls: list[Hull | None], cuts: list[int], depths: list[float], reason: str) -> Relief:
    return Relief(
        hulls=(hulls[0], hulls[1]), cuts=(cuts[0], cuts[1]), depths=(depths[0], depths[1]), reason=reason
    )


def _cut(
    hulls: list[Hull | None],
    side: int,
    outward: Float[np.ndarray, "3"],
    poses: tuple[Float[np.ndarray, "4 4"], Float[np.ndarray, "4 4"]],
    cfg: ReliefConfig,
) -> Hull | None:
    """One hull cut back to where the other begins along ``outward``; ``None`` if too little is left."""
    own, other = hulls[side], hulls[1 - side]
    assert own is not None
    assert other is not None
    T_own_other = inverse(poses[side]) @ poses[1 - side]
    normal = poses[side][:3, :3].T @ outward
    begins = float((transform_points(T_own_other, other.vertices) @ normal).min())
    cut = clip_hull(own, normal, begins - cfg.margin)
    if cut is None or hull_width(cut)[0] < cfg.min_width:
        return None
    return cut
