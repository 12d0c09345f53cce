"""Both sides of the limits of latents, and closed forms of how logits are smoothed."""

import math

import pytest
import torch

from artigen.latent.latent_dit import velocity_of, weigh_times
from artigen.latent.outline import OutlineBatch, find_candidates, touched_cells
from artigen.latent.patch_vae import PatchDecoder, PatchVaeConfig
from artigen.latent.smoothing import steady_occupancy
from artigen.voxels.fields import CHANNELS, ROW

NOTHING = OutlineBatch(rows=torch.zeros(1, 1, CHANNELS - 1), given=torch.zeros(1, 1, dtype=torch.bool))


def test_a_velocity_is_an_error_over_the_time_and_over_a_twentieth_at_least():
    velocity = velocity_of(torch.ones(3, 1), torch.zeros(3, 1), torch.tensor([0.0, 0.048, 0.052]))
    torch.testing.assert_close(velocity[:, 0], torch.tensor([20.0, 20.0, 1.0 / 0.052]))


def test_errors_before_four_tenths_of_the_time_count_less():
    weights = weigh_times(torch.tensor([0.2, 0.38, 0.42, 1.0]))
    torch.testing.assert_close(weights, torch.tensor([0.25, (0.38 / 0.4) ** 2, 1.0, 1.0]))


def test_a_cell_has_four_candidates():
    """The smallest of six boxes about the middle."""
    rows = torch.zeros(1, 6, CHANNELS - 1)
    rows[0, :, ROW.box.stop - 3 : ROW.box.stop] = torch.linspace(0.9, 0.4, 6)[:, None]
    outlines = OutlineBatch(rows=rows, given=torch.ones(1, 6, dtype=torch.bool))
    found = find_candidates(outlines, 2)
    assert found.found.all()
    assert found.chosen[0, :, 0].tolist() == [5, 4, 3, 2]


@pytest.mark.parametrize(("gap", "touched"), [(0.48 / 64, 1), (0.52 / 64, 0)])
def test_a_box_touches_cells_within_half_a_cell_of_64(gap, touched):
    """The first of 16 cells along x ends 7/16 before the middle, and the box begins behind it."""
    row = torch.zeros(1, 1, CHANNELS - 1)
    low, high = -7 / 16 + gap, 0.25
    row[..., ROW.box] = torch.tensor([(low + high) / 2, 0.0, 0.0, high - low, 0.1, 0.1])
    outlines = OutlineBatch(rows=row, given=torch.ones(1, 1, dtype=torch.bool))
    assert touched_cells(outlines, 16)[0, 0, 0].any() == touched


def test_a_class_is_never_less_likely_than_a_millionth():
    cfg = PatchVaeConfig(resolution=32, width=32, global_width=64)
    decoder, rows = PatchDecoder(cfg).eval(), torch.zeros(1, 4, CHANNELS - 1)
    rows[..., ROW.label.start] = 1.0
    values = decoder.attributes(torch.zeros(1, 32), rows, torch.ones(1, 64, 4, dtype=torch.bool))
    logits = values[0, :, ROW.label]
    torch.testing.assert_close(logits[:, 0], torch.zeros(64))
    torch.testing.assert_close(logits[:, 1:], torch.full((64, logits.shape[1] - 1), math.log(1e-6)))


@pytest.mark.parametrize(
    ("logit", "steadied"),
    [
        (0.1, 0.1 * (1.0 + 1.5 + 1.0) ** 2),  # each of two passes adds the second mean and the highest
        (3.9 / 3.5, 3.9 * 3.5),
        (4.1 / 3.5, 4.0 * 3.5),  # what is above 4 counts as 4
        (9.0, 4.0 * 3.5),
        (-0.3, -0.3 * (1.0 + 1.5) ** 2),
        (-0.9, -0.9 * 2.5 - 1.5),
        (-1.1, -1.1 - 2 * 1.5),  # no mean counts as less than -1
        (-9.0, -4.0 - 1.5),
    ],
)
def test_equal_logits_are_raised_or_lowered_by_their_means(logit, steadied):
    found = steady_occupancy(torch.full((1, 12, 12, 12), logit), NOTHING)
    torch.testing.assert_close(found, torch.full((1, 12, 12, 12), steadied))


def test_a_pass_reaches_four_cells_along_an_axis():
    logits = torch.zeros(1, 32, 32, 32)
    logits[:, 16, 16] = 1.0
    along = steady_occupancy(logits, NOTHING)[0, 16:, 16, 16]
    assert (along > 0).tolist() == [distance <= 2 * 4 for distance in range(16)]
    first = 1.0 + 1.5 / 9 + 1.0  # what one pass makes of it, and a ninth of what is beside it
    beside = (first + 8.0 / 9) / 9
    assert float(along[0]) == pytest.approx(first + 1.5 * beside + first)
