"""Collision hulls of a part: as few and as true to its mesh as possible, and never across a cavity.

`sim_export.hull_methods` proposes hulls, this module holds them to what physics engines ask and to
what a hand or a thing must be able to enter. Volume error is the symmetric difference of hulls and
mesh over the mesh's volume, by exact booleans.
"""

import logging
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sim_export.convex_pieces import Solid
from sim_export.errors import DecompositionFailed
from sim_export.hull_limits import limit_hulls
from sim_export.hull_methods import DecomposeConfig, Method, diagonal_of, hull_candidates
from sim_export.package import Hull, Mesh
from sim_export.solids import as_solid, measure_fit, measure_kept_cavity, solid_hull

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
    started = time.perf_counter()
    solid = as_solid(mesh)
    problems: list[str] = []
    result = _first_good(solid, cfg, cache, problems)
    if result is None:
        if cfg.on_failure == "raise":
            raise DecompositionFailed(f"{'; '.join(problems)}; raise max_hulls, or ask for on_failure='hull'")
        result = _comply("hull", (solid_hull(solid),), solid, cfg)
        problems.append("one convex hull taken instead")
    seconds = time.perf_counter() - started
    logger.info(
        "%s: %d hulls, volume error %.3f, %.3f s",
        result.method, len(result.hulls), result.volume_error, seconds,
    )  # fmt: skip
    return replace(result, seconds=seconds, records=(*problems, *result.records))


def _first_good(
    solid: Solid, cfg: DecomposeConfig, cache: Path | None, problems: list[str]
) -> Decomposition | None:
    """The first candidate that leaves cavities free; says in ``problems`` why others did not do."""
    try:
        for candidate in hull_candidates(solid, cfg, cache):
            result = _comply(candidate.method, candidate.hulls, solid, cfg)
            if candidate.note and candidate.note not in problems:
                problems.append(candidate.note)
            if result.kept_cavity >= cfg.min_kept_cavity:
                return result
            problem = (
                f"{len(result.hulls)} hulls by {candidate.method} leave {result.kept_cavity:.0%} of the "
                f"cavity free, at least {cfg.min_kept_cavity:.0%} allowed"
            )
            if problem not in problems:
                problems.append(problem)
    except DecompositionFailed as err:
        problems.append(str(err))
    return None


def _comply(method: Method, hulls: Sequence[Hull], solid: Solid, cfg: DecomposeConfig) -> Decomposition:
    """Hulls within the limits of physics engines, measured against the solid."""
    limited, changes = limit_hulls(hulls, cfg.limits, cfg.max_hulls)
    fit = measure_fit(limited, solid)
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
    decomposed again with their share of what is allowed.
    """
    cfg = cfg or DecomposeConfig()
    if cfg.size == 0.0 and meshes:
        corners = np.concatenate([mesh.vertices for mesh in meshes])
        cfg = replace(cfg, size=float(np.linalg.norm(np.ptp(corners, axis=0))))
    out = [decompose_part(mesh, cfg, cache) for mesh in meshes]
    for owner in sorted(set(owners)):
        parts = [index for index, other in enumerate(owners) if other == owner]
        for _ in range(3):  # cutting oblong hulls may give a part more than its share
            counts = {index: len(out[index].hulls) for index in parts}
            total = sum(counts.values())
            if total <= cfg.max_hulls:
                break
            spread = [index for index in parts if counts[index] > 1]
            room = cfg.max_hulls - (len(parts) - len(spread))
            taken = sum(counts[index] for index in spread)
            for index in spread:
                share = max(1, counts[index] * room // taken)
                if share < counts[index]:
                    # Few hulls are poor for certain; CoACD would not change that.
                    fewer = replace(
                        cfg, max_hulls=share, max_pieces=max(1, round(0.8 * share)), coacd_faces=0
                    )
                    out[index] = _decompose_again(meshes[index], out[index], fewer, cache)
    return tuple(out)


def _decompose_again(
    mesh: Mesh, full: Decomposition, cfg: DecomposeConfig, cache: Path | None
) -> Decomposition:
    """A part with fewer hulls, or the same as before, and a record, where so few would fill a cavity."""
    try:
        return decompose_part(mesh, cfg, cache)
    except DecompositionFailed as err:
        kept = f"kept {len(full.hulls)} hulls, more than its share of {cfg.max_hulls}: {err}"
        return full if kept in full.records else replace(full, records=(*full.records, kept))
