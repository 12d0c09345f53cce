"""Collision hulls of a part: few, close to its mesh, and never across a cavity.

`sim_export.collision.hull_methods` proposes hulls, this module holds them to what physics engines ask and to
what a hand or a thing must be able to enter. Volume error is the symmetric difference of hulls and
mesh over the mesh's volume, by exact booleans.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim_export.collision.hull_limits import THICKEST, compact_hull, comply_hull
from sim_export.collision.hull_methods import Method, Part, diagonal_of, hull_candidates
from sim_export.collision.hull_pool import Solid
from sim_export.errors import DecompositionFailed
from sim_export.geometry.solids import as_solid, measure_fit, measure_kept_cavity, unite_hulls
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
