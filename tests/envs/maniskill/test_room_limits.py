"""Both sides of what a room allows its door."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from bare_room import ENTRANCE, ROOM

from envs.rooms import check
from envs.rooms.arrange import Plan
from envs.rooms.doorway import hang_door
from envs.rooms.pieces import GAP, Boxes, Piece
from envs.rooms.recipes import DOOR
from envs.rooms.solids import make_solid
from sim_export.geometry.hulls import box_hull


@pytest.mark.parametrize(("above", "hung"), [(0.101, 1), (0.099, 0)])
def test_a_wall_of_a_hand_s_breadth_stays_above_a_door(above: float, hung: int):
    bodies, none = np.array([[(-0.1, 0.0, 0.0), (0.0, 0.8, 2.0)]]), np.zeros((0, 2, 3))
    piece = Piece(role=DOOR.name, entry=None, boxes=Boxes(bodies=bodies, sweeps=none, stands=none), face=-0.1)
    chooser: Any = SimpleNamespace(
        shortlists={DOOR.name: (None,)}, rng=np.random.default_rng(0), piece=lambda *_: piece
    )
    plan = hang_door(Plan(size=(4.0, 3.5, 2.0 + 2 * GAP + above), entrance=ENTRANCE), chooser)
    assert len(plan.places) == hung
    assert (plan.entrance.height == pytest.approx(2.0 + 2 * GAP)) == hung


@pytest.mark.parametrize(("depth", "past"), [(0.39, 0.0), (0.41, 0.01)])
def test_a_door_may_take_forty_centimetres_behind_the_entrance(depth: float, past: float):
    leaf = make_solid("door", [box_hull(np.array([1.55, -depth, 0.01]), np.array([2.35, 0.0, 1.99]))])
    found = check._outside(ROOM, [leaf])
    assert [problem.depth for problem in found] == ([pytest.approx(past)] if past else [])
