"""Decomposition methods, and the order in which they are tried.

From cheap to dear: one ``hull`` where the part is convex; ``boxes`` where few of them are enough; a
``cover`` by boxes, convex pieces and what joins to more. The cover is greedy: again and again, the hull
is taken that gains most, by what `sim_export.collision.hull_offers` has measured. What the budget leaves
out is what volume and surface miss least.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float, Int, UInt64

from sim_export.checks.surface import SampledSurface, sample_surface_tree
from sim_export.collision.cuboids import CuboidFit
from sim_export.collision.hull_limits import comply_hull, tile_hull
from sim_export.collision.hull_offers import (
    TAKEN,
    Ground,
    Offers,
    PooledHull,
    find_rest,
    join_offers,
    make_ground,
    measure_offers,
    pack_marks,
)
from sim_export.collision.hull_pool import MOST_PIECES, Solid, box_offers, piece_offers, rest_offers
from sim_export.collision.hulls import box_hull
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
Method = Literal["hull", "boxes", "cover"]
FEW_DETAILS = (1e-2, 3e-3, 1e-3)
"""Least share of the surface that a plane must hold to bound boxes; tried from coarse to fine."""
MISSED = 0.012
"""A point farther than this from the other surface, over the object's diagonal, is missed."""
FARTHEST = 0.018
"""No point should be farther away than this."""
LEAST_REST = 0.005
"""Share of the volume that no hull holds, above which small boxes are sought there."""
CAVITY_WEIGHTS = (1.0, 4.0, 16.0)
"""What free space filled counts against solid missed: more where the first cover fills a cavity."""
TOLERANCE = 0.05
"""Volume error up to which the first few boxes are taken rather than better hulls looked for."""
FEW = 12
"""Most boxes that are taken so."""
COVER_TOLERANCE = 0.1
"""What a cover by boxes may miss and cost, in shares of the volume, before convex pieces are tried."""
HULL_TOLERANCE = 0.1
"""Volume error up to which a single hull is taken."""
SMALL = 0.2
"""Diagonal, over the object's, below which a part gets a third of hulls and pieces: handles and knobs."""
SIMPLIFY = 0.0025
"""Detail left out before cutting, over the mesh's diagonal."""


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
    def cuboids(self) -> CuboidFit:
        """Boxes that fill the solid, where its faces are axis-aligned."""
        vertices, faces = solid_arrays(self.simple)
        return CuboidFit(vertices=vertices, faces=faces)

    @cached_property
    def surface(self) -> SampledSurface:
        """The solid's surface, to measure distances to."""
        vertices, faces = solid_arrays(self.simple)
        return sample_surface_tree(vertices[faces], SURFACE_SAMPLES)

    @cached_property
    def boxes(self) -> Offers:
        """Boxes and what they join to, measured against the solid."""
        return self._measure(box_offers(self.simple, self.cuboids))

    @cached_property
    def pieces(self) -> Offers:
        """Convex pieces and what they join to, measured against the solid."""
        return self._measure(piece_offers(self.simple, self.allot(MOST_PIECES)))

    @cached_property
    def everything(self) -> Offers:
        """Boxes, pieces, and small boxes of what neither holds."""
        both = join_offers(self.boxes, self.pieces)
        rest = find_rest(both)
        if both.weights[rest].sum() < LEAST_REST:
            return both
        more = rest_offers(self._ground, rest, self.simple.volume())
        return join_offers(both, self._measure(more))

    @cached_property
    def _ground(self) -> Ground:
        return make_ground(self.simple, self.others)

    def _measure(self, pool: Sequence[PooledHull]) -> Offers:
        return measure_offers(pool, self._ground, MISSED * self.size, FARTHEST * self.size)


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidate:
    """Hulls by one method and how untrue they are.

    ``error`` is the volume error against the simplified solid, and what surface they miss: a tenth of
    a percent of it missed weighs as much as a percent of the volume; so does a fifth of a percent of it that
    fills other links.
    """

    method: Method
    hulls: tuple[Hull, ...]
    error: float


def hull_candidates(part: Part, max_hulls: int) -> Iterator[Candidate]:
    """Hulls by several methods, best first; the next only costs time if asked for."""
    whole = _measured("hull", [solid_hull(part.simple)], part)
    if whole.error <= HULL_TOLERANCE:
        yield whole
    boxes = _few_boxes(part, max_hulls)
    if boxes is not None:
        yield boxes
    for weight in CAVITY_WEIGHTS:
        cfg = CoverConfig(max_hulls=part.allot(max_hulls), filled_weight=weight)
        hulls, loss = choose_hulls(part.boxes, cfg)
        if hulls and loss <= COVER_TOLERANCE:
            yield _measured("boxes", hulls, part)
            continue
        hulls = choose_hulls(part.everything, cfg)[0]
        if hulls:
            yield _measured("cover", hulls, part)
    yield whole


def _few_boxes(part: Part, max_hulls: int) -> Candidate | None:
    """The coarsest boxes within tolerance, if they are few."""
    for detail in FEW_DETAILS:
        boxes = part.cuboids.take(FEW + 1, detail)
        if boxes is None or len(boxes) > FEW:
            return None
        hulls = [box_hull(low, high) for low, high in boxes]
        if not hulls or not _few_tiles(hulls, max_hulls):
            continue
        found = _measured("boxes", hulls, part)
        if found.error <= TOLERANCE:
            return found
    return None


def _few_tiles(hulls: Sequence[Hull], most: int) -> bool:
    """Whether hulls can be cut to the length that their thickness allows without being too many."""
    tiles = [len(tile_hull(comply_hull(hull), most)) for hull in hulls]
    return min(tiles) > 0 and sum(tiles) <= most


def _measured(method: Method, hulls: Sequence[Hull], part: Part) -> Candidate:
    union = unite_hulls(hulls)
    error = measure_fit(union, part.simple).volume_error
    least = MISSED * part.size
    for distances in (measure_stray(hulls, part.simple), measure_bulge(hulls, part.surface, least)):
        missed = float((distances > least).mean())
        too_far = max(0.0, float(distances.max(initial=0.0)) / part.size - FARTHEST)
        error += 10.0 * missed + 20.0 * too_far
    error += TAKEN * measure_intrusion(union, part.simple, part.others)
    return Candidate(method=method, hulls=tuple(hulls), error=error)
