"""Compares converted objects with their source: surfaces in several states, free space.

Used by conversion.py. All distances in voxels (1/64 of the object's longest edge).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.ndimage import binary_dilation, label
from scipy.optimize import linear_sum_assignment
from scipy.spatial import ConvexHull, KDTree

from artigen.datasets.partnet_mobility import read_object
from artigen.kinematics import displacements, movable_parts
from artigen.types import Asset, Joint
from artigen.voxels.voxelize import voxelize
from sim_export.files.read import read_package
from sim_export.geometry.hulls import hull_planes
from sim_export.motion.kinematics import driven_joints, link_displacements
from sim_export.package import Mesh, SimPackage

STATES = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
SOURCE_POINTS = 400_000
EXPORT_POINTS = 150_000
PROBES = 30_000
MIN_CAVITY_CELLS = 200


@dataclass(frozen=True, kw_only=True)
class Likeness:
    """Mean distances (voxels), closed and over the open states, and the share of free space kept."""

    key: str
    forth_closed: float
    back_closed: float
    forth_open: float
    back_open: float
    cavity_cells: int
    cavity_kept: float
    unmatched_joints: int


def measure_likeness(source_folder: Path, package_folder: Path) -> Likeness:
    """Compares a package with the object it came from.

    ``forth`` is from points of the exported visual to the source's surface, ``back`` the other way.
    The surface that is measured to is a dense sample (spacing 0.3 to 0.5 voxel), so both are upper bounds.
    """
    asset = read_object(source_folder).asset
    package = read_package(package_folder)
    pairs, unmatched = match_joints(asset, package)
    rng = np.random.default_rng(0)
    exported, links = sample_visuals(package, EXPORT_POINTS, rng)
    surface = asset.surface
    assert surface is not None
    rows = rng.choice(len(surface.points), min(SOURCE_POINTS, len(surface.points)), replace=False)
    points = surface.points[rows].astype(np.float64) * asset.scale
    owners = surface.part_ids[rows]
    voxel = asset.scale / 64
    forth, back = [], []
    for state in STATES:
        moved = pose_source(asset, pairs, state, points, owners)
        shown = pose_package(package, pairs, state, exported, links)
        tree = KDTree(moved, balanced_tree=False, compact_nodes=False)
        forth.append(tree.query(shown[:PROBES])[0].mean() / voxel)
        back.append(KDTree(shown).query(moved[:PROBES])[0].mean() / voxel)
    cells, kept = free_space(asset, package)
    return Likeness(
        key=package_folder.name,
        forth_closed=float(forth[0]),
        back_closed=float(back[0]),
        forth_open=float(np.mean(forth[1:])),
        back_open=float(np.mean(back[1:])),
        cavity_cells=cells,
        cavity_kept=kept,
        unmatched_joints=unmatched,
    )


def match_joints(asset: Asset, package: SimPackage) -> tuple[list[tuple[int, Joint]], int]:
    """Movable parts and package joints that mean the same: same kind, nearest in place."""
    movable = movable_parts(asset)
    joints = list(driven_joints(package.joints))
    if not movable or not joints:
        return [], len(movable)
    centers = {link.name: link_center(package, link.name) for link in package.links}
    followers = {joint.follows: joint.child for joint in package.joints if joint.follows is not None}
    cost = np.full((len(movable), len(joints)), 1e3)
    for row, index in enumerate(movable):
        part = asset.parts[index]
        for column, joint in enumerate(joints):
            center = centers[followers.get(joint.name, joint.child)]
            if part.joint.type == joint.kind and center is not None:
                cost[row, column] = np.linalg.norm(part.box[0] * asset.scale - center)
    rows, columns = linear_sum_assignment(cost)
    pairs = [
        (movable[r], joints[c]) for r, c in zip(rows, columns, strict=True) if cost[r, c] < 0.2 * asset.scale
    ]
    return pairs, len(movable) - len(pairs)


def link_center(package: SimPackage, name: str) -> np.ndarray | None:
    """Centre of the box of a link's leading part."""
    link = next(link for link in package.links if link.name == name)
    corners = [
        visual.mesh.vertices
        for visual in link.visuals
        if isinstance(visual.mesh, Mesh) and visual.part == link.parts[0]
    ]
    if not corners:
        return None
    points = np.concatenate(corners)
    return (points.min(axis=0) + points.max(axis=0)) / 2


