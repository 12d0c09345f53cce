"""Rooms as MJCF and OpenUSD: MuJoCo and usd-core find every body where the room's kinematics put it."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from bare_room import ROOM
from room_poses import expected_poses
from sample_packages import SAMPLE_PARTS, build_package, double_door_parts

from artigen.transforms import matrix_from_quat
from artigen.types import Joint
from envs.rooms.ajar import stays
from envs.rooms.contents import fill_room
from envs.rooms.covers import fixture_mesh
from envs.rooms.footprints import cached_package, read_footprint
from envs.rooms.mjcf import HOME, write_room_mjcf
from envs.rooms.patterns import PERIODS, paint_pattern
from envs.rooms.room import Fixture, Placement, Room, pose_matrix_of
from envs.rooms.usd import write_room_usd
from envs.rooms.views import find_lamps, find_views
from sim_export.files.obj import read_image
from sim_export.files.write import write_package
from sim_export.motion.kinematics import driven_joints
from sim_export.package import Inertial, Link, SimPackage

OPENED = 0.2
MICROMETRE, MILLIMETRE = 1e-6, 1e-3


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> Room:
    """Two cabinets of one package and one of another, turned differently, a drawer open, things in all."""
    base = tmp_path_factory.mktemp("packages").resolve()
    packages = (build_package(SAMPLE_PARTS), build_package(double_door_parts()))
    folders = [write_package(package, base / f"cabinet_{index}") for index, package in enumerate(packages)]
    placements = tuple(
        Placement(
            id=f"cabinet_{index}", role="base cabinet", category="StorageFurniture", package=folders[which],
            position=(0.6 + 1.3 * index, 2.0, 0.002 - float(read_footprint(folders[which]).body[0, 2])),
            quat=(0.5**0.5, 0.0, 0.0, sign * 0.5**0.5), size=(0.5, 0.8, 0.7),
            joints=(("joint_0", OPENED),) if index == 1 else (),
        )
        for index, (which, sign) in enumerate(((0, 1.0), (0, -1.0), (1, 1.0)))
    )  # fmt: skip
    return fill_room(replace(ROOM, placements=placements), 1.0)


def start(room: Room, folder: Path) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The room in MuJoCo, at its own coordinates."""
    model = mujoco.MjModel.from_xml_path(str(write_room_mjcf(room, folder)))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(HOME).id)
    mujoco.mj_forward(model, data)
    return model, data


def test_mujoco_finds_every_body_and_joint_of_the_room(room: Room, tmp_path: Path):
    model, data = start(room, tmp_path)
    expected = expected_poses(room)
    assert {model.body(index).name for index in range(1, model.nbody)} == set(expected)
    for name, T in expected.items():
        found = data.body(name)
        np.testing.assert_allclose(found.xpos, T[:3, 3], atol=MICROMETRE, err_msg=name)
        np.testing.assert_allclose(found.xmat.reshape(3, 3), T[:3, :3], atol=MICROMETRE, err_msg=name)
    for placement in room.placements:
        for joint in driven_joints(cached_package(placement.package).joints):
            found = model.joint(f"{placement.id}/{joint.name}")
            if joint.type != "continuous":
                np.testing.assert_allclose(found.range, (joint.lower, joint.upper), atol=MICROMETRE)
    for item in room.contents:
        assert model.body(item.id).mass[0] == pytest.approx(item.mass)


