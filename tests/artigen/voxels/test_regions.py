"""Faces join what touches and is alike; rectangles hold what speaks for them, and discs are round."""

import numpy as np
import pytest

from artigen.voxels.regions import connected_groups, draw_ellipse, find_edges, find_rectangles, is_round

EDGE = 8


def test_edges_join_what_touches_and_is_alike():
    coords = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [3, 0, 0], [7, 7, 7], [7, 7, 6]])
    alike = np.zeros(6, dtype=int)
    assert find_edges(coords, alike, alike, EDGE).T.tolist() == [[0, 1], [1, 2], [5, 4]]
    assert find_edges(coords, np.array([0, 0, 1, 0, 0, 0]), alike, EDGE).T.tolist() == [[0, 1], [5, 4]]
    assert find_edges(coords, alike, np.array([0, 1, 1, 0, 0, 5]), EDGE).T.tolist() == [[1, 2]]
    faces = connected_groups(6, find_edges(coords, alike, alike, EDGE))
    assert (faces[:, None] == faces).sum() == 3 * 3 + 1 + 2 * 2


def test_a_blob_becomes_its_rectangle_and_islands_go():
    rng = np.random.default_rng(0)
    wanted = np.zeros((40, 30), dtype=bool)
    wanted[6:30, 5:25] = True
    blob = wanted.copy()
    for corner in ((6, 5), (6, 23), (28, 5), (28, 23)):
        blob[corner[0] : corner[0] + 2, corner[1] : corner[1] + 2] = False
    blob[34:36, 3] = True
    blob ^= rng.random(blob.shape) < 0.05
    evidence = np.where(blob, 0.8, -0.8)
    np.testing.assert_array_equal(find_rectangles(evidence, 24.0), wanted)
    np.testing.assert_array_equal(find_rectangles(evidence.T, 24.0), wanted.T)


@pytest.mark.parametrize(("size", "stays"), [(3, False), (5, True)])
def test_what_holds_too_little_evidence_is_no_rectangle(size: int, *, stays: bool):
    evidence = np.full((12, 12), -1.0)
    evidence[6, :size] = 1.0
    np.testing.assert_array_equal(find_rectangles(evidence, 4.0), (evidence > 0) & stays)


def test_discs_are_round_and_rectangles_and_small_faces_are_not():
    assert is_round(draw_ellipse(30, 30))
    assert is_round(draw_ellipse(20, 30))
    ring = draw_ellipse(30, 30)
    ring[10:20, 10:20] = False
    assert is_round(ring)
    assert not is_round(np.ones((30, 30), dtype=bool))
    assert not is_round(draw_ellipse(6, 6))


@pytest.mark.parametrize(("width", "found"), [(7, False), (8, True)])
def test_a_disc_is_seen_from_a_width_of_eight_cells(width: int, found: object):
    assert is_round(draw_ellipse(width, 12)) == is_round(draw_ellipse(12, width)) == found
