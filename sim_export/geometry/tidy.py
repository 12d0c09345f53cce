"""Removes needles and tiny edges from meshes after exact booleans."""

import manifold3d
import numpy as np

from sim_export.errors import OpenMesh
from sim_export.geometry.needles import find_needles, flip_needles
from sim_export.geometry.solids import as_solid, solid_arrays
from sim_export.package import Mesh

DETAILS = (1e-5, 1e-4, 5e-4, 1e-3)
"""Detail left out, over the mesh's diagonal; the least that does is taken."""
LEAST_DETAIL = 2e-6
"""Metres; files hold micrometres."""
MOST_LOST = 0.005
"""Share of the volume that leaving out detail may change."""
MOST_NEEDLES = 0.008
"""Share of needles up to which a mesh is good; checks allow a hundredth, or one."""


def tidy_mesh(solid: manifold3d.Manifold, like: Mesh) -> Mesh | None:
    """The mesh of a solid in the colour of another, or `None` where it cannot be had clean.

    Clean means closed, with edges that outlast a file, and hardly any needles.
    """
    vertices, _ = solid_arrays(solid)
    if not len(vertices):
        return None
    size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    for detail in DETAILS:
        vertices, faces = solid_arrays(solid.simplify(max(detail * size, LEAST_DETAIL)))
        faces = flip_needles(vertices, faces, np.zeros(len(faces), dtype=np.int64))
        mesh = Mesh(vertices=vertices, faces=faces, color=like.color)
        needles = int(find_needles(vertices[faces], 1.2e-4).sum())
        try:
            volume = as_solid(mesh).volume()
        except OpenMesh:
            continue
        if needles <= max(1, MOST_NEEDLES * len(faces)) and abs(volume / solid.volume() - 1.0) <= MOST_LOST:
            return mesh
    return None
