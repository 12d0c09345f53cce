"""Laws of primitives in place of pieces that nearly are such: around them, near them, blind to poses."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from artigen.shapes.appliances.rings import build_ring
from artigen.shapes.primitives import Primitive, box, cylinder, place_vertices, prism, rounded_box
from sim_export.collision.simplification import measure_simplified, simplify_hulls, simplify_links
from sim_export.geometry.hulls import convex_hull, hull_planes, hull_volume, hull_width
from sim_export.geometry.primitives import find_primitive
from sim_export.geometry.solids import as_solid
from sim_export.package import Hull

SEEDS = st.integers(0, 10_000)
TOLERANCE = 0.0035
"""Metres that a primitive may reach out of a piece."""
SHARE = 0.25
"""The same as a share of the thickness of a piece, which holds where it is less."""
CORNER = 2.0 / np.sqrt(3.0)
"""How far the corner of a box stands out of its bevels, over their width."""


def hull_of(primitive: Primitive) -> Hull:
    return Hull(vertices=place_vertices(primitive), faces=primitive.faces)


def bevelled(bevel: float, sizes: tuple[float, float, float] = (0.3, 0.4, 0.02)) -> Hull:
    return hull_of(rounded_box((0.0, 0.0, 0.0), sizes, bevel, ""))


def ring(inner: float, outer: float, sides: int = 16) -> list[Hull]:
    radii = (inner, outer)
    return [
        hull_of(wedge) for wedge in build_ring((0, 0, 0), "z", (0.0, 0.1), (radii, radii), "", sides=sides)
    ]


def kinds(hulls: tuple[Hull, ...]) -> list[str]:
    found = [find_primitive(hull) for hull in hulls]
    return ["mesh" if shape is None else shape.kind for shape in found]


def union(hulls) -> object:
    first, *others = [as_solid(hull) for hull in hulls]
    for other in others:
        first = first + other
    return first


def test_primitives_stay_the_same_objects():
    solids = [box((0, 0, 0), (1, 2, 3), ""), cylinder((0, 0, 0), (0, 0, 1), 0.2, "")]
    hulls = [hull_of(solid) for solid in solids]
    assert all(new is old for new, old in zip(simplify_hulls(hulls), hulls, strict=True))


@pytest.mark.parametrize("bevel", [0.0, 1e-4, 0.001, 0.003, 0.008])
def test_the_measured_difference_is_that_of_the_bevel_and_none_for_what_stays(bevel: float):
    hulls = [bevelled(bevel) if bevel else hull_of(box((0, 0, 0), (0.3, 0.4, 0.02), ""))]
    simple = simplify_hulls(hulls)
    (apart,) = measure_simplified(hulls, simple)
    assert apart == pytest.approx(0.0 if simple[0] is hulls[0] else CORNER * bevel, abs=1e-9)


@pytest.mark.parametrize(("share", "kind"), [(0.99, "box"), (1.01, "mesh")])
def test_a_bevel_is_left_out_up_to_the_tolerance(share: float, kind: str):
    assert kinds(simplify_hulls([bevelled(share * TOLERANCE / CORNER)])) == [kind]


@pytest.mark.parametrize(("share", "kind"), [(0.99, "box"), (1.01, "mesh")])
def test_thin_pieces_have_a_tolerance_in_proportion(share: float, kind: str):
    thickness = 0.5 * TOLERANCE / SHARE
    hull = bevelled(share * SHARE * thickness / CORNER, (0.3, 0.4, thickness))
    assert kinds(simplify_hulls([hull])) == [kind]


@pytest.mark.parametrize(("share", "kind"), [(0.99, "cylinder"), (1.01, "mesh")])
def test_a_prism_of_many_sides_becomes_a_cylinder_up_to_the_tolerance(share: float, kind: str):
    sides = 12
    radius = share * TOLERANCE / (1.0 - np.cos(np.pi / sides))
    turns = 2 * np.pi * np.arange(sides) / sides
    profile = radius * np.column_stack([np.cos(turns), np.sin(turns)])
    piece = hull_of(prism(profile, (0, 0, 0), (0, 0.3, 0), ""))
    assert kinds(simplify_hulls([piece])) == [kind]


def test_a_box_takes_the_extents_of_a_bevelled_one():
    hull = bevelled(0.002)
    (simple,) = simplify_hulls([hull])
    for measure in (np.min, np.max):
        assert np.allclose(measure(simple.vertices, axis=0), measure(hull.vertices, axis=0))


def test_wedges_of_a_ring_become_boxes_and_the_ring_stays_what_it_is():
    """The box around a wedge reaches only into its neighbours, however thick the ring is."""
    wedges = ring(0.2, 0.3)
    boxes = simplify_hulls(wedges)
    assert kinds(boxes) == ["box"] * 16
    before, after = union(wedges), union(boxes)
    assert (after - before).volume() < 1e-9 * before.volume()
    assert (before - after).volume() < 1e-9 * before.volume()


def test_a_wedge_without_neighbours_stays_a_wedge():
    wedges = ring(0.2, 0.3)
    assert kinds(simplify_hulls(wedges[:1])) == ["mesh"]
    half = kinds(simplify_hulls(wedges[:8]))
    assert half == ["mesh", *["box"] * 6, "mesh"]


@pytest.mark.parametrize(("offset", "kind"), [(0.9e-6, "cylinder"), (1.1e-6, "mesh")])
def test_corners_within_a_micrometre_of_a_plane_lie_on_a_cap(offset: float, kind: str):
    """A prism of six sides, with two corners of either cap a little nearer to the middle: four are no cap."""
    turns = 2 * np.pi * np.arange(6) / 6
    profile = 0.01 * np.column_stack([np.cos(turns), np.sin(turns)])
    inwards = offset * np.array([1.0, 0.0, 0.0, 1.0, 0.0, 0.0])
    caps = [np.column_stack([profile, z]) for z in (inwards, 0.02 - inwards)]
    assert kinds(simplify_hulls([convex_hull(np.concatenate(caps))])) == [kind]


@pytest.mark.parametrize(
    ("turns", "radius", "kind"), [((20, 90, 170), 0.011, "cylinder"), ((20, 50, 60, 120), 0.01, "mesh")]
)
def test_the_four_smallest_primitives_are_tried(turns: tuple[int, ...], radius: float, kind: str):
    """Around prisms on an ellipse, the cylinder is the fourth, after three boxes that are too large, and the
    fifth after four."""
    at = np.radians([*turns, *(turn + 180 for turn in turns)])
    profile = radius * np.column_stack([1.1 * np.cos(at), np.sin(at)])
    piece = convex_hull(np.array([[x, y, z] for x, y in profile for z in (0.0, 0.05)]))
    assert kinds(simplify_hulls([piece])) == [kind]


@pytest.mark.parametrize(("share", "kind"), [(0.9, "box"), (1.1, "mesh")])
def test_a_thousandth_of_a_cubic_millimetre_of_a_box_may_be_in_no_piece(share: float, kind: str):
    """A block without one of its edges, in whose place are two bars; between them is a slit.

    Pieces count as larger by the tolerance on all sides: of the edge a prism a millimetre high is left, and
    of the slit what is wider than twice the tolerance.
    """
    bevel = np.sqrt(2.0) * (TOLERANCE + 1e-3)
    profile = np.array([[bevel, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1], [0.0, bevel]])
    block = convex_hull(np.array([[x, y, z] for x, y in profile for z in (0.0, 0.1)]))
    slit = 2.0 * TOLERANCE + share * 1e-6
    bars = [
        hull_of(box((0.0, 0.0, low), (bevel, bevel, high), ""))
        for low, high in ((0.0, 0.04), (0.04 + slit, 0.1))
    ]
    assert kinds(simplify_hulls([block, *bars]))[0] == kind


def test_a_cone_is_no_cylinder():
    turns = 2 * np.pi * (np.arange(16) + 0.5) / 16
    profile = 0.05 * np.column_stack([np.cos(turns), np.sin(turns)])
    cone = hull_of(prism(profile, (0, 0, 0), (0, 0, 0.1), "", taper=0.7))
    assert kinds(simplify_hulls([cone])) == ["mesh"]


@settings(max_examples=60)
@given(SEEDS)
def test_what_is_taken_lies_around_the_piece_and_near_it(seed: int):
    """Boxes whose corners were moved by up to twice the tolerance, anywhere in space."""
    rng = np.random.default_rng(seed)
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * rng.uniform(
        0.03, 0.4, 3
    )
    corners = corners + rng.uniform(-1, 1, (8, 3)) * TOLERANCE * rng.uniform(0, 2)
    hull = convex_hull(Rotation.random(random_state=seed).apply(corners) + rng.uniform(-1, 1, 3))
    (simple,) = simplify_hulls([hull])
    if find_primitive(simple) is None:
        assert simple is hull
        return
    planes, around = hull_planes(hull), hull_planes(simple)
    slack = min(TOLERANCE, SHARE * hull_width(hull)[0])
    assert (simple.vertices @ planes[:, :3].T - planes[:, 3]).max() <= slack + 1e-9
    assert (hull.vertices @ around[:, :3].T - around[:, 3]).max() <= 1e-9
    assert hull_volume(simple) >= hull_volume(hull)


@settings(max_examples=20)
@given(SEEDS)
def test_poses_do_not_matter(seed: int):
    rng = np.random.default_rng(seed)
    turn, offset = Rotation.random(random_state=seed), rng.uniform(-1, 1, 3)
    pieces = [*ring(0.2, 0.25)[:4], bevelled(0.002), bevelled(0.005)]
    moved = [
        Hull(vertices=turn.apply(np.array(piece.vertices)) + offset, faces=piece.faces) for piece in pieces
    ]
    assert kinds(simplify_hulls(moved)) == kinds(simplify_hulls(pieces))


@pytest.mark.parametrize(("clearance", "kind"), [(1.1, "box"), (0.9, "mesh")])
def test_a_piece_stays_exact_where_its_box_would_overlap_another_link(clearance: float, kind: str):
    """The corner of a bevelled board is free; a rod of another link stands in it."""
    bevel = 0.9 * TOLERANCE / CORNER
    board = bevelled(bevel)
    radius = 0.2 * bevel
    at = -clearance * radius / np.sqrt(2.0)
    rod = hull_of(cylinder((at, at, -1.0), (at, at, 1.0), radius, ""))
    assert as_solid(board).__xor__(as_solid(rod)).volume() == 0.0
    assert kinds(simplify_links([[board], [rod]], [0, 1])[0]) == [kind]
    assert kinds(simplify_links([[board], [rod]], [0, 0])[0]) == ["box"]  # its own link may be in the way
