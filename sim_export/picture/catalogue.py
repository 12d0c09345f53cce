"""Pictures in catalogue light: path tracing by Mitsuba 3 in a white studio with soft boxes.

Materials are those of all other formats: base colour or image, roughness, metallic, index of refraction,
opacity and clear coat. Noise differs from run to run.
"""

# mitsuba has incomplete type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from jaxtyping import UInt8

from artigen.camera import Camera
from artigen.splats.colors import linear_from_srgb, srgb_from_linear
from sim_export.errors import PackageError
from sim_export.picture.raycast import Surface
from sim_export.picture.render import surface_points

VARIANT = "scalar_rgb"
"""Needs no LLVM library."""
LEAST_ROUGHNESS = 0.03
FROSTED = 0.1
"""Roughness from which a pane scatters what passes."""
BOXES = (
    ((-1.5, 1.5, 2.1), 1.0, 3.4),
    ((-1.2, -1.9, 1.2), 0.8, 1.1),
    ((1.6, 0.3, 2.4), 0.8, 1.8),
)
"""Soft boxes around an object of unit extent: place of the middle, half the edge, and radiance."""
STUDIO = 0.5
"""Radiance of the walls."""
FLOOR = 0.86
"""Reflectance of the floor."""


@dataclass(frozen=True, kw_only=True)
class CatalogueConfig:
    """Cost and noise of a picture."""

    samples: int = 64
    """Paths per pixel."""
    depth: int = 8
    """Longest path; panes need two each."""


def require_mitsuba() -> Any:
    """The module; raises `PackageError` if it is not installed."""
    try:
        import mitsuba
    except ImportError as err:
        raise PackageError('catalogue light needs Mitsuba 3: pip install "artigen[mitsuba]"') from err
    mitsuba.set_variant(VARIANT)
    return mitsuba


def render_catalogue(
    surfaces: Sequence[Surface], camera: Camera, ground: float, cfg: CatalogueConfig | None = None
) -> UInt8[np.ndarray, "H W 3"]:
    """A picture of surfaces (m) on a floor at height ``ground``, sRGB.

    Raises:
        PackageError: If Mitsuba is not installed.
    """
    mitsuba, cfg = require_mitsuba(), cfg or CatalogueConfig()
    points = surface_points(surfaces)
    middle, extent = (points.min(axis=0) + points.max(axis=0)) / 2, float(np.ptp(points, axis=0).max())
    with TemporaryDirectory() as scratch:
        scene: dict[str, Any] = {
            "type": "scene",
            "integrator": {"type": "volpath", "max_depth": cfg.depth},
            "walls": {"type": "constant", "radiance": STUDIO},
            "sensor": _sensor(mitsuba, camera, cfg),
            "floor": _floor(mitsuba, middle, ground, extent),
        }
        for number, (place, half, bright) in enumerate(BOXES):
            at = middle + extent * np.array(place)
            scene[f"box_{number}"] = _soft_box(mitsuba, at, middle, half * extent, bright)
        for number, surface in enumerate(surfaces):
            if len(surface.triangles):
                path = Path(scratch) / f"{number}.ply"
                path.write_bytes(_ply(surface))
                look = _look(mitsuba, surface)
                scene[f"surface_{number}"] = {"type": "ply", "filename": str(path), "look": look}
        image = mitsuba.render(mitsuba.load_dict(scene), spp=cfg.samples)
    seen = np.clip(srgb_from_linear(np.minimum(np.array(image)[..., :3], 1.0)), 0.0, 1.0)
    return np.rint(255.0 * seen).astype(np.uint8)


def _sensor(mitsuba: Any, camera: Camera, cfg: CatalogueConfig) -> dict[str, Any]:
    return {
        "type": "perspective",
        "fov_axis": "y",
        "fov": camera.fov,
        "to_world": mitsuba.ScalarTransform4f().look_at(
            camera.position.tolist(), camera.target.tolist(), (-camera.axes[1]).tolist()
        ),
        "film": {"type": "hdrfilm", "width": camera.width, "height": camera.height},
        "sampler": {"type": "multijitter", "sample_count": cfg.samples},
    }


