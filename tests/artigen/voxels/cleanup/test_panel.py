"""The panel of a part is its fullest layer near the front, with those beside it that are half as full."""

import numpy as np
import pytest

from artigen.voxels.cleanup.panel import find_panel


def part(*held: int) -> np.ndarray:
    """Layers with so many cells each, from the front."""
    layers = np.zeros((len(held), 10, 10), dtype=bool)
    for layer, count in enumerate(held):
        layers[layer].flat[:count] = True
    return layers


@pytest.mark.parametrize(
    ("deep", "at", "found"), [(20, 5, True), (20, 6, False), (5, 2, True), (5, 3, False)]
)
def test_it_is_sought_in_three_tenths_of_the_depth_and_three_layers(deep: int, at: int, found: object):
    held = [10] * deep
    held[at] = 100
    assert (find_panel(part(0, *held)) == slice(at + 1, at + 2)) == found


def test_layers_beside_it_that_are_half_as_full_are_of_it():
    assert find_panel(part(0, 49, 50, 100, 50, *[0] * 20, 9)) == slice(2, 5)
    assert find_panel(part(50, 50, 100, 49, *[0] * 20, 9)) == slice(0, 3)
