"""L1, islands: no piece of a visual and no hull floats beside the rest of its link (V107)."""

from collections.abc import Callable, Iterator, Sequence
from functools import cache

import numpy as np
from jaxtyping import Float, Int

from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, always
from sim_export.checks.subject import Subject
from sim_export.collision.contacts import HullSet

# coal is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

Distance = Callable[[int, int], float]
ENCLOSED = 0.99
"""Winding number from which a point counts as inside of a closed surface; those of open ones are less."""


def check_islands(subject: Subject, cfg: CheckConfig) -> Finding:
    """V107: what is seen of a link holds together, and each of its hulls is at that or at other hulls."""
    gaps = [(0.0, "", "every link is of one piece")]
    for link in subject.links:
        shown = [shape.triangles for shape in subject.visuals if shape.link == link]
        triangles = np.concatenate([np.zeros((0, 3, 3)), *shown])
        for gap, size in visual_islands(triangles, cfg.max_island):
            said = f"a visible piece of {size} faces is {1e3 * gap:.3g} mm from the rest of link {link!r}"
            gaps.append((gap, link, said))
        for gap, size in hull_islands(subject.hull_sets[link], triangles, cfg.max_island):
            said = f"{size} hulls of link {link!r} are {1e3 * gap:.3g} mm from all else of it"
            gaps.append((gap, link, said))
    gap, where, said = max(gaps)
    return Finding(
        passed=gap <= cfg.max_island,
        value=gap,
        threshold=cfg.max_island,
        unit="m",
        where=where,
        message=f"{said}, allowed is {1e3 * cfg.max_island:g} mm",
    )


def visual_islands(triangles: Float[np.ndarray, "F 3 3"], reach: float) -> list[tuple[float, int]]:
    """Pieces of a surface farther than ``reach`` from the rest: distance (m) and count of faces of each.

    A piece inside the solid that the others bound is no island: nobody sees it, or it is the wall of a sealed
    cavity.
    """
    if not len(triangles):
        return []
    piece = join_near(triangles, connected_pieces(triangles), reach)
    order = np.argsort(piece, kind="stable")
    pieces = np.split(triangles[order], np.flatnonzero(np.diff(piece[order])) + 1)
    bounds = np.array([_bounds(piece) for piece in pieces])
    shapes = cache(lambda index: _surface_shape(pieces[index]))

    def embedded(rows: Sequence[int]) -> bool:
        others = [piece for row, piece in enumerate(pieces) if row not in rows]
        return _turns_around(np.concatenate(others), pieces[rows[0]][0, 0]) > ENCLOSED

    return find_islands(
        bounds,
        lambda one, other: _distance(shapes(one), shapes(other)),
        [len(p) for p in pieces],
        reach,
        embedded,
    )


def hull_islands(
    hulls: HullSet, triangles: Float[np.ndarray, "F 3 3"], reach: float
) -> list[tuple[float, int]]:
    """Hulls farther than ``reach`` from all that is seen of a link and from its other hulls.

    A hull at the surface that it stands for does not float, though the next one may be far: how well hulls
    cover a surface is not judged here.

    Args:
        hulls: The hulls of a link.
        triangles: What is seen of it.
        reach: Farthest that a hull may be from the rest (m).
    """
    count = len(hulls.hulls)
    if not count:
        return []
    shown = cache(lambda: _surface_shape(triangles))

    def distance(one: int, other: int) -> float:
        if other < count:
            return _distance(hulls.shapes[one], hulls.shapes[other])
        low, high = hulls.rest_bounds[one, 0] - reach, hulls.rest_bounds[one, 1] + reach
        near = (triangles.min(axis=1) <= high).all(axis=1) & (triangles.max(axis=1) >= low).all(axis=1)
        found = _distance(hulls.shapes[one], _surface_shape(triangles[near])) if near.any() else np.inf
        return found if found <= reach else _distance(hulls.shapes[one], shown())

    bounds, sizes = hulls.rest_bounds, [1] * count
    if len(triangles):
        bounds, sizes = np.concatenate([bounds, _bounds(triangles)[None]]), [*sizes, count + 1]
    return find_islands(bounds, distance, sizes, reach)


def _bounds(triangles: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "2 3"]:
    return np.stack([triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))])


def _distance(first: object, second: object) -> float:
    """Distance (m) of two coal shapes, 0 where they overlap."""
    import coal

    request, still = coal.DistanceRequest(), coal.Transform3s()
    request.enable_signed_distance = False
    return max(0.0, float(coal.distance(first, still, second, still, request, coal.DistanceResult())))


