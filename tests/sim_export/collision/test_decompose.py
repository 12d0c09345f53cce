"""Hulls stand for their mesh: convex, within the limits of engines, true in volume, cavities open."""

from dataclasses import replace

import manifold3d
import numpy as np
import pytest
from sample_cabinet import SAMPLE_PARTS, sample_box_arrays
from scipy.spatial import ConvexHull

from sim_export.collision import decompose
from sim_export.collision.cuboids import largest_cuboids
from sim_export.collision.decompose import decompose_part, decompose_parts
from sim_export.collision.hull_choice import TAKEN, make_ground
from sim_export.collision.hull_limits import (
    MAX_ASPECT,
    MAX_POLYGONS,
    MAX_VERTICES,
    MIN_WIDTH,
    comply_hull,
    hull_aspect,
    tile_hull,
)
from sim_export.collision.hull_pool import cut_pieces
from sim_export.errors import DecompositionFailed, OpenMesh
from sim_export.geometry.hulls import (
    box_bounds,
    box_hull,
    clip_hull,
    convex_hull,
    count_polygons,
    face_planes,
    hull_planes,
    hull_volume,
    hull_width,
    subtract_hull,
)
from sim_export.geometry.solids import (
    as_solid,
    inside_grid,
    measure_fit,
    measure_intrusion,
    measure_stray,
    solid_arrays,
    solid_hull,
    unite_hulls,
)
from sim_export.package import Mesh

Solid = manifold3d.Manifold


def as_mesh(solid: Solid) -> Mesh:
    vertices, faces = solid_arrays(solid)
    return Mesh(vertices=vertices, faces=faces)


def block(low, high) -> Solid:
    return Solid.cube(tuple(np.subtract(high, low).tolist())).translate(
        tuple(np.asarray(low, float).tolist())
    )


def sample_mesh(name: str) -> Mesh:
    boxes = sample_box_arrays(next(part for part in SAMPLE_PARTS if part.name == name))
    return as_mesh(Solid.batch_boolean([block(low, high) for low, high in boxes], manifold3d.OpType.Add))


SHAPES = {
    "body": sample_mesh("body"),
    "drawer": sample_mesh("drawer"),
    "handle": sample_mesh("drawer_handle"),
    "pot": as_mesh(
        Solid.cylinder(0.3, 0.2, 0.2, 48) - Solid.cylinder(0.3, 0.185, 0.185, 48).translate((0, 0, 0.015))
    ),
    "slanted tray": as_mesh(
        (block((-0.3, -0.2, 0), (0.3, 0.2, 0.1)) - block((-0.28, -0.18, 0.02), (0.28, 0.18, 0.2))).rotate(
            (20, 10, 30)
        )
    ),
    "table": as_mesh(
        Solid.batch_boolean(
            [
                block((-0.4, -0.5, 0.5), (0.4, 0.5, 0.53)),
                *(
                    Solid.cylinder(0.51, 0.02, 0.03, 20)
                    .rotate((6 * y, 6 * x, 0))
                    .translate((0.3 * x, 0.4 * y, 0))
                    for x in (-1, 1)
                    for y in (-1, 1)
                ),
            ],
            manifold3d.OpType.Add,
        )
    ),
}


def assert_within_limits(hulls) -> None:
    for hull in hulls:
        independent = ConvexHull(hull.vertices)
        assert hull_volume(hull) / independent.volume >= 0.999
        assert 4 <= len(hull.vertices) <= MAX_VERTICES
        assert count_polygons(hull) <= MAX_POLYGONS
        assert hull_width(hull)[0] >= 0.999 * MIN_WIDTH
        assert hull_aspect(hull) <= 1.001 * MAX_ASPECT


