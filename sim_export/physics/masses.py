"""Mass of a part: its walls without the space they enclose.

Voxels of a closed body describe a shell, but its mesh also encloses the inaccessible cavity. The mass
properties are therefore those of the solid mesh minus those of the cavity cells, both exact. Walls thicker
than their material is used in practice are hollow and have the mass of the thickest real wall.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import binary_erosion

from artigen.types import Asset, VoxelGrid
from sim_export.errors import DegeneratePart
from sim_export.geometry.hulls import convex_hull, hull_planes
from sim_export.geometry.occupancy import PartOccupancy, require_voxels
from sim_export.geometry.triangles import area_normals, bounds_of
from sim_export.package import Inertial, Link, Mesh
from sim_export.physics.inertia import inertia_about, mesh_inertial
from sim_export.physics.makes import fill_base, find_make, is_hardware, wall_density
from sim_export.physics.materials import MATERIALS, part_material

FARTHEST = 0.006
"""Distance (m) up to which a centre of mass is moved into the collision geometry of its link."""
_INSIDE = 2e-4
"""Distance (m) inside a face to which a centre of mass is moved."""


def weigh_part(asset: Asset, part_id: int, mesh: Mesh, occupancy: PartOccupancy) -> Inertial:
    """Mass properties of the walls of a part, with the material implied by its label and category.

    Where the real wall thickness is known (`Make.wall`), its mass is spread over the whole mesh, as in exact
    packages.

    Args:
        mesh: Its closed mesh, metres.
        occupancy: The cells from which the mesh was made.
    """
    voxels = require_voxels(asset)
    part = asset.parts[part_id]
    name, make = part_material(part.label, asset.category), find_make(asset.category)
    hardware = is_hardware(part.label, moves=part.joint.type != "fixed")
    if name in make.wall and not hardware:
        walls = mesh_inertial(mesh, wall_density(make, name, mean_thickness(mesh)))
    else:
        own = MATERIALS[name].bulk if hardware else wall_density(make, name)
        density = own * min(1.0, MATERIALS[name].thickest / mean_thickness(mesh))
        walls = _weigh_shell(voxels, occupancy, asset.scale, mesh, density)
    if walls.mass <= 0:
        raise DegeneratePart(
            f"part {part.name!r}: walls of {walls.mass:.3g} kg around its cavity, expected > 0"
        )
    if part.parent != -1:
        return walls
    return fill_base(make, walls, bounds_of(mesh.vertices))


def _weigh_shell(
    voxels: VoxelGrid, occupancy: PartOccupancy, scale: float, mesh: Mesh, density: float
) -> Inertial:
    """Mass properties of a closed mesh without the cells that it encloses."""
    cavity = binary_erosion(occupancy.occupancy)  # the outermost cells are walls
    cavity[tuple(voxels.coords.T)] = False
    solid = mesh_inertial(mesh, density)
    return (
        subtract(solid, cells_inertial(cavity, scale / voxels.resolution, density)) if cavity.any() else solid
    )


def mean_thickness(mesh: Mesh) -> float:
    """Mean thickness (m) of a plate with the volume and area of a mesh; half the diameter for a bar."""
    corners = mesh.vertices[mesh.faces]
    normals = area_normals(corners)
    volume = float(np.einsum("fi,fi->", corners[:, 0], normals)) / 6.0
    return 2.0 * volume / (float(np.linalg.norm(normals, axis=1).sum()) / 2.0)


def cells_inertial(cells: Bool[np.ndarray, "R R R"], cell_size: float, density: float) -> Inertial:
    """Mass properties of the cubes of a grid that is centred on the origin."""
    centers = (np.argwhere(cells) + 0.5 - cells.shape[0] / 2) * cell_size
    mass = density * cell_size**3
    com = centers.mean(axis=0)
    arms = centers - com
    own = mass * cell_size**2 / 6.0 * len(arms) * np.eye(3)
    second = mass * arms.T @ arms
    return Inertial(mass=mass * len(arms), com=com, inertia=own + np.trace(second) * np.eye(3) - second)


def subtract(whole: Inertial, hole: Inertial) -> Inertial:
    """Mass properties of ``whole`` without ``hole``."""
    mass = whole.mass - hole.mass
    com = (whole.mass * np.asarray(whole.com) - hole.mass * np.asarray(hole.com)) / mass
    rest: Float[np.ndarray, "3 3"] = inertia_about(whole, com) - inertia_about(hole, com)
    return Inertial(mass=mass, com=com, inertia=rest)


def hold_centers(links: Sequence[Link]) -> tuple[tuple[Link, ...], tuple[str, ...]]:
    """Moves centres of mass into the collision geometry of their links; one sentence per change.

    The mesh of a knob that clearance trimmed has its centre of mass slightly outside of the remaining hulls.
    Centres more than `FARTHEST` outside are an error of the object and stay unchanged.
    """
    out, records = [], []
    for link in links:
        if link.inertial is None or not link.hulls:
            out.append(link)
            continue
        planes = hull_planes(convex_hull(np.concatenate([hull.vertices for hull in link.hulls])))
        com = np.asarray(link.inertial.com)
        start = com
        for _ in range(12):
            beyond = planes[:, :3] @ com - planes[:, 3]
            worst = int(beyond.argmax())
            if beyond[worst] <= 0.0:
                break
            com = com - (beyond[worst] + _INSIDE) * planes[worst, :3]
        moved = float(np.linalg.norm(com - start))
        if not 0.0 < moved <= FARTHEST:
            out.append(link)
            continue
        out.append(replace(link, inertial=replace(link.inertial, com=com)))
        records.append(f"{link.name}: its centre of mass moved by {1000 * moved:.1f} mm into its collision")
    return tuple(out), tuple(records)
