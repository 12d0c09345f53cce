"""Daylight: pictures are exposed for what they show, and light comes from windows and lamps."""

import numpy as np
import pytest

from artigen.camera import look_at
from sim_export.geometry.primitives import primitive_mesh
from sim_export.package import Mesh
from sim_export.picture.daylight import develop, render_daylight
from sim_export.picture.raycast import Surface
from sim_export.picture.render import surface_from_mesh
from sim_export.picture.tracing import TraceConfig


def test_a_picture_is_the_same_at_any_exposure_and_keeps_the_order_of_brightness():
    image = np.geomspace(0.01, 3.0, 64).reshape(8, 8, 1).repeat(3, axis=2)
    seen = develop(image)
    assert (np.diff(seen[..., 0].ravel().astype(int)) >= 0).all()
    assert np.abs(develop(1000.0 * image).astype(int) - seen).max() <= 1
    assert 142 < np.median(seen) < 152  # 0.42 (1 + 0.42 / 144) / 1.42 = 0.297, in sRGB 148


def board(number: int, middle: tuple[float, float, float], size: tuple[float, float, float]) -> Surface:
    box = primitive_mesh("box", size)
    mesh = Mesh(vertices=box.vertices + np.array(middle), faces=box.faces, color=(0.5, 0.5, 0.5))
    return surface_from_mesh(mesh, surface_id=number)


def test_what_faces_the_sky_or_is_near_a_lamp_is_brighter():
    pytest.importorskip("mitsuba_oidn")
    walls = [board(0, (0.0, 0.0, -0.05), (4.0, 4.0, 0.1)), board(1, (0.0, 0.0, 2.55), (4.0, 4.0, 0.1))]
    walls += [board(2, (0.0, 2.05, 1.25), (4.2, 0.1, 2.6)), board(3, (0.0, -2.05, 1.25), (4.2, 0.1, 2.6))]
    walls += [board(4, (2.05, 0.0, 1.25), (0.1, 4.0, 2.6)), board(5, (-2.05, 0.0, 1.25), (0.1, 4.0, 2.6))]
    sky = board(6, (-1.98, 0.0, 1.3), (0.02, 1.5, 1.2))
    camera = look_at(
        np.array([0.0, -1.9, 1.3]), np.array([0.0, 2.0, 1.3]), fov=70.0, width=60, height=40
    )  # the sky is at the left
    cfg = TraceConfig(samples=16)
    by_sky = render_daylight([*walls, sky], camera, {6}, [], cfg).astype(int)
    by_lamp = render_daylight([*walls, sky], camera, (), [(1.6, 1.0, 1.3)], cfg).astype(int)
    row = slice(15, 25)
    assert (
        by_sky[row, 46:51].mean() > 1.2 * by_sky[row, 9:14].mean()
    )  # the walls across from it, and beside it
    assert by_lamp[row, 35:40].mean() > 1.2 * by_lamp[row, 10:20].mean()
