"""Loading: what the package says is what the engine has, and nothing is lost without a word."""

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from braced_cabinet import braced_cabinet
from defects import mesh_collisions
from folding_cupboard import draw_folding
from screw_jar import screw_package

from artigen.transforms import inverse
from artigen.types import Joint
from sim_export.errors import PackageError
from sim_export.files.write import write_package
from sim_export.motion.kinematics import link_displacements
from sim_export.package import SimPackage
from sim_export.physics.materials import physx_friction_coefficient
from sim_export.reference import build_reference

sapien = pytest.importorskip("sapien")
from envs.hand import pose_matrix  # noqa: E402
from envs.sim.friction import CHAIN_ITERATIONS, apply_damping, apply_friction, apply_velocity  # noqa: E402
from envs.sim.loaded import qpos_of, set_open_fraction  # noqa: E402
from envs.sim.sapien import LoadConfig, load_package  # noqa: E402
from envs.sim.scene import create_scene  # noqa: E402

pytestmark = pytest.mark.sim
TIMESTEPS = [1 / 60, 1 / 100, 1 / 240]


@pytest.fixture(scope="module")
def package() -> SimPackage:
    return braced_cabinet()


def slider(mass: float, joint: str = "prismatic") -> str:
    """A block on a horizontal rail (or hinge), as URDF; its inertia about any axis is mass / 10."""
    inertia = f'<inertia ixx="{mass / 10}" iyy="{mass / 10}" izz="{mass / 10}" ixy="0" ixz="0" iyz="0"/>'
    return f"""<robot name="slider"><link name="base"/>
    <link name="link_0"><inertial><mass value="{mass}"/>{inertia}</inertial>
      <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
    <joint name="joint_0" type="{joint}"><parent link="base"/><child link="link_0"/>
      <axis xyz="1 0 0"/><limit lower="-10" upper="10" effort="1" velocity="1"/></joint></robot>"""


def push(
    xml: str, path: Path, timestep: float, friction: float, damping: float, effort: float, seconds: float
):
    """Position and speed after a constant effort from rest."""
    path.write_text(xml)
    scene = create_scene(timestep)
    articulation = scene.create_urdf_loader().load(str(path))
    joint = articulation.active_joints[0]
    apply_friction(joint, friction)
    apply_damping(articulation, joint, damping)
    for _ in range(round(seconds / timestep)):
        articulation.set_qf(np.array([effort], dtype=np.float32))
        scene.step()
    return float(articulation.qpos[0]), float(articulation.qvel[0])


@pytest.mark.parametrize("timestep", TIMESTEPS)
@pytest.mark.parametrize("joint", ["prismatic", "revolute"])
def test_friction_is_coulomb_in_newtons_at_every_step_size(tmp_path, timestep, joint):
    mass = 2.0
    inertia = mass if joint == "prismatic" else mass / 10
    for friction in (0.5, 5.0):
        held, _ = push(
            slider(mass, joint), tmp_path / "s.urdf", timestep, friction, 0.0, 0.98 * friction, 0.5
        )
        assert held == pytest.approx(0.98 * 1e-5 * 0.5, rel=0.2)  # it creeps at its speed for friction
        _, speed = push(
            slider(mass, joint), tmp_path / "s.urdf", timestep, friction, 0.0, 1.5 * friction, 0.5
        )
        assert speed == pytest.approx(0.5 * friction / inertia * 0.5, rel=0.05)


@pytest.mark.parametrize("timestep", TIMESTEPS)
def test_damping_adds_to_friction(tmp_path, timestep):
    mass, friction, damping, effort, seconds = 5.0, 5.0, 10.0, 12.0, 0.5
    _, speed = push(slider(mass), tmp_path / "s.urdf", timestep, friction, damping, effort, seconds)
    exact = (effort - friction) / damping * (1 - np.exp(-seconds * damping / mass))
    assert speed == pytest.approx(exact, rel=0.08)


