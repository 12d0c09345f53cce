"""Cells that agree along lines: what is mended, what stays, and what does not depend on the axes."""

import pytest
import torch
from torch import Tensor

from artigen.latent.outline import OutlineBatch
from artigen.latent.patches import as_patches, from_patches
from artigen.latent.smoothing import steady_occupancy
from artigen.types import PART_LABELS

EDGE = 32
NOTHING = OutlineBatch(rows=torch.zeros(1, 1, 35), given=torch.zeros(1, 1, dtype=torch.bool))


def volume(*boxes: tuple[slice, slice, slice]) -> Tensor:
    """Logits of cells, certain and occupied in boxes."""
    out = torch.full((1, EDGE, EDGE, EDGE), -4.0)
    for box in boxes:
        out[0][box] = 4.0
    return out


PANEL = (slice(8, 9), slice(6, 26), slice(4, 28))
BAR = (slice(8, 9), slice(10, 11), slice(4, 28))
SHELL = [
    (slice(6, 26), slice(6, 26), slice(6, 7)),
    (slice(6, 26), slice(6, 26), slice(25, 26)),
    (slice(6, 26), slice(6, 7), slice(6, 26)),
    (slice(6, 26), slice(25, 26), slice(6, 26)),
    (slice(25, 26), slice(6, 26), slice(6, 26)),
]


@pytest.mark.parametrize("boxes", [[PANEL], [BAR], SHELL], ids=["panel", "bar", "open box"])
def test_clean_shapes_stay(boxes):
    clean = volume(*boxes)
    assert torch.equal(steady_occupancy(clean, NOTHING) > 0, clean > 0)


def test_a_gap_of_one_cell_between_panels_stays():
    clean = volume(PANEL)
    clean[0, :, 15] = -4.0
    assert torch.equal(steady_occupancy(clean, NOTHING) > 0, clean > 0)


def test_holes_and_ragged_rims_of_a_panel_are_mended():
    clean = volume(PANEL)
    generator = torch.Generator().manual_seed(0)
    drawn = clean.clone()
    panel = drawn[0][PANEL]
    panel[torch.rand(panel.shape, generator=generator) < 0.1] = -4.0
    beyond = torch.rand(20, generator=generator) < 0.3
    drawn[0, 8, 6:26, 28][beyond] = 2.0
    wrong = ((drawn > 0) != (clean > 0)).sum()
    left = ((steady_occupancy(drawn, NOTHING) > 0) != (clean > 0)).sum()
    assert wrong > 40
    assert left < 0.2 * wrong


def test_no_axis_is_special():
    generator = torch.Generator().manual_seed(1)
    logits = 3.0 * torch.randn(1, EDGE, EDGE, EDGE, generator=generator)
    turned = steady_occupancy(logits.permute(0, 3, 1, 2), NOTHING)
    torch.testing.assert_close(turned, steady_occupancy(logits, NOTHING).permute(0, 3, 1, 2))


def test_cells_of_handles_keep_what_was_drawn(handle_outline: OutlineBatch, monkeypatch: pytest.MonkeyPatch):
    logits = torch.randn(1, EDGE, EDGE, EDGE, generator=torch.Generator().manual_seed(2))
    steadied = steady_occupancy(logits, handle_outline)
    kept = steadied == logits
    assert kept[0, 16, 16, 16]
    assert not kept[0, 2, 2, 2]
    monkeypatch.setattr("artigen.latent.smoothing.EXEMPT", ())
    assert not (steady_occupancy(logits, handle_outline) == logits)[0, 16, 16, 16]


@pytest.fixture
def handle_outline() -> OutlineBatch:
    """A handle in the middle of the cube."""
    from artigen.voxels.fields import CHANNELS, ROW

    rows = torch.zeros(1, 1, CHANNELS - 1)
    rows[0, 0, ROW.label.start + PART_LABELS.index("handle")] = 1.0
    rows[0, 0, ROW.box.stop - 3 : ROW.box.stop] = 0.2
    return OutlineBatch(rows=rows, given=torch.ones(1, 1, dtype=torch.bool))


def test_volumes_come_back_from_their_patches():
    logits = torch.randn(2, EDGE, EDGE, EDGE)
    assert torch.equal(from_patches(as_patches(logits), EDGE // 4), logits)
