"""Pictures of packages: one row of states for an object, and a contact sheet for many.

If an object has Gaussians and the caller can render them, they are shown below the meshes from the same
cameras. Meshes are shaded; Gaussians show their own colours without lighting.

All panels of a row share one camera in front of the object, to its left and above, which frames the object in
every state.
"""

import io
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float, UInt8

from artigen.camera import Camera
from artigen.io import write_whole
from sim_export.files.obj import png_bytes
from sim_export.motion.kinematics import driven_joints
from sim_export.package import SimPackage
from sim_export.picture.draw import explode_links, hull_surfaces, open_links, package_surfaces, pose_surfaces
from sim_export.picture.image import Lighting, render_standing
from sim_export.picture.lighting import RenderConfig
from sim_export.picture.raycast import Surface
from sim_export.picture.render import surface_points
from sim_export.picture.splats import DrawSplats, has_splats, pose_splats
from sim_export.picture.viewpoint import Viewpoint, place_camera

Panel = Literal["closed", "half", "open", "exploded", "collision"]
SPLAT_PANELS: tuple[Panel, ...] = ("closed", "half", "open", "exploded")
"""Panels that also show Gaussians."""
PANEL_CAPTIONS: dict[Panel, str] = {
    "closed": "closed",
    "half": "half open",
    "open": "open",
    "exploded": "exploded",
    "collision": "collision hulls",
}

INK = (38, 42, 50)
PALE_INK = (110, 116, 128)
QUALITY = 80
"""WebP quality."""
PANELS: tuple[Panel, ...] = ("closed", "open")
"""Panels of contact sheets and thumbnails."""
SPREAD = 0.25
"""Distance that exploded links move, as a fraction of the object's diagonal."""


@dataclass(frozen=True, kw_only=True)
class PreviewConfig:
    """Content and size of a preview."""

    panels: tuple[Panel, ...] = ("closed", "half", "open", "exploded", "collision")
    """States to draw, left to right."""
    viewpoint: Viewpoint = field(default_factory=Viewpoint)
    """Viewpoint of the camera and pixels per panel."""
    render: RenderConfig = field(default_factory=RenderConfig)
    """Light and sampling of quick pictures."""
    light: Lighting = "quick"
    """Light of meshes."""
    columns: int = 4
    """Objects in a row of a contact sheet."""

    def __post_init__(self) -> None:
        if not self.panels:
            raise ValueError("a preview needs at least one panel")
        if self.columns < 1:
            raise ValueError(f"a contact sheet with {self.columns} columns, allowed is 1 and above")


@dataclass(frozen=True, kw_only=True, eq=False)
class Shapes:
    """Drawable data of one package, prepared once."""

    package: SimPackage
    visual: tuple[Surface, ...]
    hulls: tuple[Surface, ...]
    exploded: Float[np.ndarray, "L 4 4"]


def describe_size(package: SimPackage) -> str:
    """Width (along y), depth (along x) and height of the closed object in metres."""
    points = surface_points(package_surfaces(package))
    depth, width, height = np.ptp(points, axis=0) if len(points) else np.zeros(3)
    return f"{width:.2f} m wide, {depth:.2f} m deep, {height:.2f} m high"


def describe_joints(package: SimPackage) -> str:
    """Number of driven joints, by type."""
    types = [joint.type for joint in driven_joints(package.joints)]
    kinds = ", ".join(f"{types.count(kind)} {kind}" for kind in sorted(set(types)))
    plural = "joint" if len(types) == 1 else "joints"
    return f"{len(types)} {plural}" + (f" ({kinds})" if kinds else "")


