"""A shape rendered over a picture: the visible face of each pixel, and measures of agreement.

Agreement has three terms: overlap of the silhouettes, colours that are even where the shape shows one finish
on one side, and edges where the shape has edges.
"""

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.camera import Camera
from artigen.datasets.mesh_raster import rasterize_mesh
from artigen.errors import ArtigenError
from artigen.shapes.primitives import place_vertices
from artigen.shapes.shape import Shape
from artigen.shapes.surfaces.textures import LINED

SIDES = len(("+x", "-x", "+y", "-y", "+z", "-z"))
"""Number of sides of an object, which are counted in this order."""
FRONT = 1
"""The side that faces -x."""
SOLID = 0.95
"""Alpha above which a pixel shows the object alone."""
NOISE = 0.02
"""Colour differences (sRGB) below which colours count as even."""
STEP = 0.003
"""Offset (m) between parallel faces of a part beyond which they show an edge between them."""


class PictureError(ArtigenError):
    """A picture that shows nothing to align."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Faces:
    """All triangles of a closed shape (metres, object frame)."""

    vertices: Float[np.ndarray, "V 3"]
    corners: Int[np.ndarray, "F 3"]
    normals: Float[np.ndarray, "F 3"]
    """Outward, unit."""
    roles: Int[np.ndarray, "F"]
    """Index into the shape's finishes."""
    parts: Int[np.ndarray, "F"]
    primitives: Int[np.ndarray, "F"]
    """Index counted through all parts."""
    sides: Int[np.ndarray, "F"]
    """Direction of the normal by its largest component: 0 to 5 for +x, -x, +y, -y, +z, -z."""
    regions: Int[np.ndarray, "F"]
    """Faces with no visible edge between them share a region: same part, finish and plane, or side if
    curved."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Target:
    """A target picture at one resolution, with the bounding box of the object (pixels)."""

    rgb: Float[np.ndarray, "S S 3"]
    alpha: Float[np.ndarray, "S S"]
    inside: Bool[np.ndarray, "S S"]
    """Pixels that are covered together with their whole neighbourhood."""
    slopes: Float[np.ndarray, "S S"]
    """Blurred colour gradient inside the object, 0 to 1."""
    low: Float[np.ndarray, "2"]
    high: Float[np.ndarray, "2"]


def list_faces(shape: Shape) -> Faces:
    """The triangles of a closed shape with their part, finish, side and region."""
    numbers = {role: index for index, (role, _) in enumerate(shape.finishes)}
    columns: dict[str, list[np.ndarray]] = defaultdict(list)
    count = 0
    owned = [(number, p) for number, part in enumerate(shape.parts) for p in part.primitives]
    for index, (part, primitive) in enumerate(owned):
        points, corners = place_vertices(primitive), primitive.faces
        a, b, c = (points[corners[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        roles = np.full(len(corners), numbers[primitive.finish])
        if primitive.lining is not None:
            roles[normals @ np.array(primitive.lined_side) > LINED] = numbers[primitive.lining]
        columns["vertices"].append(points)
        columns["corners"].append(corners + count)
        columns["normals"].append(normals)
        columns["roles"].append(roles)
        columns["parts"].append(np.full(len(corners), part))
        columns["primitives"].append(np.full(len(corners), index))
        count += len(points)
    joined = {name: np.concatenate(values) for name, values in columns.items()}
    sides, regions = _find_regions(joined)
    return Faces(**joined, sides=sides, regions=regions)


def read_target(picture: Float[np.ndarray, "4 S S"], edge: int) -> Target:
    """Scales a picture to ``edge`` pixels and finds its object and edges.

    Raises:
        PictureError: If the picture shows no object.
    """
    from PIL import Image
    from scipy.ndimage import binary_erosion, sobel, uniform_filter

    channels = [np.asarray(channel, dtype=np.float32) for channel in picture]
    if channels[0].shape != (edge, edge):
        fill = Image.Resampling.BOX
        channels = [np.asarray(Image.fromarray(c).resize((edge, edge), fill)) for c in channels]
    alpha = channels[3]
    covered = alpha > 0.5
    if not (picture[3] > 0.5).any():
        raise PictureError(
            "the picture shows nothing: its alpha is 0 everywhere; cut the object out and keep it opaque, or "
            "give a picture without alpha"
        )
    rgb = np.stack(channels[:3], axis=2) / np.maximum(alpha, 1e-3)[..., None]
    inside = np.asarray(binary_erosion(covered, np.ones((3, 3))))
    strength = np.hypot(sobel(rgb, axis=0), sobel(rgb, axis=1)).max(axis=2) / 4.0
    finest = picture[3] > 0.5
    rows, columns = np.flatnonzero(finest.any(axis=1)), np.flatnonzero(finest.any(axis=0))
    share = edge / picture.shape[1]
    return Target(
        rgb=rgb,
        alpha=alpha,
        inside=inside,
        slopes=uniform_filter(np.where(inside, strength / (strength + 0.06), 0.0).astype(np.float32), 3),
        low=share * np.array([columns[0], rows[0]]),
        high=share * np.array([columns[-1] + 1, rows[-1] + 1]),
    )


def find_visible(faces: Faces, camera: Camera) -> Int[np.ndarray, "S S"]:
    """Index of the visible face at each pixel, -1 for background."""
    ahead = np.einsum("fk,fk->f", faces.normals, camera.position - faces.vertices[faces.corners[:, 0]])
    rows = np.flatnonzero(ahead > 0)
    seen = rasterize_mesh(faces.vertices, faces.corners[rows], camera)
    out = np.full(camera.width * camera.height, -1)
    out[seen.pixel] = rows[seen.face]
    return out.reshape(camera.height, camera.width)


def measure_overlap(seen: Int[np.ndarray, "S S"], target: Target) -> float:
    """Intersection over union of the silhouettes, slightly blurred so that thin parts overlap."""
    from scipy.ndimage import uniform_filter

    mask, alpha = uniform_filter((seen >= 0).astype(np.float32), 3), uniform_filter(target.alpha, 3)
    return float(np.minimum(mask, alpha).sum() / max(float(np.maximum(mask, alpha).sum()), 1e-9))


def measure_evenness(faces: Faces, seen: Int[np.ndarray, "S S"], target: Target) -> float:
    """Share of the picture's variance that one colour for each finish on each side explains, at most 1."""
    chosen = target.inside & (seen >= 0)
    label = (SIDES * faces.roles + faces.sides)[seen[chosen]]
    if not len(label):
        return 0.0
    colors, floor = target.rgb[chosen], len(label) * NOISE**2
    counts = np.maximum(np.bincount(label), 1)
    apart = np.sum((colors - colors.mean(axis=0)) ** 2)
    left = 0.0
    for channel in colors.T:
        left += np.sum((channel - (np.bincount(label, channel) / counts)[label]) ** 2)
    return float(1.0 - (left + floor) / (apart + floor))