def sample_visuals(
    package: SimPackage, count: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Points uniform by area on all visual meshes, and the link of each."""
    corners, owners = [], []
    for index, link in enumerate(package.links):
        for visual in link.visuals:
            assert isinstance(visual.mesh, Mesh), "likeness is about visuals made from voxels"
            corners.append(visual.mesh.vertices[visual.mesh.faces])
            owners.append(np.full(len(visual.mesh.faces), index))
    triangles, link_ids = np.concatenate(corners), np.concatenate(owners)
    edges = triangles[:, 1:] - triangles[:, :1]
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    chosen = rng.choice(len(triangles), count, p=area / area.sum())
    u, v = rng.random((2, count, 1))
    flip = u + v > 1
    u, v = np.where(flip, 1 - u, u), np.where(flip, 1 - v, v)
    points = triangles[chosen, 0] + u * edges[chosen, 0] + v * edges[chosen, 1]
    return points, link_ids[chosen]


def pose_source(asset, pairs, state: float, points: np.ndarray, owners: np.ndarray) -> np.ndarray:
    """Source points (metres) with every matched joint opened to ``state``."""
    movable = movable_parts(asset)
    qpos = np.zeros(len(movable))
    for part, _ in pairs:
        joint = asset.parts[part].joint
        qpos[movable.index(part)] = joint.lower + state * (joint.upper - joint.lower)
    D = displacements(asset, qpos)
    D[:, :3, 3] *= asset.scale
    return np.einsum("nij,nj->ni", D[owners][:, :3, :3], points) + D[owners][:, :3, 3]


def pose_package(package, pairs, state: float, points: np.ndarray, links: np.ndarray) -> np.ndarray:
    """Exported points with every matched joint opened to ``state`` of the source's range."""
    qpos = {joint.name: joint.lower + state * (joint.upper - joint.lower) for _, joint in pairs}
    T = link_displacements(package.links, package.joints, qpos)
    return np.einsum("nij,nj->ni", T[links][:, :3, :3], points) + T[links][:, :3, 3]


def free_space(asset: Asset, package: SimPackage) -> tuple[int, float]:
    """Cells inside the bodies and drawers of the source that are free, and the share still free of hulls.

    A free cell lies in the convex hull of a base, drawer or tray, more than a cell away from any of the
    source's surface, and is no closed cavity. Parts with fewer than 200 of them have no space to keep.
    """
    assert asset.surface is not None
    grid = voxelize(asset.surface)
    occupied = np.zeros((64,) * 3, dtype=bool)
    occupied[tuple(grid.coords.T)] = True
    near = np.asarray(binary_dilation(occupied, np.ones((3, 3, 3))), dtype=bool)
    total, kept = 0, 0
    planes = [hull_planes(hull) for link in package.links for hull in link.hulls]
    for index, part in enumerate(asset.parts):
        cells = grid.coords[grid.part_ids == index]
        if part.label not in ("base", "drawer", "tray") or len(cells) < 50:
            continue
        own = np.zeros_like(occupied)
        own[tuple(cells.T)] = True
        free = np.argwhere(~near & reachable(own))
        if np.ptp(cells, axis=0).min() == 0:
            continue
        hull = ConvexHull(cells)
        inside = (free @ hull.equations[:, :3].T + hull.equations[:, 3] < -1.0).all(axis=1)
        free = free[inside]
        if len(free) < MIN_CAVITY_CELLS:
            continue
        centers = ((free + 0.5) / 64 - 0.5) * asset.scale
        filled = np.zeros(len(centers), dtype=bool)
        for plane in planes:
            filled |= (centers @ plane[:, :3].T <= plane[:, 3]).all(axis=1)
        total += len(free)
        kept += int((~filled).sum())
    return total, kept / total if total else 1.0


def reachable(own: np.ndarray) -> np.ndarray:
    """Cells that can be reached from outside past one part alone."""
    padded = np.pad(~own, 1, constant_values=True)
    labels = np.zeros(padded.shape, dtype=np.int64)
    label(padded, output=labels)
    return (labels == labels[0, 0, 0])[1:-1, 1:-1, 1:-1]