def preview_package(
    package: SimPackage, cfg: PreviewConfig | None = None, draw_splats: DrawSplats | None = None
) -> UInt8[np.ndarray, "H W 3"]:
    """One row: the states of ``cfg.panels`` side by side, under the object's name and size.

    A second row shows the Gaussians of the package, if it has any and ``draw_splats`` is given.

    Raises:
        ValueError: If the package has nothing to draw.
    """
    cfg = PreviewConfig() if cfg is None else cfg
    shapes = prepare_shapes(package, cfg)
    camera = frame_shapes(shapes, cfg, cfg.panels)
    tiles = [
        caption_below(draw_panel(shapes, panel, camera, cfg), PANEL_CAPTIONS[panel], cfg.render.background)
        for panel in cfg.panels
    ]
    row = np.concatenate(tiles, axis=1)
    if draw_splats is not None and has_splats(package):
        drawn = [
            caption_below(
                _draw_splats(shapes, panel, camera, cfg, draw_splats),
                f"Gaussians, {PANEL_CAPTIONS[panel]}" if panel in SPLAT_PANELS else "",
                cfg.render.background,
            )
            for panel in cfg.panels
        ]
        row = np.concatenate([row, np.concatenate(drawn, axis=1)], axis=0)
    facts = "     ".join([package.category, describe_size(package), describe_joints(package)])
    return title_above(row, package.name, facts, cfg.render.background)


def contact_sheet(
    packages: Sequence[SimPackage], cfg: PreviewConfig | None = None, draw_splats: DrawSplats | None = None
) -> UInt8[np.ndarray, "H W 3"]:
    """Many packages, each closed beside open, in a grid of ``cfg.columns`` objects per row.

    Gaussians are drawn below the meshes if any package has some and ``draw_splats`` is given.
    """
    cfg = PreviewConfig() if cfg is None else cfg
    if not packages:
        raise ValueError("a contact sheet of no packages")
    cells = []
    for package in packages:
        shapes = prepare_shapes(package, cfg)
        camera = frame_shapes(shapes, cfg, PANELS)
        pair = np.concatenate([draw_panel(shapes, panel, camera, cfg) for panel in PANELS], axis=1)
        if draw_splats is not None and any(has_splats(one) for one in packages):
            below = [_draw_splats(shapes, panel, camera, cfg, draw_splats) for panel in PANELS]
            pair = np.concatenate([pair, np.concatenate(below, axis=1)], axis=0)
        cells.append(
            caption_below(pair, f"{package.name}     {describe_joints(package)}", cfg.render.background)
        )
    return arrange_grid(cells, cfg)


def arrange_grid(
    cells: Sequence[UInt8[np.ndarray, "H W 3"]], cfg: PreviewConfig
) -> UInt8[np.ndarray, "H2 W2 3"]:
    """Equally large pictures in rows of ``cfg.columns``; the rest of the last row is background."""
    columns = min(cfg.columns, len(cells))
    blank = np.full_like(cells[0], cfg.render.background)
    filled = [*cells, *[blank] * (-len(cells) % columns)]
    rows = [np.concatenate(filled[at : at + columns], axis=1) for at in range(0, len(filled), columns)]
    return np.concatenate(rows, axis=0)


def write_preview(
    folders: Sequence[Path],
    png: Path,
    cfg: PreviewConfig | None = None,
    draw_splats: DrawSplats | None = None,
) -> None:
    """Writes the row of one package, or the contact sheet of several, as a PNG.

    Args:
        draw_splats: Renderer of Gaussians; without it only meshes are shown.

    Raises:
        PackageError: If a folder is not a readable package.
    """
    from sim_export.files.read import read_package

    packages = [read_package(folder) for folder in folders]
    if len(packages) == 1:
        image = preview_package(packages[0], cfg, draw_splats)
    else:
        image = contact_sheet(packages, cfg, draw_splats)
    write_whole(png, png_bytes(image))


def prepare_shapes(package: SimPackage, cfg: PreviewConfig) -> Shapes:
    """Prepares the drawable data of a package.

    Raises:
        ValueError: If the package has nothing to draw.
    """
    visual = package_surfaces(package)
    hulls = hull_surfaces(package) if "collision" in cfg.panels else ()
    if not any(len(surface.triangles) for surface in visual):
        raise ValueError(f"package {package.name!r} has no visual triangles, there is nothing to draw")
    return Shapes(
        package=package, visual=visual, hulls=hulls, exploded=explode_links(package, visual, SPREAD)
    )


def _panel_pose(shapes: Shapes, panel: Panel) -> Float[np.ndarray, "L 4 4"]:
    """Displacements of all links in a panel."""
    if panel == "exploded":
        return shapes.exploded
    return open_links(shapes.package, {"closed": 0.0, "half": 0.5}.get(panel, 1.0))


