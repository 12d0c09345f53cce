"""Joints of sketches in integers: lengths in steps of `STEP` metres, angles in half degrees."""

from collections.abc import Sequence

import numpy as np

from artigen.sketch.piece import LINED
from artigen.sketch.snap import STEP
from artigen.types import FULL_TURN, JOINT_TYPES, Joint

HALF_DEGREE = np.pi / 360


def number_joint(joint: Joint) -> tuple[int, ...]:
    """Type, index of the axis in `LINED`, origin, upper limit, and the travel of a screw over its range.

    The origin of a prismatic joint and the limit of a continuous one are 0.

    Raises:
        ValueError: If the axis is none of the six directions.
    """
    near = np.array(LINED) @ joint.axis
    if near.max() < 1 - 1e-9:
        raise ValueError(f"moves along {joint.axis.tolist()}, expected one of the axes")
    slides, unit = joint.type == "prismatic", STEP if joint.type == "prismatic" else HALF_DEGREE
    return (
        JOINT_TYPES.index(joint.type),
        int(near.argmax()),
        *((0, 0, 0) if slides else (round(v / STEP) for v in joint.origin)),
        0 if joint.type == "continuous" else max(round(joint.upper / unit), 1),
        max(round(joint.pitch * joint.upper / STEP), 1) if joint.type == "screw" else 0,
    )


def build_joint(numbers: Sequence[int]) -> Joint:
    """The joint that `number_joint` describes (m, rad)."""
    kind, axis, x, y, z, upper, travel = numbers
    joint_type = JOINT_TYPES[kind]
    most = FULL_TURN if joint_type == "continuous" else upper * HALF_DEGREE
    if joint_type == "prismatic":
        x, y, z, most = 0, 0, 0, upper * STEP
    return Joint(
        type=joint_type,
        axis=np.array(LINED[axis]),
        origin=np.array([x, y, z]) * STEP,
        upper=most,
        pitch=travel * STEP / most if joint_type == "screw" else 0.0,
    )
