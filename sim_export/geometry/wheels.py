"""Replaces wheels with cylinders, so that they do not rest on a flat side."""

from collections.abc import Sequence
from dataclasses import replace

import manifold3d
import numpy as np
from jaxtyping import Float

from artigen.types import Asset, Joint
from sim_export.geometry.distances import MAX_P99, surface_distances
from sim_export.geometry.hulls import convex_hull, hull_volume
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.solids import as_solid, unite
from sim_export.geometry.tidy import tidy_mesh
from sim_export.package import Hull, Mesh

STEEPEST_AXLE = 0.5
"""Largest vertical component of an axle; a wheel on a steeper one is a swivel that carries a wheel."""
SEGMENTS = 24
"""Sides of the cylinder; a corner points down, so that it stands on an edge."""
LEAST_ALIKE = 0.6
"""Smallest ratio of the volumes of mesh and cylinder, in either direction; excludes forks."""
WELL = 0.003
"""Clearance (m) made around a wheel in other parts."""
NEAR = 1.5
"""Distance (voxels) from the lowest point of the object within which wheels are extended down to it."""
SAMPLES = 2000
"""Points by which the distance of a cylinder from its wheel is measured."""


def fit_width(cylinder: Mesh, joint: Joint, scale: float, triangles: Float[np.ndarray, "F 3 3"]) -> Hull:
    """A cylinder about the axle ``joint`` that is as wide as a wheel's triangles (m).

    One made of cells is wider, most of all on an oblique axle.
    """
    origin, axis = scale * np.asarray(joint.origin), np.asarray(joint.axis)
    arms = cylinder.vertices - origin
    radius = float(np.linalg.norm(arms - np.outer(arms @ axis, axis), axis=1).max())
    along = (triangles.reshape(-1, 3) - origin) @ axis
    return _cylinder(origin, axis, (float(along.min()), float(along.max())), radius)


def is_open(triangles: Float[np.ndarray, "F 3 3"], cylinder: Hull, diagonal: float) -> bool:
    """Whether a cylinder would close openings of a wheel with these triangles, such as those between spokes:
    1 % of it is farther from them than check V103 allows. All lengths in metres."""
    points, _ = sample_triangles(cylinder.vertices[cylinder.faces], SAMPLES)
    distances = surface_distances(points, triangles, 4 * SAMPLES)
    return float(np.percentile(distances, 99)) > MAX_P99 * diagonal


def round_wheels(asset: Asset, meshes: Sequence[Mesh]) -> tuple[tuple[Mesh, ...], tuple[str, ...]]:
    """Replaces the meshes of wheels with cylinders about their axles and cuts wells around them; records
    changes.

    Args:
        asset: Parts and joints; unit-cube lengths.
        meshes: Closed mesh of every part (metres), in order.
    """
    floor = min(float(mesh.vertices[:, 2].min()) for mesh in meshes)
    voxel = asset.scale / (64 if asset.voxels is None else asset.voxels.resolution)
    out, records = list(meshes), []
    wells: dict[int, manifold3d.Manifold] = {}
    for index, (part, mesh) in enumerate(zip(asset.parts, meshes, strict=True)):
        if part.label != "wheel" or part.joint.type != "continuous":
            continue
        axis, origin = np.asarray(part.joint.axis), np.asarray(part.joint.origin) * asset.scale
        if abs(axis[2]) > STEEPEST_AXLE:  # a swivel
            continue
        along = (mesh.vertices - origin) @ axis
        across = np.linalg.norm(mesh.vertices - origin - np.outer(along, axis), axis=1)
        radius = (float(across.max()) + float(np.median(across))) / 2
        drop = float(origin[2] - floor) / float(np.hypot(axis[0], axis[1]))
        if abs(drop - radius) <= NEAR * voxel:
            radius = drop
        cylinder = _cylinder(origin, axis, (float(along.min()), float(along.max())), radius)
        share = as_solid(mesh).volume() / hull_volume(cylinder)
        if not LEAST_ALIKE <= share <= 1.0 / LEAST_ALIKE:
            continue
        out[index] = replace(mesh, vertices=cylinder.vertices, faces=cylinder.faces)
        records.append(f"{part.name}: became a cylinder of {2000 * radius:.1f} mm about its axle")
        reach = (float(along.min()) - WELL, float(along.max()) + WELL)
        wells[index] = as_solid(_cylinder(origin, axis, reach, radius + WELL))
    for index, well in wells.items():
        for other in sorted(set(range(len(out))) - wells.keys()):
            hollow = _without(out[other], well)
            if hollow is not None:
                out[other] = hollow
                records.append(f"{asset.parts[other].name}: makes room for {asset.parts[index].name}")
    return tuple(out), tuple(records)


def _without(mesh: Mesh, well: manifold3d.Manifold) -> Mesh | None:
    """Subtracts a well from a mesh and drops the resulting fragments; `None` if they do not overlap or no
    clean mesh remains."""
    solid = as_solid(mesh)
    shared = (solid ^ well).volume()
    if shared <= 0.0 or shared > 0.85 * solid.volume():
        return None
    pieces = (solid - well).decompose()
    kept = [piece for piece in pieces if piece.volume() > 0.1 * shared]
    return tidy_mesh(unite(kept), mesh)


def _cylinder(
    origin: Float[np.ndarray, "3"], axis: Float[np.ndarray, "3"], span: tuple[float, float], radius: float
) -> Hull:
    """A cylinder with its corners at this radius, one of them straight below the axis."""
    down = np.array([0.0, 0.0, -1.0]) + axis[2] * axis
    if np.linalg.norm(down) < 1e-6:
        down = np.array([1.0, 0.0, 0.0])
    down /= np.linalg.norm(down)
    side = np.cross(axis, down)
    angles = 2.0 * np.pi * np.arange(SEGMENTS) / SEGMENTS
    ring = origin + radius * (np.outer(np.cos(angles), down) + np.outer(np.sin(angles), side))
    return convex_hull(np.concatenate([ring + end * axis for end in span]))
