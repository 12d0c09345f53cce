"""Normals are smooth across gentle edges and sharp across others."""

import numpy as np
import pytest

from sim_export.geometry.normals import corner_normals


@pytest.mark.parametrize(("degrees", "smooth"), [(49.0, True), (51.0, False)])
def test_an_edge_is_smooth_up_to_fifty_degrees(*, degrees: float, smooth: bool):
    turn = np.radians(degrees)
    edge = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    level, raised = np.array([0.0, -1.0, 0.0]), np.array([1.0, np.cos(turn), np.sin(turn)])
    normals = corner_normals(np.array([[*edge[::-1], level], [*edge, raised]]))
    assert np.allclose(normals[0, 0], normals[1, 1]) == smooth
