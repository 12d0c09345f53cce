"""Laws of the kinematic tree: order, composition, and agreement with an independent URDF library."""

import io
from dataclasses import replace

import numpy as np
import pytest

from artigen.kinematics import (
    articulate_gaussians,
    articulate_points,
    displacements,
    movable_parts,
    parents_first,
    qlimits,
)
from artigen.transforms import inverse, joint_motion, matrix_from_quat, transform_points
from artigen.types import FIXED, Asset, Gaussians, Joint, Part

X, Y, Z = np.eye(3)


def make_part(name: str, parent: int, joint: Joint) -> Part:
    return Part(
        name=name, label="base" if parent == -1 else "door", parent=parent, joint=joint, box=np.zeros((2, 3))
    )


@pytest.fixture(scope="module")
def arm() -> Asset:
    """A planar arm of two unit links, then a slider along the second; listed leaf first."""
    parts = (
        make_part("slider", 1, Joint(type="prismatic", axis=X, origin=np.zeros(3), upper=1.0)),
        make_part("fore", 2, Joint(type="revolute", axis=Z, origin=X, upper=3.0)),
        make_part("upper", 3, Joint(type="revolute", axis=Z, origin=np.zeros(3), upper=3.0)),
        make_part("base", -1, FIXED),
    )
    return Asset(name="arm", category="Arm", scale=1.0, parts=parts)


def random_qpos(asset: Asset, seed: int) -> np.ndarray:
    limits = qlimits(asset)
    return np.random.default_rng(seed).uniform(limits[:, 0], limits[:, 1])


def test_every_parent_comes_before_its_children(cabinet, arm):
    for asset in (cabinet, arm):
        order = parents_first([part.parent for part in asset.parts])
        assert sorted(order) == list(range(len(asset.parts)))
        place = {index: at for at, index in enumerate(order)}
        assert all(place[part.parent] < place[i] for i, part in enumerate(asset.parts) if part.parent != -1)


def test_movable_parts_and_limits_go_together(cabinet):
    movable = movable_parts(cabinet)
    assert [cabinet.parts[index].name for index in movable] == ["drawer", "door", "lock", "tray"]
    uppers = [cabinet.parts[index].joint.upper for index in movable]
    np.testing.assert_array_equal(qlimits(cabinet), np.stack([np.zeros(4), uppers], axis=1))


def test_planar_arm_in_closed_form(arm):
    travel, elbow, shoulder = 0.4, 0.9, 0.5
    tip = articulate_points(arm, np.array([travel, elbow, shoulder]), 2 * X[None], np.array([0]))[0]
    reach = 1 + travel
    both = shoulder + elbow
    expected = [np.cos(shoulder) + reach * np.cos(both), np.sin(shoulder) + reach * np.sin(both), 0.0]
    np.testing.assert_allclose(tip, expected, atol=1e-12)


