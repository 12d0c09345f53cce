"""Votes of voxels in units of the field's noise, and agreement of groups and votes."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.types import FULL_TURN, PART_LABELS
from artigen.voxels.fields import VoxelFields

BASE = PART_LABELS.index("base")
BOX, PLACE, ORIGIN, MOTION = slice(0, 6), slice(0, 3), slice(6, 9), slice(9, 14)
WIDTH = 14
"""Columns of a vote: box centre 3, box size 3, joint origin 3, axis 3, normalised ranges 2."""
FACE_CAP, OUTSIDE_CAP, SEPARATE_JOINTS = 25.0, 24.0, 10.0
"""Evidence: caps per coordinate of a box and per voxel outside a box, and weight of unequal joint types."""
LENGTH_FLOOR = 0.05
"""Least noise assumed on lengths, in voxels. Raise it when votes drift within a part and parts
are found split."""
MOTION_FLOOR = 0.005
"""Least noise assumed on axis components and on normalised ranges."""
LABEL_ERROR = 0.03
"""Share of wrong labels expected among voxels."""
LABEL_PENALTY = 3.0
"""Evidence against merging groups of different labels. Raise it when a handle is taken for the
knob beside it, lower it when patches of wrong labels become parts."""
EXTENT_TOLERANCE = 0.75
"""Voxels by which a part may fall short of or exceed the box it votes for."""
OUTSIDE = 0.7
"""Voxels outside a part's box that count as one standard deviation."""
WITNESSES = 40
"""Most voxels per group that are tested against another group's box."""
SPLIT_BIAS = 6.0
"""Variance that splitting a group by its votes puts between the means of the two halves."""
TRIM = 0.01
"""Share of a group's voxels that may lie beyond the extent it is given, on every side."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Votes:
    """Per-voxel votes: numbers in units of their noise, classes as log probabilities."""

    resolution: int
    coords: Int[np.ndarray, "N 3"]
    whitened: Float[np.ndarray, "N 14"]
    sigma: Float[np.ndarray, "14"]
    patch: float
    """Voxels whose noise counts as one independent draw."""
    drift: Float[np.ndarray, "14"]
    """Variance, in units of the noise, by which the votes of one part may differ between places."""
    log_label: Float[np.ndarray, "N L"]
    log_joint: Float[np.ndarray, "N T"]


@dataclass(frozen=True, kw_only=True, eq=False)
class GroupVotes:
    """Summaries of groups of voxels; ``mean`` in units of the noise, corners in unit lengths."""

    count: Int[np.ndarray, "G"]
    draws: Float[np.ndarray, "G"]
    mean: Float[np.ndarray, "G 14"]
    low: Float[np.ndarray, "G 3"]
    high: Float[np.ndarray, "G 3"]
    label: Int[np.ndarray, "G"]
    joint: Int[np.ndarray, "G"]


def measure_noise(
    values: Float[np.ndarray, "N 14"],
    is_base: Bool[np.ndarray, "N"],
    alike: Int[np.ndarray, "2 E"],
    floor: Float[np.ndarray, "14"],
) -> tuple[Float[np.ndarray, "14"], float]:
    """Noise of the votes: standard deviations (at least ``floor``), and how many voxels share a draw.

    The base is one part, so whatever its votes scatter is noise; differences between like-labelled
    neighbours (``alike``) measure the part of it that changes from voxel to voxel. If neighbours
    correlate by rho, a surface patch of ``1 + pi rho / (1 - rho)`` voxels counts as one draw (exact for
    a Gaussian correlation on a plane).
    """
    center = np.median(values[is_base], axis=0)
    sigma = 1.4826 * np.median(np.abs(values[is_base] - center), axis=0)
    local = sigma
    if alike.shape[1]:
        chosen = alike[:, :: max(1, alike.shape[1] // 20000)]
        local = 1.4826 / np.sqrt(2) * np.median(np.abs(values[chosen[0]] - values[chosen[1]]), axis=0)
    sigma = np.maximum(sigma, local)
    noisy = sigma > floor
    if not noisy.any():
        return floor, 1.0
    rho = float(np.clip(1 - np.median(local[noisy] ** 2 / sigma[noisy] ** 2), 0.0, 0.99))
    return np.maximum(sigma, floor), 1 + np.pi * rho / (1 - rho)


def collect_votes(
    fields: VoxelFields, is_base: Bool[np.ndarray, "N"], alike: Int[np.ndarray, "2 E"]
) -> Votes:
    """Votes of a field in units of its own noise; see `measure_noise`."""
    floor = np.repeat([LENGTH_FLOOR / fields.resolution, MOTION_FLOOR], [9, WIDTH - 9])
    ranges = fields.ranges / (FULL_TURN, 1.0)
    values = np.concatenate([fields.box, fields.origin, fields.axis, ranges], axis=1, dtype=np.float64)
    sigma, patch = measure_noise(values, is_base, alike, floor)
    return Votes(
        resolution=fields.resolution,
        coords=fields.coords.astype(np.int64),
        whitened=values / sigma,
        sigma=sigma,
        patch=patch,
        drift=(2 * floor / sigma) ** 2,
        log_label=_log_classes(fields.label_probs),
        log_joint=_log_classes(fields.joint_probs),
    )


def _log_classes(chances: Float[np.ndarray, "N K"]) -> Float[np.ndarray, "N K"]:
    """Log probabilities of classes of which a share of `LABEL_ERROR` is wrong."""
    return np.log(chances * (1 - LABEL_ERROR) + LABEL_ERROR / chances.shape[1])


def placed_votes(votes: Votes, rows: Int[np.ndarray, "n"]) -> Float[np.ndarray, "n 14"]:
    """Votes of voxels assumed to be one part, with their own positions as additional votes for its centre.

    A voxel lies in its part's box, so its position gives the centre to about ``size / sqrt(6)`` (between
    evenly filled and shell). For small parts this is more precise than the network.
    """
    values = votes.whitened[rows].copy()
    size = np.maximum(values[:, 3:6].mean(axis=0) * votes.sigma[3:6], 1 / votes.resolution)
    place = (votes.coords[rows] + 0.5) / votes.resolution - 0.5
    voted, seen = votes.sigma[:3] ** -2, 6 / size**2
    values[:, PLACE] = (values[:, PLACE] * votes.sigma[:3] * voted + place * seen) / np.sqrt(voted + seen)
    return values


def overlong_axis(votes: Votes, rows: Int[np.ndarray, "n"], excess: float) -> int | None:
    """The axis along which voxels reach farthest beyond the size they vote for; None if none clearly does.

    Cells exceed a box by half a voxel on average. ``excess`` voxels and two standard errors more mean a
    row of parts.
    """
    size = votes.whitened[rows, 3:6].mean(axis=0) * votes.sigma[3:6]
    error = votes.sigma[3:6] / np.sqrt(max(1.0, len(rows) / votes.patch))
    extent = (np.ptp(votes.coords[rows], axis=0) + 0.5) / votes.resolution
    beyond = extent - size - 2 * error - excess / votes.resolution
    longest = int(beyond.argmax())
    return longest if beyond[longest] > 0 else None


def summarise(votes: Votes, groups: Int[np.ndarray, "N"]) -> GroupVotes:
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
    label[0] = BASE
    low, high = _trimmed_extents(
        votes.coords[order], np.repeat(np.arange(len(count)), count), votes.resolution
    )
    return GroupVotes(
        count=count,
        draws=np.maximum(count / votes.patch, 1.0),
        mean=mean,
        low=low / votes.resolution - 0.5,
        high=high / votes.resolution - 0.5,
        label=label,
        joint=np.add.reduceat(votes.log_joint[order], starts, axis=0).argmax(axis=1),
    )


def _trimmed_extents(
    coords: Int[np.ndarray, "N 3"], groups: Int[np.ndarray, "N"], resolution: int
) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corners (in cells) of each group without its outermost `TRIM` of voxels."""
    total = int(groups[-1]) + 1
    low, high = np.empty((2, total, 3))
    for k in range(3):
        layers = np.bincount(groups * resolution + coords[:, k], minlength=total * resolution)
        layers = layers.reshape(total, resolution)
        number = layers.sum(axis=1, keepdims=True)
        cut = np.floor(TRIM * number)
        low[:, k] = (np.cumsum(layers, axis=1) > cut).argmax(axis=1)
        high[:, k] = resolution - (np.cumsum(layers[:, ::-1], axis=1) > cut).argmax(axis=1)
    return low, high


