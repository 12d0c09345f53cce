"""Worktops lie on what is below them, at one height, with holes where something stands up."""

import numpy as np
import pytest

from envs.rooms.arrange import Plan, wall_places
from envs.rooms.footprints import COVERS, FOOT, Footprint, _find_deck
from envs.rooms.pieces import GAP, Boxes, Cluster, Member, Piece, conflict, join_boxes, move_boxes
from envs.rooms.room import Opening
from envs.rooms.worktops import (
    HOOD_BOTTOM,
    LYING,
    RIM,
    THICKNESS,
    hang_hoods,
    lay_worktops,
    worktop_height,
)

PLAN = Plan(size=(4.0, 3.5, 2.6), entrance=Opening(side="front", start=1.5, width=0.9, height=2.0))
SIZE = (0.6, 0.8, 0.88)


def sink_boxes() -> np.ndarray:
    """Four boards around an opening of 0.3 by 0.4 m in a box of 0.6 by 0.8 by 0.88 m, and a tap behind it."""
    sides = [
        ((0.0, 0.0), (0.6, 0.2)),
        ((0.0, 0.6), (0.6, 0.8)),
        ((0.0, 0.2), (0.1, 0.6)),
        ((0.4, 0.2), (0.6, 0.6)),
    ]
    boards = [((*low, 0.85), (*high, 0.88)) for low, high in sides]
    return np.array([*boards, ((0.0, 0.0, 0.0), (0.6, 0.8, 0.5)), ((0.45, 0.38, 0.88), (0.5, 0.42, 1.15))])


def test_a_deck_is_the_highest_level_that_covers_much_and_its_hole_holds_basin_and_tap():
    deck = _find_deck(sink_boxes())
    assert deck.height == pytest.approx(0.88)
    np.testing.assert_allclose(deck.hole, [[0.1, 0.2], [0.5, 0.6]])
    np.testing.assert_allclose(deck.above, [[0.45, 0.38, 0.88], [0.5, 0.42, 1.15]])


@pytest.mark.parametrize(("lift", "reach"), [(FOOT - 0.001, 0.5), (FOOT + 0.001, 0.4)])
def test_only_what_stands_near_the_deck_needs_a_hole(lift: float, reach: float):
    boxes = sink_boxes()
    boxes[-1, 0, 2] = 0.88 + lift
    hole = _find_deck(
        boxes[:-1] if reach == 0.0 else np.array([*boxes, [[0.2, 0.3, 0.88], [0.3, 0.4, 0.9]]])
    ).hole
    assert hole is not None
    assert hole[1, 0] == pytest.approx(reach)


@pytest.mark.parametrize("boxes", [sink_boxes()[:-1], np.array([[[0.0, 0.0, 0.0], [1.0, 1.0, 0.7]]])])
def test_a_level_top_has_no_hole(boxes: np.ndarray):
    assert _find_deck(boxes).hole is None


def unit(role: str, height: float, boxes: np.ndarray | None = None) -> Piece:
    """A unit of 0.6 by 0.8 m as a piece, or one of boxes; its back is at x = 0."""
    own = np.array([[[0.0, 0.0, 0.0], [SIZE[0], SIZE[1], height]]]) if boxes is None else boxes
    own = own - [SIZE[0], 0.0, 0.0]
    deck, none = _find_deck(own), np.zeros((0, 2, 3))
    body = np.array([own[:, 0].min(axis=0), own[:, 1].max(axis=0)])
    solid = body.copy()
    solid[1, 2] = deck.height
    bodies = solid[None] if deck.above is None else np.array([solid, deck.above])
    footprint = Footprint(
        body=body, solid=bodies, sweeps=none, fronts=np.zeros((0, 2)), tops=(), face=-SIZE[0], deck=deck
    )
    entry = object()  # only whether there is one matters
    return Piece(role=role, entry=entry, boxes=Boxes(bodies=bodies), face=-SIZE[0], footprint=footprint)  # pyright: ignore


def run_of(*pieces: Piece) -> tuple[Plan, dict]:
    members = []
    for index, piece in enumerate(pieces):
        T = np.eye(4)
        T[1, 3] = index * (SIZE[1] + GAP)
        members.append(Member(piece=piece, T=T))
    boxes = join_boxes([move_boxes(member.piece.boxes, member.T) for member in members])
    length = len(pieces) * (SIZE[1] + GAP)
    run = Cluster(name="back", members=tuple(members), boxes=boxes, length=length, depth=SIZE[0])
    place = next(wall_places(PLAN, run, "back", np.array([0.4])))
    return PLAN.with_place(place), {"back": place}


def covered(plan: Plan) -> np.ndarray:
    """Boxes of all worktops in the room."""
    slabs = [place.boxes.bodies for place in plan.places if "worktop" in place.cluster.name]
    return np.concatenate([np.zeros((0, 2, 3)), *slabs])


def test_one_worktop_lies_on_the_highest_of_its_units_and_stops_at_a_range():
    units = [
        unit("base cabinet", 0.88),
        unit("dishwasher", 0.85),
        unit("range", 0.9),
        unit("base cabinet", 0.86),
    ]
    plan, runs = run_of(*units)
    height = worktop_height(runs)
    assert height == pytest.approx(0.88 + LYING)
    slabs = covered(lay_worktops(plan, runs, height))
    assert len(slabs) == 2
    np.testing.assert_allclose(slabs[:, 0, 2], height)
    np.testing.assert_allclose(slabs[:, 1, 2], height + THICKNESS)
    length = float((slabs[:, 1, 0] - slabs[:, 0, 0]).sum())
    assert 3 * SIZE[1] < length < 3 * SIZE[1] + GAP + 0.08  # with panels at both ends


def test_a_worktop_leaves_the_basin_and_the_tap_free():
    plan, runs = run_of(
        unit("base cabinet", 0.88), unit("sink", 0.88, sink_boxes()), unit("base cabinet", 0.88)
    )
    height = worktop_height(runs)
    assert height is not None
    laid = lay_worktops(plan, runs, height)
    slabs = covered(laid)
    area = float(np.prod((slabs[:, 1] - slabs[:, 0])[:, :2], axis=1).sum())
    whole = float(np.prod((slabs[:, 1].max(axis=0) - slabs[:, 0].min(axis=0))[:2]))
    assert whole - area == pytest.approx((0.4 + 2 * RIM) ** 2, rel=1e-6)
    assert not conflict(Boxes(bodies=slabs), plan.boxes)


def test_a_hood_hangs_above_every_range():
    plan, runs = run_of(unit("base cabinet", 0.88), unit("range", 0.9))
    hung = hang_hoods(plan, runs)
    (place,) = [place for place in hung.places if "hood" in place.cluster.name]
    canopy, chimney = place.boxes.bodies
    cooker = move_boxes(
        plan.places[0].cluster.members[1].piece.boxes, runs["back"].T @ plan.places[0].cluster.members[1].T
    )
    np.testing.assert_allclose(canopy[:, 0], cooker.bodies[0][:, 0])
    assert canopy[0, 2] == HOOD_BOTTOM
    assert chimney[1, 2] == pytest.approx(PLAN.size[2] - GAP)


@pytest.mark.parametrize(("more", "height"), [(0.95, 0.5), (1.05, 0.7)])
def test_boundary_of_a_deck(more: float, height: float):
    """A block on a body is its deck from a share of its area on."""
    boxes = np.array([[(0.0, 0.0, 0.0), (1.0, 1.0, 0.5)], [(0.0, 0.0, 0.5), (more * COVERS, 1.0, 0.7)]])
    assert _find_deck(boxes).height == height
