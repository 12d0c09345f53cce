"""Laws of textures: every texel filled, colours where they were sampled, sides of thin walls apart."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from artigen.types import Asset, Gaussians
from sim_export.appearance.atlas import make_atlas
from sim_export.appearance.texture import TextureConfig, bake_parts, bake_texture
from sim_export.geometry.meshing import mesh_parts
from sim_export.package import Mesh

RED, BLUE = np.array([200, 10, 10], dtype=np.uint8), np.array([10, 10, 200], dtype=np.uint8)


def box_mesh(*extents: float) -> Mesh:
    box = trimesh.creation.box(extents)
    return Mesh(vertices=box.vertices, faces=box.faces)


def ball_mesh() -> Mesh:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.5)
    return Mesh(vertices=ball.vertices, faces=ball.faces)


def sample(mesh: Mesh, count: int = 20000) -> tuple[np.ndarray, np.ndarray]:
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    points, faces = trimesh.sample.sample_surface(solid, count, seed=0)
    return np.asarray(points), np.asarray(solid.face_normals[faces])


def look_up(mesh: Mesh, faces: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Colours of a textured mesh at barycentric places, as a renderer would read them."""
    height, width = mesh.texture.shape[:2]
    uv = np.einsum("nc,ncd->nd", weights, mesh.uv[faces])
    column = np.floor(uv[:, 0] * width).astype(int)
    row = np.floor((1.0 - uv[:, 1]) * height).astype(int)
    return mesh.texture[row, column]


