"""Smooth rounds: the bodies that prisms and wedges of a part approximate, with as many sides as one can see.

A prism between two regular polygons is a cylinder, a cone or a piece of a bent tube, also where these are
stretched to ellipses; equal wedges about an
axis are a ring; and wedges around a polygon are a plate with a round hole.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from artigen.shapes.primitives import Primitive, place_vertices
from sim_export.geometry.triangles import area_normals
from sim_export.package import Mesh

SAGITTA = 0.00005
"""Largest distance (m) of a side from its circle."""
SIDES = (16, 128)
"""Least and largest number of sides of a circle."""
POLYGON = 10
"""Corners from which on a regular polygon stands for a circle."""
EQUAL = 1e-6
"""Distance (m) within which corners are on one circle."""
PARALLEL = 0.02
"""Sine of the angle between the ends of a tube below which it is straight."""


def count_sides(radius: float) -> int:
    """Sides of a circle of a radius (m)."""
    angle = np.arccos(max(1.0 - SAGITTA / radius, 0.0))
    return int(np.clip(4 * np.ceil(np.pi / angle / 4), *SIDES))


def find_sagitta(radius: float, sides: int | None = None) -> float:
    """Distance (m) of the sides of a regular polygon from the circle through its corners; as many sides as
    are shown if None."""
    return radius * (1.0 - float(np.cos(np.pi / (sides or count_sides(radius)))))


@dataclass(frozen=True, kw_only=True, eq=False)
class Bend:
    """A turn about an axis through a pivot (m) by an angle (rad)."""

    pivot: Float[np.ndarray, "3"]
    axis: Float[np.ndarray, "3"]
    angle: float
    reach: float
    """Distance (m) of the outside of the tube from the axis."""

    def turn(self, share: float, arms: Float[np.ndarray, "*N 3"]) -> Float[np.ndarray, "*N 3"]:
        """Vectors turned by a share of the angle."""
        angle = share * self.angle
        along = (arms @ self.axis)[..., None] * self.axis
        return along + np.cos(angle) * (arms - along) + np.sin(angle) * np.cross(self.axis, arms)


@dataclass(frozen=True, kw_only=True, eq=False)
class Tube:
    """A body between two circles or ellipses: centres, and two half axes of each, as vectors (m)."""

    centers: Float[np.ndarray, "2 3"]
    first: Float[np.ndarray, "2 3"]
    second: Float[np.ndarray, "2 3"]
    sides: int | None
    """Of the polygons that stand for the circles; None where the solid is round itself."""

    @property
    def deviation(self) -> float:
        """Largest distance (m) between the smooth body and the solid, whose rims are not broken."""
        rough = 0.0 if self.sides is None else find_sagitta(self.radius, self.sides)
        bend = self.bend
        if bend is not None:
            rough += bend.reach * (1.0 - float(np.cos(bend.angle / 2)))
        return rough + find_sagitta(self.radius)

    @cached_property
    def bend(self) -> "Bend | None":
        """The turn that takes one end to the other; None if they are parallel or differ otherwise."""
        axes = np.cross(self.first, self.second)
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        axis = np.cross(axes[0], axes[1])
        size = float(np.linalg.norm(axis))
        if size < PARALLEL or axes[0] @ axes[1] <= 0.0:
            return None
        axis /= size
        heights = np.array([*(axes * self.centers).sum(axis=1), axis @ self.centers[0]])
        pivot = np.linalg.solve(np.vstack([axes, axis]), heights)
        reach = float(np.linalg.norm(self.centers[0] - pivot)) + self.radius
        bend = Bend(pivot=pivot, axis=axis, angle=float(np.arcsin(size)), reach=reach)
        turned = [bend.turn(1.0, arm[0]) - arm[1] for arm in (self.centers - pivot, self.first, self.second)]
        return bend if np.abs(turned).max() <= EQUAL else None

    @property
    def radius(self) -> float:
        """The larger radius (m)."""
        return float(np.linalg.norm(self.first, axis=1).max())


def find_tube(primitive: Primitive) -> Tube | None:
    """The body that a polytope between two regular polygons approximates; None if it is something else."""
    rings = primitive.rings
    count = len(primitive.vertices) // 2
    if count < POLYGON or rings.shape[1] < count or len(primitive.vertices) != 2 * count:
        return None
    sizes = np.array([len(set(ring)) for ring in rings.tolist()])
    caps = np.flatnonzero(sizes == count)
    if (
        len(caps) != 2
        or len(set(rings[caps[0], :count].tolist()) | set(rings[caps[1], :count].tolist())) != 2 * count
    ):
        return None
    points = place_vertices(primitive)
    normals = primitive.planes[caps, :3] @ primitive.rotation.T
    lower, upper = (list(dict.fromkeys(rings[cap].tolist())) for cap in caps)
    centers = np.stack([points[lower].mean(axis=0), points[upper].mean(axis=0)])
    found = [
        _find_axes(points[corners] - center) for corners, center in zip((lower, upper), centers, strict=True)
    ]
    if found[0] is None or found[1] is None:
        return None
    (corner, ratio), (_, other) = found[0], found[1]
    start = points[lower[corner]]
    sides = [set(ring) for k, ring in enumerate(rings.tolist()) if k not in caps]
    around = [side for side in sides if lower[corner] in side]
    both = set.intersection(*around) & set(upper) if len(around) == 2 else set()
    if len(both) != 1:
        return None
    first = np.stack([start - centers[0], points[both.pop()] - centers[1]])
    second = np.stack([ratio * np.cross(normals[0], first[0]), other * np.cross(-normals[1], first[1])])
    sides_of = None if primitive.kind == "cylinder" else count
    return Tube(centers=centers, first=first, second=second, sides=sides_of)


def _find_axes(arms: Float[np.ndarray, "N 3"]) -> tuple[int, float] | None:
    """The corner at the end of the longer half axis of an ellipse around which corners are spread evenly, and
    the ratio of the shorter one to it; None if they are not. ``arms`` lead from its centre to them in
    order."""
    count, radii = len(arms), np.linalg.norm(arms, axis=1)
    far = int(radii.argmax()) if np.ptp(radii) > EQUAL else 0
    long, short = arms[far], arms[(far + count // 4) % count]
    ratio = 1.0
    if np.ptp(radii) > EQUAL:
        if count % 4 or abs(long @ short) > EQUAL * radii[far]:
            return None
        ratio = float(np.linalg.norm(short) / radii[far])
        across = np.outer(arms @ short / (short @ short), short)
        arms = arms - across + across / ratio
        radii = np.linalg.norm(arms, axis=1)
    steps = np.linalg.norm(np.diff(arms[[*range(count), 0]], axis=0), axis=1)
    return (far, ratio) if max(np.ptp(radii), np.ptp(steps)) <= EQUAL else None


def build_tube(tube: Tube, width: tuple[float, float] = (0.0, 0.0)) -> Mesh:
    """The smooth body of a tube, its rims cut off by ``width`` (m) at either end."""
    sides, bend = count_sides(tube.radius), tube.bend
    turn = np.arange(sides) * 2 * np.pi / sides
    length = float(np.linalg.norm(tube.centers[1] - tube.centers[0]))
    steps = 1 if bend is None else int(np.ceil(bend.angle / (2 * np.pi) * count_sides(bend.reach)))

    def circle(at: float, scale: float = 1.0) -> np.ndarray:
        if bend is not None:
            start = np.cos(turn)[:, None] * tube.first[0] + np.sin(turn)[:, None] * tube.second[0]
            return bend.pivot + bend.turn(at, tube.centers[0] - bend.pivot + scale * start)
        center, first, second = (
            (1 - at) * pair[0] + at * pair[1] for pair in (tube.centers, tube.first, tube.second)
        )
        return center + scale * (np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second)

    rows: list[np.ndarray] = []
    for end, (far, cut) in enumerate(zip((0.0, 1.0), width, strict=True)):
        radius = float(np.linalg.norm(tube.first[end]))
        pair = [circle(far, 1.0 - cut / radius)] if cut else []
        pair.append(circle(abs(far - cut / length)))
        inner = np.linspace(width[0] / length, 1.0 - width[1] / length, steps + 1)[1:-1]
        rows += pair if end == 0 else [*map(circle, inner.tolist()), *pair[::-1]]
    return _skin(rows, closed=False)


def find_ring(primitives: Sequence[Primitive]) -> int:
    """How many of the first primitives are the equal wedges of one full ring; 0 if they are none."""
    first = primitives[0]
    alike = [first]
    for other in primitives[1:]:
        if other.finish != first.finish or not np.array_equal(other.vertices, first.vertices):
            break
        alike.append(other)
    if len(alike) < 6 or len(first.vertices) != 8 or first.kind != "polytope":
        return 0
    turn = alike[1].rotation @ first.rotation.T
    cosine = (np.trace(turn) - 1) / 2
    count = round(2 * np.pi / float(np.arccos(np.clip(cosine, -1.0, 1.0)))) if cosine < 1 - 1e-9 else 0
    if not 6 <= count <= len(alike):
        return 0
    closes = np.allclose(turn @ alike[count - 1].rotation, first.rotation, atol=1e-6)
    return count if closes else 0


def build_ring(wedges: Sequence[Primitive]) -> tuple[Mesh, float] | None:
    """The smooth ring of equal wedges and of their volume, and the largest distance (m) between the two; None
    if it has no hole or the wedges do not face its axis."""
    turn = wedges[1].rotation @ wedges[0].rotation.T
    shift = wedges[1].center - turn @ wedges[0].center
    values, vectors = np.linalg.eigh((turn + turn.T) / 2)
    axis = vectors[:, values.argmax()]
    point = np.linalg.lstsq(np.eye(3) - turn, shift, rcond=None)[0]
    arms = place_vertices(wedges[0]) - point
    heights = arms @ axis
    flat = arms - heights[:, None] * axis
    radii = np.linalg.norm(flat, axis=1)
    low, high = float(heights.min()), float(heights.max())
    profile, same = [], _same_area(len(wedges))
    for level in (low, high):
        here = np.abs(heights - level) < EQUAL
        if here.sum() != 4 or radii[here].min() < 1e-4:
            return None
        inner, outer = np.sort(radii[here])[:2].mean(), radii[here].max()
        profile.append((float(inner) * same, float(outer) * same, level))
    (inner0, outer0, _), (inner1, outer1, _) = profile
    sides = count_sides(max(outer0, outer1))
    angles = np.arange(sides) * 2 * np.pi / sides
    first = flat[radii.argmax()] / radii.max()
    spoke = np.cos(angles)[:, None] * first + np.sin(angles)[:, None] * np.cross(axis, first)
    corners = ((inner0, low), (outer0, low), (outer1, high), (inner1, high))
    rows = [point + radius * spoke + height * axis for radius, height in corners]
    return _skin(rows, closed=True), _round_deviation(float(radii.max()), len(wedges))


def find_plate(primitives: Sequence[Primitive]) -> tuple[int, Mesh, Mesh, float] | None:
    """A plate of wedges around a polygonal hole: how many of the first primitives it is, the plate without
    its hole, the smooth hole, and the largest distance (m) between the two holes."""
    count = 12
    wedges = primitives[:count]
    if len(wedges) < count or any(one.finish != wedges[0].finish for one in wedges):
        return None
    points = [place_vertices(one) for one in wedges]
    low, high = (
        np.min([p.min(axis=0) for p in points], axis=0),
        np.max([p.max(axis=0) for p in points], axis=0),
    )
    every = np.concatenate(points)
    thick = int(np.argmin(high - low))
    across = [k for k in range(3) if k != thick]
    spans = [np.unique(np.round(p[:, thick], 7)) for p in points]
    if any(len(span) != 2 for span in spans):
        return None
    inside = ((every[:, across] > low[across] + EQUAL) & (every[:, across] < high[across] - EQUAL)).all(
        axis=1
    )
    hole = np.unique(np.round(every[inside][:, across], 7), axis=0)
    if len(hole) != count:
        return None
    center = hole.mean(axis=0)
    rim = np.linalg.norm(hole - center, axis=1)
    if np.ptp(rim) > 1e-5:
        return None
    area = count / 2 * rim.mean() ** 2 * np.sin(2 * np.pi / count)
    volume = sum(_volume(p, one.faces) for p, one in zip(points, wedges, strict=True))
    size = high - low
    if abs(volume - size[thick] * (size[across].prod() - area)) > 1e-3 * size.prod():
        return None
    radius = float(rim.mean()) * _same_area(count)
    ends, arm = np.zeros((2, 3)), np.zeros((2, 2, 3))
    ends[:, across] = center
    ends[:, thick] = low[thick] - 0.01, high[thick] + 0.01
    arm[0, :, across[0]] = radius
    arm[1, :, across[1]] = radius
    tube = Tube(centers=ends, first=arm[0], second=arm[1], sides=None)
    return count, _box(low, high), build_tube(tube), _round_deviation(float(rim.mean()), count)


def _same_area(sides: int) -> float:
    """Radius of the circle that has the area of a regular polygon, relative to its corners."""
    return float(np.sqrt(np.sin(2 * np.pi / sides) / (2 * np.pi / sides)))


def _round_deviation(radius: float, sides: int) -> float:
    """Largest distance (m) between a regular polygon and the shown circle of its area."""
    lost = radius * (1.0 - _same_area(sides))
    return max(lost, find_sagitta(radius, sides) - lost) + find_sagitta(radius)


def _box(low: np.ndarray, high: np.ndarray) -> Mesh:
    ring = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    rows = [low + (high - low) * np.column_stack([ring, np.full(4, z)]) for z in (0, 1)]
    return _skin(rows, closed=False)


def _volume(points: np.ndarray, faces: np.ndarray) -> float:
    corners = (points - points.mean(axis=0))[faces]
    return float((area_normals(corners) * corners[:, 0]).sum() / 6.0)


def _skin(rows: Sequence[Float[np.ndarray, "N 3"]], *, closed: bool) -> Mesh:
    """The closed surface through rows of points: each row joined to the next, and the last to the first or
    both ends filled; turned outwards."""
    sides, vertices = len(rows[0]), np.concatenate(rows)
    faces = [quad for pair in _pairs(len(rows), closed=closed) for quad in _band(*pair, sides)]
    if not closed:
        last = (len(rows) - 1) * sides
        for k in range(1, sides - 1):
            faces += [(0, k + 1, k), (last, last + k, last + k + 1)]
    found = np.array(faces)
    if _volume(vertices, found) < 0:
        found = found[:, ::-1]
    return Mesh(vertices=vertices, faces=found)


def _pairs(count: int, *, closed: bool) -> Iterator[tuple[int, int]]:
    for k in range(count if closed else count - 1):
        yield k, (k + 1) % count


def _band(low: int, high: int, sides: int) -> Iterator[tuple[int, int, int]]:
    for k in range(sides):
        a, b = low * sides + k, low * sides + (k + 1) % sides
        c, d = high * sides + k, high * sides + (k + 1) % sides
        yield a, b, d
        yield a, d, c
