"""Hulls made from triangles: whatever these are like, the hulls cover them and fill nothing else."""

from dataclasses import replace

import numpy as np
import pytest
from triangle_box import box

from artigen.types import Joint
from sim_export.collision.cover import object_cover
from sim_export.collision.cover.exposed import find_uncovered
from sim_export.collision.cover.free_space import FreeSpace, find_free_space, find_inside, look_up
from sim_export.collision.cover.object_cover import ObjectCover, find_passing
from sim_export.collision.cover.piece_hulls import piece_hull
from sim_export.collision.cover.surface_hulls import (
    DIVIDED,
    FINER,
    USUAL,
    cover_surface,
    join_again,
    refine_cover,
    split_components,
)
from sim_export.collision.cover.surface_pieces import cut_triangles, make_piece
from sim_export.collision.hull_limits import MAX_ASPECT, compact_hull, hull_aspect
from sim_export.geometry.distances import surface_distances
from sim_export.geometry.grid import Grid
from sim_export.geometry.hulls import (
    box_hull,
    convex_hull,
    hull_triangles,
    hull_volume,
    hull_width,
    inside_hulls,
)
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import triangle_areas
from sim_export.package import Link

WALL = 0.018


def drawer():
    """Five boards that leave the top open: 0.4 m wide and deep, 0.2 m high."""
    a, h = 0.4, 0.2
    return np.concatenate(
        [
            box((0, 0, 0), (a, a, WALL)),
            box((0, 0, WALL), (WALL, a, h)),
            box((a - WALL, 0, WALL), (a, a, h)),
            box((WALL, 0, WALL), (a - WALL, WALL, h)),
            box((WALL, a - WALL, WALL), (a - WALL, a, h)),
        ]
    )


def cover(*surfaces):
    """Hulls of one or several links."""
    links = {f"link_{index}": surface for index, surface in enumerate(surfaces)}
    return list(ObjectCover(links, {}).make_hulls().values())


def spoil(triangles, how):
    """The same surface in triangles that enclose nothing."""
    if how == "doubled":
        return np.concatenate([triangles, triangles[:, ::-1]])
    if how == "torn":
        return np.concatenate(cut_triangles(triangles, np.array([0.6, 0.8, 0.0]), 0.1))
    return triangles[:, ::-1]


def test_a_closed_box_is_one_hull_of_its_own_volume():
    (hulls,) = cover(box((0, 0, 0), (0.6, 0.4, 0.2)))
    assert len(hulls) == 1
    assert hull_volume(hulls[0]) == pytest.approx(0.6 * 0.4 * 0.2, rel=1e-6)


@pytest.mark.parametrize("how", ["doubled", "torn", "inside out"])
def test_a_drawer_keeps_its_room_and_all_its_boards(how):
    surface = spoil(drawer(), how)
    (hulls,) = cover(surface)
    assert 5 <= len(hulls) <= 16
    room = np.random.default_rng(0).uniform((0.04, 0.04, 0.04), (0.36, 0.36, 0.19), (500, 3))
    assert not inside_hulls(room, hulls).any()
    seen = sample_triangles(surface, 2000)[0]
    felt = np.concatenate([hull.vertices[hull.faces] for hull in hulls])
    outside = seen[~inside_hulls(seen, hulls)]
    assert surface_distances(outside, felt, 20_000).max(initial=0.0) < 0.003


def test_hulls_keep_out_of_a_room_that_another_link_is_in():
    closed = box((0, 0, 0), (0.5, 0.5, 0.5))
    lodger = box((0.1, 0.1, 0.1), (0.4, 0.4, 0.4))
    others = {"body": sample_triangles(lodger, 6000)[0]}
    alone = ObjectCover({"body": closed}, {}).make_hulls()["body"]
    shared = ObjectCover({"body": closed}, others).make_hulls()["body"]
    middle = np.full((1, 3), 0.25)
    assert inside_hulls(middle, alone).all()
    assert not inside_hulls(middle, shared).any()


def test_a_sheet_becomes_a_hull_as_thick_as_engines_need():
    corners = np.array([[0, 0, 0], [0.3, 0, 0], [0.3, 0.2, 0], [0, 0.2, 0]], dtype=float)
    (hulls,) = cover(corners[[[0, 1, 2], [0, 2, 3]]])
    assert len(hulls) == 1
    assert 0.0015 <= hull_width(hulls[0])[0] <= 0.003


RADIUS = 0.2


def depth(theta):
    """Radius of a ball with a dent at its upper pole, by the angle from there."""
    return RADIUS * (1.0 - 0.5 * np.exp(-8.0 * theta**2))


