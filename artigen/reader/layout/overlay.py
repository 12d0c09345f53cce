"""`lay_over`: the camera that lays an object over the photograph it was built from."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares, linear_sum_assignment

from artigen.camera import Camera, project_points
from artigen.kind import kinds
from artigen.reader.boxes import overlap_boxes
from artigen.reader.layout.frontal import find_face, list_outline, place_camera, read_shape
from artigen.reader.reading import Reading
from artigen.shapes.shape import Shape, ShapePart

MET = 0.4
"""Overlap (intersection over union) from which a front of the photograph is met by one of the object."""
CORNER = 0.5
"""Weight of the corners of a front against its box."""
STEEPEST, NEAREST = 1.2, 0.8
"""Largest pitch (radians), and largest half of the object's diagonal over its distance."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Overlay:
    """An object over its photograph."""

    camera: Camera
    """In the photograph, in pixels of its extent."""
    parts: tuple[tuple[str, Float[np.ndarray, "4"]], ...]
    """Label and box (shares of the photograph) of every door and drawer of the object."""
    met: tuple[float, ...]
    """Of every front of the reading: its overlap with the one of the object that meets it; 0 for none."""

    @property
    def good(self) -> bool:
        """Whether every front of the reading is met by one of the same label."""
        return all(overlap >= MET for overlap in self.met)


def lay_over(reading: Reading, shape: Shape) -> Overlay:
    """Fits a camera to the fronts of a reading: that of `Reading.view`, turned, moved and scaled until the
    fronts of an object lie best on those that were read.

    Args:
        reading: What was read.
        shape: The object that was built of it.
    """
    low, high = shape.bounds()
    extent = np.array(reading.extent, dtype=np.float64)
    fronts = [part for part in shape.parts if part.label in ("door", "drawer")]
    clouds = [list_outline(part) for part in fronts]
    whole = np.stack(np.meshgrid(*np.stack([low, high]).T, indexing="ij"), axis=-1).reshape(8, 3)
    seen = [(part.label, np.asarray(part.box)) for part in reading.fronts]
    frame, scale = (
        np.tile(reading.box[:2], 2),
        np.tile(np.maximum(reading.box[2:] - reading.box[:2], 1e-3), 2),
    )
    built = read_shape(shape, view=reading.view)
    pairs = match_fronts(seen, [(part.label, part.box * scale + frame) for part in built.fronts])
    targets = [np.asarray(reading.box)] + [seen[i][1] for i, _ in pairs]
    points = [whole] + [clouds[j] for _, j in pairs]
    # furniture has its size from its fronts, which are read better than its own box, or from its outline
    sized = bool(pairs) and not reading.measured and kinds()[shape.category].trade == "furniture"
    weights = np.array([0.0 if sized else 1.0] + [1.0] * len(pairs))
    faces = [
        (find_face(fronts[j]), np.asarray(corners))
        for i, j in pairs
        if (corners := reading.fronts[i].corners) is not None and _is_upright(fronts[j])
    ]
    size = float((scale[:2] * extent).max())
    view = np.array([reading.view[0], reading.view[1], np.log(max(reading.view[2], 0.02))])

    def place(values: Float[np.ndarray, "6"]) -> Camera:
        near = (
            values[0],
            float(np.clip(values[1], -STEEPEST, STEEPEST)),
            min(float(np.exp(values[2])), NEAREST),
        )
        camera = place_camera(low, high, near)
        pixel = camera.pixel * np.exp(values[3])
        middle = values[4:6] * size * pixel
        axes = camera.axes + np.outer([1.0, 0.0, 0.0], camera.axes[2]) * middle[0]
        axes = axes + np.outer([0.0, 1.0, 0.0], camera.axes[2]) * middle[1]
        return Camera(
            position=camera.position,
            axes=axes,
            pixel=pixel,
            width=reading.extent[0],
            height=reading.extent[1],
        )

    def miss(values: Float[np.ndarray, "6"]) -> Float[np.ndarray, "R"]:
        camera = place(values)
        errors = [
            weight * (_bound(camera, cloud) - target * np.tile(extent, 2)) / size
            for cloud, target, weight in zip(points, targets, weights, strict=True)
        ]
        errors += [
            CORNER * (project_points(camera, face)[:, :2] - corners * extent).ravel() / size
            for face, corners in faces
        ]
        return np.concatenate(errors)

    start = np.concatenate([view, [0.0, 0.0, 0.0]])
    for _ in range(2):  # to the size, then to the place of the object's box
        box = _bound(place(start), whole)
        aim = reading.box * np.tile(extent, 2)
        start[3] += np.log((box[2:] - box[:2]).max() / (aim[2:] - aim[:2]).max())
        box = _bound(place(start), whole)
        start[4:6] += ((aim[:2] + aim[2:]) - (box[:2] + box[2:])) / 2 / size
    camera = place(least_squares(miss, start, max_nfev=60).x)
    boxes = [_bound(camera, cloud) / np.tile(extent, 2) for cloud in clouds]
    parts = tuple((part.label, box) for part, box in zip(fronts, boxes, strict=True))
    return Overlay(camera=camera, parts=parts, met=rate_fronts(seen, parts))


def match_fronts(
    seen: Sequence[tuple[str, Float[np.ndarray, "4"]]], built: Sequence[tuple[str, Float[np.ndarray, "4"]]]
) -> list[tuple[int, int]]:
    """Pairs of fronts of one label with the greatest overlap in total, each front in one pair."""
    pairs: list[tuple[int, int]] = []
    for label in ("door", "drawer"):
        own, other = ([k for k, (name, _) in enumerate(one) if name == label] for one in (seen, built))
        if own and other:
            first, last = np.stack([seen[k][1] for k in own]), np.stack([built[k][1] for k in other])
            apart = np.abs(first[:, None] - last[None]).sum(axis=-1)
            rows, columns = linear_sum_assignment(apart - overlap_boxes(first, last))
            pairs += [(own[row], other[column]) for row, column in zip(rows, columns, strict=True)]
    return pairs


def rate_fronts(
    seen: Sequence[tuple[str, Float[np.ndarray, "4"]]], built: Sequence[tuple[str, Float[np.ndarray, "4"]]]
) -> tuple[float, ...]:
    """Overlap of every seen front with the one that is its pair; 0 for none."""
    met = [0.0] * len(seen)
    for i, j in match_fronts(seen, built):
        met[i] = float(overlap_boxes(seen[i][1][None], built[j][1][None])[0, 0])
    return tuple(met)


def _is_upright(part: ShapePart) -> bool:
    """Whether a front stands, as lids do not."""
    return int(np.argmin(np.ptp(part.bounds(), axis=0))) != 2


def _bound(camera: Camera, points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "4"]:
    """Left, top, right and bottom of points in the picture (pixels)."""
    at = project_points(camera, points)[:, :2]
    return np.concatenate([at.min(axis=0), at.max(axis=0)])
