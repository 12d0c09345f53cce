"""Scores of pool hulls against a solid: covered, missed and excess volume.

Every hull is measured once: which cells of a grid it holds, which points of the solid's surface it misses,
how far it bulges into free space, and as how many hulls it counts once it has been cut to a length that
physics engines take.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import manifold3d
import numpy as np
from jaxtyping import Bool, Float, Int, UInt64
from scipy.spatial import KDTree

from sim_export.collision.cuboids import face_coordinates
from sim_export.collision.hulls import face_planes, hull_volume
from sim_export.geometry.sampling import sample_triangles, triangle_areas
from sim_export.geometry.solids import inside_grid, solid_arrays
from sim_export.package import Hull

CELLS = 64
"""Cells along the longest edge at least; planes of the mesh divide them further."""
PLANE_DETAIL = 3e-3
"""Share of the surface that a plane must hold to divide cells."""
SAMPLES = 5000
"""Points on the solid's surface."""
DENSE = 30_000
"""Points on the solid's surface to which bulges are measured."""
TAKEN = 5.0
"""How many times free space counts where another link is: a hull there would have to be cut again."""
HULL_SAMPLES = 120
"""Points on each hull whose distance to the solid is measured."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PooledHull:
    """A hull, and the hulls within the limits of engines that it is cut to."""

    hull: Hull
    tiles: tuple[Hull, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Ground:
    """What hulls are measured against: cells of uneven size, and points on the solid's surface.

    Cells lie between ``edges`` and are judged by a point each, at ``axes``. ``weights`` are their volumes
    over the solid's, positive in the solid and negative outside, more so where other links are.
    """

    edges: tuple[np.ndarray, np.ndarray, np.ndarray]
    axes: tuple[np.ndarray, np.ndarray, np.ndarray]
    weights: Float[np.ndarray, "X Y Z"]
    points: Float[np.ndarray, "N 3"]
    surface: KDTree
    gap: float
    area: float
    volume: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Cells:
    """The cells of a hull: a window, and which in it, or None for all (a box)."""

    window: tuple[slice, slice, slice]
    mask: np.ndarray | None

    def select(self, grid: np.ndarray) -> np.ndarray:
        """The values of these cells, as a copy unless the hull is a box."""
        return grid[self.window] if self.mask is None else grid[self.window][self.mask]

    def fill(self, grid: np.ndarray, *, value: float) -> None:
        grid[self.window][... if self.mask is None else self.mask] = value


@dataclass(frozen=True, kw_only=True, eq=False)
class Offers:
    """Hulls to choose from, and how each stands against the solid.

    ``tiles`` are the hulls that each is cut to, ``costs`` how many. ``surplus`` is the volume of a hull
    that its cells do not show, over the solid's: what sticks out of the planes between cells by less than
    half a cell. ``missing`` marks for every hull, by a bit for each of ``points`` points, those farther away
    than allowed for the surface to be missed, and those too far away; ``bulges`` is the area with which
    it bulges, over the solid's.
    """

    tiles: tuple[tuple[Hull, ...], ...]
    costs: Int[np.ndarray, "K"]
    cells: tuple[Cells, ...]
    bounds: Int[np.ndarray, "K 3 2"]
    surplus: Float[np.ndarray, "K"]
    missing: UInt64[np.ndarray, "K 2 W"]
    points: int
    bulges: Float[np.ndarray, "K"]
    weights: Float[np.ndarray, "X Y Z"]


def make_ground(solid: manifold3d.Manifold, others: Sequence[manifold3d.Manifold] = ()) -> Ground:
    """The cells and surface points of a solid; what ``others`` hold counts ``TAKEN`` times when filled."""
    vertices, faces = solid_arrays(solid)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    step = float((high - low).max()) / CELLS
    planes = face_coordinates(vertices, faces, PLANE_DETAIL) or tuple(np.stack([low, high]).T)
    edges = [_subdivide(plane, step) for plane in planes]
    x, y, z = ((edge[:-1] + 0.4871 * np.diff(edge)) for edge in edges)
    sizes = [np.diff(edge) for edge in edges]
    cells = (sizes[0][:, None, None] * sizes[1][:, None] * sizes[2]).astype(np.float32)
    inside = inside_grid(vertices, faces, (x, y, z))
    weights = np.where(inside, cells, -cells) / max(float(cells[inside].sum()), 1e-300)
    for other in others:
        taken = inside_grid(*solid_arrays(other), (x, y, z))
        weights[taken & ~inside] *= TAKEN
    surface = sample_triangles(vertices[faces], DENSE)[0]
    points = sample_triangles(vertices[faces], SAMPLES)[0]
    corners = vertices[:: max(1, len(vertices) // (SAMPLES // 4))]
    area = float(solid.surface_area())
    return Ground(
        edges=(edges[0], edges[1], edges[2]),
        axes=(x, y, z),
        weights=weights.astype(np.float32),
        points=np.concatenate([points, corners]),
        surface=KDTree(surface),
        gap=0.7 * float(np.sqrt(area / DENSE)),
        area=area,
        volume=float(solid.volume()),
    )


def _subdivide(planes: np.ndarray, step: float) -> np.ndarray:
    """Coordinates with more in between, none farther than ``step`` from the next."""
    out = [planes[:1]]
    for low, high in pairwise(planes):
        out.append(np.linspace(low, high, int(np.ceil((high - low) / step)) + 1)[1:])
    return np.concatenate(out)


def measure_offers(pool: Sequence[PooledHull], ground: Ground, missed: float, farthest: float) -> Offers:
    """Measures hulls against a solid and leaves out those that bulge too far.

    Args:
        pool: The hulls.
        ground: The solid that they are to stand for.
        missed: Distance (m) from which on a point of one surface is missed by the other.
        farthest: Distance (m) that no point should exceed.
    """
    bulges, reach = _measure_bulges(pool, ground, missed)
    able: list[int] = np.flatnonzero(reach <= farthest).tolist()
    hulls = tuple(pool[index].hull for index in able)
    cells = tuple(_cells_inside(hull, ground) for hull in hulls)
    limits = sorted((missed, farthest))
    columns = np.ascontiguousarray(ground.points.T)
    missing = [pack_marks(mark_missing(hull, columns, limits)) for hull in hulls]
    bounds = [[(axis.start, axis.stop) for axis in item.window] for item in cells]
    shown = np.array([np.abs(item.select(ground.weights)).sum() for item in cells])
    volumes = np.array([hull_volume(hull) for hull in hulls]) / ground.volume
    return Offers(
        tiles=tuple(pool[index].tiles for index in able),
        costs=np.array([len(pool[index].tiles) for index in able], dtype=np.int64),
        cells=cells,
        bounds=np.array(bounds, dtype=np.int64).reshape(-1, 3, 2),
        surplus=np.maximum(volumes - shown, 0.0),
        missing=np.array(missing, dtype=np.uint64).reshape(len(hulls), 2, -(-len(ground.points) // 64)),
        points=len(ground.points),
        bulges=bulges[able],
        weights=ground.weights,
    )


def join_offers(first: Offers, second: Offers) -> Offers:
    """Two sets of hulls that were measured against the same ground, as one."""
    return Offers(
        tiles=first.tiles + second.tiles,
        cells=first.cells + second.cells,
        weights=first.weights,
        points=first.points,
        **{
            name: np.concatenate([getattr(first, name), getattr(second, name)])
            for name in ("costs", "bounds", "surplus", "missing", "bulges")
        },
    )


def pack_marks(marks: Bool[np.ndarray, "2 N"]) -> UInt64[np.ndarray, "2 W"]:
    """A bit for every mark; those that fill up the last word are 0."""
    packed = np.packbits(marks, axis=1)
    return np.pad(packed, ((0, 0), (0, -packed.shape[1] % 8))).view(np.uint64)


def _measure_bulges(
    pool: Sequence[PooledHull], ground: Ground, missed: float
) -> tuple[np.ndarray, np.ndarray]:
    """Area over the solid's with which hulls bulge into free space beyond ``missed`` (m), and how far (m)."""
    if not pool:
        return np.zeros(0), np.zeros(0)
    triangles = [item.hull.vertices[item.hull.faces] for item in pool]
    areas = np.array([triangle_areas(corners).sum() for corners in triangles])
    spread = [sample_triangles(corners, HULL_SAMPLES)[0] for corners in triangles]
    clouds = [np.concatenate([inner, item.hull.vertices]) for inner, item in zip(spread, pool, strict=True)]
    points = np.concatenate(clouds)
    away = np.maximum(np.asarray(ground.surface.query(points)[0]) - ground.gap, 0.0)
    away[_in_solid(points, ground)] = 0.0
    split = np.split(away, np.cumsum([len(cloud) for cloud in clouds])[:-1])
    shares = np.array([(far[:HULL_SAMPLES] > missed).mean() for far in split])
    return shares * areas / ground.area, np.array([far.max() for far in split])


