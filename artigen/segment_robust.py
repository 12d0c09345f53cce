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
from scipy.sparse import coo_array

from artigen.fields import VoxelFields
from artigen.neighbours import connected_groups, neighbour_pairs
from artigen.partition import Partition, canonical_partition
from artigen.votes import WIDTH, Votes, collect_votes, merge_scores, summarise, voxel_costs


@dataclass(frozen=True, kw_only=True)
class RobustConfig:
    """Sensitivities of the robust recipe; lengths in voxels, evidence in units of chi squared."""

    length_floor: float = 0.25
    """Least noise assumed on lengths, in voxels. Raise it when votes drift within a part and parts
    are found split."""
    motion_floor: float = 0.02
    """Least noise assumed on axis components and on normalised ranges."""
    split_scatter: float = 2.0
    """A group is split when its votes scatter this many times more than noise alone (variance)."""
    seed_voxels: int = 12
    """Connected voxels of one label that make a first group of their own; fewer only do when no
    other group explains them."""
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
    votes = collect_votes(fields, pairs[:, alike], floor, cfg.label_error)
    components = connected_groups(len(labels), pairs, alike)
    groups = _first_groups(votes, components, labels == base, base, cfg)
    for _ in range(cfg.rounds):
        groups = _merge(votes, groups, components, base, cfg)
        groups = _reassign(votes, groups, pairs, base, cfg)
    return canonical_partition(fields, groups, summarise(votes, groups, base).label)


def _first_groups(
    votes: Votes,
    components: Int[np.ndarray, "N"],
    is_base: Bool[np.ndarray, "N"],
    base: int,
    cfg: RobustConfig,
) -> Int[np.ndarray, "N"]:
    """Group 0 is the base; connected voxels of one label follow, split where their votes disagree."""
    groups = np.full(len(components), -1, dtype=np.int64)
    groups[is_base] = 0
    order = np.argsort(components, kind="stable")
    starts = np.flatnonzero(np.diff(components[order], prepend=-1))
    pieces = [rows for rows in np.split(order, starts[1:]) if not is_base[rows[0]]]
    count = 1
    for rows in (rows for rows in pieces if len(rows) >= cfg.seed_voxels):
        for piece in _split(votes.whitened, rows, cfg.split_scatter):
            groups[piece] = count
            count += 1
    small = [rows for rows in pieces if len(rows) < cfg.seed_voxels]
    if not small:
        return groups
    costs = voxel_costs(votes, summarise(votes, groups, base), np.concatenate(small), cfg.outside)
    limit = _explained_below(cfg)
    for rows, cost in zip(small, np.split(costs, np.cumsum([len(rows) for rows in small])[:-1]), strict=True):
        if cost.mean(axis=0).min() < limit:
            groups[rows] = cost.argmin(axis=1)
        else:
            groups[rows] = count
            count += 1
    return groups


def _explained_below(cfg: RobustConfig) -> float:
    """Cost under which a voxel may be in a group by noise and one wrong label: mean plus 3 sigma."""
    return (WIDTH + 3 * np.sqrt(2 * WIDTH)) / 2 - np.log(cfg.label_error / 8)


def _split(
    whitened: Float[np.ndarray, "N 14"], rows: Int[np.ndarray, "n"], scatter: float
) -> list[np.ndarray]:
    """Bisects ``rows`` until no direction scatters ``scatter`` times more than pure noise would.

    Pure noise of n samples in d dimensions has variances up to (1 + sqrt(d / n))^2 (Marchenko-Pastur).
    """
    done, waiting = [], [rows]
    while waiting:
        piece = waiting.pop()
        values = whitened[piece] - whitened[piece].mean(axis=0)
        variances, directions = np.linalg.eigh(values.T @ values / len(piece))
        if len(piece) < 2 or variances[-1] <= scatter * (1 + np.sqrt(WIDTH / len(piece))) ** 2:
            done.append(piece)
            continue
        side = values @ directions[:, -1] > 0
        for _ in range(10):
            means = np.stack([values[~side].mean(axis=0), values[side].mean(axis=0)])
            nearer = values @ (means[1] - means[0]) > (means[1] @ means[1] - means[0] @ means[0]) / 2
            if (nearer == side).all() or nearer.all() or not nearer.any():
                break
            side = nearer
        waiting += [piece[side], piece[~side]]
    return done


def _merge(
    votes: Votes, groups: Int[np.ndarray, "N"], components: Int[np.ndarray, "N"], base: int, cfg: RobustConfig
) -> Int[np.ndarray, "N"]:
    """Merges the two groups that look most like one part until none do."""
    label_penalty = -2 * np.log(cfg.label_error)
    while True:
        groups = _without_gaps(groups)
        stats = summarise(votes, groups, base)
        total = len(stats.count)
        if total == 1:
            return groups
        first = np.zeros(total, dtype=np.int64)
        first[groups] = components
        scores = np.full((total, total), np.inf)
        for index in range(total):
            scores[index] = merge_scores(
                votes, stats, index, first == first[index], cfg.extent_tolerance, label_penalty
            )
        scores[0, stats.label == base] = scores[stats.label == base, 0] = -np.inf
        np.fill_diagonal(scores, np.inf)
        merged = np.arange(total)
        taken = np.zeros(total, dtype=bool)
        for a, b in np.stack(np.unravel_index(np.argsort(scores, axis=None), scores.shape), axis=1):
            if scores[a, b] >= cfg.merge_evidence:
                break
            if not taken[a] and not taken[b]:
                merged[max(a, b)] = min(a, b)
                taken[a] = taken[b] = True
        if not taken.any():
            return groups
        groups = merged[groups]


def _without_gaps(groups: Int[np.ndarray, "N"]) -> Int[np.ndarray, "N"]:
    return np.unique(groups, return_inverse=True)[1].ravel()


def _reassign(
    votes: Votes, groups: Int[np.ndarray, "N"], pairs: Int[np.ndarray, "2 E"], base: int, cfg: RobustConfig
) -> Int[np.ndarray, "N"]:
    """Moves every voxel to the group that explains it best, neighbours included."""
    groups = _without_gaps(groups)
    stats = summarise(votes, groups, base)
    total = len(stats.count)
    everything = np.arange(len(groups))
    costs = voxel_costs(votes, stats, everything, cfg.outside)
    both = np.concatenate([pairs, pairs[::-1]], axis=1)
    touching = coo_array(
        (np.ones(both.shape[1], dtype=np.float32), (both[0], groups[both[1]])), shape=(len(groups), total)
    ).toarray()
    return (costs - cfg.neighbour_weight * touching).argmin(axis=1)
