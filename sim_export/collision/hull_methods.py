"""Decomposition methods, and the order in which `auto` tries them.

From cheap to dear: one ``hull`` where the part is convex; ``boxes`` where few of them are enough; a
``cover`` by boxes, convex pieces and what joins to more, of which those are taken that gain most. CoACD
is there on request.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np

from sim_export.checks.surface import SampledSurface, sample_surface_tree
from sim_export.collision.coacd_process import CoacdConfig, run_coacd
from sim_export.collision.convex_pieces import Solid
from sim_export.collision.cuboids import CuboidFit
from sim_export.collision.hull_cover import CoverConfig, choose_hulls
from sim_export.collision.hull_limits import HullLimits, comply_hull, tile_hull
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
from sim_export.errors import DecompositionFailed
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
from sim_export.package import Hull, Mesh

Method = Literal["hull", "boxes", "pieces", "cover", "coacd", "surface"]
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


@dataclass(frozen=True, kw_only=True)
class DecomposeConfig:
    """How a part becomes hulls."""

    method: Literal["auto", "boxes", "pieces", "coacd"] = "auto"
    """One method, or the cheapest that is good enough."""
    max_hulls: int = 60
    """Most hulls per part, and per link; fewer than `MOST_OF_LINK`, for what clearance may have to split.
    Physics engines slow down with every one."""
    tolerance: float = 0.05
    """Volume error up to which `auto` takes the first few boxes rather than looking for better hulls."""
    few: int = 12
    """Most boxes that it takes so."""
    cover_tolerance: float = 0.1
    """What a cover by boxes may miss and cost, in shares of the volume, before convex pieces are tried."""
    hull_tolerance: float = 0.1
    """Volume error up to which `auto` takes a single hull."""
    min_kept_cavity: float = 0.9
    """Least share of the space inside the part's convex hull that must stay free."""
    min_cavity: float = 0.3
    """Space, over the part's convex hull, below which it does not count as a cavity."""
    min_cavity_volume: float = 5e-4
    """Nor do cavities below this volume (m^3): a pocket in a knob may be filled."""
    skin: float = 0.015
    """Space nearer to the part than this, over its diagonal, does not count as cavity either."""
    min_skin: float = 0.008
    """Nor does space nearer than this (m): no finger fits into it."""
    max_pieces: int = 72
    """Convex pieces that the solid is cut into, at most; raise it for parts with fine detail."""
    small: float = 0.2
    """Diagonal, over the object's, below which a part gets a third of hulls and pieces: handles and knobs."""
    simplify: float = 0.0025
    """Detail left out before cutting, over the mesh's diagonal; raise it when curved meshes take long."""
    on_failure: Literal["raise", "hull"] = "raise"
    """What to do where no method works: raise, or take one convex hull and record it."""
    size: float = 0.0
    """Diagonal (m) of the whole object, by which distances are judged; 0 takes the part's own."""
    limits: HullLimits = field(default_factory=HullLimits)
    """What each hull must be like."""
    coacd: CoacdConfig = field(default_factory=lambda: CoacdConfig(timeout=20.0))
    """Parameters of CoACD."""

    def __post_init__(self) -> None:
        for name in ("tolerance", "cover_tolerance", "hull_tolerance", "min_kept_cavity", "min_cavity"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ValueError(f"decompose: {name} is {getattr(self, name)}, expected 0 to 1")
        if self.max_hulls < 1:
            raise ValueError(f"decompose: max_hulls is {self.max_hulls}, expected at least 1")


def diagonal_of(solid: Solid) -> float:
    """Diagonal of a solid's bounding box (m)."""
    low, high = np.array(solid.bounding_box()).reshape(2, 3)
    return float(np.linalg.norm(high - low))


@dataclass(frozen=True, kw_only=True, eq=False)
class Part:
    """A part's solid, and what its hulls are chosen from: found on demand, once for any number of hulls."""

    solid: Solid
    cfg: DecomposeConfig
    others: tuple[Solid, ...] = ()
    """Parts of other links whose boxes meet this one's: where they are, no hull should be."""

    @cached_property
    def simple(self) -> Solid:
        """The solid without detail, unless that costs more than a hundredth of its volume."""
        simple = self.solid.simplify(self.cfg.simplify * diagonal_of(self.solid))
        return simple if abs(simple.volume() / self.solid.volume() - 1.0) < 0.01 else self.solid

    @property
    def size(self) -> float:
        """The length (m) by which distances are judged."""
        return self.cfg.size or diagonal_of(self.solid)

    def allot(self, most: int) -> int:
        """How many of ``most`` hulls or pieces a part of this size may have."""
        return most if diagonal_of(self.solid) >= self.cfg.small * self.size else max(1, most // 3)

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
        return self._measure(box_offers(self.simple, self.cuboids, self.cfg.limits))

    @cached_property
    def pieces(self) -> Offers:
        """Convex pieces and what they join to, measured against the solid."""
        return self._measure(piece_offers(self.simple, self.cfg.limits, self.allot(self.cfg.max_pieces)))

    @cached_property
    def everything(self) -> Offers:
        """Boxes, pieces, and small boxes of what neither holds."""
        both = join_offers(self.boxes, self.pieces)
        rest = find_rest(both)
        if both.weights[rest].sum() < LEAST_REST:
            return both
        more = rest_offers(self._ground, rest, self.simple.volume(), self.cfg.limits)
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


def hull_candidates(part: Part, max_hulls: int, cache: Path | None) -> Iterator[Candidate]:
    """Hulls by the method asked for, or by several, best first; the next only costs time if asked for."""
    method = part.cfg.method
    if method == "coacd":
        vertices, faces = solid_arrays(part.simple)
        found = run_coacd(Mesh(vertices=vertices, faces=faces), part.cfg.coacd, cache)
        yield _measured("coacd", found, part)
    elif method == "auto":
        yield from _auto(part, max_hulls)
    else:
        offers = part.boxes if method == "boxes" else part.pieces
        hulls = choose_hulls(offers, CoverConfig(max_hulls=part.allot(max_hulls)))[0]
        if not hulls:
            raise DecompositionFailed(
                f"no {method} fit a mesh of {part.simple.num_tri()} faces; use method 'auto'"
            )
        yield _measured(method, hulls, part)


def _auto(part: Part, max_hulls: int) -> Iterator[Candidate]:
    whole = _measured("hull", [solid_hull(part.simple)], part)
    if whole.error <= part.cfg.hull_tolerance:
        yield whole
    boxes = _few_boxes(part, max_hulls)
    if boxes is not None:
        yield boxes
    for weight in CAVITY_WEIGHTS:
        cfg = CoverConfig(max_hulls=part.allot(max_hulls), filled_weight=weight)
        hulls, loss = choose_hulls(part.boxes, cfg)
        if hulls and loss <= part.cfg.cover_tolerance:
            yield _measured("boxes", hulls, part)
            continue
        hulls = choose_hulls(part.everything, cfg)[0]
        if hulls:
            yield _measured("cover", hulls, part)
    yield whole


def _few_boxes(part: Part, max_hulls: int) -> Candidate | None:
    """The coarsest boxes within tolerance, if they are few."""
    for detail in FEW_DETAILS:
        boxes = part.cuboids.take(part.cfg.few + 1, detail)
        if boxes is None or len(boxes) > part.cfg.few:
            return None
        hulls = [box_hull(low, high) for low, high in boxes]
        if not hulls or not _few_tiles(hulls, part.cfg.limits, max_hulls):
            continue
        found = _measured("boxes", hulls, part)
        if found.error <= part.cfg.tolerance:
            return found
    return None


def _few_tiles(hulls: Sequence[Hull], limits: HullLimits, most: int) -> bool:
    """Whether hulls can be cut to the length that their thickness allows without being too many."""
    tiles = [len(tile_hull(comply_hull(hull, limits), limits, most)) for hull in hulls]
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
