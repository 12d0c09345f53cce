"""Discs on the faces of a shape: on the surface of their part, up to its edges, as opaque as its finish."""

import numpy as np
import pytest
import torch
from scipy.ndimage import binary_erosion
from scipy.spatial import KDTree

from artigen.shapes.asset import frame_shape, shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.shapes.primitives import Primitive, box, cylinder, prism
from artigen.shapes.render import Cameras
from artigen.shapes.render.even_light import OPENNESS
from artigen.shapes.sampling import place_points
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.splats.colors import linear_from_srgb, srgb_from_linear
from artigen.splats.faces import SPREAD, SQUARE, divide_lengths, lay_gaussians
from artigen.splats.render import Rendering, make_splats, rasterize
from artigen.transforms import matrix_from_quat
from artigen.types import Gaussians


def of(*primitives: Primitive, opacity: float = 1.0) -> Shape:
    """One part of grey plastic, or of glass."""
    finish = Finish(
        kind="glass" if opacity < 1 else "plastic", color=(0.5, 0.5, 0.5), accent=(0.5, 0.5, 0.5),
        period=1.0, gloss=0.0, opacity=opacity,
    )  # fmt: skip
    part = ShapePart(name="body", label="base", parent=None, primitives=primitives, joint=None)
    return Shape(category="Thing", seed=0, style="plain", parts=(part,), finishes=(("grey", finish),))


def see(
    gaussians: Gaussians, direction: tuple[float, float, float], behind: float = 0.0, size: int = 300
) -> Rendering:
    """Seen from 200 units away; the picture is 1.5 units wide."""
    camera = Cameras(
        position=200 * torch.tensor([direction], dtype=torch.float64),
        target=torch.zeros(1, 3, dtype=torch.float64),
        fov=torch.tensor([np.degrees(2 * np.arctan(0.75 / 200))], dtype=torch.float64),
        width=size,
        height=size,
    )
    return rasterize(make_splats(gaussians), camera, background=(behind,) * 3)


@pytest.fixture(scope="module")
def oven() -> Shape:
    return draw_shape("Oven", 0)


@pytest.fixture(scope="module")
def discs(oven: Shape) -> Gaussians:
    return lay_gaussians(oven)


@pytest.mark.parametrize("length", [1e-4, 0.01, 0.04, 0.2, 0.31, 0.32, 0.33, 1.0, 3.7])
def test_cells_follow_each_other_from_end_to_end(length: float):
    row, place, deviation = divide_lengths(np.array([1.0, length]), 0.1)
    place, width = place[row == 1], deviation[row == 1] / SPREAD
    np.testing.assert_allclose(np.diff(place), (width[1:] + width[:-1]) / 2, rtol=1e-9)
    np.testing.assert_allclose(place, length - place[::-1], atol=1e-12)
    assert 0 < place[0] <= place[-1] < length
    assert width.max() <= 0.1 * 1.5


def test_long_faces_take_few_cells():
    count = [len(divide_lengths(np.array([length]), 0.1)[0]) for length in (1.0, 2.0)]
    assert count[1] - count[0] == 10


@pytest.mark.slow
def test_discs_lie_on_the_surface_of_their_part_and_face_outward(oven: Shape, discs: Gaussians):
    center, scale = frame_shape(oven)
    found = place_points(oven, scale / 512)
    away, turned = np.zeros(len(discs.means)), np.zeros(len(discs.means))
    normals = matrix_from_quat(discs.quats)[:, :, 2]
    for part in range(len(oven.parts)):
        own, true = discs.part_ids == part, found.part_ids == part
        near = KDTree(found.points[true]).query(discs.means[own] * scale + center, k=8)
        away[own] = near[0][:, 0] / scale
        turned[own] = np.einsum("kni,ki->kn", found.normals[true][near[1]], normals[own]).max(axis=1)
    assert away.max() < 1 / 256
    assert np.quantile(turned, 0.001) > 0.97


def test_every_part_has_discs_all_over_its_surface(oven: Shape, discs: Gaussians):
    center, scale = frame_shape(oven)
    found = place_points(oven, scale / 64)
    for part in range(len(oven.parts)):
        means = discs.means[discs.part_ids == part]
        points = (found.points[found.part_ids == part] - center) / scale
        assert np.asarray(KDTree(means).query(points)[0]).max() < 1 / 64, oven.parts[part].name


def test_colours_are_those_of_the_finishes_in_even_light(oven: Shape, discs: Gaussians):
    painted = shape_to_asset(oven, resolution=None, spacing=0.02).surface
    assert painted is not None
    for part in range(len(oven.parts)):
        drawn = srgb_from_linear(discs.colors[discs.part_ids == part]).mean(axis=0)
        true = painted.colors[painted.part_ids == part].mean(axis=0) / 255.0
        assert np.abs(drawn - true).max() < 0.2, oven.parts[part].name


CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5]])
SOLIDS = {
    "box": (box((-0.5, -0.5, -0.25), (0.5, 0.5, 0.25), "grey"), 0.5, 3.0, 0.4),
    "board": (box((-0.5, -0.5, -0.01), (0.5, 0.5, 0.01), "grey"), 0.02, 2.04, 0.4),
    "rod": (cylinder((0.0, -0.5, 0.0), (0.0, 0.5, 0.0), 0.2, "grey"), 0.4, 2.8, 0.4),
    "thin rod": (cylinder((0.0, -0.5, 0.0), (0.0, 0.5, 0.0), 0.008, "grey"), 0.016, 2.032, 0.45),
    "end of a rod": (cylinder((-0.5, 0.0, 0.0), (0.5, 0.0, 0.0), 0.4, "grey"), np.pi * 0.16, 2.51, 0.6),
    "wedge": (prism(CORNERS, (-0.5, 0.0, 0.0), (0.5, 0.0, 0.0), "grey"), 0.5, 3.41, 0.7),
}
"""Solids that reach from -0.5 to 0.5 along x: area and length of the outline from there, and by how much the
outline may be off on average (pixels of 0.005). Rows of cells end in steps at slanted edges."""


@pytest.mark.parametrize("name", SOLIDS)
def test_outlines_enclose_the_area_of_the_solid_without_holes(name: str):
    solid, area, outline, allowed = SOLIDS[name]
    alpha = see(lay_gaussians(of(solid)), (-1.0, 0.0, 0.0)).alpha[0].numpy()
    pixel = 1.5 / len(alpha)
    assert abs(alpha.sum() * pixel**2 - area) < allowed * pixel * outline
    inside = binary_erosion(alpha > 0.5, iterations=4)
    assert alpha[inside].min(initial=1.0) > 0.98


@pytest.mark.parametrize("opacity", [0.1, 0.3, 0.6, 0.9, 1.0])
@pytest.mark.parametrize("behind", [0.0, 1.0])
def test_panes_show_black_and_white_through_them_as_their_finish_says(opacity: float, behind: float):
    """Even light on upright surface is 0.85 x 1.25 x 0.85, of which corners leave `OPENNESS`."""
    pane = of(box((-0.01, -0.5, -0.5), (0.01, 0.5, 0.5), "grey"), opacity=opacity)
    light = 0.85 * 1.25 * 0.85 * OPENNESS * linear_from_srgb(np.array(0.5))
    shown = see(lay_gaussians(pane), (-1.0, 0.0, 0.0), behind).color[0, 75:225, 75:225].numpy()
    wanted = srgb_from_linear(opacity * light + (1 - opacity) * behind)
    assert abs(shown.mean() - wanted) < 0.02
    assert np.ptp(shown) < 0.05


@pytest.mark.parametrize("angle", [1.0, 2.5, 3.0, 10.0])
def test_edges_that_are_not_square_end_in_fine_steps(angle: float):
    """From 2.6 degrees on, the cosine at which edges no longer count as parallel."""
    lean = np.tan(np.radians(angle))
    corners = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5 - lean, 0.5], [-0.5, 0.5]])
    slab = prism(corners, (-0.1, 0.0, 0.0), (0.1, 0.0, 0.0), "grey")
    discs = lay_gaussians(of(slab))
    front = discs.scales[np.abs(matrix_from_quat(discs.quats)[:, 0, 2]) > 0.999]
    rows = front[:, :2].max() / np.median(front[:, 1])
    assert (rows > 2) == (angle > np.degrees(np.arccos(SQUARE)))


@pytest.mark.parametrize(("around", "count"), [(14.0, 16), (20.0, 20)])
def test_a_rod_is_round_however_thin(around: float, count: int):
    """As many discs around it as its spacing allows, and at least sixteen."""
    radius = around * 0.05 / (2.0 * np.pi)
    rod = of(cylinder((0.0, 0.0, -0.5), (0.0, 0.0, 0.5), radius, "grey"))
    means = lay_gaussians(rod, 0.05).means
    side = means[np.isclose(np.linalg.norm(means[:, :2], axis=1), np.linalg.norm(means[:, :2], axis=1).max())]
    assert len(np.unique(np.round(np.arctan2(side[:, 1], side[:, 0]), 3) + 0.0)) == count


def test_the_unit_of_length_does_not_matter():
    def scaled(by: float) -> Shape:
        return of(
            box((0.0, 0.0, 0.0), (by, 0.4 * by, 0.3 * by), "grey"),
            cylinder((0.5 * by, 0.2 * by, 0.3 * by), (0.5 * by, 0.2 * by, 0.7 * by), 0.05 * by, "grey"),
        )

    one, two = lay_gaussians(scaled(1.0)), lay_gaussians(scaled(2.0))
    np.testing.assert_allclose(one.means, two.means, atol=1e-6)
    np.testing.assert_allclose(one.scales, two.scales, rtol=1e-5)


def test_surface_within_other_primitives_has_no_discs():
    low, high = box((0.0, 0.0, 0.0), (1.0, 1.0, 0.5), "grey"), box((0.0, 0.0, 0.5), (1.0, 1.0, 1.0), "grey")
    means = lay_gaussians(of(low, high)).means
    assert np.abs(means).max(axis=1).min() > 0.5 - 1e-6


def test_a_spacing_of_nothing_is_refused(oven: Shape):
    with pytest.raises(ValueError, match="expected above 0"):
        lay_gaussians(oven, 0.0)
