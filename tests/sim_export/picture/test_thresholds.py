"""Boundaries of rays: what hides what, and how closely surfaces may follow each other."""

import numpy as np
import pytest

from sim_export.package import Mesh
from sim_export.picture.raycast import Surface, build_scene, cast_layers
from sim_export.picture.render import surface_from_mesh


def pane(x: float, alpha: int, *, number: int = 0, backward: bool = False) -> Surface:
    """A unit square of one opacity at x that faces -x, or +x."""
    vertices = np.array([[x, 0.5, -0.5], [x, -0.5, -0.5], [x, -0.5, 0.5], [x, 0.5, 0.5]])
    faces = np.array([[0, 1, 2], [0, 2, 3]])[:, :: -1 if backward else 1]
    texture = np.full((1, 1, 4), alpha, dtype=np.uint8)
    return surface_from_mesh(
        Mesh(vertices=vertices, faces=faces, uv=np.full((2, 3, 2), 0.5), texture=texture), surface_id=number
    )


def cast(*panes: Surface) -> list[int]:
    """Numbers of the surfaces that a ray along +x meets; it starts a millimetre in front of the origin."""
    scene = build_scene(panes)
    ray = np.array([[1.0, 0.0, 0.0]], dtype=np.float32)
    found = cast_layers(scene, np.array([-1e-3, 0.2, 0.1]), ray)
    return [panes[scene.owner[triangle]].id for hits, _ in found for triangle in hits.triangle]


@pytest.mark.parametrize(("alpha", "layers"), [(252, 2), (253, 1)])
def test_surfaces_of_an_opacity_of_99_hundredths_hide_what_is_behind_them(alpha, layers):
    """These are 0.988 and 0.992."""
    assert len(cast(pane(0.0, alpha), pane(0.1, 255))) == layers


@pytest.mark.parametrize(("panes", "layers"), [(7, 7), (8, 8), (9, 8)])
def test_a_ray_passes_eight_transparent_surfaces(panes, layers):
    assert len(cast(*(pane(0.05 * number, 10) for number in range(panes)))) == layers


@pytest.mark.parametrize(("gap", "seen"), [(1.8e-6, 1), (2.2e-6, 0)])
def test_a_front_is_seen_if_it_lies_within_two_millionths_of_the_extent_behind_a_back(gap, seen):
    assert cast(pane(-gap, 255, number=0, backward=True), pane(0.0, 255, number=1))[0] == seen


@pytest.mark.parametrize(("gap", "layers"), [(1.3e-5, 1), (1.5e-5, 2)])
def test_a_surface_shows_behind_a_pane_from_a_hundred_thousandth_of_the_diagonal(gap, layers):
    """The diagonal is 1.414 m."""
    assert len(cast(pane(0.0, 10), pane(gap, 255))) == layers
