"""Pictures of meshes: visible faces against rays, and the camera and light that shapes have."""

from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import binary_dilation
from scipy.spatial import ConvexHull

from artigen.camera import Camera, project_points
from artigen.datasets.mesh_raster import rasterize_mesh
from artigen.datasets.partnet_mobility import ReaderConfig, read_object
from artigen.datasets.partnet_surface import FaceTable
from artigen.examples.photographs import draw_camera, photograph_mesh, photograph_shape
from artigen.files.mtl import Material
from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape

CAMERA = Camera(
    position=np.array([-3.0, 0.1, 0.2]), axes=np.eye(3)[[1, 2, 0]], pixel=0.02, width=40, height=30
)


def soup(seed: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles anywhere near the origin, some of them slivers, some beyond the picture."""
    rng = np.random.default_rng(seed)
    vertices = rng.uniform(-1.4, 1.4, (3 * count, 3))
    vertices[1:60:3] = vertices[:60:3] + 1e-3
    return vertices, np.arange(3 * count).reshape(-1, 3)


def cast(vertices: np.ndarray, faces: np.ndarray, camera: Camera) -> np.ndarray:
    """Nearest depth of every pixel by solving for each triangle, infinite where there is none."""
    columns, rows = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    x, y = (columns.ravel() - camera.width / 2), (rows.ravel() - camera.height / 2)
    rays = np.column_stack([x * camera.pixel, y * camera.pixel, np.ones(len(x))]) @ camera.axes
    nearest = np.full(len(rays), np.inf)
    for triangle in vertices[faces] - camera.position:
        weights = rays @ np.linalg.inv(triangle)  # of the corners, times one over the depth
        inside = (weights >= 0).all(axis=1)
        nearest[inside] = np.minimum(nearest[inside], 1.0 / weights[inside].sum(axis=1))
    return nearest


def test_the_nearest_triangle_is_that_of_rays_through_the_pixels():
    vertices, faces = soup(0, 120)
    seen = rasterize_mesh(vertices, faces, CAMERA)
    found = np.full(CAMERA.width * CAMERA.height, np.inf)
    found[seen.pixel] = seen.depth
    truth = cast(vertices, faces, CAMERA)
    assert 0.3 < np.isfinite(truth).mean() <= 1.0
    np.testing.assert_allclose(found, truth, rtol=2e-4)  # backs are a little behind


def test_weights_give_the_point_that_is_seen():
    vertices, faces = soup(1, 40)
    seen = rasterize_mesh(vertices, faces, CAMERA)
    assert len(seen.pixel) > 100
    assert (seen.weights > -1e-5).all()
    points = np.einsum("nk,nkd->nd", seen.weights, vertices[faces[seen.face]])
    *screen, depth = project_points(CAMERA, points).T
    middles = np.column_stack([seen.pixel % CAMERA.width, seen.pixel // CAMERA.width]) + 0.5
    np.testing.assert_allclose(np.column_stack(screen), middles, atol=1e-4)
    np.testing.assert_allclose(depth, seen.depth, rtol=1e-5)


@pytest.mark.parametrize("turned", [False, True])
def test_of_a_sheet_with_two_sides_the_one_that_faces_the_camera_is_seen(*, turned: bool):
    vertices = np.array([[0.0, -1.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]])
    sides = np.array([[0, 1, 2], [0, 2, 1]])  # the second one faces -x
    seen = rasterize_mesh(vertices, sides[::-1] if turned else sides, CAMERA)
    assert set(seen.face.tolist()) == {0 if turned else 1}


def test_nothing_is_seen_of_what_is_a_line_or_beside_the_picture():
    on_a_line = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    beside = on_a_line + np.array([[0.0, 5.0, 0.0], [0.0, 5.0, 0.0], [0.0, 5.0, 1.0]])
    faces = np.array([[0, 1, 2], [0, 0, 1], [3, 4, 5]])
    assert len(rasterize_mesh(np.concatenate([on_a_line, beside]), faces, CAMERA).pixel) == 0


def mesh_of(shape: Shape) -> FaceTable:
    """The surfaces of all primitives in the unit of metres, red."""
    hulls = [ConvexHull(place_vertices(p)) for part in shape.parts for p in part.primitives]
    starts = np.cumsum([0, *(len(hull.points) for hull in hulls)])[:-1]
    faces = np.concatenate([hull.simplices + start for hull, start in zip(hulls, starts, strict=True)])
    vertices = np.concatenate([hull.points for hull in hulls])
    return FaceTable(
        vertices=vertices,
        faces=faces.astype(np.int64),
        corners=vertices[faces],
        uv=np.zeros((len(faces), 3, 2)),
        material_ids=np.zeros(len(faces), dtype=np.int64),
        materials=(Material(color=(0.8, 0.1, 0.1)),),
    )


@pytest.mark.parametrize("category", ["Table", "Microwave"])
def test_a_mesh_is_seen_as_the_shape_it_is_made_of(category: str):
    shape = draw_shape(category, 4)
    exact = photograph_shape(shape, 7, 48)
    mesh = mesh_of(shape)
    drawn = photograph_mesh([mesh], 1.0, 7, 48)
    assert ((exact[..., 3] > 0) == (drawn[..., 3] > 0)).mean() > 0.995
    np.testing.assert_array_equal(photograph_mesh([mesh], 1.0, 7, 48), drawn)
    other = photograph_mesh([mesh], 1.0, 8, 48)
    assert (other[..., 3] != drawn[..., 3]).mean() > 0.01


def test_a_picture_of_a_mesh_has_its_colour_light_and_nothing_around():
    shape = draw_shape("Table", 4)
    seen = photograph_mesh([mesh_of(shape)], 1.0, 7, 48)
    inside = seen[..., 3] > 0
    assert not seen[~inside].any()
    red, green = seen[inside][:, 0].astype(float), seen[inside][:, 1].astype(float)
    assert (red > 2 * green).all()
    assert np.ptp(red) > 30  # lit from one side, with shadows


@pytest.mark.real
def test_a_real_object_is_seen_where_its_surface_is(real_objects: Path):
    source = read_object(real_objects / "partnet_mobility" / "46197", ReaderConfig(samples=60_000))
    assert source.asset.surface is not None
    seen = photograph_mesh(source.tables, source.asset.scale, 3, 64)[..., 3] > 0
    scale = source.asset.scale
    camera = draw_camera(scale * source.triangles.vertices[np.unique(source.triangles.faces)], 3, 64)
    screen = project_points(camera, scale * source.asset.surface.points)[:, :2]
    column, row = np.floor(screen).astype(int).T
    assert binary_dilation(seen, np.ones((3, 3)))[row, column].all()
    hit = np.zeros_like(seen)
    hit[row, column] = True
    assert hit[seen].mean() > 0.98
