"""`Solids`: meshes, masses and surfaces of the parts of an `Asset`, of which hulls are made."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float

from artigen.runtime.stopwatch import Stopwatch
from artigen.types import Asset
from sim_export.collision.cover.object_cover import ObjectCover, find_passing
from sim_export.geometry.boards import fill_boards
from sim_export.geometry.lone_cells import give_lone_cells
from sim_export.geometry.meshing import mesh_parts, solid_parts
from sim_export.geometry.occupancy import require_voxels
from sim_export.geometry.separation import free_latches, separate_solids
from sim_export.geometry.triangles import diagonal_of
from sim_export.geometry.wheels import fit_width, is_open, round_wheels
from sim_export.package import Inertial, Mesh
from sim_export.physics.links import (
    LinkTree,
    PartGeometry,
    build_links,
    link_names,
    link_owners,
    link_surfaces,
)
from sim_export.physics.masses import weigh_part


@dataclass(frozen=True, kw_only=True, eq=False)
class Solids:
    """What does not depend on the choice of hulls: a mesh and mass of every part, the triangles (m) of which
    hulls are made where that is not the mesh, records, and the seconds that each stage took."""

    asset: Asset
    meshes: tuple[Mesh, ...]
    inertials: tuple[Inertial, ...]
    surfaces: tuple[Float[np.ndarray, "F 3 3"], ...] | None
    records: tuple[str, ...]
    seconds: tuple[tuple[str, float], ...]

    @cached_property
    def source_cover(self) -> ObjectCover:
        """Hulls of the links from their own triangles, kept out of the space that other links sweep."""
        if self.surfaces is None:
            raise ValueError("these solids have no surfaces of their own; make hulls of their meshes")
        shown = link_surfaces(self.asset, self.surfaces)
        return ObjectCover(shown, find_passing(self._tree.links, self._tree.joints, shown))

    @cached_property
    def voxel_cover(self) -> ObjectCover:
        """Hulls of the parts from their meshes, kept out of the space that other links are in or sweep."""
        triangles = [mesh.vertices[mesh.faces] for mesh in self.meshes]
        shown = link_surfaces(self.asset, triangles)
        passing = find_passing(self._tree.links, self._tree.joints, shown, solid=True)
        names, owners = link_names(self.asset), link_owners(self.asset)
        parts = [part.name for part in self.asset.parts]
        around = {
            part: passing[names[owner]]
            for part, owner in zip(parts, owners, strict=True)
            if names.get(owner) in passing
        }
        return ObjectCover(dict(zip(parts, triangles, strict=True)), around, solid=True)

    @cached_property
    def _tree(self) -> LinkTree:
        return build_links(self.asset, [PartGeometry(inertial=inertial) for inertial in self.inertials])


def make_solids(asset: Asset, surfaces: Sequence[Float[np.ndarray, "F 3 3"]] | None = None) -> Solids:
    """Meshes and masses of all parts from their voxels.

    Args:
        asset: As in `export_asset`.
        surfaces: The triangles of the visual meshes by part (metres), from which `export_solids` may make
            collision.

    Raises:
        ExportError: As `export_asset`.
    """
    watch = Stopwatch()
    owners = link_owners(asset)
    voxels, lone = give_lone_cells(require_voxels(asset), owners)
    voxels, gaps = fill_boards(voxels, owners)
    asset = replace(asset, voxels=voxels)
    solids, given_up = separate_solids(asset, solid_parts(asset), owners)
    asset, solids, freed = free_latches(asset, solids, owners)
    plain = mesh_parts(asset, solids)
    meshes, rounded = round_wheels(asset, plain)
    if surfaces is not None:
        surfaces, spoked = _round_surfaces(asset, surfaces, plain, meshes)
        rounded = (*rounded, *spoked)
    watch.lap("mesh")
    inertials = [weigh_part(asset, index, mesh, solids[index]) for index, mesh in enumerate(meshes)]
    watch.lap("mass")
    records = (
        *([f"{lone} cells apart from their links were given to what is around them"] if lone else []),
        *([f"{gaps} cells between the faces of boards were filled"] if gaps else []),
        *(
            f"{part.name}: {said}"
            for part, solid in zip(asset.parts, solids, strict=True)
            for said in solid.records
        ),
        *given_up,
        *freed,
        *rounded,
    )
    return Solids(
        asset=asset,
        meshes=tuple(meshes),
        inertials=tuple(inertials),
        surfaces=None if surfaces is None else tuple(surfaces),
        records=records,
        seconds=tuple(watch.laps),
    )


def _round_surfaces(
    asset: Asset,
    surfaces: Sequence[Float[np.ndarray, "F 3 3"]],
    plain: Sequence[Mesh],
    meshes: Sequence[Mesh],
) -> tuple[list[Float[np.ndarray, "F 3 3"]], tuple[str, ...]]:
    """The triangles of all parts, those of wheels that became cylinders replaced by these.

    A wheel that its cylinder would close keeps its own, and a record says so.
    """
    diagonal = diagonal_of(np.concatenate([surface.reshape(-1, 3) for surface in surfaces]))
    out, records = list(surfaces), []
    for index, (part, before, mesh) in enumerate(zip(asset.parts, plain, meshes, strict=True)):
        if part.label != "wheel" or mesh is before or not len(surfaces[index]):
            continue
        cylinder = fit_width(mesh, part.joint, asset.scale, surfaces[index])
        if is_open(surfaces[index], cylinder, diagonal):
            records.append(f"{part.name}: keeps its own surface, whose openings the cylinder would close")
        else:
            out[index] = cylinder.vertices[cylinder.faces]
    return out, tuple(records)
