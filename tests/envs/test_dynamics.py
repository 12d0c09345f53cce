"""L3 checks: a sound cabinet passes all of them, and every seeded defect fails the check meant for it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from braced_cabinet import braced_cabinet, with_joint, with_link
from defects import mesh_collisions

from artigen.shapes.draw import draw_shape
from artigen.types import Joint
from sim_export.files.read import read_package
from sim_export.files.write import write_package
from sim_export.geometry.hulls import box_hull
from sim_export.package import Inertial, Link, SimPackage
from sim_export.reference import build_reference

pytest.importorskip("sapien")
from envs import dynamics
from envs import trials as trials_module
from envs.dynamics import (
    check_dynamics,
    check_energy,
    check_mujoco,
    check_opens,
    check_repeat,
    check_rest,
    check_stand,
    check_stays_closed,
)
from envs.titles import TITLES
from envs.trials import run_trials

pytestmark = pytest.mark.sim


def hulls_of(package: SimPackage, name: str):
    return next(link for link in package.links if link.name == name).hulls


@pytest.fixture(scope="module")
def package() -> SimPackage:
    return braced_cabinet()


@pytest.fixture
def one_step_size(monkeypatch: pytest.MonkeyPatch) -> None:
    """Saves the time of V309."""
    monkeypatch.setattr(dynamics, "OTHER_TIMESTEPS", ())


@pytest.fixture(scope="module")
def trials(folder: Path, package: SimPackage):
    return run_trials(folder, package, 0.01)


def test_a_sound_cabinet_passes_everything(folder):
    results = check_dynamics(folder, read_package(folder))
    assert [result.id for result in results] == sorted(TITLES)
    assert {
        result.id: (result.verdict, result.message) for result in results if result.verdict != "pass"
    } == {}


def seeded(package: SimPackage, defect: str) -> SimPackage:
    """The package with one thing wrong."""
    drawer = next(joint for joint in package.joints if joint.name == "joint_0")
    body = next(link for link in package.links if link.name == "link_4")
    if defect == "jammed":  # a latch on the door in front of the drawer
        front = np.concatenate([hull.vertices for hull in hulls_of(package, "link_0")])
        # Close to the hinge, where 30 N cannot push the door open along with it.
        low = np.array([front[:, 0].min() - 0.05, 0.34, front[:, 2].min() - 0.02])
        latch = box_hull(low, low + np.array([0.09, 0.05, 0.1]))
        return with_link(package, "link_1", hulls=(*hulls_of(package, "link_1"), latch))
    if defect == "tray behind a closed door":
        return replace(package, requires_open=())
    if defect == "stuck":
        return with_joint(package, "joint_0", friction=200.0)
    if defect == "no friction":
        return with_joint(package, "joint_0", friction=0.0, damping=1.0)
    if defect == "slanted runners":
        axis = drawer.axis * np.cos(0.5) + np.array([0.0, 0.0, -np.sin(0.5)])
        return with_joint(package, "joint_0", axis=axis)
    if defect == "top-heavy":
        assert body.inertial is not None
        beside = replace(body.inertial, com=body.inertial.com + np.array([-1.0, 0.0, 0.0]))
        return with_link(package, "link_4", inertial=beside)
    if defect == "overlapping siblings":
        moved = tuple(
            replace(hull, vertices=hull.vertices + np.array([0.0, 0.0, 0.05]))
            for hull in hulls_of(package, "link_1")
        )
        return with_link(package, "link_1", hulls=moved)
    if defect == "impossible inertia":
        assert body.inertial is not None
        bad = Inertial(mass=1.0, com=body.inertial.com, inertia=np.diag([1.0, 0.1, 0.1]))
        return with_link(package, "link_0", inertial=bad)
    if defect == "stiff knob":  # an overdamped knob turns at the speed of the time step
        return with_joint(package, "joint_2", damping=0.04)
    raise ValueError(defect)


@pytest.mark.usefixtures("one_step_size")
@pytest.mark.parametrize(
    ("defect", "check"),
    [
        ("jammed", "V304"),
        ("tray behind a closed door", "V304"),
        ("stuck", "V304"),
        ("no friction", "V305"),
        ("slanted runners", "V302"),
        ("top-heavy", "V303"),
        ("overlapping siblings", "V302"),
        ("impossible inertia", "V308"),
    ],
)
def test_a_seeded_defect_fails_its_check(package, tmp_path, defect, check):
    wrong = seeded(package, defect)
    folder = write_package(wrong, tmp_path / "cabinet")
    verdicts = {result.id: result.verdict for result in check_dynamics(folder, wrong)}
    assert verdicts[check] == "fail"
    assert verdicts["V301"] == verdicts["V307"] == "pass"


@pytest.mark.parametrize(
    ("kind", "upper", "allowed"),
    [
        ("revolute", 2.0, 0.02),
        ("revolute", 0.5, np.radians(0.5)),
        ("prismatic", 0.4, 0.004),
        ("prismatic", 0.0013, 1e-4),
    ],
)
def test_a_joint_keeps_its_place_within_what_counts_as_its_limit(trials, kind, upper, allowed):
    joint = replace(trials.joints[0], type=kind, lower=0.0, upper=upper)
    none = np.zeros(1)
    for drift, verdict in ((0.999 * allowed, "pass"), (1.001 * allowed, "fail")):
        moved = np.array([drift])
        run = replace(trials, joints=(joint,), rest_drift=moved, rest_speed=none, lean_drift=moved)
        for check in (check_rest, check_stays_closed):
            result = check(run)
            assert (result.verdict, result.threshold) == (verdict, pytest.approx(allowed, rel=1e-3))


@pytest.mark.parametrize("speed", [0.0, 0.5])
def test_speeds_at_rest_are_those_of_positions(speed: float):
    """Whatever the engine reports of a joint that sleeps."""
    articulation = SimpleNamespace(qpos=np.zeros(1), qvel=np.full(1, 0.2))

    def step() -> None:
        articulation.qpos = articulation.qpos + 0.01 * speed

    scene = SimpleNamespace(timestep=0.01)
    joint = SimpleNamespace(index=0)
    loaded = SimpleNamespace(articulation=articulation, scene=scene, joints=(joint,), step=step)
    assert trials_module._rest(loaded, [])[1] == pytest.approx([speed])


def test_what_depends_on_the_step_size_fails_v309(package, tmp_path, monkeypatch):
    wrong = seeded(package, "stiff knob")
    folder = write_package(wrong, tmp_path / "cabinet")
    monkeypatch.setattr(dynamics, "TIMESTEP", 1 / 240)
    monkeypatch.setattr(dynamics, "OTHER_TIMESTEPS", (1 / 60,))
    results = {result.id: result for result in check_dynamics(folder, wrong)}
    assert results["V304"].verdict == "pass"
    assert results["V309"].verdict == "fail"
    assert "V304 at 1/60 s (joint_2" in results["V309"].message


@pytest.mark.usefixtures("one_step_size")
def test_scenes_do_not_depend_on_what_ran_in_the_process_before(package, folder):
    """ManiSkill sets PhysX's global settings to its own."""
    from sapien import physx

    def measure() -> dict[str, float]:
        return {result.id: result.value for result in check_dynamics(folder, package)}

    expected = measure()
    physx.set_body_config(solver_position_iterations=1, solver_velocity_iterations=0, sleep_threshold=0.1)
    physx.set_shape_config(contact_offset=0.05, rest_offset=0.002)
    physx.set_scene_config(enable_pcm=False, enable_tgs=False, bounce_threshold=0.1)
    physx.set_default_material(1.0, 1.0, 0.5)
    assert measure() == expected


