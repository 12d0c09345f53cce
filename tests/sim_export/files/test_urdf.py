"""URDF: our kinematics against yourdfpy and SAPIEN, and every convention that loaders rely on."""

import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from box_cabinet import as_package, box_geometry, scaled, with_screw

from artigen.kinematics import displacements, qlimits
from artigen.types import Asset, Part
from sim_export.errors import DegeneratePart, InvalidKinematics
from sim_export.files.urdf import format_number, link_origins, urdf_text
from sim_export.files.write import write_package
from sim_export.package import SimPackage
from sim_export.physics.inertia import combine, subtree_inertial
from sim_export.physics.links import PartGeometry, build_links, check_kinematics


@pytest.fixture(scope="module", params=["plain", "screw"])
def case(request, cabinet, tmp_path_factory) -> tuple[Asset, SimPackage, Path]:
    asset = scaled(cabinet) if request.param == "plain" else with_screw(scaled(cabinet))
    package = as_package(asset, box_geometry())
    folder = write_package(package, tmp_path_factory.mktemp(request.param) / "cabinet")
    return asset, package, folder


def without_pitch(asset: Asset) -> Asset:
    """Screws that only turn, as in the variant for ManiSkill."""
    parts = [
        replace(part, joint=replace(part.joint, pitch=0.0)) if part.joint.type == "screw" else part
        for part in asset.parts
    ]
    return replace(asset, parts=tuple(parts))


def joint_values(asset: Asset, package: SimPackage, qpos: np.ndarray) -> dict[str, float]:
    """Package joint coordinates for an asset's qpos: metres for slides, followers left out."""
    movers = [joint for joint in package.joints if joint.type != "fixed" and joint.follows is None]
    values = {}
    for joint, q in zip(movers, qpos, strict=True):
        values[joint.name] = float(q * asset.scale if joint.type == "prismatic" else q)
    return values


def expected_frames(asset: Asset, package: SimPackage, qpos: np.ndarray) -> dict[str, np.ndarray]:
    """Link frames from the asset's own kinematics, in metres."""
    moved = displacements(asset, qpos)
    moved[:, :3, 3] *= asset.scale
    index = {part.name: k for k, part in enumerate(asset.parts)}
    frames = {}
    for link in package.links:
        if link.parts:
            rest = np.eye(4)
            rest[:3, 3] = link_origins(package)[link.name]
            frames[link.name] = moved[index[link.parts[0]]] @ rest
    return frames


def random_qpos(asset: Asset, seed: int) -> np.ndarray:
    low, high = qlimits(asset).T
    return np.random.default_rng(seed).uniform(low, high)


@pytest.mark.parametrize("file", ["mobility.urdf", "mobility_cvx.urdf"])
def test_yourdfpy_validates_and_agrees_on_poses(case, file):
    import yourdfpy

    asset, package, folder = case
    asset = asset if file == "mobility.urdf" else without_pitch(asset)
    robot = yourdfpy.URDF.load(str(folder / file))
    assert robot.validate(), robot.errors
    assert robot.validate_filenames()
    for seed in range(4):
        qpos = random_qpos(asset, seed)
        robot.update_cfg(joint_values(asset, package, qpos))
        for name, T in expected_frames(asset, package, qpos).items():
            np.testing.assert_allclose(robot.get_transform(name, robot.base_link), T, atol=2e-8)


