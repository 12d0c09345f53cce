"""Boundaries and units of measurements."""

import numpy as np
import pytest

from artigen.appearance.photographs import NOTHING
from artigen.metrics.appearance import mean_colors
from artigen.metrics.clouds import chamfer, sample_every_part
from artigen.metrics.compat import compat_distance
from artigen.types import Asset, Joint, Part, VoxelGrid


@pytest.mark.parametrize(("pixels", "counts"), [(11, False), (12, True)])
def test_a_part_has_a_colour_if_twelve_pixels_show_it(pixels, counts):
    parts = np.full((2, 4, 4), NOTHING, dtype=np.uint8)
    parts.reshape(-1)[:pixels] = 3
    assert (3 in mean_colors(np.zeros((2, 4, 4, 3)), parts)) == counts


def box_with_knob(place: int) -> Asset:
    """A box of 8^3 cells with one of 2^3 inside of it, that many cells from its lower end."""
    grid = np.stack(np.meshgrid(*(np.arange(8),) * 3, indexing="ij"), axis=3).reshape(-1, 3)
    inner = np.arange(2)
    knob = np.stack(np.meshgrid(inner + 3, inner + 3, inner + place, indexing="ij"), axis=3).reshape(-1, 3)
    own = (grid[:, None] == knob).all(axis=2).any(axis=1)
    still = Joint(type="fixed", axis=np.array([0.0, 0.0, 1.0]), origin=np.zeros(3))
    inside = np.stack([(knob.mean(axis=0) + 0.5) / 8 - 0.5, np.full(3, 2 / 8)])
    parts = (
        Part(name="base", label="base", parent=-1, joint=still, box=np.stack([np.zeros(3), np.ones(3)])),
        Part(name="knob", label="knob", parent=0, joint=still, box=inside),
    )
    voxels = VoxelGrid(resolution=8, coords=grid, part_ids=own.astype(int))
    return Asset(name="box", category="Oven", scale=1.0, parts=parts, voxels=voxels)


def test_published_distances_are_those_of_objects_with_an_edge_of_two():
    low, high = box_with_knob(0), box_with_knob(6)
    clouds = [sample_every_part(asset, 200) for asset in (low, high)]
    apart = [chamfer(*(cloud.points[cloud.part_ids == part] for cloud in clouds)) for part in range(2)]
    assert compat_distance(low, high, per_part=200).rest == pytest.approx(4.0 * np.mean(apart))
