"""Things in a compartment: of few kinds, apart from each other, and just above the floor."""

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from envs.rooms.compartments import Compartment
from envs.rooms.contents import fill_compartment
from envs.rooms.room import Item, Placement
from envs.rooms.solids import item_hulls

SHELF = Compartment(link="body", kind="shelf", low=(0.0, 0.0, 0.1), high=(0.4, 0.8, 0.5))
HOLDER = Placement(
    id="cabinet_1", role="base cabinet", category="StorageFurniture", package=Path("x"),
    position=(0.0, 0.0, 0.0), quat=(1.0, 0.0, 0.0, 0.0), size=(0.6, 1.0, 0.9),
)  # fmt: skip


@pytest.fixture(scope="module")
def filled() -> list[list[Item]]:
    """Of twenty shelves of a kitchen."""
    return [fill_compartment(SHELF, "kitchen", HOLDER, np.random.default_rng(seed)) for seed in range(20)]


def test_a_compartment_has_up_to_three_kinds_of_things(filled: list[list[Item]]):
    assert max(len({item.thing for item in items}) for items in filled) == 3


def test_things_stand_half_a_millimetre_above_their_floor(filled: list[list[Item]]):
    assert {item.position[2] for items in filled for item in items} == {0.1005}


def test_things_are_eight_millimetres_apart(filled: list[list[Item]]):
    """And some are hardly more."""
    gaps = []
    for items in filled:
        points = [np.concatenate([hull.vertices for hull in item_hulls(item)])[:, :2] for item in items]
        for one, other in combinations([(each.min(axis=0), each.max(axis=0)) for each in points], 2):
            gaps.append(np.maximum(one[0] - other[1], other[0] - one[1]).max())
    assert 0.008 - 1e-5 < min(gaps) < 0.011


def test_a_compartment_has_up_to_forty_things():
    """However large it is."""
    hall = replace(SHELF, high=(50.0, 50.0, 0.5))
    assert len(fill_compartment(hall, "kitchen", HOLDER, np.random.default_rng(0))) == 40
