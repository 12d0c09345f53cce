"""Decomposition methods, and the order in which they are tried.

From cheap to dear: one ``hull`` where the part is convex; ``boxes`` where these are enough; a ``cover`` by
boxes, convex pieces and what joins to more. The cover is greedy: again and again, the hull is taken that
gains most, by what `sim_export.collision.hull_offers` has measured. What the budget leaves out is what volume
and surface miss least.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from jaxtyping import Bool, Int, UInt64

from sim_export.checks.surface import SampledSurface, sample_surface_tree
from sim_export.collision.hull_offers import (
    TAKEN,
    Ground,
    Offers,
    PooledHull,
    join_offers,
    make_ground,
    measure_offers,
    pack_marks,
)
from sim_export.collision.hull_pool import MOST_PIECES, Solid, box_offers, piece_offers
from sim_export.geometry.solids import (
    SURFACE_SAMPLES,
    measure_bulge,
    measure_fit,
    measure_intrusion,
    measure_stray,
    solid_arrays,
    solid_hull,
    unite_hulls,
)
from sim_export.package import Hull

LEAST_SHARE = 0.02
"""Share of its weight from which on surface counts."""

MISSED_WEIGHT = 10.0
"""What a share of the surface missed counts, in shares of the volume."""
FREE_SHARE = 0.004
"""Share of the surface that may be missed for nothing, unless it is too far away."""
FAR_WEIGHT = 40.0
"""What a share of the surface that is too far away counts on top of that."""
FIRST_LOOKS = ((1.0, 0.0), (1.0, 0.02), (1.0, 1.0), (2.0, 0.02), (2.0, 0.1), (4.0, 0.0), (4.0, 0.1))
"""What greedy choices begin with: factor of what filling counts, share of the surface's weight."""
PRICE = 0.002
"""What every hull costs, in shares of the volume."""
Method = Literal["hull", "boxes", "cover"]
MISSED = 0.012
"""A point farther than this from the other surface, over the object's diagonal, is missed."""
FARTHEST = 0.018
"""No point should be farther away than this."""
CAVITY_WEIGHTS = (1.0, 4.0, 16.0)
"""What free space filled counts against solid missed: more where the first cover fills a cavity."""
COVER_TOLERANCE = 0.1
"""What a cover by boxes may miss and cost, in shares of the volume, before convex pieces are tried."""
HULL_TOLERANCE = 0.1
"""Volume error up to which a single hull is taken."""
SMALL = 0.2
"""Diagonal, over the object's, below which a part gets a third of hulls and pieces: handles and knobs."""
SIMPLIFY = 0.0025
"""Detail left out before cutting, over the mesh's diagonal."""


def choose_hulls(offers: Offers, most: int, weight: float = 1.0) -> tuple[tuple[Hull, ...], float]:
    """The hulls that together stand best for the solid, and their loss; none where none was offered.

    Greedy choices depend on what is looked for first, so surface is first given little weight, then more.

    Args:
        offers: What is chosen from.
        most: Hulls, at most.
        weight: What free space filled counts against solid missed; more keeps cavities freer.
    """
    if not offers.tiles:
        return (), np.inf
    covers = [_cover(offers, most, factor * weight, share) for factor, share in FIRST_LOOKS]
    losses = [_loss(offers, cover, weight) for cover in covers]
    best = int(np.argmin(losses))
    return tuple(tile for index in covers[best] for tile in offers.tiles[index]), losses[best]


def _loss(offers: Offers, cover: list[int], weight: float) -> float:
    """What a cover misses, fills and costs."""
    covered = np.zeros(offers.weights.shape, dtype=bool)
    for index in cover:
        offers.cells[index].fill(covered, value=True)
    held = offers.weights[covered]
    filled = offers.surplus[cover].sum() - held[held < 0].sum()
    volume = 1.0 - held[held > 0].sum() + weight * filled
    surface = (
        _surface_loss(_missing_beside(offers, cover)[None], offers.points)[0]
        + MISSED_WEIGHT * offers.bulges[cover].sum()
    )
    return float(volume + surface + PRICE * offers.costs[cover].sum())


