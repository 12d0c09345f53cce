"""Laws of facets: none is left that an engine would take for its neighbour, and hulls only shrink."""

import numpy as np
import pytest

from sim_export.collision import hull_limits
from sim_export.collision.hull_limits import flatten_facets
from sim_export.geometry.hulls import box_hull, clip_hull, convex_hull, face_planes, hull_planes, hull_volume
from sim_export.package import Hull

LEAF = box_hull(np.array([0.0, 0.0, 0.0]), np.array([0.02, 0.5, 1.0]))


def fan(degrees: float, count: int = 4) -> Hull:
    """A door leaf whose edge was cut at several angles, as a swing past a neighbour cuts it."""
    hull = LEAF
    for step in range(1, count + 1):
        angle = np.radians(degrees * step)
        normal = np.array([np.sin(angle), np.cos(angle), 0.0])
        cut = clip_hull(hull, normal, float(np.array([0.01, 0.499, 0.0]) @ normal))
        assert cut is not None
        hull = cut
    return hull


def inside(points: np.ndarray, hull: Hull) -> bool:
    planes = hull_planes(hull)
    return bool((points @ planes[:, :3].T <= planes[:, 3] + 1e-7).all())


def test_a_fan_becomes_fewer_facets_inside_of_the_hull():
    before = fan(2.0)
    after = flatten_facets(before)
    assert len(face_planes(after)) < len(face_planes(before))
    assert inside(after.vertices, before)
    assert hull_volume(after) > 0.97 * hull_volume(before)
    assert flatten_facets(after) is after


def test_boxes_and_real_edges_stay():
    assert flatten_facets(LEAF) is LEAF
    corner = clip_hull(LEAF, np.array([0.0, 1.0, 1.0]) / np.sqrt(2.0), 1.0)
    assert corner is not None
    assert flatten_facets(corner) is corner


@pytest.mark.parametrize("sides", [12, 24])
def test_cylinders_stay_round(sides: int):
    angles = 2.0 * np.pi * np.arange(sides) / sides
    ring = 0.03 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    knob = convex_hull(np.concatenate([np.column_stack([ring, np.full(sides, z)]) for z in (0.0, 0.02)]))
    assert flatten_facets(knob) is knob


def test_a_hull_is_left_alone_where_that_would_cost_much_of_it(monkeypatch):
    monkeypatch.setattr(hull_limits, "MAX_FLATTENED", 0.0)
    before = fan(2.0)
    assert flatten_facets(before) is before


@pytest.mark.parametrize(("height", "merged"), [(0.00145, True), (0.00155, False)])
def test_facets_are_one_if_they_lie_within_0_15_percent_of_the_size_of_a_hull(height: float, merged: object):
    """A roof, the middle of either side of which lies ``height`` diagonals above the plane of the other."""
    ridge = 0.1 + height * float(np.linalg.norm([0.3, 0.3, 0.1]))
    outline = np.array([[0.0, 0.0], [0.3, 0.0], [0.3, 0.1], [0.15, ridge], [0.0, 0.1]])
    roof = convex_hull(np.concatenate([np.insert(outline, 1, y, axis=1) for y in (0.0, 0.3)]))
    assert (len(face_planes(flatten_facets(roof))) == 6) == merged
