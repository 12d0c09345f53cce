"""Voxels that Gaussians are drawn on: all of a surface lies in them, and sides face as most of it does."""

import numpy as np
import pytest
from box_surface import EDGE, sample_box
from drawer_chest import make_chest

from artigen.appearance.paint import lay_painted
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import SurfaceSamples, VoxelGrid
from artigen.voxels.frames import find_facings
from artigen.voxels.layout import cover_surface, lay_out, turn_facings
from artigen.voxels.surface import SAMPLES, find_voxels
from artigen.voxels.voxelize import voxelize


def join(*surfaces: SurfaceSamples) -> SurfaceSamples:
    names = vars(surfaces[0])
    return SurfaceSamples(
        **{name: np.concatenate([getattr(one, name) for one in surfaces]) for name in names}
    )


def owners(voxels: VoxelGrid) -> dict[tuple[int, ...], int]:
    return {
        tuple(cell): int(part) for cell, part in zip(voxels.coords.tolist(), voxels.part_ids, strict=True)
    }


@pytest.fixture
def pressed() -> SurfaceSamples:
    """A door of three cells whose back lies in the cells of a thick body behind it (voxels)."""
    door = sample_box(np.array([2.1, 3.1, 3.1]), np.array([5.2, 12.9, 12.9]), part=1)
    body = sample_box(np.array([5.25, 3.1, 3.1]), np.array([12.9, 12.9, 12.9]))
    rail = sample_box(np.array([5.3, 3.1, 3.1]), np.array([5.9, 12.9, 12.9]))  # more of the body there
    front = sample_box(np.array([0.1, 3.1, 3.1]), np.array([2.0, 12.9, 12.9]), part=1)  # and of the door
    return join(door, front, body, rail)


def test_surface_without_a_voxel_of_its_part_gets_one_beneath(pressed: SurfaceSamples):
    before = voxelize(pressed, EDGE)
    lost = ~find_voxels(pressed, before)[1]
    assert set(pressed.part_ids[lost]) == {1}
    assert lost.sum() > 60 * SAMPLES**2
    after = cover_surface(pressed, before)
    assert find_voxels(pressed, after)[1].all()
    had, has = owners(before), owners(after)
    assert had.items() <= has.items()
    assert {part for cell, part in has.items() if cell not in had} == {1}
    assert {cell[0] for cell in has if cell not in had} == {4}


def test_what_has_its_voxels_gets_no_others():
    alone = sample_box(np.array([2.0, 3.3, 3.0]), np.array([5.2, 13.0, 12.5]))
    voxels = voxelize(alone, EDGE)
    assert owners(cover_surface(alone, voxels)) == owners(voxels)


def test_cells_are_taken_neither_outside_of_the_grid_nor_for_slivers():
    low, high = np.array([0.0, 4.0, 4.0]), np.array([0.4, 4.3, 4.3])
    sliver = sample_box(low, high, part=1)
    cells = voxelize(sliver, EDGE)
    taken = VoxelGrid(resolution=EDGE, coords=cells.coords, part_ids=np.zeros(len(cells.coords), int))
    assert owners(cover_surface(sliver, taken)) == owners(taken)


def test_the_part_with_most_surface_over_a_cell_gets_it():
    x, y = (values.ravel() for values in np.meshgrid(*[np.arange(2.125, 3.0, 0.25)] * 2))
    points = np.stack([x, y, np.full(len(x), 4.3)], axis=1)
    part_ids = np.where(y < 2.5, 2, 1)
    part_ids[np.flatnonzero(y > 2.5)[0]] = 2  # nine of sixteen samples
    surface = SurfaceSamples(
        points=points / EDGE - 0.5,
        normals=np.tile([0.0, 0.0, 1.0], (len(x), 1)),
        colors=np.zeros((len(x), 3), dtype=np.uint8),
        part_ids=part_ids,
    )
    one = VoxelGrid(resolution=EDGE, coords=np.array([[2, 2, 4]]), part_ids=np.array([0]))
    assert owners(cover_surface(surface, one)) == {(2, 2, 4): 0, (2, 2, 3): 2}


@pytest.mark.parametrize("category", ["Refrigerator", "Oven"])
def test_true_objects_are_covered(category: str):
    shape = draw_shape(category, 1)
    asset = shape_to_asset(shape, 64)
    assert asset.voxels is not None
    laid, facings, _ = lay_painted(shape, asset)
    assert laid.voxels is not None
    assert laid.surface is not None
    bare = [1.0 - find_voxels(laid.surface, voxels)[1].mean() for voxels in (asset.voxels, laid.voxels)]
    assert bare[1] < 0.005 < bare[0]
    assert len(facings) == len(laid.voxels.coords) < 1.1 * len(asset.voxels.coords)


def test_sides_face_along_the_axis_that_most_surface_does():
    shape = make_chest()
    laid, facings, _ = lay_painted(shape, shape_to_asset(shape, 16))
    assert laid.voxels is not None
    assert laid.surface is not None
    rows, own = find_voxels(laid.surface, laid.voxels)
    areas = np.zeros((len(facings), 3))
    np.add.at(areas, rows, laid.surface.normals[own] ** 2)
    shown = areas[np.arange(len(facings)), facings // 2]
    assert (1.5 * shown >= areas.max(axis=1) - 1e-3).all()
    plain = find_facings(laid.voxels.coords, laid.voxels.part_ids, 16)
    turned = facings != plain
    assert (shown[turned] == areas.max(axis=1)[turned]).all()
    assert (shown[turned] > 1.5 * areas[np.arange(len(plain)), plain // 2][turned]).all()
    assert 0.0 < (facings != plain).mean() < 0.5


def test_the_end_of_a_thick_board_faces_its_way():
    board = sample_box(np.array([2.1, 2.1, 4.1]), np.array([13.9, 8.9, 6.9]))
    voxels, facings = lay_out(board, voxelize(board, EDGE))
    within = voxels.coords[:, 2] == 5  # between the two sheets
    ends = {
        cell: int(way) for cell, way in zip(map(tuple, voxels.coords[within]), facings[within], strict=True)
    }
    assert {ends[13, y, 5] for y in range(3, 8)} == {1}
    assert {ends[2, y, 5] for y in range(3, 8)} == {0}
    assert {ends[x, 2, 5] for x in range(3, 13)} == {2}
    sheets = ~within & (voxels.coords[:, 0] % 13 > 2) & (voxels.coords[:, 1] % 8 > 2)
    assert set(facings[sheets] // 2) == {2}


def test_voxels_without_surface_keep_their_facing():
    board = sample_box(np.array([2.0, 2.0, 4.4]), np.array([9.0, 9.0, 4.6]))
    voxels = VoxelGrid(resolution=EDGE, coords=np.array([[12, 12, 12], [3, 3, 4]]), part_ids=np.zeros(2, int))
    assert turn_facings(board, voxels, np.array([2, 2])).tolist() == [2, 4]  # below the middle