def find_islands(
    bounds: Float[np.ndarray, "N 2 3"],
    distance: Distance,
    sizes: Sequence[int],
    reach: float,
    belongs: Callable[[Sequence[int]], bool] = lambda _: False,
) -> list[tuple[float, int]]:
    """Groups of things that nothing within ``reach`` connects to the largest group.

    Things hold together by single linkage; the gap of a group is the width that the shortest bridges to the
    largest group ask for.

    Args:
        bounds: Lowest and highest corner of every thing.
        distance: Exact distance of two of them (m).
        sizes: What each counts for.
        reach: Farthest that things may be apart and still hold together (m).
        belongs: Tells of a group whether it is a part of the rest, however far it is.
    """
    groups = np.arange(len(bounds))
    for first, second, _ in _near_pairs(bounds, reach):
        if groups[first] != groups[second] and distance(first, second) <= reach:
            groups[groups == groups[second]] = groups[first]
    names, weights = np.unique(groups), np.bincount(groups, weights=sizes).astype(int)
    if len(names) == 1:
        return []
    loose = [name for name in names if not belongs(np.flatnonzero(groups == name).tolist())]
    main = max(loose, key=lambda name: weights[name])
    groups[~np.isin(groups, loose)] = main
    names, weights = np.unique(groups), np.bincount(groups, weights=sizes).astype(int)
    gaps = np.full((len(names), len(names)), np.inf)
    row = {name: index for index, name in enumerate(names.tolist())}
    for first, second, apart in _near_pairs(bounds, np.inf):
        a, b = row[int(groups[first])], row[int(groups[second])]
        if a != b and apart < gaps[a, b]:
            gaps[a, b] = gaps[b, a] = min(gaps[a, b], distance(first, second))
    return _bridge(gaps, weights[names])


def _bridge(gaps: Float[np.ndarray, "G G"], weights: Int[np.ndarray, "G"]) -> list[tuple[float, int]]:
    """Bridges of groups to the heaviest one, shortest first (Prim): width and weight of each group."""
    joined = np.arange(len(weights)) == weights.argmax()
    out = []
    while not joined.all():
        rest = np.where(joined[:, None] & ~joined[None], gaps, np.inf)
        _, column = np.unravel_index(int(rest.argmin()), rest.shape)
        out.append((float(rest[:, column].min()), int(weights[column])))
        joined[column] = True
    return out


def _turns_around(triangles: Float[np.ndarray, "F 3 3"], point: Float[np.ndarray, "3"]) -> float:
    """Winding number of a surface about a point: 1 inside of what it bounds, 0 outside.

    The sum of the solid angles of its faces (Van Oosterom and Strackee 1983).
    """
    a, b, c = np.moveaxis(triangles - point, 1, 0)
    far_a, far_b, far_c = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    volume = np.einsum("fi,fi->f", a, np.cross(b, c))
    sums = [(u * v).sum(axis=1) * far for u, v, far in ((a, b, far_c), (b, c, far_a), (c, a, far_b))]
    return float(np.arctan2(volume, far_a * far_b * far_c + sum(sums)).sum() / (2 * np.pi))


def _near_pairs(bounds: Float[np.ndarray, "N 2 3"], reach: float) -> Iterator[tuple[int, int, float]]:
    """Pairs of boxes within ``reach``, nearest first, with the distance of the boxes."""
    low, high = bounds[:, 0], bounds[:, 1]
    between = np.maximum(0.0, np.maximum(low[:, None] - high[None], low[None] - high[:, None]))
    apart = np.linalg.norm(between, axis=2)
    first, second = np.nonzero(np.triu(apart <= reach, k=1))
    for index in np.argsort(apart[first, second], kind="stable"):
        yield int(first[index]), int(second[index]), float(apart[first[index], second[index]])


def connected_pieces(triangles: Float[np.ndarray, "F 3 3"]) -> Int[np.ndarray, "F"]:
    """Number of the connected piece of every face; corners in the same place, to a micrometre, are one."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    keys = np.round(triangles.reshape(-1, 3) * 1e6).astype(np.int64)
    unique, corner = np.unique(keys, axis=0, return_inverse=True)
    faces = corner.reshape(-1, 3)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_matrix((np.ones(len(edges), bool), edges.T), (len(unique), len(unique)))
    return connected_components(graph, directed=False)[1][faces[:, 0]]


def join_near(
    triangles: Float[np.ndarray, "F 3 3"], piece: Int[np.ndarray, "F"], reach: float
) -> Int[np.ndarray, "F"]:
    """Pieces that have corners in one cell with a diagonal of ``reach`` as one: quick, and never too many."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    if not reach > 0.0:
        return piece
    cells = np.floor(triangles.reshape(-1, 3) * (np.sqrt(3.0) / reach)).astype(np.int64)
    _, cell = np.unique(cells, axis=0, return_inverse=True)
    count = int(piece.max()) + 1
    row, column = np.repeat(piece, 3), count + cell.ravel()
    size = count + int(cell.max()) + 1
    graph = coo_matrix((np.ones(len(row), bool), (row, column)), (size, size))
    return connected_components(graph, directed=False)[1][piece]


def _surface_shape(triangles: Float[np.ndarray, "F 3 3"]) -> object:
    """A tree of triangles, for exact distances between surfaces."""
    import coal

    shape = coal.BVHModelOBBRSS()
    shape.beginModel(len(triangles), 3 * len(triangles))
    points, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for corner in triangles.reshape(-1, 3):
        points.append(corner)
    for face in range(0, 3 * len(triangles), 3):
        faces.append(coal.Triangle(face, face + 1, face + 2))
    shape.addSubModel(points, faces)
    shape.endModel()
    return shape


ISLAND_CHECKS = (
    CheckSpec(id="V107", level="L1", title="no islands", applies=always, function=check_islands),
)
