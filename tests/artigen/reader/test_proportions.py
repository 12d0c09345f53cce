"""A cuboid's outline and the ends of its front tell its proportions."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image, ImageDraw
from scipy.spatial import ConvexHull

from artigen.camera import project_points
from artigen.reader.layout.frontal import place_camera, read_shape
from artigen.reader.looks import measure_outline
from artigen.reader.proportions import fit_outline
from artigen.shapes.draw import draw_shape

EDGE = 256


def see(size: tuple[float, float, float], view: tuple[float, float, float]):
    """The outline of a cuboid (width, depth, height), and the ends of its front as shares of the width."""
    width, depth, height = size
    half = np.array([depth, width, height]) / 2
    camera = place_camera(-half, half, view)
    signs = np.stack(np.meshgrid(*[(-1.0, 1.0)] * 3), axis=-1).reshape(-1, 3)
    points = project_points(camera, np.concatenate([signs, [(-1.0, 1.0, 0.0), (-1.0, -1.0, 0.0)]]) * half)[
        :, :2
    ]
    low, high = points.min(axis=0), points.max(axis=0)
    points = 20 + (points - low) / (high - low).max() * (EDGE - 40)
    picture = Image.new("1", (EDGE, EDGE))
    hull = points[:8][ConvexHull(points[:8]).vertices]
    ImageDraw.Draw(picture).polygon([tuple(point) for point in hull], fill=1)
    return np.asarray(picture), (float(points[8, 0] / EDGE), float(points[9, 0] / EDGE))


def ratios(size: tuple[float, float, float]) -> np.ndarray:
    return np.log(np.array(size)) - np.mean(np.log(size))


@pytest.mark.parametrize("yaw", [-0.5, 0.0, 0.35])
@pytest.mark.parametrize("size", [(0.6, 0.5, 1.0), (1.2, 0.4, 0.7)])
def test_lengths_that_were_read_wrongly_come_nearer(size: tuple[float, float, float], yaw: float):
    outline, ends = see(size, (yaw, 0.15, 0.3))
    wrong = (1.25 * size[0], size[1], 0.85 * size[2])
    found, view = fit_outline(outline, wrong, (0.0, 0.12, 0.3), ends)
    before, after = (np.abs(ratios(one) - ratios(size)) for one in (wrong, found))
    assert after.max() < 0.5 * before.max()
    assert abs(view[0] - yaw) < 0.15
    assert np.prod(found) == pytest.approx(np.prod(wrong))


def test_a_right_reading_stays():
    size, view = (0.8, 0.5, 0.9), (0.3, 0.15, 0.3)
    outline, ends = see(size, view)
    np.testing.assert_allclose(fit_outline(outline, size, view, ends)[0], size, rtol=0.04)


@pytest.mark.parametrize(("factor", "measured"), [(1.2, True), (2.6, False)])
def test_an_outline_far_from_what_was_read_is_not_believed(factor: float, *, measured: bool):
    outline, ends = see((0.6, 0.5, 1.0), (0.3, 0.15, 0.3))
    reading = read_shape(draw_shape("Refrigerator", 0))
    front = replace(reading.fronts[0], box=np.array([ends[0], 0.2, ends[1], 0.8]))
    seen = replace(reading, parts=(front,), size=(0.6 * factor, 0.5, 1.0), view=(0.3, 0.15, 0.3))
    found = measure_outline(seen, outline)
    assert found.measured is measured
    assert (found.size == seen.size) is not measured
