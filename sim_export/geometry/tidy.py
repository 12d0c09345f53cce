"""Removes slivers and tiny edges from meshes after exact booleans."""

import manifold3d
import numpy as np

from sim_export.errors import OpenMesh
from sim_export.geometry.solids import as_solid, solid_arrays
from sim_export.geometry.triangles import diagonal_of, find_slivers
from sim_export.package import Mesh

DETAILS = (1e-5, 1e-4, 5e-4, 1e-3)
"""Simplification tolerances relative to the mesh's diagonal; the smallest sufficient one is used."""
LEAST_DETAIL = 2e-6
"""Smallest simplification tolerance (m); files have micrometre precision."""
MOST_LOST = 0.005
"""Largest relative change of the volume by simplification."""
MOST_SLIVERS = 0.008
"""Largest share of slivers in a clean mesh; V101 allows a hundredth, or one."""


def tidy_mesh(solid: manifold3d.Manifold, like: Mesh) -> Mesh | None:
    """The mesh of a solid in the colour of another; `None` if no clean mesh is found.

    Clean means closed, with edges that survive rounding in a file, and with hardly any slivers.
    """
    vertices, _ = solid_arrays(solid)
    if not len(vertices):
        return None
    size = diagonal_of(vertices)
    for detail in DETAILS:
        vertices, faces = solid_arrays(solid.simplify(max(detail * size, LEAST_DETAIL)))
        mesh = Mesh(vertices=vertices, faces=faces, color=like.color)
        slivers = np.count_nonzero(find_slivers(vertices[faces], 1.2e-4))
        try:
            volume = as_solid(mesh).volume()
        except OpenMesh:
            continue
        if slivers <= max(1, MOST_SLIVERS * len(faces)) and abs(volume / solid.volume() - 1.0) <= MOST_LOST:
            return mesh
    return None
