"""Hulls of solids: convex, within the limits of engines, true in volume, cavities open, apart from others."""

from dataclasses import replace

import manifold3d
import numpy as np
import pytest
from hull_link import block
from sample_cabinet import SAMPLE_PARTS, sample_box_arrays
from scipy.spatial import ConvexHull

from sim_export.collision.cover.cuboids import fill_with_boxes, largest_cuboids
from sim_export.collision.cover.free_space import find_free_space
from sim_export.collision.cover.object_cover import ObjectCover, find_passing
from sim_export.collision.cover.sectors import count_sectors
from sim_export.collision.cover.surface_hulls import SHALLOW, cover_surface
from sim_export.collision.hull_limits import MAX_ASPECT, MAX_POLYGONS, MAX_VERTICES, MIN_WIDTH, hull_aspect
from sim_export.geometry.hulls import (
    box_bounds,
    box_hull,
    count_polygons,
    hull_volume,
    hull_width,
    inside_hulls,
)
from sim_export.geometry.solids import as_solid, inside_grid, solid_arrays, solid_triangles, unite
from sim_export.package import Link

Solid = manifold3d.Manifold
OPEN = 0.95
"""Share of the free space in a body that its hulls leave open, at least."""


def sample_solid(name: str) -> Solid:
    boxes = sample_box_arrays(next(part for part in SAMPLE_PARTS if part.name == name))
    return unite(block(low, high) for low, high in boxes)


def leg(x: int, y: int) -> Solid:
    return Solid.cylinder(0.51, 0.02, 0.03, 20).rotate((6 * y, 6 * x, 0)).translate((0.3 * x, 0.4 * y, 0))


def ring(thickness: float) -> Solid:
    """A pot 0.3 m high and wide, as thick as this everywhere."""
    hole = Solid.cylinder(0.3, 0.15 - thickness, 0.15 - thickness, 64).translate((0, 0, thickness))
    return Solid.cylinder(0.3, 0.15, 0.15, 64) - hole


TRAY = block((-0.3, -0.2, 0), (0.3, 0.2, 0.1)) - block((-0.28, -0.18, 0.02), (0.28, 0.18, 0.2))
SOLIDS = {
    "body": sample_solid("body"),
    "drawer": sample_solid("drawer"),
    "handle": sample_solid("drawer_handle"),
    "pot": ring(0.012),
    "slanted tray": TRAY.rotate((20, 10, 30)),
    "table": unite(
        [block((-0.4, -0.5, 0.5), (0.4, 0.5, 0.53)), *(leg(x, y) for x in (-1, 1) for y in (-1, 1))]
    ),
}


def make_hulls(solid: Solid):
    """Hulls of a solid that is the whole object."""
    return ObjectCover({"part": solid_triangles(solid)}, {}, solid=True).make_hulls()["part"]


def measure_error(hulls, solid: Solid) -> float:
    """Volume of the symmetric difference over the solid's."""
    union = unite(map(as_solid, hulls))
    return ((union - solid).volume() + (solid - union).volume()) / solid.volume()


@pytest.fixture(scope="module")
def covered():
    return {name: make_hulls(solid) for name, solid in SOLIDS.items()}


@pytest.mark.parametrize(
    ("name", "most", "error"),
    [
        ("body", 8, 0.002),
        ("drawer", 6, 0.001),
        ("handle", 3, 0.001),
        ("pot", 64, 0.06),
        ("slanted tray", 6, 0.02),
        ("table", 44, 0.05),
    ],
)
def test_hulls_are_true_to_the_solid(covered, name, most, error):
    assert len(covered[name]) <= most
    assert measure_error(covered[name], SOLIDS[name]) <= error


@pytest.mark.parametrize("name", sorted(SOLIDS))
def test_hulls_are_within_the_limits_of_engines(covered, name):
    for hull in covered[name]:
        assert hull_volume(hull) / ConvexHull(hull.vertices).volume >= 0.999
        assert 4 <= len(hull.vertices) <= MAX_VERTICES
        assert count_polygons(hull) <= MAX_POLYGONS
        assert hull_width(hull)[0] >= 0.999 * MIN_WIDTH
        assert hull_aspect(hull) <= 1.001 * MAX_ASPECT


@pytest.mark.parametrize("name", ["body", "drawer", "pot", "slanted tray"])
def test_hulls_leave_cavities_open(covered, name):
    solid = SOLIDS[name]
    low, high = np.array(solid.bounding_box()).reshape(2, 3)
    axes = tuple(low[n] + (high - low)[n] * (np.arange(40) + 0.4871) / 40 for n in range(3))
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    whole, own = (inside_grid(*solid_arrays(s), axes) for s in (solid.hull(), solid))
    points = grid[whole & ~own]
    assert len(points) > 1000
    assert np.mean(~inside_hulls(points, covered[name])) >= OPEN


@pytest.mark.slow
def test_hulls_repeat_and_are_the_same_anywhere(covered):
    for one, two in zip(make_hulls(SOLIDS["pot"]), covered["pot"], strict=True):
        np.testing.assert_array_equal(one.vertices, two.vertices)
    moved = SOLIDS["body"].translate((0.7, -0.2, 1.1))
    assert measure_error(make_hulls(moved), moved) <= 0.002


def test_a_convex_solid_is_one_hull_if_the_corners_of_one_suffice():
    assert len(make_hulls(Solid.cylinder(0.2, 0.1, 0.1, 16))) == 1
    ball = Solid.sphere(0.1, 16)
    assert len(make_hulls(ball)) > 1
    assert measure_error(make_hulls(ball), ball) <= 0.002


