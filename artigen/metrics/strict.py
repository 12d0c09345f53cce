"""RS and AS Chamfer distances with strict matching of parts, after Particulate's protocol (2026).

Parts are paired one to one by their centroids, and a part without partner costs `PENALTY`. Joints move
within their own limits and the whole tree follows. Nothing is rescaled. `artigen.metrics.compat` holds the
published protocol; the two are never compared with each other.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import linear_sum_assignment

from artigen.metrics.clouds import PartCloud, chamfer, sample_cells
from artigen.types import Asset

PENALTY = 3.0**0.5
"""Cost of a part without partner: the length of the diagonal of the unit cube."""


@dataclass(frozen=True, kw_only=True)
class StrictDistance:
    """Squared unit-cube lengths; per part, means over the parts of one object, then over both directions."""

    rest: float
    """RS: all joints closed."""
    articulated: float
    """AS: all joints at the ends of their ranges."""
    rest_matched: float
    """RS of the parts that have a partner, without penalties."""
    articulated_matched: float
    """AS of the parts that have a partner."""
    whole_rest: float
    """Distance of whole objects regardless of parts, closed."""
    whole_articulated: float
    """The same for open objects."""


def strict_distance(found: Asset, truth: Asset, *, points: int) -> StrictDistance:
    """Chamfer distances per part and of whole objects, closed and opened.

    Args:
        points: Points on each whole object; the published protocol has 100,000.
    """
    clouds = sample_cells(found, points), sample_cells(truth, points)
    rest, opened = [(clouds[0].opened(share), clouds[1].opened(share)) for share in (0.0, 1.0)]
    pairs = pair_parts(clouds[0], clouds[1])
    matched = [_matched(clouds, pairs, state) for state in (rest, opened)]
    numbers = [len(np.unique(cloud.part_ids)) for cloud in clouds]
    penalised = [_penalise(values, numbers) for values in matched]
    return StrictDistance(
        rest=penalised[0],
        articulated=penalised[1],
        rest_matched=float(np.mean(matched[0])),
        articulated_matched=float(np.mean(matched[1])),
        whole_rest=chamfer(*rest),
        whole_articulated=chamfer(*opened),
    )


def pair_parts(first: PartCloud, second: PartCloud) -> Int[np.ndarray, "K 2"]:
    """Part ids paired one to one with the least total distance of centroids."""
    ids, centroids = zip(*(_centroids(cloud) for cloud in (first, second)), strict=True)
    cost = np.linalg.norm(centroids[0][:, None] - centroids[1][None], axis=2)
    rows, columns = linear_sum_assignment(cost)
    return np.stack([ids[0][rows], ids[1][columns]], axis=1)


def _centroids(cloud: PartCloud) -> tuple[Int[np.ndarray, "P"], Float[np.ndarray, "P 3"]]:
    ids, at = np.unique(cloud.part_ids, return_inverse=True)
    counts = np.bincount(at)
    sums = np.stack([np.bincount(at, weights=column) for column in cloud.points.T], axis=1)
    return ids, sums / counts[:, None]


def _matched(
    clouds: tuple[PartCloud, PartCloud], pairs: Int[np.ndarray, "K 2"], state: tuple[np.ndarray, np.ndarray]
) -> list[float]:
    return [
        chamfer(state[0][clouds[0].part_ids == one], state[1][clouds[1].part_ids == two])
        for one, two in pairs.tolist()
    ]


def _penalise(matched: list[float], numbers: list[int]) -> float:
    """Mean over the parts of each object, with `PENALTY` for missing partners; then over both objects."""
    return float(np.mean([(sum(matched) + (count - len(matched)) * PENALTY) / count for count in numbers]))
