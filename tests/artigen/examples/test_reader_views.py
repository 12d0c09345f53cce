"""Marks of rendered views: where they say a part is, its pixels are."""

import numpy as np
import pytest

from artigen.camera import look_at
from artigen.examples.reader_views import NOTHING, PART, project_front, sort_corners, take_views
from artigen.examples.view_shards import pack_views
from artigen.reader.labels import FRONT, HINGES, UNKNOWN
from artigen.shapes.fittings.hardware import slide
from artigen.shapes.primitives import box
from artigen.shapes.shape import ShapePart
from artigen.types import Joint

LEAF = box((-0.02, -0.3, 0.1), (0.0, 0.3, 1.1), "paint")
CAMERA = look_at(np.array([-4.0, 0.3, 0.9]), np.array([0.0, 0.0, 0.6]), fov=40.0)


@pytest.fixture(scope="module")
def views():
    return take_views(3, 3)


@pytest.mark.parametrize(
    ("axis", "origin", "side"),
    [
        ((0.0, 0.0, 1.0), (-0.02, 0.3, 0.0), "left"),
        ((0.0, 0.0, -1.0), (-0.02, -0.3, 0.0), "right"),
        ((0.0, 1.0, 0.0), (-0.02, 0.0, 0.1), "bottom"),
        ((0.0, -1.0, 0.0), (-0.02, 0.0, 1.1), "top"),
    ],
)
def test_hinges_are_on_the_side_of_the_axis_closed_and_open(axis, origin, side):
    motion = Joint(type="revolute", axis=np.array(axis), origin=np.array(origin), upper=1.5)
    part = ShapePart("leaf", "door", [LEAF], motion)
    _, hinge = project_front(part, np.eye(4), CAMERA)
    assert HINGES[hinge] == side


def test_corners_are_those_of_the_face_in_front():
    part = ShapePart("front", "drawer", [LEAF], slide(0.3))
    corners, hinge = project_front(part, np.eye(4), CAMERA)
    assert hinge == UNKNOWN
    # From the front, y points to the left: the upper left corner is that of the largest y and z.
    from artigen.camera import project_points

    face = np.array([[-0.02, 0.3, 1.1], [-0.02, -0.3, 1.1], [-0.02, -0.3, 0.1], [-0.02, 0.3, 0.1]])
    np.testing.assert_allclose(corners, project_points(CAMERA, face)[:, :2], atol=1e-9)


def test_corners_are_sorted_whatever_their_order():
    square = np.array([[0.0, 0.0], [3.0, 0.2], [3.1, 2.0], [0.1, 2.1]])
    for order in ([0, 1, 2, 3], [2, 3, 0, 1], [3, 2, 1, 0], [1, 0, 3, 2]):
        np.testing.assert_array_equal(sort_corners(square[order]), square)


def test_parts_are_seen_where_their_corners_say(views):
    checked = 0
    for view in views:
        for index in np.flatnonzero((view.parts["thing"] == FRONT) & (view.parts["open"] == 0)):
            rows, columns = np.nonzero(view.ids == index)
            if len(rows) < 50:
                continue
            low, high = view.parts["corners"][index].min(axis=0), view.parts["corners"][index].max(axis=0)
            deep = 0.15 * (high - low).max() + 3  # a front has a thickness, which is seen from the side
            assert (columns > low[0] - deep).all()
            assert (columns < high[0] + deep).all()
            assert (rows > low[1] - deep).all()
            assert (rows < high[1] + deep).all()
            checked += 1
    assert checked > 0


def test_every_pixel_names_a_part_and_every_part_an_object(views):
    for view in views:
        assert view.ids[view.ids != NOTHING].max() < len(view.parts)
        assert view.parts["object"].max() < len(view.bodies)
        assert ((view.rgba[..., 3] > 0) == (view.ids != NOTHING)).mean() > 0.97


def test_views_are_a_function_of_their_seed(views):
    again = take_views(3, 1)[0]
    np.testing.assert_array_equal(again.rgba, views[0].rgba)
    np.testing.assert_array_equal(again.ids, views[0].ids)
    assert again.parts.tobytes() == views[0].parts.tobytes()


def test_packing_loses_nothing(views, tmp_path):
    from artigen.examples.view_shards import read_views

    np.savez(tmp_path / "shard.npz", **pack_views(views))
    for packed, view in zip(read_views(tmp_path / "shard.npz"), views, strict=True):
        found = packed.unpack()
        np.testing.assert_array_equal(found.rgba, view.rgba)
        np.testing.assert_array_equal(found.ids, view.ids)
        assert found.parts.dtype == PART
        assert found.parts.tobytes() == view.parts.tobytes()
        assert found.bodies.tobytes() == view.bodies.tobytes()
