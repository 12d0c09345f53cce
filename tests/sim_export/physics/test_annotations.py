"""Handles: their boxes, normals, clearance and motion, on the cabinet however it is turned."""

from dataclasses import replace

import numpy as np
import pytest
from box_cabinet import SCALE, box_geometry, scaled

from artigen.kinematics import displacements
from artigen.transforms import rotation_about
from artigen.types import Asset, Joint
from sim_export.geometry.hulls import box_hull
from sim_export.geometry.rays import ray_hits
from sim_export.package import HandleAnnotation, Mesh
from sim_export.physics.annotations import annotate_handles, joint_velocity
from sim_export.physics.inertia import mesh_inertial
from sim_export.physics.links import LinkTree, PartGeometry, build_links


def turned(asset: Asset, meshes: list[Mesh], R: np.ndarray) -> tuple[Asset, list[Mesh]]:
    """The whole object turned about the origin; part boxes are left, nothing here reads them."""
    parts = tuple(
        replace(part, joint=replace(part.joint, axis=R @ part.joint.axis, origin=R @ part.joint.origin))
        for part in asset.parts
    )
    moved = [replace(mesh, vertices=mesh.vertices @ R.T) for mesh in meshes]
    return replace(asset, parts=parts, voxels=None, surface=None), moved


def annotate(asset: Asset, meshes: list[Mesh]) -> dict[str, HandleAnnotation]:
    inertial = mesh_inertial(box_hull(np.zeros(3), np.ones(3)), 10.0)
    tree = build_links(asset, [PartGeometry(visuals=(mesh,), inertial=inertial) for mesh in meshes])
    return {handle.part: handle for handle in annotate_handles(asset, meshes, tree)}


@pytest.fixture(scope="module")
def meshes() -> list[Mesh]:
    return [geometry.visuals[0] for geometry in box_geometry()]


@pytest.fixture(scope="module")
def handles(cabinet, meshes) -> dict[str, HandleAnnotation]:
    return annotate(scaled(cabinet), meshes)


def test_every_handle_and_knob_that_moves_is_annotated(handles):
    assert {name: (handle.link, handle.gapart) for name, handle in handles.items()} == {
        "drawer_handle": ("link_0", "line_fixed_handle"),
        "door_handle": ("link_1", "line_fixed_handle"),
        "lock": ("link_2", "hinge_knob"),
    }


def test_boxes_are_those_of_the_meshes(cabinet, meshes, handles):
    for index, part in enumerate(cabinet.parts):
        if part.name not in handles:
            continue
        corners, vertices = handles[part.name].corners, meshes[index].vertices
        assert len(np.unique(np.round(corners, 9), axis=0)) == 8
        np.testing.assert_allclose(corners.min(axis=0), vertices.min(axis=0), atol=1e-12)
        np.testing.assert_allclose(corners.max(axis=0), vertices.max(axis=0), atol=1e-12)


def test_measures_are_those_of_the_cabinet(handles):
    for handle in handles.values():
        np.testing.assert_allclose(handle.normal, [-1.0, 0.0, 0.0], atol=1e-12)
    bar, upright, lock = (handles[name] for name in ("drawer_handle", "door_handle", "lock"))
    # Bars are 20 mm wide and stand 35 mm off their panels, the lock is 50 mm wide on its plate.
    assert [round(handle.width / SCALE, 6) for handle in (bar, upright, lock)] == [0.02, 0.02, 0.05]
    assert [round(handle.clearance / SCALE, 6) for handle in (bar, upright, lock)] == [0.035, 0.035, 0.0]
    for handle, along in ((bar, 1), (upright, 2)):
        line = handle.grasp_line
        direction = np.abs(line[1] - line[0])
        assert direction[along] > 0.15 * SCALE
        assert np.delete(direction, along).max() < 1e-12
        # The middle of the bar is 0.2925 m before the middle of the sample, which is at x = -0.025.
        np.testing.assert_allclose(line[:, 0], (-0.2925 + 0.025) * SCALE, atol=1e-9)


def test_handles_open_along_their_annotated_direction(cabinet, handles):
    asset = scaled(cabinet)
    step = 1e-5
    moving = [index for index, part in enumerate(asset.parts) if part.joint.type != "fixed"]
    index = {part.name: k for k, part in enumerate(asset.parts)}
    for name, leader in (("drawer_handle", "drawer"), ("door_handle", "door"), ("lock", "lock")):
        qpos = np.where(np.array(moving) == index[leader], step, 0.0)
        T = displacements(asset, qpos)[index[leader]]
        handle = handles[name]
        point = handle.grasp_line[1] if name == "lock" else handle.corners.mean(axis=0)
        start = point / SCALE
        moved = T[:3, :3] @ start + T[:3, 3] - start
        np.testing.assert_allclose(moved / np.linalg.norm(moved), handle.opening_direction, atol=1e-4)


