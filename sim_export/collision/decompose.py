"""Collision hulls of a part: few, close to its mesh, and never across a cavity.

From cheap to dear: one ``hull`` where the part is convex; ``boxes`` where these are enough; a ``cover`` by
boxes, convex pieces and what joins to more (`sim_export.collision.hull_choice`). The first is taken that
leaves free what a hand or a thing must be able to enter. Volume error is the symmetric difference of hulls
and mesh over the mesh's volume, by exact booleans.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from sim_export.collision.hull_choice import (
    TAKEN,
    Ground,
    Offers,
    PooledHull,
    choose_hulls,
    join_offers,
    make_ground,
    measure_offers,
)
from sim_export.collision.hull_limits import THICKEST, compact_hull, comply_hull
from sim_export.collision.hull_pool import MOST_PIECES, Solid, box_offers, piece_offers
from sim_export.errors import DecompositionFailed
from sim_export.geometry.distances import SampledSurface, sample_surface_tree
from sim_export.geometry.solids import (
    SURFACE_SAMPLES,
    as_solid,
    measure_bulge,
    measure_fit,
    measure_intrusion,
    measure_kept_cavity,
    measure_stray,
    solid_arrays,
    solid_hull,
    unite_hulls,
)
from sim_export.package import Hull, Mesh

MOST_HULLS = 60
"""Most hulls per part, and per link; fewer than `MOST_OF_LINK`, for what clearance may have to split.
Physics engines slow down with every one."""
MIN_KEPT_CAVITY = 0.9
"""Least share of the space inside the part's convex hull that must stay free."""
MIN_CAVITY = 0.3
"""Space, over the part's convex hull, below which it does not count as a cavity."""
MIN_CAVITY_VOLUME = 5e-4
"""Nor do cavities below this volume (m^3): a pocket in a knob may be filled."""
SKIN = 0.015
"""Space nearer to the part than this, over its diagonal, does not count as cavity either."""
MIN_SKIN = 0.008
"""Nor does space nearer than this (m): no finger fits into it."""
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


@dataclass(frozen=True, kw_only=True, eq=False)
class Decomposition:
    """Hulls of one part and how true they are.

    ``kept_cavity`` is the share of the part's cavity that they leave free, 1 where it has none;
    ``records`` says what was tried in vain.
    """

    hulls: tuple[Hull, ...]
    method: Method
    volume_error: float
    kept_cavity: float
    records: tuple[str, ...] = ()


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


def decompose_part(mesh: Mesh, max_hulls: int = MOST_HULLS) -> Decomposition:
    """Convex hulls of one part's closed mesh (metres), which is the whole object.

    Raises:
        OpenMesh: if the mesh is not closed.
        DecompositionFailed: if all hulls would fill a cavity.
    """
    solid = as_solid(mesh)
    return _decompose(Part(solid=solid, size=diagonal_of(solid)), max_hulls)


def _decompose(part: Part, max_hulls: int) -> Decomposition:
    """The first candidate that leaves cavities free, and in its records why others did not do."""
    problems: list[str] = []
    for method, hulls in hull_candidates(part, max_hulls):
        result = _comply(method, hulls, part)
        if result.kept_cavity >= MIN_KEPT_CAVITY:
            return replace(result, records=tuple(problems))
        problem = (
            f"{len(result.hulls)} hulls by {method} leave {result.kept_cavity:.0%} of the "
            f"cavity free, at least {MIN_KEPT_CAVITY:.0%} allowed"
        )
        if problem not in problems:
            problems.append(problem)
    raise DecompositionFailed(f"{'; '.join(problems)}; make walls and openings thicker than a cell")


def _comply(method: Method, hulls: Sequence[Hull], part: Part) -> Decomposition:
    """Hulls within the limits of physics engines, measured against the solid."""
    solid = part.solid
    thickest = THICKEST * part.size
    limited = tuple(tile for hull in hulls for tile in compact_hull(comply_hull(hull), thickest))
    fit = measure_fit(unite_hulls(limited), solid)
    hollow = fit.cavity > MIN_CAVITY and fit.cavity * solid.hull().volume() > MIN_CAVITY_VOLUME
    skin = max(SKIN * diagonal_of(solid), MIN_SKIN)
    return Decomposition(
        hulls=limited,
        method=method,
        volume_error=fit.volume_error,
        kept_cavity=measure_kept_cavity(limited, solid, skin) if hollow else 1.0,
    )


def decompose_parts(
    meshes: Sequence[Mesh], owners: Sequence[int], max_hulls: int = MOST_HULLS
) -> tuple[Decomposition, ...]:
    """Hulls of all parts, so that parts with the same owner (one link) keep to ``max_hulls`` together.

    Each part is first decomposed alone; where a link has too many hulls, the parts with most are
    decomposed again with their share of what is allowed. Hulls keep out of parts with other owners.
    """
    corners = np.concatenate([mesh.vertices for mesh in meshes])
    size = float(np.linalg.norm(np.ptp(corners, axis=0)))
    solids = [as_solid(mesh) for mesh in meshes]
    parts = [
        Part(
            solid=solid,
            size=size,
            others=tuple(
                other
                for other, owner in zip(solids, owners, strict=True)
                if owner != owners[index] and _boxes_meet(solid, other)
            ),
        )
        for index, solid in enumerate(solids)
    ]
    out = [_decompose(part, max_hulls) for part in parts]
    for owner in sorted(set(owners)):
        mine = [index for index, other in enumerate(owners) if other == owner]
        for _ in range(3):  # cutting oblong hulls may give a part more than its share
            counts = {index: len(out[index].hulls) for index in mine}
            total = sum(counts.values())
            if total <= max_hulls:
                break
            spread = [index for index in mine if counts[index] > 1]
            room = max_hulls - (len(mine) - len(spread))
            taken = sum(counts[index] for index in spread)
            for index in spread:
                share = max(1, counts[index] * room // taken)
                if share < counts[index]:
                    out[index] = _decompose_again(parts[index], out[index], share)
    return tuple(out)


def _boxes_meet(first: Solid, second: Solid) -> bool:
    a, b = (np.array(solid.bounding_box()).reshape(2, 3) for solid in (first, second))
    return bool((a[0] < b[1]).all() and (b[0] < a[1]).all())


def _decompose_again(part: Part, full: Decomposition, max_hulls: int) -> Decomposition:
    """A part with fewer hulls, or the same as before, and a record, where so few would fill a cavity."""
    try:
        return _decompose(part, max_hulls)
    except DecompositionFailed as err:
        kept = f"kept {len(full.hulls)} hulls, more than its share of {max_hulls}: {err}"
        return full if kept in full.records else replace(full, records=(*full.records, kept))


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
