"""Converts the voxels of an asset to one closed mesh per part.

The cells of a part become a blocky solid (`occupancy`). Its faces move to their most likely planes
(`face_planes`), round and slanted surfaces are smoothed (`smoothing`), and coplanar triangles are merged.
Unlike marching cubes, this preserves walls one cell thick as well as the sharp edges and exact outer size of
furniture, and open drawers stay open.
"""

from collections.abc import Sequence

import manifold3d
import numpy as np
from jaxtyping import Bool, Float, Int

from artigen.types import Asset, Part
from sim_export.errors import DegeneratePart, OpenMesh
from sim_export.geometry.face_planes import BOX_REACH, DIRECTIONS, MARGIN, box_in_lattice, fit_face_planes
from sim_export.geometry.occupancy import PartOccupancy, part_occupancy, require_voxels
from sim_export.geometry.slants import find_slants
from sim_export.geometry.smoothing import BlockySurface, put_on_slants, smooth_surface, stretch_to_box
from sim_export.geometry.solids import make_manifold, solid_arrays
from sim_export.geometry.triangles import face_edges
from sim_export.package import Mesh

TOLERANCE = 0.03
"""Deviation allowed when triangles are merged, in cells."""
_SLIVER = 0.02
"""Twice the area, in square cells, below which a quad is split along its other diagonal if possible."""


def solid_parts(asset: Asset) -> tuple[PartOccupancy, ...]:
    """The solid cells of every part, in the order of the parts.

    Raises `DegeneratePart` if a part has no voxels, `ValueError` if the asset has none.
    """
    voxels, solids = require_voxels(asset), []
    for index, part in enumerate(asset.parts):
        if not (voxels.part_ids == index).any():
            raise DegeneratePart(
                f"asset {asset.name!r}: part {part.name!r} owns 0 of {len(voxels.coords)} voxels, "
                "expected at least 1; give it more samples or leave it out"
            )
        box = box_in_lattice(part, voxels.resolution)
        fittings = [
            k for k, other in enumerate(asset.parts) if other.parent == index and other.label == "knob"
        ]
        solids.append(part_occupancy(voxels, index, box, fittings, leaf=part.label == "door"))
    return tuple(solids)


def mesh_parts(asset: Asset, solids: Sequence[PartOccupancy] | None = None) -> tuple[Mesh, ...]:
    """One closed mesh per part, in the order of the parts; metres, object frame.

    ``solids`` are the cells of the parts if already computed (`solid_parts`). Raises `DegeneratePart` if a
    part has no voxels, `ValueError` if the asset has none.
    """
    voxels, meshes = require_voxels(asset), []
    boxes = [box_in_lattice(part, voxels.resolution) for part in asset.parts]
    for index, (part, solid) in enumerate(zip(asset.parts, solids or solid_parts(asset), strict=True)):
        occupancy = solid.occupancy
        others = np.zeros_like(occupancy)
        others[tuple(voxels.coords[voxels.part_ids != index].T)] = True
        vertices, faces = mesh_occupancy(occupancy, boxes[index], others & ~occupancy)
        _check_closed(asset.name, part, vertices, faces)
        metres = (vertices / voxels.resolution - 0.5) * asset.scale
        meshes.append(Mesh(vertices=metres, faces=faces))
    return tuple(meshes)


def mesh_occupancy(
    occupancy: Bool[np.ndarray, "X Y Z"],
    box: Float[np.ndarray, "2 3"],
    others: Bool[np.ndarray, "X Y Z"] | None = None,
) -> tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "F 3"]]:
    """Closed mesh of a well-composed solid with the extent ``box``, next to ``others``; lattice units."""
    cells = np.nonzero(occupancy)
    low = np.array([axis.min() for axis in cells])
    window = tuple(slice(axis.min(), axis.max() + 1) for axis in cells)
    around = None
    if others is not None:
        wide = tuple(slice(axis.min(), axis.max() + 1 + 2 * MARGIN) for axis in cells)
        around = np.pad(others, MARGIN)[wide]
    surface = read_surface(occupancy[window], box - low, around)
    vertices = smooth_surface(surface)
    vertices = stretch_to_box(vertices, ~surface.locked, box - low, BOX_REACH)
    faces = _split_quads(vertices, surface.quads)
    return _merge_coplanar(vertices + low, faces)


