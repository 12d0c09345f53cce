"""Scores of pool hulls against a solid (covered, missed and excess volume), and the choice among them.

Every hull is measured once: which cells of a grid it holds, which points of the solid's surface it misses,
how far it bulges into free space, and as how many hulls it counts once it has been cut to a length that
physics engines take. The choice is greedy: again and again, the hull is taken that gains most. What the
budget leaves out is what volume and surface miss least.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import manifold3d
import numpy as np
from jaxtyping import Bool, Float, Int, UInt64
from scipy.spatial import KDTree

from sim_export.collision.cuboids import face_coordinates
from sim_export.geometry.hulls import face_planes, hull_volume
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
LEAST_SHARE = 0.02
"""Share of its weight from which on surface counts."""
MISSED_WEIGHT = 10.0
"""What a share of the surface missed counts, in shares of the volume."""
FREE_SHARE = 0.004
"""Share of the surface that may be missed for nothing, unless it is too far away."""
FAR_WEIGHT = 40.0
"""What a share of the surface that is too far away counts on top of that."""
FIRST_LOOKS = ((1.0, 0.0), (1.0, 0.02), (1.0, 1.0), (2.0, 0.02), (2.0, 0.1), (4.0, 0.0), (4.0, 0.1))
"""What greedy choices begin with: factor of what filling counts, share of the surface's weight."""
PRICE = 0.002
"""What every hull costs, in shares of the volume."""


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


def choose_hulls(offers: Offers, most: int, weight: float = 1.0) -> tuple[tuple[Hull, ...], float]:
    """The hulls that together stand best for the solid, and their loss; none where none was offered.

    Greedy choices depend on what is looked for first, so surface is first given little weight, then more.

    Args:
        offers: What is chosen from.
        most: Hulls, at most.
        weight: What free space filled counts against solid missed; more keeps cavities freer.
    """
    if not offers.tiles:
        return (), np.inf
    covers = [_cover(offers, most, factor * weight, share) for factor, share in FIRST_LOOKS]
    losses = [_loss(offers, cover, weight) for cover in covers]
    best = int(np.argmin(losses))
    return tuple(tile for index in covers[best] for tile in offers.tiles[index]), losses[best]


def _loss(offers: Offers, cover: list[int], weight: float) -> float:
    """What a cover misses, fills and costs."""
    covered = np.zeros(offers.weights.shape, dtype=bool)
    for index in cover:
        offers.cells[index].fill(covered, value=True)
    held = offers.weights[covered]
    filled = offers.surplus[cover].sum() - held[held < 0].sum()
    volume = 1.0 - held[held > 0].sum() + weight * filled
    surface = (
        _surface_loss(_missing_beside(offers, cover)[None], offers.points)[0]
        + MISSED_WEIGHT * offers.bulges[cover].sum()
    )
    return float(volume + surface + PRICE * offers.costs[cover].sum())


def _cover(offers: Offers, most: int, filled: float, share: float) -> list[int]:
    """Greedy choice of at most ``most`` hulls, for which free space counts ``filled`` times.

    Surface counts ``share`` of its weight until nothing is gained so, then ever more.
    """
    value = np.where(offers.weights < 0, filled * offers.weights, offers.weights)
    volumes = np.array([item.select(value).sum() for item in offers.cells])
    fixed = filled * offers.surplus + PRICE * offers.costs
    missing = _missing_beside(offers, ())
    surfaces = _surface_gains(offers, missing)
    chosen: list[int] = []
    room = most
    while room > 0:
        gains = volumes + share * surfaces - fixed
        score = np.where(offers.costs <= room, gains / offers.costs, -np.inf)
        best = int(score.argmax())
        if score[best] > 0.0:
            chosen.append(best)
            room -= int(offers.costs[best])
            offers.cells[best].fill(value, value=0.0)
            missing = missing & offers.missing[best]
            surfaces = _surface_gains(offers, missing)
            for index in np.flatnonzero(_meet(offers.bounds, offers.bounds[best]) & np.isfinite(volumes)):
                volumes[index] = offers.cells[index].select(value).sum()
            volumes[best] = -np.inf
        elif share < 1.0:
            share = min(1.0, max(LEAST_SHARE, 3.0 * share))
        else:
            break
    return chosen


def _meet(bounds: Int[np.ndarray, "K 3 2"], other: Int[np.ndarray, "3 2"]) -> Bool[np.ndarray, "K"]:
    """Whether windows of cells have any in common with another."""
    return np.all((bounds[..., 0] < other[:, 1]) & (other[:, 0] < bounds[..., 1]), axis=-1)


def _surface_gains(offers: Offers, missing: np.ndarray) -> np.ndarray:
    """What each hull gains in surface, less what it bulges, where so much is ``missing`` yet."""
    gained = _surface_loss(missing[None], offers.points)[0] - _surface_loss(
        missing & offers.missing, offers.points
    )
    return gained - MISSED_WEIGHT * offers.bulges


def _missing_beside(offers: Offers, cover: Sequence[int]) -> UInt64[np.ndarray, "2 W"]:
    """The points that all hulls of a cover miss; all points without any."""
    everything = pack_marks(np.ones((2, offers.points), dtype=bool))
    return np.bitwise_and.reduce(offers.missing[list(cover)], axis=0) if len(cover) else everything


def _surface_loss(missing: UInt64[np.ndarray, "K 2 W"], total: int) -> np.ndarray:
    """What missing points count, out of ``total``."""
    missed, far = np.bitwise_count(missing).sum(axis=2, dtype=np.int64).T / total
    return MISSED_WEIGHT * np.maximum(missed - FREE_SHARE, 0.0) + FAR_WEIGHT * far