@pytest.mark.parametrize(
    ("axis", "angle"),
    [
        ((0.0, 0.0, 1.0), np.pi / 2),
        ((0.0, 0.0, 1.0), 0.6),
        ((0.48, 0.6, 0.64), 1.1),
        ((1.0, 0.0, 0.0), np.pi),
    ],
)
def test_annotations_turn_with_the_object(cabinet, meshes, handles, axis, angle):
    R = rotation_about(np.array(axis), np.array(angle))
    found = annotate(*turned(scaled(cabinet), meshes, R))
    assert found.keys() == handles.keys()
    for name, handle in found.items():
        before = handles[name]
        np.testing.assert_allclose(handle.normal, R @ before.normal, atol=1e-6)
        assert handle.width == pytest.approx(before.width, abs=1e-6)
        assert handle.clearance == pytest.approx(before.clearance, abs=1e-5)
        assert handle.gapart == before.gapart
        turned_corners = before.corners @ R.T
        distances = np.linalg.norm(handle.corners[:, None] - turned_corners[None], axis=2)
        assert distances.min(axis=1).max() < 1e-6
        if name != "lock":  # a square knob may be grasped along either side
            np.testing.assert_allclose(handle.opening_direction, R @ before.opening_direction, atol=1e-6)
            line = before.grasp_line @ R.T
            gap = min(np.abs(handle.grasp_line - line).max(), np.abs(handle.grasp_line - line[::-1]).max())
            assert gap < 1e-5


def test_handles_on_the_body_are_left_out(cabinet, meshes):
    asset = scaled(cabinet)
    parts = tuple(replace(part, parent=0) if part.name == "door_handle" else part for part in asset.parts)
    assert "door_handle" not in annotate(replace(asset, parts=parts), meshes)


def test_something_behind_a_handle_takes_its_clearance(cabinet, meshes, handles):
    center = handles["drawer_handle"].corners.mean(axis=0)
    wall = box_hull(center + np.array([0.005, -0.3, -0.05]), center + np.array([0.006, 0.3, 0.05]))
    door = Mesh(
        vertices=np.concatenate([meshes[4].vertices, wall.vertices]),
        faces=np.concatenate([meshes[4].faces, wall.faces + len(meshes[4].vertices)]),
    )
    blocked = annotate(scaled(cabinet), [*meshes[:4], door, *meshes[5:]])["drawer_handle"]
    assert blocked.clearance < handles["drawer_handle"].clearance - 0.005
    np.testing.assert_allclose(blocked.normal, handles["drawer_handle"].normal)


LOCK = 6


def test_a_telescopic_handle_is_annotated_at_its_grip(cabinet, meshes):
    """Two rods and a bar before the door slide up together; the middle between them is empty."""
    asset = scaled(cabinet)
    index = next(k for k, part in enumerate(asset.parts) if part.name == "door_handle")
    leaf = meshes[asset.parts[index].parent].vertices
    x, (y0, y1), z = leaf[:, 0].min() - 0.03, (leaf[:, 1].min(), leaf[:, 1].max()), leaf[:, 2].max() - 0.1
    bars = [box_hull(np.array([x - 0.01, y, z - 0.2]), np.array([x, y + 0.01, z])) for y in (y0, y1 - 0.01)]
    bars.append(box_hull(np.array([x - 0.01, y0, z]), np.array([x, y1, z + 0.02])))
    rods = Mesh(
        vertices=np.concatenate([bar.vertices for bar in bars]),
        faces=np.concatenate([bar.faces + 8 * k for k, bar in enumerate(bars)]),
    )
    slide = replace(
        asset.parts[LOCK].joint, type="prismatic", axis=np.array([0.0, 0.0, 1.0]), lower=0.0, upper=0.2
    )
    parts = [*asset.parts]
    parts[index] = replace(parts[index], joint=slide)
    shapes = [*meshes[:index], rods, *meshes[index + 1 :]]
    found = annotate(replace(asset, parts=tuple(parts)), shapes)["door_handle"]
    np.testing.assert_allclose(found.corners.min(axis=0), [x - 0.01, y0, z], atol=1e-9)
    np.testing.assert_allclose(found.corners.max(axis=0), [x, y1, z + 0.02], atol=1e-9)
    np.testing.assert_allclose(found.grasp_line[:, 2], z + 0.01, atol=1e-9)
    np.testing.assert_allclose(found.opening_direction, [0.0, 0.0, 1.0], atol=1e-12)
    assert found.clearance == pytest.approx(0.03, abs=1e-6)


