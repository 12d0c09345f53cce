"""The robust recipe: voxels vote for boxes, and a part must fill the box it votes for.

Semantics and connectivity give a first grouping. A group whose votes scatter more than the noise of
the field is split. Groups are merged when their votes agree and they fill the box that they vote for
better together than each alone. Finally every voxel goes to the part that best explains its votes, its
label, its joint type, its place in the part's box, and its neighbours.
The noise is measured on the field itself: the base is one part, so the scatter of its votes is noise.
"""

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.errors import SegmentationError
from artigen.voxels.fields import VoxelFields
from artigen.voxels.regions import connected_groups
from artigen.voxels.segmentation.neighbours import Partition, canonical_partition, neighbour_pairs
from artigen.voxels.segmentation.votes import (
    BASE,
    WIDTH,
    GroupVotes,
    Votes,
    class_costs,
    collect_votes,
    merge_scores,
    overlong_axis,
    placed_votes,
    select_groups,
    summarise,
    vote_costs,
)

SPLIT_SCATTER = 1.5
"""A group is split when its votes scatter this many times more than noise alone (variance)."""
OVERLONG = 1.5
"""A group is split across an axis when it is longer than its voted box by this many voxels and twice
the standard error of that vote."""
SEED_VOXELS = 24
"""A group of fewer voxels is a part of its own only when no larger part explains it."""
ABSORB_SIGMAS = 8.0
"""Largest deviation, in standard deviations, of the votes of a small group from the group that
absorbs it. Raise it when single stray voxels become parts."""
MERGE_EVIDENCE = 8.0
"""Two groups are one part when the evidence against that stays below this."""
NEIGHBOUR_WEIGHT = 0.5
"""Evidence for a part per neighbouring voxel that belongs to it."""
ROUNDS = 2
"""Rounds of merging and reassignment."""
MAX_GROUPS = 2500
"""Votes that fall into more groups than this are rejected as noise; time grows as their square."""


def partition_robust(fields: VoxelFields) -> Partition:
    """Divides the voxels among parts by votes, boxes and connectivity; the base is one part.

    Raises:
        SegmentationError: If the votes are noise.
    """
    pairs = neighbour_pairs(fields.coords.astype(np.int64), fields.resolution)
    labels = fields.label_probs.argmax(axis=1)
    alike = labels[pairs[0]] == labels[pairs[1]]
    votes = collect_votes(fields, is_base=labels == BASE, alike=pairs[:, alike])
    pieces = connected_groups(len(labels), pairs[:, alike])
    groups = _first_groups(votes, pieces, labels == BASE)
    if groups.max() > MAX_GROUPS:
        raise SegmentationError(
            f"the votes of {len(labels)} voxels fall into {groups.max()} groups, expected at most "
            f"{MAX_GROUPS}: the votes of neighbouring voxels differ too much to form parts"
        )
    groups = _absorb(votes, groups, np.inf)
    for _ in range(ROUNDS):
        groups = _absorb(votes, groups, 2.0)
        groups = _merge(votes, groups, pieces)
        groups = _reassign(votes, groups, pairs)
    groups = _without_gaps(_absorb(votes, groups, 2.0))
    label = summarise(votes, groups).label
    groups[label[groups] == BASE] = 0
    return canonical_partition(fields, groups, label)


def _first_groups(
    votes: Votes, pieces: Int[np.ndarray, "N"], is_base: Bool[np.ndarray, "N"]
) -> Int[np.ndarray, "N"]:
    """Group 0 is the base; connected voxels of one label follow, split where their votes disagree."""
    groups = np.zeros(len(pieces), dtype=np.int64)
    rows = np.flatnonzero(~is_base)
    order = rows[np.argsort(pieces[rows], kind="stable")]
    starts = np.flatnonzero(np.diff(pieces[order], prepend=-1))
    count = 1
    for piece in np.split(order, starts[1:]) if len(order) else []:
        for part in _split(votes, piece):
            groups[part] = count
            count += 1
    return groups