def ball(rings=12):
    """Triangles of this ball, which no few hulls follow exactly."""
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rings), np.linspace(0, 2 * np.pi, 2 * rings))
    points = depth(theta)[..., None] * np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1
    )
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    return np.concatenate([np.stack(corners, axis=2).reshape(-1, 3, 3) for corners in ((a, b, c), (a, c, d))])


def missed(hulls):
    """Mean distance (m) of this ball's surface from hulls where it is outside of them."""
    points = sample_triangles(ball(), 4000)[0]
    outside = points[~inside_hulls(points, hulls)]
    return float(surface_distances(outside, hull_triangles(hulls), 20_000).sum()) / len(points)


def test_smaller_hulls_follow_the_links_that_ask_for_them_and_leave_others_as_they_are():
    dented, plain = ball(), box((1, 0, 0), (1.3, 0.3, 0.3))
    links = {"door": dented, "body": plain}
    known = ObjectCover(links, {})
    usual, finer = known.make_hulls(), known.make_hulls({"door": 1})
    assert finer["body"] == usual["body"]
    assert missed(finer["door"]) < 0.8 * missed(usual["door"])
    assert len(usual["door"]) < len(finer["door"]) <= FINER.most
    assert known.make_hulls()["door"] == usual["door"]


def test_hulls_get_coarser_until_there_are_few_enough(monkeypatch):
    dented = ball()
    many = len(ObjectCover({"door": dented}, {}).make_hulls()["door"])
    monkeypatch.setattr(object_cover, "LEVELS", (replace(USUAL, most=many - 1),))
    few = ObjectCover({"door": dented}, {}).make_hulls()["door"]
    assert 0 < len(few) < many


def test_triangles_without_area_are_no_pieces_of_a_coarser_cover():
    solid = box((0, 0, 0), (0.4, 0.3, 0.2))
    one = cover_surface(solid, find_free_space(solid, 0.6), 0.6)
    line = make_piece(np.array([[[0.1, 0.2, 0.1], [0.2, 0.2, 0.1], [0.3, 0.2, 0.1]]]), one.space, one.least)
    assert len(join_again(replace(one, pieces=(*one.pieces, line)), 0.02, 0.6).hulls) == len(one.hulls) == 1


def test_components_are_what_shares_corners():
    two = np.concatenate([box((0, 0, 0), (1, 1, 1)), box((2, 0, 0), (3, 1, 1))])
    assert sorted(len(group) for group in split_components(two)) == [12, 12]


def test_cutting_keeps_all_area_and_divides_it_by_the_plane():
    triangles = np.random.default_rng(1).normal(size=(300, 3, 3))
    normal = np.array([2.0, -1.0, 2.0]) / 3.0
    below, above = cut_triangles(triangles, normal, 0.2)
    whole = triangle_areas(triangles).sum()
    assert triangle_areas(below).sum() + triangle_areas(above).sum() == pytest.approx(whole, rel=1e-9)
    assert (below @ normal).max() <= 0.2 + 1e-9
    assert (above @ normal).min() >= 0.2 - 1e-9


def test_enclosed_space_is_none_of_the_free_space_until_others_pass_through_it():
    closed, middle = box((0, 0, 0), (1, 1, 1)), np.full((1, 3), 0.5)
    space = find_free_space(closed, 1.7)
    assert look_up(middle, space.depth, space.grid)[0] == 0.0
    assert find_inside(middle, space)[0] == pytest.approx(0.5, abs=3 * space.grid.cell)
    assert find_inside(np.array([[1.5, 0.5, 0.5]]), space)[0] == 0.0
    lodger = sample_triangles(box((0.1, 0.1, 0.1), (0.9, 0.9, 0.9)), 40_000)[0]
    shared = find_free_space(closed, 1.7, lodger)
    assert look_up(middle, shared.depth, shared.grid)[0] > 0.0


def test_long_thin_hulls_are_kept_within_the_limits():
    long_box = box_hull(np.zeros(3), np.array([2.0, 0.3, 0.002]))
    assert compact_hull(long_box, 0.0) == [long_box]
    turn = 2 * np.pi * np.arange(16) / 16
    disc = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(16)])
    plate = convex_hull(np.concatenate([disc, disc + np.array([0, 0, 0.01])]))
    divided = compact_hull(plate, 0.0)
    assert max(map(hull_aspect, divided)) <= MAX_ASPECT
    assert sum(map(hull_volume, divided)) > 0.99 * hull_volume(plate)
    (thick,) = compact_hull(plate, 0.1)
    assert hull_aspect(thick) <= MAX_ASPECT


