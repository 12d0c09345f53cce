"""Fills the mesh where hulls fill it, up to the size of a voxel.

A slot between two bars or the gap between four low feet can be one voxel wide. It takes a hull a bar to
leave it open, and a link has few. Where hulls fill such gaps by more than a little of a link's
volume, its mesh fills them, too: what is seen is what is felt, and nothing wider than the
representation's own error changes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import manifold3d
import numpy as np

from sim_export.checks.surface import SampledSurface, distances_to, sample_surface_tree
from sim_export.geometry.solids import as_solid, inside_grid, solid_arrays
from sim_export.geometry.tidy import tidy_mesh
from sim_export.package import Hull, Link, Mesh

_SAMPLES = 20_000


REACH = 1.6
"""Voxels; a hull that stands out of the mesh by more anywhere is not taken in."""
SHARE = 0.05
"""Share of a link's volume that its hulls may fill without any change to meshes."""
LEAST = 0.001
"""Share of a link's volume below which what one hull fills is left alone."""
GRID = 24
"""Cells along each axis with which the depth of what a hull fills is measured."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Filled:
    """The meshes of all parts by name, and one sentence for each that changed."""

    meshes: Mapping[str, Mesh]
    records: tuple[str, ...] = ()


def fill_meshes(links: Sequence[Link], meshes: Mapping[str, Mesh], voxel: float) -> Filled:
    """Adds to the meshes of each link what its hulls hold besides, as far as that is thin.

    Args:
        links: Links with hulls, object frame at rest.
        meshes: Closed mesh of every part, by name; metres, object frame.
        voxel: Edge of a voxel (m).
    """
    out, records = dict(meshes), []
    for link in links:
        if not link.hulls or not link.parts:
            continue
        solids = {part: as_solid(meshes[part]) for part in link.parts}
        whole = manifold3d.Manifold.batch_boolean(list(solids.values()), manifold3d.OpType.Add)
        volume = whole.volume()
        felt = manifold3d.Manifold.batch_boolean(list(map(as_solid, link.hulls)), manifold3d.OpType.Add)
        excess = (felt - whole).volume() - SHARE * volume
        if excess <= 0.0:
            continue
        taken: dict[str, int] = {}
        surface = _sample(whole)
        for hull, rest in _fillers(link.hulls, whole, LEAST * volume):
            if excess <= 0.0:
                break
            if _depth(rest, surface, GRID) > REACH * voxel:
                continue
            part = max(solids, key=lambda name: (solids[name] ^ hull).volume())
            solids[part] = solids[part] + hull
            taken[part] = taken.get(part, 0) + 1
            excess -= (rest - whole).volume()
            whole = whole + hull
            surface = _sample(whole)
        for part, count in taken.items():
            mesh = tidy_mesh(solids[part], meshes[part])
            if mesh is None:
                continue
            grown = as_solid(mesh).volume() / as_solid(meshes[part]).volume() - 1.0
            out[part] = mesh
            records.append(
                f"{part}: its mesh fills gaps up to {1000 * REACH * voxel:.0f} mm deep, as {count} of "
                f"its hulls do: {grown:.1%} of its volume"
            )
    return Filled(meshes=out, records=tuple(records))


def _fillers(
    hulls: Sequence[Hull], whole: manifold3d.Manifold, least: float
) -> list[tuple[manifold3d.Manifold, manifold3d.Manifold]]:
    """Hulls that fill more than ``least`` (m^3) outside of a solid, and what, the most first."""
    found = []
    for hull in map(as_solid, hulls):
        rest = hull - whole
        if rest.volume() > least:
            found.append((hull, rest))
    return sorted(found, key=lambda pair: -pair[1].volume())


def _sample(whole: manifold3d.Manifold) -> SampledSurface:
    """The surface of a solid, to measure distances to."""
    vertices, faces = solid_arrays(whole)
    return sample_surface_tree(vertices[faces], _SAMPLES)


def _depth(rest: manifold3d.Manifold, surface: SampledSurface, cells: int) -> float:
    """How far (m) from the surface of a solid something outside of it reaches, to a cell of a grid."""
    vertices, faces = solid_arrays(rest)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    steps = (np.arange(cells) + 0.4871) / cells
    x, y, z = (low[axis] + (high - low)[axis] * steps for axis in range(3))
    inside = np.argwhere(inside_grid(vertices, faces, (x, y, z)))
    points = np.concatenate([np.stack([x, y, z], axis=1)[inside, [0, 1, 2]], vertices])
    return float(distances_to(points, surface).max())