def _split(votes: Votes, rows: Int[np.ndarray, "n"]) -> list[np.ndarray]:
    """Bisects ``rows`` until no direction scatters `SPLIT_SCATTER` times more than noise would.

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
        if variances[-1] > SPLIT_SCATTER * (1 + np.sqrt(WIDTH / draws)) ** 2:
            side = _bisect(values, directions[:, -1])
        else:
            long = overlong_axis(votes, piece, OVERLONG)
            if long is None:
                done.append(piece)
                continue
            side = _bisect(values[:, [long]], np.ones(1))
        waiting += [piece[side], piece[~side]]
    return done


def _bisect(values: Float[np.ndarray, "n D"], direction: Float[np.ndarray, "D"]) -> Bool[np.ndarray, "n"]:
    """Two-means of centred rows, started from the sign along ``direction``; both sides are non-empty."""
    side = values @ direction > 0
    for _ in range(10):
        low, high = values[~side].mean(axis=0), values[side].mean(axis=0)
        nearer = values @ (high - low) > (high @ high - low @ low) / 2
        if (nearer == side).all() or nearer.all() or not nearer.any():
            break
        side = nearer
    return side


def _absorb(votes: Votes, groups: Int[np.ndarray, "N"], share: float) -> Int[np.ndarray, "N"]:
    """Gives small groups to larger ones that explain them by noise, whatever their classes.

    A larger group has `SEED_VOXELS`, or ``share`` times the voxels. `_explained_below` gives the limit.
    """
    groups = _without_gaps(groups)
    stats = summarise(votes, groups)
    returned = _return_to_base(votes, stats, groups)
    if (returned != groups).any():
        groups = _without_gaps(returned)
        stats = summarise(votes, groups)
    is_small = stats.count < SEED_VOXELS
    is_small[0] = False
    if not is_small.any():
        return groups
    rows = np.flatnonzero(is_small[groups])
    rows = rows[np.argsort(groups[rows], kind="stable")]
    number = stats.count[is_small]
    larger = np.flatnonzero(stats.count >= min(share, SEED_VOXELS))
    if not len(larger):  # a handful of voxels: not even the base is a seed
        return groups
    costs = vote_costs(votes, select_groups(stats, larger), rows)
    least = np.minimum(np.repeat(number, number) * share, SEED_VOXELS)
    costs[least[:, None] > stats.count[larger]] = np.inf
    mean = np.add.reduceat(costs, np.cumsum(number) - number, axis=0) / number[:, None]
    limit = _explained_below(number)
    moved = np.repeat(mean.min(axis=1) < limit, number)
    out = groups.copy()
    out[rows[moved]] = larger[costs[moved].argmin(axis=1)]
    return out


def _explained_below(number: Int[np.ndarray, "K"]) -> Float[np.ndarray, "K"]:
    """Mean cost below which ``number`` voxels may be in a group by noise alone.

    A half chi squared of d votes has mean d / 2 and standard deviation sqrt(2 d) / 2. The allowance falls
    faster with the number than that of a mean would, because single voxels have a long chi-squared tail.
    """
    return (WIDTH + ABSORB_SIGMAS * np.sqrt(2 * WIDTH) / number**0.75) / 2


def _return_to_base(votes: Votes, stats: GroupVotes, groups: Int[np.ndarray, "N"]) -> Int[np.ndarray, "N"]:
    """Gives groups of any size to the base where its votes explain them: patches of wrong labels.

    No real part votes for the box of the base.
    """
    rows = np.flatnonzero(groups > 0)
    costs = vote_costs(votes, select_groups(stats, np.array([0])), rows)[:, 0]
    mean = np.bincount(groups[rows], weights=costs, minlength=len(stats.count)) / stats.count
    limit = np.maximum(_explained_below(stats.count), 0.75 * WIDTH)
    return np.where((groups > 0) & (mean < limit)[groups], 0, groups)


def _merge(votes: Votes, groups: Int[np.ndarray, "N"], pieces: Int[np.ndarray, "N"]) -> Int[np.ndarray, "N"]:
    """Merges groups that look like one part, the most similar first, until none are left."""
    while True:
        groups = _without_gaps(groups)
        stats = summarise(votes, groups)
        total = len(stats.count)
        piece = _main_piece(groups, pieces)
        scores = merge_scores(votes, stats, groups, piece[:, None] == piece)
        scores[0, stats.label == BASE] = scores[stats.label == BASE, 0] = -np.inf
        np.fill_diagonal(scores, np.inf)
        into = np.arange(total)
        taken = np.zeros(total, dtype=bool)
        candidates = np.argwhere(scores < MERGE_EVIDENCE)
        for a, b in candidates[np.argsort(scores[tuple(candidates.T)], kind="stable")]:
            if not taken[a] and not taken[b]:
                into[max(a, b)] = min(a, b)
                taken[a] = taken[b] = True
        if not taken.any():
            return groups
        groups = into[groups]


def _main_piece(groups: Int[np.ndarray, "N"], pieces: Int[np.ndarray, "N"]) -> Int[np.ndarray, "G"]:
    """The connected piece that most voxels of each group come from."""
    span = int(pieces.max()) + 1
    keys, counts = np.unique(groups * span + pieces, return_counts=True)
    owner, piece = np.divmod(keys, span)
    order = np.lexsort((-counts, owner))
    return piece[order][np.flatnonzero(np.diff(owner[order], prepend=-1))]


def _without_gaps(groups: Int[np.ndarray, "N"]) -> Int[np.ndarray, "N"]:
    used = np.bincount(groups) > 0
    return (np.cumsum(used) - 1)[groups]


def _reassign(
    votes: Votes, groups: Int[np.ndarray, "N"], pairs: Int[np.ndarray, "2 E"]
) -> Int[np.ndarray, "N"]:
    """Moves every voxel to the group that explains it best, neighbours included.

    Voxels that the base explains within twice the expected chi squared stay there.
    """
    groups = _without_gaps(groups)
    stats = summarise(votes, groups)
    total = len(stats.count)
    in_base = np.flatnonzero(groups == 0)
    sure = vote_costs(votes, select_groups(stats, np.array([0])), in_base)[:, 0] < WIDTH
    rows = np.setdiff1d(np.arange(len(groups)), in_base[sure], assume_unique=True)
    costs = vote_costs(votes, stats, rows) + class_costs(votes, stats, rows)
    place = np.full(len(groups), -1)
    place[rows] = np.arange(len(rows))
    ends = np.concatenate([pairs, pairs[::-1]], axis=1)
    ends = ends[:, place[ends[0]] >= 0]
    touching = np.bincount(place[ends[0]] * total + groups[ends[1]], minlength=len(rows) * total)
    out = groups.copy()
    out[rows] = (costs - NEIGHBOUR_WEIGHT * touching.reshape(len(rows), total)).argmin(axis=1)
    return out
