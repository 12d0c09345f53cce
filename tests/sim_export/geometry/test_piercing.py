"""Edges of a surface, and how far they reach through another."""

import numpy as np
import pytest

from sim_export.geometry.piercing import PiercedSurface, find_edges

SHEET = np.array([[(-1, -1, 0), (1, -1, 0), (0, 2, 0)]], dtype=float)


def test_an_edge_between_two_triangles_counts_once():
    square = np.array([[(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 0, 0), (1, 1, 0), (0, 1, 0)]], dtype=float)
    lengths = np.linalg.norm(np.diff(find_edges(square), axis=1)[:, 0], axis=1)
    assert lengths == pytest.approx([2**0.5, 1, 1, 1, 1])


def test_of_many_edges_the_twenty_thousand_longest_are_followed():
    sizes = np.linspace(0.5, 1.0, 7000)[:, None, None]
    apart = 3.0 * np.arange(7000)[:, None, None] * np.array([1.0, 0.0, 0.0])
    edges = find_edges(sizes * np.array([[0, 0, 0], [3, 0, 0], [0, 4, 0]]) + apart)
    lengths = np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)
    every = np.sort(np.outer(sizes, [3, 4, 5]).ravel())[::-1]
    assert lengths == pytest.approx(every[:20_000], abs=0.02)


@pytest.mark.parametrize(("low", "high", "depth"), [(-0.3, 0.1, 0.1), (-0.1, 0.3, 0.1), (0.1, 0.3, 0.0)])
def test_depth_is_what_reaches_through_on_the_shorter_side(low: float, high: float, depth: float):
    rod = np.array([[(0.0, 0.0, low), (0.0, 0.0, high)]])
    assert PiercedSurface(SHEET).depth(rod) == pytest.approx((depth, depth), abs=1e-6)
