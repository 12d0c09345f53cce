"""Ways to turn a part's solid into convex hulls, and the order in which `auto` tries them.

From cheap to dear: one ``hull`` where the part is convex; ``boxes`` where it is blocky; ``pieces``
for anything slanted or round (cut at concave edges, joined by least added volume); ``coacd`` where
all of these are poor.
"""

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float
from manifold3d import OpType

from sim_export.coacd_process import CoacdConfig, run_coacd
from sim_export.convex_pieces import PieceConfig, Solid, convex_pieces, join_pieces
from sim_export.cuboids import fit_cuboids, largest_cuboids
from sim_export.errors import DecompositionFailed, DegeneratePart
from sim_export.hull_limits import HullLimits
from sim_export.hulls import box_hull
from sim_export.package import Hull, Mesh
from sim_export.solids import (
    as_solid,
    inside_grid,
    measure_bulge,
    measure_fit,
    measure_stray,
    solid_arrays,
    solid_hull,
)

logger = logging.getLogger(__name__)

Method = Literal["hull", "boxes", "pieces", "coacd"]
BOX_DETAILS = (1e-2, 3e-3, 1e-3, 1e-4)
"""Least share of the surface that a plane must hold to bound boxes; tried from coarse to fine."""
EXACT = 0.01
"""Volume error below which finer boxes are not looked for."""
INNER_CELLS = 72
"""Cells along the longest edge where boxes are sought that fill no cavity."""
MOST_BOXES = 256
"""Boxes that joining starts from at most."""
MISSED = 0.012
"""A point farther than this from the other surface, over the object's diagonal, is missed."""
FARTHEST = 0.022
"""No point should be farther away than this."""
SMALLEST_MISSING = 2e-3
"""Pieces below this share of the volume are not worth a hull of their own."""
LARGE_MISSING = 0.02
"""Pieces above this share of the volume always are."""


@dataclass(frozen=True, kw_only=True)
class DecomposeConfig:
    """How a part becomes hulls."""

    method: Literal["auto", "boxes", "pieces", "coacd"] = "auto"
    """One method, or the cheapest that is good enough."""
    max_hulls: int = 27
    """Most hulls per part, and per link; a few less than checked, for what clearance may have to
    split; physics engines slow down with every one."""
    tolerance: float = 0.08
    """Volume error that `auto` accepts; lower it when hulls stray from the visual mesh."""
    join_above: int = 8
    """More boxes than this are joined to fewer hulls while the volume error stays within tolerance."""
    boxes_tolerance: float = 0.3
    """Volume error up to which `auto` takes boxes, if none are within ``tolerance``, rather than cutting the
    mesh, which takes ten times longer."""
    hull_tolerance: float = 0.1
    """Volume error up to which `auto` takes a single hull."""
    reach: float = 0.02
    """Farthest that the mesh may stick out of boxes, over its diagonal, before what does gets hulls of its
    own: volume alone would not miss small legs."""
    coacd_above: float = 0.6
    """Volume error above which `auto` tries CoACD, which takes seconds to minutes."""
    coacd_faces: int = 0
    """Most faces, after leaving out detail, of a mesh that `auto` gives to CoACD; none by default, because
    it takes seconds to minutes and its hulls fill more of thin-walled parts than pieces and boxes do."""
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
    size: float = 0.0
    """Diagonal (m) of the whole object, by which distances are judged; 0 takes the part's own."""
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


def diagonal_of(solid: Solid) -> float:
    """Diagonal of a solid's bounding box (m)."""
    low, high = np.array(solid.bounding_box()).reshape(2, 3)
    return float(np.linalg.norm(high - low))


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidate:
    """Hulls by one method, how untrue they are, and what was tried in vain.

    ``error`` is the volume error against the simplified solid, and what surface they miss: a tenth of
    a percent of it missed weighs as much as a percent of the volume.
    """

    method: Method
    hulls: tuple[Hull, ...]
    error: float
    note: str = ""

    @property
    def score(self) -> float:
        """Volume error, and a little for every hull: hulls are what simulation time goes into."""
        return self.error + 0.002 * len(self.hulls)


