"""The plane of an object's fronts: where things of a photograph are on it.

Edges of fronts are horizontal or vertical, so their lines meet in two vanishing points, and these give the
map from the picture to the plane but for a scale and a shift of either axis."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Float

from artigen.camera import look_at, project_points
from artigen.reader.reading import Reading, ReadPart

STEADY = 0.1
"""Weight of the assumption that edges are parallel in the picture, against edges as long as half the fronts'
extent: corners that are 2 % off then turn no small front into a strong perspective."""
AHEAD = 0.15
"""Least depth, relative to that of the middle, at which a corner is still before the camera."""
SLOPES = np.linspace(-1.0, 1.0, 41)
"""Slopes of horizontal edges in the picture (pixels), y down, as tried where only boxes are known."""
ALIKE = 0.08
"""Distance of two edges, as a share of the fronts' height, from which they have nothing to do with each
other."""
OUTSIDE = 0.01
"""Distance, as a share of the picture, by which an object's front may leave its box."""
HALVINGS = 8
"""Steps in which that is found, to half a per cent of the difference."""
PLAIN = 0.03
"""Cost of a slope of one, against an edge that has nothing to do with any other."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Plane:
    """A map from shares of the photograph to coordinates of the plane, x to the right and y down."""

    matrix: Float[np.ndarray, "3 3"]
    """Homography."""

    def locate(self, points: Float[np.ndarray, "*N 2"]) -> Float[np.ndarray, "*N 2"]:
        """Points of the picture on the plane."""
        held = np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1) @ self.matrix.T
        return held[..., :2] / held[..., 2:]

    def show(self, points: Float[np.ndarray, "*N 2"]) -> Float[np.ndarray, "*N 2"]:
        """Inverts `locate`."""
        return Plane(matrix=np.linalg.inv(self.matrix)).locate(points)

    def bound(self, quads: Float[np.ndarray, "N 4 2"]) -> Float[np.ndarray, "N 4"]:
        """Quadrangles, from the upper left clockwise, as left, top, right and bottom on the plane."""
        at = self.locate(quads)
        return np.stack(
            [at[:, [0, 3], 0].mean(1), at[:, :2, 1].mean(1), at[:, 1:3, 0].mean(1), at[:, 2:, 1].mean(1)],
            axis=1,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Sight:
    """Fronts in a picture, and the plane that suits them."""

    plane: Plane
    quads: Float[np.ndarray, "N 4 2"]
    """Corners of the fronts, from the upper left clockwise, as shares of the picture."""


def frame_box(box: Float[np.ndarray, "4"]) -> Float[np.ndarray, "4 2"]:
    """The corners of a box, from the upper left clockwise."""
    left, top, right, bottom = box
    return np.array([(left, top), (right, top), (right, bottom), (left, bottom)])


def guess_sights(reading: Reading, fronts: Sequence[ReadPart]) -> Iterator[Sight]:
    """Ways to see the fronts: that of the outline's view where it is known, with the boxes of the fronts and
    with their corners; else that of the corners where they are known; and several that fit the boxes."""
    extent = np.array(reading.extent, dtype=np.float64)
    quads = np.stack(
        [frame_box(front.box) if front.corners is None else np.asarray(front.corners) for front in fronts]
    )
    if reading.measured:
        plane = map_face(find_face(reading))
        yield Sight(plane=plane, quads=np.stack([frame_box(front.box) for front in fronts]))
        yield Sight(plane=plane, quads=quads)
    elif any(front.corners is not None for front in fronts):
        pixels = quads * extent
        whole = float(
            ((reading.box[2:] - reading.box[:2]) * extent).max() / np.ptp(pixels, axis=(0, 1)).max()
        )
        yield Sight(plane=fit_plane(pixels, extent, whole), quads=quads)
    boxes = np.stack([front.box for front in fronts]) * np.tile(extent, 2)
    yield _see_boxes(boxes, (0.0, 0.0), extent)
    yield _see_boxes(boxes, _find_slopes(boxes), extent)


def _level(
    boxes: Float[np.ndarray, "N 4"], slopes: Float[np.ndarray, "*S 2"]
) -> tuple[Float[np.ndarray, "*S N"], Float[np.ndarray, "*S N"]]:
    """Heights at which the upper and the lower edge of fronts within boxes meet the upright line through the
    middle.

    Args:
        boxes: Left, top, right and bottom (pixels).
        slopes: Of horizontal edges at the upper and at the lower end of all, on that line.
    """
    low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    first = slopes[..., 0, None]
    bend = (slopes[..., 1, None] - first) / (high[1] - low[1])

    def meet(x: Float[np.ndarray, "N"], y: Float[np.ndarray, "N"]) -> Float[np.ndarray, "*S N"]:
        out = x - (low[0] + high[0]) / 2
        return (y - (first - bend * low[1]) * out) / np.maximum(1.0 + bend * out, 1e-3)

    left, top, right, bottom = boxes.T
    return np.maximum(meet(left, top), meet(right, top)), np.minimum(meet(left, bottom), meet(right, bottom))


def _find_slopes(boxes: Float[np.ndarray, "N 4"]) -> tuple[float, float]:
    """Slopes, as of `_level`, for which most edges are level with an edge of another front."""
    slopes = np.stack(np.meshgrid(SLOPES, SLOPES, indexing="ij"), axis=-1)
    tops, bottoms = _level(boxes, slopes)
    edges = np.concatenate([tops, bottoms], axis=-1)
    apart = np.abs(edges[..., :, None] - edges[..., None, :])
    same = np.tile(np.eye(len(boxes), dtype=bool), (2, 2))
    nearest = np.where(same, np.inf, apart).min(axis=-1) / (boxes[:, 3].max() - boxes[:, 1].min())
    cost = np.minimum(nearest / ALIKE, 1.0).mean(axis=-1) + PLAIN * np.abs(slopes).sum(axis=-1)
    cost = np.where((bottoms <= tops).any(axis=-1), np.inf, cost)
    at = np.unravel_index(int(np.argmin(cost)), cost.shape)
    return float(SLOPES[at[0]]), float(SLOPES[at[1]])


def _see_boxes(
    boxes: Float[np.ndarray, "N 4"], slopes: tuple[float, float], extent: Float[np.ndarray, "2"]
) -> Sight:
    """Fronts that fill boxes (pixels), with upright edges, and horizontal ones of these slopes."""
    low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    (middle, _), tall = (low + high) / 2, high[1] - low[1]
    tops, bottoms = _level(boxes, np.array(slopes))
    bend = (slopes[1] - slopes[0]) / tall

    def run(level: Float[np.ndarray, "N"], x: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N 2"]:
        return np.stack([x, level + (slopes[0] + bend * (level - low[1])) * (x - middle)], axis=1)

    left, _, right, _ = boxes.T
    quads = np.stack([run(tops, left), run(tops, right), run(bottoms, right), run(bottoms, left)], axis=1)
    q = slopes[1] - slopes[0]
    point = np.array([middle * q - tall, low[1] * q - slopes[0] * tall, q])
    at, size = _measure(quads)
    rows = np.array([(point[0] - at[0] * q) / size, (point[1] - at[1] * q) / size, q])
    return Sight(plane=_map_to_plane(quads, rows, np.array([0.0, 1.0, 0.0]), extent), quads=quads / extent)


def fit_plane(quads: Float[np.ndarray, "N 4 2"], extent: Float[np.ndarray, "2"], whole: float = 1.0) -> Plane:
    """The plane on which quadrangles (pixels) are as upright rectangles as can be.

    Args:
        quads: From the upper left clockwise.
        extent: Width and height of the picture (pixels).
        whole: Extent of the object over that of all quadrangles: the smaller they are, the less they tell.
    """
    steady = STEADY * max(1.0, whole) ** 2
    middle, size = _measure(quads)
    placed = (quads - middle) / size
    rows = _find_meeting(placed[:, [0, 3]], placed[:, [1, 2]], steady)
    columns = _find_meeting(placed[:, [0, 1]], placed[:, [3, 2]], steady)
    return _map_to_plane(quads, rows, columns, extent)


def _measure(quads: Float[np.ndarray, "N 4 2"]) -> tuple[Float[np.ndarray, "2"], float]:
    points = quads.reshape(-1, 2)
    low, high = points.min(axis=0), points.max(axis=0)
    return (low + high) / 2, float((high - low).max() / 2)


def _find_meeting(
    starts: Float[np.ndarray, "*N 2"], ends: Float[np.ndarray, "*N 2"], steady: float
) -> Float[np.ndarray, "3"]:
    """The homogeneous point that the lines from starts to ends meet in, long ones with more weight."""
    one = np.ones((starts.size // 2, 1))
    lines = np.cross(np.hstack([starts.reshape(-1, 2), one]), np.hstack([ends.reshape(-1, 2), one]))
    return np.linalg.svd(np.vstack([lines, (0.0, 0.0, steady)]))[2][-1]


def _map_to_plane(
    quads: Float[np.ndarray, "N 4 2"],
    rows: Float[np.ndarray, "3"],
    columns: Float[np.ndarray, "3"],
    extent: Float[np.ndarray, "2"],
) -> Plane:
    """The plane with vanishing points of horizontal and of upright edges; parallel edges where these lie too
    near.

    Vanishing points are relative to the middle of the quadrangles (pixels), in halves of their longer extent.
    """
    middle, size = _measure(quads)
    norm = np.array([[1 / size, 0, -middle[0] / size], [0, 1 / size, -middle[1] / size], [0, 0, 1]])
    horizon = np.cross(rows, columns)
    horizon = horizon / (horizon[2] if abs(horizon[2]) > 1e-9 else 1e-9)
    points = ((quads - middle) / size).reshape(-1, 2)
    if (points @ horizon[:2] + 1.0).min() < AHEAD:
        rows, columns = rows * (1, 1, 0), columns * (1, 1, 0)
        horizon = np.array([0.0, 0.0, 1.0])
    across = np.array([columns[1], -columns[0], 0.0])
    along = np.array([rows[1], -rows[0], 0.0])
    across, along = across * (np.sign(across[0]) or 1.0), along * (np.sign(along[1]) or 1.0)
    return Plane(matrix=np.stack([across, along, horizon]) @ norm @ np.diag([*extent, 1.0]))


def find_face(reading: Reading) -> Float[np.ndarray, "4 2"]:
    """Corners of an object's front in the picture (shares), from the upper left clockwise, by its camera and
    size.

    The box around a cuboid of the read size, seen from the read direction, is laid over the read box.
    """
    width, depth, height = reading.size
    yaw, pitch, near = reading.view
    far = float(np.linalg.norm(reading.size)) / 2 / max(near, 1e-3)
    away = far * np.array([-np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), np.sin(pitch)])
    signs = np.array(list(product((-0.5, 0.5), repeat=3)))
    points = project_points(look_at(away, np.zeros(3)), signs * (depth, width, height))[:, :2]
    low, high = points.min(axis=0), points.max(axis=0)
    box = np.asarray(reading.box, dtype=np.float64)
    placed = box[:2] + (points - low) / (high - low) * (box[2:] - box[:2])
    return placed[[3, 1, 0, 2]]  # of x = -0.5: left is +y, up is +z


def map_face(face: Float[np.ndarray, "4 2"]) -> Plane:
    """The plane on which a quadrangle, from the upper left clockwise, is the unit square."""
    rows = []
    for (x, y), (u, v) in zip(face, frame_box(np.array([0.0, 0.0, 1.0, 1.0])), strict=True):
        rows += [(x, y, 1, 0, 0, 0, -u * x, -u * y, -u), (0, 0, 0, x, y, 1, -v * x, -v * y, -v)]
    matrix = np.linalg.svd(np.array(rows))[2][-1].reshape(3, 3)
    return Plane(matrix=matrix * (np.sign(matrix[2] @ [*face[0], 1.0]) or 1.0))


def fit_face(plane: Plane, reading: Reading, hull: Float[np.ndarray, "4"]) -> Float[np.ndarray, "4"]:
    """Left, top, right and bottom of an object's front on the plane of its fronts.

    The front by camera and size is narrowed towards the fronts until the read box holds it, since the fronts
    tell the direction of view better than the camera that was read."""
    guess = plane.bound(find_face(reading)[None])[0]
    guess = np.concatenate([np.minimum(guess[:2], hull[:2]), np.maximum(guess[2:], hull[2:])])
    low, high = np.asarray(reading.box[:2]) - OUTSIDE, np.asarray(reading.box[2:]) + OUTSIDE

    def is_held(face: Float[np.ndarray, "4"]) -> bool:
        at = plane.show(frame_box(face))
        return bool((at >= low).all() and (at <= high).all())

    def widen(face: Float[np.ndarray, "4"], sides: Float[np.ndarray, "4"]) -> Float[np.ndarray, "4"]:
        share, step = 0.0, 1.0
        for _ in range(HALVINGS):
            if share + step <= 1.0 and is_held(face + (share + step) * sides * (guess - face)):
                share += step
            step /= 2
        return face + share * sides * (guess - face)

    face = widen(hull, np.ones(4))
    for side in np.eye(4):
        face = widen(face, side)
    return face
