"""Pieces: rounds of unseen facets, seams only between boards, broken edges, never far from the primitives."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from artigen.shapes.appliances.rings import build_pierced_plate, build_ring
from artigen.shapes.draw import draw_shape
from artigen.shapes.fittings.tubes import bend_elbow
from artigen.shapes.furniture.table_frames import cut_ellipse
from artigen.shapes.primitives import Primitive, box, cylinder, move, place_vertices, polygon, prism
from artigen.shapes.surfaces.finishes import Finish, FinishKind
from sim_export.appearance.pieces import draw_pieces, find_pieces
from sim_export.geometry.broken_edges import STEPS, THIN, WIDTHS
from sim_export.geometry.rounds import SAGITTA, count_sides
from sim_export.geometry.solids import solid_arrays, solid_triangles, unite
from sim_export.package import Mesh
from sim_export.physics.inertia import mesh_inertial


def finish(kind: FinishKind) -> dict[str, Finish]:
    return {"body": Finish(kind=kind, color=(0.5, 0.5, 0.5), accent=(0.5, 0.5, 0.5))}


def show(primitives: list[Primitive], kind: FinishKind = "steel", *, boards: bool = False):
    return find_pieces(primitives, finish(kind), np.zeros(3), boards=boards)


def volume(pieces) -> float:
    vertices, faces = solid_arrays(unite([piece.solid for piece in pieces]))
    return mesh_inertial(Mesh(vertices=vertices, faces=faces), 1.0).mass


def lost_area(width: float) -> float:
    """Of the section of a right angle: the square of a radius without the kites of its tangents."""
    tangent = np.tan(np.pi / 4 / (STEPS + 1))
    return (width / (1 - tangent)) ** 2 * (1 - (STEPS + 1) * tangent)


@pytest.mark.parametrize("kind", ["wood", "steel", "plastic"])
def test_a_box_loses_what_is_outside_the_tangents_of_a_round_along_each_edge(kind):
    size, width = np.array([0.3, 0.2, 0.1]), WIDTHS[kind]
    (piece,) = show([box((0.0, 0.0, 0.0), tuple(size), "body")], kind)
    lost = 4 * size.sum() * lost_area(width)
    assert size.prod() - volume([piece]) == pytest.approx(lost, rel=0.03)
    corners = solid_triangles(piece.solid).reshape(-1, 3)
    np.testing.assert_allclose([corners.min(axis=0), corners.max(axis=0)], [np.zeros(3), size], atol=1e-9)


def test_the_edges_of_a_thin_plate_are_broken_by_a_share_of_it():
    size = np.array([0.3, 0.2, 0.004])
    (piece,) = show([box((0.0, 0.0, 0.0), tuple(size), "body")])
    lost = 4 * size.sum() * lost_area(THIN * 0.004)
    assert size.prod() - volume([piece]) == pytest.approx(lost, rel=0.03)


def test_flush_neighbours_show_a_seam_only_if_they_are_boards():
    pair = [box((x, 0.0, 0.0), (x + 0.1, 0.1, 0.1), "body") for x in (0.0, 0.1)]
    whole = show([box((0.0, 0.0, 0.0), (0.2, 0.1, 0.1), "body")])
    assert volume(show(pair)) == pytest.approx(volume(whole), rel=1e-6)
    assert volume(show(pair, "wood", boards=False)) > volume(show(pair, "wood", boards=True))


def test_a_rim_on_a_plate_stays_sharp_there():
    plate = box((-0.1, -0.1, -0.02), (0.1, 0.1, 0.0), "body")
    rod, free = (
        cylinder((0, 0, 0), (0, 0, 0.1), 0.01, "body"),
        cylinder((0, 0, 1.0), (0, 0, 1.1), 0.01, "body"),
    )
    standing = volume([show([plate, rod])[1]])
    assert standing > volume([show([plate, free])[1]])


@pytest.mark.parametrize("radius", [0.004, 0.02, 0.15])
def test_a_cylinder_is_as_round_as_one_can_see(radius):
    (piece,) = show([cylinder((0, 0, 0), (0, 0, 0.5), radius, "body")], "glass")
    sides = count_sides(radius)
    exact = np.pi * radius**2 * 0.5
    inscribed = sides / 2 * radius**2 * np.sin(2 * np.pi / sides) * 0.5
    assert volume([piece]) == pytest.approx(inscribed, rel=2e-2 if radius < 0.01 else 2e-3)
    assert volume([piece]) < exact
    assert radius * (1 - np.cos(np.pi / sides)) <= SAGITTA


def test_a_cone_of_many_corners_is_round_and_one_of_few_is_not():
    round_one, square = (
        show([prism(0.1 * polygon(sides), (0, 0, 0), (0, 0, 0.2), "body", taper=0.5)])[0].solid.num_tri()
        for sides in (10, 8)
    )
    assert round_one > 4 * count_sides(0.1) > square


def test_a_bend_is_a_piece_of_a_torus_within_its_stated_deviation():
    bend, radius = 0.05, 0.012
    elbow = bend_elbow((0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)), bend, radius, "body")
    made = show(list(elbow), "glass")
    points = np.concatenate([solid_triangles(one.solid).reshape(-1, 3) for one in made])
    ring = np.hypot(points[:, 0], points[:, 2])
    tube = np.hypot(ring - bend, points[:, 1])
    inner = np.abs(np.arctan2(points[:, 2], points[:, 0]) - np.pi / 4) < 0.6
    np.testing.assert_allclose(tube[inner], radius, atol=2e-6)
    whole = np.pi * radius**2 * bend * np.pi / 2
    assert volume(made) == pytest.approx(whole, rel=0.02)
    assert volume(draw_pieces(list(elbow), np.zeros(3))) < 0.97 * whole
    far = (bend + radius) * (1 - np.cos(np.pi / 12))
    assert all(far <= one.deviation < 2 * far for one in made)


def test_an_elliptic_board_has_the_outline_of_its_ellipse():
    half, thick = np.array([0.3, 0.6]), 0.03
    (made,) = show([replace(cut_ellipse(*half, (0.0, thick)), finish="body")], "wood")
    assert volume([made]) == pytest.approx(np.pi * half.prod() * thick, rel=0.003)
    corners = solid_triangles(made.solid).reshape(-1, 3)[:, :2]
    reach = np.linalg.norm(corners / half, axis=1)
    assert reach.max() == pytest.approx(1.0, abs=1e-5)
    assert len(np.unique(np.round(corners, 6), axis=0)) > 2 * count_sides(half.max()) - 5


def test_wedges_of_a_ring_become_one_smooth_ring():
    wedges = build_ring((0.3, 0.2, 0.1), "x", (0.0, 0.04), ((0.1, 0.15), (0.12, 0.15)), "body", sides=16)
    turned = [move(one, turn=0.3, about=(0.0, 1.0, 1.0)) for one in wedges]
    for given in (list(wedges), turned):
        (piece,) = show(given)
        assert piece.primitives == tuple(range(16))
        drawn = sum(one.solid.volume() for one in draw_pieces(given, np.zeros(3)))
        assert piece.solid.volume() == pytest.approx(drawn, rel=5e-3)
        assert piece.solid.num_tri() > 4 * count_sides(0.1)
    middles = np.array([one.center for one in turned])
    assert piece.owners(middles).tolist() == list(range(16))


def test_a_plate_around_a_polygon_becomes_one_with_a_round_hole():
    wedges = build_pierced_plate((0.0, 0.02), ((-0.3, 0.3), (0.1, 0.8)), (0.05, 0.4, 0.2), "body")
    (piece,) = show(list(wedges))
    assert piece.solid.volume() == pytest.approx(volume(draw_pieces(wedges, np.zeros(3))), rel=1e-3)
    assert piece.solid.genus() == 1


def test_an_incomplete_ring_keeps_its_wedges():
    wedges = build_ring((0.0, 0.0, 0.0), "z", (0.0, 0.1), ((0.1, 0.2), (0.1, 0.2)), "body", sides=16)
    assert len(show(list(wedges[:-1]))) == 15


def distances_to_solids(points: np.ndarray, solids: list[Primitive]) -> np.ndarray:
    """To the nearest surface: of a cylinder in closed form, of others by trimesh."""
    out = []
    for one in solids:
        if one.kind == "cylinder":
            own = (points - one.center) @ one.rotation
            beyond = np.stack([np.hypot(own[:, 0], own[:, 1]), np.abs(own[:, 2])], axis=1) - one.size[1:] / 2
            outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
            out.append(np.where(outside > 0, outside, -beyond.max(axis=1)))
        else:
            solid = trimesh.Trimesh(place_vertices(one), one.faces, process=False)
            out.append(trimesh.proximity.closest_point(solid, points)[1])
    return np.min(out, axis=0)


@pytest.mark.parametrize("drawn", [True, False])
@pytest.mark.parametrize("seen", [("WashingMachine", 1), ("Toaster", 1), ("Faucet", 2), ("Dresser", 3)])
def test_no_body_is_farther_from_its_solids_than_it_says(seen, drawn):
    shape = draw_shape(*seen)
    largest = 0.0
    for part in shape.parts:
        finishes = dict(shape.finishes)
        whole = find_pieces(part.primitives, finishes, np.zeros(3), boards=False)
        for piece in draw_pieces(part.primitives, np.zeros(3)) if drawn else whole:
            solids = [part.primitives[index] for index in piece.primitives]
            shown = trimesh.Trimesh(*solid_arrays(piece.solid), process=False)
            forth = distances_to_solids(np.vstack([shown.vertices, shown.triangles_center]), solids)
            corners = np.concatenate([place_vertices(one) for one in solids])
            back = trimesh.proximity.closest_point(shown, corners)[1]
            assert max(forth.max(), back.max()) <= piece.deviation + 3e-6, "files have micrometres"
            largest = max(largest, back.max())
    assert drawn or largest > 0.0005
