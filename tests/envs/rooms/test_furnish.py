"""Groups of furniture along walls and in the middle of a room."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from envs.rooms.arrange import Place, Plan
from envs.rooms.furnish import place_group
from envs.rooms.pieces import Boxes, Cluster, Piece
from envs.rooms.recipes import KITCHEN, Group
from envs.rooms.room import Opening

NONE = np.zeros((0, 2, 3))
CUBE = Piece(
    role="table",
    entry=None,
    boxes=Boxes(bodies=np.array([[[-0.2, 0.0, 0.0], [0.0, 0.2, 0.5]]]), sweeps=NONE, stands=NONE),
    face=-0.2,
)


def furnish(plan: Plan, group: Group) -> Place | None:
    """The place of a group of cubes of 20 cm, if there is one."""
    chooser: Any = SimpleNamespace(
        shortlists={"table": (None,)}, rng=np.random.default_rng(0), piece=lambda *_: CUBE, most=30
    )
    placed = place_group(plan, KITCHEN, group, chooser, whole=False)
    return placed.places[-1] if placed else None


@pytest.mark.parametrize(("away", "found"), [(0.59, False), (0.61, True)])
def test_what_stands_in_the_middle_is_sixty_centimetres_from_everything(away: float, found: object):
    """In a room so small that there is one place only, in its middle."""
    plan = Plan(size=(1.75, 1.75, 2.6), entrance=Opening(side="back", start=2.5, width=0.9, height=2.0))
    bodies = np.array([[[0.0, 0.0, 0.0], [0.8 - away, 1.75, 0.5]]])
    boxes = Boxes(bodies=bodies, sweeps=NONE, stands=NONE)
    cluster = Cluster(name="wall", members=(), boxes=boxes, length=1.0, depth=1.0)
    plan = plan.with_place(Place(cluster=cluster, T=np.eye(4), boxes=boxes, side=None))
    group = Group(name="table", roles=("table",), count=(1, 1), where="middle")
    assert (furnish(plan, group) is not None) == found


def test_a_group_stands_in_one_row_before_its_wall_unless_something_else_is_said():
    plan = Plan(size=(4.0, 3.5, 2.6), entrance=Opening(side="front", start=1.5, width=0.9, height=2.0))
    place = furnish(plan, Group(name="tables", roles=("table",) * 3, count=(1, 1)))
    assert place is not None
    bodies = place.boxes.bodies
    ends = np.stack([bodies[:, 0, :2], np.array(plan.size[:2]) - bodies[:, 1, :2]])
    assert ends.min() == pytest.approx(0.003)
    across = np.ptp(bodies[:, :, :2], axis=(0, 1))
    assert across.min() == pytest.approx(0.2)
