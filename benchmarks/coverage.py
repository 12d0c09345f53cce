"""Measures how much of real objects the pieces of a sketch can represent.

    python benchmarks/coverage.py ../shared/data                    # partnet_mobility/ and splits.json
    python benchmarks/coverage.py ../shared/data --per-category 5   # the first few of each category

Every mesh file of an object is split into connected components. A component is represented by the best piece
of `artigen.sketch.pieces`, or by several: planes along the axes cut it where that helps most, into at most
``--most`` pieces. Surface is covered if it is within 1 % of the object's longest edge of the pieces; pieces
are true where they are that close to the component. Faces shared by two pieces of a component do not count.

Prints Markdown: shares by category, the worst objects, and the uncovered surface by the name of its
component. Real objects are PartNet-Mobility folders and not part of this repository.
"""

import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import tyro
from jaxtyping import Float
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, KDTree, QhullError

from artigen.datasets.partnet_mobility import ReaderConfig, read_object
from artigen.datasets.partnet_surface import FaceTable
from artigen.shapes.primitives import Primitive, contains, place_vertices
from artigen.sketch.piece import Piece, across
from artigen.sketch.pieces import build_piece

NEAR = 0.01
"""Distance, as a share of the longest edge, within which surface is covered."""
SMALL = 0.03
"""Components with a shorter diagonal are omitted, because nearly any box around them is within `NEAR`."""
THIN = 0.002
"""Minimum edge of a fitted piece, so that sheets without thickness become boards."""
DENSITY = 40_000
"""Sample points per unit of area of a component: 5 mm apart on an object of one metre."""
FEW, MANY = 400, 120_000
"""Minimum and maximum number of points on a component."""
LOOKED_AT = 800
"""Number of these points that are used for fitting pieces."""
CUTS = 5
"""Number of planes per axis at which a cut is tried."""
GOOD = 0.97
"""Score from which a fit is not cut further."""
LEAST_AREA = 0.003
"""Share of an object's surface below which a component is not cut."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    data: tyro.conf.Positional[Path]
    """Folder with partnet_mobility/ and splits.json."""
    most: int = 10
    """Maximum number of pieces of one component."""
    per_category: int | None = None
    """Objects per category; default: all."""
    worst: int = 25
    """Number of rows of the tables of objects and names."""
    out: Path | None = None
    """JSON file for the numbers of every component."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Component:
    """Connected triangles of one mesh file, in the unit cube."""

    name: str
    area: float
    points: Float[np.ndarray, "N 3"]
    """Points spread evenly over the surface."""
    vertices: Float[np.ndarray, "V 3"]


@dataclass(frozen=True, kw_only=True)
class Said:
    """Scores of the pieces of a component."""

    name: str
    area: float
    kinds: tuple[str, ...]
    one: float
    """Share of the surface that the best single piece covers."""
    one_true: float
    """Share of that piece's surface that lies on the component."""
    several: float
    several_true: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """Some points of a component and the piece that represents them."""

    points: Float[np.ndarray, "N 3"]
    kind: str
    solids: tuple[Primitive, ...]
    score: float


def split_components(name: str, table: FaceTable, rng: np.random.Generator) -> Iterator[Component]:
    """The connected components of a mesh with merged vertices."""
    _, where = np.unique(np.round(table.vertices, 5), axis=0, return_inverse=True)
    faces = where.reshape(-1)[table.faces]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    count = int(where.max()) + 1
    group = connected_components(coo_matrix((np.ones(len(edges)), edges.T), shape=(count, count)))[1]
    owner = group[faces[:, 0]]
    for index in np.unique(owner):
        corners = table.corners[owner == index]
        vertices = np.unique(np.round(corners.reshape(-1, 3), 5), axis=0)
        area = float(_areas(corners).sum())
        if np.linalg.norm(np.ptp(vertices, axis=0)) >= SMALL and area > 0:
            count = int(np.clip(DENSITY * area, FEW, MANY))
            points = _spread(corners, count, rng)
            yield Component(name=name, area=area, points=points, vertices=vertices)


def _areas(corners: Float[np.ndarray, "F 3 3"]) -> Float[np.ndarray, "F"]:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.linalg.norm(normals, axis=1) / 2


def _spread(
    corners: Float[np.ndarray, "F 3 3"], count: int, rng: np.random.Generator
) -> Float[np.ndarray, "N 3"]:
    """Points on triangles, even by area."""
    areas = np.cumsum(_areas(corners))
    chosen = np.searchsorted(areas, (np.arange(count) + rng.uniform(size=count)) / count * areas[-1])
    chosen = corners[np.minimum(chosen, len(corners) - 1)]
    a, b = np.sqrt(rng.uniform(size=count)), rng.uniform(size=count)
    weights = np.stack([1 - a, a * (1 - b), a * b], axis=1)
    return np.einsum("nk,nkd->nd", weights, chosen)


