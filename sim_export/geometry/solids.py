"""Closed meshes as exact solids (`manifold3d`), and the grid points inside of them."""

from collections.abc import Iterable

import manifold3d
import numpy as np
from jaxtyping import Bool, Float, Int

from sim_export.errors import OpenMesh
from sim_export.geometry.hulls import convex_hull
from sim_export.geometry.triangles import area_normals
from sim_export.package import Hull, Mesh


def make_manifold(vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"]) -> manifold3d.Manifold:
    """The solid of a mesh, whose status tells whether it is closed."""
    mesh = manifold3d.Mesh64(  # copies, because manifold3d refuses read-only arrays
        vert_properties=np.array(vertices, dtype=np.float64, order="C"),
        tri_verts=np.array(faces, dtype=np.uint64, order="C"),
    )
    return manifold3d.Manifold(mesh)


def as_solid(mesh: Mesh | Hull) -> manifold3d.Manifold:
    """The enclosed volume of a closed mesh; inner voids stay free.

    Raises:
        OpenMesh: If the mesh does not enclose a volume.
    """
    solid = make_manifold(mesh.vertices, mesh.faces)
    if solid.status() != manifold3d.Error.NoError or solid.is_empty() or solid.volume() <= 0.0:
        raise OpenMesh(
            f"a mesh of {len(mesh.faces)} faces encloses {solid.volume():.3g} m^3 "
            f"({solid.status().name}); it must be closed, with faces counter-clockwise from outside"
        )
    return solid


def solid_arrays(solid: manifold3d.Manifold) -> tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "F 3"]]:
    """Vertices and faces of a solid."""
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties[:, :3]), np.asarray(mesh.tri_verts).astype(np.int64)


def solid_triangles(solid: manifold3d.Manifold) -> Float[np.ndarray, "F 3 3"]:
    """The surface of a solid."""
    vertices, faces = solid_arrays(solid)
    return vertices[faces]


def unite(solids: Iterable[manifold3d.Manifold]) -> manifold3d.Manifold:
    """The union of solids."""
    return manifold3d.Manifold.batch_boolean(list(solids), manifold3d.OpType.Add)


def solid_hull(solid: manifold3d.Manifold) -> Hull:
    """Convex hull of a solid; raises `DegeneratePart` if it is flat."""
    return convex_hull(solid_arrays(solid.hull())[0])


def inside_grid(
    vertices: Float[np.ndarray, "V 3"],
    faces: Int[np.ndarray, "F 3"],
    axes: tuple[Float[np.ndarray, "X"], Float[np.ndarray, "Y"], Float[np.ndarray, "Z"]],
) -> Bool[np.ndarray, "X Y Z"]:
    """Flags the points of a tensor grid (sorted coordinates per axis) that lie inside a closed mesh.

    Winding numbers along z: each triangle contributes to the columns that it covers in projection. Points
    should not lie exactly on the mesh.
    """
    xs, ys, zs = axes
    corners = vertices[faces]  # F 3 3
    normals = area_normals(corners)
    steep = np.abs(normals[:, 2]) > 1e-15
    corners, normals = corners[steep], normals[steep]
    first, last = [], []
    for axis, grid in ((0, xs), (1, ys)):
        first.append(np.searchsorted(grid, corners[:, :, axis].min(axis=1), side="left"))
        last.append(np.searchsorted(grid, corners[:, :, axis].max(axis=1), side="right"))
    counts = [np.maximum(last[axis] - first[axis], 0) for axis in range(2)]
    total = counts[0] * counts[1]
    triangle = np.repeat(np.arange(len(corners)), total)
    local = np.arange(total.sum()) - np.repeat(np.cumsum(total) - total, total)
    i = first[0][triangle] + local // np.maximum(counts[1][triangle], 1)
    j = first[1][triangle] + local % np.maximum(counts[1][triangle], 1)
    at = np.stack([xs[i], ys[j]], axis=1)
    covered = np.ones(len(at), dtype=bool)
    turn = np.sign(normals[:, 2])[triangle]
    for start, end in ((0, 1), (1, 2), (2, 0)):
        a, b = corners[triangle, start, :2], corners[triangle, end, :2]
        # Both triangles at an edge evaluate it from the same end, so that exactly one covers a point.
        flip = (a[:, 0] > b[:, 0]) | ((a[:, 0] == b[:, 0]) & (a[:, 1] > b[:, 1]))
        low, high = np.where(flip[:, None], b, a), np.where(flip[:, None], a, b)
        side = (high[:, 0] - low[:, 0]) * (at[:, 1] - low[:, 1]) - (high[:, 1] - low[:, 1]) * (
            at[:, 0] - low[:, 0]
        )
        covered &= (np.where(side >= 0.0, 1.0, -1.0) * np.where(flip, -1.0, 1.0)) == turn
    triangle, i, j, at = triangle[covered], i[covered], j[covered], at[covered]
    rise = np.einsum("ij,ij->i", normals[triangle, :2], corners[triangle, 0, :2] - at) / normals[triangle, 2]
    level = np.searchsorted(zs, corners[triangle, 0, 2] + rise)
    winding = np.zeros((len(xs), len(ys), len(zs) + 1), dtype=np.int32)
    np.add.at(winding, (i, j, level), -np.sign(normals[triangle, 2]).astype(np.int32))
    return np.cumsum(winding, axis=2)[:, :, :-1] > 0
