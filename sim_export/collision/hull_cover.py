"""Greedy cover of a solid by few hulls from a pool.

Again and again, the one is taken that gains most per hull, by what `sim_export.collision.hull_offers` has
measured. What the budget leaves out is what volume and surface miss least.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, UInt64

from sim_export.collision.hull_offers import Offers, pack_marks
from sim_export.package import Hull

LEAST_SHARE = 0.02
"""Share of its weight from which on surface counts."""

MISSED_WEIGHT = 10.0
"""What a share of the surface missed counts, in shares of the volume."""
FREE_SHARE = 0.004
"""Share of the surface that may be missed for nothing, unless it is too far away."""
FAR_WEIGHT = 40.0
"""What a share of the surface that is too far away counts on top of that."""
FIRST_LOOKS = ((1.0, 0.0), (1.0, 0.02), (2.0, 0.02), (2.0, 0.1), (4.0, 0.0), (4.0, 0.1))
"""What greedy choices begin with: factor of ``filled_weight``, share of the surface's weight."""
GOOD = 0.05
"""Loss below which a cover is not improved any more."""
IMPROVED = 2
"""Covers that are improved, the best first."""
ROUNDS = 2
"""Most passes over the chosen hulls that replace one after the other."""
PRICE = 0.002
"""What every hull costs, in shares of the volume."""


@dataclass(frozen=True, kw_only=True)
class CoverConfig:
    """How many hulls there may be, and what they may fill."""

    max_hulls: int
    """Most hulls."""
    filled_weight: float = 1.0
    """What free space filled counts against solid missed; more keeps cavities freer."""


def choose_hulls(offers: Offers, cfg: CoverConfig) -> tuple[tuple[Hull, ...], float]:
    """The hulls that together stand best for the solid, within ``cfg.max_hulls``, and their loss.

    Greedy choices depend on what is looked for first, so surface is first given little weight, then
    more; the best of these covers are improved hull by hull. No hulls where none was offered.
    """
    if not offers.tiles:
        return (), np.inf
    empty = {filled: count_left(offers, filled * cfg.filled_weight) for filled, _ in FIRST_LOOKS}
    covers = [_cover(offers, cfg, empty[filled], share) for filled, share in FIRST_LOOKS]
    losses = [_loss(offers, cover, cfg) for cover in covers]
    order = np.argsort(losses, kind="stable")[:IMPROVED].tolist()
    better = [_improve(offers, covers[index], cfg) for index in order]
    losses = [_loss(offers, cover, cfg) for cover in better]
    loss, best = min(zip(losses, better, strict=True), key=lambda pair: pair[0])
    return tuple(tile for index in best for tile in offers.tiles[index]), loss


def _improve(offers: Offers, cover: list[int], cfg: CoverConfig) -> list[int]:
    """Takes single hulls out again and fills up anew, as long as that makes the cover better."""
    loss = _loss(offers, cover, cfg)
    left = None
    for _ in range(ROUNDS):
        before = loss
        if loss < GOOD:
            break
        for index in list(cover):
            if index not in cover:
                continue
            left = left or count_left(offers, cfg.filled_weight, cover)
            other = _cover(offers, cfg, take_out(offers, left, index), 1.0, never=index)
            changed = _loss(offers, other, cfg)
            if changed < loss - 1e-6:
                cover, loss, left = other, changed, None
        if loss >= before:
            break
    return cover


def _loss(offers: Offers, cover: list[int], cfg: CoverConfig) -> float:
    """What a cover misses, fills and costs."""
    covered = np.zeros(offers.weights.shape, dtype=bool)
    for index in cover:
        offers.cells[index].fill(covered, value=True)
    held = offers.weights[covered]
    filled = offers.surplus[cover].sum() - held[held < 0].sum()
    volume = 1.0 - held[held > 0].sum() + cfg.filled_weight * filled
    surface = (
        _surface_loss(_missing_beside(offers, cover)[None], offers.points)[0]
        + MISSED_WEIGHT * offers.bulges[cover].sum()
    )
    return float(volume + surface + PRICE * offers.costs[cover].sum())


@dataclass(frozen=True, kw_only=True, eq=False)
class Left:
    """What is left to gain beside some chosen hulls: cell by cell, and in all cells of every hull.

    Free space counts ``filled`` times.
    """

    chosen: tuple[int, ...]
    filled: float
    value: Float[np.ndarray, "X Y Z"]
    volumes: Float[np.ndarray, "K"]


