"""Shows a package in the browser: joint sliders, visual and collision meshes, Gaussians, handle annotations.

`build_view` starts a viser server and returns its handles without blocking. Each group that can be
shown or hidden is one branch of the scene with one frame per link. A pose is set by moving frames, so that no
mesh is sent twice. Gaussians, if the package has any, stand to the right of the meshes, as seen from the
front, and move with them.
"""

import threading
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from jaxtyping import Float

from artigen.splats.colors import srgb_from_linear
from artigen.transforms import matrix_from_quat, quat_from_matrix
from artigen.types import Joint
from sim_export.files.glb import textured_trimesh
from sim_export.geometry.triangles import diagonal_of
from sim_export.motion.kinematics import driven_joints, link_displacements
from sim_export.package import HandleAnnotation, Mesh, SimPackage
from sim_export.picture.draw import hull_surfaces, open_end, package_surfaces
from sim_export.picture.raycast import Surface
from sim_export.picture.render import surface_points
from sim_export.picture.splats import has_splats
from sim_export.picture.viewpoint import Viewpoint, place_camera

if TYPE_CHECKING:
    import viser

Group = Literal["visual", "splats", "collision", "grasp_line", "normal", "opening_direction"]
GROUPS: tuple[Group, ...] = get_args(Group)
BESIDE = 0.25
"""Gap between the meshes and the Gaussians beside them, relative to the object's width."""

COLORS: Mapping[str, tuple[int, int, int]] = {
    "grasp_line": (214, 39, 40),
    "normal": (31, 119, 180),
    "opening_direction": (44, 160, 44),
}


@dataclass(frozen=True, kw_only=True, eq=False)
class PackageView:
    """The running server and its controls.

    Sliders of turning joints are in degrees, those of sliding joints in metres.
    """

    server: "viser.ViserServer"
    sliders: Mapping[str, "viser.GuiSliderHandle[float]"]
    """Slider of each joint, by joint name."""
    toggles: Mapping[Group, "viser.GuiCheckboxHandle"]
    """Checkbox that shows or hides each group."""
    open_all: "viser.GuiButtonHandle"
    close_all: "viser.GuiButtonHandle"
    branches: Mapping[Group, "viser.FrameHandle"]
    """Root frame of each group, which controls its visibility."""
    frames: Mapping[tuple[Group, str], "viser.FrameHandle"]
    """The frame of each link, by group and link name; its pose is the link's displacement from rest."""


def build_view(package: SimPackage, *, port: int = 8080) -> PackageView:
    """Starts a server that shows ``package`` and returns without blocking; stop it with ``server.stop()``.

    viser takes the next free port if ``port`` is in use; ``server.get_port()`` returns it.
    """
    import viser

    visual, hulls = package_surfaces(package), hull_surfaces(package)
    server = viser.ViserServer(host="127.0.0.1", port=port, label=package.name, verbose=False)
    _place_camera(server, visual)
    branches, frames = _add_branches(server, package)
    for group, surfaces in (("visual", visual), ("collision", hulls)):
        for index, surface in enumerate(surfaces):
            path = f"/{group}/{package.links[surface.id].name}/{index}"
            look = Mesh(
                vertices=surface.triangles.reshape(-1, 3),
                faces=np.arange(3 * len(surface.triangles)).reshape(-1, 3),
                uv=surface.uv,
                texture=surface.texture,
                normal_map=surface.normal_map,
                color=surface.color,
                material=surface.material,
            )
            mesh = textured_trimesh(surface.triangles, look, surface.normals)
            server.scene.add_mesh_trimesh(path, mesh)
    for index, handle in enumerate(package.handles):
        _add_handle(server, handle, index)
    _add_splats(server, package, branches["splats"], visual)
    view = _add_controls(server, package, branches, frames)
    _connect(view, package)
    return view


def slider_scale(joint: Joint) -> float:
    """Joint units (rad, m) per slider unit (degrees, m)."""
    return 1.0 if joint.type == "prismatic" else float(np.pi / 180.0)


def view_qpos(view: PackageView, package: SimPackage) -> dict[str, float]:
    """The joint coordinates (rad, m) of the sliders."""
    return {
        joint.name: view.sliders[joint.name].value * slider_scale(joint)
        for joint in driven_joints(package.joints)
    }


def _place_camera(server: "viser.ViserServer", surfaces: tuple[Surface, ...]) -> None:
    points = surface_points(surfaces)
    server.scene.set_up_direction("+z")
    if not len(points):
        return
    low, high = points.min(axis=0), points.max(axis=0)
    camera = place_camera(points, Viewpoint(fov=40.0, margin=0.2))
    server.initial_camera.position = tuple(camera.position)
    server.initial_camera.look_at = tuple((low + high) / 2.0)
    width = 4.0 * float((high - low).max())
    server.scene.add_grid(
        "/floor", width, width, cell_size=0.1, section_size=1.0, position=(0.0, 0.0, float(low[2]))
    )


def _add_branches(
    server: "viser.ViserServer", package: SimPackage
) -> tuple[dict[Group, "viser.FrameHandle"], dict[tuple[Group, str], "viser.FrameHandle"]]:
    branches, frames = {}, {}
    for group in GROUPS:
        shown = _shown_at_first(package, group)
        branches[group] = server.scene.add_frame(f"/{group}", show_axes=False, visible=shown)
        for link in package.links:
            frames[group, link.name] = server.scene.add_frame(f"/{group}/{link.name}", show_axes=False)
    return branches, frames


