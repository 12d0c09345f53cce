"""Gaussians of voxels fill boards without gaps, and end where parts do."""

import numpy as np
import pytest
import torch

from artigen.facings import FACINGS, facing_frames
from artigen.models.appearance_presets import APPEARANCE_PRESETS
from artigen.models.gaussian_decoder import GaussianDecoder
from artigen.splats.render.reach import reach_neighbours
from artigen.splats.render.splats import Splats

DECODER = GaussianDecoder(APPEARANCE_PRESETS["tiny"].decoder)
EDGE = 32
ROW = np.array([[16, 16, 16], [16, 17, 16], [16, 18, 16]])


def decode(width: float, facing: int, cells: np.ndarray) -> tuple[Splats, np.ndarray]:
    """Gaussians that fill ``width`` of their voxels across, and the cells: turned as the frame is."""
    frame = np.round(facing_frames()[facing]).astype(int)
    coords = (cells - 16) @ frame.T + 16
    places = torch.from_numpy(np.pad(coords, ((0, 0), (1, 0))))
    raw = torch.zeros(len(coords), DECODER.out_layer.out_features)
    spread = torch.tanh(DECODER.offset_perturbation)
    raw[:, DECODER.channels("offset")[:, 1:]] = torch.atanh(width * spread[:, 1:]) - torch.atanh(
        spread[:, 1:]
    )
    return DECODER.read(places, raw, torch.full((len(coords),), facing)), coords


def stretch(made: Splats, coords: np.ndarray, facing: int, part_ids: np.ndarray) -> Splats:
    facings = np.full(len(coords), facing)
    return reach_neighbours(made, coords, part_ids, facings, EDGE, DECODER.span())


@pytest.mark.parametrize("facing", range(FACINGS))
def test_a_row_of_voxels_is_filled_along_and_stays_narrow_across(facing: int):
    thin, coords = decode(0.5, facing, ROW)
    whole, _ = decode(1.0, facing, ROW)
    made = stretch(thin, coords, facing, np.zeros(3, int))
    frame = torch.tensor(facing_frames()[facing]).float()
    along, across = frame[:, 1], frame[:, 2]
    torch.testing.assert_close((made.means @ along)[4:8], (whole.means @ along)[4:8], atol=1e-5, rtol=0)
    torch.testing.assert_close(made.means @ across, thin.means @ across, atol=1e-6, rtol=0)
    torch.testing.assert_close(made.scales[4:8, 1], 2.0 * thin.scales[4:8, 1])
    torch.testing.assert_close(made.scales[:, [0, 2]], thin.scales[:, [0, 2]])
    start, end = (made.means @ along).min(), (made.means @ along).max()
    assert start > (thin.means @ along).min() - 1e-6  # the row ends where it was drawn to end
    assert end < (thin.means @ along).max() + 1e-6
    for name in ("quats", "opacities", "colors"):
        assert torch.equal(getattr(made, name), getattr(thin, name))


def test_what_is_filled_stays_and_other_parts_are_no_neighbours():
    whole, coords = decode(1.0, 0, ROW)
    made = stretch(whole, coords, 0, np.zeros(3, int))
    torch.testing.assert_close(made.means, whole.means, atol=1e-6, rtol=0)
    torch.testing.assert_close(made.scales, whole.scales)
    thin, coords = decode(0.5, 0, ROW)
    apart = stretch(thin, coords, 0, np.arange(3))
    torch.testing.assert_close(apart.means, thin.means, atol=1e-6, rtol=0)
    assert torch.equal(apart.scales, thin.scales)
