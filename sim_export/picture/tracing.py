"""Path tracing of surfaces by Mitsuba 3, without noise by Intel Open Image Denoise.

Materials are those of all other formats: base colour or image, roughness, metallic, index of refraction,
opacity and clear coat. What is left of the noise differs from run to run.
"""

# mitsuba has incomplete type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from artigen.camera import Camera
from artigen.splats.colors import linear_from_srgb
from sim_export.errors import PackageError
from sim_export.picture.raycast import Surface

VARIANT = "scalar_rgb"
"""Needs no LLVM library."""
LEAST_ROUGHNESS = 0.03
FROSTED = 0.1
"""Roughness from which a pane scatters what passes."""
Pane = Literal["mirrors", "passes"]
"""Whether clear panes mirror what does not pass, or let light straight through, so that every path finds what
shines behind them."""


@dataclass(frozen=True, kw_only=True)
class TraceConfig:
    """Cost and noise of a picture."""

    samples: int = 32
    """Paths per pixel."""
    depth: int = 12
    """Longest path; panes need two each."""


def require_mitsuba() -> Any:
    """The module; raises `PackageError` if it is not installed."""
    try:
        import mitsuba
        import mitsuba_oidn  # noqa: F401
    except ImportError as err:
        raise PackageError('path tracing needs Mitsuba 3: pip install "artigen[mitsuba]"') from err
    mitsuba.set_variant(VARIANT)
    return mitsuba


def trace(
    surfaces: Sequence[Surface],
    camera: Camera,
    lights: Mapping[str, Mapping[str, Any]],
    cfg: TraceConfig | None = None,
    *,
    glow: Mapping[int, float] | None = None,
    pane: Pane = "mirrors",
) -> Float[np.ndarray, "H W 3"]:
    """A picture of surfaces (m), linear and without an upper limit.

    Args:
        lights: Whatever else the scene holds, by name, as Mitsuba's dictionaries.
        glow: Radiance of the surfaces that shine, by their ids, times their colour.
        pane: What clear panes do.

    Raises:
        PackageError: If Mitsuba is not installed.
    """
    mitsuba, cfg = require_mitsuba(), cfg or TraceConfig()
    with TemporaryDirectory() as scratch:
        scene: dict[str, Any] = {
            "type": "scene",
            "integrator": {
                "type": "aov",
                "aovs": "albedo:albedo,normal:sh_normal",
                "paths": {"type": "volpath", "max_depth": cfg.depth},
            },
            "sensor": _sensor(mitsuba, camera, cfg),
            **lights,
        }
        names: dict[object, str] = {}
        for number, surface in enumerate(surfaces):
            if not len(surface.triangles):
                continue
            path = Path(scratch) / f"{number}.ply"
            path.write_bytes(_ply(surface))
            shape: dict[str, Any] = {"type": "ply", "filename": str(path)}
            if glow and surface.id in glow:
                shine = glow[surface.id] * linear_from_srgb(np.array(surface.color))
                shape["light"] = {"type": "area", "radiance": {"type": "rgb", "value": shine.tolist()}}
            else:
                name = names.setdefault(_tell_apart(surface), f"look_{len(names)}")
                if name not in scene:
                    scene[name] = _look(mitsuba, surface, pane)
                shape["look"] = {"type": "ref", "id": name}
            scene[f"surface_{number}"] = shape
        layers = np.array(mitsuba.render(mitsuba.load_dict(scene), spp=cfg.samples), np.float32)
    return _denoise(layers)


def _denoise(layers: Float[np.ndarray, "H W C"]) -> Float[np.ndarray, "H W 3"]:
    """The picture in the first channels, by the albedo and normals in the last six."""
    import mitsuba_oidn

    parts = (layers[..., :3], np.clip(layers[..., -6:-3], 0.0, 1.0), layers[..., -3:])
    color, albedo, normal = map(np.ascontiguousarray, parts)
    return mitsuba_oidn.denoise(color, albedo, normal, hdr=True).astype(np.float64)


def _sensor(mitsuba: Any, camera: Camera, cfg: TraceConfig) -> dict[str, Any]:
    return {
        "type": "perspective",
        "fov_axis": "y",
        "fov": camera.fov,
        "to_world": mitsuba.ScalarTransform4f().look_at(
            camera.position.tolist(), camera.target.tolist(), (-camera.axes[1]).tolist()
        ),
        # A wider filter spreads noise over several pixels, where it looks like detail.
        "film": {
            "type": "hdrfilm",
            "width": camera.width,
            "height": camera.height,
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "multijitter", "sample_count": cfg.samples},
    }


def _tell_apart(surface: Surface) -> tuple[object, ...]:
    """What surfaces of one look have in common; they share its images."""
    images = (surface.texture, surface.normal_map)
    return surface.color, surface.material, *(None if each is None else each.tobytes() for each in images)


def _look(mitsuba: Any, surface: Surface, pane: Pane) -> dict[str, Any]:
    said = surface.material
    color: dict[str, Any] = {"type": "rgb", "value": linear_from_srgb(np.array(surface.color)).tolist()}
    if surface.texture is not None:
        color = {
            "type": "bitmap",
            "bitmap": mitsuba.Bitmap(np.array(surface.texture[..., :3], order="C")),
            "wrap_mode": "repeat",
        }
    if said.opacity < 1.0 and said.roughness < FROSTED and pane == "mirrors":
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
