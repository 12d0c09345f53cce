"""Moves splats with their parts, preserving gradients."""

from dataclasses import replace

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.splats.render.splats import Splats
from artigen.transforms import quat_from_matrix


def move_splats(
    splats: Splats, part_ids: Int[Tensor, "N"], displacements: Float[np.ndarray, "P 4 4"]
) -> Splats:
    """Splats moved by the displacement of their part; rotations are composed into the quaternions.

    Args:
        splats: At rest, in the frame of ``displacements``.
        displacements: As `artigen.kinematics.displacements` gives them for one joint state.
    """
    kind = {"dtype": splats.means.dtype, "device": splats.means.device}
    matrices = torch.tensor(displacements[:, :3], **kind).index_select(0, part_ids)  # N 3 4
    means = torch.einsum("nij,nj->ni", matrices[:, :, :3], splats.means) + matrices[:, :, 3]
    turns = torch.tensor(quat_from_matrix(displacements[:, :3, :3]), **kind).index_select(0, part_ids)
    return replace(splats, means=means, quats=multiply_quats(turns, splats.quats))


def multiply_quats(a: Float[Tensor, "*N 4"], b: Float[Tensor, "*N 4"]) -> Float[Tensor, "*N 4"]:
    """Hamilton products (wxyz): the rotation ``b`` followed by ``a``."""
    (aw, ax, ay, az), (bw, bx, by, bz) = a.unbind(-1), b.unbind(-1)
    return torch.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        dim=-1,
    )
