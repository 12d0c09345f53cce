"""Outlines: rows of exact objects, order, candidates, hints, and cells that are decoded in view of them."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from artigen.examples.structure import draw_example
from artigen.latent.outline import (
    DEPTH,
    HINT_CHANNELS,
    OutlineBatch,
    blur_outlines,
    draw_hint,
    find_candidates,
    gather_outlines,
    reach_cells,
)
from artigen.latent.presets import PRESETS
from artigen.latent.structure_vae import StructureVae
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import PART_LABELS, Asset
from artigen.voxels.fields import ROW, part_attributes, tabulate_parts
from artigen.voxels.voxelize import voxelize

TINY = PRESETS["tiny"]
EDGE = 16
BOX = ROW.box


@pytest.fixture(scope="module")
def table(cabinet: Asset) -> np.ndarray:
    rows = np.stack([part_attributes(part, cabinet.category) for part in cabinet.parts])
    return rows[:, 1:].astype(np.float32)


@pytest.fixture(scope="module")
def outlines(table: np.ndarray) -> OutlineBatch:
    return gather_outlines([table, table[:3]])


@pytest.mark.parametrize("category", ["StorageFurniture", "WashingMachine"])
def test_rows_of_a_shape_are_those_that_training_sees(category: str):
    shape, (_, example) = draw_shape(category, 1), draw_example(category, 1, resolution=32, image_size=0)
    assert np.array_equal(tabulate_parts(shape_to_asset(shape, 32)), example.field.table)


def test_parts_are_read_in_one_order_whatever_order_they_come_in(table: np.ndarray, outlines: OutlineBatch):
    shuffled = gather_outlines([table[::-1].copy()])
    assert torch.equal(shuffled.rows[0], outlines.rows[0])
    labels = outlines.rows[0, :, ROW.label].argmax(dim=1)
    assert (labels.diff() >= 0).all()
    assert outlines.given.sum(dim=1).tolist() == [len(table), 3]


def test_every_cell_of_a_part_has_its_part_among_its_candidates(cabinet: Asset, outlines: OutlineBatch):
    assert cabinet.surface is not None
    voxels = voxelize(cabinet.surface, 4 * EDGE)
    found = find_candidates(outlines, EDGE)
    labels = outlines.rows[0, :, ROW.label].argmax(dim=1)
    flat = np.ravel_multi_index(tuple((voxels.coords // 4).T.astype(np.int64)), (EDGE,) * 3)
    offered = torch.where(found.found[0], labels[found.chosen[0]], -1)[:, flat].numpy()
    wanted = np.array([PART_LABELS.index(part.label) for part in cabinet.parts])[voxels.part_ids]
    assert (offered == wanted).any(axis=0).mean() > 0.999


def test_candidates_come_smallest_first_and_a_missing_one_is_told_by_zeros(outlines: OutlineBatch):
    found = find_candidates(outlines, EDGE)
    volumes = outlines.rows[0, :, BOX][:, 3:].prod(dim=1)[found.chosen[0]]
    both = found.found[0, 1:] & found.found[0, :-1]
    assert both.any()
    assert (volumes.diff(dim=0)[both] >= 0).all()
    assert (found.found[0, 1:] <= found.found[0, :-1]).all()
    hint = draw_hint(outlines, found, EDGE)
    assert hint.shape == (2, HINT_CHANNELS, EDGE, EDGE, EDGE)
    told = hint[0].reshape(DEPTH, -1, EDGE**3)
    assert not told.movedim(1, 2)[~found.found[0]].any()
    assert torch.equal(told[:, -1], found.found[0].float())


def test_fine_cells_are_inside_where_they_touch_the_box(table: np.ndarray):
    row = table[:1].copy()
    fine = 1 / (4 * EDGE)
    row[:, BOX] = [0.0, 0.0, 0.0, 2 * fine, 5 * fine, 1.0]  # y ends in the middle of a cell
    alone = gather_outlines([row])
    rows, inside = reach_cells(alone, find_candidates(alone, EDGE), EDGE, 4)
    assert torch.equal(
        rows[inside.any(dim=1)], torch.from_numpy(row).expand(int(inside.any(dim=1).sum()), -1)
    )
    grid = (
        inside.any(dim=-1).reshape(*(EDGE,) * 3, 4, 4, 4).permute(0, 3, 1, 4, 2, 5).reshape(*(4 * EDGE,) * 3)
    )
    for axis, cells in enumerate((4, 6, 64)):  # what lies on the face, or a quarter of a cell from it, counts
        others = tuple(other for other in range(3) if other != axis)
        assert int(grid.any(dim=others[1]).any(dim=others[0]).sum()) == cells


def test_faces_are_told_in_cells_from_the_centre_of_the_cell(table: np.ndarray):
    row = table[:1].copy()
    row[:, BOX] = [0.0, 0.0, 0.0, 4 / EDGE, 4 / EDGE, 2 / EDGE]
    alone = gather_outlines([row])
    hint = draw_hint(alone, find_candidates(alone, EDGE), EDGE)[0].reshape(DEPTH, -1, EDGE, EDGE, EDGE)
    middle = EDGE // 2  # its centre is half a cell above the origin
    low, high = hint[0, -7:-4, middle, middle, middle], hint[0, -4:-1, middle, middle, middle]
    torch.testing.assert_close(low, torch.tensor([2.0, 2.0, 1.5]))  # at most two cells are told
    torch.testing.assert_close(high, torch.tensor([1.5, 1.5, 0.5]))
    assert not hint[:, :, 0, 0, 0].any()


def test_blur_moves_boxes_alone_and_takes_whole_outlines_away(outlines: OutlineBatch):
    generator = torch.Generator().manual_seed(0)
    blurred = blur_outlines(outlines, 0.0, generator)
    moved = (blurred.rows - outlines.rows)[outlines.given]
    assert 0.1 < 64 * float(moved[:, BOX].std()) < 0.5
    assert not moved[:, : BOX.start].any()
    assert torch.equal(blurred.given, outlines.given)
    assert not blur_outlines(outlines, 1.0, generator).given.any()


def test_cells_get_the_attributes_of_the_part_they_choose(cabinet: Asset, outlines: OutlineBatch):
    torch.manual_seed(0)
    vae = StructureVae(TINY.vae).eval()
    edge = TINY.resolution // 4
    z = torch.randn(2, 8, edge, edge, edge)
    every = torch.arange(2 * edge**3)
    with torch.no_grad():
        _, values, index = vae.decode(z, every, outlines)
    reached = find_candidates(outlines, edge).found.any(dim=1).flatten()[index]
    numbers = slice(ROW.axis.start, ROW.box.stop)
    said = values[reached][..., numbers].reshape(-1, numbers.stop - numbers.start)
    known = outlines.rows[outlines.given][:, numbers]
    assert (
        torch.cdist(said, known, compute_mode="donot_use_mm_for_euclid_dist").min(dim=1).values.max() < 1e-5
    )
    with pytest.raises(ValueError, match="under outlines"):
        vae.decode(z)
    changed = replace(outlines, rows=outlines.rows.roll(1, dims=-1))
    assert not torch.allclose(vae.decode(z, every, changed)[0], vae.decode(z, every, outlines)[0])
