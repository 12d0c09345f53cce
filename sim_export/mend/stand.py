"""Turns an object that would fall over onto the nearest side on which it stands.

Wheelbarrows are drawn with level handles and stand tilted, on their wheel and legs; bags are drawn on an
edge. What needs a larger turn stays as it is: its z axis would not be up any more. Where hulls end above what
is lowest after the turn, such as the ends of handles, these get hulls of their own. Joints get the friction
that holds their parts in the new position.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

from artigen.splats.motion import transform_gaussians
from artigen.transforms import transform_points
from artigen.types import Joint
from sim_export.collision.feet import add_feet, find_tips
from sim_export.mend.source import as_mesh
from sim_export.package import HandleAnnotation, Hull, Link, Mesh, SimPackage, Visual
from sim_export.physics.resistance import resist_joints
from sim_export.physics.standing import DOWN, center_of_mass, depth_of_mass, must_stand, stable_margin
from sim_export.picture.draw import visual_meshes

FARTHEST = 30.0
"""Largest turn (degrees)."""


def stand_on_side(package: SimPackage) -> SimPackage:
    """A package of independent joints on the nearest side on which it stands, with a record; unchanged if it
    need not stand, does so already, or if no such side is near."""
    points = np.concatenate([np.zeros((0, 3)), *(hull.vertices for k in package.links for hull in k.hulls)])
    weighed = any(link.inertial is not None for link in package.links)
    if not must_stand(package.category) or not len(points) or not weighed:
        return package
    com = center_of_mass(package.links)
    before = depth_of_mass(points, com)
    if before >= 0.0:
        return package
    sides = ConvexHull(points).equations
    normals = np.unique(np.round(sides[:, :3], 4), axis=0)
    for normal in normals[np.argsort(_angles(normals), kind="stable")]:
        side = _roll(sides, com, normal)
        angle = float(_angles(side))
        if angle <= FARTHEST and depth_of_mass(points, com, side) >= stable_margin(points):
            break
    else:
        return package
    turned = turn_package(package, _turn_onto_floor(side), points)
    record = (
        f"mend stand (V303): the object was turned by {angle:.1f} degrees onto a side on which it "
        f"stands; its centre of mass was {1e3 * -before:.0f} mm outside of what touched the floor"
    )
    links, footed = add_feet(
        turned.links, turned.joints, turned.requires_open, _shown_parts(turned), find=find_tips
    )
    joints = resist_joints(links, turned.joints)
    return replace(turned, links=links, joints=joints, records=(*package.records, record, *footed))


def _angles(normals: Float[np.ndarray, "*N 3"]) -> Float[np.ndarray, "*N"]:
    """Turns (degrees) that bring normals down."""
    return np.degrees(np.arccos(np.clip(normals @ DOWN, -1.0, 1.0)))


def _roll(
    sides: Float[np.ndarray, "S 4"], com: Float[np.ndarray, "3"], down: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "3"]:
    """Normal of the side on which an object comes to rest that is put down with another direction down.

    It rolls onto the side below its centre of mass, which is lower on each next one.

    Args:
        sides: Planes of the convex hull of all that can touch the floor, normals outwards.
        com: Its centre of mass, inside.
        down: The direction (unit vector).
    """
    heights = -(sides[:, :3] @ com + sides[:, 3])
    for _ in sides:
        falls = sides[:, :3] @ down
        ways = np.divide(heights, falls, out=np.full(len(sides), np.inf), where=falls > 0.0)
        before, down = down, sides[ways.argmin(), :3]
        if before @ down > 1.0 - 1e-12:
            break
    return down


def _shown_parts(package: SimPackage) -> dict[str, Mesh]:
    """What is seen of every part (m), as one mesh."""
    triangles: dict[str, list[np.ndarray]] = {}
    for visual in (visual for link in package.links for visual in link.visuals):
        triangles.setdefault(visual.part, []).extend(
            mesh.vertices[mesh.faces] for mesh in visual_meshes(visual)
        )
    return {part: as_mesh(np.concatenate(chunks)) for part, chunks in triangles.items()}


def _turn_onto_floor(normal: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """The smallest rotation that turns a normal down: a half turn about it, and one about the middle of
    both."""
    first = normal / np.linalg.norm(normal)
    half_turns = [2.0 * np.outer(n, n) / (n @ n) - np.eye(3) for n in (first, first + DOWN)]
    return half_turns[1] @ half_turns[0]


def turn_package(
    package: SimPackage, rotation: Float[np.ndarray, "3 3"], points: Float[np.ndarray, "N 3"]
) -> SimPackage:
    """The package with all that is in it turned; the middle of the box around ``points`` (m) stays in
    place."""
    turned = points @ rotation.T
    T = np.eye(4)
    T[:3, :3] = rotation
    T[:3, 3] = (points.min(axis=0) + points.max(axis=0) - turned.min(axis=0) - turned.max(axis=0)) / 2.0
    return replace(
        package,
        links=tuple(_turn_link(link, T) for link in package.links),
        joints=tuple(_turn_joint(joint, T) for joint in package.joints),
        handles=tuple(_turn_handle(handle, T) for handle in package.handles),
    )


def _turn_link(link: Link, T: Float[np.ndarray, "4 4"]) -> Link:
    R, inertial = T[:3, :3], link.inertial
    return replace(
        link,
        visuals=tuple(_turn_visual(visual, T) for visual in link.visuals),
        hulls=tuple(Hull(vertices=transform_points(T, h.vertices), faces=h.faces) for h in link.hulls),
        inertial=inertial
        and replace(
            inertial, com=transform_points(T, inertial.com[None])[0], inertia=R @ inertial.inertia @ R.T
        ),
        splats=link.splats and transform_gaussians(link.splats, T),
    )


def _turn_visual(visual: Visual, T: Float[np.ndarray, "4 4"]) -> Visual:
    mesh = visual.mesh
    if isinstance(mesh, Mesh):
        return replace(visual, mesh=replace(mesh, vertices=transform_points(T, mesh.vertices)))
    return replace(visual, mesh=replace(mesh, T_object_file=T @ mesh.T_object_file))


def _turn_joint(joint: Joint, T: Float[np.ndarray, "4 4"]) -> Joint:
    axis = T[:3, :3] @ joint.axis
    return replace(joint, origin=transform_points(T, joint.origin[None])[0], axis=axis / np.linalg.norm(axis))


def _turn_handle(handle: HandleAnnotation, T: Float[np.ndarray, "4 4"]) -> HandleAnnotation:
    R = T[:3, :3]
    return replace(
        handle,
        corners=transform_points(T, handle.corners),
        normal=R @ handle.normal,
        grasp_line=transform_points(T, handle.grasp_line),
        opening_direction=R @ handle.opening_direction,
    )
