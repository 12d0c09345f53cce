"""Pieces: found again in what they make, on the grid as off it; latches that come after what they hold."""

from dataclasses import replace

import numpy as np
import pytest

from artigen.shapes.draw import draw_shape
from artigen.shapes.fittings.outlines import Outline, build_loft, draw_egg, trace_corners
from artigen.shapes.primitives import SEGMENTS, box, contains, place_vertices, polytope
from artigen.sketch.piece import CORNERS, INWARD, NUMBERS, Piece, PieceKind, across
from artigen.sketch.pieces import build_piece, fit_pieces
from artigen.sketch.request import empty_request
from artigen.sketch.rows import PIECE_KINDS, ROW_KINDS, column, rows_to_sketch, sketch_to_rows
from artigen.sketch.rules import Writer
from artigen.sketch.sketch import FRACTIONS, read_sketch, write_sketch
from artigen.sketch.slots import slots
from artigen.sketch.snap import STEP, snap_piece, to_metres
from artigen.sketch.solid_pieces import room_to_cut

ROUNDED: tuple[PieceKind, ...] = ("slab", "shell", "elbow")
BOUNDS = (0.02, -0.1, 0.3, 0.32, 0.3, 0.8)


def _make(kind: PieceKind, *more: float, bounds: tuple[float, ...] = BOUNDS, **said: object) -> Piece:
    return replace(Piece(kind=kind, finish="body", numbers=(*bounds, *more)), **said)


def _elbow(axis: int, corners: int, sides: int) -> Piece:
    bounds = np.array([[0.1, 0.1, 0.1], [0.2, 0.2, 0.2]])
    bounds[1, axis] = 0.13
    numbers = (*bounds[0].tolist(), *bounds[1].tolist())
    return Piece(kind="elbow", finish="body", numbers=numbers, axis=axis, corners=corners, sides=sides)


PIECES = [
    *(_make("slab", 0.05, 0.08, axis=axis, corners=corners, sides=1 + corners % 4)
      for axis in range(3) for corners in range(1, 2**CORNERS)),
    _make("slab", 0.15, 0.2, axis=2, corners=12, sides=6),  # half an ellipse
    _make("slab", 0.3, 0.4, axis=2, corners=2, sides=1),  # a triangle
    *(_make("shell", 0.04, 0.05, inset, wall, axis=axis, sides=2)
      for axis in range(3) for inset in (-0.02, 0.0, 0.03) for wall in (0.0, 0.015) if inset or wall),
    _make("shell", 0.18, 0.12, 0.02, 0.03, axis=2, sides=4),  # arcs meet in front, and not at the sides
    _make("shell", 0.24, 0.16, 0.02, 0.03, axis=0, sides=5, bounds=(0.0, 0.0, 0.0, 0.4, 0.4, 0.2)),  # an egg
    _make("shell", 0.24, 0.16, -0.03, 0.0, axis=0, sides=4, bounds=(0.0, 0.0, 0.0, 0.4, 0.4, 0.2)),
    _make("shell", 0.04, 0.04, 0.0, 0.02, axis=0, sides=2, lining="inside", lined=INWARD),
    _make("shell", 0.04, 0.04, 0.02, 0.0, axis=0, sides=2, lining="inside", lined=1),
    _make("slab", 0.05, 0.08, axis=1, corners=3, sides=2, lining="inside", lined=4),
    *(_elbow(axis, corners, 1 + corners) for axis in range(3) for corners in range(CORNERS)),
]  # fmt: skip


@pytest.mark.parametrize("piece", PIECES, ids=lambda piece: f"{piece.kind}-{piece.axis}-{piece.corners}")
def test_what_a_piece_makes_is_that_piece_on_the_grid_too(piece: Piece):
    (found,) = fit_pieces(build_piece(piece))
    assert found.numbers == pytest.approx(piece.numbers, abs=1e-7)
    assert replace(found, numbers=piece.numbers) == piece
    # Off the grid, as the grammar has them: on it, a piece stays the one it is.
    odd = replace(piece, numbers=tuple(number * 1.0173 + 0.00013 * (number != 0) for number in piece.numbers))
    snapped = snap_piece(odd)
    (again,) = fit_pieces(build_piece(to_metres(snapped)))
    assert snap_piece(again) == snapped