def measure_edges(faces: Faces, seen: Int[np.ndarray, "S S"], target: Target) -> float:
    """Correlation of the shape's part edges with the picture's edges, -1 to 1."""
    from scipy.ndimage import uniform_filter

    lines = uniform_filter(find_lines(faces, seen), 3)[target.inside]
    return _correlate(lines, target.slopes[target.inside])


def find_lines(faces: Faces, seen: Int[np.ndarray, "S S"]) -> Float[np.ndarray, "S S"]:
    """1 at the pixels on both sides of an edge between regions of the object, 0 elsewhere."""
    region = np.where(seen >= 0, faces.regions[seen], -1)
    out = np.zeros(seen.shape, dtype=np.float32)
    for one, other in ((np.s_[:, 1:], np.s_[:, :-1]), (np.s_[1:], np.s_[:-1])):
        differs = (region[one] != region[other]) & (region[one] >= 0) & (region[other] >= 0)
        out[one][differs] = 1.0
        out[other][differs] = 1.0
    return out


def _correlate(one: Float[np.ndarray, "N"], other: Float[np.ndarray, "N"]) -> float:
    if not len(one):
        return 0.0
    a, b = one - one.mean(), other - other.mean()
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 1e-9 else 0.0


def _find_regions(columns: dict[str, np.ndarray]) -> tuple[Int[np.ndarray, "F"], Int[np.ndarray, "F"]]:
    """Sides and regions of faces."""
    normals, points = columns["normals"], columns["vertices"][columns["corners"][:, 0]]
    rows = np.arange(len(normals))
    axis = np.abs(normals).argmax(axis=1)
    sides = 2 * axis + (normals[rows, axis] < 0)
    flat = np.abs(normals[rows, axis]) > 0.999
    depth = np.where(flat, np.round(points[rows, axis] / STEP), 0).astype(np.int64)
    keys = np.stack([columns["parts"], columns["roles"], sides, depth, flat], axis=1)
    return sides, np.unique(keys, axis=0, return_inverse=True)[1].ravel()
