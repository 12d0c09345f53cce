"""MJCF and URDF in MuJoCo: same masses, inertias and poses as the package; screws stay coupled."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from box_cabinet import as_package, box_geometry, scaled, with_screw
from scipy.spatial.transform import Rotation

from artigen.api.formats import write_actuated
from artigen.kinematics import displacements, qlimits
from artigen.shapes.draw import draw_shape
from artigen.types import Asset
from sim_export.files.mjcf import mjcf_text, srdf_text
from sim_export.files.urdf import link_origins
from sim_export.files.write import write_package
from sim_export.motion.ignored_pairs import ignored_pairs
from sim_export.package import SimPackage
from sim_export.reference import build_reference


@pytest.fixture(scope="module", params=["plain", "screw"])
def case(request, cabinet, tmp_path_factory) -> tuple[Asset, SimPackage, Path]:
    asset = scaled(cabinet) if request.param == "plain" else with_screw(scaled(cabinet))
    geometry = box_geometry()
    textured = replace(
        geometry[2].visuals[0],
        uv=np.zeros((len(geometry[2].visuals[0].faces), 3, 2)),
        texture=np.full((4, 4, 4 if request.param == "screw" else 3), 200, dtype=np.uint8),
    )
    geometry[2] = replace(geometry[2], visuals=(textured,))
    package = as_package(asset, geometry)
    folder = write_package(package, tmp_path_factory.mktemp(request.param) / "cabinet")
    return asset, package, folder


FILES = ["mobility.mjcf.xml", "mobility.urdf"]


@pytest.mark.parametrize("file", FILES)
def test_mujoco_compiles_with_the_same_masses_and_limits(case, file):
    _, package, folder = case
    model = mujoco.MjModel.from_xml_path(str(folder / file))
    for link in package.links:
        body = model.body(link.name)
        if link.inertial is None:
            continue
        assert body.mass[0] == pytest.approx(link.inertial.mass, rel=1e-8)
        np.testing.assert_allclose(body.ipos, link.inertial.com - link_origins(package)[link.name], atol=1e-8)
        R = Rotation.from_quat(body.iquat, scalar_first=True).as_matrix()
        np.testing.assert_allclose(
            R @ np.diag(body.inertia) @ R.T, link.inertial.inertia, rtol=1e-6, atol=1e-8
        )
        # The visuals neither weigh nor collide.
        geoms = [geom for geom in range(model.ngeom) if model.geom_bodyid[geom] == body.id]
        assert sum(model.geom_contype[geom] > 0 for geom in geoms) == len(link.hulls)
        assert len(geoms) == len(link.hulls) + len(link.visuals)
    for joint in package.joints:
        if joint.type == "fixed":
            continue
        found = model.joint(joint.name)
        np.testing.assert_allclose(found.axis, joint.axis, atol=1e-9)
        assert bool(model.jnt_limited[found.id]) == (joint.type != "continuous")
        if joint.type != "continuous":
            np.testing.assert_allclose(found.range, [joint.lower, joint.upper], atol=1e-8)
        assert model.dof_frictionloss[found.dofadr[0]] == pytest.approx(joint.friction, abs=1e-8)
        damping = np.ravel(model.dof_damping[found.dofadr[0]])[0]
        assert damping == pytest.approx(joint.damping, abs=1e-8)


@pytest.mark.parametrize("file", FILES)
def test_mujoco_agrees_on_poses(case, file):
    asset, package, folder = case
    model = mujoco.MjModel.from_xml_path(str(folder / file))
    data = mujoco.MjData(model)
    index = {part.name: k for k, part in enumerate(asset.parts)}
    low, high = qlimits(asset).T
    movers = [joint for joint in package.joints if joint.type != "fixed" and joint.follows is None]
    for seed in range(4):
        qpos = np.random.default_rng(seed).uniform(low, high)
        values = {
            joint.name: q * (asset.scale if joint.type == "prismatic" else 1.0)
            for joint, q in zip(movers, qpos, strict=True)
        }
        for joint in package.joints:
            if joint.follows is not None:
                values[joint.name] = joint.ratio * values[joint.follows]
        for name, value in values.items():
            data.qpos[model.joint(name).qposadr[0]] = value
        mujoco.mj_forward(model, data)
        moved = displacements(asset, qpos)
        moved[:, :3, 3] *= asset.scale
        for link in package.links:
            if link.parts:
                T = moved[index[link.parts[0]]]
                origin = link_origins(package)[link.name]
                np.testing.assert_allclose(
                    data.body(link.name).xpos, T[:3, :3] @ origin + T[:3, 3], atol=1e-7
                )
                np.testing.assert_allclose(data.body(link.name).xmat.reshape(3, 3), T[:3, :3], atol=1e-7)


@pytest.mark.sim
def test_mujoco_rests_quietly_and_keeps_screws_coupled(case):
    _, package, folder = case
    model = mujoco.MjModel.from_xml_path(str(folder / "mobility.mjcf.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert np.abs(data.qfrc_constraint).sum() < 1e-3
    travels = [joint for joint in package.joints if joint.follows is not None]
    for joint in travels:
        data.qfrc_applied[model.joint(joint.follows).dofadr[0]] = 0.045
    for _ in range(200):
        mujoco.mj_step(model, data)
    assert np.isfinite(data.qpos).all()
    assert int(sum(warning.number for warning in data.warning)) == 0
    for joint in travels:
        turned = data.qpos[model.joint(joint.follows).qposadr[0]]
        assert turned > 0.1
        assert data.qpos[model.joint(joint.name).qposadr[0]] == pytest.approx(joint.ratio * turned, abs=2e-4)


def test_joined_bodies_do_not_collide(case):
    _, package, folder = case
    model = mujoco.MjModel.from_xml_path(str(folder / "mobility.mjcf.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    joined = {frozenset((joint.parent, joint.child)) for joint in package.joints}
    for contact in data.contact:
        pair = frozenset(model.body(model.geom_bodyid[geom]).name for geom in contact.geom)
        assert pair not in joined
    assert model.nexclude >= 3


def test_pairs_that_touch_without_a_joint_are_in_the_srdf(cabinet):
    geometry = box_geometry()
    package = as_package(scaled(cabinet), geometry)
    pair = ("link_0", "link_1")
    assert pair not in ignored_pairs(package)
    drawer_floor = min(hull.vertices[:, 2].min() for hull in geometry[2].hulls)
    door_top = max(hull.vertices[:, 2].max() for hull in geometry[4].hulls)
    for gap, touch in ((0.0, True), (-0.0005, True), (-0.01, False)):
        lift = np.array([0.0, 0.0, drawer_floor - door_top - gap])
        raised = tuple(replace(hull, vertices=hull.vertices + lift) for hull in geometry[4].hulls)
        changed = [*geometry[:4], replace(geometry[4], hulls=raised), *geometry[5:]]
        assert (pair in ignored_pairs(as_package(scaled(cabinet), changed))) == touch
    text = srdf_text("x", (pair,))
    assert 'reason="Default"' in text
    assert text.count("disable_collisions") == 1
    assert '<exclude body1="link_0" body2="link_1"' in mjcf_text(package, (pair,))


@pytest.fixture(scope="module", params=["StorageFurniture", "Oven"])
def actuated(request, tmp_path_factory) -> tuple[SimPackage, Path]:
    package = build_reference(draw_shape(request.param, 0))
    return package, write_actuated(package, tmp_path_factory.mktemp("actuated") / "object", "refuse")


def test_sites_mark_the_handles(actuated):
    package, file = actuated
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert model.nsite == len(package.handles) > 0
    for handle in package.handles:
        near = min(
            (data.site(k) for k in range(model.nsite)),
            key=lambda site: np.linalg.norm(site.xpos - handle.grasp_line.mean(axis=0)),
        )
        assert near.name.startswith(f"handle_{handle.link}_")
        np.testing.assert_allclose(near.xpos, handle.grasp_line.mean(axis=0), atol=1e-6)
        axes, line = near.xmat.reshape(3, 3), handle.grasp_line[1] - handle.grasp_line[0]
        np.testing.assert_allclose(axes[:, 2], handle.normal, atol=1e-6)
        np.testing.assert_allclose(
            np.cross(axes[:, 0], line - axes[:, 2] * (axes[:, 2] @ line)), 0, atol=1e-6
        )
        assert np.linalg.det(axes) == pytest.approx(1.0)


def test_servos_take_every_joint_to_its_target(actuated):
    package, file = actuated
    model = mujoco.MjModel.from_xml_path(str(file))
    own = [joint for joint in package.joints if joint.type != "fixed" and joint.follows is None]
    assert [model.actuator(k).name for k in range(model.nu)] == [joint.name for joint in own]
    for joint in own:  # one at a time: some doors are in the way of others
        data = mujoco.MjData(model)
        limited = joint.type != "continuous"
        target = (joint.lower + joint.upper) / 2.0 if limited else joint.velocity / 2.0
        if any(need.joint == joint.name for need in package.requires_open):
            continue
        data.actuator(joint.name).ctrl = target
        for _ in range(1500):
            mujoco.mj_step(model, data)
        found = data.joint(joint.name).qpos[0] if limited else data.joint(joint.name).qvel[0]
        wide = joint.upper - joint.lower if limited else joint.velocity
        assert found == pytest.approx(target, abs=0.05 * wide), joint.name
