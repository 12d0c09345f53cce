"""Boxes and cylinders that a surface consists of, exactly; nothing is approximated."""

import numpy as np
from jaxtyping import Float

from sim_export.errors import DegeneratePart, ExportError
from sim_export.geometry.hulls import convex_hull, hull_triangles
from sim_export.geometry.islands import split_groups
from sim_export.geometry.primitives import PrimitiveShape, find_primitive, place_along, primitive_hull
from sim_export.geometry.rows import connect_rows, number_rows
from sim_export.geometry.triangles import face_edges, triangle_areas
from sim_export.package import Hull

EVEN = 1e-3
"""Share of its size to which a component is a primitive; meshes have single precision."""
LEAST_SIDES = 8
"""Sides of a prism that stands for a cylinder, at least."""


def find_solids(triangles: Float[np.ndarray, "F 3 3"], owner: str) -> tuple[Hull, ...]:
    """A box or cylinder (m) for each shell of a surface; shells may touch, also along whole edges.

    Args:
        owner: How errors name the surface.

    Raises:
        ExportError: If a shell is neither.
    """
    components = _split_shells(triangles)
    found = [_find_solid(component) for component in components]
    if None in found:
        at = found.index(None)
        raise ExportError(
            f"{owner}: its piece {at + 1} of {len(found)}, of {len(components[at])} triangles, is neither a "
            "box nor a cylinder, which --collision exact needs; try --collision auto"
        )
    return tuple(hull for hull in found if hull is not None)


def _split_shells(triangles: Float[np.ndarray, "F 3 3"]) -> list[Float[np.ndarray, "G 3 3"]]:
    """The triangles by what they are connected to through edges that only two of them share."""
    corners = number_rows(np.rint(1e7 * triangles.reshape(-1, 3)).astype(np.int64))[1]
    edge = number_rows(np.sort(face_edges(corners.reshape(-1, 3)), axis=1))[1]
    owners = np.tile(np.arange(len(triangles)), 3)[np.argsort(edge, kind="stable")]
    counts = np.bincount(edge)
    first = np.cumsum(counts)[counts == 2] - 2
    return split_groups(triangles, connect_rows(np.stack([owners[first], owners[first + 1]]), len(triangles)))


def _find_solid(component: Float[np.ndarray, "F 3 3"]) -> Hull | None:
    try:
        hull = convex_hull(np.round(component.reshape(-1, 3), 7))
    except DegeneratePart:
        return None
    area = float(triangle_areas(hull_triangles((hull,))).sum())
    if abs(float(triangle_areas(component).sum()) - area) > EVEN * area:  # open, or not convex
        return None
    shape = find_primitive(hull) or _find_cylinder(hull)
    return None if shape is None else primitive_hull(shape)


def _find_cylinder(hull: Hull) -> PrimitiveShape | None:
    """The cylinder around a regular prism of any number of sides."""
    middle = (hull.vertices.min(axis=0) + hull.vertices.max(axis=0)) / 2
    spokes = hull.vertices - hull.vertices.mean(axis=0)
    for axis in np.linalg.svd(spokes, full_matrices=False)[2]:
        heights = (hull.vertices - middle) @ axis
        half = float(np.abs(heights).max())
        radii = np.linalg.norm(hull.vertices - middle - np.outer(heights, axis), axis=1)
        radius, ends = float(radii.max()), np.abs(np.abs(heights) - half)
        if len(radii) < 2 * LEAST_SIDES or max(np.ptp(radii), float(ends.max())) > EVEN * max(radius, half):
            continue
        axis = axis * np.sign(axis[np.abs(axis).argmax()])
        return PrimitiveShape(
            kind="cylinder", sizes=(radius, 2.0 * half), T_object_shape=place_along(axis, middle)
        )
    return None