def read_surface(
    occupancy: Bool[np.ndarray, "X Y Z"],
    box: Float[np.ndarray, "2 3"],
    others: Bool[np.ndarray, "X2 Y2 Z2"] | None = None,
) -> BlockySurface:
    """The blocky surface with every vertex moved to the fitted planes of its faces."""
    planes = fit_face_planes(occupancy, box, others)
    slants = find_slants(planes)
    rows = np.argwhere(planes.patch >= 0)
    direction, cell = rows[:, 0], rows[:, 1:]
    plane, flat, slanted = (grid[tuple(rows.T)] for grid in (planes.plane, slants.flat, slants.slant))
    shape = np.array(occupancy.shape) + 1
    corners = cell[:, None] + _QUAD_CORNERS[direction]  # Q 4 3
    flat_corner = np.ravel_multi_index(tuple(np.moveaxis(corners, 2, 0)), tuple(shape))
    used = np.zeros(np.prod(shape), dtype=bool)
    used[flat_corner] = True
    number = np.cumsum(used) - 1
    quads = number[flat_corner]
    vertices = np.stack(np.unravel_index(np.flatnonzero(used), tuple(shape)), axis=1).astype(np.float64)
    locked = np.zeros(vertices.shape, dtype=bool)
    slant = np.full(vertices.shape, -1)
    for axis in range(3):
        for kind in (~flat, flat):
            chosen = kind & (direction // 2 == axis)
            ids = quads[chosen].ravel()
            hits = np.bincount(ids, minlength=len(vertices))
            total = np.bincount(ids, weights=np.repeat(plane[chosen], 4), minlength=len(vertices))
            vertices[:, axis] = np.where(hits > 0, total / np.maximum(hits, 1), vertices[:, axis])
        locked[:, axis] = hits > 0
        leaning = np.flatnonzero((slanted >= 0) & (direction // 2 == axis))
        slant[quads[leaning], axis] = slanted[leaning, None]
        slant[locked[:, axis], axis] = -1
    locked |= slant >= 0
    return BlockySurface(
        vertices=put_on_slants(vertices, slant, slants.planes),
        quads=quads,
        flat=flat,
        locked=locked,
        slant=slant,
        slants=slants.planes,
        walls=_thin_walls(planes.patch, number, shape, locked),
    )


def _thin_walls(patch: np.ndarray, number: np.ndarray, shape: np.ndarray, locked: np.ndarray) -> np.ndarray:
    """Vertex pairs across cells exposed on two opposite sides, if at least one side is free."""
    walls = []
    for axis in range(3):
        cell = np.argwhere((patch[2 * axis] >= 0) & (patch[2 * axis + 1] >= 0))
        low = cell[:, None] + _QUAD_CORNERS[2 * axis]
        step = np.eye(3, dtype=np.int64)[axis]
        below, above = (
            number[np.ravel_multi_index(tuple(np.moveaxis(corner, 2, 0)), tuple(shape))].ravel()
            for corner in (low, low + step)
        )
        free = ~(locked[below, axis] & locked[above, axis])
        below, first = np.unique(below[free], return_index=True)
        walls.append(np.stack([below, above[free][first], np.full(len(below), axis)], axis=1))
    return np.concatenate(walls)


def _quad_corners() -> np.ndarray:
    """Offsets of the four corners of a cell's face, counter-clockwise from outside; 6 4 3."""
    out = np.zeros((6, 4, 3), dtype=np.int64)
    for number, (axis, sign) in enumerate(DIRECTIONS):
        order = ((0, 0), (1, 0), (1, 1), (0, 1))
        for corner, (b, c) in enumerate(order if sign > 0 else order[::-1]):
            out[number, corner, axis] = sign > 0
            out[number, corner, (axis + 1) % 3] = b
            out[number, corner, (axis + 2) % 3] = c
    return out


_QUAD_CORNERS = _quad_corners()


def _split_quads(vertices: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Two triangles per quad, along its shorter diagonal unless that makes one degenerate."""
    at = vertices[quads]
    first = ((at[:, 0] - at[:, 2]) ** 2).sum(axis=1)
    second = ((at[:, 1] - at[:, 3]) ** 2).sum(axis=1)
    corner = [
        np.linalg.norm(np.cross(at[:, n - 1] - at[:, n], at[:, n - 3] - at[:, n]), axis=1) for n in range(4)
    ]
    # The diagonal from corner 0 cuts off the triangles at corners 1 and 3, the other those at 0 and 2.
    least_first, least_second = np.minimum(corner[1], corner[3]), np.minimum(corner[0], corner[2])
    turn = np.where(least_first < _SLIVER, least_second > least_first, second < first - 1e-9)
    turn &= least_second >= np.minimum(_SLIVER, least_first)
    turned = np.where(turn[:, None], np.roll(quads, -1, axis=1), quads)
    return np.concatenate([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]])


def _merge_coplanar(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fewer triangles within `TOLERANCE` of the same surface; still a closed manifold."""
    solid = make_manifold(vertices, faces)
    if solid.status() != manifold3d.Error.NoError:
        raise OpenMesh(f"blocky surface of {len(faces)} triangles is no manifold: {solid.status().name}")
    # The first pass removes collinear triangles, which the second would keep.
    return solid_arrays(solid.simplify(TOLERANCE / 6).simplify(TOLERANCE))


def _check_closed(name: str, part: Part, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Raises unless every edge has exactly one twin in the opposite direction and the volume is positive."""
    edges = face_edges(faces)
    codes = edges[:, 0] * len(vertices) + edges[:, 1]
    twins = edges[:, 1] * len(vertices) + edges[:, 0]
    closed = len(np.unique(codes)) == len(codes) and np.isin(codes, twins).all()
    a, b, c = vertices[faces].transpose(1, 0, 2)
    volume = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
    if not closed or volume <= 0:
        raise OpenMesh(
            f"asset {name!r}: mesh of part {part.name!r} has {len(faces)} faces, "
            f"{'closed' if closed else 'not closed'}, volume {volume:.4g} cells, expected closed and positive"
        )
