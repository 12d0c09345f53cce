"""Laws of textures: every texel filled, colours where the Gaussians are, sides of thin walls apart."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from artigen.camera import look_at
from artigen.splats.colors import linear_from_srgb
from artigen.splats.render.picture import draw_gaussians
from artigen.splats.surface import SurfaceSplatConfig, splat_surface
from artigen.transforms import matrix_from_quat
from artigen.types import Asset, Gaussians, SurfaceSamples
from sim_export.appearance import texture
from sim_export.appearance.atlas import make_atlas
from sim_export.appearance.texture import DISCS, MAX_SIZE, TEXELS, BakedMesh, bake_mesh, bake_parts
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


def bake(
    mesh: Mesh,
    points: np.ndarray,
    colors: np.ndarray,
    texel: float,
    normals: np.ndarray,
    *,
    facing: bool = True,
) -> BakedMesh:
    """The mesh in the colours of samples; without ``facing``, of Gaussians that have no front."""
    samples = SurfaceSamples(
        points=points, normals=normals, colors=colors, part_ids=np.zeros(len(points), dtype=np.int64)
    )
    discs = splat_surface(samples, SurfaceSplatConfig(edge=1.0))
    ahead = matrix_from_quat(discs.quats)[:, :, 2] if facing else None
    return bake_mesh(mesh, discs, voxel=texel * TEXELS, normals=ahead)


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
def cabinet(cabinet: Asset) -> Asset:
    """The sample cabinet with as many samples as its few colours need."""
    assert cabinet.surface is not None
    return replace(
        cabinet, surface=SurfaceSamples(**{name: value[::8] for name, value in vars(cabinet.surface).items()})
    )


@pytest.fixture(scope="session")
def textured(cabinet: Asset) -> tuple[Mesh, ...]:
    return bake_parts(cabinet, mesh_parts(cabinet)).meshes


@pytest.mark.parametrize("opacity", [0.05, 0.2])
def test_a_pane_in_a_frame_is_as_clear_as_its_gaussians(opacity: float):
    board = box_mesh(1.0, 0.02, 1.0)
    points, normals = sample(board, 12000)
    window = np.abs(points[:, [0, 2]]).max(axis=1) < 0.3
    samples = SurfaceSamples(
        points=points,
        normals=normals,
        colors=np.where(window[:, None], BLUE, RED),
        part_ids=np.zeros(len(points), dtype=np.int64),
    )
    discs = splat_surface(samples, SurfaceSplatConfig(edge=1.0))
    discs = replace(discs, opacities=np.where(window, opacity, discs.opacities))
    baked = bake_mesh(board, discs, voxel=0.04)
    assert baked.covered == baked.texels
    faces, weights, places = random_places(baked.mesh)
    seen = look_up(baked.mesh, faces, weights)
    middle = np.abs(places[:, [0, 2]]).max(axis=1)
    assert (seen[middle > 0.35, 3] == 255).all()
    white, black = (
        draw_gaussians(
            discs,
            look_at(np.array([0.0, -3.0, 0.0]), np.zeros(3), fov=8.0, width=64, height=64),
            background=(tone,) * 3,
        )
        for tone in (1.0, 0.0)
    )
    through = (white.astype(float) - black)[16:48, 16:48].mean() / 255.0
    shares = seen[middle < 0.25, 3] / 255.0
    assert ((1.0 - shares) ** 2).mean() == pytest.approx(through, abs=0.05)
    np.testing.assert_allclose(seen[middle < 0.25, :3].mean(axis=0), np.maximum(BLUE, 4), atol=8)


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


@pytest.mark.parametrize("facing", [True, False])
def test_colours_come_back_where_they_were_sampled(*, facing: bool):
    mesh = ball_mesh()
    points, normals = sample(mesh)
    colors = np.rint((points + 0.5) * 255).astype(np.uint8)
    baked = bake(mesh, points, colors, 0.02, normals, facing=facing)
    assert baked.covered == baked.texels > 1000
    faces, weights, at = random_places(baked.mesh)
    error = np.abs(look_up(baked.mesh, faces, weights).astype(float) - (at + 0.5) * 255)
    assert error.mean() < 3.0
    assert np.percentile(error, 99) < 15.0


def test_both_sides_of_a_thin_plate_keep_their_colour():
    mesh = box_mesh(1.0, 1.0, 0.01)
    points, normals = sample(mesh)
    points[:, 2] = 0.0
    colors = np.where((normals[:, 2] > 0)[:, None], RED, BLUE)
    baked = bake(mesh, points, colors, 0.02, normals).mesh
    faces, weights, at = random_places(baked)
    inside = np.ptp(mesh.vertices[mesh.faces[faces], 2], axis=1) == 0
    assert inside.sum() > 100
    seen = look_up(baked, faces[inside], weights[inside])
    np.testing.assert_array_equal(seen, np.where((at[inside, 2] > 0)[:, None], RED, BLUE))


def test_gaussians_without_a_front_show_the_side_they_lie_on():
    """Two sheets 0.04 apart, looked at from both sides: each hides the other."""
    mesh = box_mesh(1.0, 1.0, 0.04)
    points, normals = sample(mesh, 60000)
    colors = np.where((normals[:, 2] > 0)[:, None], RED, BLUE)
    baked = bake(mesh, points, colors, 0.02, normals, facing=False).mesh
    faces, weights, at = random_places(baked)
    inside = (np.ptp(mesh.vertices[mesh.faces[faces], 2], axis=1) == 0) & (np.abs(at[:, :2]) < 0.45).all(
        axis=1
    )
    assert inside.sum() > 100
    seen = look_up(baked, faces[inside], weights[inside]).astype(float)
    wrong = np.abs(seen - np.where((at[inside, 2] > 0)[:, None], RED, BLUE)).max(axis=1)
    assert np.median(wrong) < 8
    assert np.percentile(wrong, 99) < 60


def test_a_lone_sheet_colours_both_sides():
    mesh = box_mesh(1.0, 1.0, 0.01)
    points, _ = sample(mesh)
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    colors = np.where((points[:, 0] > 0)[:, None], RED, BLUE)
    baked = bake(mesh, points, colors, 0.02, up).mesh
    faces, weights, at = random_places(baked)
    clear = np.abs(at[:, 0]) > 0.06
    seen = look_up(baked, faces[clear], weights[clear])
    np.testing.assert_array_equal(seen, np.where((at[clear, 0] > 0)[:, None], RED, BLUE))


def test_an_edge_between_materials_is_straight_and_smooth():
    """Of random samples, the border at x = 0 wanders in what is nearest; in the texture it does not."""
    mesh = box_mesh(1.0, 1.0, 0.1)
    points, normals = sample(mesh, 25000)
    colors = np.where((points[:, 0] > 0)[:, None], RED, BLUE)
    baked = bake(mesh, points, colors, 0.008, normals).mesh
    at = np.stack(np.meshgrid(np.linspace(-0.05, 0.05, 101), np.linspace(-0.3, 0.3, 40)), axis=-1)
    top = np.flatnonzero((mesh.vertices[mesh.faces][:, :, 2] > 0).all(axis=1))
    triangles = mesh.vertices[mesh.faces[top]]
    crossings = []
    for row in at:
        places = np.column_stack([row, np.full(len(row), 0.05)])
        weights = np.stack(
            [trimesh.triangles.points_to_barycentric(triangles[[k] * len(row)], places) for k in (0, 1)]
        )
        chosen = weights.min(axis=2).argmax(axis=0)
        shown = look_up(baked, top[chosen], weights[chosen, np.arange(len(row))])[:, 0].astype(float)
        assert (np.diff(shown) >= -25).all()
        crossings.append(row[np.abs(shown - (RED[0] + BLUE[0]) / 2).argmin(), 0])
    assert np.std(crossings) < 0.008
    assert abs(np.mean(crossings)) < 0.008


def test_one_colour_needs_no_image():
    mesh = box_mesh(1.0, 1.0, 1.0)
    points, normals = sample(mesh, 100)
    baked = bake(mesh, points, np.tile(RED, (100, 1)), 0.1, normals).mesh
    assert baked.texture is None
    assert baked.uv is None
    np.testing.assert_allclose(baked.color, RED / 255, atol=1e-6)


def test_no_texel_is_left_black_and_all_are_between_the_colours_there_are(
    cabinet: Asset, textured: tuple[Mesh, ...]
):
    images = [mesh for mesh in textured if mesh.texture is not None]
    assert images
    palette = cabinet.surface.colors
    for mesh in images:
        assert mesh.texture.min() > 0
        assert mesh.uv.min() >= 0
        assert mesh.uv.max() <= 1
        seen = mesh.texture.reshape(-1, 3)
        assert (seen >= palette.min(axis=0)).all()
        assert (seen <= palette.max(axis=0)).all()


def test_what_nothing_covers_is_filled_and_counted():
    mesh = box_mesh(1.0, 1.0, 0.1)
    points, normals = sample(mesh, 40000)
    near = points[:, 0] < 0
    colors = np.where((points[near, 1] > 0)[:, None], RED, BLUE)
    baked = bake(mesh, points[near], colors, 0.02, normals[near])
    assert baked.covered / baked.texels == pytest.approx(0.5, abs=0.08)
    faces, weights, at = random_places(baked.mesh)
    far = (at[:, 0] > 0.1) & (np.abs(at[:, 1]) > 0.1)
    assert far.sum() > 200
    seen = look_up(baked.mesh, faces[far], weights[far])
    np.testing.assert_array_equal(seen, np.where((at[far, 1] > 0)[:, None], RED, BLUE))


def test_the_neighbouring_part_lends_no_colour(cabinet: Asset):
    """Each part in one colour of its own: no texture, and exactly that colour."""
    surface = cabinet.surface
    own = np.random.default_rng(0).integers(20, 250, (len(cabinet.parts), 3)).astype(np.uint8)
    asset = replace(cabinet, surface=replace(surface, colors=own[surface.part_ids]))
    baked = bake_parts(asset, mesh_parts(cabinet))
    for index, mesh in enumerate(baked.meshes):
        assert mesh.texture is None
        np.testing.assert_allclose(mesh.color, own[index] / 255, atol=1e-6)


def test_baking_keeps_the_mesh_and_repeats_exactly(cabinet: Asset, textured: tuple[Mesh, ...]):
    meshes = mesh_parts(cabinet)
    for plain, one, two in zip(meshes, textured, bake_parts(cabinet, meshes).meshes, strict=True):
        np.testing.assert_array_equal(plain.vertices, one.vertices)
        np.testing.assert_array_equal(plain.faces, one.faces)
        assert (one.texture is None) == (two.texture is None)
        if one.texture is not None:
            assert one.texture.tobytes() == two.texture.tobytes()
            assert one.uv.tobytes() == two.uv.tobytes()


def test_large_parts_get_larger_texels():
    mesh = box_mesh(1.0, 1.0, 1.0)
    points, normals = sample(mesh, 4000)
    colors = np.rint((points + 0.5) * 255).astype(np.uint8)
    samples = SurfaceSamples(
        points=points, normals=normals, colors=colors, part_ids=np.zeros(4000, dtype=int)
    )
    baked = bake_mesh(mesh, splat_surface(samples), voxel=0.01).mesh
    assert 0.5 * MAX_SIZE < max(baked.texture.shape[:2]) <= MAX_SIZE
    with pytest.raises(ValueError, match="do not fit"):
        make_atlas(mesh, 0.1, 4)


def test_gaussians_come_before_samples_and_are_counted(cabinet: Asset):
    surface = cabinet.surface
    rows = slice(None, None, 3)
    few = SurfaceSamples(**{name: value[rows] for name, value in vars(surface).items()})
    meshes = mesh_parts(cabinet)
    asset = replace(
        cabinet, gaussians=splat_surface(few), surface=replace(surface, colors=255 - surface.colors)
    )
    baked, reference = bake_parts(asset, meshes), bake_parts(cabinet, meshes)
    for mesh, wanted in zip(baked.meshes, reference.meshes, strict=True):
        np.testing.assert_allclose(mesh.color, wanted.color, atol=0.05)
    said = baked.records[-1]
    assert said.startswith("textures: Gaussians of the own part cover ")
    assert float(said.split("cover ")[1].split(" %")[0]) > 99.0
    assert reference.records[-1].startswith("textures: surface samples")
    with pytest.raises(ValueError, match="neither Gaussians nor surface samples"):
        bake_parts(replace(cabinet, surface=None), meshes)


def test_a_part_without_gaussians_is_on_record(cabinet: Asset):
    gaussians = splat_surface(cabinet.surface)
    kept = gaussians.part_ids != 1
    asset = replace(
        cabinet, gaussians=Gaussians(**{name: value[kept] for name, value in vars(gaussians).items()})
    )
    meshes = mesh_parts(cabinet)
    baked = bake_parts(asset, meshes)
    assert baked.meshes[1] is meshes[1]
    assert f"{cabinet.parts[1].name}: no colour samples; its default colour is kept" in baked.records


def test_colours_of_gaussians_are_light_and_those_of_textures_are_not():
    mesh = box_mesh(1.0, 1.0, 1.0)
    points, normals = sample(mesh, 2000)
    grey = np.full((2000, 3), 128, dtype=np.uint8)
    samples = SurfaceSamples(points=points, normals=normals, colors=grey, part_ids=np.zeros(2000, dtype=int))
    discs = splat_surface(samples)
    np.testing.assert_allclose(discs.colors, linear_from_srgb(np.array(128 / 255.0)), rtol=1e-4)
    np.testing.assert_allclose(bake_mesh(mesh, discs, voxel=0.1).mesh.color, 128 / 255, atol=1e-6)


def test_missing_gaussians_are_an_error(cabinet: Asset):
    none = Gaussians(**{name: value[:0] for name, value in vars(splat_surface(cabinet.surface)).items()})
    with pytest.raises(ValueError, match="no Gaussians"):
        bake_mesh(box_mesh(1, 1, 1), none, voxel=0.1)


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
    baked = bake(mesh, points, colors, texel, normals).mesh
    corners = mesh.vertices[mesh.faces]
    front = np.flatnonzero((corners[:, :, 0] < 0).all(axis=1))
    faces, weights = rng.choice(front, 4000), rng.dirichlet(np.ones(3), 4000)
    at = np.einsum("nc,ncd->nd", weights, corners[faces])
    shown = look_up(baked, faces, weights)
    window = (np.abs(at[:, 1:]) < 0.2 - 3 * texel).all(axis=1)
    frame = (np.abs(at[:, 1:]) > 0.2 + 3 * texel).any(axis=1)
    assert window.sum() > 200
    np.testing.assert_array_equal(shown[window], np.tile(RED, (window.sum(), 1)))
    # Discs of random samples leave gaps; hardly anything of the inner sheet is seen through them.
    wrong = np.abs(shown[frame].astype(float) - BLUE).max(axis=1)
    assert np.median(wrong) < 8
    assert wrong.mean() < 12


def test_a_sheet_behind_does_not_show_through_the_gaps_between_random_samples():
    """A panel of doubled faces: brown outside, and the white backs of the other side 12 mm below."""
    plate = box_mesh(0.4, 0.3, 0.02)
    rng = np.random.default_rng(3)
    points = rng.uniform([-0.2, -0.15, 0.0], [0.2, 0.15, 0.0], (12000, 3))
    points[:, 2] = np.where(np.arange(12000) % 2, 0.01, -0.002)
    colors = np.where(points[:, 2:] > 0, [110, 60, 30], [255, 255, 255]).astype(np.uint8)
    samples = SurfaceSamples(
        points=points,
        normals=np.tile([0.0, 0.0, 1.0], (12000, 1)),
        colors=colors,
        part_ids=np.zeros(12000, dtype=np.int64),
    )
    discs = splat_surface(samples, DISCS)
    ahead = matrix_from_quat(discs.quats)[:, :, 2]
    baked = bake_mesh(plate, discs, voxel=0.016, normals=ahead).mesh
    faces, weights, places = random_places(baked)
    top = places[:, 2] > 0.0099
    seen = look_up(baked, faces[top], weights[top])
    assert np.count_nonzero(seen[:, 2] > 60) <= 0.002 * top.sum()


@pytest.mark.parametrize(("levels", "images"), [(3, 0), (4, 1)])
def test_colours_within_three_levels_are_one(levels: int, images: int):
    mesh = box_mesh(0.2, 0.2, 0.2)
    points, normals = sample(mesh, 2000)
    colors = np.full((2000, 3), 100, dtype=np.uint8)
    colors[::2, 1] += levels
    baked = bake(mesh, points, colors, 0.02, normals).mesh
    assert (baked.texture is not None) == images


@pytest.mark.parametrize(("samples", "used"), [(300_000, 300_000), (300_001, 150_001)])
def test_colours_come_from_three_hundred_thousand_samples_at_most(monkeypatch, cabinet, samples, used):
    seen = []
    monkeypatch.setattr(
        texture,
        "splat_surface",
        lambda surface, _: (
            seen.append(surface)
            or splat_surface(
                SurfaceSamples(**{name: value[:9] for name, value in vars(surface).items()}), DISCS
            )
        ),
    )
    rows = np.arange(samples) % len(cabinet.surface.points)
    many = SurfaceSamples(**{name: value[rows] for name, value in vars(cabinet.surface).items()})
    texture._find_gaussians(replace(cabinet, surface=many))
    assert [len(surface.points) for surface in seen] == [used]
