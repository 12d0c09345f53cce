"""Laws of the islands check: single linkage with exact distances, whatever the pose; a cut leg floats."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import Primitive, box, place_vertices
from artigen.transforms import matrix_from_rpy
from sim_export.checks.suite import run_checks
from sim_export.files.write import write_package
from sim_export.geometry.contacts import HullSet
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.islands import hull_islands, visual_islands
from sim_export.reference import build_reference

REACH = 0.005
TURN = matrix_from_rpy(np.array([0.3, -0.8, 1.9]))


def row(*starts: float, edge: float = 0.02):
    """Cubes along x that begin at these places, turned."""
    hulls = [box_hull(np.array([x, 0.0, 0.0]), np.array([x + edge, edge, edge])) for x in starts]
    return [replace(hull, vertices=hull.vertices @ TURN.T + [0.4, -0.2, 1.0]) for hull in hulls]


def islands(hulls):
    seen = visual_islands(np.concatenate([hull.vertices[hull.faces] for hull in hulls]), REACH)
    felt = hull_islands(HullSet(hulls=tuple(hulls)), np.zeros((0, 3, 3)), REACH)
    assert [gap for gap, _ in seen] == pytest.approx([gap for gap, _ in felt], abs=1e-6)
    return [gap for gap, _ in felt]


@pytest.mark.parametrize(("gap", "found"), [(0.0, []), (0.00499, []), (0.00501, [0.00501]), (0.3, [0.3])])
def test_what_is_within_reach_holds_and_what_is_not_is_measured_exactly(gap, found):
    assert islands(row(0.0, 0.02 + gap)) == pytest.approx(found, abs=1e-6)


def test_pieces_hold_together_in_a_chain_and_islands_are_measured_to_the_nearest_piece():
    assert islands(row(0.0, 0.024, 0.048, 0.072)) == []
    # Two cubes that hold to each other float 28 mm beside three that do.
    assert islands(row(0.0, 0.024, 0.048, 0.096, 0.12)) == pytest.approx([0.028])
    # An island behind an island is measured from that one, not from the mainland.
    assert islands(row(0.0, 0.02, 0.05, 0.09)) == pytest.approx([0.01, 0.02])


def test_a_hull_at_what_is_seen_does_not_float_and_one_beside_it_does():
    """However far the next hull is."""
    board = row(0.0, edge=0.3)[0]
    seen = board.vertices[board.faces]
    ends = HullSet(hulls=tuple(row(0.0, 0.28)))
    assert [gap for gap, _ in hull_islands(ends, np.zeros((0, 3, 3)), REACH)] == pytest.approx([0.26])
    assert hull_islands(ends, seen, REACH) == []
    for gap, found in ((0.00499, []), (0.00501, [0.00501])):
        beside = HullSet(hulls=tuple(row(0.0, 0.3 + gap)))
        assert [island for island, _ in hull_islands(beside, seen, REACH)] == pytest.approx(found, abs=1e-6)


def test_corners_that_many_pieces_share_make_one_surface():
    cube = row(0.0)[0]
    loose = cube.vertices[cube.faces]
    assert visual_islands(loose, REACH) == []
    assert visual_islands(np.concatenate([loose, loose + 1e-9]), 0.0) == []


def shell(low: float, high: float, *, inward: bool = False, lid: bool = True):
    """The surface of a cube, which faces inward where it bounds a cavity, or lacks its top."""
    hull = box_hull(np.full(3, low), np.full(3, high))
    faces = hull.faces[:, ::-1] if inward else hull.faces
    triangles = hull.vertices[faces]
    return triangles if lid else triangles[triangles[:, :, 2].min(axis=1) < high - 1e-9]


def test_the_wall_of_a_sealed_cavity_and_what_is_hidden_in_a_wall_are_no_islands():
    outer, wall, inside = shell(0.0, 1.0), shell(0.1, 0.9, inward=True), shell(0.4, 0.6)
    for surface, gaps in (
        ((outer, wall), []),
        ((outer, np.concatenate([shell(0.1, 0.9, inward=True)] * 9)), []),  # it has most of the faces
        ((outer, inside), []),  # embedded
        ((outer, wall, inside), []),  # afloat in the cavity, where nobody sees it
        ((shell(0.0, 1.0, lid=False), inside), [0.4]),
    ):
        moved = np.concatenate(surface) @ TURN.T
        assert [gap for gap, _ in visual_islands(moved, REACH)] == pytest.approx(gaps, abs=1e-6)


def cut_legs(shape, gap: float):
    """The table with every leg cut through its middle."""

    def cut(primitive: Primitive) -> tuple[Primitive, ...]:
        corners = place_vertices(primitive)
        low, high = corners.min(axis=0), corners.max(axis=0)
        x, y, z = high - low
        if not z > 6 * max(x, y):
            return (primitive,)
        middle = (low[2] + high[2]) / 2
        return (
            box(tuple(low), (high[0], high[1], middle - gap / 2), primitive.finish),
            box((low[0], low[1], middle + gap / 2), tuple(high), primitive.finish),
        )

    parts = [
        replace(part, primitives=tuple(piece for primitive in part.primitives for piece in cut(primitive)))
        for part in shape.parts
    ]
    assert sum(len(part.primitives) for part in parts) > sum(len(part.primitives) for part in shape.parts)
    return replace(shape, parts=tuple(parts))


def test_a_table_with_legs_cut_in_two_fails_this_check_alone(tmp_path):
    table = draw_shape("Table", 10)
    for name, shape in (("whole", table), ("cut", cut_legs(table, 0.03))):
        package = build_reference(shape)
        results = run_checks(write_package(package, tmp_path / name), ("L1", "L2"))
        failed = [result.id for result in results if result.verdict == "fail"]
        assert failed == ([] if name == "whole" else ["V107"])


def test_what_the_rest_encloses_is_not_seen_and_no_island():
    def walls(low, high):
        hull = box_hull(np.array(low), np.array(high))
        return hull.vertices[hull.faces]

    closed, within = walls((0.0, 0.0, 0.0), (0.4, 0.4, 0.4)), walls((0.1, 0.1, 0.1), (0.3, 0.3, 0.3))
    for inner in (within, within[:, ::-1]):  # a block that floats inside, and the wall of a void
        assert visual_islands(np.concatenate([closed, inner]), REACH) == []
        assert visual_islands(np.concatenate([closed, inner + 0.5]), REACH) != []
        opened = closed[closed.mean(axis=1)[:, 2] < 0.39]
        assert [gap for gap, _ in visual_islands(np.concatenate([opened, inner]), REACH)] == pytest.approx(
            [0.1]
        )


def test_hulls_float_beside_what_is_seen_however_large_they_are():
    seen = row(0.0)[0]
    larger = HullSet(hulls=(row(0.05, edge=0.3)[0],))
    ((gap, count),) = hull_islands(larger, seen.vertices[seen.faces], REACH)
    assert gap == pytest.approx(0.03)
    assert count == 1
