"""Cuts and joins pieces of a surface by the free space that their convex hulls would fill.

Nothing is assumed of the triangles: they may be open, doubled, or pass through each other.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import ConvexHull, QhullError

from sim_export.collision.cover.free_space import (
    NO_INTRUSION,
    FreeSpace,
    Intrusion,
    look_up,
    measure_intrusion,
)
from sim_export.geometry.rows import number_rows
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.triangles import area_normals, bounds_of, face_edges, triangle_areas

THIN = 2e-3
"""Pieces (m) thinner than this are sheets: their hulls hold no cell."""
MOST_PLANES = 6
"""Planes of a surface along which cuts are tried."""
LEAST_HEIGHT = 1e-5
"""Triangles lower than this (m) are left out where a cut divides a surface."""
FEW = 0.03
"""Share of the points on a thin hull that may lie in free space."""
EVEN = 0.02
"""What a cut costs that leaves all of the surface on one side, in shares of the free space taken before."""
DONE = 0.4
"""What a cut gains that leaves nearly all of the surface in a hull that takes none."""
MOST_JUDGED = 600
"""Triangles of a piece by which cuts are judged."""
BESIDE = 5e-4
"""Metres beside a plane of the surface at which a cut runs, so that the plane's triangles stay whole."""
SAMPLES = 48
"""Points on the surface of a piece."""
SKIN = 240
"""Points on the hull of a piece."""


def spread_ways(count: int) -> Float[np.ndarray, "D 3"]:
    """Unit vectors spread evenly over half of a sphere."""
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    height = (np.arange(count) + 0.5) / count
    radius = np.sqrt(1.0 - height**2)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])


WAYS, FEW_WAYS = spread_ways(96), spread_ways(24)
"""Directions, each both ways, in which corners are looked for: of pieces, and while cuts are judged."""
_MIX = np.array([1.0, 7.389, 54.598, 403.43])
"""Weights under which only coplanar faces have equal sums."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """Triangles and their convex hull.

    ``corners`` are the hull's vertices, ``planes`` its faces (none of a sheet), ``samples`` points on the
    triangles.
    """

    triangles: Float[np.ndarray, "F 3 3"]
    corners: Float[np.ndarray, "V 3"]
    planes: Float[np.ndarray, "K 4"]
    volume: float
    area: float
    intrusion: Intrusion
    samples: Float[np.ndarray, "N 3"]

    @cached_property
    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Lowest and highest corner (m)."""
        return bounds_of(self.corners)


@dataclass(frozen=True, kw_only=True, eq=False)
class Around:
    """Convex hull of points: its corners, planes, volume (m^3), area (m^2) and faces."""

    corners: Float[np.ndarray, "V 3"]
    planes: Float[np.ndarray, "K 4"]
    volume: float
    area: float
    faces: Float[np.ndarray, "F 3 3"]


def wrap(points: Float[np.ndarray, "N 3"], ways: Float[np.ndarray, "D 3"] = WAYS) -> Around:
    """The convex hull of points; no planes where they are thinner than `THIN`.

    Of many points, those count that lie farthest along some direction, ``ways`` as seen where the points
    spread evenly: hulls of engines have few corners anyway, and Qhull's time grows with them.
    """
    middle = points.mean(axis=0)
    spread = points - middle
    axes = np.linalg.eigh(spread.T @ spread)[1].T[::-1]
    across = spread @ axes[2]
    sheet = bool(across.max() - across.min() < THIN) or len(points) < 4
    if len(points) > 2 * len(ways):
        along = axes @ spread.T
        even = along / np.maximum(np.ptp(along, axis=1, keepdims=True), 1e-9)
        heights = ways.astype(np.float32) @ even.astype(np.float32)  # in rows, which are searched fastest
        chosen = np.unique(np.concatenate([heights.argmax(axis=1), heights.argmin(axis=1)]))
        points, spread = points[chosen], spread[chosen]
    if not sheet:
        try:
            solved = ConvexHull(spread)
        except QhullError:
            sheet = True
        else:
            planes = solved.equations[np.unique(np.round(solved.equations @ _MIX, 6), return_index=True)[1]]
            planes = np.column_stack([planes[:, :3], planes[:, :3] @ middle - planes[:, 3]])
            return Around(
                corners=points[solved.vertices],
                planes=planes,
                volume=float(solved.volume),
                area=float(solved.area),
                faces=points[solved.simplices],
            )
    try:
        outline = ConvexHull(spread @ axes[:2].T)
        corners, area = points[outline.vertices], 2.0 * float(outline.volume)
    except QhullError:
        corners, area = points, 0.0
    fan = np.stack([np.broadcast_to(corners[0], corners[2:].shape), corners[1:-1], corners[2:]], axis=1)
    return Around(
        corners=corners,
        planes=np.zeros((0, 4)),
        volume=0.0,
        area=area,
        faces=fan if area > 0.0 else np.zeros((0, 3, 3)),
    )


