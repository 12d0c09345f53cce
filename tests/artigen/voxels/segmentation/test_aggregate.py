"""Boxes lie where the votes say, within a cell of where the voxels do."""

import numpy as np
import pytest

from artigen.voxels.segmentation.aggregate import fuse_box


@pytest.mark.parametrize(
    ("voted", "fused"),
    [
        ((18.9, 31.1), (19.0, 31.0)),
        ((19.1, 30.9), (19.1, 30.9)),
        ((21.9, 28.1), (21.9, 28.1)),
        ((22.1, 27.9), (22.0, 28.0)),
    ],
)
def test_faces_lie_within_a_cell_of_the_outermost_cells(voted, fused):
    """Those of a part reach from 20 to 30, so that its faces are in the first and last of them, or next."""
    cells = np.argwhere(np.ones((10, 10, 10))) + 20
    low, high = voted
    box = np.array([(low + high) / 128 - 0.5] * 3 + [(high - low) / 64] * 3)
    center, size = fuse_box(box, cells, 64)
    np.testing.assert_allclose((center - size / 2 + 0.5) * 64, fused[0])
    np.testing.assert_allclose((center + size / 2 + 0.5) * 64, fused[1])
