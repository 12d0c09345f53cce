"""What voxels vote for, in units of the field's own noise, and how well groups and votes agree."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.fields import VoxelFields

BOX, PLACE, ORIGIN, MOTION = slice(0, 6), slice(0, 3), slice(6, 9), slice(9, 14)
WIDTH = 14
"""Columns of a vote: box centre 3, box size 3, joint origin 3, axis 3, normalised ranges 2."""
FACE_CAP, SEPARATE_JOINTS = 25.0, 10.0
"""Most that one face, and that different joint types, count as evidence for two parts."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Votes:
    """Per-voxel votes: numbers in units of their noise, classes as log probabilities."""

    resolution: int
    coords: Int[np.ndarray, "N 3"]
    whitened: Float[np.ndarray, "N 14"]
    sigma: Float[np.ndarray, "14"]
    drift: Float[np.ndarray, "14"]
    """Variance, in units of the noise, by which the votes of one part may differ between places."""
    log_label: Float[np.ndarray, "N L"]
    log_joint: Float[np.ndarray, "N T"]


@dataclass(frozen=True, kw_only=True, eq=False)
class GroupVotes:
    """Summaries of groups of voxels; ``mean`` in units of the noise, corners in unit lengths."""

    count: Int[np.ndarray, "G"]
    mean: Float[np.ndarray, "G 14"]
    low: Float[np.ndarray, "G 3"]
    high: Float[np.ndarray, "G 3"]
    label: Int[np.ndarray, "G"]
    joint: Int[np.ndarray, "G"]


