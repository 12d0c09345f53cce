"""What is left of the hulls of a link after cuts stays within the limits of engines."""

import pytest
from hull_link import box

from sim_export.collision.cut_hulls import CutHulls
from sim_export.geometry.hulls import hull_width
from sim_export.package import Hull, Link


def cubes(count: int) -> list[Hull]:
    """A row of cubes, each a little larger than the one before."""
    return [box((k, 0, 0), (k + 0.5 + 1e-3 * k, 0.5, 0.5)) for k in range(count)]


def cut_hulls(*hulls: Hull) -> CutHulls:
    return CutHulls([Link(name="body", label=None, parts=("body",), visuals=(), hulls=hulls, inertial=None)])


@pytest.mark.parametrize(("pieces", "dropped"), [(95, 0), (96, 1)])
def test_a_link_keeps_its_96_largest_hulls(pieces, dropped):
    """One hull stays, and another is cut to pieces."""
    whole = box((0, 2, 0), (100, 3, 1))
    work = cut_hulls(whole, box((0, 0, 0), (100, 1, 1)))
    row = cubes(pieces)
    work.put(0, 1, row)
    work.trim(0)
    assert work.hulls[0] == [whole, *row[dropped:]]
    assert work.dropped[0] == dropped


@pytest.mark.parametrize(("thickness", "kept"), [(0.0014, False), (0.0016, True)])
def test_pieces_thinner_than_one_and_a_half_millimetres_go(thickness, kept):
    whole = box((0, 0, 0), (0.1, 0.1, 0.1))
    work = cut_hulls(whole, box((0.2, 0, 0), (0.3, 0.1, 0.1)))
    work.put(0, 1, [box((0.2, 0, 0), (0.3, 0.1, thickness))])
    work.trim(0)
    assert (work.count(0) == 2) == kept
    assert all(hull is None or hull_width(hull)[0] >= 0.0015 for hull in work.hulls[0])