def propose_pieces(points: Float[np.ndarray, "N 3"]) -> Iterator[Piece]:
    """Candidate pieces of every kind for points, each in the points' bounds."""
    low, high = points.min(axis=0), points.max(axis=0)
    thin = np.maximum(THIN - (high - low), 0.0) / 2
    low, high = low - thin, high + thin
    bounds = (*low.tolist(), *high.tolist())
    shortest = float((high - low).min())
    for bevel in (0.0, 0.12 * shortest, 0.28 * shortest):
        yield _piece("box", (*bounds, bevel))
    for axis in range(3):
        u, v = across(axis)
        flat = points[:, [u, v]]
        if 0.8 < (high - low)[u] / (high - low)[v] < 1.25:
            yield _piece("cylinder", bounds, axis=axis)
        share = (points[:, axis] - low[axis]) / (high - low)[axis]
        ends = [_end_bounds(flat, share), _end_bounds(flat, 1 - share)]
        yield from _propose_frusta(axis, low, high, ends)
        yield from _propose_prisms(axis, flat, low, high)
        if axis != 1:
            yield from _propose_rings(axis, points, low, high)
    if (high - low)[0] < 0.3 * min((high - low)[1:]):
        middle = (low + high) / 2
        radius = float(np.hypot(*(points - middle)[:, 1:].T).min())
        if radius > NEAR:
            yield _piece("plate", (*bounds, float(middle[1]), float(middle[2]), radius))


def _piece(kind, numbers: Sequence[float], *, axis: int = 0, sides: int = 0) -> Piece:
    return Piece(kind=kind, finish="body", numbers=tuple(numbers), axis=axis, sides=sides)


def _end_bounds(flat: Float[np.ndarray, "N 2"], share: Float[np.ndarray, "N"]) -> Float[np.ndarray, "4"]:
    """Bounds of the points near the start of an axis; ``share`` is the position of each point along it."""
    near = flat[share < 0.06] if (share < 0.06).sum() > 3 else flat
    bottom, top = near.min(axis=0), near.max(axis=0)
    thin = np.maximum(THIN - (top - bottom), 0.0) / 2
    return np.concatenate([bottom - thin, top + thin])


def _propose_frusta(
    axis: int,
    low: Float[np.ndarray, "3"],
    high: Float[np.ndarray, "3"],
    ends: list[Float[np.ndarray, "4"]],
) -> Iterator[Piece]:
    """A frustum with four sides and a round one, from the rectangles at both ends."""
    u, v = across(axis)
    for sides in (4, 16):
        first, last = ends
        if sides > 4:
            squares = []
            for end in ends:
                middle, radius = (end[:2] + end[2:]) / 2, float((end[2:] - end[:2]).mean()) / 2
                squares.append(np.concatenate([middle - radius, middle + radius]))
            first, last = squares
        bottom, top = low.copy(), high.copy()
        bottom[u], bottom[v], top[u], top[v] = last
        yield _piece("frustum", (*bottom.tolist(), *top.tolist(), *first.tolist()), axis=axis, sides=sides)


def _propose_prisms(
    axis: int, flat: Float[np.ndarray, "N 2"], low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]
) -> Iterator[Piece]:
    """Prisms with four corners, two of them in opposite corners of the bounds, for both diagonals."""
    u, v = across(axis)
    try:
        hull = flat[ConvexHull(flat).vertices]
    except QhullError:
        return
    for flipped in (False, True):
        start, end = low.copy(), high.copy()
        if flipped:
            start[v], end[v] = high[v], low[v]
        run = (end - start)[[u, v]]
        side = (hull - start[[u, v]]) @ np.array([-run[1], run[0]])
        corners = hull[side.argmin()], hull[side.argmax()]
        if flipped:
            corners = corners[::-1]
        first, second = (corner.tolist() for corner in corners)
        yield _piece("prism", (*start.tolist(), *end.tolist(), *first, *second), axis=axis)


def _propose_rings(
    axis: int, points: Float[np.ndarray, "N 3"], low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]
) -> Iterator[Piece]:
    u, v = across(axis)
    size = high - low
    if not 0.9 < size[u] / size[v] < 1.1:
        return
    radius = float(np.hypot(*(points - (low + high) / 2)[:, [u, v]].T).min())
    outer = float(size[u] + size[v]) / 4
    if NEAR < radius < 0.97 * outer:
        numbers = (*low.tolist(), *high.tolist(), radius, radius, outer)
        yield _piece("ring", numbers, axis=axis, sides=16)


