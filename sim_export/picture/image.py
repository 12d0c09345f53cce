"""One picture of a package: any camera, any pose; its meshes, its collision hulls or its Gaussians.

Previews, animations, thumbnails and `artigen.Object.render` are made here.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np
from jaxtyping import UInt8

from artigen.camera import Camera
from artigen.errors import check_option
from sim_export.errors import PackageError
from sim_export.motion.kinematics import driven_joints, link_displacements
from sim_export.package import SimPackage
from sim_export.picture.draw import hull_surfaces, open_qpos, package_surfaces, pose_surfaces
from sim_export.picture.lighting import RenderConfig
from sim_export.picture.raycast import Surface
from sim_export.picture.render import render_scene, surface_points
from sim_export.picture.splats import DrawSplats, has_splats, pose_splats
from sim_export.picture.viewpoint import Viewpoint, place_camera

Layer = Literal["visual", "collision", "gaussians"]
Lighting = Literal["quick", "catalogue"]
"""Light of pictures of meshes: that of previews, or a studio (`sim_export.picture.catalogue`)."""


def read_pose(package: SimPackage, q: Mapping[str, float] | float) -> Mapping[str, float]:
    """Coordinates (m, rad) of driven joints by name.

    Args:
        package: The package.
        q: Coordinates by joint; or the share of its range, 0 to 1, to which every joint is open, but those
            that need another one to be open further.

    Raises:
        PackageError: If a name is not that of a driven joint, or a share is not from 0 to 1.
    """
    if not isinstance(q, Mapping):
        if not 0.0 <= q <= 1.0:
            raise PackageError(
                f"{package.name}: pose {q}, expected a share from 0 to 1, or coordinates by joint such as "
                "{'joint_0': 0.3}"
            )
        return open_qpos(package, q)
    names = [joint.name for joint in driven_joints(package.joints)]
    unknown = sorted(set(q) - set(names))
    if unknown:
        raise PackageError(
            f"{package.name}: no joint {', '.join(unknown)} to pose; it has {', '.join(names) or 'none'}"
        )
    return q


def render_package(
    package: SimPackage,
    camera: Camera | Viewpoint | None = None,
    q: Mapping[str, float] | float = 0.0,
    layer: Layer = "visual",
    *,
    light: Lighting = "quick",
    cfg: RenderConfig | None = None,
    draw_splats: DrawSplats | None = None,
) -> UInt8[np.ndarray, "H W 3"]:
    """Renders a package on the floor that it stands on when closed.

    Args:
        package: The package.
        camera: A camera in the object frame; or a viewpoint, by default in front, to the left and above, from
            which the posed object fills the picture.
        q: Pose, see `read_pose`.
        layer: The meshes, the collision hulls in colours of their own, or the Gaussians.
        light: ``catalogue`` for a studio, which needs Mitsuba 3 and takes seconds to minutes.
        cfg: Light and sampling of quick pictures.
        draw_splats: Renderer of Gaussians, for these only.

    Raises:
        PackageError: If the package has nothing to draw in that layer, or lacks a joint of ``q``; or if
            Mitsuba is not installed.
    """
    check_option("layer", layer, get_args(Layer))
    check_option("light", light, get_args(Lighting))
    cfg = cfg or RenderConfig()
    T = link_displacements(package.links, package.joints, read_pose(package, q))
    closed = package_surfaces(package)
    surfaces = hull_surfaces(package) if layer == "collision" else closed
    posed = pose_surfaces(surfaces, T)
    if not len(surface_points(posed)) or (layer == "gaussians" and not has_splats(package)):
        raise PackageError(f"package {package.name!r} has no {layer} to render")
    if not isinstance(camera, Camera):
        camera = place_camera(surface_points(posed), camera or Viewpoint())
    if layer == "gaussians":
        if draw_splats is None:
            raise PackageError(f"package {package.name!r}: Gaussians need a renderer of them, draw_splats")
        return draw_splats(pose_splats(package, T), camera, cfg.background)
    return render_standing(posed, closed or surfaces, camera, cfg, light)


def render_standing(
    posed: Sequence[Surface],
    closed: Sequence[Surface],
    camera: Camera,
    cfg: RenderConfig,
    light: Lighting = "quick",
) -> UInt8[np.ndarray, "H W 3"]:
    """Renders surfaces of an object in any pose, on the floor that it stands on when closed."""
    ground = cfg.ground_height
    if ground is None:
        ground = float(surface_points(closed)[:, 2].min())
    if light == "catalogue":
        from sim_export.picture.catalogue import render_catalogue

        return render_catalogue(posed, camera, ground)
    return render_scene(posed, camera, replace(cfg, ground_height=ground))
