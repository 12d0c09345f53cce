"""Distance of Gaussians to the true surface, closed and in every joint state: RS and AS of whole objects.

The paper does not say how it samples Gaussians. Here centres are drawn with probability proportional to
opacity, and the distance is the Chamfer distance over all points, in the unit cube at rest.
"""

import numpy as np
from jaxtyping import Float, Int

from artigen.metrics.appearance import Scores
from artigen.metrics.chamfer import chamfer
from artigen.splats.render.splats import Splats
from artigen.types import SurfaceSamples

POINTS = 4096
"""Points of each cloud."""


def score_distances(
    splats: Splats,
    part_ids: Int[np.ndarray, "N"],
    surface: SurfaceSamples,
    displacements: Float[np.ndarray, "S P 4 4"],
    *,
    points: int = POINTS,
) -> Scores:
    """``shape_rest`` in the first state, ``shape_articulated`` as a mean over all.

    Args:
        splats: Gaussians at rest, voxel after voxel.
        surface: True points at rest, with the same parts.
        displacements: Displacements of the parts, by state; the first is closed.

    Raises:
        ValueError: If the Gaussians do not divide evenly among the voxels.
    """
    means, opacities = (value.detach().double().cpu().numpy() for value in (splats.means, splats.opacities))
    if not len(part_ids) or len(means) % len(part_ids):
        raise ValueError(f"{len(means)} Gaussians for {len(part_ids)} voxels, expected as many for each")
    rng = np.random.default_rng(0)
    owners = np.repeat(part_ids, len(means) // len(part_ids))
    drawn = rng.choice(len(means), points, p=opacities / opacities.sum())
    true = rng.choice(len(surface.points), points, replace=len(surface.points) < points)
    distances = [
        chamfer(
            _move(means[drawn], D[owners[drawn]]),
            _move(surface.points[true].astype(np.float64), D[surface.part_ids[true]]),
        )
        for D in displacements
    ]
    return {"shape_rest": distances[0], "shape_articulated": float(np.mean(distances))}


def _move(points: Float[np.ndarray, "N 3"], D: Float[np.ndarray, "N 4 4"]) -> Float[np.ndarray, "N 3"]:
    return np.einsum("nij,nj->ni", D[:, :3, :3], points) + D[:, :3, 3]
