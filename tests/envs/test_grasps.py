"""Grasps in engines: what holds passes in both, what does not is caught, and both survive the files."""

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import yaml
from pulled_drawer import TRAVEL, pulled_drawer

import artigen
from artigen.api.grasps import export_grasps, store_grasps
from artigen.transforms import shift
from envs.grasps import mujoco, rail
from envs.grasps.mujoco import MujocoTrials
from envs.grasps.rail import COUPLING, lay_rail
from envs.grasps.sapien import SapienTrials
from sim_export.checks.suite import run_checks
from sim_export.files.grasp_formats import COLUMNS, hand_pose, table_text
from sim_export.files.read import read_package
from sim_export.files.urdf import link_origins
from sim_export.files.write import manifest_problems, write_package
from sim_export.geometry.hulls import box_hull
from sim_export.grasps.carry import place_link
from sim_export.grasps.find import find_grasps
from sim_export.grasps.gripper import FRANKA
from sim_export.package import Mesh, SimPackage
from sim_export.physics.inertia import mesh_inertial

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return write_package(pulled_drawer(), tmp_path_factory.mktemp("grasps") / "pulled")


@pytest.fixture(scope="module")
def proven(folder: Path) -> SimPackage:
    return artigen.grasps(folder, "franka").package


def trials(folder: Path, package: SimPackage, *, loose: bool = False):
    yield SapienTrials(folder, package, loose=loose)
    yield MujocoTrials(folder, package, FRANKA, loose=loose)


def test_a_drawer_is_pulled_open_by_its_bar_in_both_engines(proven: SimPackage):
    assert sum(grasp.proven for grasp in proven.grasps) == 3
    for grasp in proven.grasps[:3]:
        assert [proof.engine for proof in grasp.proofs] == ["sapien", "mujoco"]
        assert all(proof.held and 0.9 <= proof.opened <= 1.0 + 1e-3 for proof in grasp.proofs)


def test_an_object_says_its_grasps_as_they_are_exported(folder: Path, proven: SimPackage):
    said = artigen.load(folder).grasps("franka", engines=("mujoco",))
    for one, other in zip(said, proven.grasps, strict=True):
        np.testing.assert_array_equal(one.pose, other.pose)
        assert one.proofs[0].opened == other.proofs[1].opened


def test_a_stroke_begins_where_it_says_and_the_gripper_ends_with_the_link(folder: Path, proven: SimPackage):
    later = replace(proven.grasps[0], stroke=(0.45, 1.0))
    np.testing.assert_allclose(place_link(proven, later)[:3, 3], [-0.45 * TRAVEL, 0.0, 0.0], atol=1e-9)
    for stage in trials(folder, proven):
        proof = stage.prove(lay_rail(proven, later))
        assert proof.held
        assert proof.opened == pytest.approx(0.95, abs=0.02)  # of the stroke, not of the range


def test_a_drawer_that_a_spring_closes_is_not_left_half_open(tmp_path: Path, proven: SimPackage):
    later = replace(proven.grasps[0], stroke=(0.45, 1.0))
    sprung = replace(proven, joints=(replace(proven.joints[0], spring=20.0),))
    for stage in trials(write_package(sprung, tmp_path / "sprung"), sprung):
        assert stage.prove(lay_rail(sprung, proven.grasps[0])).passed
        assert not stage.prove(lay_rail(sprung, later)).passed


def test_a_drawer_is_seen_to_come_back_only_if_it_is_left_alone_for_half_a_second(
    tmp_path: Path, proven: SimPackage, monkeypatch
):
    """Against 2 N of friction a spring that pulls with 2 to 4 N takes 2 kg back by 80 mm in 0.4 s."""
    later = replace(proven.grasps[0], stroke=(0.45, 1.0))
    sprung = replace(proven, joints=(replace(proven.joints[0], spring=2.0),))
    assert lay_rail(sprung, later).wait == 0.5
    for stage in trials(write_package(sprung, tmp_path / "sprung"), sprung):
        assert not stage.prove(lay_rail(sprung, later)).held
        with monkeypatch.context() as short:
            short.setattr(rail, "LET_GO", 0.1)
            assert stage.prove(lay_rail(sprung, later)).passed


def test_what_a_spring_pulls_does_not_creep_out_of_the_pads_unless_the_fingers_shake(
    tmp_path: Path, proven: SimPackage, monkeypatch
):
    sprung = replace(proven, joints=(replace(proven.joints[0], spring=10.0),))
    folder, path = write_package(sprung, tmp_path / "sprung"), lay_rail(sprung, proven.grasps[0])
    opened = []
    for stiffness in (3e2, 3e3, 1e4, 2e4):
        monkeypatch.setattr(mujoco, "FINGER_GAINS", (stiffness, 2.0 * (stiffness * 0.1) ** 0.5))
        opened.append(MujocoTrials(folder, sprung, FRANKA, loose=False).prove(path).opened)
    np.testing.assert_allclose(opened[:3], 0.95, atol=5e-3)
    assert opened[3] < 0.945
    assert 3e2 <= COUPLING <= 1e4


