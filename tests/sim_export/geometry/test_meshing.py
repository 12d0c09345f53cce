"""Laws of occupancy, smoothing and meshing: closed, fitted, round where round, open where open."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from cell_grid import grid, tight_box
from scipy import ndimage

from artigen.types import Asset, VoxelGrid
from sim_export.errors import DegeneratePart
from sim_export.geometry import meshing
from sim_export.geometry.face_planes import fit_face_planes
from sim_export.geometry.joining import join_cells
from sim_export.geometry.meshing import mesh_occupancy, mesh_parts
from sim_export.geometry.occupancy import part_occupancy
from sim_export.geometry.slants import find_slants
from sim_export.package import Mesh


def as_trimesh(vertices: np.ndarray, faces: np.ndarray) -> trimesh.Trimesh:
    return trimesh.Trimesh(vertices, faces, process=False)


def voxel_grid(occupancy: np.ndarray, other: np.ndarray | None = None) -> VoxelGrid:
    """Part 0 (and 1) as a voxel grid."""
    other = np.zeros_like(occupancy) if other is None else other
    coords = np.concatenate([np.argwhere(occupancy), np.argwhere(other)])
    ids = np.repeat([0, 1], [occupancy.sum(), other.sum()])
    return VoxelGrid(resolution=len(occupancy), coords=coords, part_ids=ids)


@pytest.fixture(scope="session")
def cabinet_meshes(cabinet: Asset) -> dict[str, Mesh]:
    return {part.name: mesh for part, mesh in zip(cabinet.parts, mesh_parts(cabinet), strict=True)}


def test_closed_boxes_become_solid_and_open_ones_stay_open():
    shell = np.zeros((16, 16, 16), dtype=bool)
    shell[3:12, 3:12, 3:12] = True
    shell[4:11, 4:11, 4:11] = False
    closed = part_occupancy(voxel_grid(shell), 0)
    assert closed.enclosed == 7**3
    assert closed.occupancy.sum() == 9**3
    shell[4:11, 4:11, 11] = False
    opened = part_occupancy(voxel_grid(shell), 0)
    np.testing.assert_array_equal(opened.occupancy, shell)
    assert (opened.shared, opened.enclosed, opened.joined) == (0, 0, 0)


def test_a_hollow_leaf_with_a_seam_owned_by_its_neighbour_is_solid_but_not_one_with_an_opening():
    leaf = np.zeros((20, 20, 20), dtype=bool)
    leaf[4:8, 3:17, 3:17] = True
    leaf[5:7, 4:16, 4:16] = False
    seam, opening = np.zeros_like(leaf), np.zeros_like(leaf)
    seam[6:8, 4:16, 16] = seam[7, 4:16, 15] = True  # along its upper edge
    opening[7, 8:13, 8:13] = True
    seamed = part_occupancy(voxel_grid(leaf & ~seam, seam), 0)
    assert seamed.enclosed == 2 * 12 * 12
    assert seamed.occupancy[5:7, 4:16, 4:16].all()
    closed_by_another = part_occupancy(voxel_grid(leaf & ~opening, opening), 0)
    assert closed_by_another.enclosed == 0
    assert not closed_by_another.occupancy[5:7, 4:16, 4:16].any()


def test_pits_owned_by_another_part_are_shared():
    door = np.zeros((16, 16, 16), dtype=bool)
    door[5, 2:14, 2:14] = True
    pits = np.zeros_like(door)
    pits[5, 4, 4:6] = pits[5, 9, 9] = True
    shared = part_occupancy(voxel_grid(door & ~pits, pits), 0)
    assert shared.shared == 3
    np.testing.assert_array_equal(shared.occupancy, door)
    holes = part_occupancy(voxel_grid(door & ~pits), 0)
    np.testing.assert_array_equal(holes.occupancy, door & ~pits)


def test_joined_cells_make_any_noise_a_manifold():
    rng = np.random.default_rng(5)
    for density in (0.05, 0.2, 0.4):
        noise = np.pad(rng.random((14, 14, 14)) < density, 1)
        solid = join_cells(noise, np.zeros_like(noise))
        assert (solid >= noise).all()
        mesh = as_trimesh(*mesh_occupancy(solid, tight_box(solid)))
        assert mesh.is_watertight
        assert mesh.volume > 0


def test_joining_commutes_with_axis_permutation():
    noise = np.pad(np.random.default_rng(1).random((10, 10, 10)) < 0.3, 1)
    none = np.zeros_like(noise)
    np.testing.assert_array_equal(
        join_cells(noise, none).transpose(1, 2, 0), join_cells(noise.transpose(1, 2, 0), none)
    )


def touched_by_ball(radius: float) -> np.ndarray:
    """Cells that a ball in the middle of the grid touches: what voxelising its surface marks."""
    nearest = np.maximum(np.abs(grid()) - 0.5, 0.0)
    return (nearest**2).sum(axis=0) < radius**2


@pytest.mark.parametrize("radius", [2.5, 3.7, 5.2, 8.0, 11.4])
def test_a_ball_is_round(radius: float):
    box = np.array([[14 - radius] * 3, [14 + radius] * 3])
    mesh = as_trimesh(*mesh_occupancy(touched_by_ball(radius), box))
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.euler_number == 2
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * radius**3, rel=0.1)
    assert np.abs(np.linalg.norm(mesh.vertices - 14, axis=1) - radius).max() < 0.35


def test_a_box_is_exactly_its_box():
    solid = np.zeros((16, 16, 16), dtype=bool)
    solid[2:9, 3:13, 5:6] = True
    box = np.array([[2.3, 3.1, 5.05], [8.6, 12.9, 5.8]])
    vertices, faces = mesh_occupancy(solid, box)
    mesh = as_trimesh(vertices, faces)
    assert len(faces) == 12
    np.testing.assert_allclose(mesh.bounds, box, atol=1e-12)
    assert mesh.volume == pytest.approx(np.prod(box[1] - box[0]))


def test_axis_permutation_and_translation_commute(monkeypatch):
    monkeypatch.setattr(meshing, "TOLERANCE", 0.0)
    x = grid(20)
    solid = ((x[:2] ** 2).sum(axis=0) < 20) | ((np.abs(x[2]) < 2) & (np.abs(x[0]) < 6) & (np.abs(x[1]) < 3))
    plain = as_trimesh(*mesh_occupancy(solid, tight_box(solid)))
    turned = as_trimesh(*mesh_occupancy(solid.transpose(2, 0, 1), tight_box(solid)[:, [2, 0, 1]]))
    moved = as_trimesh(*mesh_occupancy(np.pad(solid, 3), tight_box(solid) + 3))
    np.testing.assert_allclose(turned.bounds, plain.bounds[:, [2, 0, 1]], atol=1e-9)
    np.testing.assert_allclose(moved.bounds, plain.bounds + 3, atol=1e-9)
    assert turned.volume == pytest.approx(plain.volume, rel=1e-3)
    assert moved.volume == pytest.approx(plain.volume)
    np.testing.assert_allclose(turned.center_mass, plain.center_mass[[2, 0, 1]], atol=1e-3)


def test_every_cell_is_near_the_mesh(cabinet: Asset, cabinet_meshes: dict[str, Mesh]):
    voxels = cabinet.voxels
    for index, part in enumerate(cabinet.parts):
        mesh = cabinet_meshes[part.name]
        cells = voxels.centers()[voxels.part_ids == index] * cabinet.scale
        distance = trimesh.proximity.closest_point(as_trimesh(mesh.vertices, mesh.faces), cells)[1]
        assert distance.max() < 1.3 * cabinet.scale / voxels.resolution


def test_the_cabinet_is_closed_and_fits_its_boxes(cabinet: Asset, cabinet_meshes: dict[str, Mesh]):
    for part in cabinet.parts:
        mesh = cabinet_meshes[part.name]
        solid = as_trimesh(mesh.vertices, mesh.faces)
        assert solid.is_watertight
        assert solid.is_winding_consistent
        assert solid.volume > 0
        assert solid.area_faces.min() > 0
        assert len(mesh.faces) < 3000
        center, size = part.box * cabinet.scale
        bounds = np.stack([center - size / 2, center + size / 2])
        assert np.abs(solid.bounds - bounds).max() < 0.5 * cabinet.scale / cabinet.voxels.resolution
    for flat, most in (("door", 20), ("tray", 60)):
        assert len(cabinet_meshes[flat].faces) <= most


def test_the_cabinet_is_where_it_was_sampled(cabinet: Asset, cabinet_meshes: dict[str, Mesh]):
    cell = cabinet.scale / cabinet.voxels.resolution
    for index, part in enumerate(cabinet.parts):
        mesh = cabinet_meshes[part.name]
        points = cabinet.surface.points[cabinet.surface.part_ids == index][::40] * cabinet.scale
        distance = trimesh.proximity.closest_point(as_trimesh(mesh.vertices, mesh.faces), points)[1]
        assert distance.mean() < 0.5 * cell


def test_drawer_and_tray_stay_open(cabinet: Asset, cabinet_meshes: dict[str, Mesh]):
    for name in ("drawer", "tray"):
        mesh = cabinet_meshes[name]
        solid = as_trimesh(mesh.vertices, mesh.faces)
        center = solid.bounds.mean(axis=0)
        assert not solid.contains(center[None])[0]
        size = solid.bounds[1] - solid.bounds[0]
        assert solid.volume < 0.35 * np.prod(size)


def test_meshing_twice_gives_the_same(cabinet: Asset, cabinet_meshes: dict[str, Mesh]):
    for mesh, part in zip(mesh_parts(cabinet), cabinet.parts, strict=True):
        np.testing.assert_array_equal(mesh.vertices, cabinet_meshes[part.name].vertices)
        np.testing.assert_array_equal(mesh.faces, cabinet_meshes[part.name].faces)


def test_thin_slanted_walls_survive():
    x = grid(24)
    plate = (np.abs(x[2] - x[0] / 3) < 0.8) & (np.abs(x[1]) < 8) & (np.abs(x[0]) < 9)
    solid = join_cells(plate, np.zeros_like(plate))
    mesh = as_trimesh(*mesh_occupancy(solid, tight_box(solid)))
    assert mesh.is_watertight
    assert mesh.body_count == 1
    normals = mesh.face_normals
    slanted = np.abs(normals @ (np.array([-1, 0, 3]) / np.sqrt(10))) > 0.98
    assert mesh.area_faces[slanted].sum() > 0.7 * mesh.area
    assert ndimage.label(solid)[1] == 1


def test_a_part_without_voxels_is_named(cabinet: Asset):
    voxels = cabinet.voxels
    kept = voxels.part_ids != 4
    fewer = VoxelGrid(resolution=64, coords=voxels.coords[kept], part_ids=voxels.part_ids[kept])
    with pytest.raises(DegeneratePart, match="'door' owns 0"):
        mesh_parts(replace(cabinet, voxels=fewer))
    with pytest.raises(ValueError, match="has no voxels"):
        mesh_parts(replace(cabinet, voxels=None))


def test_the_box_completes_ragged_layers_and_only_those():
    rng = np.random.default_rng(2)
    door, frame = np.zeros((2, 16, 16, 16), dtype=bool)
    door[5, 2:14, 2:14] = True
    contested = np.zeros_like(door)
    contested[6, 2:14, 2:14] = True
    contested[6, 4:12, 4:12] = False
    lost = contested & (rng.random(door.shape) < 0.6)
    frame[7, 2:14, 2:14] = True
    box = np.array([[5.2, 2, 2], [6.4, 14, 14]])
    grid = voxel_grid(door | (contested & ~lost), frame | lost)
    np.testing.assert_array_equal(part_occupancy(grid, 0, box).occupancy, door | contested)
    box[1, 0] = 5.9
    assert part_occupancy(grid, 0, box).occupancy[6].sum() < contested.sum()


@pytest.mark.parametrize("run", [3, 5, 9, 14])
def test_gentle_slopes_become_planes(run: int):
    x = grid(40)
    rise = np.abs(x[2] - x[0] / run) - 3
    solid = (rise < 0.5 + 0.5 / run) & (np.abs(x[1]) < 12) & (np.abs(x[0]) < 18)
    mesh = as_trimesh(*mesh_occupancy(solid, tight_box(solid)))
    normal = np.array([-1.0, 0.0, run]) / np.hypot(1, run)
    leaning = np.abs(mesh.face_normals @ normal)
    level = np.abs(mesh.face_normals[:, 2]) > 0.8
    assert mesh.area_faces[leaning > 0.9995].sum() > 0.9 * mesh.area_faces[level].sum()
    middle = mesh.triangles_center[leaning > 0.9995] - 20
    assert np.abs(np.abs(middle @ normal) - 3 * normal[2]).max() < 0.3


def test_a_panel_with_a_step_on_either_side_is_no_slant():
    door = np.zeros((8, 40, 40), dtype=bool)
    door[1:3] = True
    door[3, 8:] = True
    door[4, 34:] = True
    planes = fit_face_planes(door, tight_box(door))
    assert len(find_slants(planes).planes) == 0
    assert find_slants(planes).flat[1][3, 8:34].all()
    assert find_slants(planes).flat[0][1].all()


def test_a_board_with_steps_in_its_lower_face_is_no_slant():
    """Half of a top was drawn a cell thicker: a plane through both halves would leave the board above."""
    top = np.zeros((40, 60, 4), dtype=bool)
    top[:, :, 2:] = True
    top[:, 2:28, 1] = True
    top[:, 56:58, 1] = True
    planes = fit_face_planes(top, tight_box(top))
    assert len(find_slants(planes).planes) == 0
    vertices, faces = mesh_occupancy(top, tight_box(top))
    solid = trimesh.Trimesh(vertices, faces)
    low, high = solid.bounds
    grid = np.stack(np.meshgrid(np.linspace(2, 38, 19), np.linspace(2, 58, 29)), axis=-1).reshape(-1, 2)
    under = np.column_stack([grid, np.full(len(grid), low[2] - 1)])
    hits, rays, _ = solid.ray.intersects_location(under, np.tile([0, 0, 1.0], (len(grid), 1)))
    lowest = np.full(len(grid), np.inf)
    np.minimum.at(lowest, rays, hits[:, 2])
    assert (lowest < high[2] - 0.7).all()


def test_a_part_of_nothing_but_specks_stays():
    """Two cells, one behind the other, sunk into a body: each alone in its layer, and all of a knob."""
    cells = np.argwhere(np.ones((5, 5, 4), dtype=bool)) + 2
    sunk = (cells[:, :2] == 4).all(axis=1) & np.isin(cells[:, 2], (3, 4))
    grid = VoxelGrid(resolution=16, coords=cells, part_ids=sunk.astype(int))
    assert part_occupancy(grid, 1).occupancy.sum() == 2


@pytest.mark.parametrize(("step", "merged"), [(0.029, True), (0.031, False)])
def test_faces_become_one_within_three_hundredths_of_a_cell(step: float, *, merged: bool):
    """A face of a block that others touch, a tenth of a cell below its cells, and so much higher a panel."""
    solid, others = np.zeros((2, 24, 24, 12), dtype=bool)
    solid[2:22, 2:22, 2:8] = True
    solid[6:18, 6:18, 8] = True
    others[2:22, 2:6, 8] = True
    box = np.array([[2.0, 2.0, 2.0], [22.0, 22.0, 7.9 + step]])
    _, faces = mesh_occupancy(solid, box, others)
    assert (len(faces) == 12) == merged


@pytest.mark.parametrize(("doubled", "turned"), [(0.019, True), (0.021, False)])
def test_a_diagonal_cuts_off_no_triangle_of_less_than_a_hundredth_of_a_square_cell(
    doubled: float, *, turned: bool
):
    """A kite, of which the shorter diagonal cuts off a triangle with half of this area (square cells).

    What becomes of two triangles is hidden in the mesh by what is merged after them.
    """
    kite = np.array([[0.0, 0.0, 0.0], [0.5, -doubled, 0.0], [1.0, 0.0, 0.0], [0.5, 1.5, 0.0]])
    faces = meshing._split_quads(kite, np.array([[0, 1, 2, 3]]))
    assert all({1, 3} <= set(face) for face in faces.tolist()) == turned
