"""Collision hulls of a part: as few and as true to its mesh as possible, and never across a cavity.

Methods, from cheap to dear: one ``hull`` where the part is convex; ``boxes`` where it is blocky
(exact in milliseconds); ``pieces`` for anything slanted or round (cut at concave edges, joined by
least added volume); ``coacd`` on request, or where all of these are poor. Volume error is the
symmetric difference of hulls and mesh over the mesh's volume, measured by exact booleans.
"""

import logging
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float
from manifold3d import OpType

from sim_export.coacd_process import CoacdConfig, run_coacd
from sim_export.convex_pieces import PieceConfig, Solid, convex_pieces, join_pieces
from sim_export.cuboids import fit_cuboids
from sim_export.errors import DecompositionFailed, DegeneratePart
from sim_export.hull_limits import HullLimits, limit_hulls
from sim_export.hulls import box_hull
from sim_export.package import Hull, Mesh
from sim_export.solids import Fit, as_solid, measure_fit, measure_kept_cavity, solid_arrays, solid_hull

logger = logging.getLogger(__name__)

Method = Literal["hull", "boxes", "pieces", "coacd"]
BOX_DETAILS = (1e-2, 3e-3, 1e-3, 1e-4)
"""Least share of the surface that a plane must hold to bound boxes; tried from coarse to fine."""
MOST_BOXES = 120
"""Boxes that joining starts from at most."""
SMALLEST_MISSING = 2e-3
"""Pieces below this share of the volume are not worth a hull of their own."""


