"""Boxes that cover a surface hold no free space and end where the surface is."""

import numpy as np
import pytest
from triangle_box import box

from sim_export.collision.cover.exposed import find_exposed, find_uncovered
from sim_export.collision.cover.free_space import cover_with_boxes, find_free_space
from sim_export.collision.cover.surface_hulls import cover_surface
from sim_export.geometry.hulls import box_hull, inside_hulls
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import triangle_areas


def turned(triangles, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return triangles @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T


def oven():
    """A double shell that is open in front (-x), its two sheets 50 mm apart and joined at the rim."""
    outer, inner = box((0, 0, 0), (0.6, 0.5, 0.5)), box((0, 0.05, 0.05), (0.55, 0.45, 0.45))
    outer, inner = (t[(t[..., 0] > 0).any(axis=1)] for t in (outer, inner))
    rim = [
        box((0, 0, 0), (0.001, 0.5, 0.05)), box((0, 0, 0.45), (0.001, 0.5, 0.5)),
        box((0, 0, 0), (0.001, 0.05, 0.5)), box((0, 0.45, 0), (0.001, 0.5, 0.5)),
    ]  # fmt: skip
    return np.concatenate([outer, inner, *rim])


def test_the_walls_of_a_double_shell_are_few_boxes_from_sheet_to_sheet():
    surface = oven()
    space = find_free_space(surface, 0.93)
    boxes = cover_with_boxes(surface, space)
    assert 5 <= len(boxes) <= 10
    room = np.random.default_rng(0).uniform((-0.1, 0.06, 0.06), (0.54, 0.44, 0.44), (2000, 3))
    assert not inside_hulls(room, boxes).any()
    wall = np.random.default_rng(1).uniform((0.56, 0.01, 0.01), (0.59, 0.49, 0.49), (500, 3))
    assert inside_hulls(wall, boxes).all()
    left = find_uncovered(find_exposed(surface, space), boxes, 0.003)
    assert triangle_areas(left).sum() < 0.01 * triangle_areas(surface).sum()


def test_what_is_drawn_between_the_sheets_costs_no_hull():
    hidden = box((0.56, 0.2, 0.2), (0.59, 0.23, 0.23))
    surface = oven()
    counts = [
        len(cover_surface(triangles, find_free_space(triangles, 0.93), 0.93).hulls)
        for triangles in (surface, np.concatenate([surface, hidden]))
    ]
    assert counts[0] == counts[1]


def test_a_surface_that_is_not_aligned_gets_no_boxes():
    slanted = turned(box((0, 0, -0.01), (0.5, 0.02, 0.01)), 30.0)
    sides = slanted[
        np.abs(np.cross(slanted[:, 1] - slanted[:, 0], slanted[:, 2] - slanted[:, 0])[:, 2]) < 1e-9
    ]
    assert cover_with_boxes(sides, find_free_space(sides, 0.5)) == ()


@pytest.mark.parametrize(("cosine", "boxed"), [(0.991, True), (0.989, False)])
def test_a_sheet_gets_boxes_if_it_is_nearly_along_an_axis(cosine, boxed):
    sheet = np.array([[[0, 0, 0], [0.5, 0, 0], [0.5, 0, 0.5]], [[0, 0, 0], [0.5, 0, 0.5], [0, 0, 0.5]]])
    slanted = turned(sheet, np.degrees(np.arccos(cosine)))
    assert (len(cover_with_boxes(slanted, find_free_space(slanted, 0.7))) > 0) == boxed


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_the_part_of_a_sheet_that_boxes_hold_is_covered(share):
    sheet = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]], dtype=float)
    holds = [box_hull(np.array([-0.1, -0.1, -0.1]), np.array([share - 1e-6, 1.1, 0.1]))] if share else []
    left = find_uncovered(sheet, holds, 0.01)
    assert triangle_areas(left).sum() == pytest.approx(1.0 - share, abs=0.06)
    if len(left):
        assert sample_triangles(left, 200)[0][:, 0].min() > share - 0.06
