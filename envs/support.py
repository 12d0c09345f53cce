"""Static stability: whether the centre of mass is above the support polygon."""

import numpy as np
from jaxtyping import Float

from artigen.shapes.support import measure_overhang

from .hand import pose_matrix
from .loaded import LoadedPackage

FLOOR_BAND = 0.005
"""Height (m) above the lowest point within which a vertex counts as touching the floor."""


def overhang_of(loaded: LoadedPackage, vertices: Float[np.ndarray, "V 3"]) -> float:
    """Distance (m) of the centre of mass outside of the support polygon; negative inside.

    Args:
        vertices: Its collision vertices in the world.
    """
    feet = vertices[vertices[:, 2] < vertices[:, 2].min() + FLOOR_BAND][:, :2]
    return measure_overhang(feet, center_of_mass(loaded)[:2])


def center_of_mass(loaded: LoadedPackage) -> Float[np.ndarray, "3"]:
    """Centre of mass of all links in the world."""
    masses = np.array([link.mass for link in loaded.articulation.links])
    centers = np.array(
        [
            (pose_matrix(link.entity_pose) @ pose_matrix(link.cmass_local_pose))[:3, 3]
            for link in loaded.articulation.links
        ]
    )
    if not masses.sum() > 0:
        return centers.mean(axis=0)
    return np.average(centers, axis=0, weights=masses)
