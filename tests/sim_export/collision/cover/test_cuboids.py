"""Boundaries of the boxes that fill solids: where they may end, and how much they must hold."""

import manifold3d
import numpy as np
import pytest
from hull_link import block

from sim_export.collision.cover.cuboids import face_coordinates, fill_with_boxes
from sim_export.geometry.solids import solid_triangles

Solid = manifold3d.Manifold


def levels(*squares: tuple[float, float], slope: float = 0.0) -> list[np.ndarray]:
    """Two triangles across each square of some height and edge (m), which rise along x by so much per metre;
    the mean of either is that height."""
    out = []
    for height, edge in squares:
        x, y = edge / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]).T
        corners = np.column_stack([x, y, height + slope * x])
        middle = np.array([0.0, 0.0, height])
        out += [np.stack([corners[k], corners[k + 1], middle]) for k in (0, 2)]
    return out


def heights_of_planes(*triangles: np.ndarray) -> np.ndarray:
    points = np.concatenate(triangles)
    found = face_coordinates(points, np.arange(len(points)).reshape(-1, 3), 0.003)
    assert found is not None
    return found[2]


FRAME = levels((0.0, 0.8), (0.6, 0.8))
"""A floor and a ceiling with a diagonal of 1.28 m."""
DIAGONAL = float(np.linalg.norm([0.8, 0.8, 0.6]))


@pytest.mark.parametrize(("share", "boxes"), [(0.0018, 1), (0.0022, 2)])
def test_a_box_must_fill_two_thousandths_of_a_solid(share, boxes):
    edge = np.sqrt(share / 0.3)
    bump = block((0.3, 0.3, 1.0), (0.3 + edge, 0.3 + edge, 1.3))
    assert len(fill_with_boxes(solid_triangles(block((0, 0, 0), (1, 1, 1)) + bump))) == boxes


@pytest.mark.parametrize(("rise", "exact"), [(0.0111, False), (0.0125, True)])
def test_boxes_end_at_planes_that_hold_three_thousandths_of_the_surface(rise, exact):
    """A step with a riser of 0.28 or 0.31 % of the surface, between two cells of a 64th."""
    stair = block((0, 0, 0), (1, 1, 0.5)) + block((0, 0, 0.4), (0.3, 1, 0.5 + rise))
    ends = np.array([hull.vertices[:, 0].max() for hull in fill_with_boxes(solid_triangles(stair))])
    assert (np.abs(ends - 0.3).min() < 1e-6) == exact


def test_boxes_end_at_64ths_of_the_longest_edge_along_a_slope():
    wedge = block((0, 0, 0), (1, 1, 1)).trim_by_plane((-1.0, 0.0, -1.0), -1.0)
    boxes = fill_with_boxes(solid_triangles(wedge))
    ends = np.array([hull.vertices[:, [0, 2]].max(axis=0) for hull in boxes])
    steps = 64.0 * ends
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-9)
    assert (np.rint(steps) % 2 == 1).any()


@pytest.mark.parametrize(("teeth", "boxes"), [(39, 40), (40, 40)])
def test_a_solid_is_filled_by_forty_boxes_at_most(teeth, boxes):
    """A brush of teeth in rows of eight on a board."""
    brush = block((0, 0, 0), (0.8, 0.8, 0.05))
    for tooth in range(teeth):
        x, y = 0.1 * (tooth // 8), 0.1 * (tooth % 8)
        brush += block((x + 0.02, y + 0.02, 0.0), (x + 0.08, y + 0.08, 0.3))
    assert len(fill_with_boxes(solid_triangles(brush))) == boxes


@pytest.mark.parametrize(("apart", "planes"), [(4.5e-4, 1), (5.5e-4, 2)])
def test_levels_closer_than_half_a_thousandth_of_the_diagonal_are_one_plane(apart, planes):
    shelves = levels((0.3, 0.5), (0.3 + apart * DIAGONAL, 0.4))
    assert len(heights_of_planes(*FRAME, *shelves)) == 2 + planes


@pytest.mark.parametrize(("apart", "planes"), [(0.0115, 1), (0.0125, 2)])
def test_sloping_shelves_closer_than_twelve_thousandths_of_the_diagonal_are_one_plane(apart, planes):
    shelves = levels((0.3, 0.5), (0.3 + apart * DIAGONAL, 0.4), slope=0.2)
    assert len(heights_of_planes(*FRAME, *shelves)) == 2 + planes


@pytest.mark.parametrize(("share", "planes"), [(0.0046, 0), (0.0054, 1)])
def test_a_sloping_shelf_is_a_plane_if_it_holds_five_thousandths_of_the_surface(share, planes):
    edge = np.sqrt(2.0 * 0.8**2 * share / (1.0 - share) / np.hypot(1.0, 0.2))
    assert len(heights_of_planes(*FRAME, *levels((0.3, edge), slope=0.2))) == 2 + planes


@pytest.mark.parametrize(("shelves", "planes"), [(61, 63), (62, 64), (63, 64)])
def test_an_axis_has_64_planes_at_most(shelves, planes):
    heights = np.linspace(0.0, 0.6, shelves + 2)[1:-1]
    assert len(heights_of_planes(*FRAME, *levels(*((height, 0.5) for height in heights)))) == planes
