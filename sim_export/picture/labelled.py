"""Pictures of a package with exact labels: depth, parts, amodal boxes, and joints in the camera's frame."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int, UInt8

from artigen.camera import Camera, pixel_rays, project_points
from artigen.kinematics import joint_coordinates
from artigen.types import PartLabel
from sim_export.motion.kinematics import link_displacements
from sim_export.package import SimPackage
from sim_export.picture.draw import visual_meshes
from sim_export.picture.image import read_pose, render_package
from sim_export.picture.raycast import build_scene, cast_rays, surface_ids_at
from sim_export.picture.render import move_surface, surface_from_mesh


@dataclass(frozen=True, kw_only=True, eq=False)
class ShownPart:
    """A part of the object: its link, its label, and the box (left, top, right, bottom; pixels) around all of
    it, hidden or outside of the picture or not."""

    name: str
    link: str
    label: PartLabel | None
    amodal: tuple[float, float, float, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class ShownJoint:
    """A moving joint at its coordinate ``q`` (m or rad). Origin (m) and axis are in the camera's frame,
    with x to the right, y down and z forward."""

    name: str
    link: str
    type: str
    q: float
    lower: float
    upper: float
    origin: Float[np.ndarray, "3"]
    axis: Float[np.ndarray, "3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class LabelledImage:
    """A picture with labels per pixel.

    ``depth`` is along the viewing direction, in metres, and 0 where nothing is. ``parts`` indexes
    ``shown``, -1 where nothing is; what is seen through glass belongs to the glass.
    """

    image: UInt8[np.ndarray, "H W 3"]
    depth: Float[np.ndarray, "H W"]
    parts: Int[np.ndarray, "H W"]
    shown: tuple[ShownPart, ...]
    joints: tuple[ShownJoint, ...]
    intrinsics: Float[np.ndarray, "3 3"]
    T_camera_object: Float[np.ndarray, "4 4"]


def render_labelled(
    package: SimPackage, camera: Camera, q: Mapping[str, float] | float = 0.0
) -> LabelledImage:
    """Renders the visuals of a package with labels.

    Args:
        package: The package.
        camera: A camera in the object frame, whose axes are orthogonal.
        q: Pose, as in `read_pose`.

    Raises:
        PackageError: If the package has nothing to draw, or lacks a joint of ``q``.
        ValueError: If the axes of the camera are not orthogonal.
    """
    if not np.allclose(camera.axes @ camera.axes.T, np.eye(3), atol=1e-9):
        raise ValueError("camera axes are not orthogonal, so that the picture has no intrinsics")
    pose = read_pose(package, q)
    image = render_package(package, camera, pose)
    T = link_displacements(package.links, package.joints, pose)
    surfaces, shown = [], []
    for slot, link in enumerate(package.links):
        for part in dict.fromkeys(visual.part for visual in link.visuals):
            visuals = [visual for visual in link.visuals if visual.part == part]
            meshes = [mesh for visual in visuals for mesh in visual_meshes(visual)]
            own = [move_surface(surface_from_mesh(mesh, surface_id=len(shown)), T[slot]) for mesh in meshes]
            surfaces += own
            corners = np.concatenate([surface.triangles.reshape(-1, 3) for surface in own])
            shown.append(
                ShownPart(name=part, link=link.name, label=visuals[0].label, amodal=_box(camera, corners))
            )
    scene, shape = build_scene(surfaces), (camera.height, camera.width)
    hits = cast_rays(scene, camera.position, pixel_rays(camera).reshape(-1, 3))
    depth, parts = np.zeros(shape), np.full(shape, -1)
    depth.flat[hits.place] = hits.depth
    parts.flat[hits.place] = surface_ids_at(scene, hits)
    return LabelledImage(
        image=image,
        depth=depth,
        parts=parts,
        shown=tuple(shown),
        joints=_find_joints(package, pose, T, camera),
        intrinsics=find_intrinsics(camera),
        T_camera_object=_find_pose(camera),
    )


def find_intrinsics(camera: Camera) -> Float[np.ndarray, "3 3"]:
    """The pinhole matrix: focal lengths and centre in pixels, with pixel centres at halves."""
    focal = 1.0 / camera.pixel
    return np.array([[focal, 0.0, camera.width / 2.0], [0.0, focal, camera.height / 2.0], [0.0, 0.0, 1.0]])


def _find_pose(camera: Camera) -> Float[np.ndarray, "4 4"]:
    """Maps the object frame to the camera's: x right, y down, z forward."""
    T = np.eye(4)
    T[:3, :3] = camera.axes
    T[:3, 3] = -camera.axes @ camera.position
    return T


def _box(camera: Camera, corners: Float[np.ndarray, "N 3"]) -> tuple[float, float, float, float]:
    seen = project_points(camera, corners)
    seen = seen[seen[:, 2] > 0.0, :2]
    if not len(seen):
        return (0.0, 0.0, 0.0, 0.0)
    (left, top), (right, bottom) = seen.min(axis=0), seen.max(axis=0)
    return float(left), float(top), float(right), float(bottom)


def _find_joints(
    package: SimPackage, pose: Mapping[str, float], T: Float[np.ndarray, "L 4 4"], camera: Camera
) -> tuple[ShownJoint, ...]:
    """All moving joints with their axes where their parents carry them."""
    slots = {link.name: index for index, link in enumerate(package.links)}
    T_camera = _find_pose(camera)
    coordinates = joint_coordinates([joint.name for joint in package.joints], package.joints, pose)
    found = []
    for joint, q in zip(package.joints, coordinates, strict=True):
        if joint.type == "fixed":
            continue
        carried = T_camera @ T[slots[joint.parent]]
        found.append(
            ShownJoint(
                name=joint.name,
                link=joint.child,
                type=joint.type,
                q=float(q),
                lower=joint.lower,
                upper=joint.upper,
                origin=carried[:3, :3] @ joint.origin + carried[:3, 3],
                axis=carried[:3, :3] @ joint.axis,
            )
        )
    return tuple(found)
