"""Simulates follower joints and springs at every step, because SAPIEN's URDF loader supports neither.

SAPIEN's own coupling, a stiff tendon, adds energy to joints; a tendon used as a spring pulls several times
too hard.
"""

from typing import TYPE_CHECKING

import numpy as np

from sim_export.package import PackageJoint, SimPackage
from sim_export.physics.inertia import inertia_about, subtree_inertial

if TYPE_CHECKING:
    from sapien.physx import PhysxArticulationJoint

FREQUENCY = 1000.0
"""Natural frequency (rad/s) of the drive that couples a follower: under its own weight a part sags by g /
frequency^2, a hundredth of a millimetre."""


def drive_follower(engine: "PhysxArticulationJoint", joint: PackageJoint, package: SimPackage) -> None:
    """Gives a follower a critically damped position drive; its target is set at every step."""
    moved = subtree_inertial(package.links, package.joints, joint.child)
    turning = float(joint.axis @ inertia_about(moved, joint.origin) @ joint.axis)
    moment = moved.mass if joint.type == "prismatic" else turning
    engine.set_friction(0.0)
    engine.set_drive_properties(moment * FREQUENCY**2, 2.0 * moment * FREQUENCY)


def pull_spring(engine: "PhysxArticulationJoint", joint: PackageJoint, q: float) -> None:
    """Applies the spring force of a joint at the coordinate ``q`` (rad or m) to both links for one step."""
    effort = -(joint.spring + joint.stiffness * q)
    pose = engine.global_pose
    axis = np.asarray(pose.to_transformation_matrix()[:3, 0], dtype=np.float64)  # the axis of a joint is x
    for link, push in ((engine.child_link, effort * axis), (engine.parent_link, -effort * axis)):
        if joint.type == "prismatic":
            link.add_force_at_point(push.tolist(), pose.p)
        else:
            link.add_force_torque([0.0, 0.0, 0.0], push.tolist())