def distance(points: Float[np.ndarray, "N 3"], solids: Sequence[Primitive]) -> Float[np.ndarray, "N"]:
    """Distance from points to the surfaces of convex solids, slightly underestimated beside edges."""
    away = np.full(len(points), np.inf)
    for solid in solids:
        own = (points - solid.center) @ solid.rotation
        if solid.kind == "cylinder":
            aside = np.hypot(own[:, 0], own[:, 1]) - solid.size[0] / 2
            height = np.maximum(aside, np.abs(own[:, 2]) - solid.size[2] / 2)
        else:
            height = (own @ solid.planes[:, :3].T + solid.planes[:, 3]).max(axis=1)
        away = np.minimum(away, np.abs(height))
    return away


def surface_points(solids: Sequence[Primitive], rng: np.random.Generator) -> Float[np.ndarray, "N 3"]:
    """Points on convex solids, without those inside another of the solids."""
    found = []
    for index, solid in enumerate(solids):
        corners = place_vertices(solid)[solid.faces]
        count = int(np.clip(DENSITY / 4 * _areas(corners).sum() / len(solids), 24, 300))
        points = _spread(corners, count, rng)
        free = np.ones(len(points), dtype=bool)
        for other in (*solids[:index], *solids[index + 1 :]):
            free &= ~contains(other, points, margin=-THIN)
        found.append(points[free])
    return np.concatenate(found)


def rate(
    points: Float[np.ndarray, "N 3"], tree: KDTree, solids: Sequence[Primitive], rng: np.random.Generator
) -> tuple[float, float]:
    """Share of the points that the solids cover, and share of the solids' surface on the component."""
    covered = float((distance(points, solids) <= NEAR).mean())
    own = surface_points(solids, rng)
    true = float((tree.query(own, distance_upper_bound=1.0)[0] <= NEAR).mean()) if len(own) else 0.0
    return covered, true


def join(covered: float, true: float) -> float:
    """Harmonic mean of two scores."""
    return 2 * covered * true / max(covered + true, 1e-9)


def fit_best(
    points: Float[np.ndarray, "N 3"], tree: KDTree, rng: np.random.Generator, *, boxes: bool = False
) -> Fit:
    """The piece with the best score; with ``boxes``, only the box around the points."""
    best = Fit(points=points, kind="none", solids=(), score=-1.0)
    for piece in propose_pieces(points):
        try:
            solids = build_piece(piece)
        except (ValueError, QhullError):  # a candidate that is no solid
            continue
        score = join(*rate(points, tree, solids, rng))
        if score > best.score:
            best = Fit(points=points, kind=piece.kind, solids=solids, score=score)
        if boxes or best.score >= GOOD:
            break
    return best


def cut_fit(
    fit: Fit, vertices: Float[np.ndarray, "V 3"], tree: KDTree, rng: np.random.Generator
) -> tuple[Fit, Fit] | None:
    """Splits the points by the plane across an axis with the largest gain for two boxes."""
    best: tuple[float, np.ndarray] | None = None
    for axis in range(3):
        for level in _levels(fit.points[:, axis], vertices[:, axis]):
            beyond = fit.points[:, axis] > level
            if min(beyond.sum(), (~beyond).sum()) < 12:
                continue
            halves = [fit_best(fit.points[side], tree, rng, boxes=True) for side in (~beyond, beyond)]
            score = sum(half.score * len(half.points) for half in halves) / len(fit.points)
            if best is None or score > best[0]:
                best = score, beyond
    if best is None:
        return None
    first, second = (fit_best(fit.points[side], tree, rng) for side in (~best[1], best[1]))
    return first, second


def _levels(along: Float[np.ndarray, "N"], corners: Float[np.ndarray, "V"]) -> list[float]:
    """Heights of cuts: beside the corners between the ends; if there are many, an even selection."""
    low, high = along.min(), along.max()
    inner = np.unique(np.round(corners[(corners > low + THIN) & (corners < high - THIN)], 3))
    if len(inner) > CUTS:
        inner = inner[np.linspace(0, len(inner) - 1, CUTS).astype(int)]
    return [float(level + step) for level in inner for step in (-THIN, THIN)]