def test_rest_is_the_identity(cabinet):
    D = displacements(cabinet, np.zeros(4))
    np.testing.assert_allclose(D, np.broadcast_to(np.eye(4), D.shape), atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_a_part_moves_with_its_parent_and_by_its_own_joint(cabinet, seed):
    qpos = random_qpos(cabinet, seed)
    D = displacements(cabinet, qpos)
    q_of = dict(zip(movable_parts(cabinet), qpos, strict=True))
    for index, part in enumerate(cabinet.parts):
        above = np.eye(4) if part.parent == -1 else D[part.parent]
        own = joint_motion(part.joint, np.array(q_of.get(index, 0.0)))
        np.testing.assert_allclose(D[index], above @ own, atol=1e-12)
    lock, door = (next(i for i, p in enumerate(cabinet.parts) if p.name == name) for name in ("lock", "door"))
    relative = inverse(D[door]) @ D[lock]
    axis_point = cabinet.parts[lock].joint.origin[None]
    np.testing.assert_allclose(transform_points(relative, axis_point), axis_point, atol=1e-12)


def test_batches_equal_single_states(cabinet):
    batch = np.stack([random_qpos(cabinet, seed) for seed in range(6)]).reshape(2, 3, -1)
    many = displacements(cabinet, batch)
    assert many.shape == (2, 3, len(cabinet.parts), 4, 4)
    np.testing.assert_allclose(many[1, 0], displacements(cabinet, batch[1, 0]), atol=1e-14)


def test_points_keep_their_distances_within_a_part(cabinet):
    surface = cabinet.surface
    chosen = np.arange(0, len(surface.points), 500)
    points, ids = surface.points[chosen].astype(np.float64), surface.part_ids[chosen]
    moved = articulate_points(cabinet, random_qpos(cabinet, 1), points, ids)
    for part in np.unique(ids):
        own = ids == part
        before = np.linalg.norm(points[own][:1] - points[own], axis=1)
        np.testing.assert_allclose(np.linalg.norm(moved[own][:1] - moved[own], axis=1), before, atol=1e-9)
    still = ids == cabinet.root
    np.testing.assert_allclose(moved[still], points[still], atol=1e-12)


def test_gaussians_turn_with_their_parts(cabinet):
    rng = np.random.default_rng(0)
    ids = np.arange(len(cabinet.parts))
    quats = rng.normal(size=(len(ids), 4))
    gaussians = Gaussians(
        means=rng.uniform(-0.5, 0.5, (len(ids), 3)),
        quats=quats / np.linalg.norm(quats, axis=1, keepdims=True),
        scales=np.full((len(ids), 3), 0.1),
        opacities=np.ones(len(ids)),
        colors=np.zeros((len(ids), 3)),
        part_ids=ids,
    )
    qpos = random_qpos(cabinet, 3)
    moved = articulate_gaussians(cabinet, qpos, gaussians)
    D = displacements(cabinet, qpos)
    np.testing.assert_allclose(
        matrix_from_quat(moved.quats), D[:, :3, :3] @ matrix_from_quat(gaussians.quats), atol=1e-5
    )
    np.testing.assert_allclose(moved.means, articulate_points(cabinet, qpos, gaussians.means, ids), atol=1e-6)
    np.testing.assert_array_equal(moved.scales, gaussians.scales)


def test_a_wrong_number_of_coordinates_is_refused(cabinet):
    with pytest.raises(ValueError, match="qpos has 3 entries, 4 parts move"):
        displacements(cabinet, np.zeros(3))


def write_urdf(asset: Asset) -> str:
    """The asset's tree as URDF: link frames at the joint origins, axes of the object."""
    lines = ['<robot name="asset">']
    for part in asset.parts:
        lines.append(f'<link name="{part.name}"/>')
        if part.parent == -1:
            continue
        above = asset.parts[part.parent]
        start = np.zeros(3) if above.parent == -1 else above.joint.origin
        xyz = " ".join(repr(float(v)) for v in part.joint.origin - start)
        axis = " ".join(repr(float(v)) for v in part.joint.axis)
        lines.append(
            f'<joint name="j_{part.name}" type="{part.joint.type}"><parent link="{above.name}"/>'
            f'<child link="{part.name}"/><origin xyz="{xyz}"/><axis xyz="{axis}"/>'
            f'<limit lower="0" upper="{part.joint.upper}" effort="1" velocity="1"/></joint>'
        )
    return "\n".join([*lines, "</robot>"])


def test_forward_kinematics_agrees_with_an_independent_library(cabinet):
    import yourdfpy

    robot = yourdfpy.URDF.load(
        io.BytesIO(write_urdf(cabinet).encode()), load_meshes=False, build_scene_graph=True
    )
    movable = movable_parts(cabinet)
    for seed in range(4):
        qpos = random_qpos(cabinet, seed)
        robot.update_cfg({f"j_{cabinet.parts[i].name}": q for i, q in zip(movable, qpos, strict=True)})
        D = displacements(cabinet, qpos)
        for index, part in enumerate(cabinet.parts):
            rest = np.eye(4)
            rest[:3, 3] = np.zeros(3) if part.parent == -1 else part.joint.origin
            T = robot.get_transform(part.name, cabinet.parts[cabinet.root].name)
            np.testing.assert_allclose(T, D[index] @ rest, atol=1e-9)


def test_the_order_of_parts_does_not_matter(cabinet):
    permutation = np.random.default_rng(5).permutation(len(cabinet.parts))
    place = {int(old): new for new, old in enumerate(permutation)}
    parts = tuple(
        replace(cabinet.parts[old], parent=place.get(cabinet.parts[old].parent, -1)) for old in permutation
    )
    shuffled = Asset(name="shuffled", category="Cabinet", scale=1.0, parts=parts)
    q_of = {
        cabinet.parts[i].name: q for i, q in zip(movable_parts(cabinet), random_qpos(cabinet, 7), strict=True)
    }
    there = displacements(shuffled, np.array([q_of[parts[i].name] for i in movable_parts(shuffled)]))
    here = displacements(cabinet, np.array([q_of[cabinet.parts[i].name] for i in movable_parts(cabinet)]))
    np.testing.assert_allclose(there, here[permutation], atol=1e-12)