@pytest.mark.sim
@pytest.mark.parametrize("file", ["mobility.urdf", "mobility_cvx.urdf"])
def test_sapien_loads_everything(case, file):
    import sapien
    from sapien.physx import PhysxCpuSystem

    asset, package, folder = case
    scene = sapien.Scene([PhysxCpuSystem()])
    loader = scene.create_urdf_loader()
    loader.fix_root_link = True
    loader.load_multiple_collisions_from_file = True
    builder = loader.parse(str(folder / file))[0][0]
    for link in builder.link_builders:
        link.visual_records = []
    robot = builder.build()
    by_name = {link.name: link for link in package.links}
    for link in robot.links:
        authored = by_name[link.name]
        assert len(link.collision_shapes) == len(authored.hulls)
        if authored.inertial is not None:
            assert link.mass == pytest.approx(authored.inertial.mass, rel=1e-6)
    screw = any(joint.follows for joint in package.joints)
    assert robot.dof == 4 + (screw and file == "mobility.urdf")
    asset = asset if file == "mobility.urdf" else without_pitch(asset)
    specs = {joint.name: joint for joint in package.joints}
    for seed in range(3):
        qpos = random_qpos(asset, seed)
        values = joint_values(asset, package, qpos)
        full = []
        for joint in robot.active_joints:
            spec = specs[joint.name]
            full.append(values[joint.name] if spec.follows is None else spec.ratio * values[spec.follows])
            if spec.type != "continuous" or file == "mobility_cvx.urdf":
                np.testing.assert_allclose(joint.limits[0], [spec.lower, spec.upper], atol=1e-6)
        robot.set_qpos(np.array(full, dtype=np.float32))
        for name, T in expected_frames(asset, package, qpos).items():
            pose = next(link for link in robot.links if link.name == name).entity_pose
            np.testing.assert_allclose(pose.to_transformation_matrix(), T, atol=2e-6)


def test_conventions(case):
    _, package, folder = case
    for file in ("mobility.urdf", "mobility_cvx.urdf"):
        robot = ET.parse(folder / file).getroot()
        names = [link.get("name") for link in robot.findall("link")]
        for link in robot.findall("link"):  # an empty one has no mass, and strict readers refuse it
            assert link.find("inertial") is not None
        assert names[-1] == package.links[-1].name == "link_4"
        assert not list(robot.iter("material"))
        visuals = [visual.get("name") for visual in robot.iter("visual")]
        assert len(set(visuals)) == len(visuals)
        assert not any("-" in str(name) for name in visuals)
        for mesh in robot.iter("mesh"):
            assert (folder / str(mesh.get("filename"))).is_file()
        for joint in robot.findall("joint"):
            if joint.get("type") == "fixed":
                continue
            axis, limit = joint.find("axis"), joint.find("limit")
            assert axis is not None
            assert limit is not None
            assert np.linalg.norm([float(x) for x in axis.get("xyz", "").split()]) == pytest.approx(
                1, abs=1e-8
            )
            assert {"effort", "velocity"} <= set(limit.keys())
            assert joint.find("dynamics") is not None
        bodies = {link.get("name"): len(link.findall("collision")) for link in robot.findall("link")}
        for link in package.links:
            assert bodies.get(link.name, 0) == len(link.hulls)


def test_maniskill_variant_has_handles_and_limits_everywhere(case):
    _, _, folder = case
    robot = ET.parse(folder / "mobility_cvx.urdf").getroot()
    visuals = {
        link.get("name"): [str(visual.get("name")) for visual in link.findall("visual")]
        for link in robot.findall("link")
    }
    moving = [joint for joint in robot.findall("joint") if joint.get("type") != "fixed"]
    assert len(moving) == 4
    for joint in moving:
        child, limit = joint.find("child"), joint.find("limit")
        assert joint.get("type") in ("revolute", "prismatic")
        assert joint.find("mimic") is None
        assert child is not None
        assert limit is not None
        assert any("handle" in name for name in visuals[child.get("link")])
        assert float(limit.get("lower", "nan")) == 0.0
        assert 0.0 < float(limit.get("upper", "nan")) <= 2 * np.pi + 1e-8
    assert not any("handle" in name for name in visuals["link_4"])
    assert visuals["link_0"] == ["drawer_link_0_0", "handle_link_0_0"]
    assert visuals["link_3"] == ["handle_tray_link_3_0"]


