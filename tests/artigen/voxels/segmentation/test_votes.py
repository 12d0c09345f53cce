"""Extents of groups, and how much their voxels say against a merger."""

import numpy as np
import pytest

import artigen.voxels.segmentation.votes
from artigen.voxels.segmentation.votes import Votes, merge_scores, summarise

EDGE = 64


def vote(cells: np.ndarray, centers: np.ndarray, sizes: np.ndarray, noise: float) -> Votes:
    """Votes for boxes in cells, whose centres along x are uncertain; a group is one draw of that."""
    values = np.zeros((len(cells), 14))
    values[:, :3], values[:, 3:6] = centers / EDGE - 0.5, sizes / EDGE
    sigma = np.full(14, 0.05 / EDGE)
    sigma[0] = noise / EDGE
    return Votes(
        resolution=EDGE,
        coords=cells,
        whitened=values / sigma,
        sigma=sigma,
        patch=1e6,
        drift=np.zeros(14),
        log_label=np.zeros((len(cells), 1)),
        log_joint=np.zeros((len(cells), 1)),
    )


@pytest.mark.parametrize(("count", "end"), [(99, 40), (100, 11)])
def test_a_hundredth_of_a_part_may_lie_beyond_its_extent(count: int, end: int):
    cells = np.full((count, 3), 10)
    cells[0] = 39
    votes = vote(cells, np.full((count, 3), 10.5), np.ones((count, 3)), 0.05)
    found = summarise(votes, np.zeros(count, dtype=int))
    np.testing.assert_allclose(found.high, np.full((1, 3), end / EDGE - 0.5))
    np.testing.assert_allclose(found.low, np.full((1, 3), 10 / EDGE - 0.5))


def weigh(count: int) -> float:
    """The evidence that so many voxels in a plane are not of the block beside them."""
    block = np.argwhere(np.ones((10, 8, 8))) + 10
    plane = (np.argwhere(np.ones((1, 8, 8))) + np.array([26, 10, 10]))[:count]
    centers = np.repeat([[15.0, 14.0, 14.0], [26.5, 14.0, 14.0]], [len(block), count], axis=0)
    sizes = np.repeat([[10.0, 8.0, 8.0]], len(block) + count, axis=0)
    votes = vote(np.concatenate([block, plane]), centers, sizes, 4.0)
    groups = np.repeat([0, 1], [len(block), count])
    scores = merge_scores(votes, summarise(votes, groups), groups, np.zeros((2, 2), dtype=bool))
    return float(scores[0, 1])


def test_forty_voxels_of_a_part_say_all_against_a_merger(monkeypatch: pytest.MonkeyPatch):
    """Of those that stand six voxels beside the block, each is an evidence of about one."""
    monkeypatch.setattr(artigen.voxels.segmentation.votes, "EXTENT_TOLERANCE", 10.0)
    assert weigh(40) - weigh(39) == pytest.approx(1.1, abs=0.1)
    assert weigh(41) == pytest.approx(weigh(40))
