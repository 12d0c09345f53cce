"""Laws of lamps: hinges that hold their arms in every pose, and shades that weigh what sheet does."""

import numpy as np
import pytest

from artigen.shapes.draw import draw_shape
from artigen.shapes.fittings.hardware import rotate
from artigen.shapes.primitives import box
from artigen.shapes.shape import Shape, ShapePart
from artigen.shapes.surfaces.finishes import Finish
from sim_export.motion.kinematics import link_displacements
from sim_export.package import SimPackage
from sim_export.physics.materials import GRAVITY
from sim_export.reference import build_reference

PLASTIC = Finish(kind="plastic", color=(0.5, 0.5, 0.5), accent=(0.5, 0.5, 0.5))
ARMS = ("joint_0", "joint_1", "joint_2")


@pytest.fixture(scope="module", params=[9, 100])
def lamp(request) -> SimPackage:
    return build_reference(draw_shape("DeskLamp", request.param))


def energy(lamp: SimPackage, qpos: dict[str, object], down: np.ndarray) -> np.ndarray:
    """Potential energy (J) of all links."""
    T = link_displacements(lamp.links, lamp.joints, qpos)
    total = np.zeros(T.shape[:-3])
    for k, link in enumerate(lamp.links):
        assert link.inertial is not None
        com = T[..., k, :3, :3] @ link.inertial.com + T[..., k, :3, 3]
        total -= link.inertial.mass * GRAVITY * (com @ down)
    return total


def moments(lamp: SimPackage, name: str, slope: float) -> np.ndarray:
    """Moments (N m) of gravity about a hinge at 500 poses on a slope (rad) in eight directions."""
    rng, step = np.random.default_rng(0), 1e-5
    qpos: dict[str, object] = {
        joint.name: rng.uniform(0.0, joint.upper, 500) for joint in lamp.joints if joint.name in ARMS
    }
    out = []
    for heading in np.linspace(0.0, 2 * np.pi, 8, endpoint=False):
        aside = np.sin(slope) * np.array([np.cos(heading), np.sin(heading)])
        down = np.array([*aside, -np.cos(slope)])
        ahead = energy(lamp, qpos | {name: np.asarray(qpos[name]) + step}, down)
        out.append((ahead - energy(lamp, qpos, down)) / step)
    return np.abs(out)


@pytest.mark.parametrize("name", ARMS)
def test_a_hinge_holds_its_arm_in_every_pose_on_a_slope_of_five_degrees(lamp, name):
    hinge = next(joint for joint in lamp.joints if joint.name == name)
    assert moments(lamp, name, np.radians(5.0)).max() < hinge.friction


def test_the_first_hinge_resists_no_more_than_its_load_demands(lamp):
    """A hand moves the lamp: friction is a tenth above the moment with the arms stretched out level."""
    hinge = next(joint for joint in lamp.joints if joint.name == "joint_0")
    level = moments(lamp, "joint_0", np.pi / 2).max()  # gravity along the floor, in eight directions
    assert level < hinge.friction < 1.25 * level


def test_the_handle_of_a_window_stays_turned_while_the_window_is_open():
    """It points down at rest, where gravity has no moment; if it falls back, its tongue stops the leaf."""
    window = build_reference(draw_shape("Window", 1015))
    handle = next(joint for joint in window.joints if joint.name == "joint_1")
    own = next(link.inertial for link in window.links if link.name == handle.child)
    assert own is not None
    arm = np.cross(handle.axis, own.com - handle.origin)
    assert handle.friction > own.mass * GRAVITY * float(np.linalg.norm(arm))


def weigh_plate(*, moves: bool) -> float:
    """Mass (kg) that a plate of 0.2 m x 0.2 m x 8 mm labelled as a handle adds to a lamp."""
    foot = ShapePart(
        name="body", label="base", parent=None, primitives=(box((0, 0, 0), (0.3, 0.3, 0.05), "plastic"),)
    )
    plate = ShapePart(
        name="shade",
        label="handle",
        parent="body",
        primitives=(box((0, 0, 0.05), (0.2, 0.2, 0.058), "plastic"),),
        joint=rotate((0.0, 1.0, 0.0), (0.0, 0.0, 0.0), 1.0) if moves else None,
    )
    lamp, bare = (
        Shape(category="DeskLamp", seed=0, style="led", parts=parts, finishes=(("plastic", PLASTIC),))
        for parts in ((foot, plate), (foot,))
    )
    loaded, empty = (
        sum(link.inertial.mass for link in build_reference(shape).links if link.inertial)
        for shape in (lamp, bare)
    )
    return loaded - empty


def test_a_shade_on_a_hinge_is_sheet_and_a_handle_that_is_fixed_is_solid():
    assert weigh_plate(moves=False) == pytest.approx(1050.0 * 0.04 * 0.008)
    assert weigh_plate(moves=True) == pytest.approx(2700.0 * 0.04 * 0.001, rel=0.1)  # aluminium
