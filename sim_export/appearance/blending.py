"""Blends Gaussians into texels, each viewed along its surface normal.

Every place is a pixel of an orthographic view along the dominant axis of its normal. Nearby Gaussians are
projected, filtered as in the rasteriser, and blended front to back. Textures therefore interpolate between
samples as renderings do, material edges are antialiased, and the outer of two sheets is visible.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

from artigen.splats.colors import srgb_from_linear
from artigen.transforms import matrix_from_quat
from artigen.types import Gaussians

MAX_ALPHA = 0.99
"""Largest alpha of one Gaussian, as in the rasteriser."""
EDGE = 0.05
"""Smallest alpha at which a Gaussian counts for the height of the top sheet."""
PRESENT = 0.1
"""Summed unnormalised density below which the mean opacity at a place is undefined."""
CLOSED = 0.3
"""Summed alpha from which a sheet counts as closed. Samples drawn at random leave gaps, in which the sheet
below must not show: behind the front of a panel lies the back of its other side, often of another colour."""
CELLS = 64
"""Largest number of cells along each axis for discarding Gaussians far from all places."""

NEIGHBOURS = 16
"""Nearest Gaussians considered per place; fewer miss hidden or wide ones, more take time."""
NEAR = 0.8
"""Distance (voxels) from the surface within which Gaussians count fully."""
FAR = 1.6
"""Distance (voxels) beyond which they do not count; the weight falls linearly in between."""
FILTER_VARIANCE = 0.1
"""Variance (square texels) added to every footprint; opacity is reduced so that the integral is
unchanged."""
FLATTENING = 0.5
"""Scale of the distance along the viewing axis in the search for nearest Gaussians."""
RIM = 0.35
"""Smallest radius (voxels) of Gaussians at places that none covers: at the rim of a mesh that extends
beyond its Gaussians."""
LEAST_COVER = 0.2
"""Smallest share of a place that Gaussians must hide for it to count as covered."""
SOLID = 0.5
"""Mean opacity of the Gaussians at a place below which it is transparent; those of boards have 0.8."""
SHEET = 0.04
"""Height difference (voxels) beyond which Gaussians with normals belong to different sheets; the highest
sheet is visible."""
LEAST_FACING = 0.2
"""Smallest cosine between a Gaussian's normal and the viewing axis, if normals are known."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Places:
    """Surface points with unit normals, in the unit of the Gaussians."""

    points: Float[np.ndarray, "T 3"]
    normals: Float[np.ndarray, "T 3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Blended:
    """Colours (sRGB in [0, 1]) at places, the share of each place that Gaussians hide, and their mean opacity
    (0 if there are none)."""

    colors: Float[np.ndarray, "T 3"]
    cover: Float[np.ndarray, "T"]
    opacity: Float[np.ndarray, "T"]

    def find_panes(self) -> Bool[np.ndarray, "T"]:
        """Places whose Gaussians have a mean opacity below `SOLID`."""
        return (self.opacity > 0) & (self.opacity < SOLID)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Sheet:
    """Gaussians and places of one viewing axis."""

    places: Places
    means: Float[np.ndarray, "N 3"]
    turns: Float[np.ndarray, "N 3 3"]
    scales: Float[np.ndarray, "N 3"]
    colors: Float[np.ndarray, "N 3"]
    opacities: Float[np.ndarray, "N"]
    normals: Float[np.ndarray, "N 3"] | None
    axis: int
    variance: float
    """Variance that the filter adds to every footprint."""


def blend_places(
    places: Places,
    gaussians: Gaussians,
    *,
    voxel: float,
    texel: float,
    normals: Float[np.ndarray, "N 3"] | None = None,
) -> Blended:
    """Colours at surface points; blending happens in sRGB, as when rendering splats.

    Args:
        voxel: Edge of a voxel; scales the largest distance between surface and Gaussians.
        texel: Distance between places; the width of the filter.
        normals: Outward directions of one-sided Gaussians. A place sees only those that face its way, so that
            sheets of two colours may coincide.
    """
    colors, (cover, opacity) = np.zeros((len(places.points), 3)), np.zeros((2, len(places.points)))
    axis = np.abs(places.normals).argmax(axis=1)
    side = np.take_along_axis(places.normals, axis[:, None], axis=1)[:, 0] >= 0
    for number in range(3):
        ahead = np.full(len(gaussians.means), np.nan) if normals is None else normals[:, number]
        stretch = np.where(np.arange(3) == number, FLATTENING, 1.0)
        for rows, seen in _pair_sides(axis == number, side, ahead):
            points = places.points[rows]
            near = find_near(gaussians.means[seen] * stretch, points * stretch, FAR * voxel)
            seen = seen[near]
            if not len(seen):
                continue
            sheet = _Sheet(
                places=Places(points=points, normals=places.normals[rows]),
                means=gaussians.means[seen].astype(np.float64),
                turns=matrix_from_quat(gaussians.quats[seen]),
                scales=gaussians.scales[seen].astype(np.float64),
                colors=srgb_from_linear(gaussians.colors[seen]),
                opacities=gaussians.opacities[seen].astype(np.float64),
                normals=None if normals is None else normals[seen],
                axis=number,
                variance=FILTER_VARIANCE * texel**2,
            )
            found = _blend_sheet(sheet, voxel)
            colors[rows], cover[rows], opacity[rows] = found.colors, found.cover, found.opacity
    return Blended(colors=colors, cover=cover, opacity=opacity)


def find_near(
    points: Float[np.ndarray, "N 3"], places: Float[np.ndarray, "T 3"], reach: float
) -> Bool[np.ndarray, "N"]:
    """Points that may lie within ``reach`` of a place: a superset with few others.

    These are the points in the cells of places and in adjacent cells. A cell is no smaller than ``reach``,
    and there are at most ``CELLS`` along each axis.
    """
    if not len(places):
        return np.zeros(len(points), dtype=bool)
    low = places.min(axis=0)
    extent = np.ptp(places, axis=0)
    edge = np.maximum(1.001 * reach, extent / CELLS)
    shape = (extent / edge).astype(np.int64) + 3  # one more on either side
    taken = np.zeros(shape, dtype=bool)
    taken[tuple(((places - low) / edge).astype(np.int64).T + 1)] = True
    for number in range(3):
        along = np.moveaxis(taken, number, 0)
        alone = along.copy()
        along[1:] |= alone[:-1]
        along[:-1] |= alone[1:]
    cells = np.floor((points - low) / edge).astype(np.int64) + 1
    inside = ((cells >= 0) & (cells < shape)).all(axis=1)
    out = np.zeros(len(points), dtype=bool)
    out[inside] = taken[tuple(cells[inside].T)]
    return out


def _pair_sides(
    facing: Bool[np.ndarray, "T"], side: Bool[np.ndarray, "T"], ahead: Float[np.ndarray, "N"]
) -> Iterator[tuple[Int[np.ndarray, "M"], Int[np.ndarray, "K"]]]:
    """Places that face along an axis, paired with the Gaussians on their side, or with all if these have no
    normals."""
    if np.isnan(ahead).all():
        yield np.flatnonzero(facing), np.arange(len(ahead))
        return
    for way in (False, True):
        yield (
            np.flatnonzero(facing & (side == way)),
            np.flatnonzero((ahead if way else -ahead) > LEAST_FACING),
        )


def _project(sheet: _Sheet, rows: Int[np.ndarray, "M"], least: float = 0.0) -> Float[np.ndarray, "M 4"]:
    """Footprints of some Gaussians of a sheet, with radii of at least ``least``.

    Conics ``a, b, c`` of their projections along its axis, and opacities, both after the filter.
    """
    first, second = (k for k in range(3) if k != sheet.axis)
    squares = np.maximum(sheet.scales[rows], least) ** 2
    one, other = sheet.turns[rows, first], sheet.turns[rows, second]
    xx = np.einsum("nk,nk,nk->n", one, one, squares)
    yy = np.einsum("nk,nk,nk->n", other, other, squares)
    xy = np.einsum("nk,nk,nk->n", one, other, squares)
    area = np.maximum(xx * yy - xy**2, 0.0)
    xx, yy = xx + sheet.variance, yy + sheet.variance
    filtered = np.maximum(xx * yy - xy**2, 1e-30)
    strength = sheet.opacities[rows] * np.sqrt(area / filtered)
    return np.stack([yy / filtered, -xy / filtered, xx / filtered, strength], axis=1)


def _blend_sheet(sheet: _Sheet, voxel: float) -> Blended:
    stretch = np.where(np.arange(3) == sheet.axis, FLATTENING, 1.0)
    tree = KDTree(sheet.means * stretch, leafsize=16, balanced_tree=False, compact_nodes=False)
    footprints = _project(sheet, np.arange(len(sheet.means)))
    wide = np.zeros_like(footprints)
    colors, (cover, opacity) = np.zeros_like(sheet.places.points), np.zeros((2, len(sheet.places.points)))
    reach, count = FAR * voxel, min(NEIGHBOURS, len(sheet.means))
    for rows in _chunks(len(cover), count):
        nearest = tree.query(sheet.places.points[rows] * stretch, k=count, distance_upper_bound=reach)[1]
        index = np.reshape(np.asarray(nearest), (len(rows), count))
        found = _blend_rows(sheet, rows, index, footprints, voxel)
        colors[rows], cover[rows], opacity[rows] = found.colors, found.cover, found.opacity
        bare = (found.cover < LEAST_COVER) & ~found.find_panes()
        if bare.any():
            used = np.unique(index[bare])
            used = used[used < len(wide)]
            wide[used] = _project(sheet, used, RIM * voxel)
            again = _blend_rows(sheet, rows[bare], index[bare], wide, voxel)
            colors[rows[bare]], cover[rows[bare]] = again.colors, again.cover
            opacity[rows[bare]] = again.opacity
    return Blended(colors=colors, cover=cover, opacity=opacity)


def _blend_rows(
    sheet: _Sheet,
    rows: Int[np.ndarray, "M"],
    index: Int[np.ndarray, "M K"],
    footprints: Float[np.ndarray, "N 4"],
    voxel: float,
) -> Blended:
    """Blends the Gaussians listed for each place, front to back."""
    there: Bool[np.ndarray, "M K"] = index < len(sheet.means)
    index = np.where(there, index, 0)
    points, normals = sheet.places.points[rows], sheet.places.normals[rows]
    offset = [column[index] - points[:, k, None] for k, column in enumerate(_columns(sheet.means))]
    first, second = (offset[k] for k in range(3) if k != sheet.axis)
    a, b, c, strength = (column[index] for column in _columns(footprints))
    power = 0.5 * (a * first**2 + 2.0 * b * first * second + c * second**2)
    away = np.abs(sum(offset[k] * normals[:, k, None] for k in range(3))) / voxel
    fade = np.clip((FAR - away) / (FAR - NEAR), 0.0, 1.0)
    near = np.where(there, np.exp(-np.maximum(power, 0.0)) * fade, 0.0)
    alpha = np.minimum(strength * near, MAX_ALPHA)
    if sheet.normals is None:
        outward = np.where(normals[:, sheet.axis] >= 0, 1.0, -1.0)[:, None]
        weight = _weigh_in_order(alpha, outward * offset[sheet.axis])
    else:
        up = _columns(sheet.normals)
        heights = offset[0] * up[0][index] + offset[1] * up[1][index] + offset[2] * up[2][index]
        weight = _weigh_sheets(alpha, heights, SHEET * voxel)
    cover = weight.sum(axis=1)
    total = np.stack([(weight * column[index]).sum(axis=1) for column in _columns(sheet.colors)], axis=1)
    presence = near.sum(axis=1)
    opacity = np.where(
        presence > PRESENT, (near * sheet.opacities[index]).sum(axis=1) / np.maximum(presence, PRESENT), 0.0
    )
    return Blended(colors=total / np.maximum(cover, 1e-9)[:, None], cover=cover, opacity=opacity)


def _columns(values: Float[np.ndarray, "N D"]) -> Float[np.ndarray, "D N"]:
    """The columns as contiguous rows; gathering from them is several times faster."""
    return np.ascontiguousarray(values.T)


def _weigh_in_order(
    alpha: Float[np.ndarray, "M K"], heights: Float[np.ndarray, "M K"]
) -> Float[np.ndarray, "M K"]:
    """Contribution of each Gaussian when blended from the highest down."""
    order = np.argsort(-heights, axis=1)
    weight = np.take_along_axis(alpha, order, axis=1)
    left = np.cumprod(1.0 - weight, axis=1)
    weight[:, 1:] *= left[:, :-1]
    out = np.empty_like(weight)
    np.put_along_axis(out, order, weight, axis=1)
    return out


def _weigh_sheets(
    alpha: Float[np.ndarray, "M K"], heights: Float[np.ndarray, "M K"], sheet: float
) -> Float[np.ndarray, "M K"]:
    """Contribution of each Gaussian when they form opaque sheets; gaps within one sheet are closed.

    Heights above the place along the Gaussians' own normals are equal within a sheet, even if it is slanted.
    Gaussians of the highest sheet share the area that it covers; lower ones are visible in the rest.
    """
    highest = np.where(alpha > EDGE, heights, -np.inf).max(axis=1, keepdims=True)
    top = np.where(heights >= highest - sheet, alpha, 0.0)
    total = top.sum(axis=1, keepdims=True)
    closed = np.minimum(total / CLOSED, 1.0)
    weight = top * closed / np.maximum(total, 1e-9)
    open_ = np.flatnonzero(closed[:, 0] < 1.0)
    below = _weigh_in_order((alpha - top)[open_], heights[open_])
    weight[open_] += (1.0 - closed[open_]) * below
    return weight


def _chunks(count: int, width: int) -> Iterator[Int[np.ndarray, "M"]]:
    """Rows in blocks of bounded working memory."""
    size = max(1, (1 << 16) // width)
    for start in range(0, count, size):
        yield np.arange(start, min(start + size, count))