def test_a_leaning_board_whose_ends_are_upright_on_the_grid_is_a_frustum():
    flat = np.array([(-0.1, -0.001), (0.1, -0.001), (0.1, 0.001), (-0.1, 0.001)])
    flat = flat @ np.array([(np.cos(0.06), np.sin(0.06)), (-np.sin(0.06), np.cos(0.06))])
    corners = [(x, y, z) for x, z in flat for y in (-0.02, 0.02)]
    (leaning,) = fit_pieces([polytope(np.array(corners), "body", center=(0.5, 0.5, 0.5))])
    assert leaning.kind == "prism"
    snapped = snap_piece(leaning)
    assert snapped.kind == "frustum"
    (again,) = fit_pieces(build_piece(to_metres(snapped)))
    assert snap_piece(again) == snapped


def test_arcs_that_meet_go_on_meeting_on_the_grid():
    for width in (0.2, 0.2003, 0.2005, 0.2009):
        arch = _make("slab", width / 2, 0.07, axis=2, corners=12, sides=3, bounds=(0, 0, 0, width, 0.3, 0.1))
        egg = _make(
            "shell", 0.6 * width, 0.4 * width, 0.01, 0.02, axis=2, sides=3, bounds=(0, 0, 0, width, 0.1, 0.1)
        )
        for piece in (arch, egg):
            before, after = build_piece(piece), build_piece(to_metres(snap_piece(piece)))
            assert [len(solid.vertices) for solid in after] == [len(solid.vertices) for solid in before]


@pytest.mark.parametrize("corners", range(1, 2**CORNERS))
def test_a_slab_is_its_box_but_for_the_corners_that_are_cut(corners: int):
    piece = _make("slab", 0.05, 0.08, axis=1, corners=corners, sides=1)
    (solid,) = build_piece(piece)
    (u, v), low, high = across(1), piece.low, piece.high
    for k, (i, j) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
        near = (low + high) / 2
        near[u], near[v] = (low, high)[i][u] + (1e-3, -1e-3)[i], (low, high)[j][v] + (1e-3, -1e-3)[j]
        assert contains(solid, near[None])[0] == (not corners >> k & 1)
    assert max(room_to_cut(corners)) <= 1.0


def test_cuts_beyond_what_there_is_take_all_there_is():
    most = _make("slab", 0.2, 0.25, axis=0, corners=15, sides=2)
    assert np.allclose(
        *(place_vertices(build_piece(p)[0]) for p in (most, replace(most, numbers=(*BOUNDS, 9.0, 9.0))))
    )


def test_an_outline_is_as_round_at_the_middle_as_an_ellipse():
    egg = draw_egg((0.1, 0.0), 0.3, 0.2, 0.15, pieces=8)
    points = egg.trace() - np.array([0.1, 0.0])
    reach = np.where(points[:, 0] < 0, 0.3, 0.2)
    assert (points[:, 0] / reach) ** 2 + (points[:, 1] / 0.15) ** 2 == pytest.approx(1.0)
    square = trace_corners((0.0, 1.0), (0.0, 2.0), [(0.0, 0.0)] * 4, 1)
    assert np.unique(square, axis=0).tolist() == [[0, 0], [0, 2], [1, 0], [1, 2]]


@pytest.mark.parametrize("inset", [-0.02, 0.0, 0.02])
def test_walls_of_a_loft_go_around_and_leave_the_hollow_free(inset: float):
    outline = Outline(a=(-0.2, 0.3), b=(-0.15, 0.15), cuts=(0.3, 0.2), pieces=4)
    walls = build_loft(outline, 2, (0.0, 0.1), "body", inset=inset, wall=0.03)
    assert len(walls) == 16
    for height in (0.01, 0.05, 0.09):
        taken = inset * (1 - height / 0.1) if inset > 0 else -inset * height / 0.1
        for depth, inside in ((0.01, True), (0.045, False)):
            ring = outline.shrink(taken + depth).trace()
            edges = np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1) > 1e-3
            middles = ((ring + np.roll(ring, -1, axis=0)) / 2)[edges]
            spots = np.column_stack([middles, np.full(len(middles), height)])
            held = np.sum([contains(wall, spots) for wall in walls], axis=0)
            assert (held == inside).all()