def _cover(offers: Offers, most: int, filled: float, share: float) -> list[int]:
    """Greedy choice of at most ``most`` hulls, for which free space counts ``filled`` times.

    Surface counts ``share`` of its weight until nothing is gained so, then ever more.
    """
    value = np.where(offers.weights < 0, filled * offers.weights, offers.weights)
    volumes = np.array([item.select(value).sum() for item in offers.cells])
    fixed = filled * offers.surplus + PRICE * offers.costs
    missing = _missing_beside(offers, ())
    surfaces = _surface_gains(offers, missing)
    chosen: list[int] = []
    room = most
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


def _meet(bounds: Int[np.ndarray, "K 3 2"], other: Int[np.ndarray, "3 2"]) -> Bool[np.ndarray, "K"]:
    """Whether windows of cells have any in common with another."""
    return np.all((bounds[..., 0] < other[:, 1]) & (other[:, 0] < bounds[..., 1]), axis=-1)


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


def diagonal_of(solid: Solid) -> float:
    """Diagonal of a solid's bounding box (m)."""
    low, high = np.array(solid.bounding_box()).reshape(2, 3)
    return float(np.linalg.norm(high - low))


@dataclass(frozen=True, kw_only=True, eq=False)
class Part:
    """A part's solid, and what its hulls are chosen from: found on demand, once for any number of hulls."""

    solid: Solid
    size: float
    """Diagonal (m) of the whole object, by which distances are judged."""
    others: tuple[Solid, ...] = ()
    """Parts of other links whose boxes meet this one's: where they are, no hull should be."""

    @cached_property
    def simple(self) -> Solid:
        """The solid without detail, unless that costs more than a hundredth of its volume."""
        simple = self.solid.simplify(SIMPLIFY * diagonal_of(self.solid))
        return simple if abs(simple.volume() / self.solid.volume() - 1.0) < 0.01 else self.solid

    def allot(self, most: int) -> int:
        """How many of ``most`` hulls or pieces a part of this size may have."""
        return most if diagonal_of(self.solid) >= SMALL * self.size else max(1, most // 3)

    @cached_property
    def surface(self) -> SampledSurface:
        """The solid's surface, to measure distances to."""
        vertices, faces = solid_arrays(self.simple)
        return sample_surface_tree(vertices[faces], SURFACE_SAMPLES)

    @cached_property
    def boxes(self) -> Offers:
        """Boxes and what they join to, measured against the solid."""
        return self._measure(box_offers(self.simple))

    @cached_property
    def pieces(self) -> Offers:
        """Convex pieces and what they join to, measured against the solid."""
        return self._measure(piece_offers(self.simple, self.allot(MOST_PIECES)))

    @cached_property
    def everything(self) -> Offers:
        """Boxes and pieces."""
        return join_offers(self.boxes, self.pieces)

    @cached_property
    def _ground(self) -> Ground:
        return make_ground(self.simple, self.others)

    def _measure(self, pool: Sequence[PooledHull]) -> Offers:
        return measure_offers(pool, self._ground, MISSED * self.size, FARTHEST * self.size)


def hull_candidates(part: Part, max_hulls: int) -> Iterator[tuple[Method, tuple[Hull, ...]]]:
    """Hulls by several methods, best first; the next only costs time if asked for."""
    whole = (solid_hull(part.simple),)
    if _measure_error(whole, part) <= HULL_TOLERANCE:
        yield "hull", whole
    for weight in CAVITY_WEIGHTS:
        hulls, loss = choose_hulls(part.boxes, part.allot(max_hulls), weight)
        if hulls and loss <= COVER_TOLERANCE:
            yield "boxes", hulls
            continue
        hulls = choose_hulls(part.everything, part.allot(max_hulls), weight)[0]
        if hulls:
            yield "cover", hulls
    yield "hull", whole


def _measure_error(hulls: Sequence[Hull], part: Part) -> float:
    """Volume error of hulls against the simplified solid, and what surface they miss: a tenth of a percent of
    it missed weighs as much as a percent of the volume; so does a fifth of a percent of it that fills other
    links."""
    union = unite_hulls(hulls)
    error = measure_fit(union, part.simple).volume_error
    least = MISSED * part.size
    for distances in (measure_stray(hulls, part.simple), measure_bulge(hulls, part.surface, least)):
        missed = float((distances > least).mean())
        too_far = max(0.0, float(distances.max(initial=0.0)) / part.size - FARTHEST)
        error += 10.0 * missed + 20.0 * too_far
    return error + TAKEN * measure_intrusion(union, part.simple, part.others)
