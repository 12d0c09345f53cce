"""Figures have one colour: means stay, differences within a figure go, everything else is left alone."""

import numpy as np
import torch

from artigen.appearance.draw import even_sides


def test_what_is_added_within_a_figure_is_its_mean_and_nothing_else_changes():
    generator = torch.Generator().manual_seed(0)
    drawn, expected = torch.randn(2, 12, 13, generator=generator)
    paint = np.zeros((12, 7))
    paint[6:, :3] = 0.5  # outer sides: two figures; inner ones: one; the last two voxels are no neighbours
    edges = np.array([[n, n + 1] for n in range(9)] + [[10, 11]]).T
    out = even_sides(drawn, expected, paint, edges)
    torch.testing.assert_close(out[:, 6:], drawn[:, 6:], rtol=0, atol=0)
    for side, figures in ((0, ([0, 6], [6, 10], [10, 12])), (1, ([0, 10], [10, 12]))):
        own = slice(3 * side, 3 * side + 3)
        added, was = out[:, own] - expected[:, own], drawn[:, own] - expected[:, own]
        for first, last in figures:
            mean = was[first:last].mean(dim=0, keepdim=True)
            torch.testing.assert_close(added[first:last], mean.expand(last - first, -1))
    torch.testing.assert_close(even_sides(out, expected, paint, edges), out)
    apart = np.random.default_rng(0).random((12, 7))  # all painted differently: nothing to share
    torch.testing.assert_close(even_sides(drawn, expected, apart, edges), drawn)
