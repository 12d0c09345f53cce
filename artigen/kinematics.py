"""Kinematic trees: order, joint coordinates, poses, and motion of points and Gaussians.

Every joint is given in the object frame at rest, so the displacement of a part is the
displacement of its parent times its own joint motion: ``D[i] = D[parent] @ motion_i(q_i)``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike

from artigen.transforms import joint_motion, quat_from_matrix, quat_multiply
from artigen.types import Asset, Gaussians, Joint


def parents_first(parents: Sequence[int]) -> list[int]:
    """Indices of a forest with every parent before its children.

    Args:
        parents: Index of the parent of each; -1 for roots.

    Raises:
        ValueError: If some are their own ancestors.
    """
    order: list[int] = []
    placed, waiting = {-1}, list(range(len(parents)))
    while waiting:
        ready = [index for index in waiting if parents[index] in placed]
        if not ready:
            raise ValueError(f"parents {list(parents)}: {waiting} form a cycle")
        order += ready
        placed |= set(ready)
        waiting = [index for index in waiting if index not in placed]
    return order


def compose(parents: Sequence[int], own: Float[np.ndarray, "*B P 4 4"]) -> Float[np.ndarray, "*B P 4 4"]:
    """Displacement of every part from rest: its parent's displacement times its own motion.

    Args:
        parents: Index of the parent of each; -1 for roots.
        own: Displacement of each by its own joint, in the object frame at rest.

    Raises:
        ValueError: If some are their own ancestors.
    """
    out = np.array(own, dtype=np.float64)
    for index in parents_first(parents):
        if parents[index] != -1:
            out[..., index, :, :] = out[..., parents[index], :, :] @ own[..., index, :, :]
    return out


def joint_coordinates(
    names: Sequence[str], joints: Sequence[Joint], q: Mapping[str, ArrayLike]
) -> list[Float[np.ndarray, "*B"]]:
    """Coordinate (m, rad) of every joint, of one common shape.

    That of a follower comes from its leader's, over any number of followers between them.

    Args:
        names: What the coordinates and ``Joint.follows`` name: parts, or joints of a package.
        joints: The joint of each.
        q: Coordinates by name, numbers or arrays of poses that broadcast; the others are 0.

    Raises:
        ValueError: If joints follow each other.
    """
    leaders = {name: joint for name, joint in zip(names, joints, strict=True) if joint.follows is not None}

    def read(name: str, below: tuple[str, ...] = ()) -> Float[np.ndarray, "*B"]:
        if name in below:
            raise ValueError(f"joints {', '.join(below)} follow each other")
        joint = leaders.get(name)
        if joint is None or joint.follows is None:
            return np.asarray(q.get(name, 0.0), dtype=np.float64)
        return joint.follow(read(joint.follows, (*below, name)))

    poses = np.broadcast_shapes(*(np.shape(value) for value in q.values()))
    return [np.broadcast_to(read(name), poses) for name in names]


def displace(
    names: Sequence[str], parents: Sequence[int], joints: Sequence[Joint], q: Mapping[str, ArrayLike]
) -> Float[np.ndarray, "*B P 4 4"]:
    """Displacement from rest of everything that joints move.

    Assets, shapes and packages move by this function and no other.

    Args:
        names: As in `joint_coordinates`.
        parents: Index of the one that carries each; -1 for roots.
        joints: The joint of each, in the object frame at rest.
        q: As in `joint_coordinates`.

    Raises:
        ValueError: If some are their own ancestors, or joints follow each other.
    """
    moved = map(joint_motion, joints, joint_coordinates(names, joints, q))
    return compose(parents, np.stack(list(moved), axis=-3))


def movable_parts(asset: Asset) -> list[int]:
    """Indices of the parts whose joint moves; ``qpos`` follows this order."""
    return [index for index, part in enumerate(asset.parts) if part.joint.type != "fixed"]


def qlimits(asset: Asset) -> Float[np.ndarray, "J 2"]:
    """Lower and upper limit of each movable part, in joint coordinates."""
    limits = [
        [asset.parts[index].joint.lower, asset.parts[index].joint.upper] for index in movable_parts(asset)
    ]
    return np.array(limits, dtype=np.float64).reshape(-1, 2)


def displacements(asset: Asset, qpos: Float[np.ndarray, "*B J"]) -> Float[np.ndarray, "*B P 4 4"]:
    """Rigid displacement of every part from rest at ``qpos`` (order of `movable_parts`).

    Raises:
        ValueError: If the length of ``qpos`` differs from the number of movable parts.
    """
    qpos = np.asarray(qpos, dtype=np.float64)
    movable = movable_parts(asset)
    if qpos.shape[-1] != len(movable):
        raise ValueError(
            f"asset {asset.name!r}: qpos has {qpos.shape[-1]} entries, {len(movable)} parts move"
        )
    parts = asset.parts
    q = {parts[part].name: qpos[..., index] for index, part in enumerate(movable)}
    return displace([p.name for p in parts], [p.parent for p in parts], [p.joint for p in parts], q)


def articulate_points(
    asset: Asset,
    qpos: Float[np.ndarray, "J"],
    points: Float[np.ndarray, "N 3"],
    part_ids: Int[np.ndarray, "N"],
) -> Float[np.ndarray, "N 3"]:
    """Moves points with the parts they belong to."""
    D = displacements(asset, qpos)[part_ids]  # N 4 4
    return np.einsum("nij,nj->ni", D[:, :3, :3], points) + D[:, :3, 3]


def articulate_gaussians(asset: Asset, qpos: Float[np.ndarray, "J"], gaussians: Gaussians) -> Gaussians:
    """Moves Gaussians with their parts; rotations are composed into the quaternions."""
    D = displacements(asset, qpos)
    means = articulate_points(asset, qpos, gaussians.means, gaussians.part_ids)
    quats = quat_multiply(quat_from_matrix(D[:, :3, :3])[gaussians.part_ids], gaussians.quats)
    return replace(gaussians, means=means, quats=quats / np.linalg.norm(quats, axis=1, keepdims=True))