def test_a_gripper_beside_the_bar_or_without_force_is_caught(folder: Path, proven: SimPackage):
    beside = replace(proven.grasps[0], pose=shift(np.array([0.0, 0.0, 0.1])) @ proven.grasps[0].pose)
    path = lay_rail(proven, proven.grasps[0])
    weak = replace(path, gripper=replace(FRANKA, force=0.05))
    for stage in trials(folder, proven):
        assert not stage.prove(lay_rail(proven, beside)).passed
        assert not stage.prove(weak).passed
        assert stage.prove(path).passed  # and what was tried before leaves no trace


def test_a_loose_box_is_lifted(tmp_path: Path):
    drawer = pulled_drawer()
    cube = box_hull(np.array([0.1, 0.0, 0.0]), np.array([0.14, 0.06, 0.05]))
    shown = replace(drawer.links[1].visuals[0], mesh=Mesh(vertices=cube.vertices, faces=cube.faces))
    box = replace(drawer.links[1], hulls=(cube,), visuals=(shown,), inertial=mesh_inertial(cube, 600.0))
    joint = replace(drawer.joints[0], type="fixed", upper=0.0, friction=0.0, damping=0.0, parent="base")
    base = replace(box, name="base", hulls=(), visuals=(), parts=(), inertial=None, label=None)
    package = replace(drawer, name="box", links=(base, box), joints=(joint,), handles=())
    (found,) = find_grasps(package, FRANKA)
    assert found.target.joint is None
    made = write_package(package, tmp_path / "box")
    for stage in trials(made, package, loose=True):
        proof = stage.prove(lay_rail(package, found.grasps[0]))
        assert proof.passed, (stage.engine, proof)
        assert proof.opened == pytest.approx(1.0, abs=0.1)


def test_grasps_survive_their_files_and_the_checks_find_a_moved_one(tmp_path: Path, proven: SimPackage):
    made = write_package(pulled_drawer(), tmp_path / "pulled")
    proven = replace(proven, grasps=(replace(proven.grasps[0], stroke=(0.45, 1.0)), *proven.grasps[1:]))
    store_grasps(proven, made)
    assert not manifest_problems(made)
    again = read_package(made)
    assert len(again.grasps) == len(proven.grasps)
    for one, other in zip(again.grasps, proven.grasps, strict=True):
        np.testing.assert_allclose(one.pose, other.pose, atol=1e-8)
        assert (one.proven, one.stroke) == (other.proven, other.stroke)
        assert (one.link, one.joint, one.gripper) == (other.link, other.joint, other.gripper)
    assert [check.verdict for check in run_checks(made, only=("V207",))] == ["pass"]
    moved = replace(again.grasps[0], pose=shift(np.array([0.0, 0.0, 0.05])) @ again.grasps[0].pose)
    store_grasps(replace(again, grasps=(moved,)), made)
    (check,) = run_checks(made, only=("V207",))
    assert check.verdict == "fail"
    assert "which it should touch" in check.message


def test_the_formats_of_others_state_the_same_poses(tmp_path: Path, proven: SimPackage):
    export_grasps(proven, tmp_path)
    with h5py.File(tmp_path / "pulled_franka.h5") as file:
        T = np.array(file["grasps/transforms"])
        assert np.array(file["grasps/qualities/flex/object_in_gripper"]).sum() == 3
        assert (tmp_path / file["object/file"][()].decode()).is_file()
    tips = T @ np.array([[0.041, 0.0, 0.1034, 1.0], [-0.041, 0.0, 0.1034, 1.0]]).T  # ACRONYM's fingers
    middles = tips.mean(axis=2)[:, :3]
    np.testing.assert_allclose(middles, [grasp.pose[:3, 3] for grasp in proven.grasps], atol=1e-9)
    across = (tips[:, :3, 0] - tips[:, :3, 1]) / 0.082
    np.testing.assert_allclose(across, [grasp.pose[:3, 1] for grasp in proven.grasps], atol=1e-9)
    isaac = yaml.safe_load((tmp_path / "pulled_franka_link_0.yaml").read_text())
    assert (isaac["format"], isaac["format_version"]) == ("isaac_grasp", 1.0)
    first, grasp = isaac["grasps"]["grasp_0"], proven.grasps[0]
    place = hand_pose(grasp)[:3, 3] - link_origins(proven)["link_0"]
    np.testing.assert_allclose(first["position"], place, atol=1e-8)
    assert first["cspace_position"]["panda_finger_joint1"] == pytest.approx(grasp.width / 2, abs=1e-6)
    assert first["confidence"] == pytest.approx(grasp.score, abs=1e-4)
    rows = table_text([proven]).splitlines()
    assert rows[0].split(",") == list(COLUMNS)
    assert len(rows) == 1 + len(proven.grasps)
