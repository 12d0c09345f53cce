"""The robust recipe: many voxels vote for a box, and a part must fill the box it votes for.

Semantics and connectivity give a first grouping; a group whose votes scatter more than the noise of
the field is split; groups are merged when their votes agree and the box they vote for is filled by
both together better than by each alone; at last every voxel goes to the part that explains it best:
its votes, its label, its joint type, its place in the part's box, and its neighbours.
The noise is measured on the field itself, from the differences between neighbouring voxels.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.fields import VoxelFields
from artigen.neighbours import connected_groups, neighbour_pairs
from artigen.partition import Partition, canonical_partition
from artigen.votes import WIDTH, Votes, collect_votes, merge_scores, placed_votes, summarise, voxel_costs


@dataclass(frozen=True, kw_only=True)
class RobustConfig:
    """Sensitivities of the robust recipe; lengths in voxels, evidence in units of chi squared."""

    length_floor: float = 0.05
    """Least noise assumed on lengths, in voxels. Raise it when votes drift within a part and parts
    are found split."""
    motion_floor: float = 0.005
    """Least noise assumed on axis components and on normalised ranges."""
    split_scatter: float = 1.5
    """A group is split when its votes scatter this many times more than noise alone (variance)."""
    seed_voxels: int = 12
    """Fewer voxels than this are a part of their own only when no larger part explains them."""
    extent_tolerance: float = 1.0
    """Voxels by which a part may fall short of or exceed the box it votes for."""
    merge_evidence: float = 12.0
    """Two groups are one part when the evidence against that stays below this."""
    label_error: float = 0.03
    """Share of wrong labels expected among voxels."""
    outside: float = 0.7
    """Voxels outside a part's box that count as one standard deviation."""
    neighbour_weight: float = 0.5
    """Evidence for a part per neighbouring voxel that belongs to it."""
    rounds: int = 2
    """Rounds of merging and reassignment."""


def partition_robust(fields: VoxelFields, cfg: RobustConfig) -> Partition:
    """Divides the voxels among parts by votes, boxes and connectivity; the base is one part."""
    pairs = neighbour_pairs(fields.coords.astype(np.int64), fields.resolution)
    labels = fields.label_probs.argmax(axis=1)
    base = fields.layout.labels.index("base")
    alike = labels[pairs[0]] == labels[pairs[1]]
    floor = np.repeat([cfg.length_floor / fields.resolution, cfg.motion_floor], [9, WIDTH - 9])
    votes = collect_votes(
        fields, is_base=labels == base, alike=pairs[:, alike], floor=floor, label_error=cfg.label_error
    )
    pieces = connected_groups(len(labels), pairs, alike)
    groups = _first_groups(votes, pieces, labels == base, cfg)
    for _ in range(cfg.rounds):
        groups = _absorb(votes, groups, base, cfg)
        groups = _merge(votes, groups, pieces, base, cfg)
        groups = _reassign(votes, groups, pairs, base, cfg)
    groups = _without_gaps(_absorb(votes, groups, base, cfg))
    label = summarise(votes, groups, base).label
    groups[label[groups] == base] = 0
    return canonical_partition(fields, groups, label)


def _first_groups(
    votes: Votes, pieces: Int[np.ndarray, "N"], is_base: Bool[np.ndarray, "N"], cfg: RobustConfig
) -> Int[np.ndarray, "N"]:
    """Group 0 is the base; connected voxels of one label follow, split where their votes disagree."""
    groups = np.zeros(len(pieces), dtype=np.int64)
    rows = np.flatnonzero(~is_base)
    order = rows[np.argsort(pieces[rows], kind="stable")]
    starts = np.flatnonzero(np.diff(pieces[order], prepend=-1))
    count = 1
    for piece in np.split(order, starts[1:]) if len(order) else []:
        for part in _split(votes, piece, cfg):
            groups[part] = count
            count += 1
    return groups


def _split(votes: Votes, rows: Int[np.ndarray, "n"], cfg: RobustConfig) -> list[np.ndarray]:
    """Bisects ``rows`` until no direction scatters ``split_scatter`` times more than noise would.

    Pure noise of n draws in d dimensions has variances up to (1 + sqrt(d / n))^2 (Marchenko-Pastur).
    """
    done, waiting = [], [rows]
    while waiting:
        piece = waiting.pop()
        if len(piece) < 2:
            done.append(piece)
            continue
        values = placed_votes(votes, piece)
        values -= values.mean(axis=0)
        variances, directions = np.linalg.eigh(values.T @ values / len(piece))
        draws = max(1.0, len(piece) / votes.patch)
        if variances[-1] <= cfg.split_scatter * (1 + np.sqrt(WIDTH / draws)) ** 2:
            done.append(piece)
            continue
        side = _bisect(values, directions[:, -1])
        waiting += [piece[side], piece[~side]]
    return done


