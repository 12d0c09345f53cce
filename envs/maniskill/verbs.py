"""Verbs for moving parts, derived from the motion of the grasped or touched point."""

from typing import Literal

import numpy as np
from jaxtyping import Float

from artigen.types import Joint

Verb = Literal["open", "turn", "press", "lift", "slide"]
VERBS: tuple[Verb, ...] = ("open", "turn", "press", "lift", "slide")
ALONG = 0.7
"""Cosine from which two directions count as parallel."""
MIDDLE = 0.25
"""Distance of a part's axis from its middle, as a share of its length, below which it rocks."""
UP = np.array([0.0, 0.0, 1.0])


def grip_direction(joint: Joint, grip: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Unit direction in which a point starts to move as the joint opens; zero on the axis itself."""
    if joint.type == "prismatic":
        return np.asarray(joint.axis)
    direction = np.cross(joint.axis, grip - joint.origin)
    return direction / max(float(np.linalg.norm(direction)), 1e-9)


def verb_of(
    joint: Joint,
    label: str,
    grip: Float[np.ndarray, "3"],
    normal: Float[np.ndarray, "3"],
    corners: Float[np.ndarray, "C 3"],
) -> Verb:
    """The verb of a part.

    Args:
        grip: Grasped or touched point, object frame.
        normal: Unit direction away from its carrier at that point.
        corners: Corners of a box around the grasped or touched geometry.

    Returns:
        ``turn`` for parts that rotate about an axis along the normal or the surface of their carrier;
        ``press`` for knobs that move down, into their carrier, or rock about their middle; ``lift`` for parts
        that move up; ``open`` for other hinged doors; ``slide`` for all other sliding parts.
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
