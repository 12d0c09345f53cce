"""Both sides of the cut-offs of the rasteriser, with its settings as they are."""

import pytest
import torch

from artigen.splats.render import RasterConfig, Splats
from artigen.splats.render.projection import View, project
from artigen.splats.render.rasterize import rasterize_view

VIEW = View(
    axes=torch.eye(3).double(), position=torch.zeros(3).double(), focal=torch.tensor(100.0).double(),
    width=65, height=65,
)  # fmt: skip


def ball(
    *, pixels: float, opacity: float, at: tuple[float, float] = (0.0, 0.0), depth: float = 1.0
) -> Splats:
    """A round splat; lengths in pixels at its depth."""
    x, y = at
    return Splats(
        means=torch.tensor([[x * depth / 100.0, y * depth / 100.0, depth]]).double(),
        quats=torch.tensor([[1.0, 0.0, 0.0, 0.0]]).double(),
        scales=torch.full((1, 3), pixels * depth / 100.0).double(),
        opacities=torch.tensor([opacity]).double(),
        colors=torch.ones(1, 1).double(),
    )


def middle(splats: Splats) -> float:
    """Coverage of the middle pixel."""
    return float(rasterize_view(splats, VIEW, RasterConfig())[32, 32, -1])


def test_a_footprint_is_widened_by_a_tenth_of_a_square_pixel():
    """One with this variance is as wide as two, and half as strong."""
    assert middle(ball(pixels=0.1**0.5, opacity=0.8)) == pytest.approx(0.4)


@pytest.mark.parametrize(("opacity", "coverage"), [(0.98, 0.98), (1.0, 0.99)])
def test_one_splat_covers_99_hundredths_of_a_pixel_at_most(opacity, coverage):
    assert middle(ball(pixels=1000.0, opacity=opacity)) == pytest.approx(coverage, abs=1e-4)


@pytest.mark.parametrize(("levels", "coverage"), [(0.95, 0.0), (1.05, 1.05 / 255)])
def test_a_splat_counts_from_one_level_of_255_on(levels, coverage):
    assert middle(ball(pixels=1000.0, opacity=levels / 255)) == pytest.approx(coverage, abs=1e-6)


@pytest.mark.parametrize(("depth", "drawn"), [(0.0095, 0), (0.0105, 1)])
def test_splats_are_drawn_from_a_hundredth_before_the_camera(depth, drawn):
    assert len(project(ball(pixels=2.0, opacity=0.5, depth=depth), VIEW, RasterConfig()).rows) == drawn


def test_the_perspective_of_a_splat_changes_up_to_1_3_times_the_half_picture():
    """Away from the middle it is stretched by what it is long in depth."""
    half, variances = 32.5, []
    for place in (1.25, 1.35, 1.5):
        found = project(ball(pixels=2.0, opacity=0.5, at=(place * half, 0.0)), VIEW, RasterConfig())
        variances.append(1.0 / float(found.ellipses[0, 2]) - 0.1)
    slopes = [place * half / 100.0 for place in (1.25, 1.3, 1.3)]
    assert variances == pytest.approx([4.0 * (1.0 + slope**2) for slope in slopes])
