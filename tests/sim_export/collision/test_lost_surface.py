"""Laws of what lies inside of a mesh, whatever its faces are aligned with."""

import numpy as np
import trimesh

from sim_export.collision.lost_surface import inside_mesh


def test_inside_and_outside_of_a_tilted_ring():
    ring = trimesh.creation.annulus(0.3, 0.6, 0.5)
    turn = trimesh.transformations.rotation_matrix(0.4, [1, 2, 3])
    points = np.random.default_rng(0).uniform(-0.8, 0.8, (3000, 3))
    radius = np.linalg.norm(points[:, :2], axis=1)
    # The ring has 32 sides; points nearer to its walls than their bulge are left out.
    sure = (np.abs(radius - 0.3) > 0.01) & (np.abs(radius - 0.6) > 0.01)
    expected = (radius > 0.3) & (radius < 0.6) & (np.abs(points[:, 2]) < 0.25)
    moved = trimesh.transform_points(points, turn)
    found = inside_mesh(moved, ring.apply_transform(turn).triangles)
    assert expected[sure].sum() > 200
    np.testing.assert_array_equal(found[sure], expected[sure])


def test_points_below_the_edge_between_two_faces():
    box = trimesh.creation.box([1.0, 0.7, 0.5])
    along = np.linspace(-0.9, 0.9, 19)
    edge = np.stack([0.5 * along, 0.35 * along], axis=1)  # the top and bottom are halved along a diagonal
    for x, y in (edge.T, (edge * [1, -1]).T):
        for z, expected in ((-0.3, False), (0.1, True), (0.3, False)):
            points = np.column_stack([x, y, np.full(len(x), z)])
            assert (inside_mesh(points, box.triangles) == expected).all()