def _floor(mitsuba: Any, middle: np.ndarray, ground: float, extent: float) -> dict[str, Any]:
    place = mitsuba.ScalarTransform4f().translate([float(middle[0]), float(middle[1]), ground])
    return {
        "type": "rectangle",
        "to_world": place.scale(60 * extent),
        "look": {"type": "diffuse", "reflectance": FLOOR},
    }


def _soft_box(
    mitsuba: Any, place: np.ndarray, target: np.ndarray, half: float, bright: float
) -> dict[str, Any]:
    pose = mitsuba.ScalarTransform4f().look_at(place.tolist(), target.tolist(), [0.0, 0.0, 1.0])
    return {
        "type": "rectangle",
        "to_world": pose.scale(half),
        "light": {"type": "area", "radiance": bright},
    }


def _look(mitsuba: Any, surface: Surface) -> dict[str, Any]:
    said = surface.material
    color: dict[str, Any] = {"type": "rgb", "value": linear_from_srgb(np.array(surface.color)).tolist()}
    if surface.texture is not None:
        color = {
            "type": "bitmap",
            "bitmap": mitsuba.Bitmap(np.array(surface.texture[..., :3], order="C")),
            "wrap_mode": "repeat",
        }
    if said.opacity < 1.0 and said.roughness < FROSTED:
        return _pane(surface)
    rough = max(said.coat_roughness if said.coat > 0.5 else said.roughness, LEAST_ROUGHNESS)
    look: dict[str, Any] = {"type": "principled", "base_color": color, "roughness": rough}
    look |= {"metallic": said.metallic, "eta": said.ior}
    if said.coat > 0.5:  # the principled clear coat sends back more light than it gets
        look = {"type": "roughplastic", "distribution": "ggx", "alpha": rough**2, "int_ior": said.ior}
        look |= {"diffuse_reflectance": color}
    if surface.normal_map is not None:
        bitmap = mitsuba.Bitmap(np.array(surface.normal_map, order="C"))
        texture = {"type": "bitmap", "bitmap": bitmap, "wrap_mode": "repeat", "raw": True}
        look = {"type": "normalmap", "normalmap": texture, "bsdf": look}
    look = {"type": "twosided", "look": look}
    if said.opacity < 1.0:
        return {"type": "mask", "opacity": said.opacity, "look": look}
    return look


def _pane(surface: Surface) -> dict[str, Any]:
    """A clear face: what does not pass is mirrored, or absorbed but for the colour of the glass."""
    passed = 1.0 - surface.material.opacity * (1.0 - linear_from_srgb(np.array(surface.color)))
    through = {"type": "rgb", "value": passed.tolist()}
    return {"type": "thindielectric", "int_ior": surface.material.ior, "specular_transmittance": through}


def _ply(surface: Surface) -> bytes:
    """Triangles with unshared corners, normals and texture coordinates, as binary PLY."""
    corners = surface.triangles.reshape(-1, 3)
    uv = np.zeros((len(corners), 2)) if surface.uv is None else surface.uv.reshape(-1, 2)
    uv = uv * (1.0, -1.0) + (0.0, 1.0)  # Mitsuba counts from the top
    names = ("x", "y", "z", "nx", "ny", "nz", "u", "v")
    values = np.hstack([corners, surface.normals.reshape(-1, 3), uv]).astype("<f4")
    count = len(surface.triangles)
    faces = np.zeros(count, dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, np.arange(3 * count).reshape(-1, 3)
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(corners)}"]
    head += [f"property float {name}" for name in names]
    head += [f"element face {count}", "property list uchar int vertex_indices", "end_header"]
    return "\n".join([*head, ""]).encode() + values.tobytes() + faces.tobytes()