@pytest.fixture(scope="module")
def decomposed():
    return {name: decompose_part(mesh) for name, mesh in SHAPES.items()}


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_hulls_are_true_to_the_mesh_and_leave_it_open(decomposed, name):
    result, solid = decomposed[name], as_solid(SHAPES[name])
    assert 1 <= len(result.hulls) <= 32
    assert_within_limits(result.hulls)
    assert result.volume_error <= (0.2 if name == "pot" else 0.08)
    assert result.kept_cavity >= 0.95
    # The reported error is the real one: points drawn in the bounding box disagree as often.
    low, high = np.array(solid.bounding_box()).reshape(2, 3)
    axes = tuple(low[a] + (high - low)[a] * (np.arange(50) + 0.37) / 50 for a in range(3))
    true = inside_grid(SHAPES[name].vertices, SHAPES[name].faces, axes)
    covered = np.zeros_like(true)
    for hull in result.hulls:
        covered |= inside_grid(hull.vertices, hull.faces, axes)
    cell = np.prod((high - low) / 50)
    assert (true != covered).sum() * cell / solid.volume() == pytest.approx(result.volume_error, abs=0.06)


def test_blocky_parts_become_exactly_their_boxes(decomposed):
    for name, most in (("body", 8), ("drawer", 6), ("handle", 3)):
        assert decomposed[name].method == "boxes"
        assert len(decomposed[name].hulls) <= most
        assert decomposed[name].volume_error < 0.02


def test_decomposition_repeats_and_works_anywhere(decomposed):
    again = decompose_part(SHAPES["pot"])
    assert len(again.hulls) == len(decomposed["pot"].hulls)
    for one, two in zip(again.hulls, decomposed["pot"].hulls, strict=True):
        np.testing.assert_array_equal(one.vertices, two.vertices)
    shift = np.array([0.7, -0.2, 1.1])
    moved = replace(SHAPES["body"], vertices=SHAPES["body"].vertices + shift)
    assert decompose_part(moved).volume_error <= 0.02


def test_a_convex_part_is_one_hull_and_small_feet_are_not_lost():
    assert decompose_part(as_mesh(Solid.sphere(0.1, 16))).method == "hull"
    feet = [
        Solid.cylinder(0.1, 0.015, 0.015, 16).translate((x, y, -0.1)) for x in (0.1, 0.5) for y in (0.1, 0.3)
    ]
    top = block((0, 0, 0), (0.6, 0.4, 0.05)) - block((0.1, 0.1, 0.02), (0.5, 0.3, 0.06))
    result = decompose_part(as_mesh(Solid.batch_boolean([top, *feet], manifold3d.OpType.Add)))
    assert min(hull.vertices[:, 2].min() for hull in result.hulls) == pytest.approx(-0.1, abs=0.002)


def test_parts_of_one_link_share_its_hulls():
    meshes = [SHAPES["slanted tray"], SHAPES["table"]]
    alone = [decompose_part(mesh, 8) for mesh in meshes]
    assert sum(len(part.hulls) for part in alone) > 8
    together = decompose_parts(meshes, [0, 0], 8)
    assert sum(len(part.hulls) for part in together) <= 8
    apart = decompose_parts(meshes, [0, 1], 8)
    assert [len(part.hulls) for part in apart] == [len(part.hulls) for part in alone]


def test_hulls_that_fill_a_cavity_are_refused(monkeypatch):
    def one_hull(part, max_hulls):
        yield "hull", (solid_hull(part.solid),)

    monkeypatch.setattr(decompose, "hull_candidates", one_hull)
    with pytest.raises(DecompositionFailed, match="of the cavity free"):
        decompose_part(SHAPES["body"])


def test_too_few_hulls_leave_out_walls_rather_than_fill_the_cavity():
    for most in (2, 4):
        result = decompose_part(SHAPES["body"], most)
        assert result.kept_cavity >= 0.9
        assert 1 <= len(result.hulls) <= most


