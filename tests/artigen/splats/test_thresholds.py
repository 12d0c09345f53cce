"""Sizes of the discs on surfaces, and the limits of files, in numbers."""

import numpy as np
import pytest

from artigen.shapes.primitives import prism
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.solids import list_solids
from artigen.shapes.surfaces.finishes import Finish
from artigen.splats.faces import Discs, divide_lengths, lay_discs, lay_gaussians
from artigen.splats.ply import encode_ply
from artigen.splats.surface import splat_surface
from artigen.types import Gaussians, SurfaceSamples


def test_discs_are_seven_tenths_of_a_cell_and_end_2_1_of_their_deviations_before_the_edge():
    _, place, deviation = divide_lengths(np.array([10.0]), 0.1)
    middle = len(place) // 2
    assert deviation[middle] == pytest.approx(0.7 * 0.1, rel=0.01)
    assert place[middle + 1] - place[middle] == pytest.approx(0.1, rel=0.01)
    assert place[0] == pytest.approx(2.1 * deviation[0])


def slab(lean: float) -> Shape:
    """A slab of four edges, one of which leans by an angle in degrees."""
    end = 0.5 - np.tan(np.radians(lean))
    corners = np.array([[-0.5, -0.5], [0.5, -0.5], [end, 0.5], [-0.5, 0.5]])
    grey = (0.5, 0.5, 0.5)
    finish = Finish(kind="plastic", color=grey, accent=grey, period=1.0, gloss=0.0, opacity=1.0)
    solid = prism(corners, (-0.1, 0.0, 0.0), (0.1, 0.0, 0.0), "grey")
    part = ShapePart(name="body", label="base", parent=None, primitives=(solid,), joint=None)
    return Shape(category="Thing", seed=0, style="plain", parts=(part,), finishes=(("grey", finish),))


def front_of(discs: Discs) -> np.ndarray:
    """Standard deviations of the discs on the front, along and across their rows."""
    return discs.deviations[discs.normals[:, 0] < -0.999]


@pytest.mark.parametrize(("lean", "narrower"), [(2.5, 1), (2.6, 4)])
def test_rows_of_faces_are_four_times_narrower_where_the_cosine_of_edges_is_below_999_thousandths(
    lean, narrower
):
    """From 2.56 degrees on."""
    across = np.median(front_of(lay_discs(list_solids(slab(lean)), 0.02))[:, 1])
    assert across == pytest.approx(0.7 * 0.02 / narrower, rel=0.02)


def test_discs_on_faces_are_a_thousandth_of_a_cell_thick():
    np.testing.assert_allclose(lay_gaussians(slab(0.0), 0.05).scales[:, 2], 0.001 * 0.05)


def sampled(*lattices: np.ndarray) -> SurfaceSamples:
    """Samples at points of a plane, a part each."""
    flat = np.concatenate(lattices)
    return SurfaceSamples(
        points=np.column_stack([np.zeros(len(flat)), flat]),
        normals=np.tile([-1.0, 0.0, 0.0], (len(flat), 1)),
        colors=np.zeros((len(flat), 3), dtype=np.uint8),
        part_ids=np.repeat(np.arange(len(lattices)), [len(one) for one in lattices]),
    )


def lattice(rows: int, columns: int, step: float) -> np.ndarray:
    return step * np.argwhere(np.ones((rows, columns)))


def test_discs_of_samples_are_as_wide_as_a_tenth_of_the_circle_of_ten_neighbours():
    """On a lattice that has a radius of two steps. A second is twice as coarse: its gaps are not filled."""
    scales = splat_surface(sampled(lattice(30, 30, 0.01), 5.0 + lattice(10, 10, 0.02))).scales
    wanted = 0.7 * 0.02 * np.sqrt(np.pi / 10) * np.array([1.0, 1.0, 0.1])
    np.testing.assert_allclose(scales[15 * 30 + 15], wanted, rtol=1e-6)
    np.testing.assert_allclose(scales[900 + 5 * 10 + 5], wanted, rtol=1e-6)


def test_a_surface_reaches_three_tenths_of_the_spacing_beyond_its_outermost_samples():
    """Here they are a line, whose tenth neighbour is five steps away."""
    wanted = 0.7 * 0.05 * np.sqrt(np.pi / 10) * np.array([0.1, 0.3, 1.0])
    np.testing.assert_allclose(
        np.sort(splat_surface(sampled(lattice(1, 40, 0.01))).scales[20]), wanted, rtol=1e-6
    )


@pytest.mark.parametrize(("opacity", "logit"), [(1.0, 20.0), (0.0, -104.0)])
def test_logits_in_files_end_at_20_and_at_minus_104(opacity, logit):
    gaussians = Gaussians(
        means=np.zeros((1, 3)), quats=np.array([[1.0, 0.0, 0.0, 0.0]]), scales=np.ones((1, 3)),
        opacities=np.array([opacity]), colors=np.zeros((1, 3)), part_ids=np.zeros(1, dtype=np.int64),
    )  # fmt: skip
    assert np.frombuffer(encode_ply(gaussians)[-17 * 4 :], "<f4")[9] == logit