def collect_votes(
    fields: VoxelFields, alike: Int[np.ndarray, "2 E"], floor: Float[np.ndarray, "14"], label_error: float
) -> Votes:
    """Votes of a field; the noise of each column is measured between the like-labelled neighbours
    ``alike`` and is at least ``floor``."""
    layout = fields.layout
    ranges = fields.ranges / (layout.rotation_unit, layout.length_unit)
    values = np.concatenate([fields.box, fields.origin, fields.axis, ranges], axis=1, dtype=np.float64)
    sigma = floor
    if alike.shape[1]:
        chosen = alike[:, :: max(1, alike.shape[1] // 20000)]
        spread = np.median(np.abs(values[chosen[0]] - values[chosen[1]]), axis=0)
        sigma = np.maximum(floor, spread * 1.4826 / np.sqrt(2.0))
    return Votes(
        resolution=fields.resolution,
        coords=fields.coords.astype(np.int64),
        whitened=values / sigma,
        sigma=sigma,
        drift=(2 * floor / sigma) ** 2,
        log_label=np.log(fields.label_probs * (1 - label_error) + label_error / fields.label_probs.shape[1]),
        log_joint=np.log(fields.joint_probs * (1 - label_error) + label_error / fields.joint_probs.shape[1]),
    )


def summarise(votes: Votes, groups: Int[np.ndarray, "N"], base: int) -> GroupVotes:
    """Counts, mean votes, extents and majority classes of groups numbered from 0 without gaps.

    Rows with group -1 are left out. Group 0 is the base: it keeps its label, and its votes are
    medians because it is gathered by label alone.
    """
    rows = np.flatnonzero(groups >= 0)
    order = rows[np.argsort(groups[rows], kind="stable")]
    starts = np.flatnonzero(np.diff(groups[order], prepend=-1))
    count = np.diff(np.append(starts, len(order)))
    mean = np.add.reduceat(votes.whitened[order], starts, axis=0) / count[:, None]
    mean[0] = np.median(votes.whitened[order[: count[0]]], axis=0)
    label = np.add.reduceat(votes.log_label[order], starts, axis=0).argmax(axis=1)
    label[0] = base
    return GroupVotes(
        count=count,
        mean=mean,
        low=np.minimum.reduceat(votes.coords[order], starts, axis=0) / votes.resolution - 0.5,
        high=(np.maximum.reduceat(votes.coords[order], starts, axis=0) + 1) / votes.resolution - 0.5,
        label=label,
        joint=np.add.reduceat(votes.log_joint[order], starts, axis=0).argmax(axis=1),
    )


def misfit(
    votes: Votes, mean: np.ndarray, count: np.ndarray, low: np.ndarray, high: np.ndarray, tolerance: float
) -> np.ndarray:
    """Chi squared of voted box faces against the extent of the voxels (leading shape of ``count``).

    ``tolerance`` is in voxels: the extent is known to about one, because a cell has one owner.
    """
    size = mean[..., 3:6] * votes.sigma[3:6] / 2
    center = mean[..., :3] * votes.sigma[:3]
    noise = (votes.sigma[:3] ** 2 + votes.sigma[3:6] ** 2 / 4) / count[..., None]
    noise = noise + (tolerance / votes.resolution) ** 2
    faces = np.minimum((center - size - low) ** 2 / noise, FACE_CAP)
    return (faces + np.minimum((center + size - high) ** 2 / noise, FACE_CAP)).sum(axis=-1)


def merge_scores(
    votes: Votes, stats: GroupVotes, one: int, same_origin: np.ndarray, tolerance: float, label_penalty: float
) -> Float[np.ndarray, "G"]:
    """Evidence that group ``one`` and each group are two parts, minus what one common part explains.

    Chi squared of the difference of the votes (the most telling of: centre, centre and origin, all),
    plus the misfit of the common box, minus the misfits of the separate boxes, plus penalties for
    different classes. ``same_origin`` marks groups split from the same connected piece: the split
    itself pulls their means apart by up to 1.6 standard deviations, which is no evidence.
    """
    n, other = stats.count[one], stats.count
    weight = (n / (n + other))[:, None]
    mean = weight * stats.mean[one] + (1 - weight) * stats.mean
    low, high = np.minimum(stats.low[one], stats.low), np.maximum(stats.high[one], stats.high)
    spread = (1 / n + 1 / other + 2.56 * same_origin)[:, None] + votes.drift
    apart = (stats.mean[one] - stats.mean) ** 2 / spread
    evidence = np.zeros(len(other))
    for columns in (apart[:, PLACE], np.concatenate([apart[:, PLACE], apart[:, ORIGIN]], axis=1), apart):
        width = columns.shape[1]
        excess = np.maximum(columns.sum(axis=1) - width, 0) / np.sqrt(2 * width)
        evidence = np.maximum(evidence, excess**2)
    alone = misfit(votes, stats.mean, other, stats.low, stats.high, tolerance)
    together = misfit(votes, mean, n + other, low, high, tolerance)
    classes = label_penalty * (stats.label != stats.label[one]) + SEPARATE_JOINTS * (
        stats.joint != stats.joint[one]
    )
    return evidence + together - alone - alone[one] + classes


def voxel_costs(
    votes: Votes, stats: GroupVotes, rows: Int[np.ndarray, "n"], outside: float
) -> Float[np.ndarray, "n G"]:
    """Cost (half chi squared and negative log probability) of each voxel in each group.

    Box, origin and motion votes are capped separately, so that one wild attribute does not outvote
    the others; ``outside`` is the number of voxels beyond the box that make one standard deviation.
    """
    cost = np.zeros((len(rows), len(stats.count)))
    for columns, cap in ((BOX, 24.0), (ORIGIN, 12.0), (MOTION, 12.0)):
        mine, theirs = votes.whitened[rows, columns], stats.mean[:, columns]
        square = (mine**2).sum(axis=1)[:, None] - 2 * mine @ theirs.T + (theirs**2).sum(axis=1)
        cost += np.minimum(square / 2, cap)
    center, size = stats.mean[:, :3] * votes.sigma[:3], stats.mean[:, 3:6] * votes.sigma[3:6] / 2
    noise = (votes.sigma[:3] ** 2 + votes.sigma[3:6] ** 2 / 4) / stats.count[:, None]
    noise = noise + (outside / votes.resolution) ** 2  # G 3
    at = (votes.coords[rows] + 0.5) / votes.resolution - 0.5
    beyond = np.zeros_like(cost)
    for k in range(3):
        far = np.abs(at[:, k, None] - center[:, k]) - size[:, k] - 0.5 / votes.resolution
        beyond += np.maximum(far, 0.0) ** 2 / noise[:, k]
    cost += np.minimum(beyond / 2, 24.0)
    return cost - votes.log_label[rows][:, stats.label] - votes.log_joint[rows][:, stats.joint]
