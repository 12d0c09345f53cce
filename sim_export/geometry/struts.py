"""Connects the pieces of a link that are apart by struts.

A handle on brackets thinner than a cell, a grate above its hob: what a link shows may be in several pieces
with narrow gaps between them. Struts, boxes no wider than a cell, bridge each gap.
"""

from collections.abc import Mapping, Sequence

import manifold3d
import numpy as np
from jaxtyping import Float

from sim_export.geometry.islands import nearest_points, surface_shape
from sim_export.geometry.sampling import sample_triangles
from sim_export.geometry.solids import as_solid, solid_arrays, solid_triangles, unite
from sim_export.geometry.tidy import tidy_mesh
from sim_export.package import Link, Mesh

REACH = 0.002
"""Pieces that are nearer than this (m) need no strut."""
WIDEST = 2.5
"""Widest gap that is bridged, in cells."""
ROOT = 0.5
"""How far a strut stands in what it connects, over its width."""
LONG = 6.0
"""Length over width of a strut from which on what faces across a gap is held at both ends, as handles are."""
SPECK = 0.5
"""Volume, in cells, up to which a piece too far to be connected is left out."""
_SAMPLES = 400


def brace_links(
    links: Sequence[Link], meshes: Mapping[str, Mesh], cell: float
) -> tuple[dict[str, Mesh], tuple[str, ...]]:
    """Connects the pieces of every link; pieces out of reach are left out if they are specks.

    Args:
        meshes: Closed mesh of every part, by name; metres, object frame.
        cell: Edge of a voxel (m).

    Returns:
        The meshes of all parts by name, and one sentence for each that changed.
    """
    out, records = dict(meshes), []
    for link in links:
        for part, (solid, count, dropped) in _brace(
            {p: as_solid(meshes[p]) for p in link.parts}, cell
        ).items():
            mesh = tidy_mesh(solid, meshes[part])
            if mesh is None:
                continue
            out[part] = mesh
            records.append(f"{part}: {count} struts connect its pieces, {dropped} specks left out")
    return out, tuple(records)


def _brace(
    solids: Mapping[str, manifold3d.Manifold], cell: float
) -> dict[str, tuple[manifold3d.Manifold, int, int]]:
    """The parts of one link that change: what they become, how many struts, how many specks less."""
    pieces = [(part, piece) for part, solid in solids.items() for piece in solid.decompose()]
    if len(pieces) < 2:
        return {}
    shapes = [surface_shape(solid_triangles(piece)) for _, piece in pieces]
    volumes = [piece.volume() for _, piece in pieces]
    # The surface of a void inside is a piece of negative volume.
    joined = [k for k, volume in enumerate(volumes) if volume == max(volumes) or volume < 0.0]
    near = {
        k: min((nearest_points(shapes[k], shapes[other]) for other in joined), key=_gap)
        for k in range(len(pieces))
        if k not in joined
    }
    whole = unite(solids.values())
    changed: dict[str, tuple[manifold3d.Manifold, int, int]] = {}
    while near:
        index = min(near, key=lambda k: near[k][0])
        gap, ends = near.pop(index)
        part, piece = pieces[index]
        solid, count, dropped = changed.get(part, (solids[part], 0, 0))
        if REACH < gap <= WIDEST * cell:
            changed[part] = (solid + make_struts(piece, whole - piece, ends, cell), count + 1, dropped)
        elif gap > REACH and piece.volume() <= SPECK * cell**3:
            changed[part] = (solid - piece, count, dropped + 1)
            continue
        elif gap > REACH:
            continue
        for k in near:
            near[k] = min(near[k], nearest_points(shapes[k], shapes[index]), key=_gap)
    return changed


def _gap(found: tuple[float, Float[np.ndarray, "2 3"]]) -> float:
    return found[0]


def make_struts(
    piece: manifold3d.Manifold, whole: manifold3d.Manifold, ends: Float[np.ndarray, "2 3"], cell: float
) -> manifold3d.Manifold:
    """A box from a piece to what it belongs to, or two near the ends of what faces it along a line.

    Args:
        whole: What it belongs to.
        ends: Their nearest points (m).
        cell: Largest width (m).
    """
    gap = float(np.linalg.norm(ends[1] - ends[0]))
    way = (ends[1] - ends[0]) / gap
    thickness = float(np.ptp(solid_arrays(piece)[0] @ way))
    inside = min(REACH, thickness / 2.0)  # no thin piece goes through what it faces
    patches = (piece.translate((gap + inside) * way) ^ whole).decompose()
    points = ends.mean(axis=0, keepdims=True)
    if patches:
        points = sample_triangles(solid_triangles(max(patches, key=lambda patch: patch.volume())), _SAMPLES)[
            0
        ]
    frame = _frame(way, points)
    flat = (points - points.mean(axis=0)) @ frame[1:].T
    low, high = flat.min(axis=0), flat.max(axis=0)
    length, across = high - low
    width = float(np.clip(across / 2.0, cell / 4.0, cell))
    middle = (low + high) / 2.0
    inset = np.array([length / 2.0 - width, 0.0])
    targets = [middle - inset, middle + inset] if length > LONG * width else [middle]
    size = (gap + 2.0 * ROOT * width, width, width)
    struts = []
    for target in targets:
        place = points[np.linalg.norm(flat - target, axis=1).argmin()]
        at = place + way * (way @ (ends.mean(axis=0) - place))
        T = np.column_stack([frame.T, at])
        struts.append(manifold3d.Manifold.cube(size, center=True).transform(T))
    return unite(struts)


def _frame(way: Float[np.ndarray, "3"], points: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, "3 3"]:
    """Three orthonormal rows: ``way``, the direction across it in which points spread most, and the third."""
    across = points - points.mean(axis=0)
    across = across - np.outer(across @ way, way)
    spread = across.T @ across + 1e-12 * (np.eye(3) - np.outer(way, way))
    second = np.linalg.eigh(spread)[1][:, 2]
    return np.stack([way, second, np.cross(way, second)])
