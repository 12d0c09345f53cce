"""Drawable surfaces of a package: its visuals or hulls in any pose, coloured by purpose.

The id of a surface is the index of its link. Poses are the displacements from
`sim_export.motion.kinematics.link_displacements` for joint coordinates; `explode_links` adds offsets that
separate the links.
"""

import colorsys
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from artigen.files.mtl import MtlMaterial
from artigen.transforms import joint_motion, transform_points
from artigen.types import Joint
from sim_export.errors import PackageError
from sim_export.files.obj import material_of, parse_mtl, parse_obj, read_image
from sim_export.geometry.triangles import area_normals, diagonal_of
from sim_export.motion.kinematics import driven_joints, link_displacements
from sim_export.package import Hull, Mesh, SimPackage, SourceMesh, Visual
from sim_export.picture.raycast import Surface
from sim_export.picture.render import move_surface, surface_from_mesh, surface_points

CONTINUOUS_OPEN = np.pi / 2
"""Open position (radians) of a joint without limits: a quarter turn."""

HAIR = 2e-5
"""Step by which drawn hulls are enlarged, as a fraction of the object's diagonal."""
HAIRS = 24
"""Number of different steps."""


def distinct_color(index: int) -> tuple[float, float, float]:
    """The ``index``-th of an endless sequence of distinct sRGB colours."""
    hue = (0.58 + index * 0.618033988749895) % 1.0
    return colorsys.hsv_to_rgb(hue, (0.52, 0.62, 0.40)[index % 3], (0.94, 0.78, 0.86)[index % 3])


def load_source_meshes(source: SourceMesh) -> tuple[Mesh, ...]:
    """A source OBJ as meshes in the object frame, one per material.

    Raises:
        PackageError: If the OBJ, its MTL or an image cannot be read.
    """
    data = parse_obj(source.path)
    materials = parse_mtl(source.path.parent / data.libraries[-1]) if data.libraries else {}
    vertices = transform_points(source.T_object_file, data.vertices * source.scale)
    meshes = []
    for name in dict.fromkeys(data.face_materials.tolist()):
        if name and data.libraries and name not in materials:
            raise PackageError(
                f"{source.path}: material {name!r} is not in {data.libraries[-1]}, which has "
                f"{', '.join(sorted(materials)) or 'none'}"
            )
        said = materials.get(name, MtlMaterial())
        image = said.image
        own = data.face_materials == name
        faces, uv_faces = data.faces[own], data.uv_faces[own]
        uv, texture = None, None
        if image and len(data.coords) and (uv_faces >= 0).all():
            uv, texture = data.coords[uv_faces], read_image(source.path.parent / image)
        mesh = Mesh(
            vertices=vertices,
            faces=faces,
            uv=uv,
            texture=texture,
            color=said.color,
            material=material_of(said),
        )
        meshes.append(mesh)
    return tuple(meshes)


def visual_meshes(visual: Visual) -> tuple[Mesh, ...]:
    """The meshes of a visual in the object frame at rest; a source mesh is read from its file."""
    return load_source_meshes(visual.mesh) if isinstance(visual.mesh, SourceMesh) else (visual.mesh,)


def package_surfaces(package: SimPackage) -> tuple[Surface, ...]:
    """All visual surfaces at rest; each surface's id is the index of its link."""
    return tuple(
        surface_from_mesh(mesh, surface_id=index)
        for index, link in enumerate(package.links)
        for visual in link.visuals
        for mesh in visual_meshes(visual)
    )


def hull_surfaces(package: SimPackage) -> tuple[Surface, ...]:
    """Hulls in their own colours, each enlarged by a different small amount.

    Hulls overlap and often share a plane; the enlargement determines which of them is visible there.
    """
    vertices = [hull.vertices for link in package.links for hull in link.hulls]
    if not vertices:
        return ()
    hair = HAIR * diagonal_of(np.concatenate(vertices))
    surfaces = []
    for index, link in enumerate(package.links):
        for place, hull in enumerate(link.hulls):
            mesh = Mesh(
                vertices=swell_hull(hull, hair * (len(surfaces) % HAIRS)),
                faces=hull.faces,
                color=distinct_color(index * 7 + place),
            )
            surfaces.append(surface_from_mesh(mesh, surface_id=index, crease=0.0))
    return tuple(surfaces)


