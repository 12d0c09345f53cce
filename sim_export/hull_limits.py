"""What physics engines ask of every hull, and how hulls are changed to comply."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim_export.hulls import (
    clip_hull,
    convex_hull,
    hull_length,
    hull_volume,
    hull_width,
    reduce_hull,
)
from sim_export.package import Hull


@dataclass(frozen=True, kw_only=True)
class HullLimits:
    """Limits of PhysX's GPU solver, with a little room, and a least thickness."""

    max_vertices: int = 64
    """Most vertices of a hull."""
    max_polygons: int = 64
    """Most faces of a hull, coplanar triangles counted once."""
    min_width: float = 0.001
    """Least thickness (m); thinner hulls are thickened to it."""
    max_aspect: float = 60.0
    """Greatest length over thickness; longer hulls are cut in two or, where there are too many already,
    thickened. PhysX handles oblong hulls badly from 64 on."""


def limit_hulls(
    hulls: Sequence[Hull], limits: HullLimits, max_hulls: int
) -> tuple[tuple[Hull, ...], tuple[str, ...]]:
    """Hulls within the limits, and one sentence for each kind of change."""
    reduced = [reduce_hull(hull, limits.max_vertices, limits.max_polygons) for hull in hulls]
    fewer = sum(new is not old for new, old in zip(reduced, hulls, strict=True))
    thick = [_thicken(hull, limits.min_width) for hull in reduced]
    thickened = sum(new is not old for new, old in zip(thick, reduced, strict=True))
    out, cuts, widened = _limit_aspect(thick, limits, max_hulls)
    records = (
        (fewer, f"{fewer} hulls reduced to {limits.max_vertices} vertices and {limits.max_polygons} faces"),
        (thickened, f"{thickened} hulls thickened to {1000 * limits.min_width:g} mm"),
        (cuts, f"oblong hulls cut {cuts} times to a length below {limits.max_aspect:g} thicknesses"),
        (widened, f"{widened} oblong hulls thickened, because cutting them would exceed {max_hulls} hulls"),
    )
    return tuple(out), tuple(sentence for count, sentence in records if count)


def hull_aspect(hull: Hull) -> float:
    """Greatest length over least thickness."""
    return hull_length(hull)[0] / hull_width(hull)[0]


def _thicken(hull: Hull, width: float) -> Hull:
    """Stretches a hull along its thinnest direction to ``width``, about its middle."""
    measured, normal = hull_width(hull)
    if measured >= width * (1.0 - 1e-9):
        return hull
    heights = hull.vertices @ normal
    middle = (heights.min() + heights.max()) / 2
    return convex_hull(hull.vertices + np.outer((heights - middle) * (width / measured - 1.0), normal))


def _limit_aspect(hulls: Sequence[Hull], limits: HullLimits, max_hulls: int) -> tuple[list[Hull], int, int]:
    """Cuts oblong hulls while the number of hulls allows it, those first that need few cuts."""
    pieces = [_cut_to_aspect(hull, limits.max_aspect) for hull in hulls]
    room = max(max_hulls - len(hulls), 0)
    cuts, widened = 0, 0
    for index in sorted(range(len(hulls)), key=lambda index: len(pieces[index])):
        extra = len(pieces[index]) - 1
        if extra == 0:
            continue
        if cuts + extra <= room:
            cuts += extra
        else:
            width = hull_length(hulls[index])[0] / limits.max_aspect
            pieces[index] = [_thicken(hulls[index], width)]
            widened += 1
    return [piece for group in pieces for piece in group], cuts, widened


def _cut_to_aspect(hull: Hull, max_aspect: float) -> list[Hull]:
    """Halves a hull across its length until every piece is compact enough."""
    length, direction = hull_length(hull)
    width, _ = hull_width(hull)
    count = int(np.ceil(length / width / max_aspect))
    if count <= 1:
        return [hull]
    heights = hull.vertices @ direction
    steps = np.linspace(heights.min(), heights.max(), count + 1)
    out: list[Hull] = []
    for low, high in pairwise(steps):
        piece = clip_hull(hull, direction, high)
        piece = None if piece is None else clip_hull(piece, -direction, -low)
        if piece is not None and hull_volume(piece) > 1e-6 * hull_volume(hull):
            out += _cut_to_aspect(piece, max_aspect)
    return out