def hull_candidates(solid: Solid, cfg: DecomposeConfig, cache: Path | None) -> Iterator[Candidate]:
    """Hulls by the method asked for, or by several, best first; the next only costs time if asked for."""
    simple = _simplified(solid, cfg)
    if cfg.method == "pieces":
        yield _pieces(simple, cfg)
    elif cfg.method == "coacd":
        yield _coacd(simple, cfg, cache)
    elif cfg.method == "boxes":
        boxes = _boxes(simple, cfg)
        if boxes is None:
            raise DecompositionFailed(
                f"a mesh of {simple.num_tri()} faces is no union of {MOST_BOXES} boxes or fewer; use 'auto'"
            )
        yield boxes
    else:
        yield from _auto(simple, cfg, cache)


def _auto(solid: Solid, cfg: DecomposeConfig, cache: Path | None) -> Iterator[Candidate]:
    whole = _measured("hull", [solid_hull(solid)], solid, cfg)
    if whole.error <= cfg.hull_tolerance:
        yield whole
    boxes = _boxes(solid, cfg)
    early = boxes is not None and boxes.error <= cfg.boxes_tolerance
    if boxes is not None and early:
        yield boxes
    found = [_pieces(solid, cfg), whole] + ([boxes] if boxes is not None and not early else [])
    found.sort(key=lambda candidate: candidate.score)
    if found[0].error <= cfg.coacd_above or solid.num_tri() > cfg.coacd_faces:
        yield from found
    if solid.num_tri() > cfg.coacd_faces:
        yield _inner_boxes(solid, cfg, "")
        return
    note = ""
    try:  # what has been found so far is poor, or fills a cavity
        found.append(_coacd(solid, cfg, cache))
    except DecompositionFailed as err:
        note = f"CoACD was tried in vain: {err}"
    for candidate in sorted(found, key=lambda candidate: candidate.score):
        yield replace(candidate, note=note)
    yield _inner_boxes(solid, cfg, note)


