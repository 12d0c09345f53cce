"""Laws of cameras: axes, projection as the inverse of rays, sheared axes, tight framing."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.camera import Camera, frame_points, look_at, pixel_rays, project_points
from sim_export.picture.viewpoint import Viewpoint, place_camera, view_direction

FRONT = look_at(np.array([-4.0, 0.0, 0.0]), np.zeros(3), fov=30.0, width=200, height=160)
"""Looks along +x from 4 m in front of the origin."""
SHEARED = replace(FRONT, axes=FRONT.axes + np.array([[0.2], [-0.1], [0.0]]) * FRONT.axes[2])


@pytest.mark.parametrize("azimuth", [-50.0, 0.0, 35.0])
@pytest.mark.parametrize("size", [(300, 200), (200, 300)])
def test_framing_is_tight_and_complete(azimuth: float, size: tuple[int, int]):
    points = np.random.default_rng(3).uniform([-0.2, -1.0, 0.0], [0.2, 1.0, 0.7], size=(200, 3))
    viewpoint = Viewpoint(azimuth=azimuth, width=size[0], height=size[1], margin=0.1)
    seen = project_points(place_camera(points, viewpoint), points)
    share = np.stack([seen[:, 0] / size[0], seen[:, 1] / size[1]], axis=1)
    assert (seen[:, 2] > 0).all()
    assert share.min() >= 0.1 - 1e-9
    assert share.max() <= 0.9 + 1e-9
    assert (np.ptp(share, axis=0) > 0.8 - 1e-6).any()


@pytest.mark.parametrize("camera", [FRONT, SHEARED])
def test_projection_is_the_inverse_of_rays(camera: Camera):
    rays = pixel_rays(camera)
    points = camera.position + rays[[3, 77, 150], [10, 99, 180]] * np.array([[2.0], [3.0], [1.5]])
    seen = project_points(camera, points)
    assert seen == pytest.approx(
        np.array([[10.5, 3.5, 2.0], [99.5, 77.5, 3.0], [180.5, 150.5, 1.5]]), abs=1e-3
    )


def test_a_camera_looks_at_its_target_upright_with_its_angle_of_view():
    assert np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0]]) == pytest.approx(FRONT.axes)
    middle = np.array([100.0, 80.0])
    assert project_points(FRONT, FRONT.target[None])[0, :2] == pytest.approx(middle)
    assert FRONT.fov == pytest.approx(30.0)
    top = np.array([[0.0, 0.0, 4.0 * np.tan(np.radians(15.0))]])
    assert project_points(FRONT, top)[0] == pytest.approx(np.array([100.0, 0.0, 4.0]))


def test_viewpoint_directions():
    assert view_direction(Viewpoint(azimuth=0.0, elevation=0.0)) == pytest.approx(np.array([-1.0, 0.0, 0.0]))
    assert view_direction(Viewpoint(azimuth=90.0, elevation=0.0)) == pytest.approx(np.array([0.0, 1.0, 0.0]))


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: look_at(np.zeros(3), np.zeros(3)), ("differ",)),
        (lambda: look_at(np.array([0, 0, 2.0]), np.zeros(3)), ("above each other",)),
        (lambda: look_at(np.array([2.0, 0, 0]), np.zeros(3), fov=200.0), ("200", "180")),
        (lambda: look_at(np.array([2.0, 0, 0]), np.zeros(3), height=0), ("384 x 0", "1 x 1")),
        (lambda: replace(FRONT, width=0), ("0 x 160", "1 x 1")),
        (lambda: place_camera(np.zeros((0, 3)), Viewpoint()), ("no points",)),
        (lambda: place_camera(np.eye(3), Viewpoint(margin=0.5)), ("0.5",)),
        (lambda: frame_points(np.eye(3), np.array([0, 0, 1.0]), width=9, height=9), ("above each other",)),
    ],
)
def test_bad_values_are_named(build, words: tuple[str, ...]):
    with pytest.raises(ValueError, match=r".+") as caught:
        build()
    assert all(word in str(caught.value) for word in words), str(caught.value)