def make_piece(triangles: Float[np.ndarray, "F 3 3"], space: FreeSpace, least: float) -> Piece:
    """A piece of some triangles; ``least`` (m) as in `measure_intrusion`."""
    around = wrap(triangles.reshape(-1, 3))
    return _finish(around, triangles, sample_triangles(triangles, SAMPLES)[0], space, least)


def join_pieces(first: Piece, second: Piece, space: FreeSpace, least: float) -> Piece:
    """One piece of two."""
    around = wrap(np.concatenate([first.corners, second.corners]))
    triangles = np.concatenate([first.triangles, second.triangles])
    return _finish(around, triangles, np.concatenate([first.samples, second.samples]), space, least)


def intrude_together(first: Piece, second: Piece, space: FreeSpace, least: float) -> Intrusion:
    """What the hull of a few corners of two pieces takes of free space: no more than their common one
    does."""
    return _measure(wrap(np.concatenate([first.corners, second.corners]), FEW_WAYS), space, least, SAMPLES)


def _finish(
    around: Around, triangles: np.ndarray, samples: np.ndarray, space: FreeSpace, least: float
) -> Piece:
    return Piece(
        triangles=triangles,
        corners=around.corners,
        planes=around.planes,
        volume=around.volume,
        area=around.area,
        intrusion=_measure(around, space, least, SKIN),
        samples=samples,
    )


def measure_again(piece: Piece, space: FreeSpace, least: float) -> Piece:
    """A piece with what its hull takes of free space beyond another distance (m) from the surface."""
    return replace(piece, intrusion=_measure(wrap(piece.corners), space, least, SKIN))


def _measure(around: Around, space: FreeSpace, least: float, skin: int) -> Intrusion:
    """What a hull takes of free space.

    Hulls thinner than two cells contain few centres of cells, so ``skin`` points on their faces are tested:
    the hull of a frame must not close its opening.
    """
    cell = space.grid.cell
    intrusion = NO_INTRUSION
    if len(around.planes):
        intrusion = measure_intrusion(around.planes, bounds_of(around.corners), space, least)
    if len(around.faces) and around.volume < cell * around.area:
        depth = look_up(sample_triangles(around.faces, skin)[0], space.depth, space.grid)
        share = float((depth > least + 0.5 * cell).mean())
        if share > FEW:
            taken = 0.5 * share * around.area * cell
            deepest = max(intrusion.depth, float(depth.max()))
            return Intrusion(volume=max(intrusion.volume, taken), depth=deepest)
    return intrusion


def cut_triangles(
    triangles: Float[np.ndarray, "F 3 3"], normal: Float[np.ndarray, "3"], offset: float
) -> tuple[Float[np.ndarray, "G 3 3"], Float[np.ndarray, "H 3 3"]]:
    """Triangles below and above the plane ``normal @ x = offset``; those across are divided."""
    heights = triangles @ normal - offset
    below = heights <= 0.0
    count = below.sum(axis=1)
    sides = [triangles[count == 3], triangles[count == 0]]
    for lone_below in (True, False):
        rows = np.flatnonzero(count == (1 if lone_below else 2))
        if not len(rows):
            continue
        lone = (below[rows] == lone_below).argmax(axis=1)
        turned = (lone[:, None] + np.arange(3)) % 3
        corners = triangles[rows[:, None], turned]
        h = heights[rows[:, None], turned]
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        p = a + (h[:, 0] / (h[:, 0] - h[:, 1]))[:, None] * (b - a)
        q = a + (h[:, 0] / (h[:, 0] - h[:, 2]))[:, None] * (c - a)
        tip = np.stack([a, p, q], axis=1)
        rest = np.concatenate([np.stack([p, b, c], axis=1), np.stack([p, c, q], axis=1)])
        own, other = (0, 1) if lone_below else (1, 0)
        sides[own] = np.concatenate([sides[own], _without_needles(tip)])
        sides[other] = np.concatenate([sides[other], _without_needles(rest)])
    return sides[0], sides[1]


def _without_needles(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "G 3 3"]:
    """Triangles higher than `LEAST_HEIGHT`; each cut along a fine mesh would triple all others."""
    edges = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2).max(axis=1)
    return triangles[2.0 * triangle_areas(triangles) > LEAST_HEIGHT * edges]


