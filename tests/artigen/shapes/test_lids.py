"""Laws of lids, latches, bowls and turned parts: what opens upwards, and what holds it down."""

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest
from shape_sweeps import find_overlaps

from artigen.kind import kinds
from artigen.kinds.toilet import SHALLOWEST
from artigen.shapes.draw import ShapeError, Wish, draw_shape
from artigen.shapes.fittings.bowls import build_bowl
from artigen.shapes.fittings.hardware import GAP, Edge, Space
from artigen.shapes.fittings.lids import (
    build_half_shell,
    build_roof,
    build_vessel,
    hinge_lid,
    make_lift_out,
    trace_arch,
)
from artigen.shapes.fittings.locks import FREE, make_latch
from artigen.shapes.fittings.outlines import Outline
from artigen.shapes.fittings.turning import QUARTERS, turn_part
from artigen.shapes.poses import pose_parts
from artigen.shapes.primitives import Primitive, box, contains, place_vertices
from artigen.shapes.shape import Shape, ShapePart, make_base
from artigen.shapes.surfaces.finishes import Finish
from artigen.sketch.faults import find_faults
from artigen.sketch.words import CATEGORIES

FINISH = Finish(kind="plastic", color=(0.5, 0.5, 0.5), accent=(0.4, 0.4, 0.4))
X, Y, RIM = (-0.2, 0.25), (-0.3, 0.35), 0.3
MORE = sorted(set(kinds()) - set(CATEGORIES[:9]))


def make_shape(*parts: ShapePart) -> Shape:
    return Shape(category="Vessel", seed=0, style="plain", parts=parts, finishes=(("paint", FINISH),))


def vessel(lean: float = 0.0) -> ShapePart:
    bottom = (X[0] + lean, X[1] - lean), (Y[0] + lean, Y[1] - lean)
    solids = build_vessel(bottom, (X, Y), (0.0, RIM), 0.012, "paint")
    return make_base(solids)


def lid(solids: tuple[Primitive, ...], upper: float, edge: Edge | None = None) -> ShapePart:
    motion = hinge_lid(X, Y, RIM + GAP, upper, edge)
    return ShapePart("lid", "door", solids, motion)


def slab() -> tuple[Primitive, ...]:
    return (box((X[0], Y[0], RIM + GAP), (X[1], Y[1], RIM + GAP + 0.03), "paint"),)


@pytest.mark.parametrize("edge", [None, "bottom", "left", "right"])
@pytest.mark.parametrize("upper", [radians(80), radians(120), pi])
def test_a_lid_clears_its_rim_over_its_whole_sweep_and_its_free_edge_rises(edge: Edge | None, upper: float):
    shape = make_shape(vessel(), lid(slab(), upper, edge))
    assert find_faults(shape) == ()
    T = pose_parts(shape, np.array([0.0, 0.01]))[1]
    corners = place_vertices(shape.parts[1].primitives[0])
    risen = (corners @ T[:3, :3].T + T[:3, 3])[:, 2] - corners[:, 2]
    assert risen.max() > 0.004
    assert risen.min() > -1e-3


@pytest.mark.parametrize("rise", [0.05, 0.2])
def test_hollow_lids_clear_the_rim_too(rise: float):
    low = RIM + GAP
    hollow = (
        build_roof(trace_arch(X, low, rise), 0.01, Y, "paint"),
        build_half_shell(Space(x=X, y=Y, z=(low, low + rise)), 0.008, "paint", "paint"),
    )
    for solids in hollow:
        shape = make_shape(vessel(lean=0.03), lid(solids, radians(100)))
        assert find_faults(shape) == ()
        inside = np.array([[sum(X) / 2, sum(Y) / 2, low + 0.4 * rise]])
        assert not any(contains(solid, inside)[0] for solid in solids)


def test_a_tray_below_a_lid_comes_out_once_the_lid_is_open():
    inside = (X[0] + 0.02, X[1] - 0.02), (Y[0] + 0.02, Y[1] - 0.02)
    tray = make_lift_out(inside, (0.012 + GAP, 0.25), 0.006, "paint")
    cover = lid(slab(), radians(100))
    assert find_faults(make_shape(vessel(), cover, tray)) == ()
    blocked = make_shape(vessel(), lid(slab(), radians(60)), tray)
    assert "blocked" in {fault.id for fault in find_faults(blocked)}


@pytest.mark.parametrize("side", list(QUARTERS))
def test_a_latch_stays_clear_of_the_face_on_every_side(side: str):
    half = 0.2
    body = box((-half, -half, 0.0), (half, half, RIM), "paint")
    base = make_base((body,))
    made = make_latch(-half, (-0.02, 0.02), (RIM - 0.05, RIM - 0.005), name="latch")
    latch = turn_part(made, side)
    latch = replace(latch, primitives=[box(*_corners(solid), "paint") for solid in latch.primitives])
    shape = make_shape(base, latch)
    assert find_faults(shape) == ()
    out = {"front": (-1, 0), "right": (0, -1), "back": (1, 0), "left": (0, 1)}[side]
    low, high = latch.bounds()
    reach = [value for value in (*low[:2], *high[:2]) if abs(value) > half]
    assert {float(np.sign(value)) for value in reach} == {float(sum(out))}
    assert min(abs(value) for value in reach) == pytest.approx(half + FREE)


def _corners(solid: Primitive):
    points = place_vertices(solid)
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


@pytest.mark.parametrize("axis", [0, 2])
@pytest.mark.parametrize("span", [(0.0, 0.1), (0.1, 0.0)])
def test_a_bowl_is_closed_at_one_end_and_around_and_hollow_within(axis: int, span: tuple[float, float]):
    outline = Outline(a=(-0.2, 0.2), b=(0.1, 0.4), cuts=(0.05, 0.05))
    solids = build_bowl(outline, span, 0.01, axis=axis, bevel=0.015)

    def filled(a: float, b: float, along: float) -> bool:
        point = np.array([[along, a, b] if axis == 0 else [a, b, along]])
        return any(contains(solid, point)[0] for solid in solids)

    closed = span[0] + 0.005 * np.sign(span[1] - span[0])
    assert filled(0.0, 0.25, closed)
    assert not filled(0.0, 0.25, 0.05)
    assert not filled(0.0, 0.25, span[1])
    for a, b in ((-0.195, 0.25), (0.195, 0.25), (0.0, 0.105), (0.0, 0.395)):
        assert filled(a, b, 0.05)
    assert not filled(0.199, 0.399, 0.05)  # the corner is rounded


@pytest.mark.parametrize("category", MORE)
def test_wished_lengths_are_met_with_what_stands_out_excepted(category: str):
    for seed in range(3):
        plain = draw_shape(category, seed).condition
        wish = Wish(width=1.03 * plain.width, height=1.03 * plain.height, style=plain.style)
        found = draw_shape(category, seed, wish).condition
        assert found.width == pytest.approx(1.03 * plain.width, abs=0.02)
        assert found.height == pytest.approx(1.03 * plain.height, abs=0.02)
        assert found.style == plain.style


def test_wall_hung_toilets_have_bowls_that_their_hinges_leave_free():
    shape = draw_shape("Toilet", 0, Wish(style="wall_hung", depth=SHALLOWEST))
    assert find_overlaps(shape, 3) == []
    with pytest.raises(ShapeError, match=r"depth 0.61 m with a piece of wall, expected at least 0.62 m"):
        draw_shape("Toilet", 0, Wish(style="wall_hung", depth=SHALLOWEST - 0.01))