@dataclass(frozen=True, kw_only=True)
class DecomposeConfig:
    """How a part becomes hulls."""

    method: Literal["auto", "boxes", "pieces", "coacd"] = "auto"
    """One method, or the cheapest that is good enough."""
    max_hulls: int = 32
    """Most hulls per part; physics engines slow down with every one."""
    tolerance: float = 0.08
    """Volume error that `auto` accepts; lower it when hulls stray from the visual mesh."""
    join_above: int = 6
    """More boxes than this are joined to fewer hulls while the volume error stays within tolerance."""
    boxes_tolerance: float = 0.15
    """Volume error up to which `auto` takes boxes, if none are within ``tolerance``, rather than cutting the
    mesh, which takes ten times longer."""
    hull_tolerance: float = 0.08
    """Volume error up to which `auto` takes a single hull."""
    reach: float = 0.02
    """Farthest that the mesh may stick out of boxes, over its diagonal, before what does gets hulls of its
    own: volume alone would not miss small legs."""
    coacd_above: float = 0.6
    """Volume error above which `auto` tries CoACD, which takes seconds to minutes."""
    coacd_faces: int = 3000
    """Most faces, after leaving out detail, of a mesh that `auto` gives to CoACD; more take minutes."""
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
    max_pieces: int = 24
    """Most hulls by `pieces`, fewer than ``max_hulls``, because oblong ones are cut again afterwards."""
    simplify: float = 0.0025
    """Detail left out before cutting, over the mesh's diagonal; raise it when curved meshes take long."""
    on_failure: Literal["raise", "hull"] = "raise"
    """What to do where no method works: raise, or take one convex hull and record it."""
    limits: HullLimits = field(default_factory=HullLimits)
    """What each hull must be like."""
    coacd: CoacdConfig = field(default_factory=lambda: CoacdConfig(timeout=20.0))
    """Parameters of CoACD."""

    def __post_init__(self) -> None:
        for name in ("tolerance", "hull_tolerance", "reach", "coacd_above", "min_kept_cavity", "min_cavity"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ValueError(f"decompose: {name} is {getattr(self, name)}, expected 0 to 1")
        if self.max_hulls < 1:
            raise ValueError(f"decompose: max_hulls is {self.max_hulls}, expected at least 1")


@dataclass(frozen=True, kw_only=True, eq=False)
class Decomposition:
    """Hulls of one part and how true they are; ``records`` says what was changed to meet the limits."""

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
        DecompositionFailed: if no method works, or the hulls would fill a cavity, unless
            ``cfg.on_failure`` asks for one hull.
    """
    cfg = cfg or DecomposeConfig()
    started = time.perf_counter()
    solid = as_solid(mesh)
    records: tuple[str, ...] = ()
    try:
        method, hulls, fit = _choose(mesh, solid, cfg, cache)
    except DecompositionFailed as err:
        if cfg.on_failure == "raise":
            raise
        hulls = (solid_hull(solid),)
        method, fit, records = "hull", measure_fit(hulls, solid), (f"one convex hull instead: {err}",)
    limited, changes = limit_hulls(hulls, cfg.limits, cfg.max_hulls)
    if changes:
        fit = measure_fit(limited, solid)
    kept = _measure_cavity(limited, solid, fit, cfg)
    if kept < cfg.min_kept_cavity and cfg.on_failure == "raise":
        raise DecompositionFailed(
            f"{len(limited)} hulls by {method} leave {kept:.0%} of the cavity free, at least "
            f"{cfg.min_kept_cavity:.0%} allowed; raise max_hulls or lower the tolerance"
        )
    seconds = time.perf_counter() - started
    logger.info("%s: %d hulls, volume error %.3f, %.3f s", method, len(limited), fit.volume_error, seconds)
    return Decomposition(
        hulls=limited,
        method=method,
        volume_error=fit.volume_error,
        kept_cavity=kept,
        seconds=seconds,
        records=records + changes,
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
                    fewer = replace(cfg, max_hulls=share, max_pieces=max(1, round(0.8 * share)))
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


Choice = tuple[Method, tuple[Hull, ...], Fit]


def _measure_cavity(hulls: Sequence[Hull], solid: Solid, fit: Fit, cfg: DecomposeConfig) -> float:
    """Share of the part's cavity that stays free; 1 where it has none worth the name."""
    if fit.cavity <= cfg.min_cavity or fit.cavity * solid.hull().volume() <= cfg.min_cavity_volume:
        return 1.0
    return measure_kept_cavity(hulls, solid, max(cfg.skin * _diagonal(solid), cfg.min_skin))


def _diagonal(solid: Solid) -> float:
    low, high = np.array(solid.bounding_box()).reshape(2, 3)
    return float(np.linalg.norm(high - low))


def _choose(mesh: Mesh, solid: Solid, cfg: DecomposeConfig, cache: Path | None) -> Choice:
    """Hulls by the method asked for, or by the cheapest that is within tolerance."""
    if cfg.method == "pieces":
        return _pieces(solid, cfg)
    if cfg.method == "coacd":
        return _coacd(solid, cfg, cache)
    if cfg.method == "auto" and solid.hull().volume() <= (1.0 + cfg.hull_tolerance) * solid.volume():
        return _measured("hull", (solid_hull(solid),), solid)
    boxes = _boxes(solid, cfg)
    if cfg.method == "boxes":
        if boxes is None:
            raise DecompositionFailed(
                f"a mesh of {len(mesh.faces)} faces is no union of {cfg.max_hulls} boxes or fewer; use 'auto'"
            )
        return boxes
    if boxes is not None and boxes[2].volume_error <= cfg.boxes_tolerance:
        return boxes
    found = [_pieces(solid, cfg)] + ([boxes] if boxes is not None else [])
    poor = min(choice[2].volume_error for choice in found) > cfg.coacd_above
    if poor and _simplified(solid, cfg).num_tri() <= cfg.coacd_faces:
        try:
            found.append(_coacd(solid, cfg, cache))
        except DecompositionFailed as err:
            logger.warning("CoACD was tried, because volume error is high, and failed: %s", err)
    return min(found, key=_score)


def _boxes(solid: Solid, cfg: DecomposeConfig) -> Choice | None:
    """The coarsest boxes within tolerance, else the best there are; what they miss gets hulls of its own."""
    vertices, faces = solid_arrays(solid)
    best = None
    for detail in BOX_DETAILS:
        boxes = fit_cuboids(vertices, faces, MOST_BOXES, detail)
        if boxes is None or not len(boxes):
            continue
        hulls = [box_hull(low, high) for low, high in boxes]
        if _farthest_outside(boxes, vertices) > cfg.reach * _diagonal(solid):
            hulls += _missing_hulls(solid, boxes, cfg)
        choice = _measured("boxes", tuple(hulls), solid)
        if best is None or _score(choice) < _score(best):
            best = choice
        if best[2].volume_error <= cfg.tolerance:
            break
    return best if best is None or len(best[1]) <= cfg.join_above else _joined(best, solid, cfg)


def _score(choice: Choice) -> float:
    """Volume error, and a little for every hull: hulls are what simulation time goes into."""
    return choice[2].volume_error + 0.004 * len(choice[1])


def _missing_hulls(solid: Solid, boxes: Float[np.ndarray, "K 2 3"], cfg: DecomposeConfig) -> list[Hull]:
    """Hulls of those pieces of the solid that stick far out of the boxes: feet, knobs, rims."""
    covered = Solid.batch_boolean(
        [Solid.cube(tuple(high - low)).translate(tuple(low)) for low, high in boxes], OpType.Add
    )
    hulls = []
    for piece in (solid - covered).decompose():
        far = _farthest_outside(boxes, solid_arrays(piece)[0]) > cfg.reach * _diagonal(solid)
        if far and piece.volume() > SMALLEST_MISSING * solid.volume():
            small = PieceConfig(max_hulls=4, max_pieces=8)
            hulls += [solid_hull(part) for part in convex_pieces(piece, small)]
    return hulls


def _joined(boxes: Choice, solid: Solid, cfg: DecomposeConfig) -> Choice:
    """Fewer hulls from many boxes, with what the tolerance leaves, and in any case few enough."""
    left = max(cfg.tolerance - boxes[2].volume_error, 0.02)
    most = min(cfg.max_hulls, cfg.max_pieces)
    pieces = PieceConfig(max_hulls=most, join_excess=0.8 * left)
    joined = join_pieces([as_solid(hull) for hull in boxes[1]], solid.volume(), pieces)
    choice = _measured("boxes", tuple(solid_hull(piece) for piece in joined), solid)
    good = choice[2].volume_error <= boxes[2].volume_error + left or len(boxes[1]) > most
    return choice if good else boxes


def _pieces(solid: Solid, cfg: DecomposeConfig) -> Choice:
    simple = _simplified(solid, cfg)
    pieces = PieceConfig(
        max_hulls=min(cfg.max_hulls, cfg.max_pieces),
        cut_excess=0.5 * cfg.tolerance,
        join_excess=0.8 * cfg.tolerance,
    )
    hulls = []
    for piece in convex_pieces(simple, pieces):
        try:
            hulls.append(solid_hull(piece))
        except DegeneratePart:
            logger.debug("a piece of %.3g m^3 is flat: left out", piece.volume())
    return _measured("pieces", tuple(hulls), solid)


def _simplified(solid: Solid, cfg: DecomposeConfig) -> Solid:
    """The solid without detail, unless that costs more than a hundredth of its volume."""
    simple = solid.simplify(cfg.simplify * _diagonal(solid))
    return simple if abs(simple.volume() / solid.volume() - 1.0) < 0.01 else solid


def _coacd(solid: Solid, cfg: DecomposeConfig, cache: Path | None) -> Choice:
    vertices, faces = solid_arrays(_simplified(solid, cfg))
    return _measured("coacd", run_coacd(Mesh(vertices=vertices, faces=faces), cfg.coacd, cache), solid)


def _measured(method: Method, hulls: tuple[Hull, ...], solid: Solid) -> Choice:
    return method, hulls, measure_fit(hulls, solid)


def _farthest_outside(boxes: Float[np.ndarray, "K 2 3"], points: Float[np.ndarray, "N 3"]) -> float:
    """Greatest distance (m) of a point from the boxes."""
    outside = np.maximum(boxes[:, 0] - points[:, None], points[:, None] - boxes[:, 1])
    return float(np.linalg.norm(np.maximum(outside, 0.0), axis=-1).min(axis=1).max())