def say(component: Component, most: int, rng: np.random.Generator) -> Said:
    """Scores of one piece and of several pieces for a component."""
    tree = KDTree(component.points)
    points = component.points[:: -(-len(component.points) // LOOKED_AT)]
    whole = fit_best(points, tree, rng)
    one = rate(points, tree, whole.solids, rng)
    fits, done = [whole], []
    while fits and len(fits) + len(done) < most:
        fits.sort(key=lambda fit: (1 - fit.score) * len(fit.points))
        worst = fits.pop()
        halves = None if worst.score >= GOOD else cut_fit(worst, component.vertices, tree, rng)
        if halves is None:
            done.append(worst)
        else:
            fits += halves
    fits += done
    several = rate(points, tree, [solid for fit in fits for solid in fit.solids], rng)
    if join(*several) < join(*one):
        fits, several = [whole], one
    return Said(
        name=component.name,
        area=component.area,
        kinds=tuple(fit.kind for fit in fits),
        one=one[0],
        one_true=one[1],
        several=several[0],
        several_true=several[1],
    )


def measure_object(folder: Path, most: int) -> list[Said]:
    """Measures every component of a real object; deterministic."""
    rng = np.random.default_rng(0)
    found = read_object(folder, ReaderConfig(samples=1000))
    components = [
        component
        for visual, table in zip(found.visuals, found.tables, strict=True)
        for component in split_components(visual.name.rsplit("-", 1)[0], table, rng)
    ]
    least = LEAST_AREA * sum(component.area for component in components)
    return [say(component, most if component.area > least else 1, rng) for component in components]


def weigh(said: Sequence[Said]) -> tuple[float, float, float, float]:
    """The four shares of several components, by area."""
    areas = np.array([one.area for one in said])
    shares = np.array([(one.one, one.one_true, one.several, one.several_true) for one in said])
    mean = areas @ shares / areas.sum()
    return float(mean[0]), float(mean[1]), float(mean[2]), float(mean[3])


def _cells(said: Sequence[Said]) -> str:
    return " | ".join(f"{100 * share:.1f} %" for share in weigh(said))


def tabulate(measured: dict[str, dict[str, list[Said]]], worst: int) -> list[str]:
    """Tables of categories, objects and names as Markdown."""
    head = "one piece covers | it is true | several cover | they are true |"
    lines = [f"| category | objects | components | {head}", "|---|---|---|---|---|---|---|"]
    every = {key: said for objects in measured.values() for key, said in objects.items()}
    for name, objects in (*sorted(measured.items()), ("all", every)):
        # Every object has the same weight, regardless of how much of its inside is modelled.
        shares = np.mean([weigh(said) for said in objects.values()], axis=0)
        cells = " | ".join(f"{100 * share:.1f} %" for share in shares)
        lines.append(f"| {name} | {len(objects)} | {sum(map(len, objects.values()))} | {cells} |")
    lines += ["", f"| object | {head} worst components |", "|---|---|---|---|---|---|"]

    def score(said: list[Said]) -> float:
        return join(*weigh(said)[2:])

    for key in sorted(every, key=lambda key: score(every[key]))[:worst]:
        missing = sorted(every[key], key=lambda one: one.area * (join(one.several, one.several_true) - 1))[:3]
        told = ", ".join(f"{one.name} {join(one.several, one.several_true):.2f}" for one in missing)
        lines.append(f"| {key} | {_cells(every[key])} | {told} |")
    lines += ["", f"| name | objects | {head} share of all that is missed |", "|---|---|---|---|---|---|---|"]
    named: dict[str, list[Said]] = {}
    holders: dict[str, set[str]] = {}
    for key, said in every.items():
        whole = sum(one.area for one in said)
        for one in said:
            label = f"{key.split('/')[0]}: {one.name}"
            named.setdefault(label, []).append(replace(one, area=one.area / whole))
            holders.setdefault(label, set()).add(key)

    def missed(said: list[Said]) -> float:
        return sum(one.area * (1 - join(one.several, one.several_true)) for one in said)

    total = sum(missed(said) for said in named.values())
    for label in sorted(named, key=lambda label: -missed(named[label]))[:worst]:
        said = named[label]
        lines.append(
            f"| {label} | {len(holders[label])} | {_cells(said)} | {100 * missed(said) / total:.1f} % |"
        )
    return lines


def main(options: Options) -> int:
    """Measures the training and validation objects of all categories and prints tables."""
    splits = json.loads((options.data / "splits.json").read_text())
    measured: dict[str, dict[str, list[Said]]] = {}
    for key in sorted((*splits["train"], *splits["val"]), key=int):
        folder = options.data / "partnet_mobility" / key
        category = json.loads((folder / "meta.json").read_text())["model_cat"]
        held = measured.setdefault(category, {})
        if options.per_category is None or len(held) < options.per_category:
            held[f"{category}/{key}"] = measure_object(folder, options.most)
            print(f"{category}/{key} done", file=sys.stderr, flush=True)
    if options.out is not None:
        options.out.parent.mkdir(parents=True, exist_ok=True)
        rows = {
            key: [asdict(one) for one in said] for held in measured.values() for key, said in held.items()
        }
        options.out.write_text(json.dumps(rows))
    print("\n".join(tabulate(measured, options.worst)))
    return 0


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