def _inner_boxes(solid: Solid, cfg: DecomposeConfig, note: str) -> Candidate:
    """The largest boxes of a fine grid: they miss detail, but fill nothing that is free."""
    vertices, faces = solid_arrays(solid)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    cell = float((high - low).max()) / INNER_CELLS
    counts = np.maximum(np.rint((high - low) / cell).astype(int), 1)
    edges = [np.linspace(low[axis], high[axis], counts[axis] + 1) for axis in range(3)]
    x, y, z = ((edge[:-1] + edge[1:]) / 2 for edge in edges)
    boxes = largest_cuboids(inside_grid(vertices, faces, (x, y, z)), max(1, cfg.max_hulls // 2))
    hulls = [
        box_hull(*(np.array([edges[axis][box[end, axis]] for axis in range(3)]) for end in range(2)))
        for box in boxes
    ]
    if not hulls:
        raise DecompositionFailed(f"no cell of a grid of {INNER_CELLS} along the longest edge lies inside")
    said = f"the {len(hulls)} largest boxes inside of it are taken, detail is left out"
    return replace(_measured("boxes", hulls, solid, cfg), note=f"{note}; {said}" if note else said)


def _boxes(solid: Solid, cfg: DecomposeConfig) -> Candidate | None:
    """Boxes from coarse to fine until within tolerance and one step on; the best of them, joined."""
    vertices, faces = solid_arrays(solid)
    best = None
    for detail in BOX_DETAILS:
        enough = best is not None and best.error <= cfg.tolerance
        boxes = fit_cuboids(vertices, faces, MOST_BOXES, detail)
        if boxes is not None and len(boxes):
            hulls = [box_hull(low, high) for low, high in boxes]
            found = _measured("boxes", hulls, solid, cfg)
            missing = [] if found.error <= EXACT / 5 else _missing_hulls(solid, boxes, cfg)
            if missing:
                found = _measured("boxes", hulls + missing, solid, cfg)
            if best is None or found.score < best.score:
                best = found
        if enough or (best is not None and best.error <= EXACT):
            break
    if best is None or len(best.hulls) <= min(cfg.join_above, cfg.max_hulls):
        return best
    return _joined(best, solid, cfg)


def _missing_hulls(solid: Solid, boxes: Float[np.ndarray, "K 2 3"], cfg: DecomposeConfig) -> list[Hull]:
    """Hulls of what boxes miss: pieces that stick far out of them, like feet, and whole boards.

    Pieces that their hulls would more than double are left to finer boxes.
    """
    covered = Solid.batch_boolean(
        [Solid.cube(tuple(high - low)).translate(tuple(low)) for low, high in boxes], OpType.Add
    )
    hulls = []
    for piece in (solid - covered).decompose():
        if piece.volume() < SMALLEST_MISSING * solid.volume():
            continue
        far = _farthest_outside(boxes, solid_arrays(piece)[0]) > cfg.reach * diagonal_of(solid)
        if far or piece.volume() > LARGE_MISSING * solid.volume():
            small = PieceConfig(max_hulls=4, max_pieces=8, cut_excess=0.2, join_excess=0.3)
            parts = convex_pieces(piece, small)
            if sum(part.volume() for part in parts) <= 2.0 * piece.volume():
                hulls += [solid_hull(part) for part in parts]
    return hulls


def _joined(boxes: Candidate, solid: Solid, cfg: DecomposeConfig) -> Candidate:
    """Fewer hulls from many boxes, with what the tolerance leaves, and in any case few enough."""
    left = max(cfg.tolerance - boxes.error, 0.02)
    most = min(cfg.max_hulls, cfg.max_pieces)
    pieces = PieceConfig(max_hulls=most, join_excess=0.8 * left)
    joined = join_pieces([as_solid(hull) for hull in boxes.hulls], solid.volume(), pieces)
    choice = _measured("boxes", [solid_hull(piece) for piece in joined], solid, cfg)
    good = choice.error <= boxes.error + left or len(boxes.hulls) > most
    return choice if good else boxes


def _pieces(solid: Solid, cfg: DecomposeConfig) -> Candidate:
    pieces = PieceConfig(
        max_hulls=min(cfg.max_hulls, cfg.max_pieces),
        cut_excess=0.5 * cfg.tolerance,
        join_excess=0.8 * cfg.tolerance,
    )
    hulls = []
    for piece in convex_pieces(solid, pieces):
        try:
            hulls.append(solid_hull(piece))
        except DegeneratePart:
            logger.debug("a piece of %.3g m^3 is flat: left out", piece.volume())
    return _measured("pieces", hulls, solid, cfg)


def _simplified(solid: Solid, cfg: DecomposeConfig) -> Solid:
    """The solid without detail, unless that costs more than a hundredth of its volume."""
    simple = solid.simplify(cfg.simplify * diagonal_of(solid))
    return simple if abs(simple.volume() / solid.volume() - 1.0) < 0.01 else solid


def _coacd(solid: Solid, cfg: DecomposeConfig, cache: Path | None) -> Candidate:
    vertices, faces = solid_arrays(solid)
    return _measured("coacd", run_coacd(Mesh(vertices=vertices, faces=faces), cfg.coacd, cache), solid, cfg)


def _measured(method: Method, hulls: Sequence[Hull], solid: Solid, cfg: DecomposeConfig) -> Candidate:
    size = cfg.size or diagonal_of(solid)
    error = measure_fit(hulls, solid).volume_error
    for distances in (measure_stray(hulls, solid), measure_bulge(hulls, solid)):
        missed = float((distances > MISSED * size).mean())
        too_far = max(0.0, float(distances.max(initial=0.0)) / size - FARTHEST)
        error += 10.0 * missed + 20.0 * too_far
    return Candidate(method=method, hulls=tuple(hulls), error=error)


def _farthest_outside(boxes: Float[np.ndarray, "K 2 3"], points: Float[np.ndarray, "N 3"]) -> float:
    """Greatest distance (m) of a point from the boxes."""
    outside = np.maximum(boxes[:, 0] - points[:, None], points[:, None] - boxes[:, 1])
    return float(np.linalg.norm(np.maximum(outside, 0.0), axis=-1).min(axis=1).max())
