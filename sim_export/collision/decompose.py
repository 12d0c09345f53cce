"""Collision hulls of a part: few, close to its mesh, and never across a cavity.

`sim_export.collision.hull_methods` proposes hulls, this module holds them to what physics engines ask and to
what a hand or a thing must be able to enter. Volume error is the symmetric difference of hulls and
mesh over the mesh's volume, by exact booleans.
"""

import logging
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sim_export.collision.convex_pieces import Solid
from sim_export.collision.hull_limits import limit_hulls
from sim_export.collision.hull_methods import DecomposeConfig, Method, Part, diagonal_of, hull_candidates
from sim_export.errors import DecompositionFailed
from sim_export.geometry.solids import as_solid, measure_fit, measure_kept_cavity, solid_hull, unite_hulls
from sim_export.package import Hull, Mesh

__all__ = ["DecomposeConfig", "Decomposition", "decompose_part", "decompose_parts"]

logger = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True, eq=False)
class Decomposition:
    """Hulls of one part and how true they are.

    ``kept_cavity`` is the share of the part's cavity that they leave free, 1 where it has none;
    ``records`` says what was changed to meet the limits and what was tried in vain.
    """

    hulls: tuple[Hull, ...]
    method: Method
    volume_error: float
    kept_cavity: float
    seconds: float
    records: tuple[str, ...] = ()


def decompose_part(
    mesh: Mesh, cfg: DecomposeConfig | None = None, cache: Path | None = None
) -> Decomposition:
    """Convex hulls of one part's closed mesh (metres).

    Args:
        mesh: The part's mesh; must enclose a volume.
        cfg: Method, tolerances and limits.
        cache: Folder in which CoACD's results are kept from run to run.

    Raises:
        OpenMesh: if the mesh is not closed.
        DecompositionFailed: if no method works, or all would fill a cavity, unless
            ``cfg.on_failure`` asks for one hull.
    """
    cfg = cfg or DecomposeConfig()
    return _decompose(Part(solid=as_solid(mesh), cfg=cfg), cfg.max_hulls, cache)


def _decompose(part: Part, max_hulls: int, cache: Path | None) -> Decomposition:
    started = time.perf_counter()
    problems: list[str] = []
    result = _first_good(part, max_hulls, cache, problems)
    if result is None:
        if part.cfg.on_failure == "raise":
            raise DecompositionFailed(f"{'; '.join(problems)}; raise max_hulls, or ask for on_failure='hull'")
        result = _comply("hull", (solid_hull(part.solid),), part, max_hulls)
        problems.append("one convex hull taken instead")
    seconds = time.perf_counter() - started
    logger.info(
        "%s: %d hulls, volume error %.3f, %.3f s",
        result.method, len(result.hulls), result.volume_error, seconds,
    )  # fmt: skip
    return replace(result, seconds=seconds, records=(*problems, *result.records))


def _first_good(part: Part, max_hulls: int, cache: Path | None, problems: list[str]) -> Decomposition | None:
    """The first candidate that leaves cavities free; says in ``problems`` why others did not do."""
    try:
        for candidate in hull_candidates(part, max_hulls, cache):
            result = _comply(candidate.method, candidate.hulls, part, max_hulls)
            if result.kept_cavity >= part.cfg.min_kept_cavity:
                return result
            problem = (
                f"{len(result.hulls)} hulls by {candidate.method} leave {result.kept_cavity:.0%} of the "
                f"cavity free, at least {part.cfg.min_kept_cavity:.0%} allowed"
            )
            if problem not in problems:
                problems.append(problem)
    except DecompositionFailed as err:
        problems.append(str(err))
    return None


def _comply(method: Method, hulls: Sequence[Hull], part: Part, max_hulls: int) -> Decomposition:
    """Hulls within the limits of physics engines, measured against the solid."""
    cfg, solid = part.cfg, part.solid
    limited, changes = limit_hulls(hulls, cfg.limits, max_hulls)
    fit = measure_fit(unite_hulls(limited), solid)
    hollow = fit.cavity > cfg.min_cavity and fit.cavity * solid.hull().volume() > cfg.min_cavity_volume
    skin = max(cfg.skin * diagonal_of(solid), cfg.min_skin)
    return Decomposition(
        hulls=limited,
        method=method,
        volume_error=fit.volume_error,
        kept_cavity=measure_kept_cavity(limited, solid, skin) if hollow else 1.0,
        seconds=0.0,
        records=changes,
    )


def decompose_parts(
    meshes: Sequence[Mesh],
    owners: Sequence[int],
    cfg: DecomposeConfig | None = None,
    cache: Path | None = None,
) -> tuple[Decomposition, ...]:
    """Hulls of all parts, so that parts with the same owner (one link) keep to ``max_hulls`` together.

    Each part is first decomposed alone; where a link has too many hulls, the parts with most are
    decomposed again with their share of what is allowed. Hulls keep out of parts with other owners.
    """
    cfg = cfg or DecomposeConfig()
    if cfg.size == 0.0 and meshes:
        corners = np.concatenate([mesh.vertices for mesh in meshes])
        cfg = replace(cfg, size=float(np.linalg.norm(np.ptp(corners, axis=0))))
    solids = [as_solid(mesh) for mesh in meshes]
    parts = [
        Part(
            solid=solid,
            cfg=cfg,
            others=tuple(
                other
                for other, owner in zip(solids, owners, strict=True)
                if owner != owners[index] and _boxes_meet(solid, other)
            ),
        )
        for index, solid in enumerate(solids)
    ]
    out = [_decompose(part, cfg.max_hulls, cache) for part in parts]
    for owner in sorted(set(owners)):
        mine = [index for index, other in enumerate(owners) if other == owner]
        for _ in range(3):  # cutting oblong hulls may give a part more than its share
            counts = {index: len(out[index].hulls) for index in mine}
            total = sum(counts.values())
            if total <= cfg.max_hulls:
                break
            spread = [index for index in mine if counts[index] > 1]
            room = cfg.max_hulls - (len(mine) - len(spread))
            taken = sum(counts[index] for index in spread)
            for index in spread:
                share = max(1, counts[index] * room // taken)
                if share < counts[index]:
                    out[index] = _decompose_again(parts[index], out[index], share, cache)
    return tuple(out)


def _boxes_meet(first: Solid, second: Solid) -> bool:
    a, b = (np.array(solid.bounding_box()).reshape(2, 3) for solid in (first, second))
    return bool((a[0] < b[1]).all() and (b[0] < a[1]).all())


def _decompose_again(part: Part, full: Decomposition, max_hulls: int, cache: Path | None) -> Decomposition:
    """A part with fewer hulls, or the same as before, and a record, where so few would fill a cavity."""
    try:
        return _decompose(part, max_hulls, cache)
    except DecompositionFailed as err:
        kept = f"kept {len(full.hulls)} hulls, more than its share of {max_hulls}: {err}"
        return full if kept in full.records else replace(full, records=(*full.records, kept))
