"""Distances to surfaces are exact to the triangles of the nearest samples."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from sim_export.geometry.distances import SampledSurface, distances_to


@pytest.mark.parametrize(("nearer", "distance"), [(7, 0.1), (8, 0.5)])
def test_the_triangles_of_the_eight_nearest_samples_count(nearer: int, distance: float):
    """A large triangle 0.1 m below the origin, whose sample is 1 m away, and small ones that are 0.5 m away
    as their samples are."""
    large = np.array([[[-2.0, -2.0, -0.1], [4.0, -2.0, -0.1], [-2.0, 4.0, -0.1]]])
    turn = np.arange(nearer)
    corner = np.stack([0.5 * np.cos(turn), 0.5 * np.sin(turn), 0.0 * turn], axis=1)
    small = np.stack([corner, 1.01 * corner, 1.01 * corner + [0.0, 0.0, 0.01]], axis=1)
    samples = np.concatenate([[[np.sqrt(0.99), 0.0, -0.1]], corner])
    surface = SampledSurface(
        triangles=np.concatenate([large, small]), owner=np.arange(nearer + 1), tree=KDTree(samples)
    )
    assert distances_to(np.zeros((1, 3)), surface)[0] == pytest.approx(distance)