def through_lock(meshes: list[Mesh], door: int, out: float) -> list[Mesh]:
    """The cabinet with a lock that passes through its door and stands out behind it, in metres."""
    lock, leaf = meshes[LOCK].vertices, meshes[door].vertices
    low, high = lock.min(axis=0), lock.max(axis=0)
    bolt = box_hull(low, np.array([leaf[:, 0].max() + out, *high[1:]]))
    mesh = Mesh(vertices=bolt.vertices, faces=bolt.faces)
    return [*meshes[:LOCK], mesh, *meshes[LOCK + 1 :]]


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_of_a_handle_on_both_sides_the_one_to_pull_is_annotated(cabinet, meshes, handles, way):
    asset = scaled(cabinet)
    door = asset.parts[LOCK].parent
    joint = asset.parts[door].joint
    parts = [*asset.parts]
    parts[door] = replace(parts[door], joint=replace(joint, axis=way * joint.axis))
    found = annotate(replace(asset, parts=tuple(parts)), through_lock(meshes, door, 0.03))["lock"]
    np.testing.assert_allclose(found.normal, [-way, 0.0, 0.0], atol=1e-12)
    front = handles["lock"].corners[:, 0]
    back = meshes[door].vertices[:, 0].max()
    low, high = (front.min(), front.max()) if way > 0.0 else (back, back + 0.03)
    np.testing.assert_allclose([found.corners[:, 0].min(), found.corners[:, 0].max()], [low, high], atol=1e-9)


@pytest.mark.parametrize(("out", "cut"), [(0.0099, False), (0.0101, True)])
def test_an_end_within_a_centimetre_behind_the_carrier_is_no_second_side(cabinet, meshes, handles, out, cut):
    asset = scaled(cabinet)
    through = through_lock(meshes, asset.parts[LOCK].parent, out)
    found = annotate(asset, through)["lock"]
    assert (np.ptp(found.corners[:, 0]) < np.ptp(handles["lock"].corners[:, 0]) + 1e-9) == cut


def test_kinds_follow_the_joint(cabinet, meshes):
    asset = scaled(cabinet)
    sliding = replace(asset.parts[6].joint, type="prismatic", upper=0.01)
    parts = [*asset.parts]
    parts[6] = replace(parts[6], joint=sliding)
    parts[5] = replace(parts[5], joint=asset.parts[6].joint)
    found = annotate(replace(asset, parts=tuple(parts)), meshes)
    assert (found["lock"].gapart, found["door_handle"].gapart) == ("slider_button", "hinge_handle")


def test_rays_hit_boxes_where_they_should():
    box = box_hull(np.zeros(3), np.ones(3))
    origins = np.array([[0.3, 0.6, 2.0], [0.3, 1.6, 2.0], [0.3, 0.6, 0.5]])
    distances, sides = ray_hits(origins, np.array([0.0, 0.0, -1.0]), box.vertices[box.faces])
    hits = [
        sorted(zip(row[np.isfinite(row)].tolist(), sides[np.isfinite(row)].tolist(), strict=True))
        for row in distances
    ]
    assert hits == [[(1.0, -1.0), (2.0, 1.0)], [], [(0.5, 1.0)]]


def test_an_object_without_handles_has_none(cabinet, meshes):
    asset = replace(scaled(cabinet), parts=cabinet.parts[:2], voxels=None, surface=None)
    assert annotate(asset, meshes[:2]) == {}
    assert annotate_handles(asset, meshes[:2], LinkTree(links=(), joints=())) == ()


def test_what_slides_moves_along_its_axis_whether_it_leads_or_follows_and_a_screw_turns():
    up, beside = np.array([0.0, 0.0, 1.0]), np.array([0.1, 0.0, 0.5])
    slide = Joint(type="prismatic", axis=up, upper=0.1)
    for joint in (slide, replace(slide, follows="pedal", ratio=2.0)):
        np.testing.assert_array_equal(joint_velocity(joint, np.zeros(3)), up)
    travel = replace(slide, follows="turn", ratio=0.01, of_screw=True)
    np.testing.assert_allclose(joint_velocity(travel, beside), [0.0, 0.1, 0.0])