@pytest.mark.parametrize("timestep", TIMESTEPS)
@pytest.mark.parametrize("joint", ["prismatic", "revolute"])
def test_no_push_exceeds_the_top_speed(tmp_path, timestep, joint):
    path = tmp_path / "s.urdf"
    path.write_text(slider(0.01, joint))
    scene = create_scene(timestep)
    articulation = scene.create_urdf_loader().load(str(path))
    apply_velocity(articulation.active_joints[0], 2.0)
    speeds = []
    for _ in range(round(1.0 / timestep)):
        articulation.set_qf(np.array([0.1], dtype=np.float32))
        scene.step()
        speeds.append(float(articulation.qvel[0]))
    assert 1.5 < max(speeds) <= 2.0 + 1e-5
    with pytest.raises(ValueError, match="velocity 0"):
        apply_velocity(articulation.active_joints[0], 0.0)


@pytest.mark.parametrize("friction", [1.0, 3.0, 8.0])
def test_the_coefficient_for_other_loaders_holds_about_the_friction(tmp_path, friction):
    mass = 5.0
    path = tmp_path / "s.urdf"
    path.write_text(slider(mass))
    spec = Joint(
        name="joint_0", type="prismatic", parent="base", child="link_0",
        origin=np.zeros(3), axis=np.array([1.0, 0.0, 0.0]), upper=1.0, friction=friction,
    )  # fmt: skip
    for effort, low, high in ((0.7 * friction, 0.0, 1e-3), (1.4 * friction, 1.2e-3, 10.0)):
        scene = create_scene(0.01)
        articulation = scene.create_urdf_loader().load(str(path))
        articulation.set_solver_position_iterations(15)
        articulation.active_joints[0].set_friction(physx_friction_coefficient(spec, mass, 0.0))
        for _ in range(100):
            articulation.set_qf(np.array([effort], dtype=np.float32))
            scene.step()
        assert low <= abs(float(articulation.qpos[0])) <= high


def test_negative_resistance_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"joint_0.*friction -1"):
        push(slider(1.0), tmp_path / "s.urdf", 0.01, -1.0, 0.0, 0.0, 0.1)


def test_every_hull_and_mass_arrives(folder, package):
    loaded = load_package(create_scene(0.01), folder, LoadConfig())
    by_name = {load.name: load for load in loaded.links}
    assert set(by_name) == {link.name for link in package.links}
    for link in package.links:
        load = by_name[link.name]
        assert (load.hulls, load.shapes, load.lost) == (len(link.hulls), len(link.hulls), ())
        if link.inertial is not None:
            assert load.engine_mass == pytest.approx(link.inertial.mass, rel=1e-6)


def longest_edge(shape) -> float:
    """Longest side of the box around a collision shape of SAPIEN's."""
    if hasattr(shape, "half_size"):
        return float(2 * shape.half_size.max())
    return float(np.ptp(shape.vertices * shape.scale, axis=0).max())


def test_a_package_in_the_place_of_another_has_its_own_hulls(package: SimPackage, tmp_path: Path):
    """SAPIEN keeps meshes by their path: a package drawn again was tested with the hulls of the first."""
    bigger = replace(
        package,
        links=tuple(
            replace(link, hulls=tuple(replace(hull, vertices=1.25 * hull.vertices) for hull in link.hulls))
            for link in package.links
        ),
    )
    for written in (package, bigger, package):
        folder = write_package(written, tmp_path / "cabinet", "replace")
        loaded = load_package(create_scene(0.01), folder, LoadConfig())
        shapes = {link.name: link.collision_shapes for link in loaded.articulation.links}
        for link in written.links:
            wide = sorted(np.ptp(hull.vertices, axis=0).max() for hull in link.hulls)
            found = sorted(map(longest_edge, shapes[link.name]))
            assert found == pytest.approx(wide, rel=1e-4)


