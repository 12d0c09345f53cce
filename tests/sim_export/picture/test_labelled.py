"""Labels of rendered pictures agree with the geometry, and with COCO's own tools."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from sample_packages import SAMPLE_PARTS, build_package

from artigen.api.render import RenderSettings, render_labelled
from artigen.camera import Camera, look_at, project_points
from artigen.errors import ArtigenError
from sim_export.files.write import write_package
from sim_export.motion.kinematics import link_displacements, needed_fractions
from sim_export.motion.states import sample_state
from sim_export.picture import labelled
from sim_export.picture.coco import run_lengths
from sim_export.picture.image import render_package

PACKAGE = build_package(SAMPLE_PARTS)
CAMERA = look_at(np.array([-2.0, 0.7, 0.9]), np.zeros(3), fov=40.0, width=120, height=100)
Q = {"joint_0": 0.2}


@pytest.fixture(scope="module")
def picture() -> labelled.LabelledImage:
    return labelled.render_labelled(PACKAGE, CAMERA, Q)


def decode_runs(counts, height: int, width: int) -> np.ndarray:
    """The mask of `run_lengths`."""
    return np.repeat(np.arange(len(counts)) % 2 == 1, counts).reshape((height, width), order="F")


def test_the_picture_is_that_of_the_renderer_and_labels_cover_the_object(picture):
    np.testing.assert_array_equal(picture.image, render_package(PACKAGE, CAMERA, Q))
    assert ((picture.parts >= 0) == (picture.depth > 0.0)).all()
    assert {part.label for part in picture.shown} >= {"door", "drawer", "handle"}


def test_depth_and_intrinsics_give_points_on_the_part_that_the_pixel_names(picture):
    """Every seen point lies in the box around its part, moved as its link."""
    T = link_displacements(PACKAGE.links, PACKAGE.joints, Q)
    rows, columns = np.nonzero(picture.parts >= 0)
    rays = np.linalg.solve(picture.intrinsics, np.stack([columns + 0.5, rows + 0.5, np.ones(len(rows))]))
    seen = rays.T * picture.depth[rows, columns][:, None]
    T_object_camera = np.linalg.inv(picture.T_camera_object)
    points = seen @ T_object_camera[:3, :3].T + T_object_camera[:3, 3]
    slots = {link.name: index for index, link in enumerate(PACKAGE.links)}
    for index, part in enumerate(picture.shown):
        own = points[picture.parts[rows, columns] == index]
        link = PACKAGE.links[slots[part.link]]
        corners = np.concatenate([v.mesh.vertices for v in link.visuals if v.part == part.name])
        rest = (own - T[slots[part.link]][:3, 3]) @ T[slots[part.link]][:3, :3]
        assert (rest > corners.min(axis=0) - 1e-3).all()
        assert (rest < corners.max(axis=0) + 1e-3).all()


def test_amodal_boxes_contain_what_is_seen_of_a_part(picture):
    for index, part in enumerate(picture.shown):
        rows, columns = np.nonzero(picture.parts == index)
        left, top, right, bottom = part.amodal
        if len(rows):
            assert left - 0.5 <= columns.min() + 0.5
            assert columns.max() + 0.5 <= right + 0.5
            assert top - 0.5 <= rows.min() + 0.5
            assert rows.max() + 0.5 <= bottom + 0.5


def test_a_joint_s_axis_in_the_camera_moves_its_part_as_the_object_s(picture):
    (drawer,) = (joint for joint in picture.joints if joint.name == "joint_0")
    assert drawer.q == Q["joint_0"]
    specs = {joint.name: joint for joint in PACKAGE.joints}
    axis = picture.T_camera_object[:3, :3] @ specs["joint_0"].axis
    np.testing.assert_allclose(drawer.axis, axis, atol=1e-12)
    pixel = picture.intrinsics @ (drawer.origin / drawer.origin[2])
    expected = project_points(CAMERA, specs["joint_0"].origin[None])[0]
    np.testing.assert_allclose(pixel[:2], expected[:2], atol=1e-9)


def test_a_skewed_camera_has_no_intrinsics():
    axes = CAMERA.axes.copy()
    axes[0] += 0.1 * axes[1]
    skewed = Camera(position=CAMERA.position, axes=axes, pixel=CAMERA.pixel, width=10, height=10)
    with pytest.raises(ValueError, match="not orthogonal"):
        labelled.render_labelled(PACKAGE, skewed)


@given(arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9))))
def test_run_lengths_are_those_of_coco(mask: np.ndarray):
    counts = run_lengths(mask)
    np.testing.assert_array_equal(decode_runs(counts, *mask.shape), mask)
    assert sum(counts) == mask.size
    assert all(count > 0 for count in counts[1:])


def test_states_never_move_what_needs_another_joint_open():
    moved = set()
    for seed in range(60):
        q = sample_state(PACKAGE, np.random.default_rng(seed))
        for joint in PACKAGE.joints:
            if joint.name not in q:
                continue
            assert joint.lower <= q[joint.name] <= joint.upper
            if q[joint.name] > 0.0:
                moved.add(joint.name)
                for other, share in needed_fractions(joint.name, PACKAGE.requires_open).items():
                    (leader,) = (each for each in PACKAGE.joints if each.name == other)
                    assert q[other] >= leader.lower + share * (leader.upper - leader.lower) - 1e-9
    assert len(moved) > 1


def test_a_data_set_names_every_file_and_is_not_overwritten(tmp_path: Path):
    folder = write_package(PACKAGE, tmp_path / "cabinet")
    cfg = RenderSettings(states=2, views=1, size=48)
    paths = list(render_labelled([folder], tmp_path / "out", cfg))
    value = json.loads((tmp_path / "out" / "coco.json").read_text())
    assert len(paths) == len(value["images"]) == 2
    for image in value["images"]:
        assert all(
            (tmp_path / "out" / image[key]).is_file() for key in ("file_name", "depth_name", "parts_name")
        )
    ids = {image["id"] for image in value["images"]}
    assert {annotation["image_id"] for annotation in value["annotations"]} == ids
    for annotation in value["annotations"]:
        size, counts = annotation["segmentation"]["size"], annotation["segmentation"]["counts"]
        mask = decode_runs(counts, *size)
        rows, columns = np.nonzero(mask)
        assert mask.sum() == annotation["area"]
        assert annotation["bbox"] == [
            columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1,
        ]  # fmt: skip
    with pytest.raises(ArtigenError, match="exists already"):
        list(render_labelled([folder], tmp_path / "out", cfg))
    with pytest.raises(ArtigenError, match="0 states"):
        RenderSettings(states=0)
