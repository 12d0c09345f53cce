"""Makes long thin hulls acceptable to engines: replaced by a box, thickened or halved."""

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull
from scipy.spatial.distance import pdist

from sim_export.collision.hull_limits import MAX_ASPECT, MIN_WIDTH, comply_hull, hull_aspect, thicken_hull
from sim_export.collision.hulls import (
    clip_hull,
    convex_hull,
    hull_length,
    hull_planes,
    hull_volume,
    hull_width,
)
from sim_export.package import Hull

ALIKE = 1.12
"""A box stands for a hull of up to this many times less volume."""
HALVINGS = 7
"""Times that a hull is divided, and its halves again."""
_SPARE = 0.97
"""Share of the longest allowed length that hulls are made for."""


def compact_hull(
    hull: Hull,
    thickest: float,
    alike: float = ALIKE,
    halvings: int = HALVINGS,
    reach: float = np.inf,
) -> list[Hull]:
    """A hull, or what stands for it within the limits: its box, a thicker hull, or halves of these.

    Args:
        hull: Any hull.
        thickest: Thickness (m) up to which a hull is thickened rather than divided.
        alike: Volume of its box over that of a hull up to which the box is taken.
        halvings: Times that it may be divided; what is left oblong then is left out.
        reach: How far (m) its box may stand out of it.
    """
    proper = comply_hull(hull, grow=False)
    if hull_aspect(proper) <= MAX_ASPECT:
        return [proper]
    box = around_box(hull)
    planes = hull_planes(hull)
    beyond = float((box.vertices @ planes[:, :3].T - planes[:, 3]).max())
    if hull_volume(box) <= alike * hull_volume(hull) and beyond <= reach:
        return [box]
    if not halvings:  # the tip of a wedge is thinner the shorter it is
        return []
    length, along = hull_length(hull)
    # Its longest diagonal, because thickening turns the directions along which its length is measured.
    needed = max(length, float(pdist(hull.vertices).max())) / (_SPARE * MAX_ASPECT)
    if needed <= max(thickest, hull_width(hull)[0]):
        thick = comply_hull(thicken_hull(hull, needed), grow=False)
        if hull_aspect(thick) <= MAX_ASPECT:
            return [thick]
    heights = hull.vertices @ along
    middle = float(heights.min() + heights.max()) / 2
    halves = (clip_hull(hull, along, middle), clip_hull(hull, -along, -middle))
    return [
        part
        for half in halves
        if half is not None and hull_width(half)[0] >= 0.5 * MIN_WIDTH
        for part in compact_hull(half, thickest, alike, halvings - 1, reach)
    ]


def around_box(hull: Hull) -> Hull:
    """The smallest box around a hull with a face on its flattest side."""
    normal = hull_width(hull)[1]
    helper = np.eye(3)[int(np.abs(normal).argmin())]
    u = np.cross(normal, helper)
    u /= np.linalg.norm(u)
    axes = np.stack([u, np.cross(normal, u)])
    flat = hull.vertices @ axes.T
    outline = flat[ConvexHull(flat).vertices]
    edges = np.roll(outline, -1, axis=0) - outline
    edges = edges[edges.any(axis=1)]  # two corners may lie in one place
    edges /= np.linalg.norm(edges, axis=1, keepdims=True)
    sides = np.stack([edges, np.column_stack([-edges[:, 1], edges[:, 0]])], axis=1)  # E 2 2
    spread = np.ptp(np.einsum("esi,ni->ens", sides, outline), axis=1)
    rows = sides[int(spread.prod(axis=1).argmin())] @ axes
    return box_along(hull.vertices, np.concatenate([rows, [normal]]))


def box_along(points: Float[np.ndarray, "N 3"], axes: Float[np.ndarray, "3 3"]) -> Hull:
    """The box around points whose edges run along the rows of ``axes``."""
    heights = points @ axes.T
    corners = np.stack(np.meshgrid(*zip(heights.min(axis=0), heights.max(axis=0), strict=True)), axis=-1)
    return convex_hull(corners.reshape(-1, 3) @ axes)
