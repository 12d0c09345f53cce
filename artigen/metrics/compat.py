"""The published RS and AS Chamfer distances, quirks included; for comparison with published tables only.

They follow SINGAPO's ``metrics/cd.py``, which DIPO copied, including its quirks. Parts are paired by the
centres of their boxes, and left-over parts take their nearest partner without a penalty. Every hinge opens
to 90 degrees whatever its limit, and a screw does not move. A moving part takes only its direct children
with it. Generated parts are stretched in place by (generated box / true box) per axis, the inverse of what
would align the objects, and joints are not stretched. AS includes the state at rest.
`artigen.metrics.strict` is the measure to trust; the two are never compared with each other.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import linear_sum_assignment

from artigen.conditioning.delivery import asset_bounds
from artigen.metrics.clouds import PartCloud, chamfer, sample_every_part
from artigen.transforms import joint_motion, transform_points
from artigen.types import Asset, Part

LENGTH = 2.0
"""Edge of the cube of published objects, about [-1, 1]; here it is the unit cube."""
STATES = (0.0, 0.25, 0.5, 0.75, 1.0)


@dataclass(frozen=True, kw_only=True)
class CompatDistance:
    """Mean over parts and both directions, squared lengths of a cube of edge 2."""

    rest: float
    """RS-d_CD."""
    articulated: float
    """AS-d_CD: mean of five states, the one at rest among them."""


def compat_distance(found: Asset, truth: Asset, *, per_part: int = 2048) -> CompatDistance:
    """RS and AS Chamfer distance by the published protocol."""
    clouds = [_center(sample_every_part(asset, per_part)) for asset in (found, truth)]
    sizes = [np.ptp(asset_bounds(asset), axis=0) for asset in (found, truth)]
    stretched = _stretch(clouds[0], sizes[0] / np.maximum(sizes[1], 1e-9))
    ids = [np.unique(cloud.part_ids) for cloud in clouds]
    centers = [_centers(cloud.asset)[kept] for cloud, kept in zip(clouds, ids, strict=True)]
    forth = list(enumerate(pair_with_leftovers(centers[0], centers[1]).tolist()))
    back = [(row, column) for column, row in enumerate(pair_with_leftovers(centers[1], centers[0]).tolist())]
    values = []
    for share in STATES:
        moved = [
            _move(cloud, share).reshape(len(kept), per_part, 3)
            for cloud, kept in zip((stretched, clouds[1]), ids, strict=True)
        ]
        distance = {
            (row, column): chamfer(moved[0][row], moved[1][column]) for row, column in {*forth, *back}
        }
        ways = [np.mean([distance[pair] for pair in way]) for way in (forth, back)]
        values.append(LENGTH**2 * float(np.mean(ways)))
    return CompatDistance(rest=values[0], articulated=float(np.mean(values)))


def pair_with_leftovers(
    source: Float[np.ndarray, "P 3"], target: Float[np.ndarray, "Q 3"]
) -> Int[np.ndarray, "P"]:
    """Partner of every source by one-to-one assignment of centres; those left over take their nearest."""
    cost = np.linalg.norm(source[:, None] - target[None], axis=2)
    partner = cost.argmin(axis=1)
    rows, columns = linear_sum_assignment(cost)
    partner[rows] = columns
    return partner


def _centers(asset: Asset) -> Float[np.ndarray, "P 3"]:
    """Centres of the boxes of all parts, about the centre of the object."""
    return np.stack([part.box[0] for part in asset.parts]) - asset_bounds(asset).mean(axis=0)


def _center(cloud: PartCloud) -> PartCloud:
    return replace(cloud, points=cloud.points - asset_bounds(cloud.asset).mean(axis=0))


def _stretch(cloud: PartCloud, factors: Float[np.ndarray, "3"]) -> PartCloud:
    """Stretches every part about the centre of its own box."""
    centers = _centers(cloud.asset)[cloud.part_ids]
    return replace(cloud, points=centers + (cloud.points - centers) * factors)


def _move(cloud: PartCloud, share: float) -> Float[np.ndarray, "N 3"]:
    """Centred points with all joints opened by the published rule."""
    asset = cloud.asset
    own = np.stack([_published_motion(part, share) for part in asset.parts])
    shift = np.eye(4)
    shift[:3, 3] = asset_bounds(asset).mean(axis=0)
    back = np.linalg.inv(shift)
    out = cloud.points.copy()
    for index, part in enumerate(asset.parts):
        T = own[index] if part.parent == -1 else own[part.parent] @ own[index]
        rows = cloud.part_ids == index
        out[rows] = transform_points(back @ T @ shift, cloud.points[rows])
    return out


def _published_motion(part: Part, share: float) -> Float[np.ndarray, "4 4"]:
    joint = part.joint
    match joint.type:
        case "prismatic":
            q = joint.upper * share
        case "revolute":
            q = np.sign(joint.upper) * np.pi / 2 * share
        case "continuous":
            q = 2.0 * np.pi * share
        case _:
            return np.eye(4)
    return joint_motion(joint, np.array(q))