def test_small_feet_are_not_lost():
    feet = [
        Solid.cylinder(0.1, 0.015, 0.015, 16).translate((x, y, -0.1)) for x in (0.1, 0.5) for y in (0.1, 0.3)
    ]
    top = block((0, 0, 0), (0.6, 0.4, 0.05)) - block((0.1, 0.1, 0.02), (0.5, 0.3, 0.06))
    hulls = make_hulls(unite([top, *feet]))
    for foot in feet:
        center = np.array(foot.bounding_box()).reshape(2, 3).mean(axis=0) - [0, 0, 0.04]
        assert inside_hulls(center[None], hulls).all()


def test_a_thick_solid_is_filled_not_only_its_surface_covered():
    thick = block((0, 0, 0), (0.6, 0.6, 0.6)) - block((0.2, 0.2, 0.3), (0.4, 0.4, 0.7))
    points = np.random.default_rng(0).uniform(0.02, 0.18, (300, 3))
    assert inside_hulls(points, make_hulls(thick)).all()


def test_hulls_of_solids_keep_out_of_other_links_whatever_their_size():
    """A peg in a hole of a board, which its hulls might fill, and the same with a larger peg."""
    for length in (0.05, 2.0):
        board = block((0, 0, 0), (0.4, 0.4, 0.02)) - block((0.15, 0.15, -1), (0.25, 0.25, 1))
        peg = block((0.16, 0.16, -0.01), (0.24, 0.24, length))
        surfaces = {"board": solid_triangles(board), "peg": solid_triangles(peg)}
        links = [
            Link(name=name, label=None, parts=(name,), visuals=(), hulls=(), inertial=None)
            for name in surfaces
        ]
        hulls = ObjectCover(surfaces, find_passing(links, [], surfaces, solid=True), solid=True).make_hulls()
        for hull in hulls["board"]:
            assert (as_solid(hull) ^ peg).volume() == 0.0


def test_what_is_enclosed_by_a_solid_is_its_own_even_if_another_link_passes_through():
    walls = solid_triangles(block((0, 0, 0), (0.5, 0.5, 0.5)))
    lodger = np.random.default_rng(0).uniform(0.05, 0.45, (4000, 3))
    middle = (32, 32, 32)
    assert find_free_space(walls, 0.87, lodger).depth[middle] > 0
    assert find_free_space(walls, 0.87, lodger, solid=True).depth[middle] == 0


def test_boxes_end_at_the_planes_of_the_solid_or_a_64th_before_what_has_none():
    plain = fill_with_boxes(solid_triangles(block((0.01, 0.02, 0.03), (1, 0.5, 0.4))))
    bounds = box_bounds(plain[0])
    assert bounds is not None
    np.testing.assert_allclose(bounds[0], [0.01, 0.02, 0.03])
    wedge = block((0, 0, 0), (1, 1, 0.5)) - block((-1, 0.8, -1), (2, 2, 2)).rotate((30, 0, 0)).translate(
        (0, 0.1, -0.2)
    )
    for hull in fill_with_boxes(solid_triangles(wedge)):
        assert (as_solid(hull) - wedge).volume() <= 0.6 / 64 * 0.5  # half a cell along the slope


def test_cuboids_cover_exactly_and_few():
    rng = np.random.default_rng(0)
    for _ in range(20):
        boxes = rng.integers(0, 12, size=(5, 2, 3))
        grid = np.zeros((12, 12, 12), dtype=bool)
        for a, b in boxes:
            low, high = np.minimum(a, b), np.maximum(a, b) + 1
            grid[low[0] : high[0], low[1] : high[1], low[2] : high[2]] = True
        covered = np.zeros_like(grid)
        edges = [np.arange(13)] * 3
        found = largest_cuboids(grid, edges, 99, 0.0)
        for low, high in found:
            covered[low[0] : high[0], low[1] : high[1], low[2] : high[2]] = True
        np.testing.assert_array_equal(covered, grid)
        assert len(found) <= 30
        np.testing.assert_array_equal(largest_cuboids(grid, edges, 3, 0.0), found[:3])


@pytest.mark.parametrize("thickness", [0.006, 0.012])
def test_thin_round_walls_get_more_sectors(thickness):
    """An arc is as deep as 0.8 % of the diagonal, or as 15 % of a thinner wall's thickness."""
    triangles, diagonal = solid_triangles(ring(thickness)), float(np.linalg.norm([0.3, 0.3, 0.3]))
    space = find_free_space(triangles, diagonal)
    sheets, solids = (
        cover_surface(triangles, replace(space, solid=solid), diagonal) for solid in (False, True)
    )
    assert len(solids.cut) >= len(sheets.cut)
    assert measure_error(solids.hulls, ring(thickness)) < measure_error(sheets.hulls, ring(thickness))
    assert count_sectors(0.15, SHALLOW * thickness) > count_sectors(0.15, 0.008 * diagonal)


def test_inside_grid_counts_the_volume():
    solid = SOLIDS["slanted tray"]
    vertices, faces = solid_arrays(solid)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    axes = tuple(low[a] + (high - low)[a] * (np.arange(80) + 0.4871) / 80 for a in range(3))
    inside = inside_grid(vertices, faces, axes)
    assert inside.sum() * np.prod((high - low) / 80) == pytest.approx(solid.volume(), rel=0.02)


def test_the_hull_of_a_box_is_the_box():
    (hull,) = make_hulls(block((0, 0, 0), (0.6, 0.4, 0.2)))
    assert hull_volume(hull) == pytest.approx(hull_volume(box_hull(np.zeros(3), np.array([0.6, 0.4, 0.2]))))