def test_what_hulls_leave_out_is_not_far_from_them():
    # Thirty small hooks on the back and one long handle: the handle is what must not be lost.
    walls = as_solid(SHAPES["body"])
    low, high = np.array(walls.bounding_box()).reshape(2, 3)
    hooks = [
        block((high[0] - 0.01, y, z), (high[0] + 0.01, y + 0.01, z + 0.01))
        for y in np.linspace(low[1] + 0.02, high[1] - 0.03, 6)
        for z in np.linspace(low[2] + 0.02, high[2] - 0.03, 5)
    ]
    bar = block((high[0] - 0.01, 0, high[2] - 0.06), (high[0] + 0.15, 0.02, high[2] - 0.04))
    mesh = as_mesh(Solid.batch_boolean([walls, *hooks, bar], manifold3d.OpType.Add))
    result = decompose_part(mesh, 12)
    assert len(result.hulls) <= 12
    assert max(hull.vertices[:, 0].max() for hull in result.hulls) >= high[0] + 0.13
    far = measure_stray(result.hulls, as_solid(mesh)).max()
    assert far <= 0.022 * np.linalg.norm(high - low)


def test_a_round_shell_is_cut_to_pieces_that_hardly_exceed_it():
    drum = Solid.cylinder(0.4, 0.25, 0.25, 48) - Solid.cylinder(0.38, 0.24, 0.24, 48).translate((0, 0, 0.01))
    pieces = cut_pieces(drum)
    assert sum(piece.volume() for piece in pieces) == pytest.approx(drum.volume(), rel=1e-3)
    assert sum(piece.hull().volume() for piece in pieces) <= 1.4 * drum.volume()


def test_a_whole_board_is_never_missed():
    # One board in the open, as thick as what coarse boxes may miss.
    boards = [
        block((0, 0, 0), (0.4, 0.02, 1)),
        block((0, 0.98, 0), (0.4, 1, 1)),
        block((0, 0, 0), (0.4, 1, 0.02)),
    ]
    tilted = block((0, 0, 0), (0.4, 1.0, 0.02)).rotate((1.2, 0, 0)).translate((0, 0, 0.96))
    mesh = as_mesh(Solid.batch_boolean([*boards, tilted], manifold3d.OpType.Add))
    result = decompose_part(mesh)
    middle = np.array([[0.2, 0.5, 0.96 + 0.5 * np.tan(np.radians(1.2)) + 0.01]])
    inside = [(middle @ planes[:, :3].T <= planes[:, 3]).all() for planes in map(hull_planes, result.hulls)]
    assert any(inside)


def test_an_open_mesh_is_refused():
    cube = as_mesh(block((0, 0, 0), (1, 1, 1)))
    with pytest.raises(OpenMesh, match="11 faces"):
        decompose_part(replace(cube, faces=cube.faces[:-1]))


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
        found = largest_cuboids(grid, edges, 99)
        for low, high in found:
            covered[low[0] : high[0], low[1] : high[1], low[2] : high[2]] = True
        np.testing.assert_array_equal(covered, grid)
        assert len(found) <= 30
        np.testing.assert_array_equal(largest_cuboids(grid, edges, 3), found[:3])


def test_pieces_cover_the_solid():
    solid = as_solid(SHAPES["slanted tray"])
    pieces = [piece.hull() for piece in cut_pieces(solid)]
    union = Solid.batch_boolean(pieces, manifold3d.OpType.Add)
    assert (solid - union).volume() < 1e-3 * solid.volume()
    assert union.volume() <= 1.06 * solid.volume()


def test_inside_grid_counts_the_volume():
    mesh = SHAPES["slanted tray"]
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    axes = tuple(low[a] + (high - low)[a] * (np.arange(80) + 0.4871) / 80 for a in range(3))
    inside = inside_grid(mesh.vertices, mesh.faces, axes)
    volume = inside.sum() * np.prod((high - low) / 80)
    assert volume == pytest.approx(as_solid(mesh).volume(), rel=0.02)


def test_subtracting_leaves_the_rest():
    box = box_hull(np.zeros(3), np.ones(3))
    other = convex_hull(np.random.default_rng(1).uniform(0.3, 1.4, size=(20, 3)))
    rest = subtract_hull(box, face_planes(other), 0.0)
    common = (as_solid(box) ^ as_solid(other)).volume()
    assert common > 0.05
    assert sum(map(hull_volume, rest)) == pytest.approx(1.0 - common, abs=1e-6)


