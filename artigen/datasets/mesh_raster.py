"""Finds the visible triangle of each pixel in pictures of any mesh, with Intel Embree."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

# embreex is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

BACK = 1e-4
"""Share of the depth by which the back of a triangle counts as behind its front: where a source draws both
sides of a sheet, each with its own material, the side that faces the camera is visible."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Pinhole:
    """A camera; pixel (column, row) covers [column, column + 1] x [row, row + 1] from the upper left."""

    position: Float[np.ndarray, "3"]
    axes: Float[np.ndarray, "3 3"]
    """Rows point to the right, down and forward in the picture; they need not be orthogonal."""
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
    """Barycentric weights of the corners of the face at the visible point."""
    depth: Float[np.ndarray, "N"]
    """Depth along the viewing direction."""


def rasterize_mesh(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], camera: Pinhole
) -> SeenFaces:
    """The nearest triangle at the centre of every pixel, visible from either side."""
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    right, down, forward = np.linalg.inv(camera.axes).T
    across, along = (
        camera.pixel * (np.arange(size) + 0.5 - size / 2) for size in (camera.width, camera.height)
    )
    # Depth one along each ray, so that the distance of a hit in lengths of the ray is its depth.
    rays = along[:, None, None] * down + (across[:, None] * right + forward)
    rays = np.ascontiguousarray(rays.reshape(-1, 3), dtype=np.float32)
    corners = vertices[faces] - camera.position
    edges = corners[:, 1:] - corners[:, :1]
    away = np.einsum("fk,fk->f", np.cross(edges[:, 0], edges[:, 1]), corners[:, 0]) > 0
    depth, face = np.full(len(rays), np.inf), np.full(len(rays), -1)
    u, v = np.zeros((2, len(rays)))
    for side, behind in ((~away, 1.0), (away, 1.0 + BACK)):
        if not side.any():
            continue
        scene = rtcore_scene.EmbreeScene(robust=True)
        TriangleMesh(scene, corners[side].astype(np.float32))
        found = scene.run(np.zeros_like(rays), rays, output=True)
        nearer = np.flatnonzero((found["primID"] >= 0) & (behind * found["tfar"] < depth))
        face[nearer] = np.flatnonzero(side)[found["primID"][nearer]]
        u[nearer], v[nearer], depth[nearer] = (found[name][nearer] for name in ("u", "v", "tfar"))
    pixel = np.flatnonzero(face >= 0)
    weights = np.stack([1.0 - u - v, u, v], axis=1)
    return SeenFaces(pixel=pixel, face=face[pixel], weights=weights[pixel], depth=depth[pixel])


def project_points(
    points: Float[np.ndarray, "N 3"], camera: Pinhole
) -> tuple[Float[np.ndarray, "N 2"], Float[np.ndarray, "N"]]:
    """Column and row (pixels) and depth of points."""
    local = (points - camera.position) @ camera.axes.T
    middle = np.array([camera.width / 2, camera.height / 2])
    return local[:, :2] / (camera.pixel * local[:, 2:]) + middle, local[:, 2]
