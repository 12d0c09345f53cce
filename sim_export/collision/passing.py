"""Space that other links occupy at rest and while joints move, in the frame of each link."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from artigen.transforms import inverse, transform_points
from sim_export.collision.motion import driven_joints, link_displacements, moved_links
from sim_export.collision.requirements import sweep_coordinates
from sim_export.geometry.sampling import sample_triangles
from sim_export.package import Link, PackageJoint
from sim_export.tree import hanging_links

SAMPLES = 6000
"""Points on the surface of each link."""
POSES = 21
"""Poses of every joint."""


def find_passing(
    links: Sequence[Link],
    joints: Sequence[PackageJoint],
    surfaces: Mapping[str, Float[np.ndarray, "F 3 3"]],
) -> dict[str, Float[np.ndarray, "N 3"]]:
    """Points (m, object frame at rest) where other links are, by link.

    Links on one branch of the tree, like a drawer and its body, are followed along their joints. Those of
    different branches count at rest only: one may have to be opened before the other.

    Args:
        links: The links.
        joints: Their joints.
        surfaces: Triangles of every link that has any, at rest.
    """
    points = {name: sample_triangles(triangles, SAMPLES)[0] for name, triangles in surfaces.items()}
    below = {link.name: set(hanging_links(joints, link.name)) for link in links}
    slot = {link.name: index for index, link in enumerate(links)}
    out = {name: [other for key, other in points.items() if key != name] for name in points}
    for joint in driven_joints(joints):
        moved = {links[index].name for index in moved_links(links, joints, joint)}
        T = link_displacements(links, joints, {joint.name: sweep_coordinates(joint, POSES)[1:]})
        for name in points:
            for other in points:
                related = other in below[name] or name in below[other]
                if name != other and related and (name in moved) != (other in moved):
                    relative = inverse(T[:, slot[name]]) @ T[:, slot[other]]
                    out[name].append(transform_points(relative, points[other]).reshape(-1, 3))
    return {name: np.concatenate(found) for name, found in out.items() if found}
