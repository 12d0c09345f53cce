"""Convex primitives: solids, surfaces and planes say the same, wherever they are moved."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from artigen.shapes.primitives import (
    SEGMENTS,
    Primitive,
    box,
    contains,
    cylinder,
    line,
    move,
    place_vertices,
    polytope,
    prism,
    rounded_box,
)

TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]])
SOLIDS = {
    "box": box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0), "wood"),
    "rounded box": rounded_box((-1.0, 0.0, 0.0), (1.0, 2.0, 3.0), 0.1, "wood"),
    "rod": cylinder((0.0, 0.0, 0.0), (0.0, 1.0, 1.0), 0.3, "wood"),
    "wedge": prism(TRIANGLE, (0.0, 0.0, 1.0), (0.0, 3.0, 1.0), "wood"),
    "taper": prism(TRIANGLE, (0.0, 0.0, 0.0), (0.0, 0.0, 2.0), "wood", taper=0.5),
    "turned": move(
        box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0), "wood"), (1.0, 2.0, 3.0), turn=0.7, about=(1.0, 1.0, 0.0)
    ),
}
VOLUMES = {
    "box": 6.0,
    "rod": np.sqrt(2.0) * 0.3**2 * SEGMENTS / 2 * np.sin(2 * np.pi / SEGMENTS),
    "wedge": 3.0,
    "taper": 2.0 / 3.0 * (1.0 + 0.25 + 0.5),
    "turned": 6.0,
}


def enclosed(primitive: Primitive) -> float:
    corners = place_vertices(primitive)[primitive.faces]
    return float(np.einsum("fi,fi->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6)


@pytest.mark.parametrize("name", VOLUMES)
def test_surface_encloses_the_volume(name: str):
    assert enclosed(SOLIDS[name]) == pytest.approx(VOLUMES[name])


@pytest.mark.parametrize("name", SOLIDS)
def test_surface_is_closed_and_convex(name: str):
    solid = SOLIDS[name]
    edges = np.stack([solid.faces, np.roll(solid.faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    assert {tuple(edge) for edge in edges} == {tuple(edge[::-1]) for edge in edges}
    assert enclosed(solid) == pytest.approx(ConvexHull(place_vertices(solid)).volume)
    assert len(solid.vertices) <= 32


@pytest.mark.parametrize("name", SOLIDS)
def test_points_are_inside_as_the_surface_says(name: str):
    solid = SOLIDS[name]
    vertices = place_vertices(solid)
    rng = np.random.default_rng(0)
    weights = rng.dirichlet(np.ones(len(vertices)), 200)
    middle = vertices.mean(axis=0)
    assert contains(solid, weights @ vertices, -1e-9).all()
    assert contains(solid, middle[None]).all()
    assert not contains(solid, middle + 1.2 * (vertices - middle)).any()
    assert not contains(solid, vertices, 1e-6).any()


def test_a_cylinder_is_round_where_its_prism_is_not():
    rod = cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 1.0, "steel")
    turn = np.linspace(0.0, 2 * np.pi, 50)
    rim = np.column_stack([np.cos(turn), np.sin(turn), np.full(50, 0.5)])
    assert contains(rod, 0.999 * rim + (0.0, 0.0, 0.0005)).all()
    assert not contains(rod, 1.001 * rim).any()


def test_bevels_take_off_edges_and_nothing_of_the_extent():
    plain, round_one = box((0, 0, 0), (1, 2, 3), "wood"), rounded_box((0, 0, 0), (1, 2, 3), 0.1, "wood")
    for primitive in (plain, round_one):
        assert np.allclose(place_vertices(primitive).min(axis=0), 0.0)
        assert np.allclose(place_vertices(primitive).max(axis=0), (1, 2, 3))
    edges = 4 * (0.8 + 1.8 + 2.8) * 0.1**2 / 2
    assert 6.0 - enclosed(round_one) == pytest.approx(edges + 8 * 5 / 6 * 0.1**3, rel=0.02)


def test_moving_keeps_the_solid_and_turns_its_lining():
    lined = line(box((0, 0, 0), (1, 1, 1), "wood"), "white", (1.0, 0.0, 0.0))
    moved = move(lined, (0.0, 0.0, 2.0), turn=np.pi / 2)
    assert enclosed(moved) == pytest.approx(1.0)
    assert np.allclose(moved.lined_side, (0.0, 1.0, 0.0))
    assert np.allclose(place_vertices(moved).min(axis=0), (-1.0, 0.0, 2.0))
    assert lined.lined_side == (1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: box((0, 0, 0), (1, 0, 1), "wood"), "edges must be longer"),
        (lambda: rounded_box((0, 0, 0), (1, 0.2, 1), 0.1, "wood"), "two bevels"),
        (lambda: cylinder((0, 0, 0), (0, 0, 0), 0.1, "wood"), "must be positive"),
        (lambda: polytope(np.eye(3), "wood"), "span no volume"),
    ],
)
def test_what_is_no_solid_is_refused(make, says: str):
    with pytest.raises(ValueError, match=says):
        make()