def test_an_elbow_joins_two_tubes_corner_to_corner():
    piece = _elbow(1, 0, 3)
    rings = np.concatenate([place_vertices(solid) for solid in build_piece(piece)])
    (u, v), center, radius = across(1), np.array([0.1, 0.115, 0.1]), 0.015
    for end, other in ((u, v), (v, u)):
        ring = rings[np.abs(rings[:, other] - center[other]) < 1e-9]
        middle = center.copy()
        middle[end] = 0.2 - radius
        assert np.linalg.norm(np.unique(ring.round(9), axis=0) - middle, axis=1) == pytest.approx(
            [radius] * SEGMENTS
        )


def _write(row: list[int], writer: Writer, rng: np.random.Generator) -> bool:
    """Says a piece by chance within the rules."""
    while not writer.complete():
        value = writer.follows() if writer.row else None
        if value is None and len(writer.row) < len(row):
            value = row[len(writer.row)]
        if value is None and (size := int(slots().size[slots().of_cell[writer.row[0], len(writer.row)]])):
            value = int(rng.choice(np.flatnonzero(writer.allowed(size))))
        if value is None:
            low, high = writer.span()
            assert low <= high, (writer.row, writer.name)
            value = int(rng.integers(low, high + 1))
        writer.put(value)
    return True


@pytest.mark.parametrize("kind", ROUNDED)
def test_whatever_the_rules_allow_of_a_rounded_piece_is_one(kind: PieceKind):
    table, rng = sketch_to_rows(write_sketch(draw_shape("Safe", 1))), np.random.default_rng(0)
    head = next(at for at, row in enumerate(table) if ROW_KINDS[row[0]] == "part")
    for _ in range(150):
        writer = Writer(request=empty_request())
        for row in table[: head + 1].tolist():
            _write(row, writer, rng)
            writer.close()
        _write([ROW_KINDS.index(kind)], writer, rng)
        row = writer.close()
        first = column(kind, "x0")
        numbers = tuple(number * STEP for number in row[first : first + len(NUMBERS[kind])])
        said = {name: row[column(kind, name)] for name in ("axis", "sides")}
        if kind != "shell":
            said["corners"] = row[column(kind, "corners")]
        piece = replace(Piece(kind=kind, finish="body", numbers=numbers), **said)
        assert all((solid.size > 0).all() for solid in build_piece(piece))


@pytest.mark.parametrize("category", ["Door", "Suitcase", "Box"])
def test_a_latch_that_comes_after_what_it_holds_says_so(category: str):
    found = 0
    for seed in range(6):
        sketch = write_sketch(draw_shape(category, seed))
        table = sketch_to_rows(sketch)
        holds = [int(row[column("joint", "holds")]) for row in table if ROW_KINDS[row[0]] == "joint"]
        for holder, held in enumerate(holds):
            if held:
                assert held - 1 < holder
                assert holder in sketch.parts[held - 1].needs
                assert FRACTIONS[sketch.parts[held - 1].fraction] in (0.9, 0.95)
                found += 1
        assert rows_to_sketch(table) == sketch
        # A table that ends before the latch can be read: what it holds is free.
        ends = [at for at, row in enumerate(table) if ROW_KINDS[row[0]] == "joint"]
        for end in ends:
            read_sketch(rows_to_sketch(np.concatenate([table[: end + 1], table[-1:]])))
    assert found


def test_no_part_may_hold_what_it_waits_for():
    sketch = write_sketch(draw_shape("Safe", 1))
    moving = next(k for k, part in enumerate(sketch.parts) if part.joint is not None)
    for needs, allowed in (((moving,), False), ((), True)):
        last = next(k for k, part in enumerate(sketch.parts) if part.joint is not None and k > moving)
        parts = list(sketch.parts)
        parts[last] = replace(parts[last], needs=needs)
        table = sketch_to_rows(replace(sketch, parts=tuple(parts)))
        writer, joints = Writer(request=empty_request()), 0
        for row in table.tolist():
            while not writer.complete():
                if joints == last and writer.row and writer.kind == "joint" and writer.name == "holds":
                    size = int(slots().size[slots().of_cell[writer.row[0], len(writer.row)]])
                    assert writer.allowed(size)[moving + 1] == allowed
                writer.put(row[len(writer.row)])
            joints += ROW_KINDS[writer.close()[0]] == "joint"


def test_boxes_around_a_hole_stay_boxes():
    frame = [box((a, b, 0.0), (a + 0.1, b + 0.1, 0.2), "body") for a in (0.0, 0.1) for b in (0.0, 0.1)]
    assert {piece.kind for piece in fit_pieces(frame)} == {"box"}
    assert set(ROUNDED) < set(PIECE_KINDS)
