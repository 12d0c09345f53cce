"""Laws of hulls that are boxes or cylinders: found wherever they stand, and nothing else is found."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from artigen.shapes.primitives import SEGMENTS, cylinder, place_vertices, rounded_box
from artigen.transforms import transform_points
from artigen.types import Joint
from envs.hand import link_vertices
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull, clip_hull, convex_hull
from sim_export.geometry.primitives import (
    PrimitiveShape,
    find_primitive,
    is_box,
    primitive_hull,
)
from sim_export.package import Hull, Link, SimPackage
from sim_export.physics.inertia import mesh_inertial

LENGTHS = st.floats(0.0015, 2.5)
SEEDS = st.integers(0, 10_000)


def place(seed: int) -> np.ndarray:
    """A pose that is aligned with the axes for some seeds and turned freely for the others."""
    rng = np.random.default_rng(seed)
    turn = Rotation.random(random_state=seed)
    if seed % 3 == 0:
        turn = Rotation.from_euler("xyz", rng.integers(0, 4, size=3) * np.pi / 2)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = turn.as_matrix(), rng.uniform(-1, 1, size=3)
    return T


def farthest(first: Hull, second: Hull) -> float:
    """The greatest distance from a corner of one hull to the nearest corner of the other."""
    apart = np.linalg.norm(first.vertices[:, None] - second.vertices, axis=2)
    return float(max(apart.min(axis=0).max(), apart.min(axis=1).max()))


@settings(max_examples=60, deadline=None)
@given(st.tuples(LENGTHS, LENGTHS, LENGTHS), SEEDS)
def test_a_box_is_found_wherever_it_stands(sizes, seed):
    hull = primitive_hull(PrimitiveShape(kind="box", sizes=sizes, T_object_shape=place(seed)))
    found = find_primitive(hull)
    assert found is not None
    assert found.kind == "box"
    np.testing.assert_allclose(sorted(found.sizes), sorted(sizes), atol=1e-9)
    assert np.linalg.det(found.T_object_shape[:3, :3]) == pytest.approx(1.0)
    assert farthest(primitive_hull(found), hull) < 1e-9


@settings(max_examples=60, deadline=None)
@given(LENGTHS, LENGTHS, SEEDS)
def test_a_cylinder_is_found_wherever_it_stands(radius, length, seed):
    hull = primitive_hull(PrimitiveShape(kind="cylinder", sizes=(radius, length), T_object_shape=place(seed)))
    found = find_primitive(hull)
    assert found is not None
    assert found.kind == "cylinder"
    np.testing.assert_allclose(found.sizes, (radius, length), atol=1e-9)
    assert farthest(primitive_hull(found), hull) < 1e-9


def test_an_axis_aligned_box_has_no_rotation():
    found = find_primitive(box_hull(np.array([-0.3, 0.1, 0.0]), np.array([0.3, 0.118, 2.0])))
    assert found is not None
    np.testing.assert_allclose(found.sizes, (0.6, 0.018, 2.0), atol=1e-12)
    np.testing.assert_allclose(found.T_object_shape[:3, :3], np.eye(3), atol=1e-12)


@pytest.mark.parametrize(("off", "known"), [(0.9e-6, True), (1.2e-6, False)])
def test_corners_may_be_off_by_what_files_round_away(off, known):
    hull = box_hull(np.zeros(3), np.array([0.3, 0.4, 0.018]))
    moved = hull.vertices.copy()
    moved[3, 2] += off
    assert is_box(Hull(vertices=moved, faces=hull.faces)) == known
    rod = primitive_hull(PrimitiveShape(kind="cylinder", sizes=(0.02, 0.5), T_object_shape=np.eye(4)))
    moved = rod.vertices.copy()
    moved[3, :2] *= 1.0 + off / 0.02
    assert (find_primitive(Hull(vertices=moved, faces=rod.faces)) is not None) == known


def other_hulls() -> dict[str, Hull]:
    unit = box_hull(np.zeros(3), np.ones(3))
    sheared = unit.vertices + 0.1 * unit.vertices[:, [2, 0, 1]] * [1.0, 0.0, 0.0]
    tapered = unit.vertices * np.where(unit.vertices[:, 2:] > 0.5, [0.8, 0.8, 1.0], 1.0)
    bevelled = rounded_box((0.0, 0.0, 0.0), (0.3, 0.2, 0.1), 0.01, "")
    cut = clip_hull(unit, np.array([0.6, 0.0, 0.8]), 0.9)
    assert cut is not None
    angles = np.arange(SEGMENTS) * 2 * np.pi / SEGMENTS
    rim = np.column_stack([np.cos(angles), np.sin(angles)])
    oval = np.concatenate([np.column_stack([rim * [1.0, 0.9], np.full(SEGMENTS, z)]) for z in (0.0, 1.0)])
    cone = np.concatenate(
        [np.column_stack([rim * (1.0 - 0.3 * z), np.full(SEGMENTS, z)]) for z in (0.0, 1.0)]
    )
    twisted = (
        np.cos(0.05) * rim[:, 0] - np.sin(0.05) * rim[:, 1],
        np.sin(0.05) * rim[:, 0] + np.cos(0.05) * rim[:, 1],
    )
    turned = np.concatenate(
        [np.column_stack([rim, np.zeros(SEGMENTS)]), np.column_stack([*twisted, np.ones(SEGMENTS)])]
    )
    return {
        "sheared": Hull(vertices=sheared, faces=unit.faces),
        "tapered": Hull(vertices=tapered, faces=unit.faces),
        "bevelled": Hull(vertices=place_vertices(bevelled), faces=bevelled.faces),
        "cut": cut,
        "oval": convex_hull(oval),
        "cone": convex_hull(cone),
        "twisted": convex_hull(turned),
    }


@pytest.mark.parametrize("name", list(other_hulls()))
@pytest.mark.parametrize("seed", [0, 1])
def test_other_hulls_stay_hulls(name, seed):
    hull = other_hulls()[name]
    assert (
        find_primitive(Hull(vertices=transform_points(place(seed), hull.vertices), faces=hull.faces)) is None
    )


SHAPES = tuple(
    PrimitiveShape(kind=kind, sizes=sizes, T_object_shape=place(seed))
    for kind, sizes in (("box", (0.1, 0.2, 0.4)), ("cylinder", (0.05, 0.3)))
    for seed in (0, 1, 3, 4)
)


@pytest.fixture(scope="module")
def placed(tmp_path_factory):
    """A package of one moving link whose hulls are boxes and cylinders in many poses."""
    hulls = tuple(primitive_hull(shape) for shape in SHAPES)
    body = Link(
        name="link_1",
        label="base",
        parts=(),
        visuals=(),
        hulls=hulls[:1],
        inertial=mesh_inertial(hulls[0], 500.0),
    )
    mover = replace(body, name="link_0", label="door", hulls=hulls)
    joint = Joint(
        name="joint_0", type="revolute", parent="link_1", child="link_0",
        origin=np.array([0.3, -0.2, 0.1]), axis=np.array([0.0, 0.0, 1.0]), upper=1.0,
    )  # fmt: skip
    package = SimPackage(
        name="shapes", category="Thing", visual="voxels", links=(mover, body), joints=(joint,)
    )
    return write_package(package, tmp_path_factory.mktemp("shapes") / "shapes")


def corner_bounds(shape: PrimitiveShape) -> np.ndarray:
    """Bounds of the exact solid along each object axis."""
    R, at = shape.T_object_shape[:3, :3], shape.T_object_shape[:3, 3]
    if shape.kind == "box":
        reach = np.abs(R) @ np.array(shape.sizes) / 2
    else:
        radius, length = shape.sizes
        reach = np.abs(R[:, 2]) * length / 2 + radius * np.hypot(R[:, 0], R[:, 1])
    return np.stack([at - reach, at + reach])


def as_placed(kind: str, sizes: tuple[float, ...], R: np.ndarray, at: np.ndarray) -> PrimitiveShape:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, at
    return PrimitiveShape(kind=kind, sizes=sizes, T_object_shape=T)


@pytest.mark.sim
@pytest.mark.parametrize("file", ["mobility.urdf", "mobility.mjcf.xml"])
def test_mujoco_puts_them_where_they_are(placed, file):
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(placed / file))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mover = model.body("link_0").id
    found = []
    for index in np.flatnonzero(model.geom_bodyid == mover):
        size, R = model.geom_size[index], data.geom_xmat[index].reshape(3, 3)
        if model.geom_type[index] == mujoco.mjtGeom.mjGEOM_BOX:
            found.append(as_placed("box", tuple(2 * size), R, data.geom_xpos[index]))
        else:
            assert model.geom_type[index] == mujoco.mjtGeom.mjGEOM_CYLINDER
            found.append(as_placed("cylinder", (size[0], 2 * size[1]), R, data.geom_xpos[index]))
    bounds = np.stack([corner_bounds(shape) for shape in SHAPES])
    np.testing.assert_allclose([corner_bounds(shape) for shape in found], bounds, atol=1e-6)


@pytest.mark.sim
def test_sapien_puts_them_where_they_are(placed):
    import sapien
    from sapien.physx import PhysxCollisionShapeBox, PhysxCpuSystem

    loader = sapien.Scene([PhysxCpuSystem()]).create_urdf_loader()
    robot = loader.parse(str(placed / "mobility.urdf"))[0][0].build()
    robot.set_qpos(np.zeros(1, dtype=np.float32))
    link = next(link for link in robot.links if link.name == "link_0")
    found = []
    for shape in link.collision_shapes:
        T = (link.entity_pose * shape.local_pose).to_transformation_matrix()
        if isinstance(shape, PhysxCollisionShapeBox):
            found.append(as_placed("box", tuple(2 * shape.half_size), T[:3, :3], T[:3, 3]))
        else:  # along x
            R = T[:3, [1, 2, 0]]
            found.append(as_placed("cylinder", (shape.radius, 2 * shape.half_length), R, T[:3, 3]))
    bounds = np.stack([corner_bounds(shape) for shape in SHAPES])
    np.testing.assert_allclose([corner_bounds(shape) for shape in found], bounds, atol=1e-5)


@pytest.mark.sim
def test_wheels_stand_on_a_facet_in_sapien(tmp_path):
    """A cylinder that lies on the ground as its prism does, on a side, stays there and is as low."""
    import sapien
    from sapien.physx import PhysxCpuSystem

    solid = cylinder((0.0, -0.02, 0.0), (0.0, 0.02, 0.0), 0.1, "")
    hull = Hull(vertices=place_vertices(solid), faces=solid.faces)
    shape = find_primitive(hull)
    assert shape is not None
    body = Link(
        name="link_0", label="base", parts=(), visuals=(), hulls=(hull,), inertial=mesh_inertial(hull, 500.0)
    )
    side = Link(name="link_1", label="base", parts=(), visuals=(), hulls=(), inertial=body.inertial)
    fixed = Joint(
        name="joint_0", type="fixed", parent="link_1", child="link_0", origin=np.zeros(3),
        axis=np.array([1.0, 0.0, 0.0]),
    )  # fmt: skip
    package = SimPackage(name="roll", category="Thing", visual="source", links=(body, side), joints=(fixed,))
    folder = write_package(package, tmp_path / "roll")
    scene = sapien.Scene([PhysxCpuSystem()])
    scene.set_timestep(1 / 240)
    scene.add_ground(0.0, render=False)
    loader = scene.create_urdf_loader()
    loader.fix_root_link = False
    articulations, actors, _ = loader.parse(str(folder / "mobility.urdf"))
    roll = (articulations or actors)[0].build()
    roll.set_pose(sapien.Pose([0.0, 0.0, -float(hull.vertices[:, 2].min()) + 2e-3]))
    for _ in range(480):
        scene.step()
    assert abs(roll.pose.p[0]) < 1e-3  # half a facet of 32 would be 10 mm
    corners = transform_points(
        roll.pose.to_transformation_matrix(),
        link_vertices(next(link for link in roll.links if link.name == "link_0")),
    )
    assert corners[:, 2].min() == pytest.approx(0.0, abs=5e-4)
    assert roll.pose.p[2] == pytest.approx(0.1 * np.cos(np.pi / 32), abs=5e-4)
