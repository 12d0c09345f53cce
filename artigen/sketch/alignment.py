"""Fits the camera that aligns a shape with a picture.

The picture shows one object, cut out from its background. The fit matches the silhouette of the closed shape
and the edges between its parts to those of the picture. It starts from a given view, such as the one that
`artigen.sketch.picture` predicts, or from a grid of directions compared coarsely by the convex hull of the
silhouette. It is then refined on buffers that store the visible face of each pixel.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from artigen.camera import Camera
from artigen.shapes.shape import Shape
from artigen.sketch.overlay import (
    Faces,
    Target,
    find_visible,
    list_faces,
    measure_edges,
    measure_evenness,
    measure_overlap,
    read_target,
)

EDGE, FINE_EDGE = 80, 160
"""Edge lengths (pixels) of the picture used for the search, and for the last refinement."""
BOUNDS = {
    "yaw": (-np.radians(66.0), np.radians(66.0)),
    "pitch": (-np.radians(12.0), np.radians(48.0)),
    "closeness": (0.04, 0.55),
    "zoom": (-0.1, 0.1),
    "aside": (-0.1, 0.1),
    "down": (-0.1, 0.1),
}
"""Search range of each camera parameter."""
STEPS = {"yaw": 0.06, "pitch": 0.05, "closeness": 0.06, "zoom": 0.008, "aside": 0.004, "down": 0.004}
"""Initial step sizes of the refinement."""
YAWS = np.radians(np.linspace(-60.0, 60.0, 21))
PITCHES = np.radians([-10.0, -5.0, -1.0, 3.0, 7.0, 12.0, 18.0, 25.0, 34.0, 44.0])
CLOSENESSES = np.array([0.13, 0.22, 0.36])
"""Grid of views for the first comparison of silhouettes; closeness is half the diagonal over the distance."""
NEAR_YAWS, NEAR_PITCHES, NEAR_CLOSENESSES = np.radians([-3, 0, 3]), np.radians([-2, 0, 2]), (0.8, 1.0, 1.25)
"""Views around the best of these: offsets of yaw and pitch, factors of closeness."""
USUAL_CLOSENESS, CLOSENESS_WEIGHT = 0.22, 0.012
"""Prior on closeness: the usual value, and the penalty for the square of the log ratio to it."""
DIRECTIONS = 20
"""Number of directions in which the hulls of silhouettes are compared."""
STARTS, ROUNDS = 16, 2
"""Number of views kept after the comparison of hulls, and number of those that are refined."""
ALIKE = np.array([np.radians(4.0), np.radians(3.0), 1.0])
"""Differences in yaw, pitch and closeness below which two views count as one start."""
COARSE_TRIES, TRIES = 24, 56
"""Evaluations per refinement: coarse and final."""
SURE = 0.96
"""Overlap below which the camera is refined once more, on the larger picture."""
WEIGHTS = ((0.2, 0.0), (0.2, 0.2), (0.1, 0.1))
"""Weights of colour evenness and of edges relative to silhouette overlap: for the coarse search, the choice
of a direction and the final refinement. Larger weights would rotate a shape that differs from the pictured
one until some of its edges agree."""


@dataclass(frozen=True)
class View:
    """A camera orbiting the object: angles in radians, other values dimensionless."""

    yaw: float
    """Rotation from the front, positive towards +y."""
    pitch: float
    """Elevation above the horizon."""
    closeness: float
    """Half the object's diagonal over the distance of the camera from its centre; 0 is infinitely far."""
    zoom: float = 0.0
    """Logarithm of the object's scale relative to its box in the picture."""
    aside: float = 0.0
    """Shift to the right, as a fraction of the picture's edge."""
    down: float = 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """The camera under which a shape matches a picture best."""

    view: View
    camera: Camera
    """For the picture at its given size; rows of ``axes`` are sheared by the position of the crop."""
    overlap: float
    """Intersection over union of the silhouettes."""