def swell_hull(hull: Hull, amount: float) -> Float[np.ndarray, "V 3"]:
    """Vertices of the hull with its faces moved outward by at most ``amount`` (metres)."""
    corners = hull.vertices[hull.faces]
    normals = area_normals(corners)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    # Count the triangles of one flat face once.
    _, first, kind = np.unique(np.round(normals, 3), axis=0, return_index=True, return_inverse=True)
    pairs = np.unique(np.stack([hull.faces.ravel(), np.repeat(kind.ravel(), 3)]), axis=1)
    outward = np.zeros_like(hull.vertices)
    np.add.at(outward, pairs[0], normals[first][pairs[1]])
    reach = np.full(len(outward), 1e-30)
    np.maximum.at(reach, pairs[0], (outward[pairs[0]] * normals[first][pairs[1]]).sum(axis=1))
    return hull.vertices + outward * (amount / np.maximum(reach, 1.0))[:, None]


def pose_surfaces(surfaces: Sequence[Surface], T: Float[np.ndarray, "L 4 4"]) -> tuple[Surface, ...]:
    """Moves surfaces of `package_surfaces` with their links."""
    return tuple(move_surface(surface, T[surface.id]) for surface in surfaces)


def open_end(joint: Joint) -> float:
    """Coordinate of an open joint: the limit farther from rest, or a quarter turn."""
    if joint.type == "continuous":
        return CONTINUOUS_OPEN
    return joint.upper if abs(joint.upper) >= abs(joint.lower) else joint.lower


def open_qpos(package: SimPackage, fraction: float) -> dict[str, float]:
    """Coordinates of all driven joints, opened to ``fraction`` of their range.

    A joint that requires another one to be open further than that (a tray behind a door) stays closed.
    """
    shut = {need.joint for need in package.requires_open if need.fraction > fraction}
    return {
        joint.name: 0.0 if joint.name in shut else fraction * open_end(joint)
        for joint in driven_joints(package.joints)
    }


def open_links(package: SimPackage, fraction: float) -> Float[np.ndarray, "L 4 4"]:
    """Displacements of all links with every joint opened to ``fraction`` of its range."""
    return link_displacements(package.links, package.joints, open_qpos(package, fraction))


def sweep_qpos(package: SimPackage, time: float) -> dict[str, float]:
    """Coordinates of all driven joints at ``time`` between all closed (0) and all open (1).

    A joint that requires another one to be open starts after it, so that the motion is physically possible.
    Each joint eases in and out.
    """
    needs = [(need.joint, need.needs) for need in package.requires_open]

    def turn(joint: str) -> int:
        return max((turn(other) + 1 for name, other in needs if name == joint), default=0)

    joints = driven_joints(package.joints)
    turns = {joint.name: turn(joint.name) for joint in joints}
    total = max(turns.values(), default=0) + 1
    share = {name: min(max(time * total - at, 0.0), 1.0) for name, at in turns.items()}
    return {
        joint.name: (0.5 - 0.5 * float(np.cos(np.pi * share[joint.name]))) * open_end(joint)
        for joint in joints
    }


def explode_links(
    package: SimPackage, surfaces: Sequence[Surface], spread: float
) -> Float[np.ndarray, "L 4 4"]:
    """Displacements that separate the links at rest.

    Every link moves with its parent and additionally by ``spread`` times the object's diagonal in the
    direction of its joint's opening motion. A link that turns in place moves along its axis; a fixed one
    stays.
    """
    centers = _link_centers(len(package.links), surfaces)
    points = surface_points(surfaces)
    step = spread * diagonal_of(points) if len(points) else 0.0
    joint_of = {joint.child: joint for joint in package.joints}
    slot = {link.name: index for index, link in enumerate(package.links)}
    T = np.tile(np.eye(4), (len(package.links), 1, 1))
    for index, link in enumerate(package.links):
        at: str | None = link.name
        while at in joint_of:
            joint = joint_of[at]
            T[index, :3, 3] += step * _way_out(joint, centers[slot[at]], centers[slot[joint.parent]])
            at = joint.parent
    return T


def _link_centers(count: int, surfaces: Sequence[Surface]) -> np.ndarray:
    centers = np.zeros((count, 3))
    for index in range(count):
        points = surface_points([surface for surface in surfaces if surface.id == index])
        if len(points):
            centers[index] = (points.min(axis=0) + points.max(axis=0)) / 2.0
    return centers


def _way_out(joint: Joint, center: np.ndarray, parent: np.ndarray) -> np.ndarray:
    if joint.type == "fixed" or joint.follows is not None:
        return np.zeros(3)
    start = np.array(0.02 * np.sign(open_end(joint)))
    moved = transform_points(joint_motion(joint, start), center[None])[0] - center
    arm = np.linalg.norm(np.cross(center - joint.origin, joint.axis))
    extent = max(float(np.linalg.norm(center - parent)), 1e-9)
    if joint.type != "prismatic" and arm < 0.05 * extent:
        return joint.axis * (1.0 if (center - parent) @ joint.axis >= 0 else -1.0)
    length = float(np.linalg.norm(moved))
    return moved / length if length > 0 else np.zeros(3)
