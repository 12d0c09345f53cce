"""`render_labelled`: pictures of packages with exact labels, for those who train detectors."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from artigen.errors import ArtigenError
from artigen.io import write_whole

FOV = (28.0, 50.0)
"""Range of vertical angles of view (degrees)."""
AZIMUTH, ELEVATION = (-65.0, 65.0), (3.0, 40.0)
"""Ranges of the camera's direction from the object (degrees); 0 is straight in front."""
MARGIN = (0.04, 0.25)
"""Range of the free border, as a share of the picture on each side."""
MILLIMETRE = 1000.0
FAR = 65.535
"""Greatest depth (m) that a picture of 16 bits in millimetres holds."""


@dataclass(frozen=True, kw_only=True)
class RenderSettings:
    """Number, size and seed of labelled pictures."""

    states: int = 5
    """States of the joints of each package."""
    views: int = 1
    """Views of each state."""
    size: int = 640
    """Edge of the square pictures, in pixels."""
    seed: int = 0
    """Seed of states and views."""

    def __post_init__(self) -> None:
        if min(self.states, self.views) < 1 or not 16 <= self.size <= 4096 or self.seed < 0:
            raise ArtigenError(
                f"{self.states} states, {self.views} views, size {self.size}, seed {self.seed}: expected at "
                "least one state and view, 16 to 4096 pixels and a seed from 0"
            )


def render_labelled(folders: Sequence[Path], out: Path, cfg: RenderSettings) -> Iterator[Path]:
    """Renders packages in random states and views: pictures, depth, parts, and at the end ``coco.json``.

    Args:
        folders: Package folders.
        out: Folder for ``images``, ``depth`` (PNG of 16 bits, mm), ``parts`` (PNG of 16 bits: index in
            ``parts`` of the image's entry plus 1) and ``coco.json``; it must not hold a ``coco.json`` yet.
        cfg: Number, size and seed.

    Yields:
        The path of every picture as it is written.

    Raises:
        ArtigenError: If a package cannot be read or drawn, or the folder holds such a data set already.
    """
    from sim_export.files.read import read_package
    from sim_export.motion.states import sample_state
    from sim_export.physics.phrases import name_parts
    from sim_export.picture.coco import coco_annotations, coco_categories, coco_image
    from sim_export.picture.labelled import render_labelled as render

    index = out / "coco.json"
    if index.exists():
        raise ArtigenError(f"{index}: exists already; render into another folder, or remove it")
    names = [folder.resolve().name for folder in folders]
    doubled = sorted({name for name in names if names.count(name) > 1})
    if doubled:
        raise ArtigenError(f"packages named {', '.join(doubled)} occur twice; expected different names")
    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    for name, folder in zip(names, folders, strict=True):
        package = read_package(folder)
        phrases = {part.link: part.phrases[0] for part in name_parts(package)}
        for state in range(cfg.states):
            rng = np.random.default_rng([cfg.seed, state])
            q = sample_state(package, rng)
            for view in range(cfg.views):
                picture = render(package, _draw_camera(package, q, cfg.size, rng), q)
                stem = f"{name}_{state:03d}_{view:02d}.png"
                files = {
                    "file_name": f"images/{stem}",
                    "depth_name": f"depth/{stem}",
                    "parts_name": f"parts/{stem}",
                }
                _write(out / files["file_name"], picture.image)
                depth = np.rint(np.minimum(picture.depth, FAR) * MILLIMETRE).astype(np.uint16)
                _write(out / files["depth_name"], depth)
                _write(out / files["parts_name"], (picture.parts + 1).astype(np.uint16))
                facts = {"package": name, "parts": [part.name for part in picture.shown]}
                images.append(coco_image(picture, len(images) + 1, files, **facts))
                annotations += coco_annotations(picture, len(images), len(annotations) + 1, phrases)
                yield out / files["file_name"]
    value = {"images": images, "annotations": annotations, "categories": coco_categories()}
    write_whole(index, json.dumps(value) + "\n")


def _draw_camera(package: Any, q: dict[str, float], size: int, rng: np.random.Generator) -> Any:
    """A camera somewhere before the object that has all of it in the picture."""
    from sim_export.motion.kinematics import link_displacements
    from sim_export.picture.draw import package_surfaces, pose_surfaces
    from sim_export.picture.render import surface_points
    from sim_export.picture.viewpoint import Viewpoint, place_camera

    T = link_displacements(package.links, package.joints, q)
    viewpoint = Viewpoint(
        azimuth=float(rng.uniform(*AZIMUTH)),
        elevation=float(rng.uniform(*ELEVATION)),
        fov=float(rng.uniform(*FOV)),
        margin=float(rng.uniform(*MARGIN)),
        width=size,
        height=size,
    )
    return place_camera(surface_points(pose_surfaces(package_surfaces(package), T)), viewpoint)


def _write(path: Path, pixels: np.ndarray) -> None:
    from PIL import Image

    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(pixels).save(path)