def test_limits_are_met_by_cutting_and_fewer_vertices():
    board = box_hull(np.zeros(3), np.array([1.0, 0.5, 0.006]))
    assert tile_hull(board, 1) == (board,)
    plate = clip_hull(board, np.array([0.6, 0.8, 0.0]), 0.95)
    assert plate is not None
    cut = tile_hull(plate, 6)
    assert_within_limits(cut)
    assert len(cut) == 6
    assert sum(map(hull_volume, cut)) == pytest.approx(hull_volume(plate))
    assert tile_hull(plate, 5) == ()
    assert_within_limits([comply_hull(box_hull(np.zeros(3), np.array([0.03, 0.03, 0.0004])))])
    rng = np.random.default_rng(0)
    points = rng.normal(size=(500, 3))
    ball = convex_hull(points / np.linalg.norm(points, axis=1, keepdims=True))
    round_ = comply_hull(ball)
    assert_within_limits([round_])
    assert hull_volume(round_) == pytest.approx(hull_volume(ball))
    assert measure_fit(unite_hulls([round_]), as_solid(ball)).volume_error < 0.12


def test_boxes_are_measured_and_cut_like_any_other_hull():
    low, high = np.array([-0.2, 0.1, 0.0]), np.array([0.4, 0.12, 0.3])
    box = box_hull(low, high)
    turned = convex_hull(box.vertices + 1e-12 * np.arange(24).reshape(8, 3))  # no longer exactly a box
    assert box_bounds(turned) is None
    assert hull_width(box)[0] == pytest.approx(hull_width(turned)[0])
    for normal in np.concatenate([np.eye(3), -np.eye(3)]):
        offset = float((box.vertices @ normal).mean()) + 0.003
        one, other = clip_hull(box, normal, offset), clip_hull(turned, normal, offset)
        assert one is not None
        assert other is not None
        assert hull_volume(one) == pytest.approx(hull_volume(other), rel=1e-6)
        assert (one.vertices @ normal).max() == pytest.approx(offset)
    assert clip_hull(box, np.array([1.0, 0.0, 0.0]), -0.2) is None


def test_space_that_other_links_take_counts_more_when_hulls_fill_it():
    wall = block((0.0, 0.0, 0.0), (0.6, 0.02, 0.6)) - block((0.4, -0.01, 0.2), (0.5, 0.03, 0.5))
    tray = block((0.4, -0.3, 0.2), (0.5, 0.3, 0.5))
    alone, beside = make_ground(wall), make_ground(wall, (tray,))
    np.testing.assert_array_equal(alone.weights > 0, beside.weights > 0)
    free = alone.weights < 0
    ratio = beside.weights[free] / alone.weights[free]
    assert (np.round(ratio, 4) == TAKEN).all()  # the tray takes all that is free here
    taken = alone.weights[free][ratio > 1.5].sum() * wall.volume()
    assert -taken == pytest.approx((tray ^ block((0.0, 0.0, 0.0), (0.6, 0.02, 0.6))).volume(), rel=0.02)
    filled = (box_hull(np.zeros(3), np.array([0.6, 0.02, 0.6])),)
    assert measure_intrusion(unite_hulls(filled), wall, (tray,)) == pytest.approx(
        -taken / wall.volume(), rel=0.02
    )


@pytest.mark.parametrize(("excess", "pieces"), [(0.019, 1), (0.021, 2)])
def test_a_solid_is_cut_if_its_hull_is_two_percent_larger(excess: float, pieces: int):
    """A cube without a square along one edge, half of which its hull takes."""
    side = np.sqrt(2.0 * excess / (1.0 + 2.0 * excess))
    solid = block((0, 0, 0), (1, 1, 1)) - block((1 - side, 1 - side, 0), (1, 1, 1))
    assert solid.hull().volume() / solid.volume() - 1.0 == pytest.approx(excess)
    assert len(cut_pieces(solid)) == pieces