def random_places(mesh: Mesh, count: int = 3000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(7)
    faces = rng.integers(0, len(mesh.faces), count)
    weights = rng.dirichlet((1.0, 1.0, 1.0), count)
    return faces, weights, np.einsum("nc,ncd->nd", weights, mesh.vertices[mesh.faces[faces]])


@pytest.fixture(scope="session")
def textured(cabinet: Asset) -> tuple[Mesh, ...]:
    return bake_parts(cabinet, mesh_parts(cabinet))


@pytest.mark.parametrize("mesh", [box_mesh(1.0, 0.4, 0.02), ball_mesh()], ids=["box", "ball"])
def test_an_atlas_shows_every_texel_where_it_is(mesh: Mesh):
    atlas = make_atlas(mesh, 0.02, 512)
    assert max(atlas.shape) <= 512
    assert len(np.unique(atlas.texels, axis=0)) == len(atlas.texels)
    assert (atlas.texels >= 0).all()
    assert (atlas.texels < atlas.shape).all()
    # The corner coordinates are an affine map of each face: they carry a face's points to texels.
    corners, triangles = atlas.corners[atlas.faces], mesh.vertices[mesh.faces][atlas.faces]
    weights = trimesh.triangles.points_to_barycentric(triangles, atlas.points)
    back = np.einsum("nc,ncd->nd", weights, corners)
    assert np.abs(back - atlas.texels[:, ::-1]).max() < 0.75
    assert np.median(np.abs(back - atlas.texels[:, ::-1])) < 1e-6
    area = trimesh.Trimesh(mesh.vertices, mesh.faces).area
    assert len(atlas.texels) == pytest.approx(area / 0.02**2, rel=0.35)


def test_charts_do_not_overlap():
    mesh = box_mesh(1.0, 0.7, 0.3)
    atlas = make_atlas(mesh, 0.02, 512)
    low, high = atlas.corners.min(axis=1), atlas.corners.max(axis=1)
    boxes = np.unique(np.concatenate([low, high], axis=1), axis=0)
    assert len(boxes) == 6
    for index, one in enumerate(boxes):
        for other in boxes[index + 1 :]:
            gap = np.maximum(one[:2] - other[2:], other[:2] - one[2:])
            assert gap.max() >= 2.0


def test_colours_come_back_where_they_were_sampled():
    mesh = ball_mesh()
    points, normals = sample(mesh)
    colors = np.rint((points + 0.5) * 255).astype(np.uint8)
    baked = bake_texture(mesh, points, colors, texel_size=0.02, normals=normals)
    faces, weights, at = random_places(baked)
    error = np.abs(look_up(baked, faces, weights).astype(float) - (at + 0.5) * 255)
    assert error.mean() < 3.0
    assert np.percentile(error, 99) < 15.0


def test_both_sides_of_a_thin_plate_keep_their_colour():
    mesh = box_mesh(1.0, 1.0, 0.01)
    points, normals = sample(mesh)
    points[:, 2] = 0.0
    colors = np.where((normals[:, 2] > 0)[:, None], RED, BLUE)
    baked = bake_texture(mesh, points, colors, texel_size=0.02, normals=normals)
    faces, weights, at = random_places(baked)
    inside = np.ptp(mesh.vertices[mesh.faces[faces], 2], axis=1) == 0
    assert inside.sum() > 100
    seen = look_up(baked, faces[inside], weights[inside])
    np.testing.assert_array_equal(seen, np.where((at[inside, 2] > 0)[:, None], RED, BLUE))


def test_a_lone_sheet_colours_both_sides():
    mesh = box_mesh(1.0, 1.0, 0.01)
    points, _ = sample(mesh)
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    colors = np.where((points[:, 0] > 0)[:, None], RED, BLUE)
    baked = bake_texture(mesh, points, colors, texel_size=0.02, normals=up)
    faces, weights, at = random_places(baked)
    clear = np.abs(at[:, 0]) > 0.03
    seen = look_up(baked, faces[clear], weights[clear])
    np.testing.assert_array_equal(seen, np.where((at[clear, 0] > 0)[:, None], RED, BLUE))


def test_one_colour_needs_no_image():
    mesh = box_mesh(1.0, 1.0, 1.0)
    points, _ = sample(mesh, 100)
    baked = bake_texture(mesh, points, np.tile(RED, (100, 1)), texel_size=0.1)
    assert baked.texture is None
    assert baked.uv is None
    np.testing.assert_allclose(baked.color, RED / 255)


def test_no_texel_is_left_black(cabinet: Asset, textured: tuple[Mesh, ...]):
    images = [mesh for mesh in textured if mesh.texture is not None]
    assert images
    for mesh in images:
        assert mesh.texture.min() > 0
        assert mesh.uv.min() >= 0
        assert mesh.uv.max() <= 1
    palette = np.unique(cabinet.surface.colors, axis=0)
    for mesh in images:
        seen = np.unique(mesh.texture.reshape(-1, 3), axis=0)
        assert all((palette == color).all(axis=1).any() for color in seen)


def test_baking_keeps_the_mesh_and_repeats_exactly(cabinet: Asset, textured: tuple[Mesh, ...]):
    meshes = mesh_parts(cabinet)
    for plain, one, two in zip(meshes, textured, bake_parts(cabinet, meshes), strict=True):
        np.testing.assert_array_equal(plain.vertices, one.vertices)
        np.testing.assert_array_equal(plain.faces, one.faces)
        assert (one.texture is None) == (two.texture is None)
        if one.texture is not None:
            assert one.texture.tobytes() == two.texture.tobytes()
            assert one.uv.tobytes() == two.uv.tobytes()


def test_large_parts_get_larger_texels():
    mesh = box_mesh(1.0, 1.0, 1.0)
    points, normals = sample(mesh)
    colors = np.rint((points + 0.5) * 255).astype(np.uint8)
    baked = bake_texture(
        mesh, points, colors, texel_size=1e-4, normals=normals, cfg=TextureConfig(max_size=64)
    )
    assert max(baked.texture.shape[:2]) <= 64
    with pytest.raises(ValueError, match="do not fit"):
        make_atlas(mesh, 0.1, 4)


def test_gaussians_give_colours_too(cabinet: Asset):
    surface = cabinet.surface
    rows = slice(None, None, 200)
    count = len(surface.points[rows])
    gaussians = Gaussians(
        means=surface.points[rows],
        quats=np.tile([1.0, 0, 0, 0], (count, 1)),
        scales=np.full((count, 3), 0.01),
        opacities=np.ones(count),
        colors=(surface.colors[rows] / 255.0) ** 2.2,
        part_ids=surface.part_ids[rows],
    )
    asset = replace(cabinet, surface=None, gaussians=gaussians)
    meshes = mesh_parts(cabinet)
    for mesh, reference in zip(bake_parts(asset, meshes), bake_parts(cabinet, meshes), strict=True):
        np.testing.assert_allclose(mesh.color, reference.color, atol=0.12)
    with pytest.raises(ValueError, match="neither surface samples nor Gaussians"):
        bake_parts(replace(cabinet, surface=None), meshes)


def test_wrong_settings_and_missing_samples_are_errors():
    with pytest.raises(ValueError, match="max_size is 4"):
        TextureConfig(max_size=4)
    with pytest.raises(ValueError, match="no colour samples"):
        bake_texture(box_mesh(1, 1, 1), np.zeros((0, 3)), np.zeros((0, 3), dtype=np.uint8), texel_size=0.1)


def test_of_two_sheets_a_hair_apart_only_the_outer_one_shows():
    """Front of a door: a sheet with a window over another of a different colour, half a texel behind it."""
    mesh = box_mesh(0.1, 1.0, 1.0)
    rng = np.random.default_rng(0)
    texel = 0.02
    inner = np.column_stack([np.full(9000, -0.05 + 0.4 * texel), rng.uniform(-0.5, 0.5, (9000, 2))])
    outer = np.column_stack([np.full(9000, -0.05), rng.uniform(-0.5, 0.5, (9000, 2))])
    outer = outer[(np.abs(outer[:, 1:]) > 0.2).any(axis=1)]
    points = np.concatenate([inner, outer])
    colors = np.concatenate([np.tile(RED, (len(inner), 1)), np.tile(BLUE, (len(outer), 1))])
    normals = np.tile([-1.0, 0.0, 0.0], (len(points), 1))
    baked = bake_texture(mesh, points, colors, texel_size=texel, normals=normals)
    corners = mesh.vertices[mesh.faces]
    front = np.flatnonzero((corners[:, :, 0] < 0).all(axis=1))
    faces, weights = rng.choice(front, 4000), rng.dirichlet(np.ones(3), 4000)
    at = np.einsum("nc,ncd->nd", weights, corners[faces])
    shown = look_up(baked, faces, weights)
    window = (np.abs(at[:, 1:]) < 0.2 - 2 * texel).all(axis=1)
    frame = (np.abs(at[:, 1:]) > 0.2 + 2 * texel).any(axis=1)
    assert window.sum() > 300
    np.testing.assert_array_equal(shown[window], np.tile(RED, (window.sum(), 1)))
    np.testing.assert_array_equal(shown[frame], np.tile(BLUE, (frame.sum(), 1)))