def _in_solid(points: np.ndarray, ground: Ground) -> np.ndarray:
    """Whether points lie in cells of the solid."""
    cells = [
        np.clip(np.searchsorted(axis, points[:, n]), 0, len(axis) - 1) for n, axis in enumerate(ground.axes)
    ]
    for n, axis in enumerate(ground.axes):
        before = np.maximum(cells[n] - 1, 0)
        nearer = np.abs(axis[before] - points[:, n]) < np.abs(axis[cells[n]] - points[:, n])
        cells[n] = np.where(nearer, before, cells[n])
    return ground.weights[tuple(cells)] > 0


def _cells_inside(hull: Hull, ground: Ground) -> Cells:
    low, high = hull.vertices.min(axis=0), hull.vertices.max(axis=0)
    window = [
        slice(int(np.searchsorted(axis, low[n])), int(np.searchsorted(axis, high[n], side="right")))
        for n, axis in enumerate(ground.axes)
    ]
    planes = face_planes(hull)
    slanted = planes[np.abs(planes[:, :3]).max(axis=1) < 1.0 - 1e-9].astype(np.float32)
    box = (window[0], window[1], window[2])
    if not len(slanted):
        return Cells(window=box, mask=None)
    x, y, z = (axis[part].astype(np.float32) for axis, part in zip(ground.axes, box, strict=True))
    mask = np.ones((len(x), len(y), len(z)), dtype=bool)
    for a, b, c, d in slanted:
        mask &= (a * x)[:, None, None] + ((b * y)[:, None] + (c * z - d)) <= 0.0
    return Cells(window=box, mask=mask)


def mark_missing(
    hull: Hull, points: Float[np.ndarray, "3 N"], limits: Sequence[float]
) -> Bool[np.ndarray, "L N"]:
    """Whether points lie farther outside of a hull than each of some limits (m, rising), at least.

    Those too far from its box are, and only the others are measured against its planes.
    """
    low, high = hull.vertices.min(axis=0)[:, None], hull.vertices.max(axis=0)[:, None]
    beside = np.maximum(np.maximum(low - points, points - high), 0.0)
    beyond = np.sqrt((beside * beside).sum(axis=0))
    near = np.flatnonzero(beyond <= limits[-1])
    planes = face_planes(hull)
    outside = (planes[:, :3] @ points[:, near] - planes[:, 3:]).max(axis=0)
    away = np.full(points.shape[1], np.inf, dtype=np.float32)
    away[near] = np.maximum(np.maximum(outside, beyond[near]), 0.0)
    return np.stack([away > limit for limit in limits])
