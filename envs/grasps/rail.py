"""The rail along which a gripper is carried, and the times of a trial.

The gripper hangs on two virtual joints in series, a turning and a sliding one about the axis of the joint
that it opens; position drives take it along the path of the grasped link. Its fingers slide, press with a
constant force, and are coupled as by the gear of a real one: drives hold each at the mean of both.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.transforms import transform_points
from sim_export.files.urdf import link_origins
from sim_export.grasps.carry import carried_to, joint_range, place_link
from sim_export.grasps.gripper import Gripper, find_gripper
from sim_export.grasps.poses import SPARE
from sim_export.motion.kinematics import object_joints, required_openings
from sim_export.package import Grasp, SimPackage

LIFT = 0.2
"""Height (m) by which loose objects are lifted."""
CLOSE, REST = 0.3, 0.2
"""Seconds in which the fingers close, and in which the gripper waits at the end of its path."""
LET_GO = 0.5
"""Seconds for which a joint must stay where a stroke left it."""
SPEED = 0.6
"""Most (m/s) that the gripper moves, but not faster than joints may."""
LEAST = 0.8
"""Least seconds of a motion."""
PEAK = 1.875
"""Largest over mean speed of a motion."""
LOOK = 0.1
"""Seconds at the end in which each finger must touch the link."""
COUPLING = 3e3
"""Stiffness (N/m) of the drives that keep the fingers together. MuJoCo's step is too long for more than
three times as much: fingers then shake, and what a spring pulls creeps out of them."""
FINGER_MASS, PALM_MASS = 0.1, 0.8
ARMATURE, FREQUENCY = 10.0, 100.0
"""Inertia (kg, kg m^2) and natural frequency (rad/s) of the rail's drives."""
RAIL_GAINS = (ARMATURE * FREQUENCY**2, 2.0 * ARMATURE * FREQUENCY)
FINGER_GAINS = (COUPLING, 2.0 * (COUPLING * FINGER_MASS) ** 0.5)
"""Stiffness and damping of the drives, the latter critical."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Rail:
    """The path of a gripper; object frame, which is the world's.

    ``start`` is the gripper's pose as it closes; the ``turn`` (rad) about ``axis`` through ``origin`` and the
    ``slide`` (m) along it take it to the end in ``move`` seconds. ``needs`` are coordinates of joints by name
    as the trial begins. ``point`` is where it holds the ``link``, in that one's frame. ``lower`` and ``span``
    are the stroke of the joint of the package that is opened; "" is none. The open fingers ``wait`` (s)
    before they close, so that a joint which does not stay where the stroke before left it leaves them.
    """

    gripper: Gripper
    start: Float[np.ndarray, "4 4"]
    axis: Float[np.ndarray, "3"]
    origin: Float[np.ndarray, "3"]
    turn: float
    slide: float
    width: float
    joint: str
    link: str
    point: Float[np.ndarray, "3"]
    needs: dict[str, float]
    lower: float
    span: float
    move: float
    wait: float = 0.0

    def press(self, time: float) -> float:
        """Force (N) on each finger at a time (s) of the trial, negative as it closes."""
        return -self.gripper.force if time >= self.wait else 0.0

    @property
    def gap(self) -> float:
        """Opening (m) of the fingers as the trial begins."""
        return self.width + 2.0 * SPARE

    def share(self, time: float) -> float:
        """Share of the path at a time (s) of the trial, smooth at both ends."""
        s = float(np.clip((time - self.wait - CLOSE) / self.move, 0.0, 1.0))
        return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)

    @property
    def seconds(self) -> float:
        """Length of a trial."""
        return self.wait + CLOSE + self.move + REST


def lay_rail(package: SimPackage, grasp: Grasp) -> Rail:
    """The rail of a grasp.

    Raises:
        PackageError: If there is no gripper of the grasp's name.
    """
    gripper = find_gripper(grasp.gripper)
    up = np.array([0.0, 0.0, 1.0])
    rail = Rail(
        gripper=gripper, start=grasp.pose, axis=up, origin=np.zeros(3), turn=0.0, slide=LIFT,
        width=grasp.width, joint="", link=grasp.link,
        point=grasp.pose[:3, 3] - link_origins(package)[grasp.link], needs={}, lower=0.0, span=LIFT,
        move=max(LEAST, PEAK * LIFT / SPEED),
    )  # fmt: skip
    if not grasp.joint:
        return rail
    joint = next(joint for joint in object_joints(package.joints) if joint.name == grasp.joint)
    rest = place_link(package, grasp)
    low, high = joint_range(joint)
    lower, upper = (low + share * (high - low) for share in grasp.stroke)
    travel = (carried_to(*grasp.stroke) - grasp.stroke[0]) * (high - low)
    sliding = joint.type == "prismatic"
    arm = grasp.pose[:3, 3] - joint.origin
    lever = 1.0 if sliding else float(np.linalg.norm(np.cross(joint.axis, arm)))
    fastest = min(SPEED / max(lever, 1e-3), joint.velocity)
    return replace(
        rail,
        start=rest @ grasp.pose,
        axis=rest[:3, :3] @ joint.axis,
        origin=transform_points(rest, np.asarray(joint.origin)[None])[0],
        turn=0.0 if sliding else travel,
        slide=travel if sliding else joint.pitch * travel,
        joint=grasp.joint,
        needs=required_openings(joint, package.joints, package.requires_open) | {grasp.joint: lower},
        lower=lower,
        span=upper - lower,
        move=max(LEAST, PEAK * travel / fastest),
        wait=LET_GO if grasp.stroke[0] > 0.0 else 0.0,
    )
