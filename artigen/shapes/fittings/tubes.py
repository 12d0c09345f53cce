"""Round tubes and rods: straight, leaning and bent by a quarter: spouts, lever handles, bails, lamp arms.

All have `SEGMENTS` sides in the same orientation, so that the pieces of a tube meet corner to corner.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from artigen.shapes.primitives import SEGMENTS, Primitive, Vector, as_vector, cylinder, polygon, polytope


def lean_rod(start: Vector, end: Vector, radii: float | tuple[float, float], finish: str) -> Primitive:
    """A round rod between two points (m), whose ends are perpendicular to the axis closest to its direction.

    Args:
        start: Centre of one end.
        end: Centre of the other.
        radii: Radius of its edges in the planes of its ends: one for both, or one each.
        finish: Role of the finish.
    """
    ends, sizes = np.array([start, end], dtype=float), np.broadcast_to(np.asarray(radii, dtype=float), 2)
    way = np.abs(ends[1] - ends[0])
    axis = int(way.argmax())
    if np.delete(way, axis).max() < 1e-9 and sizes[0] == sizes[1]:
        return cylinder(start, end, float(sizes[0]), finish)
    rim = _trace_circle(axis)
    corners = [point + size * rim for point, size in zip(ends, sizes, strict=True)]
    return polytope(np.concatenate(corners), finish)


def bend_elbow(
    center: Vector, ways: tuple[Vector, Vector], bend: float, radius: float, finish: str, *, pieces: int = 3
) -> tuple[Primitive, ...]:
    """A quarter of a bent tube.

    Args:
        center: Centre of the bend (m).
        ways: Unit vectors along two axes, from the centre to the middle of each end.
        bend: Distance of the tube's middle from the centre (m), at least the tube's radius.
        radius: Radius of the tube's edges (m).
        finish: Role of the finish.
        pieces: Number of straight pieces.
    """
    first, second = np.array(ways)
    if (np.abs(second).argmax() - np.abs(first).argmax()) % 3 != 1:  # the same pieces in both directions
        first, second = second, first
    aside = np.cross(first, second)
    along, across = polygon().T[:, :, None]
    rings = []
    for angle in np.linspace(0.0, np.pi / 2, pieces + 1):
        out = np.cos(angle) * first + np.sin(angle) * second
        ring = (bend + radius * along) * out + radius * across * aside
        rings.append(np.array(center) + ring)
    return tuple(polytope(np.concatenate(pair), finish) for pair in pairwise(rings))


def lay_pipe(
    path: Sequence[Vector], radius: float, bend: float, finish: str, *, pieces: int = 3
) -> tuple[Primitive, ...]:
    """A tube of legs along the axes with round bends between them.

    Args:
        path: Ends of the legs (m).
        radius: Radius of the tube (m).
        bend: Radius of the bends (m), to the tube's middle.
        finish: Role of the finish.
        pieces: Number of straight pieces per bend.
    """
    points = np.array(path, dtype=float)
    ways = np.diff(points, axis=0)
    lengths = np.linalg.norm(ways, axis=1)
    ways /= lengths[:, None]
    out: list[Primitive] = []
    for k, way in enumerate(ways):
        start = points[k] + (bend * way if k else 0.0)
        end = points[k + 1] - (bend * way if k + 1 < len(ways) else 0.0)
        if float((end - start) @ way) > 1e-9:
            out.append(cylinder(as_vector(start), as_vector(end), radius, finish))
        if k + 1 < len(ways):
            after = ways[k + 1]
            center = points[k + 1] + bend * (after - way)
            sides = (as_vector(-after), as_vector(way))
            out += bend_elbow(as_vector(center), sides, bend, radius, finish, pieces=pieces)
    return tuple(out)


def _trace_circle(axis: int) -> Float[np.ndarray, "N 3"]:
    """Corners of a circle of radius 1 about an axis."""
    return np.roll(np.column_stack([polygon(), np.zeros(SEGMENTS)]), axis + 1, axis=1)
