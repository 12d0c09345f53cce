"""Sets joint friction, damping and maximum speed in SI units, which SAPIEN's loader ignores.

SAPIEN ignores a URDF's ``<dynamics friction>`` and ``<limit velocity>``. PhysX's own joint friction is a
unitless coefficient whose holding force depends on the time step and on the number of solver iterations
(``benchmarks/friction_calibration.py`` measures this). Two other constraints are exact at any step size: a
velocity drive at rest with a force limit is Coulomb friction, and a fixed tendon over one joint is a viscous
damper beside it.

Followers and springs, which SAPIEN's loader does not support either, are simulated at every step: SAPIEN's
own coupling, a stiff tendon, adds energy to joints, and a tendon used as a spring pulls several times too
hard.
"""

from typing import TYPE_CHECKING

import numpy as np

from artigen.types import Joint
from sim_export.package import SimPackage
from sim_export.physics.inertia import inertia_about, subtree_inertial

if TYPE_CHECKING:
    from sapien.physx import PhysxArticulation, PhysxArticulationJoint


CREEP = 1e-5
"""Speed (m/s or rad/s) at which the drive reaches its friction force: a joint loaded just below its friction
creeps at this speed, and a faster joint feels the whole force."""
CHAIN_ITERATIONS = 40
"""Position iterations of PhysX where a leaf hangs on a leaf, instead of SAPIEN's 10. At every step the joint
of the first leaf gives way to the load of the second in one iteration out of all."""
FREQUENCY = 1000.0
"""Natural frequency (rad/s) of the drive that couples a follower: under its own weight a part sags by g /
frequency^2 at most, a hundredth of a millimetre."""


def apply_resistance(articulation: "PhysxArticulation", joint: "PhysxArticulationJoint", spec: Joint) -> None:
    """Applies a package's friction, damping and maximum speed to one of its joints; a joint with neither
    friction nor damping is left to the engine."""
    if spec.friction == 0.0 and spec.damping == 0.0:
        return
    apply_friction(joint, spec.friction)
    apply_damping(articulation, joint, spec.damping)
    if spec.velocity > 0.0:
        apply_velocity(joint, spec.velocity)


def apply_friction(joint: "PhysxArticulationJoint", friction: float) -> None:
    """Replaces a joint's resistance by Coulomb friction of ``friction`` newtons or newton metres.

    Uses the joint's drive; setting another drive on the joint later replaces the friction.
    """
    if not friction >= 0.0:
        raise ValueError(f"joint {joint.name!r}: friction {friction}, expected >= 0")
    joint.set_friction(0.0)
    if friction > 0.0:
        joint.set_drive_velocity_target(0.0)
        joint.set_drive_properties(
            stiffness=0.0, damping=friction / CREEP, force_limit=friction, mode="force"
        )
    else:
        joint.set_drive_properties(stiffness=0.0, damping=0.0)


def apply_damping(articulation: "PhysxArticulation", joint: "PhysxArticulationJoint", damping: float) -> None:
    """Adds viscous damping (N s/m or N m s/rad), independent of the joint's drive."""
    if not damping >= 0.0:
        raise ValueError(f"joint {joint.name!r}: damping {damping}, expected >= 0")
    if damping > 0.0:
        articulation.create_fixed_tendon(
            [joint.parent_link, joint.child_link], [0.0, 1.0], [0.0, 1.0], stiffness=0.0, damping=damping
        )


def apply_velocity(joint: "PhysxArticulationJoint", velocity: float) -> None:
    """Limits the speed of a joint to ``velocity`` (m/s or rad/s).

    Fingers can accelerate a knob by more than a thousand rad/s^2. Without a limit it soon turns by more than
    a radian per step, and PhysX's predicted contacts with its neighbours throw it back and forth.
    """
    if not velocity > 0.0:
        raise ValueError(f"joint {joint.name!r}: velocity {velocity}, expected > 0")
    joint.set_max_velocity(velocity)


def hold_chains(articulation: "PhysxArticulation", package: SimPackage) -> None:
    """Makes PhysX iterate more often where a door carries a door, so that friction holds both."""
    doors = {link.name for link in package.links if link.label == "door"}
    if any(joint.parent in doors and joint.child in doors for joint in package.joints):
        articulation.set_solver_position_iterations(CHAIN_ITERATIONS)


def drive_follower(engine: "PhysxArticulationJoint", joint: Joint, package: SimPackage) -> None:
    """Gives a follower a critically damped position drive; its target is set at every step."""
    moved = subtree_inertial(package.links, package.joints, joint.child)
    turning = float(joint.axis @ inertia_about(moved, joint.origin) @ joint.axis)
    moment = moved.mass if joint.type == "prismatic" else turning
    engine.set_friction(0.0)
    engine.set_drive_properties(moment * FREQUENCY**2, 2.0 * moment * FREQUENCY)


def pull_spring(engine: "PhysxArticulationJoint", joint: Joint, q: float) -> None:
    """Applies the spring force of a joint at the coordinate ``q`` (rad or m) to both links for one step."""
    effort = joint.pull(q)
    pose = engine.global_pose
    axis = np.asarray(pose.to_transformation_matrix()[:3, 0], dtype=np.float64)  # the axis of a joint is x
    for link, push in ((engine.child_link, effort * axis), (engine.parent_link, -effort * axis)):
        if joint.type == "prismatic":
            link.add_force_at_point(push.tolist(), pose.p)
        else:
            link.add_force_torque([0.0, 0.0, 0.0], push.tolist())
