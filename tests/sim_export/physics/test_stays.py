"""Lids whose hinges hold them wherever they are left, and the grips on them."""

from math import radians
from pathlib import Path

import numpy as np
import pytest

from artigen.shapes.draw import draw_shape
from artigen.shapes.fittings.carrying import make_grip
from artigen.shapes.fittings.hardware import GAP
from artigen.shapes.fittings.lids import make_lid
from artigen.shapes.primitives import box, place_vertices
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from artigen.transforms import rotation_about
from artigen.types import Joint
from sim_export.files.read import read_package
from sim_export.files.write import write_package
from sim_export.package import SimPackage
from sim_export.physics.inertia import subtree_inertial
from sim_export.physics.materials import GRAVITY
from sim_export.physics.resistance import HOLD_SLOPE, STAY_FORCE
from sim_export.reference import build_reference

FINISH = Finish(kind="wood", color=(0.5, 0.5, 0.5), accent=(0.4, 0.4, 0.4))


def make_box(thick: float, *, stays: bool = True, low: float = 0.1) -> Shape:
    """A block with a wooden lid of 0.3 m by 0.4 m, and a grip on the lid, at a height above the hinge."""
    x, y, rim = (-0.15, 0.15), (-0.2, 0.2), 0.2
    body = ShapePart("body", "base", (box((x[0], y[0], 0.0), (x[1], y[1], rim), "paint"),), parent=None)
    slab = box((x[0], y[0], rim + GAP + low), (x[1], y[1], rim + GAP + low + thick), "paint")
    skirt = box((x[0], y[0], rim + GAP), (x[1], y[1], rim + GAP + low + 0.5 * thick), "paint")
    lid = make_lid((slab, skirt), x, y, rim + GAP, radians(100), stays=stays)
    at = (0.0, 0.0, rim + GAP + low + thick)
    grip = make_grip(at, 0.12, name="grip", parent="lid", finish="paint")
    finishes = (("paint", FINISH),)
    return Shape(category="Vessel", seed=0, style="plain", parts=(body, lid, grip), finishes=finishes)


def hinge_of(package: SimPackage) -> Joint:
    return next(joint for joint in package.joints if joint.type == "revolute")


def find_lid(package: SimPackage) -> Joint:
    owner = next(link.name for link in package.links if link.parts[:1] == ("lid",))
    return next(joint for joint in package.joints if joint.child == owner)


def weigh(package: SimPackage, joint: Joint, q: np.ndarray) -> np.ndarray:
    """Torque of the weight (N m) about a hinge at its coordinates; above 0 it opens."""
    moved = subtree_inertial(package.links, package.joints, joint.child)
    arms = rotation_about(np.asarray(joint.axis), q) @ (np.asarray(moved.com) - joint.origin)
    return np.cross(arms, [0.0, 0.0, -GRAVITY * moved.mass]) @ joint.axis


@pytest.mark.parametrize(
    ("kind", "seed"), [("ChestFreezer", 1005), ("ChestFreezer", 1009), ("ToolBox", 1005), ("BreadBox", 1008)]
)
def test_a_lid_stays_wherever_it_is_left_and_does_not_open_by_itself(kind: str, seed: int):
    package = build_reference(draw_shape(kind, seed))
    lid = find_lid(package)
    q = np.linspace(0.0, lid.upper, 50)
    load = weigh(package, lid, q) - lid.spring - lid.stiffness * q
    assert np.abs(load).max() < lid.friction
    assert load[0] < 0.0


def test_friction_holds_a_light_lid_and_springs_take_the_rest_of_a_heavy_one():
    seen = set()
    for thick in np.linspace(0.005, 0.2, 14):
        package = build_reference(make_box(float(thick), low=0.01))
        lid = hinge_of(package)
        moved = subtree_inertial(package.links, package.joints, lid.child)
        moment = (1 + HOLD_SLOPE) * GRAVITY * moved.mass * float(np.hypot(*(moved.com - lid.origin)[[0, 2]]))
        hulls = next(link.hulls for link in package.links if link.name == lid.child)
        points = np.concatenate([hull.vertices for hull in hulls]) - lid.origin
        most = STAY_FORCE * float(np.hypot(points[:, 0], points[:, 2]).max())
        assert lid.friction == pytest.approx(min(moment, most), rel=1e-6)
        assert lid.spring == pytest.approx(min(0.0, most - moment), abs=1e-9)
        seen.add(lid.spring < 0.0)
    assert seen == {False, True}


def test_hinges_without_stays_have_no_spring_and_little_friction():
    loose, tight = (hinge_of(build_reference(make_box(0.1, stays=stays))) for stays in (False, True))
    assert loose.spring == 0.0
    assert loose.friction < 0.1 * tight.friction


def test_a_counterbalance_is_the_same_in_every_file(tmp_path: Path):
    mujoco = pytest.importorskip("mujoco")
    package = build_reference(make_box(0.2))
    lid = hinge_of(package)
    assert lid.spring < 0.0
    folder = write_package(package, tmp_path / "box")
    assert hinge_of(read_package(folder)).spring == pytest.approx(lid.spring, rel=1e-6)
    model = mujoco.MjModel.from_xml_path(str(folder / "mobility.mjcf.xml"))
    data = mujoco.MjData(model)
    at = model.joint(lid.name).qposadr[0]
    for share in (0.0, 0.5, 1.0):
        data.qpos[at] = share * lid.upper
        mujoco.mj_forward(model, data)
        assert data.qfrc_spring[at] == pytest.approx(-lid.spring * (1.0 - share / 1.5), rel=1e-6)
    assert f"{lid.name}: a spring counterbalances it" in (folder / "meta.json").read_text()


@pytest.mark.sim
@pytest.mark.parametrize("share", [0.2, 0.5, 0.7])
def test_in_sapien_a_heavy_lid_stays_where_it_is_left(tmp_path: Path, share: float):
    sapien = pytest.importorskip("sapien")
    from envs.sim.loaded import set_open_fraction
    from envs.sim.sapien import LoadConfig, load_package

    package = build_reference(make_box(0.08, low=0.01))
    assert hinge_of(package).spring < 0.0
    folder = write_package(package, tmp_path / "box")
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(0.01)
    loaded = load_package(scene, folder, LoadConfig())
    begin = set_open_fraction(loaded, share).copy()
    for _ in range(300):
        loaded.step()
    np.testing.assert_allclose(loaded.articulation.qpos, begin, atol=2e-3)


@pytest.mark.parametrize("low", [0.02, 0.1, 0.3])
def test_a_grip_points_away_from_its_lid_however_high_it_is_above_the_hinge(low: float):
    """Its first motion slants across the lid."""
    (grip,) = build_reference(make_box(0.02, low=low)).handles
    np.testing.assert_allclose(grip.normal, [0.0, 0.0, 1.0], atol=1e-9)


def test_a_grip_turns_between_fingers():
    """Its bar is round about the hinge's direction."""
    bar = make_grip((0.0, 0.0, 0.1), 0.12, name="grip", parent="lid").primitives[0]
    assert bar.kind == "cylinder"
    width, length, height = np.ptp(place_vertices(bar), axis=0)
    assert length == pytest.approx(0.12)
    assert width == pytest.approx(height) == pytest.approx(0.016, rel=0.03)