def test_hulls_that_sapien_knows_behave_as_those_it_reads(folder, package, trials):
    known = run_trials(folder, package, 0.01)
    np.testing.assert_array_equal(known.trace, trials.trace)


def lose_a_hull(folder: Path) -> None:
    mesh_collisions(folder)
    (folder / "collision" / "link_3_1.obj").unlink()


def flatten_inertia(folder: Path) -> None:
    urdf = folder / "mobility.urdf"
    head, tail = urdf.read_text().split('<link name="link_1">')
    values = tail.split("<inertia ")[1].split("/>")[0]
    zero = " ".join(f'{name}="0"' for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    urdf.write_text(head + '<link name="link_1">' + tail.replace(values, zero, 1))


@pytest.mark.usefixtures("one_step_size")
@pytest.mark.parametrize(
    ("damage", "where"), [(lose_a_hull, "link_3"), (flatten_inertia, "link_1")], ids=["hull", "inertia"]
)
def test_what_sapien_passes_over_fails_v301(package, tmp_path, damage: Callable[[Path], None], where):
    folder = write_package(package, tmp_path / "cabinet")
    damage(folder)
    result = check_dynamics(folder, package)[0]
    assert (result.id, result.verdict, result.where) == ("V301", "fail", where)


def test_joints_that_could_meet_are_tried_apart(package, tmp_path):
    """Two square knobs side by side that meet only where both are turned by 45 degrees."""
    from envs.plan import plan_trials
    from envs.sim.sapien import LoadConfig, load_package
    from envs.sim.scene import create_scene

    body = next(link for link in package.links if link.label == "base")
    turning = package.joints[0]

    def knobs(distance: float) -> SimPackage:
        links, joints = [], []
        for k in range(2):
            at = np.array([-0.5, k * distance, 0.5])
            half = np.array([0.01, 0.02, 0.02])
            inertial = Inertial(mass=0.05, com=at, inertia=1e-4 * np.eye(3))
            hull = box_hull(at - half, at + half)
            links.append(
                replace(body, name=f"link_{k}", label="knob", parts=(), visuals=(), hulls=(hull,),
                        inertial=inertial)
            )  # fmt: skip
            joints.append(
                replace(turning, name=f"joint_{k}", type="continuous", parent=body.name,
                        child=f"link_{k}", origin=at, axis=np.array([-1.0, 0.0, 0.0]), upper=2 * np.pi,
                        velocity=6.0, friction=0.04, damping=1e-4)
            )  # fmt: skip
        return replace(package, links=(*links, body), joints=tuple(joints), handles=(), requires_open=())

    groups = {}
    for distance in (0.0565, 0.0567):  # corners reach 28.3 mm from the axis
        folder = write_package(knobs(distance), tmp_path / f"{distance}")
        loaded = load_package(create_scene(0.01), folder, LoadConfig())
        groups[distance] = len(plan_trials(loaded).groups)
    assert groups == {0.0565: 2, 0.0567: 1}


def test_energy_from_nowhere_fails_v306(trials):
    assert check_energy(trials).verdict == "pass"
    fast = replace(trials.pulls[0], peak_speed=10 * trials.plan.joints[0].speed_limit)
    assert check_energy(replace(trials, pulls=(fast, *trials.pulls[1:]))).verdict == "fail"
    assert check_energy(replace(trials, size_ratio=11.0)).verdict == "fail"


def test_a_different_second_run_fails_v307(folder, package, trials):
    assert check_repeat(folder, package, trials).verdict == "pass"
    other = replace(trials, trace=trials.trace + 2e-6)
    assert check_repeat(folder, package, other).verdict == "fail"


def test_only_what_is_mounted_or_held_may_overhang(package, trials):
    tipped = replace(trials, stand=replace(trials.stand, overhang=0.1, tilt=60.0))
    assert check_stand(package, tipped).verdict == "fail"
    assert "outside" in check_stand(package, tipped).message
    assert check_stand(replace(package, category="Faucet"), tipped).verdict == "not_applicable"
    assert check_stand(replace(package, category="Faucet"), trials).verdict == "pass"


@pytest.mark.parametrize(
    ("tilt", "drift", "verdict"), [(2.01, 0.0, "not_applicable"), (1.99, 0.0, "pass"), (0.0, 0.0051, "fail")]
)
def test_what_is_mounted_is_judged_only_while_it_stands(tilt, drift, verdict, package, trials):
    stand = replace(trials.stand, overhang=-0.01, tilt=tilt, drift=drift)
    judged = check_stand(replace(package, category="Faucet"), replace(trials, stand=stand))
    assert judged.verdict == verdict


def test_a_folding_door_closes_once_its_second_leaf_has_come_to_rest(tmp_path):
    """At its limit the first of two leaves of 13 kg stops, and the second swings on and holds it."""
    package = build_reference(draw_shape("StorageFurniture", 1346))
    folder = write_package(package, tmp_path / "cabinet")
    assert check_opens(run_trials(folder, package, 0.01)).verdict == "pass"


@pytest.mark.usefixtures("one_step_size")
def test_what_does_not_move_has_nothing_to_open(package, tmp_path):
    body = next(link for link in package.links if link.name == "link_4")
    base = Link(name="base", label=None, parts=(), visuals=(), hulls=(), inertial=None)
    fixed = Joint(name="joint_0", type="fixed", parent="base", child="link_4", axis=package.joints[0].axis)
    block = replace(package, links=(base, body), joints=(fixed,), handles=(), requires_open=())
    folder = write_package(block, tmp_path / "block")
    verdicts = {result.id: result.verdict for result in check_dynamics(folder, block)}
    applies = {name for name, verdict in verdicts.items() if verdict != "not_applicable"}
    assert applies == {"V301", "V303", "V307", "V308", "V309"}
    assert {verdicts[name] for name in applies} == {"pass"}


def test_mujoco_leaves_nothing_in_the_working_directory(folder, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert check_mujoco(folder).verdict == "pass"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("one_step_size")
@pytest.mark.real
def test_original_objects_get_a_verdict_on_everything(real_objects):
    for name in ("10040", "44781"):
        folder = real_objects / "partnet_mobility" / name
        results = check_dynamics(folder, read_package(folder))
        assert [result.id for result in results] == sorted(TITLES)
        assert results[0].verdict == "pass"
        assert "assumes the mass" in results[0].message