def _panel_surfaces(shapes: Shapes, panel: Panel) -> tuple[Surface, ...]:
    return pose_surfaces(shapes.hulls if panel == "collision" else shapes.visual, _panel_pose(shapes, panel))


def frame_shapes(shapes: Shapes, cfg: PreviewConfig, panels: Sequence[Panel]) -> Camera:
    """A camera that frames every one of the panels."""
    points = [surface_points(_panel_surfaces(shapes, panel)) for panel in panels]
    return place_camera(np.concatenate(points), cfg.viewpoint)


def draw_panel(
    shapes: Shapes, panel: Panel, camera: Camera, cfg: PreviewConfig
) -> UInt8[np.ndarray, "H W 3"]:
    """Renders one state of a package with a camera of `frame_shapes`."""
    light = "quick" if panel == "collision" else cfg.light
    return render_standing(_panel_surfaces(shapes, panel), shapes.visual, camera, cfg.render, light)


def _draw_splats(
    shapes: Shapes, panel: Panel, camera: Camera, cfg: PreviewConfig, draw_splats: DrawSplats
) -> UInt8[np.ndarray, "H W 3"]:
    """The Gaussians in a panel's pose; blank if there are none, or the panel shows none."""
    if panel not in SPLAT_PANELS or not has_splats(shapes.package):
        return np.full((camera.height, camera.width, 3), cfg.render.background, dtype=np.uint8)
    return draw_splats(pose_splats(shapes.package, _panel_pose(shapes, panel)), camera, cfg.render.background)


def caption_below(
    image: UInt8[np.ndarray, "H W 3"], text: str, background: tuple[int, int, int]
) -> UInt8[np.ndarray, "H2 W 3"]:
    """The image with one centred line of text below it."""
    band = np.full((34, image.shape[1], 3), background, dtype=np.uint8)
    return np.concatenate([image, _write(band, text, 15, INK, centered=True)], axis=0)


def title_above(
    image: UInt8[np.ndarray, "H W 3"], title: str, facts: str, background: tuple[int, int, int]
) -> UInt8[np.ndarray, "H2 W 3"]:
    """The image below its title and a line of facts."""
    top = _write(np.full((40, image.shape[1], 3), background, dtype=np.uint8), title, 20, INK)
    below = _write(np.full((26, image.shape[1], 3), background, dtype=np.uint8), facts, 14, PALE_INK)
    return np.concatenate([top, below, image], axis=0)


def _write(
    band: np.ndarray, text: str, size: int, ink: tuple[int, int, int], *, centered: bool = False
) -> np.ndarray:
    from PIL import Image, ImageDraw, ImageFont

    picture = Image.fromarray(band)
    draw = ImageDraw.Draw(picture)
    font = ImageFont.load_default(size)
    room = band.shape[1] - 24
    while draw.textlength(text, font=font) > room and len(text) > 4:
        text = text[:-4] + "..."
    place = (band.shape[1] / 2, band.shape[0] / 2) if centered else (18.0, band.shape[0] / 2)
    draw.text(place, text, fill=ink, font=font, anchor="mm" if centered else "lm")
    return np.asarray(picture)


def draw_thumbnail(package: SimPackage, size: int) -> UInt8[np.ndarray, "H W 3"]:
    """The closed object beside the open one, each ``size`` x ``size`` pixels, with one camera.

    Raises:
        ValueError: If the package has nothing to draw.
    """
    cfg = PreviewConfig(panels=PANELS, viewpoint=Viewpoint(width=size, height=size))
    shapes = prepare_shapes(package, cfg)
    camera = frame_shapes(shapes, cfg, PANELS)
    return np.concatenate([draw_panel(shapes, panel, camera, cfg) for panel in PANELS], axis=1)


def webp_bytes(image: UInt8[np.ndarray, "H W 3"]) -> bytes:
    """Encodes the image as WebP; deterministic."""
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(image).save(stream, "WEBP", quality=QUALITY, method=4)
    return stream.getvalue()
