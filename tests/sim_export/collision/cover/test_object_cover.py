"""Hulls get coarser by steps while there are too many, and links are followed at enough points."""

from dataclasses import replace

import numpy as np
import pytest
from triangle_box import box

from sim_export.collision.cover import object_cover
from sim_export.collision.cover.object_cover import ObjectCover, find_passing
from sim_export.collision.cover.surface_hulls import USUAL
from sim_export.package import Link

CORNERS = np.array([[0.0, 0.0, 0.0], [0.3, 0.1, 0.0], [0.1, 0.3, 0.0], [0.2, 0.2, 0.3]])
TETRAHEDRON = CORNERS[[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]]


def test_hulls_reach_half_as_far_again_into_free_space_until_that_is_0_012_of_the_diagonal(monkeypatch):
    """From 0.004 of it; two tetrahedra that are apart are never one hull."""
    triangles = np.concatenate([TETRAHEDRON, TETRAHEDRON + 1.0])
    diagonal = float(np.linalg.norm(np.ptp(triangles.reshape(-1, 3), axis=0)))
    reaches = []

    def follow(cover, least, size, join=object_cover.join_again):
        reaches.append(least / diagonal)
        assert len(reaches) < 10
        return join(cover, least, size)

    monkeypatch.setattr(object_cover, "join_again", follow)
    monkeypatch.setattr(object_cover, "LEVELS", (replace(USUAL, most=1),))
    ObjectCover({"door": triangles}, {}).make_hulls()
    assert reaches == pytest.approx([0.006, 0.009, 0.0135])


def test_a_link_is_followed_at_6000_points():
    links = [
        Link(name=name, label=None, parts=(name,), visuals=(), hulls=(), inertial=None)
        for name in ("knob", "door")
    ]
    surfaces = {"knob": box((0, 0, 0), (0.1, 0.1, 0.1)), "door": box((0, 0, 0.2), (1, 1, 0.3))}
    passing = find_passing(links, [], surfaces)
    assert {name: len(points) for name, points in passing.items()} == {"door": 6000}


@pytest.mark.parametrize(("pieces", "coarser"), [(9, False), (10, True)])
def test_there_are_three_quarters_of_the_hulls_where_there_shall_be_fewer(pieces, coarser, monkeypatch):
    """Of twelve hulls of an object at most; tetrahedra that are apart are never one hull."""
    solids = [TETRAHEDRON + np.array([k, 0.0, 0.0]) for k in range(pieces)]
    monkeypatch.setattr(object_cover, "LEVELS", (replace(USUAL, most_of_object=12),))
    joined = []

    def follow(cover, least, size):
        joined.append(least)
        return replace(cover, least=1.0 * size)

    monkeypatch.setattr(object_cover, "join_again", follow)
    cover = ObjectCover({"body": np.concatenate(solids)}, {})
    cover.make_hulls()
    assert not joined
    cover.make_hulls(fewer=True)
    assert bool(joined) == coarser
