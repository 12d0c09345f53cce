"""Links without visuals, of boxes as hulls and of their union as a mesh."""

import manifold3d
import numpy as np
from triangle_box import Ends

from sim_export.geometry.hulls import Hull, box_hull
from sim_export.geometry.solids import solid_arrays
from sim_export.package import Link, Mesh


def box(low: Ends, high: Ends) -> Hull:
    """A box as a hull."""
    return box_hull(np.array(low, dtype=float), np.array(high, dtype=float))


def link(name: str, *hulls: Hull) -> Link:
    """A link of hulls alone."""
    return Link(name=name, label=None, parts=(name,), visuals=(), hulls=hulls, inertial=None)


def solid(*boxes: tuple[Ends, Ends]) -> Mesh:
    """The union of boxes, each given by its lowest and highest corner."""
    whole = manifold3d.Manifold()
    for low, high in boxes:
        whole += manifold3d.Manifold.cube(tuple(np.subtract(high, low))).translate(tuple(low))
    vertices, faces = solid_arrays(whole)
    return Mesh(vertices=vertices, faces=faces)
