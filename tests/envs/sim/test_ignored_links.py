"""Masks by which SAPIEN ignores contacts between links."""

from itertools import combinations

import pytest

from envs.sim.ignored_links import share_bits
from sim_export.files.mjcf import MAX_PAIRS


def pairs_of(*names: str) -> list[frozenset[str]]:
    return [frozenset(pair) for pair in combinations(names, 2)]


@pytest.mark.parametrize(
    "pairs", [pairs_of(*"abcdefghi"), [*pairs_of(*"abc"), *pairs_of(*"cde"), frozenset("ae")]]
)
def test_links_share_a_bit_exactly_if_they_are_a_pair(pairs):
    masks = share_bits(pairs, ())
    for one, other in pairs_of(*masks):
        assert bool(masks[one] & masks[other]) == (frozenset((one, other)) in pairs)


def test_pairs_of_one_link_with_many_that_touch_each_other_end_with_the_bits():
    masks = share_bits([frozenset(("hub", f"{k}")) for k in range(MAX_PAIRS + 5)], ())
    assert len(masks) == 1 + MAX_PAIRS
