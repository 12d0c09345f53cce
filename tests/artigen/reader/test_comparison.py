"""An object lies over the photograph it was built from, and the page shows both."""

import html
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from artigen.camera import project_points
from artigen.reader.comparison import draw_over, scale_camera, straighten, write_comparison
from artigen.reader.layout.frontal import read_shape
from artigen.reader.layout.overlay import MET, lay_over, match_fronts
from artigen.reader.open_reading import parse_reading
from artigen.reader.reading import Reading
from artigen.shapes.draw import draw_shape
from artigen.shapes.shape import Shape


def see(
    kind: str = "StorageFurniture", view: tuple[float, float, float] = (0.4, 0.25, 0.25)
) -> tuple[Reading, Shape]:
    """An object, and what is read of it in the lower right of a picture."""
    shape = draw_shape(kind, 3)
    reading = read_shape(shape, view=view)
    parts = tuple(replace(part, box=0.5 + 0.45 * part.box) for part in reading.parts)
    wide, high = (round(0.4 * side) for side in reading.extent)
    return replace(reading, parts=parts, box=0.5 + 0.45 * reading.box, extent=(wide, high)), shape


@pytest.mark.parametrize("kind", ["StorageFurniture", "Refrigerator", "Dresser"])
def test_an_object_lies_over_itself(kind: str):
    reading, shape = see(kind)
    overlay = lay_over(reading, shape)
    assert overlay.good
    assert min(overlay.met) > 0.8


def test_a_view_that_was_misread_is_found_by_the_fronts():
    reading, shape = see()
    turned = lay_over(replace(reading, view=(0.1, 0.1, 0.25)), shape)
    assert min(turned.met) > 0.7


def test_a_front_that_the_object_lacks_is_not_met():
    reading, shape = see("Refrigerator")
    extra = replace(reading.fronts[0], label="drawer")
    overlay = lay_over(replace(reading, parts=(*reading.parts, extra)), shape)
    assert not overlay.good
    assert min(overlay.met) < MET


def test_fronts_are_matched_once_and_by_label():
    box, other = np.array([0, 0, 1, 1.0]), np.array([0, 0, 1, 0.9])
    assert match_fronts([("door", box), ("door", other)], [("door", other)]) == [(1, 0)]
    assert match_fronts([("door", box)], [("drawer", box)]) == []


def test_a_straight_camera_sees_the_same_elsewhere():
    reading, shape = see()
    camera = lay_over(reading, shape).camera
    straight, (left, top) = straighten(camera)
    points = np.array([(-0.2, 0.3, 0.4), (0.1, -0.4, 0.9)])
    moved = project_points(straight, points)[:, :2] - (left, top)
    np.testing.assert_allclose(moved, project_points(camera, points)[:, :2], atol=1.0)
    np.testing.assert_allclose(straight.axes @ straight.axes.T, np.eye(3), atol=1e-9)
    half = project_points(scale_camera(camera, (camera.width // 2, camera.height // 2)), points)
    np.testing.assert_allclose(2 * half[:, :2], project_points(camera, points)[:, :2], atol=2.0)


def test_the_page_shows_the_object_within_its_box(tmp_path: Path):
    reading, shape = see()
    photo = Image.new("RGBA", reading.extent, (255, 0, 0, 255))
    overlay = write_comparison(tmp_path / "sub" / "page.html", photo, reading, shape, ["a <note>"])
    page = (tmp_path / "sub" / "page.html").read_text()
    assert page.count("data:image/jpeg;base64,") == 3
    assert page.count("<tr><td>") == len(reading.fronts)
    assert "a &lt;note&gt;" in page
    held = html.unescape(page.split("<textarea")[1].split(">", 1)[1].split("</textarea>")[0])
    assert parse_reading(json.loads(held)).to_json() == reading.to_json()
    shown = np.asarray(draw_over(photo, overlay.camera, shape), dtype=float)
    pale = np.abs(shown - shown[0, 0]).max(axis=2) < 2
    rows, columns = np.nonzero(~pale)
    box = np.array([columns.min(), rows.min(), columns.max() + 1, rows.max() + 1])
    box = box / np.tile(reading.extent, 2)
    np.testing.assert_allclose(box, reading.box, atol=0.04)
