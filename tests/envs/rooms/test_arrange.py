"""Where clusters may stand in a room, and which of these places is taken."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from envs.rooms.arrange import (
    Place,
    Plan,
    Taste,
    best_place,
    fits,
    middle_places,
    place_cost,
    wall_places,
)
from envs.rooms.pieces import Boxes, Cluster, join_boxes
from envs.rooms.room import Opening, Side

PLAN = Plan(size=(4.0, 3.5, 2.6), entrance=Opening(side="front", start=1.5, width=0.9, height=2.0))
NONE = np.zeros((0, 2, 3))


def solid(low: tuple[float, float, float], high: tuple[float, float, float]) -> Boxes:
    return Boxes(bodies=np.array([[low, high]]), sweeps=NONE, stands=NONE)


def cluster(length: float = 0.5, depth: float = 0.4) -> Cluster:
    boxes = solid((-depth, 0.0, 0.0), (0.0, length, 0.8))
    return Cluster(name="box", members=(), boxes=boxes, length=length, depth=depth)


def stand(x: float, y: float, side: Side | None = None) -> Place:
    """A box of ten centimetres with its middle there."""
    boxes = solid((x - 0.05, y - 0.05, 0.0), (x + 0.05, y + 0.05, 0.8))
    return Place(cluster=cluster(), T=np.eye(4), boxes=boxes, side=side)


@pytest.mark.parametrize(("room", "found"), [(0.038, False), (0.041, True)])
def test_a_stretch_of_wall_is_found_if_it_is_four_centimetres_longer_than_needed(room: float, found: object):
    """It begins a millimetre beyond a place that is tried, which all are multiples of 4 cm from the wall."""
    start = 0.003 + 0.4 + 0.001
    sides = join_boxes(
        [
            solid((0.0, 3.0, 0.0), (start, 3.5, 0.8)),
            solid((start + 0.5 + room, 3.0, 0.0), (4.0, 3.5, 0.8)),
        ]
    )
    places = wall_places(PLAN, cluster(), "back")
    assert any(fits(PLAN, place.boxes, sides) for place in places) == found


def test_places_in_the_middle_are_fifteen_centimetres_apart():
    centers = np.array([place.center for place in middle_places(PLAN, cluster())])
    for axis in (0, 1):
        np.testing.assert_allclose(np.diff(np.unique(np.round(centers[:, axis], 6))), 0.15)


@pytest.mark.parametrize(("away", "free"), [(0.89, False), (0.91, True)])
def test_ninety_centimetres_before_the_entrance_stay_empty(away: float, free: object):
    assert fits(PLAN, solid((1.8, away, 0.0), (2.0, away + 0.3, 0.8)), join_boxes([])) == free


@pytest.mark.parametrize("way", [0.6, 2.9, 3.1])
@pytest.mark.parametrize("side", [None, "back"])
def test_a_place_is_a_quarter_better_for_each_of_three_metres_from_the_entrance(
    way: float, side: Side | None
):
    """And nothing else counts, unless a group likes corners or the middle."""
    middle = PLAN.doorway[0, :, :2].mean(axis=0)
    place = stand(float(middle[0] + 0.6 * way), float(middle[1] + 0.8 * way), side)
    assert place_cost(PLAN, place, Taste(), middle) == pytest.approx(-0.25 * min(way, 3.0))


@pytest.mark.parametrize(("better", "taken"), [(0.59, "worse"), (0.61, "better")])
def test_chance_makes_a_place_up_to_six_tenths_worse(better: float, taken: str):
    """A metre from the entrance is worth a quarter; chance is against the better place."""
    x, y = (float(value) for value in PLAN.doorway[0, :, :2].mean(axis=0))
    places = [stand(x, y + 3.0), stand(x + 3.0 - 4 * better, y)]
    chance: Any = SimpleNamespace(random=iter([1.0, 0.0]).__next__)
    found = best_place(PLAN, places, Taste(), chance)
    assert found is places[["better", "worse"].index(taken)]
