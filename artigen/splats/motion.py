"""Moves sets of Gaussians: rigid transforms and changes of unit.

Gaussians that move with their parts: `artigen.kinematics.articulate_gaussians`. Colours are harmonics of
degree 0, the same from everywhere, so that a rotation leaves them alone.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from artigen.transforms import quat_from_matrix, quat_multiply, transform_points
from artigen.types import Gaussians


def transform_gaussians(gaussians: Gaussians, T: Float[np.ndarray, "4 4"]) -> Gaussians:
    """Gaussians in another frame; the rotation is composed into the quaternions.

    Raises:
        ValueError: If ``T`` is not rigid.
    """
    rotation = T[:3, :3]
    off = np.abs(rotation @ rotation.T - np.eye(3)).max()
    if off > 1e-6 or np.linalg.det(rotation) < 0 or (T[3] != (0.0, 0.0, 0.0, 1.0)).any():
        raise ValueError(
            f"transform of Gaussians: R R^T is off the identity by {off:.3g} and det R is "
            f"{np.linalg.det(rotation):.6g}, expected a rigid motion"
        )
    quats = quat_multiply(quat_from_matrix(rotation), gaussians.quats)
    return replace(
        gaussians,
        means=transform_points(T, gaussians.means),
        quats=quats / np.linalg.norm(quats, axis=1, keepdims=True),
    )


def scale_gaussians(gaussians: Gaussians, factor: float) -> Gaussians:
    """Gaussians in another unit of length; raises `ValueError` unless ``factor`` is above 0."""
    if not factor > 0:
        raise ValueError(f"scale of Gaussians is {factor}, expected above 0")
    return replace(gaussians, means=gaussians.means * factor, scales=gaussians.scales * factor)
