"""Joints of URDFs in the object frame."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from artigen.files.urdf import UrdfJoint
from artigen.transforms import transform_vectors
from artigen.types import FULL_TURN, Joint
from sim_export.errors import PackageError
from sim_export.package import URDF_JOINT_TYPES


def place_joint(joint: UrdfJoint, poses: Mapping[str, Float[np.ndarray, "4 4"]], file: str) -> Joint:
    """A URDF joint in the object frame.

    Args:
        poses: Pose of every link at rest.
        file: How errors name the URDF.

    Raises:
        PackageError: If it cannot be moved, or follows another joint with an offset: the joints of a package
            are all closed at 0.
    """
    owner = f"{file}: joint {joint.name!r}"
    if joint.type not in URDF_JOINT_TYPES:
        raise PackageError(f"{owner}: type {joint.type!r}, supported: {', '.join(URDF_JOINT_TYPES)}")
    limits: tuple[float | None, float | None] = (0.0, 0.0)
    if joint.type in ("revolute", "prismatic"):
        limits = (joint.lower, joint.upper)
    elif joint.type == "continuous":
        limits = (0.0, FULL_TURN)
    lower, upper = limits
    if lower is None or upper is None:
        raise PackageError(f"{owner}: a {joint.type} joint without <limit>")
    optional = {
        key: value
        for key in ("effort", "velocity", "friction", "damping")
        if (value := getattr(joint, key)) is not None
    }
    T = poses[joint.child]
    numbers = [
        lower,
        upper,
        joint.mimic_multiplier,
        joint.mimic_offset,
        *T.ravel(),
        *joint.axis,
        *optional.values(),
    ]
    if not np.isfinite(numbers).all():
        raise PackageError(f"{owner}: origin, axis, limits or dynamics hold NaN or infinite values")
    if lower > upper:
        raise PackageError(f"{owner}: lower {lower} is above upper {upper}")
    length = float(np.linalg.norm(joint.axis))
    if length < 1e-9 and joint.type != "fixed":
        raise PackageError(f"{owner}: axis {joint.axis.tolist()} has no direction")
    axis = joint.axis / length if length >= 1e-9 else np.array([1.0, 0.0, 0.0])
    return Joint(
        name=joint.name,
        type=joint.type,
        parent=joint.parent,
        child=joint.child,
        origin=T[:3, 3],
        axis=transform_vectors(T, axis[None])[0],
        lower=lower,
        upper=upper,
        follows=joint.mimic,
        ratio=joint.mimic_multiplier if joint.mimic is not None else 0.0,
        offset=joint.mimic_offset,
        **optional,
    )
