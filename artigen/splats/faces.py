"""Gaussians of a shape: flat discs laid on the exact faces of its primitives, without a network.

A face is covered by rows of cells with one disc each. Cells at the borders of a face are a quarter as wide as
those inside, so that edges are sharp and large faces take few discs. Colours are those of the renderer in
even light, averaged over directions of view. There is no detail finer than a cell.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.special import spence

from artigen.shapes.asset import frame_shape
from artigen.shapes.primitives import Primitive
from artigen.shapes.shape import Shape
from artigen.shapes.solids import Solids, list_solids, see_points
from artigen.transforms import quat_from_matrix
from artigen.types import Gaussians

SPACING = 1 / 96
"""Width of a cell inside a face, as a share of the longest edge of the object."""
BORDER = (0.25, 0.25, 0.5)
"""Widths of the cells along a border, from the edge inwards, as shares of the width inside."""
FINE = 4
"""How many times narrower rows and borders of faces with slanted edges are: rows end in steps there, and such
faces often meet others in one plane, as around a round hole."""
SPREAD = 0.7
"""Standard deviation of a disc, as a share of the width of its cell. Less shows the grid, more blurs."""
INSET = 2.1
"""Distance of the outermost discs from the edge, in standard deviations. At the edges of a board the discs of
its front, back and end overlap: less thickens outlines, more opens seams."""
FLATNESS = 0.001
"""Standard deviation along the normal, as a share of the width inside a face."""
SQUARE = 0.999
"""Cosine from which edges count as parallel; 1 less it, below which they count as perpendicular."""
SIDES = 32
"""Corners of the polygon that stands for the round end of a cylinder."""
LEAST_AROUND = 16
"""Fewest discs around a cylinder: wide ones stick out of its outline."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Faces:
    """Flat faces: convex polygons, whose rings repeat their last corner."""

    rings: Float[np.ndarray, "F M 3"]
    """Corners (m), counterclockwise from outside."""
    normals: Float[np.ndarray, "F 3"]
    owners: Int[np.ndarray, "F"]
    """Index of the primitive."""
    directions: Float[np.ndarray, "F 3"]
    """Directions of the rows."""
    slanted: bool
    """Whether some edges are neither parallel nor perpendicular to the rows."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Discs:
    """Discs in metres, primitive by primitive."""

    centers: Float[np.ndarray, "N 3"]
    frames: Float[np.ndarray, "N 3 3"]
    """Columns: two axes in the face, and the outward normal."""
    deviations: Float[np.ndarray, "N 2"]
    """Standard deviations along the first two axes."""
    owners: Int[np.ndarray, "N"]
    """Index of the primitive."""

    @property
    def normals(self) -> Float[np.ndarray, "N 3"]:
        """Outward unit normals."""
        return self.frames[:, :, 2]

    def select(self, rows: Int[np.ndarray, "K"] | Bool[np.ndarray, "N"]) -> "Discs":
        """Some of the discs."""
        return Discs(**{name: value[rows] for name, value in vars(self).items()})


def lay_gaussians(shape: Shape, spacing: float = SPACING) -> Gaussians:
    """Gaussians on the surface of every part, in the unit cube of the shape's `Asset`; deterministic.

    A pane lets as much light through as its finish says; its two sides share its opacity.

    Args:
        shape: The object; part i of the Gaussians is its part i.
        spacing: Width of a cell inside a face, as a share of the longest edge.

    Raises:
        ValueError: If ``spacing`` is not above 0.
    """
    from artigen.shapes.render.even_light import light_evenly

    if not spacing > 0:
        raise ValueError(f"Gaussians {spacing} of the longest edge apart, expected above 0")
    center, scale = frame_shape(shape)
    solids = list_solids(shape)
    discs = lay_discs(solids, spacing * scale)
    discs = discs.select(see_points(solids, discs.centers, discs.normals, discs.owners))
    opacity, colors = light_evenly(
        shape, discs.owners, discs.centers, discs.frames, footprint=spacing * scale
    )
    flat = np.full(len(opacity), FLATNESS * spacing)
    return Gaussians(
        means=(discs.centers - center) / scale,
        quats=quat_from_matrix(discs.frames),
        scales=np.column_stack([discs.deviations / scale, flat]),
        opacities=_disc_opacity(opacity),
        colors=colors,
        part_ids=solids.part_ids[discs.owners],
    )


def lay_discs(solids: Solids, spacing: float) -> Discs:
    """Discs on all faces of all primitives, in the order of the primitives, hidden ones included.

    Args:
        spacing: Width of a cell inside a face (m).
    """
    round_ones = [index for index, one in enumerate(solids.primitives) if one.kind == "cylinder"]
    laid = [_cover_faces(faces, spacing) for faces in _list_faces(solids)]
    laid += [_cover_side(solids.primitives[index], index, spacing) for index in round_ones]
    every = Discs(**{name: np.concatenate([vars(one)[name] for one in laid]) for name in vars(laid[0])})
    return every.select(np.argsort(every.owners, kind="stable"))


def divide_lengths(
    lengths: Float[np.ndarray, "K"], spacing: float, border: Sequence[float] = BORDER
) -> tuple[Int[np.ndarray, "N"], Float[np.ndarray, "N"], Float[np.ndarray, "N"]]:
    """Divides lengths into cells, narrow ones at both ends; short lengths into narrow cells only.

    Returns:
        Row of the length, place along it, and standard deviation, of the disc of each cell.
    """
    widths = spacing * np.array(border)
    narrow, reach = widths[0], INSET * SPREAD
    inset = (reach - 0.5) * narrow  # the narrow cells at the ends begin here
    free = lengths - 2 * inset
    inner = free - 2 * widths.sum()
    graded = inner > spacing / 2
    inside = np.where(graded, np.maximum(1, np.rint(inner / spacing)), 0).astype(np.int64)
    alike = np.maximum(1, np.rint(free / narrow)).astype(np.int64)
    count = np.where(graded, inside + 2 * len(widths), alike)
    row = np.repeat(np.arange(len(lengths)), count)
    order = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    rest = count[row] - 1 - order
    width = (lengths / (alike - 1 + 2 * reach))[row]
    place = (reach + order) * width
    wide = np.where(graded, inner / np.maximum(inside, 1), 0.0)[row]
    away = np.minimum(order, rest)  # cells from the nearer end
    at_end, end = away < len(widths), np.minimum(away, len(widths) - 1)
    from_end = inset + (np.cumsum(widths) - widths / 2)[end]
    outer = np.where(order < rest, from_end, lengths[row] - from_end)
    middle = inset + widths.sum() + (order - len(widths) + 0.5) * wide
    place = np.where(graded[row], np.where(at_end, outer, middle), place)
    width = np.where(graded[row], np.where(at_end, widths[end], wide), width)
    return row, place, SPREAD * width


def _list_faces(solids: Solids) -> list[_Faces]:
    """The flat faces of all primitives, ends of cylinders included: the rectangular ones, and the others."""
    rings, normals, owners = [], [], []
    for index, one in enumerate(solids.primitives):
        if one.kind == "cylinder":
            radial, axis = _around(one, np.arange(SIDES) * (2 * np.pi / SIDES))[0], one.rotation[:, 2]
            for sign in (1, -1):
                end = one.center + sign * axis * one.size[2] / 2 + one.size[0] / 2 * radial[::sign]
                rings.append(end)
                normals.append(sign * axis)
                owners.append(index)
        else:
            corners = one.vertices @ one.rotation.T + one.center
            rings.extend(corners[one.rings])
            normals.extend(one.planes[:, :3] @ one.rotation.T)
            owners.extend([index] * len(one.rings))
    most = max(len(ring) for ring in rings)
    padded = [np.concatenate([ring, np.repeat(ring[-1:], most - len(ring), axis=0)]) for ring in rings]
    outlines = np.stack(padded)
    directions, slanted = _find_directions(outlines)
    return [
        _Faces(
            rings=outlines[rows],
            normals=np.stack(normals)[rows],
            owners=np.array(owners)[rows],
            directions=directions[rows],
            slanted=kind,
        )
        for kind, rows in ((False, ~slanted), (True, slanted))
    ]


def _cover_faces(faces: _Faces, spacing: float) -> Discs:
    """Rows of discs from border to border of each face."""
    along = faces.directions
    frames = np.stack([along, np.cross(faces.normals, along), faces.normals], axis=2)
    corners = np.einsum("fmi,fij->fmj", faces.rings - faces.rings[:, :1], frames[:, :, :2])
    low, high = corners[:, :, 1].min(axis=1), corners[:, :, 1].max(axis=1)
    fine, border = 1, BORDER
    if faces.slanted:
        fine, border = FINE, (*(share / FINE for share in BORDER), *BORDER[1:])
    face, height, tall = divide_lengths(high - low, spacing / fine)
    height += low[face]
    start, stop = _cut_rows(corners[face], height)
    row, place, wide = divide_lengths(stop - start, spacing, border)
    own = face[row]
    flat = np.stack([start[row] + place, height[row]], axis=1)
    return Discs(
        centers=faces.rings[own, 0] + np.einsum("nj,nij->ni", flat, frames[own, :, :2]),
        frames=frames[own],
        deviations=np.stack([wide, tall[row]], axis=1),
        owners=faces.owners[own],
    )


def _find_directions(
    rings: Float[np.ndarray, "F M 3"],
) -> tuple[Float[np.ndarray, "F 3"], Bool[np.ndarray, "F"]]:
    """The direction of the edge to which most of a face's outline is parallel or perpendicular.

    Returns:
        The directions, and whether an edge is neither.
    """
    edges = np.roll(rings, -1, axis=1) - rings
    lengths = np.linalg.norm(edges, axis=2)
    units = edges / np.where(lengths == 0, 1.0, lengths)[:, :, None]
    cosines = np.abs(np.einsum("fmi,fki->fmk", units, units))
    aligned = (cosines > SQUARE) | (cosines < 1 - SQUARE)
    score = np.einsum("fmk,fk->fm", aligned, lengths)
    best = np.where(lengths == 0, -1.0, score + lengths / 2).argmax(axis=1)
    every = np.arange(len(rings))
    return units[every, best], score[every, best] < 0.999 * lengths.sum(axis=1)


def _cut_rows(
    corners: Float[np.ndarray, "R M 2"], height: Float[np.ndarray, "R"]
) -> tuple[Float[np.ndarray, "R"], Float[np.ndarray, "R"]]:
    """Where rows at a height enter and leave their convex polygons."""
    x, y = corners[:, :, 0], corners[:, :, 1]
    rise = np.roll(y, -1, axis=1) - y
    share = (height[:, None] - y) / np.where(rise == 0, np.inf, rise)
    crossed = (rise != 0) & (share >= 0) & (share <= 1)
    at = x + share * (np.roll(x, -1, axis=1) - x)
    return np.where(crossed, at, np.inf).min(axis=1), np.where(crossed, at, -np.inf).max(axis=1)


def _cover_side(one: Primitive, index: int, spacing: float) -> Discs:
    """Rings of discs on the round side of a cylinder."""
    radius, length = one.size[0] / 2, one.size[2]
    _, height, tall = divide_lengths(np.array([length]), spacing)
    count = max(LEAST_AROUND, round(2 * np.pi * radius / spacing))
    radial, tangent = _around(one, np.arange(count) * (2 * np.pi / count))
    ring = np.tile(np.arange(count), len(height))
    level = np.repeat(height - length / 2, count)
    axis = np.broadcast_to(one.rotation[:, 2], (len(ring), 3))
    wide = np.full(len(ring), SPREAD * 2 * np.pi * radius / count)
    return Discs(
        centers=one.center + radius * radial[ring] + level[:, None] * axis,
        frames=np.stack([tangent[ring], axis, radial[ring]], axis=2),
        deviations=np.stack([wide, np.repeat(tall, count)], axis=1),
        owners=np.full(len(ring), index),
    )


def _around(
    one: Primitive, angles: Float[np.ndarray, "K"]
) -> tuple[Float[np.ndarray, "K 3"], Float[np.ndarray, "K 3"]]:
    """Unit vectors away from the axis of a cylinder at angles about it, and along its circle."""
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x, y = one.rotation[:, 0], one.rotation[:, 1]
    return cos * x + sin * y, cos * y - sin * x


def _disc_opacity(opacity: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N"]:
    """Opacity of discs of which two layers hide as much as a surface of the given opacity.

    A disc of opacity a and standard deviation SPREAD (in cells) contributes 2 pi SPREAD^2 Li2(a) to the mean
    optical depth of its cell.
    """
    with np.errstate(divide="ignore"):
        depth = -0.5 * np.log(1.0 - opacity)
    known = np.linspace(0.0, 1.0, 2001)
    return np.interp(depth, 2 * np.pi * SPREAD**2 * spence(1.0 - known), known)
