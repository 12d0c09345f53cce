"""Rasterises any mesh in numpy: the visible triangle of each pixel."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

PIXELS = 2_000_000
"""Pixels of triangles that are looked at together, to bound the memory."""
BACK = 1e-4
"""Share of the depth by which the back of a triangle stands behind its front: where a source draws both
sides of a sheet, each with its own material, one sees the side that faces the camera."""
NOTHING = np.iinfo(np.int64).max


@dataclass(frozen=True, kw_only=True, eq=False)
class Pinhole:
    """A camera; pixel (column, row) covers [column, column + 1] x [row, row + 1] from the upper left."""

    position: Float[np.ndarray, "3"]
    axes: Float[np.ndarray, "3 3"]
    """Rows point to the right, down and forward in the picture."""
    pixel: float
    """Edge of a pixel at depth one."""
    width: int
    height: int


@dataclass(frozen=True, kw_only=True, eq=False)
class SeenFaces:
    """Visible faces of the covered pixels, in the order of the pixels."""

    pixel: Int[np.ndarray, "N"]
    """Row times width plus column."""
    face: Int[np.ndarray, "N"]
    weights: Float[np.ndarray, "N 3"]
    """Of the corners of the face: they give the point seen, and whatever is linear on the face."""
    depth: Float[np.ndarray, "N"]
    """Along the viewing direction."""


def rasterize_mesh(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], camera: Pinhole
) -> SeenFaces:
    """The nearest triangle at the middle of every pixel, seen from either side.

    Args:
        vertices: All in front of the camera.
        faces: Triangles of any orientation.
        camera: From where, and how finely.
    """
    screen, depth = project_points(vertices, camera)
    edges = vertices[faces[:, 1:]] - vertices[faces[:, :1]]
    outward = np.cross(edges[:, 0], edges[:, 1])
    faces_away = np.einsum("fk,fk->f", outward, camera.position - vertices[faces[:, 0]]) < 0
    behind = 1.0 + BACK * faces_away
    planes = _find_planes(screen[faces])
    # Over its depth, each weight is linear in the picture; so is their sum, one over the depth there.
    shares = planes / depth[faces][..., None]
    nearness = shares.sum(axis=1)
    nearest = np.full(camera.width * camera.height, NOTHING)
    for face, column, row in _list_pixels(screen[faces], planes, camera):
        plane = nearness[face]
        far = behind[face] / (plane[:, 0] * (column + 0.5) + plane[:, 1] * (row + 0.5) + plane[:, 2])
        key = (far.astype(np.float32).view(np.int32).astype(np.int64) << 32) | face
        np.minimum.at(nearest, row * camera.width + column, key)
    pixel = np.flatnonzero(nearest != NOTHING)
    face = nearest[pixel] & 0xFFFFFFFF
    middles = np.column_stack([pixel % camera.width + 0.5, pixel // camera.width + 0.5, np.ones(len(pixel))])
    share = np.einsum("nkc,nc->nk", shares[face], middles)
    total = share.sum(axis=1)
    return SeenFaces(pixel=pixel, face=face, weights=share / total[:, None], depth=1.0 / total)


def project_points(
    points: Float[np.ndarray, "N 3"], camera: Pinhole
) -> tuple[Float[np.ndarray, "N 2"], Float[np.ndarray, "N"]]:
    """Column and row (pixels) and depth of points."""
    local = (points - camera.position) @ camera.axes.T
    middle = np.array([camera.width / 2, camera.height / 2])
    return local[:, :2] / (camera.pixel * local[:, 2:]) + middle, local[:, 2]


def _find_planes(corners: Float[np.ndarray, "F 3 2"]) -> Float[np.ndarray, "F 3 3"]:
    """Barycentric weight of each corner as ``a column + b row + c``; none where a triangle is a line."""
    after, last = np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)
    across = after[..., 1] - last[..., 1]
    along = last[..., 0] - after[..., 0]
    planes = np.stack([across, along, -across * after[..., 0] - along * after[..., 1]], axis=2)
    area = (planes[:, 0] * np.column_stack([corners[:, 0], np.ones(len(corners))])).sum(axis=1)
    return planes / np.where(area == 0.0, np.inf, area)[:, None, None]


def _list_pixels(
    corners: Float[np.ndarray, "F 3 2"], planes: Float[np.ndarray, "F 3 3"], camera: Pinhole
) -> Iterator[tuple[Int[np.ndarray, "M"], Int[np.ndarray, "M"], Int[np.ndarray, "M"]]]:
    """Triangle, column and row of every pixel whose middle is in a triangle, in portions."""
    first = np.maximum(np.ceil(corners.min(axis=1) - 0.5), 0).astype(np.int64)
    last = np.minimum(np.floor(corners.max(axis=1) - 0.5), [camera.width - 1, camera.height - 1]).astype(
        np.int64
    )
    flat = (planes == 0.0).all(axis=(1, 2))
    rows = np.where((last[:, 0] >= first[:, 0]) & ~flat, np.maximum(last[:, 1] - first[:, 1] + 1, 0), 0)
    face, step = _count_up(rows)
    row = first[face, 1] + step
    a, b, c = np.moveaxis(planes[face], 2, 0)
    rest = b * (row + 0.5)[:, None] + c
    with np.errstate(divide="ignore", invalid="ignore"):
        edge = -rest / a - 0.5  # the column at which the weight passes zero
    low = np.where(a > 0.0, np.ceil(edge), -np.inf).max(axis=1)
    high = np.where(a < 0.0, np.floor(edge), np.inf).min(axis=1)
    outside = ((a == 0.0) & (rest < 0.0)).any(axis=1)
    start = np.maximum(low, first[face, 0]).astype(np.int64)
    stop = np.minimum(high, last[face, 0]).astype(np.int64)
    counts = np.where(outside, 0, np.maximum(stop - start + 1, 0))
    portion = np.cumsum(counts) // PIXELS
    for number in np.unique(portion).tolist():
        chosen = np.flatnonzero(portion == number)
        span, step = _count_up(counts[chosen])
        span = chosen[span]
        yield face[span], start[span] + step, row[span]


def _count_up(counts: Int[np.ndarray, "N"]) -> tuple[Int[np.ndarray, "M"], Int[np.ndarray, "M"]]:
    """For ``counts[n]`` steps of each n: n, and the number of the step."""
    index = np.repeat(np.arange(len(counts)), counts)
    return index, np.arange(len(index)) - np.repeat(np.cumsum(counts) - counts, counts)
