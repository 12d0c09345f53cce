"""URDF primitives as closed meshes, centred on their own frame."""

import numpy as np

from sim_export.errors import PackageError
from sim_export.package import Mesh

SEGMENTS = 24


def primitive_mesh(kind: str, sizes: tuple[float, ...]) -> Mesh:
    """A box (three edges), cylinder (radius, length along z) or sphere (radius) in metres.

    Raises:
        PackageError: If a size is not a positive number or the kind is unknown.
    """
    if not (len(sizes) and np.isfinite(sizes).all() and min(sizes) > 0):
        raise PackageError(f"a {kind} has sizes {list(sizes)}, expected positive numbers")
    import trimesh

    match kind:
        case "box":
            solid = trimesh.creation.box(extents=sizes)
        case "cylinder":
            solid = trimesh.creation.cylinder(radius=sizes[0], height=sizes[1], sections=SEGMENTS)
        case "sphere":
            solid = trimesh.creation.icosphere(subdivisions=2, radius=sizes[0])
        case _:
            raise PackageError(f"shape {kind!r}, expected box, cylinder or sphere")
    return Mesh(vertices=np.asarray(solid.vertices), faces=np.asarray(solid.faces))
