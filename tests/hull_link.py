"""Boxes as hulls, solids, meshes and links without visuals, and joints."""

import manifold3d
import numpy as np
from triangle_box import Ends

from artigen.types import Joint, JointType
from sim_export.geometry.hulls import Hull, box_hull
from sim_export.geometry.solids import solid_arrays, unite
from sim_export.package import Link, Mesh


def box(low: Ends, high: Ends) -> Hull:
    """A box as a hull."""
    return box_hull(np.array(low, dtype=float), np.array(high, dtype=float))


def link(name: str, *hulls: Hull) -> Link:
    """A link of hulls alone."""
    return Link(name=name, label=None, parts=(name,), visuals=(), hulls=hulls, inertial=None)


def make_joint(
    child: str, kind: JointType, axis: Ends, origin: Ends, upper: float, parent: str = "body"
) -> Joint:
    """A joint, called after its child."""
    return Joint(
        name=f"joint_{child}", type=kind, parent=parent, child=child,
        origin=np.array(origin, dtype=float), axis=np.array(axis, dtype=float), upper=upper,
    )  # fmt: skip


def block(low: Ends, high: Ends) -> manifold3d.Manifold:
    """A box as a solid."""
    return manifold3d.Manifold.cube(tuple(np.subtract(high, low))).translate(tuple(low))


def as_mesh(solid: manifold3d.Manifold) -> Mesh:
    """The surface of a solid."""
    vertices, faces = solid_arrays(solid)
    return Mesh(vertices=vertices, faces=faces)


def solid(*boxes: tuple[Ends, Ends]) -> Mesh:
    """The union of boxes, each given by its lowest and highest corner."""
    return as_mesh(unite(block(*ends) for ends in boxes))