def fit_camera(shape: Shape, picture: Float[np.ndarray, "4 S S"], near: View | None = None) -> Fit:
    """Finds the camera under which the closed shape matches a picture best.

    Args:
        shape: The object, at rest.
        picture: RGBA in [0, 1], premultiplied on black (`artigen.conditioning.image.read_picture`).
        near: Approximate view, clamped to `BOUNDS`. None searches all directions in front.

    Raises:
        PictureError: If the picture shows no object.
    """
    faces = list_faces(shape)
    hull = find_hull(faces.vertices)
    target = read_target(picture, EDGE)
    shown = keep_shown(faces, hull, target)
    first, choose, last = (_scorer(shown, hull, target, weights=weights) for weights in WEIGHTS)
    starts = find_starts(hull, target) if near is None else [_bound(near)]
    ranked = sorted(starts, key=first, reverse=True)
    found = [refine(first, view, 3, COARSE_TRIES) for view in ranked[:ROUNDS]]
    view = refine(last, max(found, key=choose), 6, TRIES)
    fine = read_target(picture, FINE_EDGE)
    if measure_overlap(find_visible(shown, place_camera(view, hull, fine)), fine) < SURE:  # thin parts
        view = refine(_scorer(shown, hull, fine, weights=WEIGHTS[-1]), view, 6, TRIES)
    whole = read_target(picture, picture.shape[1])
    camera = place_camera(view, hull, whole)
    return Fit(view=view, camera=camera, overlap=measure_overlap(find_visible(faces, camera), whole))


def _scorer(
    faces: Faces, hull: Float[np.ndarray, "H 3"], target: Target, *, weights: tuple[float, float]
) -> Callable[[View], float]:
    """Objective of the search for views; ``weights`` are those of colour evenness and of edges."""
    evenness, edges = weights

    def score(view: View) -> float:
        seen = find_visible(faces, place_camera(view, hull, target))
        odd = np.log(view.closeness / USUAL_CLOSENESS)
        out = measure_overlap(seen, target) - CLOSENESS_WEIGHT * odd * odd
        out += evenness * measure_evenness(faces, seen, target)
        return out + (edges * measure_edges(faces, seen, target) if edges else 0.0)

    return score


def keep_shown(faces: Faces, hull: Float[np.ndarray, "H 3"], target: Target) -> Faces:
    """Keeps the faces that are visible from the front; most faces lie inside the object."""
    shown = np.zeros(len(faces.corners), dtype=bool)
    for yaw in np.radians([-60.0, -30.0, 0.0, 30.0, 60.0]):
        for pitch in np.radians([-8.0, 25.0]):
            camera = place_camera(View(yaw=yaw, pitch=pitch, closeness=0.25), hull, target)
            seen = find_visible(faces, camera)
            shown[seen[seen >= 0]] = True
    kept = {name: value[shown] for name, value in vars(faces).items() if name != "vertices"}
    used, corners = np.unique(kept["corners"], return_inverse=True)
    return Faces(vertices=faces.vertices[used], **(kept | {"corners": corners.reshape(-1, 3)}))


def find_hull(points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "H 3"]:
    """Vertices of the convex hull of a point set."""
    from scipy.spatial import ConvexHull

    return points[ConvexHull(points).vertices]


def place_camera(view: View, hull: Float[np.ndarray, "H 3"], target: Target) -> Camera:
    """Camera of a view, scaled and sheared so that the object's box coincides with the picture's."""
    edge = len(target.alpha)
    axes, position = _stand(hull, *(np.array([v]) for v in (view.yaw, view.pitch, view.closeness)))
    axes, position = axes[0], position[0]
    local = (hull - position) @ axes.T
    plane = local[:, :2] / local[:, 2:]
    low, high = plane.min(axis=0), plane.max(axis=0)
    pixel = float(np.exp(-view.zoom) * np.sqrt(np.prod((high - low) / (target.high - target.low))))
    middle = (target.low + target.high) / 2 + edge * np.array([view.aside, view.down])
    shear = (middle - edge / 2) * pixel - (low + high) / 2
    return Camera(
        position=position,
        axes=axes + np.array([[shear[0]], [shear[1]], [0.0]]) * axes[2],
        pixel=pixel,
        width=edge,
        height=edge,
    )


def find_starts(hull: Float[np.ndarray, "H 3"], target: Target) -> list[View]:
    """Distinct views whose silhouette hulls are closest to the picture's."""
    grid = _cross(YAWS, PITCHES, CLOSENESSES)
    best = _spread(grid[np.argsort(_measure_hulls(hull, target, grid), kind="stable")], STARTS)
    steps = _cross(NEAR_YAWS, NEAR_PITCHES, np.array(NEAR_CLOSENESSES))
    near = best[:, None] * np.array([1.0, 1.0, 0.0]) + steps * np.array([1.0, 1.0, 0.0])
    near[:, :, 2] = best[:, None, 2] * steps[:, 2]
    apart = _measure_hulls(hull, target, near.reshape(-1, 3)).reshape(len(best), -1)
    chosen = near[np.arange(len(best)), apart.argmin(axis=1)]
    return [View(yaw=yaw, pitch=pitch, closeness=closeness) for yaw, pitch, closeness in chosen.tolist()]


