"""Light in a bright room: a sky, a floor that reflects light, and one large lamp."""

from dataclasses import dataclass

import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.shapes.primitives import Vector
from artigen.shapes.surfaces.textures import KINDS

STEEL = KINDS.index("steel")


@dataclass(frozen=True, kw_only=True)
class RenderConfig:
    """Appearance and cost of pictures."""

    shadow_rays: int = 1
    """Rays per pixel towards the lamp, and as many towards the sky; more than one gives soft shadows, zero
    none. A multiple of the square of ``supersampling``, or one."""
    openness: bool = True
    """Whether corners and gaps are darker than open surfaces."""
    floor: bool = False
    """Whether a floor at z = 0 shows the object's shadow; the mask contains the object alone."""
    background: Vector = (0.93, 0.93, 0.925)
    """Background colour (sRGB)."""
    lamp: Vector = (-0.68, 0.42, 0.6)
    """Direction towards the lamp; normalised."""
    lamp_strength: float = 0.62
    """Light of the lamp on a surface that faces it."""
    sky_strength: float = 0.27
    """Light from straight above, shadowed as from one direction."""
    fill_strength: float = 0.26
    """Ambient light, stronger from above than from below."""
    fill_tilt: float = 0.34
    """Strength of that difference: 0 is uniform light, independent of orientation."""
    supersampling: int = 1
    """Rays per pixel edge for colour; the other maps are always at pixel centres."""
    layers: int = 8
    """Largest number of surfaces seen through glass; with 1 the background is directly behind a pane."""

    def __post_init__(self) -> None:
        if self.supersampling < 1 or self.shadow_rays < 0 or self.layers < 1:
            raise ValueError(
                f"supersampling {self.supersampling}, shadow_rays {self.shadow_rays} and layers "
                f"{self.layers}: too few"
            )
        if self.shadow_rays > 1 and self.shadow_rays % self.supersampling**2:
            raise ValueError(
                f"shadow_rays is {self.shadow_rays}, allowed are 0, 1 and multiples of "
                f"{self.supersampling**2}, the sub-rays of a pixel"
            )


EVEN_LIGHT = RenderConfig(
    shadow_rays=0, lamp_strength=0.0, sky_strength=0.0, fill_strength=0.85, fill_tilt=0.15
)
"""Light from all around without shadows: a part keeps its colours when it moves, and a baked texture can be
relit. Only corners are darker."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Material:
    """Surface properties that shading needs at some points."""

    color: Float[Tensor, "N 3"]
    """Linear light."""
    kind: Int[Tensor, "N"]
    gloss: Float[Tensor, "N"]
    opacity: Float[Tensor, "N"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Light:
    """Light that reaches some points: 0 none, 1 all."""

    lamp: Float[Tensor, "N"]
    sky: Float[Tensor, "N"]
    open: Float[Tensor, "N"]


def shade(
    normal: Float[Tensor, "N 3"],
    view: Float[Tensor, "N 3"],
    material: Material,
    light: Light,
    cfg: RenderConfig,
) -> tuple[Float[Tensor, "N 3"], Float[Tensor, "N 3"]]:
    """Linear light that leaves a surface towards the camera: scattered, and mirrored.

    Args:
        normal: Unit normals towards the camera.
        view: Unit directions from the camera to the surface.
        material: Properties of the surface.
        light: Light that reaches it.
        cfg: Lights of the room.
    """
    up = normal[:, 2]
    lamp = torch.nn.functional.normalize(normal.new_tensor(cfg.lamp), dim=0)
    facing = (normal @ lamp).clamp(min=0.0)
    fill = (1.0 - cfg.fill_tilt + cfg.fill_tilt * up) * light.open
    diffuse = (
        cfg.lamp_strength * facing * light.lamp
        + cfg.sky_strength * (0.15 + 0.85 * (0.5 + 0.5 * up)) * light.sky * (0.4 + 0.6 * light.open)
        + cfg.fill_strength * 1.25 * fill
    )
    cosine = -(normal * view).sum(dim=1)
    mirrored = view + 2.0 * cosine[:, None] * normal
    metal = material.kind == STEEL
    base = torch.where(metal, 0.55 * material.gloss, 0.06 * material.gloss)
    fresnel = base + (0.5 * material.gloss - base).clamp(min=0.0) * (1.0 - cosine).clamp(0.0, 1.0) ** 5
    room = _room_light(mirrored, material.gloss) * (0.25 + 0.75 * light.open)
    glint = (mirrored @ lamp).clamp(min=0.0) ** (12.0 + 120.0 * material.gloss) * light.lamp
    tint = torch.where(metal[:, None], material.color, 1.0)
    specular = tint * (fresnel * (room + 1.5 * glint))[:, None]
    matte = torch.where(metal, 1.0 - 0.55 * material.gloss, 1.0)
    return material.color * (diffuse * matte)[:, None], specular


def _room_light(direction: Float[Tensor, "N 3"], gloss: Float[Tensor, "N"]) -> Float[Tensor, "N"]:
    """Radiance of the room by direction: a bright ceiling, a band of windows in front, a dim floor."""
    height = direction[:, 2]
    softness = 0.55 - 0.4 * gloss
    ceiling = torch.sigmoid((height - 0.25) / (0.25 * softness))
    window = torch.exp(-(((height - 0.15) / (0.3 + softness)) ** 2)) * torch.sigmoid(-direction[:, 0] * 4.0)
    return 0.45 + 0.55 * ceiling + 0.35 * window


def linear_from_srgb(color: Float[Tensor, "*S 3"]) -> Float[Tensor, "*S 3"]:
    """sRGB to linear RGB."""
    return torch.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055).clamp(min=0.0) ** 2.4)


def srgb_from_linear(light: Float[Tensor, "*S 3"]) -> Float[Tensor, "*S 3"]:
    """Linear RGB to sRGB."""
    light = light.clamp(0.0, 1.0)
    return torch.where(light <= 0.0031308, 12.92 * light, 1.055 * light.clamp(min=1e-8) ** (1 / 2.4) - 0.055)
