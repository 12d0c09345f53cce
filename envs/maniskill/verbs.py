"""Verbs for moving parts, from the motion of the place that is held or touched."""

from typing import Literal

import numpy as np
from jaxtyping import Float

from sim_export.package import PackageJoint

Verb = Literal["open", "turn", "press", "lift", "slide"]
VERBS: tuple[Verb, ...] = ("open", "turn", "press", "lift", "slide")
ALONG = 0.7
"""Cosine from which on a direction counts as along another one."""
MIDDLE = 0.25
"""A part whose axis passes its middle by less than this share of its length rocks."""
UP = np.array([0.0, 0.0, 1.0])


def grip_direction(joint: PackageJoint, grip: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Unit direction in which a point starts to move as the joint opens; zeros on the axis itself."""
    if joint.type == "prismatic":
        return np.asarray(joint.axis)
    direction = np.cross(joint.axis, grip - joint.origin)
    return direction / max(float(np.linalg.norm(direction)), 1e-9)


def verb_of(
    joint: PackageJoint,
    label: str,
    grip: Float[np.ndarray, "3"],
    normal: Float[np.ndarray, "3"],
    corners: Float[np.ndarray, "C 3"],
) -> Verb:
    """The verb of a part.

    Args:
        joint: moves the part.
        label: the part's.
        grip: where it is taken or touched, object frame.
        normal: unit direction away from what carries it, there.
        corners: of a box around what is taken or touched.

    Returns:
        ``turn`` for what turns about an axis that stands out of its carrier, or along its surface;
        ``press`` for knobs that go down, into their carrier, or rock about their middle; ``lift`` for what
        goes up; ``open`` for other hinged doors; ``slide`` for everything else that slides.
    """
    direction = grip_direction(joint, grip)
    knob = label in ("knob", "handle")
    if joint.type != "prismatic" and knob and abs(float(joint.axis @ normal)) > ALONG:
        return "turn"
    if knob and joint.type != "prismatic":
        along = np.cross(joint.axis, normal)
        arm = grip - joint.origin
        if np.linalg.norm(arm - (arm @ joint.axis) * joint.axis) < MIDDLE * np.ptp(corners @ along):
            return "press"
    if knob and (float(direction @ normal) < -ALONG or float(direction @ UP) < -ALONG):
        return "press"
    if float(direction @ UP) > ALONG:
        return "lift"
    if joint.type == "prismatic":
        return "slide"
    return "turn" if knob else "open"