def test_in_mujoco_nothing_moves_in_two_seconds_without_sleep(room: Room, tmp_path: Path):
    model, data = start(room, tmp_path)
    model.opt.enableflags = 0
    before = data.xpos.copy()
    for _ in range(round(2.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
    assert np.linalg.norm(data.xpos - before, axis=1).max() < MILLIMETRE


def test_in_mujoco_a_drawer_takes_along_what_it_holds(room: Room, tmp_path: Path):
    model, data = start(room, tmp_path)
    drawer = next(
        joint for joint in cached_package(room.placements[0].package).joints if joint.name == "joint_0"
    )
    held = [item.id for item in room.contents if (item.holder, item.link) == ("cabinet_0", drawer.child)]
    before = {name: data.body(name).xpos.copy() for name in held}
    mujoco.mj_step(model, data, nstep=100)
    assert (data.tree_asleep >= 0).all()
    joint = data.joint("cabinet_0/joint_0")
    while joint.qpos[0] < OPENED:
        joint.qfrc_applied[:] = 3.0 * drawer.friction
        mujoco.mj_step(model, data)
    pull = pose_matrix_of(room.placements[0])[:3, :3] @ drawer.axis
    assert len(held) >= 2
    for name in held:
        assert pull @ (data.body(name).xpos - before[name]) == pytest.approx(OPENED, abs=0.05), name


def test_usd_puts_every_body_where_the_room_has_it(room: Room, tmp_path: Path):
    pytest.importorskip("pxr")
    from pxr import Usd, UsdGeom, UsdPhysics

    stage = Usd.Stage.Open(str(write_room_usd(room, tmp_path)))
    assert not stage.GetCompositionErrors()
    bodies = [prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    expected = expected_poses(room)
    assert {str(prim.GetPath()).removeprefix("/World/") for prim in bodies} == set(expected)
    cache = UsdGeom.XformCache()
    for prim in bodies:
        name = str(prim.GetPath()).removeprefix("/World/")
        found = np.array(cache.GetLocalToWorldTransform(prim)).T
        np.testing.assert_allclose(found, expected[name], atol=MICROMETRE, err_msg=name)
    assert len({str(prim.GetPath()) for prim in stage.Traverse() if prim.IsA(UsdPhysics.Scene)}) == 1
    assert len(list((tmp_path / "usd").iterdir())) == 2


def test_newton_finds_every_body_and_joint_of_the_room(room: Room, tmp_path: Path):
    newton = pytest.importorskip("newton")
    builder = newton.ModelBuilder()
    builder.add_usd(str(write_room_usd(room, tmp_path)))
    expected = expected_poses(room)
    labels = [label.removeprefix("/World/") for label in builder.body_label]
    found = dict(zip(labels, np.array(builder.body_q), strict=True))
    assert set(found) == set(expected)
    for name, T in expected.items():
        x, y, z, w = found[name][3:]
        np.testing.assert_allclose(found[name][:3], T[:3, 3], atol=MILLIMETRE, err_msg=name)
        np.testing.assert_allclose(
            matrix_from_quat(np.array([w, x, y, z])), T[:3, :3], atol=MILLIMETRE, err_msg=name
        )
    starts = zip(builder.joint_label, builder.joint_qd_start, strict=True)
    columns = {label.removeprefix("/World/").replace("/joints/", "/"): start for label, start in starts}
    for placement in room.placements:
        for joint in driven_joints(cached_package(placement.package).joints):
            if joint.type != "continuous":
                column = columns[f"{placement.id}/{joint.name}"]
                limits = builder.joint_limit_lower[column], builder.joint_limit_upper[column]
                np.testing.assert_allclose(limits, (joint.lower, joint.upper), atol=MILLIMETRE)


TILED = Fixture(
    name="tiled", low=(0.1, 0.1, 0.0), high=(0.9, 0.6, 0.02), color=(0.8, 0.8, 0.7), pattern="tiles"
)
POST = Fixture(
    name="post", low=(3.0, 0.5, 0.0), high=(3.2, 0.7, 1.0), color=(0.5, 0.4, 0.3), shape="cylinder"
)


@pytest.fixture(scope="module")
def covered() -> Room:
    return replace(ROOM, fixtures=(*ROOM.fixtures, TILED, POST))


def test_mujoco_sees_the_pattern_where_it_is_in_the_room(covered: Room, tmp_path: Path):
    model, _ = start(covered, tmp_path)
    material = model.geom("tiled_cover").matid[0]
    texture = model.mat_texid[material].max()
    shape = model.tex_height[texture], model.tex_width[texture], 3
    start_at = model.tex_adr[texture]
    image = model.tex_data[start_at : start_at + np.prod(shape)].reshape(shape)
    np.testing.assert_array_equal(image, paint_pattern("tiles", TILED.color))
    mesh = model.mesh("tiled").id
    points = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
    coordinates = model.mesh_texcoord[model.mesh_texcoordadr[mesh] :][: model.mesh_texcoordnum[mesh]]
    assert np.ptp(coordinates[:, 0]) * PERIODS["tiles"][0] == pytest.approx(
        np.ptp(points, axis=0).max(), rel=1e-5
    )
    assert model.geom("post").type[0] == mujoco.mjtGeom.mjGEOM_CYLINDER
    assert model.geom("post").size[0] == pytest.approx(0.1)


def test_usd_sees_the_pattern_where_it_is_in_the_room(covered: Room, tmp_path: Path):
    pytest.importorskip("pxr")
    from pxr import Usd, UsdGeom, UsdPhysics, UsdShade

    stage = Usd.Stage.Open(str(write_room_usd(covered, tmp_path)))
    cover = UsdGeom.Mesh(stage.GetPrimAtPath("/World/tiled/cover"))
    expected = fixture_mesh(TILED)
    assert expected.uv is not None
    st = np.array(UsdGeom.PrimvarsAPI(cover).GetPrimvar("st").Get())
    np.testing.assert_allclose(st, expected.uv.reshape(-1, 2), atol=1e-6)
    material, _ = UsdShade.MaterialBindingAPI(cover.GetPrim()).ComputeBoundMaterial()
    image = UsdShade.Shader(stage.GetPrimAtPath(material.GetPath().AppendChild("image")))
    file = tmp_path / image.GetInput("file").Get().path
    np.testing.assert_array_equal(read_image(file)[..., :3], expected.texture)
    assert stage.GetPrimAtPath("/World/tiled/collision").HasAPI(UsdPhysics.CollisionAPI)
    assert not cover.GetPrim().HasAPI(UsdPhysics.CollisionAPI)


def test_engines_have_the_cameras_and_lamps_of_the_room(covered: Room, tmp_path: Path):
    pytest.importorskip("pxr")
    from pxr import Usd, UsdGeom, UsdLux

    model, data = start(covered, tmp_path)
    stage = Usd.Stage.Open(str(write_room_usd(covered, tmp_path)))
    cache = UsdGeom.XformCache()
    for view in find_views(covered):
        right, down, forward = view.camera.axes
        turned = np.column_stack([right, -down, -forward])
        found = data.cam(view.name)
        np.testing.assert_allclose(found.xpos, view.camera.position, atol=MICROMETRE)
        np.testing.assert_allclose(found.xmat.reshape(3, 3), turned, atol=MICROMETRE)
        T = np.array(cache.GetLocalToWorldTransform(stage.GetPrimAtPath(f"/World/cameras/{view.name}"))).T
        np.testing.assert_allclose(T[:3, 3], view.camera.position, atol=MICROMETRE)
        np.testing.assert_allclose(T[:3, :3], turned, atol=MICROMETRE)
    lamps = find_lamps(covered)
    assert model.nlight == len(lamps)
    assert sum(prim.IsA(UsdLux.DiskLight) for prim in stage.Traverse()) == len(lamps)


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.2])
@pytest.mark.parametrize("share", [0.98, 1.02])
def test_a_lid_stays_exactly_where_its_friction_reaches_its_weight(angle: float, share: float):
    """A lid of 2 kg, its centre 0.3 m from its hinge along x: the moment is m g r cos(angle)."""
    inertial = Inertial(mass=2.0, com=np.array([0.3, 0.0, 0.5]), inertia=np.eye(3))
    links = (
        Link(name="body", label="base", parts=(), visuals=(), hulls=(), inertial=None),
        Link(name="lid", label="door", parts=(), visuals=(), hulls=(), inertial=inertial),
    )
    hinge = Joint(
        name="hinge", type="revolute", parent="body", child="lid",
        origin=np.array([0.0, 0.0, 0.5]), axis=np.array([0.0, -1.0, 0.0]), upper=1.5,
        friction=share * 2.0 * 9.81 * 0.3 * np.cos(angle),
    )  # fmt: skip
    package = SimPackage(name="chest", category="Box", visual="exact", links=links, joints=(hinge,))
    assert stays(package, {"hinge": angle}, "hinge") == (share > 1.0)
