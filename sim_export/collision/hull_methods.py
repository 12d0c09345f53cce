"""Decomposition methods, and the order in which they are tried.

From cheap to dear: one ``hull`` where the part is convex; ``boxes`` where few of them are enough; a
``cover`` by boxes, convex pieces and what joins to more, of which those are taken that gain most.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from sim_export.checks.surface import SampledSurface, sample_surface_tree
from sim_export.collision.convex_pieces import MOST_PIECES, Solid
from sim_export.collision.cuboids import CuboidFit
from sim_export.collision.hull_cover import CoverConfig, choose_hulls
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
)
from sim_export.collision.hull_pool import box_offers, piece_offers, rest_offers
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