@pytest.mark.parametrize(("larger", "boxed"), [(1.11, True), (1.13, False)])
def test_a_box_stands_for_an_oblong_hull_if_it_is_less_than_an_eighth_larger(larger, boxed):
    """A leaf that narrows towards one end, as thick as a hundredth of its length."""
    end = 2.0 / larger - 1.0
    outline = np.array([[0.0, -0.1], [0.0, 0.1], [1.0, 0.1 * end], [1.0, -0.1 * end]])
    leaf = convex_hull(np.concatenate([np.column_stack([outline, np.full(4, z)]) for z in (0.0, 0.01)]))
    found = compact_hull(leaf, 0.0)
    assert (len(found) == 1) == boxed
    if boxed:
        assert hull_volume(found[0]) == pytest.approx(0.2 * 0.01)


def test_passing_points_are_where_a_drawer_goes_as_its_body_sees_it():
    links = [
        Link(name="drawer", label="drawer", parts=("d",), visuals=(), hulls=(), inertial=None),
        Link(name="body", label="base", parts=("b",), visuals=(), hulls=(), inertial=None),
    ]
    joint = Joint(
        name="slide", type="prismatic", parent="body", child="drawer",
        origin=np.zeros(3), axis=np.array([-1.0, 0, 0]), lower=0.0, upper=0.5,
    )  # fmt: skip
    surfaces = {"drawer": box((0, 0, 0), (0.4, 0.4, 0.1)), "body": box((0, 0, 0.2), (0.4, 0.4, 0.5))}
    passing = find_passing(links, [joint], surfaces)
    assert passing["body"][:, 0].min() == pytest.approx(-0.5, abs=0.01)
    assert "drawer" not in passing  # the smaller one stays whole


@pytest.mark.parametrize(("height", "kept"), [(0.95e-5, False), (1.05e-5, True)])
def test_a_cut_keeps_what_is_higher_than_a_needle(height, kept):
    triangle = np.array([[[0.0, -0.01, 0.0], [0.0, 0.01, 0.0], [0.01 + height, 0.0, 0.0]]])
    below, above = cut_triangles(triangle, np.array([1.0, 0.0, 0.0]), 0.01)
    assert (len(above) == 1) is kept
    assert len(below) == 2


def test_a_hull_with_too_many_corners_keeps_its_ends():
    """Scaled to keep its volume, this strip of a curved wall would end 4 mm below the floor."""
    turns = np.linspace(-0.3, 0.3, 60)
    arc = np.stack([0.2 * np.cos(turns), 0.2 * np.sin(turns)], axis=1)
    wall = convex_hull(np.concatenate([np.column_stack([arc, np.full(60, z)]) for z in (0.0, 0.2)]))
    for part in compact_hull(wall, 0.004):
        assert (part.vertices.min(axis=0) >= wall.vertices.min(axis=0) - 1e-9).all()
        assert (part.vertices.max(axis=0) <= wall.vertices.max(axis=0) + 1e-9).all()


SHEET = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]], dtype=float)


def test_triangles_are_halved_eight_times_at_the_end_of_a_box():
    held = box_hull(np.array([-1.0, -1.0, -1.0]), np.array([0.513, 2.0, 1.0]))
    areas = triangle_areas(find_uncovered(SHEET, [held], 1e-4))
    assert areas.min() == pytest.approx(0.5 / 2**8)


@pytest.mark.parametrize(("size", "halved"), [(3.9, False), (4.1, True)])
def test_triangles_are_halved_that_are_four_times_as_long_as_the_slack(size, halved):
    """Of a triangle 1 m long, of which a quarter is in a box."""
    triangle = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.1, 0.0]]])
    held = box_hull(np.array([-1.0, -1.0, -1.0]), np.array([0.35 - 1.0 / size, 1.0, 1.0]))
    left = triangle_areas(find_uncovered(triangle, [held], 1.0 / size)).sum()
    assert left == pytest.approx(0.025 if halved else 0.05)


def strip_beside_a_sheet(share: float) -> FreeSpace:
    """Space above a sheet that is free before so much of it, and enclosed elsewhere."""
    grid = Grid(low=np.array([0.0, 0.0, -0.05]), cell=0.01, shape=(100, 100, 10))
    depth = np.zeros(grid.shape, dtype=np.float32)
    depth[: round(100 * share), :, 5:] = 0.5
    return FreeSpace(grid=grid, away=depth, depth=depth)


@pytest.mark.parametrize(("share", "highest"), [(0.26, 0.001), (0.34, 0.0)])
def test_a_sheet_grows_to_one_side_only_if_three_tenths_more_are_free_on_the_other(share, highest):
    """It is 2 mm thick."""
    space = strip_beside_a_sheet(share)
    hull = piece_hull(make_piece(SHEET, space, 0.6), space)
    assert hull is not None
    assert hull.vertices[:, 2].max() == pytest.approx(highest)
    assert np.ptp(hull.vertices[:, 2]) == pytest.approx(0.002)


