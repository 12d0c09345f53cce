"""A shape over a picture: the camera of a view, and the visible face of each pixel."""

from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from artigen.camera import Camera
from artigen.datasets.mesh_raster import SeenFaces, rasterize_mesh
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
CLOSEST, FARTHEST = 0.55, 0.04
"""Limits of `View.closeness`."""


class PictureError(ArtigenError):
    """A picture that shows no object."""


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


@dataclass(frozen=True)
class View:
    """A camera orbiting the object."""

    yaw: float
    """Rotation from the front (radians), positive towards +y."""
    pitch: float
    """Elevation above the horizon (radians)."""
    closeness: float
    """Half the object's diagonal over the distance of the camera from its centre; 0 is infinitely far."""


def list_faces(shape: Shape) -> Faces:
    """The triangles of a closed shape with their part, finish and side."""
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
        axis = np.abs(normals).argmax(axis=1)
        columns["vertices"].append(points)
        columns["corners"].append(corners + count)
        columns["normals"].append(normals)
        columns["roles"].append(roles)
        columns["parts"].append(np.full(len(corners), part))
        columns["primitives"].append(np.full(len(corners), index))
        columns["sides"].append(2 * axis + (normals[np.arange(len(axis)), axis] < 0))
        count += len(points)
    return Faces(**{name: np.concatenate(values) for name, values in columns.items()})


def place_camera(view: View, points: Float[np.ndarray, "N 3"], alpha: Float[np.ndarray, "S S"]) -> Camera:
    """The camera of a view, scaled and sheared so that the box of the points is that of what alpha shows.

    Raises:
        PictureError: If alpha shows nothing.
    """
    covered = alpha > 0.5
    if not covered.any():
        raise PictureError(
            "the picture shows nothing: its alpha is 0 everywhere; cut the object out and keep it opaque, or "
            "give a picture without alpha"
        )
    rows, columns = np.flatnonzero(covered.any(axis=1)), np.flatnonzero(covered.any(axis=0))
    first, last = np.array([columns[0], rows[0]]), np.array([columns[-1], rows[-1]]) + 1
    level, edge = np.cos(view.pitch), len(alpha)
    forward = np.array([np.cos(view.yaw) * level, -np.sin(view.yaw) * level, -np.sin(view.pitch)])
    right = np.array([-np.sin(view.yaw), -np.cos(view.yaw), 0.0])
    axes = np.stack([right, np.cross(forward, right), forward])
    low, high = points.min(axis=0), points.max(axis=0)
    distance = np.linalg.norm(high - low) / 2 / np.clip(view.closeness, FARTHEST, CLOSEST)
    position = (low + high) / 2 - distance * forward
    local = (points - position) @ axes.T
    plane = local[:, :2] / local[:, 2:]
    least, most = plane.min(axis=0), plane.max(axis=0)
    pixel = float(np.sqrt(np.prod((most - least) / (last - first))))
    shear = ((first + last) / 2 - edge / 2) * pixel - (least + most) / 2
    axes[:2] += shear[:, None] * forward
    return Camera(position=position, axes=axes, pixel=pixel, width=edge, height=edge)


def find_visible(faces: Faces, camera: Camera) -> SeenFaces:
    """The visible face of each pixel that shows any."""
    ahead = np.einsum("fk,fk->f", faces.normals, camera.position - faces.vertices[faces.corners[:, 0]])
    rows = np.flatnonzero(ahead > 0)
    seen = rasterize_mesh(faces.vertices, faces.corners[rows], camera)
    return replace(seen, face=rows[seen.face])
