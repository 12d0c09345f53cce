"""Boundaries of thresholds that other tests only pass from afar."""

import manifold3d
import numpy as np
import pytest
from hull_link import as_mesh, block, link

from sim_export.collision.cover.cuboids import face_coordinates
from sim_export.collision.cover.free_space import find_free_space
from sim_export.collision.feet import add_feet
from sim_export.collision.hull_limits import comply_hull
from sim_export.collision.recovery import recover_surface
from sim_export.collision.simplification import simplify_hulls
from sim_export.collision.trimming import trim_meshes
from sim_export.geometry.hulls import box_hull, convex_hull, hull_width
from sim_export.geometry.primitives import find_primitive
from sim_export.package import Mesh

Solid = manifold3d.Manifold


@pytest.mark.parametrize(("width", "feet"), [(0.17, 4), (0.2, 1)])
def test_a_foot_is_whole_if_it_fills_three_fifths_of_its_hull(width, feet):
    """A frame fills 0.56 of its hull with sides as wide as 0.17 of it, and 0.64 with 0.2."""
    size, low, high = 0.6, -0.012, 0.01
    hole = block((width * size, width * size, low), ((1 - width) * size, (1 - width) * size, high))
    frame = block((0, 0, low), (size, size, high)) - hole
    body = link("body", box_hull(np.zeros(3), np.array([size, size, 0.5])))
    mesh = as_mesh(block((0, 0, 0), (size, size, 0.5)) + frame)
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
    _, records = trim_meshes(links, [], [], {"body": as_mesh(whole), "other": as_mesh(block(*other))})
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


def test_the_longest_edge_of_a_link_has_128_cells():
    box = box_hull(np.zeros(3), np.array([1.0, 0.5, 0.3]))
    assert find_free_space(box.vertices[box.faces], 1.2).grid.cell == pytest.approx((1.0 + 0.53 / 128) / 128)


BODY = (-0.3, -0.4, 0.0), (0.3, 0.4, 0.8)


def shelf(depth: float, thickness: float = 0.02) -> Mesh:
    """A body with a ledge on one side, for which no hull stands."""
    return as_mesh(block(*BODY) + block((-0.3, 0.4, 0.5), (0.3, 0.4 + depth, 0.5 + thickness)))


@pytest.mark.parametrize(("depth", "hulls"), [(0.022, 1), (0.032, 2)])
def test_surface_is_lost_two_hundredths_of_the_diagonal_from_all_hulls(depth, hulls):
    links = (link("body", box_hull(*map(np.array, BODY))),)
    new, _ = recover_surface(links, [], [], {"body": shelf(depth)})
    assert len(new[0].hulls) == hulls


def test_a_hull_that_is_put_back_reaches_a_hundredth_of_the_diagonal_beyond_what_was_lost():
    links = (link("body", box_hull(*map(np.array, BODY))),)
    mesh = shelf(0.1)
    diagonal = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    new, _ = recover_surface(links, [], [], {"body": mesh})
    start = new[0].hulls[1].vertices[:, 1].min() - 0.4
    assert start == pytest.approx((0.02 - 0.01) * diagonal, abs=0.003 * diagonal)


@pytest.mark.parametrize(("gap", "left_out"), [(0.0015, True), (0.0021, False)])
def test_a_ledge_is_shown_with_less_than_two_millimetres_around_it(gap, left_out):
    other = (-0.4, 0.41, 0.56 + gap), (0.4, 0.6, 0.7)
    links = (link("body", box_hull(*map(np.array, BODY))), link("other", box_hull(*map(np.array, other))))
    _, records = trim_meshes(links, [], [], {"body": shelf(0.1, 0.06), "other": as_mesh(block(*other))})
    assert bool(records) == left_out


@pytest.mark.parametrize(("sides", "kind"), [(4, "box"), (5, "cylinder")])
def test_a_prism_with_five_sides_may_be_a_cylinder(sides, kind):
    angles = 2.0 * np.pi * (np.arange(sides) + 0.5) / sides
    ring = 0.01 * np.column_stack([np.cos(angles), np.sin(angles)])
    prism = convex_hull(np.array([[x, y, z] for x, y in ring for z in (0.0, 0.02)]))
    (simple,) = simplify_hulls([prism])
    found = find_primitive(simple)
    assert found is not None
    assert found.kind == kind
