"""Meshes as exact solids (`manifold3d`): booleans between hulls and meshes, and their volumes."""

from collections.abc import Sequence
from dataclasses import dataclass

import manifold3d
import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from sim_export.errors import OpenMesh
from sim_export.geometry.distances import SampledSurface, distances_to
from sim_export.geometry.hulls import convex_hull, hull_planes, inside_hulls
from sim_export.geometry.sampling import sample_triangles
from sim_export.package import Hull, Mesh

CAVITY_CELLS = 36
"""Grid points along each edge of the box in which cavities are measured."""
SURFACE_SAMPLES = 10_000
"""Points on a solid's surface for measuring how far hulls bulge."""


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Agreement of hulls with a solid.

    ``volume_error`` is the volume of the symmetric difference over the solid's, ``cavity`` the space between
    the solid and its convex hull over the volume of that hull.
    """

    volume_error: float
    cavity: float


def as_solid(mesh: Mesh | Hull) -> manifold3d.Manifold:
    """The enclosed volume of a closed mesh; inner voids stay free.

    Raises:
        OpenMesh: If the mesh does not enclose a volume.
    """
    solid = _manifold(mesh.vertices, mesh.faces)
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


def solid_hull(solid: manifold3d.Manifold) -> Hull:
    """Convex hull of a solid; raises `DegeneratePart` if it is flat."""
    return convex_hull(solid_arrays(solid.hull())[0])


def unite_hulls(hulls: Sequence[Hull]) -> manifold3d.Manifold:
    """The union of hulls."""
    return manifold3d.Manifold.batch_boolean(
        [_manifold(hull.vertices, hull.faces) for hull in hulls], manifold3d.OpType.Add
    )


def measure_fit(union: manifold3d.Manifold, solid: manifold3d.Manifold) -> Fit:
    """Compares the union of hulls with the solid they represent, by exact booleans."""
    volume, outer, common = solid.volume(), solid.hull().volume(), (union ^ solid).volume()
    return Fit(
        volume_error=max((union.volume() + volume - 2.0 * common) / volume, 0.0),
        cavity=max((outer - volume) / outer, 0.0),
    )


def measure_intrusion(
    union: manifold3d.Manifold, solid: manifold3d.Manifold, others: Sequence[manifold3d.Manifold]
) -> float:
    """Volume that the union of hulls, but not the solid they represent, shares with other solids, relative to
    that solid's volume."""
    if not others:
        return 0.0
    excess = union - solid
    return sum((excess ^ other).volume() for other in others) / solid.volume()


def measure_stray(hulls: Sequence[Hull], solid: manifold3d.Manifold) -> Float[np.ndarray, "N"]:
    """Distances (m) of points on the solid's surface from the nearest hull; 0 inside.

    A lower bound. It detects missing feet, thin panels and rims, which have little volume.
    """
    vertices, faces = solid_arrays(solid)
    points = sample_triangles(vertices[faces], 2000)[0]
    outside = np.full(len(points), np.inf)
    for hull in hulls:
        planes = hull_planes(hull)
        outside = np.minimum(outside, (points @ planes[:, :3].T - planes[:, 3]).max(axis=1))
    return np.maximum(outside, 0.0)


def measure_bulge(
    hulls: Sequence[Hull], surface: SampledSurface, near: float = 0.0
) -> Float[np.ndarray, "N"]:
    """Distances (m) of points on the outside of the hulls from a solid's surface.

    Points inside other hulls are not outside. Distances below ``near`` are approximate.
    """
    triangles = np.concatenate([hull.vertices[hull.faces] for hull in hulls])
    owner = np.repeat(np.arange(len(hulls)), [len(hull.faces) for hull in hulls])
    points, face = sample_triangles(triangles, 2000)
    touching = 1e-4 * float(np.linalg.norm(np.ptp(surface.triangles.reshape(-1, 3), axis=0)))
    covered = np.zeros(len(points), dtype=bool)
    for index, hull in enumerate(hulls):
        planes = hull_planes(hull)
        within = (points @ planes[:, :3].T - planes[:, 3]).max(axis=1) <= touching
        covered |= within & (owner[face] != index)
    free = points[~covered]
    if not len(free):
        return np.zeros(0)
    return distances_to(free, surface, near)


def measure_kept_cavity(hulls: Sequence[Hull], solid: manifold3d.Manifold, skin: float) -> float:
    """Share of the space that a solid encloses or shelters and its hulls leave free.

    Measured at grid points inside the solid's convex hull and more than ``skin`` (m) away from the solid; 1
    if these are less than a twentieth of that hull.
    """
    vertices, faces = solid_arrays(solid)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    shares = (np.arange(CAVITY_CELLS) + 0.4871) / CAVITY_CELLS
    x, y, z = (low[axis] + (high - low)[axis] * shares for axis in range(3))
    solid_points = inside_grid(vertices, faces, (x, y, z))
    reach = ndimage.distance_transform_edt(~solid_points, sampling=(high - low) / CAVITY_CELLS)
    grid = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
    points = grid[np.asarray(reach) > skin]
    points = points[inside_hulls(points, (solid_hull(solid),))]
    cell = float(np.prod((high - low) / CAVITY_CELLS))
    if len(points) * cell < 0.05 * solid.hull().volume():
        return 1.0
    return float(np.mean(~inside_hulls(points, hulls)))


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
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
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


def _manifold(vertices: np.ndarray, faces: np.ndarray) -> manifold3d.Manifold:
    # Copies, because manifold3d refuses read-only arrays.
    mesh = manifold3d.Mesh64(
        vert_properties=np.array(vertices, dtype=np.float64, order="C"),
        tri_verts=np.array(faces, dtype=np.uint64, order="C"),
    )
    return manifold3d.Manifold(mesh)
