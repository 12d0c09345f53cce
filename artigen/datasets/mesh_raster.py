"""Finds the visible triangle of each pixel in pictures of any mesh, with Intel Embree."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.camera import Camera, pixel_rays

# embreex is a compiled module without stubs.
# pyright: reportAttributeAccessIssue=false

BACK = 1e-4
"""Share of the depth by which the back of a triangle counts as behind its front: where a source draws both
sides of a sheet, each with its own material, the side that faces the camera is visible."""


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
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], camera: Camera
) -> SeenFaces:
    """The nearest triangle at the centre of every pixel, visible from either side."""
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    rays = pixel_rays(camera).reshape(-1, 3)
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