def _measure_hulls(
    hull: Float[np.ndarray, "H 3"], target: Target, views: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "N"]:
    """Mean distance between the silhouette hull of each view and the picture's, relative to the object's
    size."""
    angles = np.arange(DIRECTIONS) * 2 * np.pi / DIRECTIONS
    ways = np.stack([np.cos(angles), np.sin(angles)])
    rows, columns = np.nonzero(target.alpha > 0.5)
    spots = np.column_stack([columns, rows]) + 0.5
    size = np.sqrt(np.prod(target.high - target.low))
    wanted = ((spots - (target.low + target.high) / 2) @ ways).max(axis=0) + 0.5 * np.abs(ways).sum(axis=0)
    axes, position = _stand(hull, *views.T)
    local = ((hull[None] - position[:, None]) @ np.swapaxes(axes, 1, 2)).astype(np.float32)
    plane = local[:, :, :2] / local[:, :, 2:]
    low, high = plane.min(axis=1), plane.max(axis=1)
    plane = (plane - (low + high)[:, None] / 2) / np.sqrt((high - low).prod(axis=1))[:, None, None]
    reach = (plane @ ways.astype(np.float32)).max(axis=1)
    return np.abs(reach - wanted / size).mean(axis=1)


def refine(score: Callable[[View], float], start: View, count: int, tries: int) -> View:
    """Maximises ``score`` near ``start`` with Nelder-Mead over the first ``count`` parameters of `BOUNDS`."""
    from scipy.optimize import minimize

    names = list(BOUNDS)[:count]
    lows, highs = np.array([BOUNDS[name] for name in names]).T
    steps = np.array([STEPS[name] for name in names])

    def view_of(values: np.ndarray) -> View:
        return replace(start, **dict(zip(names, np.clip(values, lows, highs).tolist(), strict=True)))

    def cost(values: np.ndarray) -> float:
        outside = np.abs(values - np.clip(values, lows, highs)) / steps
        return 0.05 * float(outside.sum()) - score(view_of(values))

    at = np.array([getattr(start, name) for name in names])
    done = minimize(
        cost,
        at,
        method="Nelder-Mead",
        options={
            "initial_simplex": np.vstack([at, at + np.diag(steps)]),
            "maxfev": tries,
            "xatol": 1e-3,
            "fatol": 2e-4,
        },
    )
    return view_of(done.x)


def _bound(view: View) -> View:
    """Clamps a view to `BOUNDS`."""
    return View(**{name: min(max(getattr(view, name), low), high) for name, (low, high) in BOUNDS.items()})


def _stand(
    hull: Float[np.ndarray, "H 3"],
    yaw: Float[np.ndarray, "N"],
    pitch: Float[np.ndarray, "N"],
    closeness: Float[np.ndarray, "N"],
) -> tuple[Float[np.ndarray, "N 3 3"], Float[np.ndarray, "N 3"]]:
    """Axes (right, down, forward) and positions (m) of cameras that look at the object's centre."""
    low, high = hull.min(axis=0), hull.max(axis=0)
    level, zero = np.cos(pitch), np.zeros_like(yaw)
    forward = np.stack([np.cos(yaw) * level, -np.sin(yaw) * level, -np.sin(pitch)], axis=1)
    right = np.stack([-np.sin(yaw), -np.cos(yaw), zero], axis=1)
    axes = np.stack([right, np.cross(forward, right), forward], axis=1)
    distance = np.linalg.norm(high - low) / 2 / closeness
    return axes, (low + high) / 2 - distance[:, None] * forward


def _cross(*values: Float[np.ndarray, "K"]) -> Float[np.ndarray, "N D"]:
    """Cartesian product of values."""
    return np.stack([one.ravel() for one in np.meshgrid(*values, indexing="ij")], axis=1)


def _spread(ranked: Float[np.ndarray, "N 3"], count: int) -> Float[np.ndarray, "K 3"]:
    """The first ``count`` rows (yaw, pitch, closeness) that differ by more than `ALIKE` from each other."""
    chosen: list[np.ndarray] = []
    for row in ranked:
        if all((np.abs(row - other) > ALIKE).any() for other in chosen):
            chosen.append(row)
            if len(chosen) == count:
                break
    return np.array(chosen)