def _shown_at_first(package: SimPackage, group: Group) -> bool:
    return group == "visual" or (group == "splats" and has_splats(package))


def _add_splats(
    server: "viser.ViserServer", package: SimPackage, branch: "viser.FrameHandle", visual: tuple[Surface, ...]
) -> None:
    """Adds the Gaussians of all links, with the whole branch beside the meshes."""
    for link in package.links:
        if link.splats is None:
            continue
        axes = matrix_from_quat(link.splats.quats) * link.splats.scales[:, None, :]
        server.scene.add_gaussian_splats(
            f"/splats/{link.name}/0",
            centers=link.splats.means,
            covariances=(axes @ np.swapaxes(axes, 1, 2)).astype(np.float32),
            rgbs=np.clip(srgb_from_linear(link.splats.colors), 0.0, 1.0).astype(np.float32),
            opacities=link.splats.opacities[:, None],
        )
    points = surface_points(visual)
    if has_splats(package) and len(points):
        branch.position = (0.0, -(1.0 + BESIDE) * float(np.ptp(points[:, 1])), 0.0)


def _add_handle(server: "viser.ViserServer", handle: HandleAnnotation, index: int) -> None:
    middle = handle.grasp_line.mean(axis=0)
    size = 0.5 * diagonal_of(handle.corners)
    server.scene.add_line_segments(
        f"/grasp_line/{handle.link}/{index}", handle.grasp_line[None], COLORS["grasp_line"], thickness=0.006
    )
    for group, direction in (("normal", handle.normal), ("opening_direction", handle.opening_direction)):
        tip = middle + direction * max(size, 0.08)
        server.scene.add_arrows(
            f"/{group}/{handle.link}/{index}", np.stack([middle, tip])[None], COLORS[group],
            shaft_radius=0.003, head_radius=0.008, head_length=0.02,
        )  # fmt: skip


def _add_controls(
    server: "viser.ViserServer",
    package: SimPackage,
    branches: Mapping[Group, "viser.FrameHandle"],
    frames: Mapping[tuple[Group, str], "viser.FrameHandle"],
) -> PackageView:
    with server.gui.add_folder("Show"):
        toggles: dict[Group, viser.GuiCheckboxHandle] = {
            group: server.gui.add_checkbox(group.replace("_", " "), _shown_at_first(package, group))
            for group in GROUPS
        }
    with server.gui.add_folder("Joints"):
        open_all = server.gui.add_button("Open all")
        close_all = server.gui.add_button("Close all")
        sliders = {joint.name: _add_slider(server, joint) for joint in driven_joints(package.joints)}
    return PackageView(
        server=server, sliders=sliders, toggles=toggles, open_all=open_all,
        close_all=close_all, branches=branches, frames=frames,
    )  # fmt: skip


def _slider_range(joint: Joint) -> tuple[float, float]:
    """Limits in slider units; a joint without limits gets a full turn in either direction."""
    if joint.type == "continuous":
        return -360.0, 360.0
    return joint.lower / slider_scale(joint), joint.upper / slider_scale(joint)


def _add_slider(server: "viser.ViserServer", joint: Joint) -> "viser.GuiSliderHandle[float]":
    low, high = _slider_range(joint)
    unit = "m" if joint.type == "prismatic" else "deg"
    # A joint with an empty range has a slider that cannot move.
    step = max((high - low) / 500.0, 1e-6)
    return server.gui.add_slider(
        f"{joint.name} ({unit})", low, max(high, low + step), step, _rest(joint), hint=f"moves {joint.child}"
    )


def _rest(joint: Joint) -> float:
    low, high = _slider_range(joint)
    return float(np.clip(0.0, low, high))


def _connect(view: PackageView, package: SimPackage) -> None:
    lock = threading.Lock()

    def follow_sliders(_: object = None) -> None:
        # Callbacks run in several threads; the last one to take the lock sees every slider.
        with lock, view.server.atomic():
            T = link_displacements(package.links, package.joints, view_qpos(view, package))
            _pose_frames(view, package, T)

    def set_all(fraction: float) -> None:
        for joint in driven_joints(package.joints):
            target = fraction * open_end(joint) / slider_scale(joint)
            view.sliders[joint.name].value = target if fraction else _rest(joint)

    for slider in view.sliders.values():
        slider.on_update(follow_sliders)
    view.open_all.on_click(lambda _: set_all(1.0))
    view.close_all.on_click(lambda _: set_all(0.0))
    for group, toggle in view.toggles.items():
        toggle.on_update(lambda event, group=group: _show(view, group, shown=event.target.value))
    follow_sliders()


def _show(view: PackageView, group: Group, *, shown: bool) -> None:
    view.branches[group].visible = shown


def _pose_frames(view: PackageView, package: SimPackage, T: Float[np.ndarray, "L 4 4"]) -> None:
    quats = quat_from_matrix(T[:, :3, :3])
    for group in GROUPS:
        for index, link in enumerate(package.links):
            frame = view.frames[group, link.name]
            frame.wxyz, frame.position = quats[index], T[index, :3, 3]
