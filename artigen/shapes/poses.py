"""Poses of the parts of a shape for joint coordinates, in metres and radians."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from artigen.kinematics import displace
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape
from artigen.types import FIXED, Joint


def pose_parts(shape: Shape, qpos: Float[np.ndarray, "*B P"]) -> Float[np.ndarray, "*B P 4 4"]:
    """Displacement of every part from rest: its parent's displacement times its own motion.

    Args:
        shape: The object.
        qpos: One coordinate per part, in metres for prismatic joints, else in radians; those of fixed parts
            and followers are ignored.

    Raises:
        ValueError: If the number of coordinates differs from the number of parts.
    """
    qpos = np.asarray(qpos, dtype=np.float64)
    if qpos.shape[-1] != len(shape.parts):
        raise ValueError(
            f"{shape.name}: qpos has {qpos.shape[-1]} entries, expected one per part, {len(shape.parts)}"
        )
    names = [part.name for part in shape.parts]
    parents = [-1 if part.parent is None else names.index(part.parent) for part in shape.parts]
    q = {name: qpos[..., index] for index, name in enumerate(names)}
    return displace(names, parents, [part.joint or FIXED for part in shape.parts], q)


def place_posed(shape: Shape, qpos: Float[np.ndarray, "P"]) -> Float[np.ndarray, "N 3"]:
    """Vertices (m) of all primitives for joint coordinates as in `pose_parts`."""
    return np.concatenate(
        [
            place_vertices(primitive) @ pose[:3, :3].T + pose[:3, 3]
            for part, pose in zip(shape.parts, pose_parts(shape, qpos), strict=True)
            for primitive in part.primitives
        ]
    )


def joint_ranges(shape: Shape) -> Float[np.ndarray, "P"]:
    """Upper end of the range of every part's joint (m, rad); zero for fixed parts."""
    return np.array([0.0 if part.joint is None else part.joint.upper for part in shape.parts])


def open_parts(shape: Shape, fraction: float) -> Float[np.ndarray, "P"]:
    """Coordinates with every limited joint at the same share of its range and the others closed."""
    return np.array(
        [
            0.0 if part.joint is None or part.joint.type == "continuous" else fraction * part.joint.upper
            for part in shape.parts
        ]
    )


def make_joint(
    motion: Joint | None, center: Float[np.ndarray, "3"] | float = 0.0, scale: float = 1.0
) -> Joint:
    """The joint of a part by itself, relative to ``center`` (m) and in units of ``scale`` metres."""
    if motion is None:
        return FIXED
    return replace(
        motion,
        origin=(motion.origin - center) / scale,
        upper=motion.upper / scale if motion.type == "prismatic" else motion.upper,
        pitch=motion.pitch / scale,
        follows=None,
        spring=0.0,
        stays=False,
    )
