"""Animations of packages: all joints open and close, as an endless GIF."""

import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from artigen.camera import Camera
from artigen.io import write_whole
from sim_export.motion.kinematics import link_displacements
from sim_export.package import SimPackage
from sim_export.picture.draw import pose_surfaces, sweep_qpos
from sim_export.picture.image import render_standing
from sim_export.picture.preview import (
    PreviewConfig,
    Shapes,
    arrange_grid,
    frame_shapes,
    prepare_shapes,
)
from sim_export.picture.splats import DrawSplats, has_splats, pose_splats
from sim_export.picture.viewpoint import Viewpoint


@dataclass(frozen=True, kw_only=True)
class AnimationConfig:
    """Parameters of an animation."""

    states: int = 13
    """Frames from closed to open, both included; they are repeated in reverse order."""
    seconds: float = 4.0
    """Duration (seconds) of opening and closing, with a rest at both ends."""
    rest: float = 0.5
    """Seconds of each rest."""
    preview: PreviewConfig = field(
        default_factory=lambda: PreviewConfig(viewpoint=Viewpoint(width=280, height=280))
    )
    """View, light, and objects per row."""

    def __post_init__(self) -> None:
        if self.states < 2 or not 0 <= 2 * self.rest < self.seconds:
            raise ValueError(
                f"{self.states} states in {self.seconds:g} s with rests of {self.rest:g} s: expected at "
                "least 2 states, and rests that leave time to move"
            )


def animate_packages(
    packages: Sequence[SimPackage], cfg: AnimationConfig | None = None, draw_splats: DrawSplats | None = None
) -> list[UInt8[np.ndarray, "H W 3"]]:
    """Frames of packages in a grid, from all closed to all open.

    Gaussians are drawn below the meshes if any package has some and ``draw_splats`` is given.

    Raises:
        ValueError: If there are no packages, or one has nothing to draw.
    """
    cfg = cfg or AnimationConfig()
    if not packages:
        raise ValueError("an animation of no packages")
    splats = draw_splats if any(has_splats(package) for package in packages) else None
    every = [prepare_shapes(package, cfg.preview) for package in packages]
    cameras = [frame_shapes(shapes, cfg.preview, ("closed", "half", "open")) for shapes in every]
    return [
        arrange_grid(
            [
                _draw_state(shapes, float(time), camera, cfg.preview, splats)
                for shapes, camera in zip(every, cameras, strict=True)
            ],
            cfg.preview,
        )
        for time in np.linspace(0.0, 1.0, cfg.states)
    ]


def write_animation(
    folders: Sequence[Path],
    gif: Path,
    cfg: AnimationConfig | None = None,
    draw_splats: DrawSplats | None = None,
) -> None:
    """Writes a GIF of opening and closing packages.

    Args:
        draw_splats: Renderer of Gaussians; without it only meshes are shown.

    Raises:
        PackageError: If a folder is not a readable package.
    """
    from PIL import Image

    from sim_export.files.read import read_package

    cfg = cfg or AnimationConfig()
    states = animate_packages([read_package(folder) for folder in folders], cfg, draw_splats)
    order = [*range(len(states)), *range(len(states) - 2, 0, -1)]
    step = (cfg.seconds - 2.0 * cfg.rest) / max(len(order) - 2, 1)
    times = [1000.0 * (cfg.rest if at in (0, len(states) - 1) else step) for at in order]
    # One palette for all frames prevents flicker of static parts.
    palette = Image.fromarray(np.concatenate([states[0], states[-1]])).quantize(256)
    frames = [Image.fromarray(states[at]).quantize(palette=palette, dither=Image.Dither.NONE) for at in order]
    stream = io.BytesIO()
    frames[0].save(
        stream,
        format="gif",
        save_all=True,
        append_images=frames[1:],
        duration=[round(time) for time in times],
        loop=0,
        optimize=False,
    )
    write_whole(gif, stream.getvalue())


def _draw_state(
    shapes: Shapes, time: float, camera: Camera, cfg: PreviewConfig, draw_splats: DrawSplats | None
) -> UInt8[np.ndarray, "H W 3"]:
    """One frame between all closed and all open: meshes, with Gaussians below them."""
    package = shapes.package
    T = link_displacements(package.links, package.joints, sweep_qpos(package, time))
    picture = render_standing(pose_surfaces(shapes.visual, T), shapes.visual, camera, cfg.render)
    if draw_splats is None:
        return picture
    below = np.full_like(picture, cfg.render.background)
    if has_splats(package):
        below = draw_splats(pose_splats(package, T), camera, cfg.render.background)
    return np.concatenate([picture, below], axis=0)