def cut_planes(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "K 4"]:
    """Planes worth a cut: beside the largest flat regions of a surface, and across its middle."""
    normals = area_normals(triangles)
    areas = np.linalg.norm(normals, axis=1)
    proper = areas > 1e-12
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    out = [np.append(axis, axis @ (low + high) / 2) for axis in np.eye(3)]
    if not proper.any():
        return np.stack(out)
    normals = normals[proper] / areas[proper, None]
    main = np.abs(normals).argmax(axis=1)
    normals *= np.where(normals[np.arange(len(normals)), main] < 0, -1.0, 1.0)[:, None]
    offsets = np.einsum("ij,ij->i", normals, triangles[proper].mean(axis=1))
    size = float((high - low).max())
    key = np.round(np.column_stack([normals * 50, offsets / size * 400])).astype(np.int64)
    first, slot = number_rows(key)
    weight = np.bincount(slot, weights=areas[proper])
    for group in np.argsort(-weight, kind="stable")[:MOST_PLANES]:
        normal, offset = normals[first[group]], offsets[first[group]]
        out += [np.append(normal, offset - BESIDE), np.append(normal, offset + BESIDE)]
    return np.stack(out)


def split_piece(piece: Piece, space: FreeSpace, least: float) -> tuple[Piece, Piece] | None:
    """The cut after which the two hulls take least free space; ``None`` where no cut divides the piece.

    Cuts that leave a side whose hull takes none are better the more of the surface is on that side: a wall
    comes off a box in one piece.
    """
    best, best_score = None, np.inf
    main = _main_triangles(piece.triangles)
    net = _make_net(main)
    for plane in cut_planes(main):
        heights = net.vertices @ plane[:3] - plane[3]
        share = _share_below(net, heights)
        if not 1e-3 < share < 1.0 - 1e-3:
            continue
        uneven = EVEN * abs(2.0 * share - 1.0)
        taken, done, bound = 0.0, 1.0, 0.0
        # The larger side first, which takes more.
        for side, part in sorted(((1.0, share), (-1.0, 1.0 - share)), key=lambda each: -each[1]):
            bound = taken + piece.intrusion.volume * (uneven - DONE * done)
            if bound >= best_score:  # whatever this side takes
                break
            own = _measure(wrap(_points_below(net, side * heights), FEW_WAYS), space, least, SAMPLES).volume
            taken, done = taken + own, done - (part if own > 0.0 else 0.0)
            bound = taken + piece.intrusion.volume * (uneven - DONE * done)
        if bound < best_score:
            best, best_score = plane, bound
    if best is None:
        return None
    sides = cut_triangles(piece.triangles, best[:3], float(best[3]))
    if min(map(len, sides)) == 0:
        return None
    return make_piece(sides[0], space, least), make_piece(sides[1], space, least)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Net:
    """Triangles by their vertices, each of these and of their edges once, and the area (m^2) of each."""

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    edges: Int[np.ndarray, "E 2"]
    areas: Float[np.ndarray, "F"]


def _make_net(triangles: Float[np.ndarray, "F 3 3"]) -> _Net:
    points = triangles.reshape(-1, 3)
    first, slot = number_rows(np.rint(1e9 * points).astype(np.int64))
    faces = slot.reshape(-1, 3)
    edges = np.sort(face_edges(faces), axis=1)
    return _Net(
        vertices=points[first],
        faces=faces,
        edges=edges[number_rows(edges)[0]],
        areas=triangle_areas(triangles),
    )


def _share_below(net: _Net, heights: Float[np.ndarray, "V"]) -> float:
    """Share of the area below a plane over which the vertices are so high."""
    h = np.sort(heights[net.faces], axis=1)
    # Of a triangle across the plane, its lone corner cuts off what two edges have of their lengths there.
    with np.errstate(invalid="ignore", divide="ignore"):
        low = h[:, 0] ** 2 / ((h[:, 0] - h[:, 1]) * (h[:, 0] - h[:, 2]))
        high = h[:, 2] ** 2 / ((h[:, 2] - h[:, 1]) * (h[:, 2] - h[:, 0]))
    below = np.where(
        h[:, 2] <= 0.0, 1.0, np.where(h[:, 0] > 0.0, 0.0, np.where(h[:, 1] > 0.0, low, 1.0 - high))
    )
    return float(below @ net.areas) / max(float(net.areas.sum()), 1e-12)


def _points_below(net: _Net, heights: Float[np.ndarray, "V"]) -> Float[np.ndarray, "N 3"]:
    """The vertices below a plane, and where it meets edges."""
    below = heights <= 0.0
    a, b = net.edges[below[net.edges[:, 0]] != below[net.edges[:, 1]]].T
    along = (heights[a] / (heights[a] - heights[b]))[:, None]
    return np.concatenate(
        [net.vertices[below], net.vertices[a] + along * (net.vertices[b] - net.vertices[a])]
    )


def _main_triangles(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "G 3 3"]:
    """The largest triangles and some of the others, by which cuts are judged."""
    if len(triangles) <= MOST_JUDGED:
        return triangles
    order = np.argsort(-triangle_areas(triangles), kind="stable")
    half = MOST_JUDGED // 2
    return triangles[np.concatenate([order[:half], order[half :: len(order) // half]])]