def corner(*more):
    """Two boards, 0.1 m long, that stand on each other."""
    return np.concatenate([box((0, 0, 0), (0.1, 0.1, 0.02)), box((0, 0, 0.02), (0.02, 0.1, 0.1)), *more])


@pytest.mark.parametrize(("cells", "boxed"), [(24.5, False), (25.5, True)])
def test_a_link_gets_boxes_if_it_is_24_cells_long(cells, boxed):
    """Of its grid, which reaches half a cell beyond it; a cell is 0.0025 of the diagonal of the object."""
    size = 0.1 / 0.0025 / cells
    assert (len(cover_surface(corner(), find_free_space(corner(), size), size).boxes) > 0) == boxed


@pytest.mark.parametrize(
    ("fineness", "height", "pieces"),
    [(USUAL, 0.0045, 0), (USUAL, 0.0075, 1), (DIVIDED, 0.0045, 0), (FINER, 0.0015, 0), (FINER, 0.0045, 1)],
)
def test_surface_is_covered_by_a_box_that_is_0_006_of_the_diagonal_away_or_0_003(fineness, height, pieces):
    """Of an object of a diagonal of 1 m; a slanted scrap is so high over a board."""
    x, y, z, rise = 0.06, 0.05, 0.02 + height, 0.0009
    a, b, c, d = (
        np.array([x + i * 0.01, y + j * 0.01, z + (2 * i - 1) * rise])
        for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    )
    surface = corner(np.array([[a, b, c], [a, c, d]]))
    cover = cover_surface(surface, find_free_space(surface, 1.0), 1.0)
    assert len(refine_cover(cover, surface, 1.0, fineness).pieces) == pieces


@pytest.mark.parametrize(("cells", "whole"), [(12, True), (15, False)])
def test_a_hull_stays_whole_if_it_takes_four_thousandths_of_its_volume(cells, whole):
    """Free space is in so many of the 15^3 cells of a box, none of it deep."""
    depth = np.full((19, 19, 19), 0.05, dtype=np.float32)
    depth[2:17, 2:17, 2:17] = 0.0
    depth[5, 2 : 2 + cells, 9] = 0.05
    space = FreeSpace(
        grid=Grid(low=np.full(3, -2.0 / 15), cell=1.0 / 15, shape=depth.shape), away=depth, depth=depth
    )
    cover = cover_surface(box((0, 0, 0), (1, 1, 1)), space, 10.0)
    assert (cover.cut == ()) == whole


def tube(radius: float, thickness: float, sides: int = 96):
    """Triangles of a closed tube about the z axis, four times as high as its radius."""
    profile = [
        (radius, 0.0),
        (radius, 4 * radius),
        (radius - thickness, 4 * radius),
        (radius - thickness, 0.0),
    ]
    turns = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    ring = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    rows = np.stack([np.column_stack([r * ring, np.full(len(ring), z)]) for r, z in [*profile, profile[0]]])
    a, b, c, d = rows[:-1, :-1], rows[:-1, 1:], rows[1:, 1:], rows[1:, :-1]
    return np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)]).reshape(-1, 3, 3)


@pytest.mark.parametrize(("thickness", "sectors"), [(0.127, 18), (0.133, 16)])
def test_arcs_of_sectors_are_0_15_of_the_thickness_of_a_wall_deep(thickness, sectors):
    """Sixteen arcs of a circle are 0.0192 of its radius deep, which is 0.15 of 0.128 of it."""
    wall = tube(0.1, 0.1 * thickness)
    space = find_free_space(wall, 1.0, solid=True)
    assert len(cover_surface(wall, space, 1.0).hulls) == sectors


@pytest.mark.parametrize(("cell", "whole"), [(0.00254, True), (0.00365, False)])
def test_a_sector_of_a_curved_wall_may_take_as_much_free_space_as_its_hull_holds(cell, whole):
    """An eighth of a circle of 50 mm; four fifths of the cells are free.

    Its hull is 2.3 mm thick in the mean. Hulls that are thinner than a cell take half a cell before all free
    surface: here, 0.86 and 1.2 times what they hold.
    """
    wall, diagonal = tube(0.05, 0.0, sides=48)[: 2 * 48], 0.48
    shape = (round(0.12 / cell), round(0.12 / cell), round(0.22 / cell))
    i, j, k = np.indices(shape)
    depth = np.where((i + 2 * j + 3 * k) % 5 > 0, 0.00799 * diagonal, 0.0).astype(np.float32)
    space = FreeSpace(
        grid=Grid(low=np.array([-0.06, -0.06, -0.01]), cell=cell, shape=shape), away=depth, depth=depth
    )
    cover = cover_surface(wall, space, diagonal, replace(USUAL, most_pieces=10))
    assert (len(cover.cut) == 8) == whole
