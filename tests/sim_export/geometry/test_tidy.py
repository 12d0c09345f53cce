"""Slivers go with the details that they belong to, unless those hold much of the volume."""

import manifold3d
import numpy as np
import pytest

from sim_export.geometry.tidy import tidy_mesh
from sim_export.geometry.triangles import find_slivers
from sim_export.package import Mesh

LIKE = Mesh(vertices=np.eye(3), faces=np.array([[0, 1, 2]]), color=(0.2, 0.4, 0.6))


def plate(height: float, step: float = 1e-4) -> manifold3d.Manifold:
    """A square metre with a step on it, whose sides are slivers."""
    return manifold3d.Manifold.cube((1.0, 1.0, height)) + manifold3d.Manifold.cube(
        (0.9, 0.95, step)
    ).translate((0.05, 0.02, height))


@pytest.mark.parametrize(("height", "tidy"), [(0.0175, True), (0.0165, False)])
def test_a_step_of_slivers_goes_if_it_holds_less_than_half_a_percent(height: float, tidy: object):
    mesh = tidy_mesh(plate(height), LIKE)
    assert (mesh is not None) == tidy
    if mesh is not None:
        assert np.ptp(mesh.vertices[:, 2]) == pytest.approx(height)
        assert mesh.color == LIKE.color
        assert not find_slivers(mesh.vertices[mesh.faces], 1e-4).any()


@pytest.mark.parametrize(("step", "left"), [(1.0e-4, False), (2.0e-4, True)])
def test_a_step_that_is_no_sliver_stays(step: float, left: object):
    mesh = tidy_mesh(plate(0.1, step), LIKE)
    assert mesh is not None
    assert (np.ptp(mesh.vertices[:, 2]) > 0.10005) == left


@pytest.mark.parametrize(("segments", "left"), [(44, False), (48, True)])
def test_a_step_of_slivers_stays_where_they_are_few_of_all_triangles(segments: int, left: object):
    """Eight slivers, beside a ball of 8 (segments / 4)^2 triangles: more or less than a thousand in all."""
    ball = manifold3d.Manifold.sphere(0.2, segments).translate((2.0, 0.0, 0.0))
    mesh = tidy_mesh(plate(0.1) + ball, LIKE)
    assert mesh is not None
    top = mesh.vertices[mesh.vertices[:, 0] < 1.5, 2].max()
    assert (top > 0.10005) == left


@pytest.mark.parametrize(("step", "left"), [(1.8e-6, False), (2.2e-6, True)])
def test_a_step_of_two_micrometres_stays(step: float, *, left: bool):
    """On a plate of 0.1 m, beside a ball of so many triangles that slivers are few."""
    base = manifold3d.Manifold.cube((0.08, 0.08, 0.01))
    panel = manifold3d.Manifold.cube((0.06, 0.05, step)).translate((0.01, 0.02, 0.01))
    ball = manifold3d.Manifold.sphere(0.01, 48).translate((0.0, 0.0, 0.05))
    mesh = tidy_mesh(base + panel + ball, LIKE)
    assert mesh is not None
    heights = mesh.vertices[mesh.vertices[:, 2] < 0.02, 2]
    assert (heights.max() > 0.01 + step / 2) == left


def test_nothing_is_no_mesh():
    assert tidy_mesh(manifold3d.Manifold(), LIKE) is None
