"""Catalogue light: the same objects in the same places as in quick pictures, in the same colours."""

import numpy as np
import pytest

from artigen.shapes.surfaces.physical import Material
from sim_export.geometry.primitives import primitive_mesh
from sim_export.package import Mesh
from sim_export.picture.catalogue import render_catalogue
from sim_export.picture.render import Surface, surface_from_mesh, surface_points
from sim_export.picture.tracing import TraceConfig
from sim_export.picture.viewpoint import Viewpoint, place_camera

pytest.importorskip("mitsuba")
FAST = TraceConfig(samples=16)


def cube(color=(0.8, 0.1, 0.1), texture=None, **material: float) -> Surface:
    box = primitive_mesh("box", (1.0, 1.0, 1.0))
    corners = box.vertices[box.faces]
    uv = None if texture is None else corners[:, :, [1, 2]] + 0.5
    look = Material(name="a", **{"roughness": 0.6, **material})
    return surface_from_mesh(
        Mesh(vertices=box.vertices, faces=box.faces, color=color, texture=texture, uv=uv, material=look)
    )


def picture(surface: Surface, azimuth: float = 0.0) -> np.ndarray:
    camera = place_camera(
        surface_points([surface]), Viewpoint(width=48, height=48, azimuth=azimuth, elevation=10.0)
    )
    return render_catalogue([surface], camera, -0.5, FAST).astype(int)


def test_a_red_cube_is_red_in_the_middle_and_its_surroundings_are_grey():
    seen = picture(cube())
    assert (seen[20:28, 20:28, 0] > 2 * seen[20:28, 20:28, 1]).all()
    assert np.ptp(seen[:2], axis=2).max() < 25
    assert np.abs(seen - picture(cube())).mean() < 3  # noise


@pytest.mark.parametrize("margin", [0.05, 0.4])
def test_no_light_is_in_the_picture_however_much_it_shows_around_the_object(margin: float):
    surface = cube()
    frame = Viewpoint(width=48, height=48, azimuth=40.0, elevation=25.0, margin=margin)
    seen = render_catalogue([surface], place_camera(surface_points([surface]), frame), -0.5, FAST)
    assert seen[:6, :, 0].min() > 90  # the cube is red


def test_a_texture_stands_upright_and_a_clear_cube_shows_what_is_behind():
    stripes = np.zeros((2, 2, 3), dtype=np.uint8)
    stripes[0, :, 0], stripes[1, :, 2] = 200, 200
    seen = picture(cube(texture=stripes))
    assert seen[16, 24, 0] > 2 * seen[16, 24, 2]
    assert seen[36, 24, 2] > 2 * seen[36, 24, 0]
    clear, solid = (picture(cube(opacity=share))[24, 24] for share in (0.3, 1.0))
    assert clear[1] > 1.5 * solid[1]


def test_metal_mirrors_the_studio():
    white = (0.9, 0.9, 0.9)
    metal, plaster = (picture(cube(white, metallic=share), 30.0)[10:40, 16:32] for share in (1.0, 0.0))
    assert np.abs(metal - plaster).mean() > 5


def test_a_coat_adds_no_light_and_a_clear_pane_takes_its_share():
    white = (0.98, 0.98, 0.98)
    coated, plain = (
        picture(cube(white, coat=share, coat_roughness=0.1), 30.0)[10:40, 16:32] for share in (1.0, 0.0)
    )
    assert plain.mean() - 15 < coated.mean() < plain.mean()
    dark = (0.1, 0.1, 0.1)
    shares = (0.2, 0.9, 1.0)
    seen = [picture(cube(dark, opacity=share, roughness=0.05))[24, 24].mean() for share in shares]
    assert seen[0] > seen[1] > seen[2] - 3
