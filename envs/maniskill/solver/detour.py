"""Collision-free arm paths between two postures, with bidirectional random trees.

RRT-Connect in joint space with subsequent shortcutting. The random numbers are always the same, so that the
result is reproducible.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float

from .chain import Chain

RESOLUTION = 0.06
"""Largest change of a joint between two checked poses, rad."""
REACH = 0.6
"""Largest change of a joint in one branch, rad."""
TRIES = 700
SHORTCUTS = 80
WIDEST = 2.9
"""Largest angle of joints without limits, rad."""

Free = Callable[[Float[np.ndarray, "B J"]], Bool[np.ndarray, "B"]]


def find_detour(
    chain: Chain, free: Free, begin: Float[np.ndarray, "J"], end: Float[np.ndarray, "J"]
) -> Float[np.ndarray, "N J"] | None:
    """Waypoints from ``begin`` to ``end``, both included, connected by straight collision-free segments.

    Args:
        free: Tells which arm poses are collision-free.
        begin: Current arm angles, rad.
        end: Goal.

    Returns:
        ``None`` if no path was found, immediately if one of the ends collides.
    """
    if not free(np.stack([begin, end])).all():
        return None
    if is_clear(free, begin, end):
        return np.stack([begin, end])
    rng = np.random.default_rng(0)
    low, high = np.maximum(chain.lower, -WIDEST), np.minimum(chain.upper, WIDEST)
    trees = [([begin], [-1]), ([end], [-1])]
    for attempt in range(TRIES):
        here, there = trees[attempt % 2], trees[1 - attempt % 2]
        goal = rng.uniform(low, high) if rng.uniform() < 0.8 else there[0][rng.integers(len(there[0]))]
        if not _grow(free, here, goal, greedy=False):
            continue
        if _grow(free, there, here[0][-1], greedy=True):
            ways = [_back(tree) for tree in trees]
            return _shorten(free, np.array(ways[0][::-1] + ways[1][1:]), rng)
    return None


def is_clear(free: Free, begin: Float[np.ndarray, "J"], end: Float[np.ndarray, "J"]) -> bool:
    """Whether the straight segment between two poses is collision-free."""
    return bool(free(between(begin, end)).all())


def between(begin: Float[np.ndarray, "J"], end: Float[np.ndarray, "J"]) -> Float[np.ndarray, "N J"]:
    """Poses on the straight segment, the first excluded and the last included."""
    count = max(1, int(np.ceil(np.abs(end - begin).max() / RESOLUTION)))
    return begin + (end - begin) * np.arange(1, count + 1)[:, None] / count


def _grow(free: Free, tree: tuple[list, list], goal: np.ndarray, *, greedy: bool) -> bool:
    """Adds a branch towards ``goal``: a short one, or (greedy) as long as it is free. Returns whether
    anything (greedy: the goal) was reached."""
    nodes, parents = tree
    nearest = int(np.linalg.norm(np.array(nodes) - goal, axis=1).argmin())
    begin, far = nodes[nearest], float(np.abs(goal - nodes[nearest]).max())
    end = goal if greedy else begin + (goal - begin) * min(1.0, REACH / max(far, REACH))
    way = between(begin, end)
    good = free(way)
    count = len(way) if good.all() else int(np.argmin(good))
    if count == 0:
        return False
    nodes.append(way[count - 1])
    parents.append(nearest)
    return count == len(way) or not greedy


def _back(tree: tuple[list, list]) -> list[np.ndarray]:
    """Nodes from the newest one of a tree, where the trees met, to its root."""
    nodes, parents = tree
    index, out = len(nodes) - 1, []
    while index >= 0:
        out.append(nodes[index])
        index = parents[index]
    return out


def _shorten(free: Free, way: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Shortcuts corners where the straight segment is free."""
    for _ in range(SHORTCUTS):
        if len(way) < 3:
            break
        lengths = np.abs(np.diff(way, axis=0)).max(axis=1)
        ends = np.concatenate([[0.0], np.cumsum(lengths)])
        first, second = np.sort(rng.uniform(0.0, ends[-1], 2))
        i, j = (int(np.clip(np.searchsorted(ends, s) - 1, 0, len(way) - 2)) for s in (first, second))
        if i == j:
            continue
        a, b = (
            way[k] + (way[k + 1] - way[k]) * (s - ends[k]) / max(lengths[k], 1e-12)
            for k, s in ((i, first), (j, second))
        )
        if is_clear(free, a, b):
            way = np.concatenate([way[: i + 1], a[None], b[None], way[j + 1 :]])
    return way