def test_links_of_two_packages_touch_whatever_each_ignores(package, tmp_path):
    folder = write_package(package, tmp_path / "twice")
    pairs = "".join(
        f'<disable_collisions link1="{one.name}" link2="{other.name}" reason="Default" />'
        for one, other in combinations(package.links, 2)
    )
    (folder / "mobility.srdf").write_text(f'<robot name="twice">{pairs}</robot>')
    scene = create_scene(0.01)
    first, second = (load_package(scene, folder, LoadConfig(), package).articulation for _ in range(2))
    scene.step()
    touching = [
        {body.entity.name for body in contact.bodies}
        for contact in scene.get_contacts()
        if {body.articulation for body in contact.bodies} == {first, second}
    ]
    for link in package.links[:-1]:
        assert {link.name} in touching  # at the same place


def test_joints_keep_order_labels_and_resistance(folder, package):
    loaded = load_package(create_scene(0.01), folder, LoadConfig())
    assert [joint.spec.name for joint in loaded.joints] == ["joint_0", "joint_1", "joint_2", "joint_3"]
    assert [joint.label for joint in loaded.joints] == ["drawer", "door", "knob", "tray"]
    for joint, spec in zip(loaded.joints, package.joints, strict=False):
        assert joint.engine.force_limit == pytest.approx(spec.friction)
        assert joint.engine.friction == 0.0


@pytest.mark.parametrize("fraction", [0.0, 0.3, [1.0, 0.5, 0.25, 0.1]])
def test_poses_agree_with_our_own_kinematics(folder, package, fraction):
    loaded = load_package(create_scene(0.01), folder, LoadConfig())
    qpos = set_open_fraction(loaded, fraction)
    q = {joint.spec.name: qpos[joint.index] for joint in loaded.joints}
    D = link_displacements(package.links, package.joints, q)
    origins = {joint.child: joint.origin for joint in package.joints}
    for link, displacement in zip(package.links, D, strict=True):
        here = pose_matrix(loaded.articulation.find_link_by_name(link.name).entity_pose)
        rest = np.eye(4)
        rest[:3, 3] = origins.get(link.name, np.zeros(3))
        np.testing.assert_allclose(here @ inverse(rest), displacement, atol=2e-6)


def test_open_fraction_outside_the_range_is_refused(folder):
    loaded = load_package(create_scene(0.01), folder, LoadConfig())
    with pytest.raises(ValueError, match=r"\[0, 1\]"):
        set_open_fraction(loaded, 1.1)


def test_a_free_base_falls_and_a_fixed_one_stays(folder):
    for base, drop in (("free", 0.5 * 9.81 * 0.2**2), ("fixed", 0.0)):
        scene = create_scene(0.001)
        loaded = load_package(scene, folder, LoadConfig(base=base))
        for _ in range(200):
            scene.step()
        height = pose_matrix(loaded.articulation.root_pose)[2, 3]
        assert height == pytest.approx(-drop, abs=2e-3)


def test_a_missing_hull_is_named(package, tmp_path):
    folder = write_package(package, tmp_path / "cabinet")
    mesh_collisions(folder)
    (folder / "collision" / "link_1_0.obj").unlink()
    loaded = load_package(create_scene(0.01), folder, LoadConfig(), package)
    lost = {load.name: load.lost for load in loaded.links if load.lost}
    assert lost == {"link_1": ("link_1_0.obj",)}


def test_visuals_and_materials_need_no_render_device(package, tmp_path):
    folder = write_package(package, tmp_path / "cabinet")
    urdf = folder / "mobility.urdf"
    red = '<material name="m"><color rgba="1 0 0 1"/></material>'
    visual = f'<visual><geometry><box size="1 1 1"/></geometry>{red}</visual>'
    urdf.write_text(urdf.read_text().replace('<link name="link_0">', f'<link name="link_0">{visual}', 1))
    assert visual in urdf.read_text()
    assert len(load_package(create_scene(0.01), folder, LoadConfig(), package).joints) == 4


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("</robot>", "", "mobility.urdf"),
        ('type="continuous"', 'type="screw"', "screw"),
        ('<?xml version="1.0" encoding="utf-8"?>', '<!DOCTYPE r [<!ENTITY a "b">]>', "mobility.urdf"),
    ],
)
def test_what_cannot_be_parsed_is_one_error(package, tmp_path, old, new, sentence):
    folder = write_package(package, tmp_path / "cabinet")
    urdf = folder / "mobility.urdf"
    assert old in urdf.read_text()
    urdf.write_text(urdf.read_text().replace(old, new))
    with pytest.raises(PackageError, match=sentence):
        load_package(create_scene(0.01), folder, LoadConfig(), package)


