"""Hinges are opposite to pulls, doors of a pair open apart, stacked ones alike, mirrored ones mirrored."""

import numpy as np
import pytest

from artigen.reader.hinges import ALIKE, APART, LEFT, NEAR, RIGHT, STACKED, average_shares, weigh_hinges

UNDECIDED = np.zeros((1, 4))
DOOR = np.array([[10.0, 10.0, 50.0, 90.0]])
NONE, NO_SCORES = np.zeros((0, 4)), np.zeros(0)


def pull_at(x: float) -> np.ndarray:
    return np.array([[x - 1, 40.0, x + 1, 60.0]])


@pytest.mark.parametrize(("x", "side"), [(46.0, LEFT), (14.0, RIGHT)])
def test_a_pull_decides_what_the_network_leaves_open(x: float, side: int):
    assert weigh_hinges(UNDECIDED, DOOR, pull_at(x), np.array([0.6]))[0].argmax() == side


def test_a_pull_in_the_middle_or_elsewhere_decides_nothing():
    for pull in (pull_at(30.0), pull_at(70.0)):
        np.testing.assert_array_equal(weigh_hinges(UNDECIDED, DOOR, pull, np.array([0.9])), UNDECIDED)


def pair(gap: float, wide: float) -> np.ndarray:
    return np.array([DOOR[0], [50.0 + gap, 10.0, 50.0 + gap + wide, 90.0]])


def test_doors_of_a_pair_open_away_from_each_other():
    found = weigh_hinges(np.zeros((2, 4)), pair(1.0, 40.0), NONE, NO_SCORES)
    assert [row.argmax() for row in found] == [LEFT, RIGHT]


@pytest.mark.parametrize(
    ("gap", "wide", "paired"),
    [
        (40.0 * NEAR - 0.1, 40.0, True),
        (40.0 * NEAR + 0.1, 40.0, False),
        (1.0, 40.0 * (1 + ALIKE) - 0.1, True),
        (1.0, 40.0 * (1 + ALIKE) + 0.1, False),
    ],
)
def test_what_counts_as_a_pair(gap: float, wide: float, *, paired: bool):
    first = weigh_hinges(np.zeros((2, 4)), pair(gap, wide), NONE, NO_SCORES)[0]
    assert bool(first[LEFT] > first[RIGHT]) == paired


def test_the_middle_of_three_doors_is_left_open():
    doors = np.array([[10.0 + 41 * k, 10.0, 50.0 + 41 * k, 90.0] for k in range(3)])
    np.testing.assert_array_equal(weigh_hinges(np.zeros((3, 4)), doors, NONE, NO_SCORES)[1], np.zeros(4))


def test_mirrored_doors_have_mirrored_hinges():
    logits = np.array([[0.3, -0.2, 0.1, 0.0], [0.1, 0.5, 0.0, 0.0]])
    doors, pulls = pair(1.0, 40.0), pull_at(44.0)
    there = weigh_hinges(logits, doors, pulls, np.array([0.5]))
    flip = [2, 1, 0, 3]
    back = weigh_hinges(
        logits[:, [1, 0, 2, 3]],
        (doors * [-1, 1, -1, 1])[:, flip] + [100, 0, 100, 0],
        (pulls * [-1, 1, -1, 1])[:, flip] + [100, 0, 100, 0],
        np.array([0.5]),
    )
    np.testing.assert_allclose(back[:, [1, 0, 2, 3]], there)


@pytest.mark.parametrize(
    ("gap", "shift", "together"),
    [
        (40.0 * APART - 0.1, 0.0, True),
        (40.0 * APART + 0.1, 0.0, False),
        (1.0, 40.0 * (1 - STACKED) - 0.1, True),
        (1.0, 40.0 * (1 - STACKED) + 0.1, False),
    ],
)
def test_stacked_doors_have_their_hinges_at_one_side(gap: float, shift: float, *, together: bool):
    doors = np.array([DOOR[0], [10.0 + shift, 90.0 + gap, 50.0 + shift, 150.0]])
    sure, unsure = [0.0, 3.0, 0.0, 0.0], [0.5, 0.0, 0.0, 0.0]
    found = weigh_hinges(np.array([sure, unsure]), doors, NONE, NO_SCORES)
    assert [int(row.argmax()) for row in found] == [RIGHT, RIGHT if together else LEFT]


@pytest.mark.parametrize(("share", "side"), [(0.3, RIGHT), (0.7, LEFT)])
def test_the_usual_side_decides_where_nothing_else_does(share: float, side: int):
    assert weigh_hinges(UNDECIDED, DOOR, NONE, NO_SCORES, share)[0].argmax() == side
    beside = weigh_hinges(np.zeros((2, 4)), pair(1.0, 40.0), NONE, NO_SCORES, share)
    assert [int(row.argmax()) for row in beside] == [LEFT, RIGHT]


def test_the_usual_side_shifts_the_odds_by_its_own():
    logits = weigh_hinges(UNDECIDED, DOOR, NONE, NO_SCORES, 0.2)[0]
    assert np.exp(logits[LEFT] - logits[RIGHT]) == pytest.approx(0.25)


def test_shares_are_averaged_over_kinds_with_half_where_unknown():
    assert average_shares([("Refrigerator", 0.6), ("Box", 0.4)], {"Refrigerator": 0.2}) == pytest.approx(0.32)
