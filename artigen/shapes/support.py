"""Support: how far a centre of mass lies outside of what an object stands on."""

import numpy as np
from jaxtyping import Float


def measure_overhang(feet: Float[np.ndarray, "N 2"], center: Float[np.ndarray, "2"]) -> float:
    """Distance of a point from the convex hull of others in the plane, in their unit; negative inside.

    A single foot, or feet in a line, give no support: the distance is that to the nearest of them.
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        edges = ConvexHull(feet).equations
    except (QhullError, ValueError):
        return float(np.linalg.norm(feet - center, axis=1).min())
    return float((edges[:, :2] @ center + edges[:, 2]).max())
