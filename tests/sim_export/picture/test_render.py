"""Laws of the ray caster: closed forms of depth and silhouettes, ids, textures, light, determinism."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.ndimage
import trimesh
from picture_maps import render_depth, render_ids

from artigen.camera import look_at, pixel_rays, project_points
from artigen.shapes.surfaces.physical import Material
from artigen.splats.colors import linear_from_srgb
from artigen.transforms import rotation_about, screw_motion
from sim_export.geometry.normals import corner_normals
from sim_export.package import Mesh
from sim_export.picture.lighting import RenderConfig
from sim_export.picture.raycast import Surface
from sim_export.picture.render import move_surface, render_scene, surface_from_mesh, surface_points
from sim_export.picture.viewpoint import Viewpoint, place_camera

FRONT = look_at(np.array([-4.0, 0.0, 0.0]), np.zeros(3), fov=30.0, width=200, height=200)
"""Looks along +x from 4 m in front of the origin."""
BEHIND = look_at(np.array([4.0, 0.0, 0.0]), np.zeros(3), fov=30.0, width=200, height=200)
MATTE = Material(ior=1.0)
"""A surface that mirrors nothing."""
RED, GREEN, BLUE, WHITE = (220, 20, 20), (20, 200, 20), (20, 20, 220), (240, 240, 240)


def box_surface(center, size, surface_id: int = 0, color=(0.6, 0.6, 0.6)) -> Surface:
    box = trimesh.creation.box(extents=size)
    mesh = Mesh(vertices=box.vertices + np.array(center), faces=box.faces, color=color)
    return surface_from_mesh(mesh, surface_id=surface_id)


def quad(texture: np.ndarray | None, color=(0.5, 0.5, 0.5)) -> Mesh:
    """A unit square at x = 0 facing -x, seen upright: uv (0, 0) at its lower left as seen from there."""
    # Seen along +x with z up, the viewer's left is +y.
    vertices = np.array([[0.0, 0.5, -0.5], [0.0, -0.5, -0.5], [0.0, -0.5, 0.5], [0.0, 0.5, 0.5]])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    uv = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])[faces]
    if texture is None:
        return Mesh(vertices=vertices, faces=faces, color=color)
    return Mesh(vertices=vertices, faces=faces, uv=uv, texture=texture)


def test_silhouette_and_depth_of_a_unit_cube_have_their_closed_form():
    cube = box_surface((0, 0, 0), (1, 1, 1))
    depth = render_depth([cube], FRONT)
    seen = np.isfinite(depth)
    focal = FRONT.height / 2.0 / np.tan(np.radians(FRONT.fov) / 2.0)
    side = focal * 1.0 / 3.5  # the front face is 3.5 m away
    assert seen.sum() == pytest.approx(side**2, rel=0.02)
    assert depth[seen] == pytest.approx(3.5, abs=1e-5)
    rows, columns = np.nonzero(seen)
    assert rows.min() + rows.max() == columns.min() + columns.max() == FRONT.height - 1


def test_depth_of_a_sphere_agrees_with_the_ray_equation():
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.7)
    surface = surface_from_mesh(Mesh(vertices=ball.vertices, faces=ball.faces))
    depth = render_depth([surface], FRONT)
    rays = pixel_rays(FRONT).astype(np.float64)
    b = rays @ FRONT.position
    a = (rays**2).sum(axis=-1)
    discriminant = b**2 - a * (FRONT.position @ FRONT.position - 0.7**2)
    inner = discriminant > 0.3
    assert inner.sum() > 3000
    exact = (-b[inner] - np.sqrt(discriminant[inner])) / a[inner]
    assert depth[inner] == pytest.approx(exact, abs=2e-3)
    assert not np.isfinite(depth[discriminant < -0.05]).any()


def test_ids_of_two_boxes_are_where_the_boxes_are():
    left = box_surface((0.0, 0.6, 0.0), (0.4, 0.4, 0.4), surface_id=3)
    right = box_surface((0.0, -0.6, 0.0), (0.4, 0.4, 0.4), surface_id=7)
    hidden = box_surface((1.0, 0.6, 0.0), (0.1, 0.1, 0.1), surface_id=9)
    ids = render_ids([left, right, hidden], FRONT)
    assert set(np.unique(ids)) == {-1, 3, 7}
    assert (ids[:, :100] != 7).all()  # +y is the viewer's left
    assert (ids[:, 100:] != 3).all()
    assert (ids == 3).sum() == pytest.approx((ids == 7).sum(), rel=0.02)
    for number, surface in ((3, left), (7, right)):
        column, row, _ = project_points(FRONT, surface_points([surface]).mean(axis=0)[None])[0]
        assert ids[int(row), int(column)] == number


def test_nothing_to_draw_is_background():
    assert not np.isfinite(render_depth([], FRONT)).any()
    assert (render_ids([], FRONT) == -1).all()
    assert (render_scene([], FRONT) == RenderConfig().background).all()


def test_texture_corners_follow_uv_from_the_lower_left_and_rows_from_the_top():
    texture = np.array([[RED, GREEN], [BLUE, WHITE]], dtype=np.uint8).repeat(8, axis=0).repeat(8, axis=1)
    cfg = RenderConfig(ground=False)
    matte = replace(quad(texture), material=MATTE)
    picture = render_scene([surface_from_mesh(matte)], FRONT, cfg).astype(float)
    columns, rows, _ = project_points(FRONT, quad(None).vertices * 0.8).T
    corners = [picture[int(row), int(column)] for column, row in zip(columns, rows, strict=True)]
    # lower left, lower right, upper right, upper left
    for have, want in zip(corners, (BLUE, WHITE, GREEN, RED), strict=True):
        tone = have / have.max() - np.array(want) / max(want)
        assert np.abs(tone).max() < 0.12, (have, want)


def test_what_is_clear_shows_what_lies_behind_it_as_far_as_it_is_clear():
    shares = (0, 60, 128, 255)
    texture = np.zeros((32, 32, 4), dtype=np.uint8)
    texture[..., :3] = BLUE
    texture[..., 3] = np.repeat(shares, 8)
    pane = surface_from_mesh(quad(texture))
    wall = surface_from_mesh(quad(None, color=(0.9, 0.1, 0.1)))
    cfg = RenderConfig(ground=False)
    hidden, alone = (
        srgb_to_linear(render_scene([one], FRONT, cfg))
        for one in (surface_from_mesh(quad(texture[..., :3])), pane)
    )
    behind = np.eye(4)
    behind[0, 3] = 0.3
    plain, walled = (
        srgb_to_linear(render_scene([*panes, move_surface(wall, behind)], FRONT, cfg))
        for panes in ((), (pane,))
    )
    background = srgb_to_linear(np.array(cfg.background))
    columns, rows, _ = project_points(FRONT, np.array([[0.0, 0.375 - 0.25 * n, 0.0] for n in range(4)])).T
    for share, column, row in zip(shares, columns.astype(int), rows.astype(int), strict=True):
        place, cover = (row, column), share / 255
        own = cover * hidden[place]
        np.testing.assert_allclose(alone[place], own + (1 - cover) * background, atol=0.01)
        through = walled[place] - own  # a pane keeps some of the light away from the wall
        assert (through >= 0.2 * (1 - cover) * plain[place] - 0.01).all()
        assert (through <= (1 - cover) * plain[place] + 0.01).all()


def srgb_to_linear(values: np.ndarray) -> np.ndarray:
    return linear_from_srgb(values / 255.0)


def test_textures_repeat_outside_the_unit_square():
    texture = np.array([[RED, BLUE]], dtype=np.uint8).repeat(8, axis=0).repeat(8, axis=1)
    mesh = quad(texture)
    assert mesh.uv is not None
    picture = render_scene(
        [surface_from_mesh(replace(mesh, uv=mesh.uv * [3.0, 1.0]))], FRONT, RenderConfig(ground=False)
    )
    row = picture[100].astype(int)
    red = (row[:, 0] > row[:, 2] + 60) & (row[:, 1] < 128)
    assert (np.diff(red.astype(int)) == 1).sum() == 3


def test_pictures_repeat_bit_by_bit_and_inputs_stay():
    surfaces = [box_surface((0, 0, 0), (1, 0.7, 1.2)), box_surface((-0.6, 0.1, 0.2), (0.2, 0.2, 0.2), 1)]
    camera = place_camera(surface_points(surfaces), Viewpoint(width=120, height=90))
    before = [surface.triangles.copy() for surface in surfaces]
    first, second = render_scene(surfaces, camera), render_scene(surfaces, camera)
    assert first.shape == (90, 120, 3)
    assert (first == second).all()
    assert all((surface.triangles == old).all() for surface, old in zip(surfaces, before, strict=True))


def test_of_a_doubled_face_the_side_that_looks_at_the_viewer_is_seen():
    front = quad(None, color=(0.8, 0.1, 0.1))
    back = Mesh(vertices=front.vertices, faces=front.faces[:, ::-1], color=(0.1, 0.1, 0.8))
    surfaces = [surface_from_mesh(back, surface_id=0), surface_from_mesh(front, surface_id=1)]
    ids = render_ids(surfaces, FRONT)
    assert set(np.unique(ids)) == {-1, 1}
    assert set(np.unique(render_ids(surfaces, BEHIND))) == {-1, 0}
    assert set(np.unique(render_ids(surfaces[::-1], FRONT))) == {-1, 1}


def test_both_sides_of_a_single_face_are_lit_alike():
    # A light in the plane of the face and none of the floor: only the camera's side can matter.
    cfg = RenderConfig(ground=False, light_direction=(0.0, 0.0, 1.0))
    surface = surface_from_mesh(replace(quad(None), material=MATTE))  # a room is not mirrored alike in both
    front, behind = render_scene([surface], FRONT, cfg), render_scene([surface], BEHIND, cfg)
    inside = np.s_[60:140, 60:140]
    assert (render_ids([surface_from_mesh(quad(None))], FRONT)[inside] == 0).all()
    assert (front[inside] == behind[inside]).all()
    assert front[inside].max() < 200


def test_the_floor_is_dark_below_the_object_and_bright_far_away():
    box = box_surface((0, 0, 0.5), (1, 1, 1))
    camera = place_camera(surface_points([box]), Viewpoint(margin=0.25))
    picture = render_scene([box], camera)
    ids = render_ids([box], camera)
    floor = picture[ids == -1].astype(int).mean(axis=1)
    bright = np.mean(RenderConfig().background)
    assert floor.max() == pytest.approx(bright, abs=1)
    assert floor.min() < bright - 40
    assert (picture[0] == RenderConfig().background).all()
    plain = render_scene([box], camera, RenderConfig(ground=False))
    free = scipy.ndimage.binary_erosion(ids == -1, iterations=1, border_value=1)
    assert free.any()
    assert (plain[free] == RenderConfig().background).all()


def test_the_light_comes_from_where_the_config_says():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.7)
    surface = surface_from_mesh(Mesh(vertices=ball.vertices, faces=ball.faces))
    left = render_scene([surface], FRONT, RenderConfig(light_direction=(-0.2, 1.0, 0.0), ground=False))
    right = render_scene([surface], FRONT, RenderConfig(light_direction=(-0.2, -1.0, 0.0), ground=False))
    assert left[100, 70].mean() > left[100, 130].mean() + 30
    assert right[100, 130].mean() > right[100, 70].mean() + 30


def test_edge_rays_soften_edges_and_nothing_else():
    surface = move_surface(
        box_surface((0, 0, 0), (1, 1, 1)),
        screw_motion(np.array([1.0, 0.0, 0.0]), np.zeros(3), np.array(0.2), np.array(0.0)),
    )
    cfg = RenderConfig(ground=False)
    rough = render_scene([surface], FRONT, replace(cfg, edge_rays=1)).astype(int)
    smooth = render_scene([surface], FRONT, cfg).astype(int)
    differs = (rough != smooth).any(axis=2)
    ids = render_ids([surface], FRONT)
    inside = np.zeros_like(differs)
    inside[2:-2, 2:-2] = (ids[4:, 2:-2] == ids[:-4, 2:-2]) & (ids[2:-2, 4:] == ids[2:-2, :-4])
    assert differs.any()
    assert not differs[inside & (ids == 0)].any()
    assert len(np.unique(smooth[..., 0])) > len(np.unique(rough[..., 0]))


def test_moving_surface_and_camera_together_changes_no_depth():
    surface = box_surface((0.1, 0.2, 0.0), (0.5, 0.8, 0.6))
    T = np.eye(4)
    T[:3, :3] = rotation_about(np.array([0.0, 0.0, 1.0]), np.array(0.7))
    T[:3, 3] = [0.3, -2.0, 1.0]
    position, axes = T[:3, :3] @ FRONT.position + T[:3, 3], FRONT.axes @ T[:3, :3].T
    moved = replace(FRONT, position=position, axes=axes)
    here, there = render_depth([surface], FRONT), render_depth([move_surface(surface, T)], moved)
    same = np.isfinite(here) & np.isfinite(there)
    assert (np.isfinite(here) != np.isfinite(there)).mean() < 0.003
    assert here[same] == pytest.approx(there[same], abs=1e-4)


def test_smooth_normals_are_radial_on_a_ball_and_flat_on_a_box():
    ball = trimesh.creation.icosphere(subdivisions=3)
    triangles = ball.vertices[ball.faces]
    assert (corner_normals(triangles, 30.0) * triangles).sum(axis=2).min() > 0.999
    box = trimesh.creation.box()
    flat = np.repeat(box.face_normals[:, None], 3, axis=1)
    assert corner_normals(box.vertices[box.faces], 30.0) == pytest.approx(flat, abs=1e-9)
    tilted = corner_normals(box.vertices[box.faces], 120.0)
    assert np.abs((tilted * flat).sum(axis=2) - 1.0).min() > 0.1


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: RenderConfig(edge_rays=0), ("edge_rays 0", "1")),
        (lambda: RenderConfig(light_direction=(0.0, 0.0, 0.0)), ("light_direction", "above 0")),
        (lambda: replace(box_surface((0, 0, 0), (1, 1, 1)), id=-1), ("-1", "background")),
    ],
)
def test_bad_values_are_named(build, words: tuple[str, ...]):
    with pytest.raises(ValueError, match=r".+") as caught:
        build()
    assert all(word in str(caught.value) for word in words), str(caught.value)


@pytest.mark.parametrize(("away", "even"), [(0.1, False), (6.0, True)])
def test_a_fine_pattern_is_its_mean_from_afar_and_itself_from_near(away: float, even: object):
    """Squares of 4 mm in black and white."""
    board = (np.indices((512, 512)) // 2).sum(axis=0) % 2 * 255
    texture = np.repeat(board[..., None], 3, axis=2).astype(np.uint8)
    camera = look_at(np.array([-away, 0.0, 0.0]), np.zeros(3), fov=20.0, width=60, height=60)
    surface = surface_from_mesh(replace(quad(texture), material=MATTE))
    seen = render_scene([surface], camera, RenderConfig(ground=False))[27:33, 27:33].astype(float)
    assert (np.ptp(seen) < 8.0) == even
