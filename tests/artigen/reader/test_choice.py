"""The chosen set of fronts is the best of all sets."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from artigen.reader.choice import FLAT, UNUSUAL, choose_fronts

SHARES = {"Refrigerator": {(2, 0): 0.7, (1, 0): 0.3}}


def value_of(labels, scores, doors, kinds, middle, strength) -> float:
    """Logarithm of the probability of one labelling: 0 absent, 1 door, 2 drawer; up to a constant."""
    odds = np.log(scores / (1 - scores)) - np.log(middle / (1 - middle))
    total = 0.0
    for label, odd, door in zip(labels, odds, doors, strict=True):
        total += 0.0 if label == 0 else odd + np.log((door if label == 1 else 1 - door) / max(door, 1 - door))
    counts = (labels.count(1), labels.count(2))
    prior = sum(
        p * (FLAT if kind not in SHARES else (1 - UNUSUAL) * SHARES[kind].get(counts, 0.0) + UNUSUAL * FLAT)
        for kind, p in kinds
    )
    return total + strength * np.log(prior)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.tuples(st.floats(0.05, 0.95), st.floats(0.05, 0.95)), min_size=1, max_size=5),
    st.floats(0.0, 1.0),
    st.floats(0.1, 0.6),
    st.floats(0.0, 1.0),
)
def test_no_other_set_is_likelier(fronts, share, middle, strength):
    scores, doors = (np.array(column) for column in zip(*fronts, strict=True))
    kinds = (("Refrigerator", share), ("Dresser", 1.0 - share))
    chosen, is_door = choose_fronts(scores, doors, kinds, SHARES, middle=middle, strength=strength)
    labels = [0] * len(scores)
    for index, door in zip(chosen, is_door, strict=True):
        labels[index] = 1 if door else 2
    best = max(
        value_of(list(other), scores, doors, kinds, middle, strength)
        for other in product((0, 1, 2), repeat=len(scores))
    )
    assert value_of(labels, scores, doors, kinds, middle, strength) == pytest.approx(best, abs=1e-9)


def test_a_usual_count_adds_a_faint_front_and_drops_an_unusual_one():
    scores, doors = np.array([0.9, 0.25]), np.array([0.97, 0.97])
    fridge, cabinet = ((("Refrigerator", 1.0),), (("StorageFurniture", 1.0),))
    for kinds, expected in ((fridge, [0, 1]), (cabinet, [0])):
        assert choose_fronts(scores, doors, kinds, SHARES, middle=0.3, strength=1.0)[0] == expected
    three = np.array([0.9, 0.8, 0.35])
    assert choose_fronts(three, np.full(3, 0.97), fridge, SHARES, middle=0.3, strength=1.0)[0] == [0, 1]