@pytest.mark.parametrize("timestep", TIMESTEPS)
def test_a_screw_turns_and_travels_as_one(tmp_path, timestep):
    package = screw_package()
    folder = write_package(package, tmp_path / "jar")
    loaded = load_package(create_scene(timestep), folder, LoadConfig(), package)
    (turn,) = loaded.joints
    assert (turn.spec.name, turn.label, turn.span) == ("joint_0", "knob", pytest.approx(5 * 2 * np.pi))
    articulation = loaded.articulation
    names = [joint.name for joint in articulation.active_joints]
    turned = 0.0
    for step in range(round(3.0 / timestep)):
        articulation.find_link_by_name("carrier").add_force_torque([0, 0, 0], [0, 0, 0.021])
        loaded.step()
        turned, travelled = (float(articulation.qpos[names.index(n)]) for n in ("joint_0", "joint_0_travel"))
        assert travelled == pytest.approx(0.01 * turned / (2 * np.pi), abs=1e-3), step
    assert turned > np.pi
    followers = qpos_of(loaded, {"joint_0": np.pi})
    assert followers[names.index("joint_0_travel")] == pytest.approx(0.005)


def test_a_follower_sags_by_a_hundredth_of_a_millimetre(tmp_path):
    """Gravity over the square of its frequency, 1000 rad/s."""
    package = screw_package()
    loaded = load_package(create_scene(0.01), write_package(package, tmp_path / "jar"), LoadConfig(), package)
    travel = next(j for j in loaded.articulation.active_joints if j.name == "joint_0_travel")
    assert 9.81 * travel.child_link.mass / travel.stiffness == pytest.approx(9.81e-6, rel=1e-3)


@pytest.mark.real
def test_original_objects_load(real_objects):
    folders = sorted((real_objects / "partnet_mobility").iterdir())[::40]
    assert len(folders) >= 4
    for folder in folders:
        loaded = load_package(create_scene(0.01), folder, LoadConfig())
        assert sum(load.shapes for load in loaded.links) > 0
        assert all(load.mass is None for load in loaded.links)


@pytest.mark.parametrize(("iterations", "holds"), [(CHAIN_ITERATIONS, True), (10, False)])
def test_a_folding_door_stays_closed_on_a_slope(tmp_path: Path, iterations: int, *, holds: bool):
    """The first of two leaves creeps with SAPIEN's iterations, though its friction exceeds its load."""
    folder = tmp_path / "cabinet"
    package = build_reference(draw_folding())
    write_package(package, folder)
    loaded = load_package(create_scene(1 / 60), folder, LoadConfig(base="fixed"), package)
    assert loaded.articulation.get_solver_position_iterations() == CHAIN_ITERATIONS
    loaded.articulation.set_solver_position_iterations(iterations)
    half = np.radians(5.0) / 2
    loaded.articulation.set_root_pose(sapien.Pose(q=[float(np.cos(half)), 0.0, -float(np.sin(half)), 0.0]))
    for _ in range(120):
        loaded.step()
    joint = loaded.joint("joint_0")
    opened = float(loaded.articulation.qpos[joint.index]) / (joint.spec.upper - joint.spec.lower)
    assert (opened < 0.001) == holds


def test_other_packages_keep_their_iterations(folder: Path, package: SimPackage):
    loaded = load_package(create_scene(1 / 60), folder, LoadConfig(base="fixed"), package)
    assert loaded.articulation.get_solver_position_iterations() == 10
