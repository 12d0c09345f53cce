"""Seams: strays go to the part they lie on, wide ones shrink, clean sets are left alone."""

from dataclasses import fields, replace

import numpy as np
import pytest

from artigen.kinematics import articulate_gaussians, qlimits
from artigen.splats.parts import merge_gaussians, select_gaussians
from artigen.splats.seams import REACH, distance_outside, settle_seams
from artigen.types import Asset, Gaussians, VoxelGrid


def at_cells(voxels: VoxelGrid, rows: np.ndarray | slice = slice(None)) -> Gaussians:
    """A small Gaussian in the middle of every cell, of the cell's part."""
    means = voxels.centers()[rows]
    return Gaussians(
        means=means,
        quats=np.tile([1.0, 0.0, 0.0, 0.0], (len(means), 1)),
        scales=np.full((len(means), 3), 0.3 / voxels.resolution),
        opacities=np.full(len(means), 0.9),
        colors=np.full((len(means), 3), 0.5),
        part_ids=voxels.part_ids[rows],
    )


@pytest.fixture(scope="module")
def clean(cabinet: Asset) -> Asset:
    assert cabinet.voxels is not None
    return replace(cabinet, gaussians=at_cells(cabinet.voxels))


def test_a_clean_set_is_left_alone(clean: Asset):
    assert settle_seams(clean) is clean
    # On the border of its own cell, a Gaussian is still at home.
    edged = replace(clean, gaussians=replace(clean.gaussians, means=clean.gaussians.means + 0.499 / 64))
    assert settle_seams(edged) is edged


def stray_rows(clean: Asset) -> tuple[int, int]:
    """A moving part's row, and another part's row a good way from that part's cells."""
    moving = next(k for k, part in enumerate(clean.parts) if part.joint.type == "prismatic")
    row = int(np.flatnonzero(clean.gaussians.part_ids == moving)[0])
    others = np.flatnonzero(clean.gaussians.part_ids != moving)
    alien = replace(select_gaussians(clean.gaussians, others), part_ids=np.full(len(others), moving))
    far = others[distance_outside(alien, clean.voxels, np.zeros((len(others), 1, 3)))[:, 0] > 3]
    return row, int(far[0])


def test_a_stray_is_given_to_the_part_it_lies_on(clean: Asset):
    row, target = stray_rows(clean)
    means = clean.gaussians.means.copy()
    means[row] = means[target]
    settled = settle_seams(replace(clean, gaussians=replace(clean.gaussians, means=means)))
    changed = np.flatnonzero(settled.gaussians.part_ids != clean.gaussians.part_ids)
    assert changed.tolist() == [row]
    assert settled.gaussians.part_ids[row] == clean.gaussians.part_ids[target]
    assert len(settled.notes) == len(clean.notes) + 1
    assert settled.notes[-1].startswith("1 of ")
    # Everything else is as it was; and a second pass finds nothing.
    for item in fields(Gaussians):
        if item.name not in ("part_ids",):
            wanted = means if item.name == "means" else getattr(clean.gaussians, item.name)
            np.testing.assert_array_equal(getattr(settled.gaussians, item.name), wanted)
    assert settle_seams(settled) is settled


def test_moving_parts_leave_nothing_behind_and_take_nothing_along(clean: Asset):
    """What is not in a part's cells does not move with it, once seams are settled."""
    rng = np.random.default_rng(0)
    mixed = clean.gaussians.part_ids.copy()
    chosen = rng.choice(len(mixed), 300, replace=False)
    mixed[chosen] = rng.integers(0, len(clean.parts), 300)
    settled = settle_seams(replace(clean, gaussians=replace(clean.gaussians, part_ids=mixed)))
    opened = qlimits(clean)[:, 1]
    wanted = articulate_gaussians(clean, opened, clean.gaussians)
    got = articulate_gaussians(settled, opened, settled.gaussians)
    np.testing.assert_allclose(got.means, wanted.means, atol=1e-6)


def test_what_stands_far_over_its_part_is_made_smaller_and_only_there(clean: Asset):
    row = stray_rows(clean)[0]
    cells = clean.voxels.resolution
    scales = clean.gaussians.scales.copy()
    scales[row] = [20.0 / cells, 0.3 / cells, 20.0 / cells]
    wide = replace(clean, gaussians=replace(clean.gaussians, scales=scales))
    settled = settle_seams(wide)
    now = settled.gaussians.scales
    others = np.arange(len(now)) != row
    np.testing.assert_array_equal(now[others], scales[others])
    assert now[row, 1] == scales[row, 1]
    assert (now[row] <= scales[row]).all()
    assert now[row].max() < scales[row].max()
    one = select_gaussians(settled.gaussians, np.array([row]))
    ends = 2.0 * np.concatenate([np.diag(now[row]), -np.diag(now[row])])[None].astype(float)
    assert distance_outside(one, clean.voxels, ends).max() <= REACH + 1e-6
    assert "made smaller" in settled.notes[-1]
    assert settle_seams(settled) is settled


def test_what_is_missing_is_an_error(clean: Asset):
    with pytest.raises(ValueError, match="both needed"):
        settle_seams(replace(clean, gaussians=None))
    with pytest.raises(ValueError, match="both needed"):
        settle_seams(replace(clean, voxels=None))
    homeless = replace(clean, voxels=replace(clean.voxels, part_ids=np.zeros_like(clean.voxels.part_ids)))
    lost = replace(
        clean.gaussians, part_ids=np.ones_like(clean.gaussians.part_ids), means=clean.gaussians.means + 2
    )
    wide = merge_gaussians([replace(lost, scales=np.full_like(lost.scales, 0.5))])
    with pytest.raises(ValueError, match="no cell"):
        settle_seams(replace(homeless, gaussians=wide))
