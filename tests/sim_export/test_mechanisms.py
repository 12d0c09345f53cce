"""Parts that follow others, and springs: from shape to package, files, engines and back."""

import json
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from artigen.shapes.draw import Wish, draw_shape
from artigen.shapes.poses import pose_parts
from artigen.shapes.primitives import block
from artigen.shapes.shape import Shape, ShapePart
from artigen.transforms import joint_motion
from artigen.types import FIXED, Joint
from sim_export.errors import InvalidKinematics
from sim_export.files.read import read_package
from sim_export.files.write import write_package
from sim_export.fingerprint import hash_geometry
from sim_export.motion.kinematics import link_displacements, moved_links
from sim_export.package import Requirement, SimPackage
from sim_export.physics.followers import follow_parts
from sim_export.physics.links import check_kinematics
from sim_export.reference import build_reference

UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def package() -> SimPackage:
    """A pedal bin: its lid follows the pedal, which a spring pulls up."""
    return build_reference(draw_shape("TrashCan", 0, Wish(style="pedal")))


@pytest.fixture(scope="module")
def folder(package: SimPackage, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_package(package, tmp_path_factory.mktemp("mechanisms") / "bin")


def pedal_and_lid(package: SimPackage) -> tuple[Joint, Joint]:
    lid = next(joint for joint in package.joints if joint.follows is not None)
    return next(joint for joint in package.joints if joint.name == lid.follows), lid


def test_motions_without_ends_neither_follow_nor_have_springs():
    with pytest.raises(ValueError, match="both must have two limits"):
        with_motion(draw_shape("TrashCan", 0, Wish(style="pedal")), "lid", type="continuous")
    with pytest.raises(ValueError, match="stays"):
        Joint(type="prismatic", axis=UP, upper=1.0, stays=True)


@pytest.mark.parametrize(
    ("joint", "says"),
    [
        (FIXED, "a fixed joint from 0 to 0"),
        (Joint(type="revolute", axis=UP, lower=-1.0, upper=1.0), "a revolute joint from -1 to 1"),
        (Joint(type="prismatic", axis=UP), "a prismatic joint from 0 to 0"),
        (Joint(type="screw", axis=UP, upper=1.0), "a screw joint without a pitch"),
        (Joint(type="continuous", axis=UP, upper=6.0, spring=1.0), "a spring of 1 at a continuous joint"),
        (Joint(type="revolute", axis=UP, upper=1.0, spring=-0.1), "a spring of -0.1"),
    ],
)
def test_a_part_moves_from_closed_or_is_fixed(joint: Joint, says: str):
    with pytest.raises(ValueError, match=says):
        ShapePart("lid", "door", [block((0.0, 1.0), (0.0, 1.0), (0.0, 1.0), "steel")], joint)


def test_joints_that_moved_one_by_one_are_coupled_and_needs_go_to_the_leader(package):
    pedal, lid = pedal_and_lid(package)
    leading = {link.name: link.parts[0] for link in package.links if link.parts}
    loose = replace(
        package,
        joints=tuple(replace(joint, follows=None, ratio=0.0) for joint in package.joints),
        requires_open=(
            Requirement(joint=lid.name, needs=pedal.name, fraction=0.5),
            Requirement(joint="other", needs=lid.name, fraction=0.4),
            Requirement(joint="other", needs=pedal.name, fraction=0.3),
        ),
    )
    coupled = follow_parts(loose, {leading[lid.child]: leading[pedal.child], "lost": "nobody"})
    assert [(j.name, j.follows, j.ratio) for j in coupled.joints] == [
        (j.name, j.follows, j.ratio) for j in package.joints
    ]
    (need,) = coupled.requires_open
    assert (need.joint, need.needs, need.fraction) == ("other", pedal.name, 0.4)


def with_motion(shape: Shape, name: str, **changes) -> Shape:
    parts = tuple(
        replace(part, joint=replace(part.joint, **changes))
        if part.name == name and part.joint is not None
        else part
        for part in shape.parts
    )
    return replace(shape, parts=parts)


def test_a_leader_exists_moves_and_follows_nothing():
    shape = draw_shape("TrashCan", 0, Wish(style="pedal"))
    with pytest.raises(ValueError, match="nobody"):
        with_motion(shape, "lid", follows="nobody")
    for leader in ("body", "lid"):
        with pytest.raises(ValueError, match="must have two limits"):
            with_motion(shape, "lid", follows=leader)
    needing = next(part for part in shape.parts if part.needs)
    with pytest.raises(ValueError, match="let it need"):
        with_motion(with_motion(shape, "lid", follows=None), needing.needs[0].part, follows=needing.name)
    for change in ({"ratio": 1.0}, {"offset": 0.01}):
        with pytest.raises(ValueError, match="close and open at the same time"):
            with_motion(shape, "lid", **change)


def test_both_are_open_at_the_same_time(package):
    pedal, lid = pedal_and_lid(package)
    assert lid.ratio * pedal.upper == pytest.approx(lid.upper)
    shares = np.linspace(0.0, 1.0, 5)
    T = link_displacements(package.links, package.joints, {pedal.name: shares * pedal.upper})
    names = [link.name for link in package.links]
    turned = T[:, names.index(lid.child), :3, :3]
    angle = np.arccos(np.clip((np.trace(turned, axis1=1, axis2=2) - 1.0) / 2.0, -1.0, 1.0))
    np.testing.assert_allclose(angle, shares * lid.upper, atol=1e-6)
    assert {names.index(x) for x in (pedal.child, lid.child)} <= set(
        moved_links(package.links, package.joints, pedal)
    )


def test_files_say_it_and_are_read_again(package, folder):
    pedal, lid = pedal_and_lid(package)
    found = {joint.name: joint for joint in read_package(folder).joints}
    assert found[pedal.name].spring == pytest.approx(pedal.spring)
    assert (found[lid.name].follows, found[lid.name].kind) == (pedal.name, "revolute")
    assert found[lid.name].ratio == pytest.approx(lid.ratio)
    urdf = ET.parse(folder / "mobility.urdf").getroot()
    mimic = [(x.get("name"), x.find("mimic")) for x in urdf.findall("joint") if x.find("mimic") is not None]
    assert [(name, tag.get("joint")) for name, tag in mimic if tag is not None] == [(lid.name, pedal.name)]
    told = " ".join(json.loads((folder / "meta.json").read_text())["records"])
    assert f"{lid.name} follows {pedal.name}" in told
    assert f"{pedal.name}: a spring closes it" in told


def test_what_has_neither_is_written_as_before(tmp_path):
    folder = write_package(build_reference(draw_shape("Switch", 0)), tmp_path / "switch")
    assert '"spring"' not in (folder / "physics.json").read_text()
    text = (folder / "mobility.mjcf.xml").read_text()
    assert "stiffness" not in text
    assert "equality" not in text


def test_a_spring_needs_a_range(package):
    pedal, _ = pedal_and_lid(package)
    for spring in (pedal.spring, -1.0):
        changed = replace(pedal, upper=0.0, spring=spring)
        joints = tuple(changed if x.name == pedal.name else x for x in package.joints)
        with pytest.raises(InvalidKinematics, match="spring"):
            check_kinematics(replace(package, joints=joints))


def test_mujoco_pulls_as_stated_and_couples(package, folder):
    mujoco = pytest.importorskip("mujoco")
    pedal, lid = pedal_and_lid(package)
    model = mujoco.MjModel.from_xml_path(str(folder / "mobility.mjcf.xml"))
    data = mujoco.MjData(model)
    at = model.joint(pedal.name).qposadr[0]
    for share in (0.0, 0.5, 1.0):
        data.qpos[at] = share * pedal.upper
        mujoco.mj_forward(model, data)
        assert data.qfrc_spring[at] == pytest.approx(-(1.0 + share) * pedal.spring, rel=1e-6)
    assert model.neq == 1
    assert model.eq_data[0, 1] == pytest.approx(lid.ratio)


def with_offset(package: SimPackage, offset: float) -> SimPackage:
    """The lid is open by ``offset`` (rad) while the pedal is up."""
    _, lid = pedal_and_lid(package)
    ajar = replace(lid, offset=offset, upper=lid.upper + offset)
    return replace(package, joints=tuple(ajar if x is lid else x for x in package.joints))


def test_an_offset_is_kept_in_files_and_in_motion(package, tmp_path):
    """A follower's coordinate is multiplier times its leader's, plus offset, wherever one is stated."""
    mujoco = pytest.importorskip("mujoco")
    ajar = with_offset(package, 0.1)
    folder = write_package(ajar, tmp_path / "ajar")
    pedal, lid = pedal_and_lid(read_package(folder))
    assert lid.offset == pytest.approx(0.1)
    T = link_displacements(ajar.links, ajar.joints, {pedal.name: np.array([0.0, 0.5 * pedal.upper])})
    turned = T[:, [link.name for link in ajar.links].index(lid.child)]
    angle = np.arccos((np.trace(turned[:, :3, :3], axis1=1, axis2=2) - 1.0) / 2.0)
    np.testing.assert_allclose(angle, [0.1, 0.1 + 0.5 * lid.ratio * pedal.upper], atol=1e-6)
    model = mujoco.MjModel.from_xml_path(str(folder / "mobility.mjcf.xml"))
    np.testing.assert_allclose(model.eq_data[0, :2], [0.1, lid.ratio], atol=1e-9)
    assert hash_geometry(ajar) != hash_geometry(package)


def test_usd_has_the_spring_in_degrees(package, tmp_path):
    pytest.importorskip("pxr")
    from pxr import Usd, UsdPhysics

    from sim_export.usd.write import write_usd

    pedal, lid = pedal_and_lid(package)
    stage = Usd.Stage.Open(str(write_usd(package, tmp_path / "usd")))
    prims = {prim.GetName(): prim for prim in stage.Traverse()}
    drive = UsdPhysics.DriveAPI.Get(prims[pedal.name], "angular")
    stiffness, target = drive.GetStiffnessAttr().Get(), drive.GetTargetPositionAttr().Get()
    assert -stiffness * target == pytest.approx(pedal.spring, rel=1e-5)
    gearing = prims[lid.name].GetAttribute("physxMimicJoint:rotZ:gearing").Get()
    assert gearing == pytest.approx(-lid.ratio, rel=1e-5)


@pytest.mark.sim
def test_in_sapien_the_lid_follows_and_the_spring_closes_both(package, folder):
    sapien = pytest.importorskip("sapien")
    from envs.sim.loaded import set_open_fraction
    from envs.sim.sapien import LoadConfig, load_package

    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(0.01)
    loaded = load_package(scene, folder, LoadConfig())
    pedal, lid = pedal_and_lid(package)
    names = [joint.name for joint in loaded.articulation.active_joints]
    assert [joint.spec.name for joint in loaded.joints if joint.spec.name == lid.name] == []
    qpos = set_open_fraction(loaded, [float(x.spec.name == pedal.name) for x in loaded.joints])
    assert qpos[names.index(lid.name)] == pytest.approx(lid.upper)
    for _ in range(200):
        loaded.step()
    np.testing.assert_allclose(loaded.articulation.qpos, 0.0, atol=2e-3)


def test_followers_are_as_far_open_as_their_leader():
    shape = draw_shape("TrashCan", 0, Wish(style="pedal"))
    index = {part.name: k for k, part in enumerate(shape.parts)}
    lid, pedal = (shape.parts[index[name]].joint for name in ("lid", "pedal"))
    assert lid is not None
    assert pedal is not None
    qpos = np.zeros(len(shape.parts))
    qpos[index["pedal"]] = 0.3 * pedal.upper
    T = pose_parts(shape, qpos)
    np.testing.assert_allclose(T[index["lid"]], joint_motion(lid, np.array(0.3 * lid.upper)), atol=1e-12)