def test_fixed_parts_weld_to_the_nearest_movable_ancestor(case):
    asset, package, _ = case
    assert {link.name: link.parts for link in package.links if link.parts} == {
        "link_0": ("drawer", "drawer_handle"),
        "link_1": ("door", "door_handle"),
        "link_2": ("lock",),
        "link_3": ("tray",),
        "link_4": ("body", "shelf"),
    }
    parents = {joint.child: joint.parent for joint in package.joints}
    assert parents["link_0"] == parents["link_3"] == "link_4"
    assert "link_4" not in parents
    assert "link_1" in (parents["link_2"], parents.get("link_2_carrier"))
    total = combine([geometry.inertial for geometry in box_geometry() if geometry.inertial])
    carriers = [link.inertial.mass for link in package.links if "carrier" in link.name and link.inertial]
    assert subtree_inertial(package.links, package.joints, "link_4").mass == pytest.approx(
        total.mass + sum(carriers)
    )
    assert len(asset.parts) == sum(len(link.parts) for link in package.links)


def test_a_screw_becomes_two_coupled_joints(cabinet):
    package = as_package(with_screw(scaled(cabinet)), box_geometry())
    turn, travel = (joint for joint in package.joints if joint.kind == "screw")
    assert (turn.type, travel.type, travel.follows) == ("revolute", "prismatic", turn.name)
    assert turn.child == travel.parent
    assert travel.ratio * 2 * np.pi == pytest.approx(0.012)
    assert travel.upper == pytest.approx(0.012)
    np.testing.assert_allclose(travel.axis, -turn.axis)  # negative pitch: it travels against its axis


def test_an_asset_without_movable_parts_still_has_a_joint(cabinet):
    body = replace(cabinet, parts=cabinet.parts[:2], voxels=None, surface=None)
    package = as_package(body, box_geometry()[:2])
    assert [link.name for link in package.links] == ["base", "link_0"]
    assert [joint.type for joint in package.joints] == ["fixed"]
    check_kinematics(package)


def test_what_cannot_be_linked_is_refused(cabinet):
    geometry = box_geometry()
    with pytest.raises(DegeneratePart, match="'tray'"):
        build_links(cabinet, [*geometry[:7], PartGeometry()])
    bare = replace(cabinet, voxels=None, surface=None)
    knobs = [
        Part(name=f"knob_{k}", label="knob", parent=0, joint=cabinet.parts[6].joint, box=np.ones((2, 3)))
        for k in range(64)
    ]
    few = build_links(replace(bare, parts=(cabinet.parts[0], *knobs[:62])), [geometry[0]] * 63)
    assert len(few.links) == 63
    with pytest.raises(InvalidKinematics, match="at most 64"):
        build_links(replace(bare, parts=(cabinet.parts[0], *knobs)), [geometry[0]] * 65)
    moving_root = replace(cabinet.parts[0], joint=cabinet.parts[2].joint)
    with pytest.raises(InvalidKinematics, match="'body'"):
        build_links(replace(bare, parts=(moving_root, *cabinet.parts[1:])), geometry)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"parent": "nowhere"}, "nowhere"),
        ({"child": "link_1"}, "tree"),
        ({"parent": "link_0"}, "hang"),
        ({"name": "joint_1"}, "twice"),
        ({"name": "joint 0"}, "letters"),
    ],
)
def test_broken_kinematics_are_refused(cabinet, change, what):
    package = as_package(scaled(cabinet), box_geometry())
    broken = replace(package, joints=(replace(package.joints[0], **change), *package.joints[1:]))
    with pytest.raises(InvalidKinematics, match=what):
        check_kinematics(broken)


def test_numbers_are_written_plainly():
    assert [format_number(value) for value in (0.0, -0.0, -1e-12, 0.1, 1e-9, 1234.5, 100.0)] == [
        "0", "0", "0", "0.1", "0.000000001", "1234.5", "100",
    ]  # fmt: skip


def test_text_is_escaped(cabinet):
    package = replace(as_package(scaled(cabinet), box_geometry()), name='a "b" <c> & d')
    assert ET.fromstring(urdf_text(package)).get("name") == package.name