def count_left(offers: Offers, filled: float, chosen: Sequence[int] = ()) -> Left:
    """What is left beside some hulls, counted from the start."""
    value = np.where(offers.weights < 0, filled * offers.weights, offers.weights)
    for index in chosen:
        offers.cells[index].fill(value, value=0.0)
    volumes = np.array([item.select(value).sum() for item in offers.cells])
    return Left(chosen=tuple(chosen), filled=filled, value=value, volumes=volumes)


def take_out(offers: Offers, left: Left, index: int) -> Left:
    """What is left when one of the chosen hulls is taken out: only what meets its cells is counted anew."""
    rest = tuple(other for other in left.chosen if other != index)
    value, window = left.value.copy(), offers.cells[index].window
    weights = offers.weights[window]
    value[window] = np.where(weights < 0, left.filled * weights, weights)
    for other in rest:
        if _meet(offers.bounds[other], offers.bounds[index]):
            offers.cells[other].fill(value, value=0.0)
    volumes = left.volumes.copy()
    for other in np.flatnonzero(_meet(offers.bounds, offers.bounds[index])):
        volumes[other] = offers.cells[other].select(value).sum()
    return Left(chosen=rest, filled=left.filled, value=value, volumes=volumes)


def _meet(bounds: Int[np.ndarray, "*K 3 2"], other: Int[np.ndarray, "3 2"]) -> Bool[np.ndarray, "*K"]:
    """Whether windows of cells have any in common with another."""
    return np.all((bounds[..., 0] < other[:, 1]) & (other[:, 0] < bounds[..., 1]), axis=-1)


def _cover(offers: Offers, cfg: CoverConfig, left: Left, share: float, never: int = -1) -> list[int]:
    """Greedy choice of all hulls but ``never``, on top of those chosen already.

    Surface counts ``share`` of its weight until nothing is gained so, then ever more.
    """
    value, volumes = left.value.copy(), left.volumes.copy()
    fixed = left.filled * offers.surplus + PRICE * offers.costs
    missing = _missing_beside(offers, left.chosen)
    surfaces = _surface_gains(offers, missing)
    chosen = list(left.chosen)
    room = cfg.max_hulls - int(offers.costs[chosen].sum())
    volumes[[*chosen, *([never] if never >= 0 else [])]] = -np.inf
    while room > 0:
        gains = volumes + share * surfaces - fixed
        score = np.where(offers.costs <= room, gains / offers.costs, -np.inf)
        best = int(score.argmax())
        if score[best] > 0.0:
            chosen.append(best)
            room -= int(offers.costs[best])
            offers.cells[best].fill(value, value=0.0)
            missing = missing & offers.missing[best]
            surfaces = _surface_gains(offers, missing)
            for index in np.flatnonzero(_meet(offers.bounds, offers.bounds[best]) & np.isfinite(volumes)):
                volumes[index] = offers.cells[index].select(value).sum()
            volumes[best] = -np.inf
        elif share < 1.0:
            share = min(1.0, max(LEAST_SHARE, 3.0 * share))
        else:
            break
    return chosen


def _surface_gains(offers: Offers, missing: np.ndarray) -> np.ndarray:
    """What each hull gains in surface, less what it bulges, where so much is ``missing`` yet."""
    gained = _surface_loss(missing[None], offers.points)[0] - _surface_loss(
        missing & offers.missing, offers.points
    )
    return gained - MISSED_WEIGHT * offers.bulges


def _missing_beside(offers: Offers, cover: Sequence[int]) -> UInt64[np.ndarray, "2 W"]:
    """The points that all hulls of a cover miss; all points without any."""
    everything = pack_marks(np.ones((2, offers.points), dtype=bool))
    return np.bitwise_and.reduce(offers.missing[list(cover)], axis=0) if len(cover) else everything


def _surface_loss(missing: UInt64[np.ndarray, "K 2 W"], total: int) -> np.ndarray:
    """What missing points count, out of ``total``."""
    missed, far = np.bitwise_count(missing).sum(axis=2, dtype=np.int64).T / total
    return MISSED_WEIGHT * np.maximum(missed - FREE_SHARE, 0.0) + FAR_WEIGHT * far