def select_groups(stats: GroupVotes, chosen: Int[np.ndarray, "K"]) -> GroupVotes:
    """The summaries of some of the groups."""
    return GroupVotes(**{name: value[chosen] for name, value in vars(stats).items()})


def misfit(
    votes: Votes, mean: np.ndarray, draws: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Chi squared of the voted box against the extent of the voxels (leading shape of ``draws``).

    The extent of the cells exceeds the box by up to a voxel, half of one on average; `EXTENT_TOLERANCE` is
    the standard deviation of that (half of it for the centre).
    """
    cell, free = 1 / votes.resolution, EXTENT_TOLERANCE / votes.resolution
    center, size = mean[..., :3] * votes.sigma[:3], mean[..., 3:6] * votes.sigma[3:6]
    noise = 1 / draws[..., None]
    off = (center - (low + high) / 2) ** 2 / (votes.sigma[:3] ** 2 * noise + (free / 2) ** 2)
    over = (high - low - size - cell / 2) ** 2 / (votes.sigma[3:6] ** 2 * noise + free**2)
    return (np.minimum(off, FACE_CAP) + np.minimum(over, FACE_CAP)).sum(axis=-1)


def merge_scores(
    votes: Votes, stats: GroupVotes, groups: Int[np.ndarray, "N"], same_piece: Bool[np.ndarray, "G G"]
) -> Float[np.ndarray, "G G"]:
    """Evidence, for every two groups, that they are two parts and not one.

    The disagreement of their votes, plus the better of two geometric arguments (the common box fits
    the common extent worse than the separate boxes fit theirs; the smaller group lies outside the
    other's box), plus penalties for different classes. ``same_piece`` marks groups split from the same
    connected piece.
    """
    apart = _disagreement(votes, stats, same_piece)
    weight = stats.draws[:, None] / (stats.draws[:, None] + stats.draws)
    mean = weight[..., None] * stats.mean[:, None] + (1 - weight[..., None]) * stats.mean
    alone = misfit(votes, stats.mean, stats.draws, stats.low, stats.high)
    together = misfit(
        votes,
        mean,
        stats.draws[:, None] + stats.draws,
        np.minimum(stats.low[:, None], stats.low),
        np.maximum(stats.high[:, None], stats.high),
    )
    geometry = np.maximum(together - alone[:, None] - alone, _strangeness(votes, stats, groups))
    classes = LABEL_PENALTY * (stats.label[:, None] != stats.label)
    return apart + geometry + classes + SEPARATE_JOINTS * (stats.joint[:, None] != stats.joint)


def _disagreement(
    votes: Votes, stats: GroupVotes, same_piece: Bool[np.ndarray, "G G"]
) -> Float[np.ndarray, "G G"]:
    """Squared number of standard deviations by which the mean votes differ more than by chance.

    The largest over three sets of votes: centre; centre and origin; all. Splitting one piece itself pulls
    the means apart, by 1.6 standard deviations of a vote and more after several splits; `SPLIT_BIAS`
    allows for that.
    """
    spread = 1 / stats.draws[:, None] + 1 / stats.draws + SPLIT_BIAS * same_piece  # G G
    apart = (stats.mean[:, None] - stats.mean) ** 2 / (spread[..., None] + votes.drift)  # G G 14
    place, origin = apart[..., PLACE].sum(axis=-1), apart[..., ORIGIN].sum(axis=-1)
    evidence = np.zeros(place.shape)
    for total, width in ((place, 3), (place + origin, 6), (apart.sum(axis=-1), WIDTH)):
        evidence = np.maximum(evidence, np.maximum(total - width, 0) ** 2 / (2 * width))
    return evidence


def _strangeness(votes: Votes, stats: GroupVotes, groups: Int[np.ndarray, "N"]) -> Float[np.ndarray, "G G"]:
    """How much worse the voxels of the smaller group lie in the other's box than in their own.

    At most `WITNESSES` evenly chosen voxels represent a group.
    """
    order = np.argsort(groups, kind="stable")
    starts = np.cumsum(stats.count) - stats.count
    number = np.minimum(stats.count, WITNESSES)
    chosen = np.concatenate(
        [
            order[start + (np.arange(n) * count) // n]
            for start, n, count in zip(starts, number, stats.count, strict=True)
        ]
    )
    costs = outside_costs(votes, stats, chosen)
    total = np.add.reduceat(costs, np.cumsum(number) - number, axis=0)  # G G
    extra = np.maximum(total - np.diag(total)[:, None], 0.0)
    smaller = stats.count[:, None] <= stats.count
    return np.maximum(np.where(smaller, extra, 0.0), np.where(smaller, extra, 0.0).T)


def outside_costs(votes: Votes, stats: GroupVotes, rows: Int[np.ndarray, "n"]) -> Float[np.ndarray, "n G"]:
    """Half chi squared of each voxel's distance from each group's voted box, capped."""
    center, half = stats.mean[:, :3] * votes.sigma[:3], stats.mean[:, 3:6] * votes.sigma[3:6] / 2
    noise = (votes.sigma[:3] ** 2 + votes.sigma[3:6] ** 2 / 4) / stats.draws[:, None]
    noise = noise + (OUTSIDE / votes.resolution) ** 2  # G 3
    at = (votes.coords[rows] + 0.5) / votes.resolution - 0.5
    beyond = np.zeros((len(rows), len(stats.count)))
    for k in range(3):
        far = np.abs(at[:, k, None] - center[:, k]) - half[:, k] - 0.5 / votes.resolution
        beyond += np.maximum(far, 0.0) ** 2 / noise[:, k]
    return np.minimum(beyond / 2, OUTSIDE_CAP)


def vote_costs(votes: Votes, stats: GroupVotes, rows: Int[np.ndarray, "n"]) -> Float[np.ndarray, "n G"]:
    """Half chi squared of each voxel's votes and place in each group.

    Box, origin and motion votes are capped separately, so that one wild attribute does not outvote
    the others.
    """
    cost = outside_costs(votes, stats, rows)
    for columns, cap in ((BOX, 24.0), (ORIGIN, 12.0), (MOTION, 12.0)):
        mine, theirs = votes.whitened[rows, columns], stats.mean[:, columns]
        square = (mine**2).sum(axis=1)[:, None] - 2 * mine @ theirs.T + (theirs**2).sum(axis=1)
        cost += np.minimum(square / 2, cap)
    return cost


def class_costs(votes: Votes, stats: GroupVotes, rows: Int[np.ndarray, "n"]) -> Float[np.ndarray, "n G"]:
    """Negative log probability of each voxel for the label and the joint type of each group."""
    return -votes.log_label[rows][:, stats.label] - votes.log_joint[rows][:, stats.joint]
