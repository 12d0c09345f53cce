"""Boundaries of thresholds that other tests only pass from afar."""

import manifold3d
import numpy as np
import pytest

from sim_export.checks.grid import Grid
from sim_export.collision.cuboids import face_coordinates
from sim_export.collision.decompose import decompose_parts
from sim_export.collision.feet import add_feet
from sim_export.collision.free_space import FreeSpace
from sim_export.collision.hull_limits import comply_hull
from sim_export.collision.hull_pool import box_offers
from sim_export.collision.hulls import box_hull, hull_width
from sim_export.collision.surface_pieces import make_piece
from sim_export.collision.trimming import trim_meshes
from sim_export.package import Hull, Link, Mesh

Solid = manifold3d.Manifold


def block(low, high) -> Solid:
    return Solid.cube(tuple(np.subtract(high, low))).translate(tuple(low))


def mesh_of(solid: Solid) -> Mesh:
    mesh = solid.to_mesh64()
    return Mesh(
        vertices=np.array(mesh.vert_properties)[:, :3], faces=np.array(mesh.tri_verts, dtype=np.int64)
    )


def link(name: str, *hulls: Hull) -> Link:
    return Link(name=name, label=None, parts=(name,), visuals=(), hulls=hulls, inertial=None)


@pytest.mark.parametrize(("width", "feet"), [(0.17, 4), (0.2, 1)])
def test_a_foot_is_whole_if_it_fills_three_fifths_of_its_hull(width, feet):
    """A frame fills 0.56 of its hull with sides as wide as 0.17 of it, and 0.64 with 0.2."""
    size, low, high = 0.6, -0.012, 0.01
    hole = block((width * size, width * size, low), ((1 - width) * size, (1 - width) * size, high))
    frame = block((0, 0, low), (size, size, high)) - hole
    body = link("body", box_hull(np.zeros(3), np.array([size, size, 0.5])))
    mesh = mesh_of(block((0, 0, 0), (size, size, 0.5)) + frame)
    _, records = add_feet((body,), [], [], {"body": mesh})
    assert f"of {feet} feet" in records[0]


@pytest.mark.parametrize(("depth", "left_out"), [(0.28, True), (0.42, False)])
def test_no_more_than_a_fifth_of_a_mesh_is_left_out(depth, left_out):
    whole = block((-0.3, -0.4, 0.0), (0.3, 0.4, 0.8)) + block((-0.3, 0.4, 0.2), (0.3, 0.4 + depth, 0.7))
    other = (-0.4, 0.401, 0.1), (0.4, 1.0, 0.8)
    links = (
        link("body", box_hull(np.array([-0.3, -0.4, 0.0]), np.array([0.3, 0.4, 0.8]))),
        link("other", box_hull(*map(np.array, other))),
    )
    _, records = trim_meshes(links, [], [], {"body": mesh_of(whole), "other": mesh_of(block(*other))})
    assert bool(records) == left_out


@pytest.mark.parametrize(("share", "found"), [(0.49, False), (0.51, True)])
def test_planes_are_found_where_half_of_a_surface_is_aligned(share, found):
    level = np.array([[0.0, 0.0, 0.0], [share, 0.0, 0.0], [0.0, 1.0, 0.0]])
    slanted = np.array([[0.0, 0.0, 0.5], [(1.0 - share), 0.0, 0.5], [0.0, np.sqrt(0.5), 0.5 + np.sqrt(0.5)]])
    faces = np.arange(6).reshape(2, 3)
    assert (face_coordinates(np.concatenate([level, slanted]), faces, 0.01) is not None) == found


@pytest.mark.parametrize(("thickness", "after"), [(0.0012, 0.0015), (0.0016, 0.0016)])
def test_hulls_are_thickened_to_one_and_a_half_millimetres(thickness, after):
    hull = comply_hull(box_hull(np.zeros(3), np.array([0.03, 0.03, thickness])))
    assert hull_width(hull)[0] == pytest.approx(after)


@pytest.mark.parametrize(("height", "finer"), [(0.16, False), (0.24, True)])
def test_finer_boxes_are_offered_where_coarse_ones_miss_a_hundredth_of_the_volume(height, finer):
    """A bump of 0.8 or 1.2 % of a cube, too small for planes of its own at first."""
    edge = np.sqrt(0.05)
    bump = block((0.3, 0.3, 1.0), (0.3 + edge, 0.3 + edge, 1.0 + height))
    offers = box_offers(block((0, 0, 0), (1, 1, 1)) + bump)
    assert (max(offer.hull.vertices[:, 2].max() for offer in offers) > 1.01) == finer


def test_a_link_gets_sixty_hulls():
    cubes = [
        block((x, y, 0.0), (x + 0.06, y + 0.06, 0.1)) for x in np.arange(8) / 10 for y in np.arange(8) / 10
    ]
    (done,) = decompose_parts([mesh_of(Solid.batch_boolean(cubes, manifold3d.OpType.Add))], [0])
    assert len(done.hulls) == 60


@pytest.mark.parametrize(("strip", "taken"), [(2, False), (4, True)])
def test_a_sheet_takes_free_space_if_three_hundredths_of_it_lie_there(strip, taken):
    grid = Grid(low=np.array([0.0, 0.0, -0.05]), cell=0.01, shape=(100, 100, 10))
    depth = np.zeros(grid.shape, dtype=np.float32)
    depth[:strip] = 0.5
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    sheet = corners[np.array([[0, 1, 2], [0, 2, 3]])]
    piece = make_piece(sheet, FreeSpace(grid=grid, away=depth, depth=depth), 0.005)
    assert (piece.intrusion.volume > 0.0) == taken