def _bisect(values: Float[np.ndarray, "n 14"], direction: Float[np.ndarray, "14"]) -> Bool[np.ndarray, "n"]:
    """Two-means of centred rows, started from the sign along ``direction``; both sides are non-empty."""
    side = values @ direction > 0
    for _ in range(10):
        low, high = values[~side].mean(axis=0), values[side].mean(axis=0)
        nearer = values @ (high - low) > (high @ high - low @ low) / 2
        if (nearer == side).all() or nearer.all() or not nearer.any():
            break
        side = nearer
    return side


def _absorb(votes: Votes, groups: Int[np.ndarray, "N"], base: int, cfg: RobustConfig) -> Int[np.ndarray, "N"]:
    """Gives small groups to larger ones that explain them by noise and a wrong label.

    The mean of n half chi squares of d votes stays below (d + 4.5 sqrt(2 d / n)) / 2; a wrong label
    costs its logarithm.
    """
    groups = _without_gaps(groups)
    counts = np.bincount(groups)
    is_small = counts < cfg.seed_voxels
    is_small[0] = False
    if not is_small.any():
        return groups
    rows = np.flatnonzero(is_small[groups])
    rows = rows[np.argsort(groups[rows], kind="stable")]
    large = np.flatnonzero(~is_small)
    renumber = np.full(len(counts), -1)
    renumber[large] = np.arange(len(large))
    costs = voxel_costs(votes, summarise(votes, renumber[groups], base), rows, cfg.outside)
    starts = np.flatnonzero(np.diff(groups[rows], prepend=-1))
    number = np.diff(np.append(starts, len(rows)))
    limit = (WIDTH + 4.5 * np.sqrt(2 * WIDTH / number)) / 2 - np.log(cfg.label_error / 8)
    explained = (np.add.reduceat(costs, starts, axis=0) / number[:, None]).min(axis=1) < limit
    moved = np.repeat(explained, number)
    out = groups.copy()
    out[rows[moved]] = large[costs[moved].argmin(axis=1)]
    return out


def _merge(
    votes: Votes, groups: Int[np.ndarray, "N"], pieces: Int[np.ndarray, "N"], base: int, cfg: RobustConfig
) -> Int[np.ndarray, "N"]:
    """Merges groups that look like one part, the most alike first, until none do."""
    while True:
        groups = _without_gaps(groups)
        stats = summarise(votes, groups, base)
        total = len(stats.count)
        piece = np.zeros(total, dtype=np.int64)
        piece[groups] = pieces
        scores = merge_scores(
            votes,
            stats,
            groups,
            same_piece=piece[:, None] == piece,
            tolerance=cfg.extent_tolerance,
            outside=cfg.outside,
            label_penalty=-2 * np.log(cfg.label_error),
        )
        scores[0, stats.label == base] = scores[stats.label == base, 0] = -np.inf
        np.fill_diagonal(scores, np.inf)
        into = np.arange(total)
        taken = np.zeros(total, dtype=bool)
        candidates = np.argwhere(scores < cfg.merge_evidence)
        for a, b in candidates[np.argsort(scores[tuple(candidates.T)], kind="stable")]:
            if not taken[a] and not taken[b]:
                into[max(a, b)] = min(a, b)
                taken[a] = taken[b] = True
        if not taken.any():
            return groups
        groups = into[groups]


def _without_gaps(groups: Int[np.ndarray, "N"]) -> Int[np.ndarray, "N"]:
    used = np.bincount(groups) > 0
    return (np.cumsum(used) - 1)[groups]


def _reassign(
    votes: Votes, groups: Int[np.ndarray, "N"], pairs: Int[np.ndarray, "2 E"], base: int, cfg: RobustConfig
) -> Int[np.ndarray, "N"]:
    """Moves every voxel to the group that explains it best, neighbours included."""
    groups = _without_gaps(groups)
    stats = summarise(votes, groups, base)
    total = len(stats.count)
    costs = voxel_costs(votes, stats, np.arange(len(groups)), cfg.outside)
    keys = np.concatenate([pairs[0] * total + groups[pairs[1]], pairs[1] * total + groups[pairs[0]]])
    touching = np.bincount(keys, minlength=len(groups) * total).reshape(len(groups), total)
    return (costs - cfg.neighbour_weight * touching).argmin(axis=1)
