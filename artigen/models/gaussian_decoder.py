"""Latents of voxels to 3D Gaussians: TRELLIS' decoder, its parametrisation and its order.

Voxel ``i`` owns the Gaussians ``n i`` to ``n i + n - 1``, so a Gaussian moves with the joint of its voxel
(section 4.2 of the paper). The output layer says, for the ``n`` Gaussians of a voxel, three offsets each,
then three colour harmonics each, three scales each, four quaternion entries each, one opacity each.
"""

from dataclasses import dataclass, field

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor
from torch.nn import functional

from artigen.models.slat_vae import SlatTrunk, SlatVaeConfig, WindowPlans
from artigen.splats.colors import linear_from_srgb
from artigen.splats.render.splats import Splats
from artigen.types import Gaussians

CHANNELS = (3, 3, 3, 4, 1)
"""Offset, colour, scale, quaternion, opacity of one Gaussian."""
HARMONIC = 0.28209479177387814
"""Value of the harmonic of degree 0."""


@dataclass(frozen=True, kw_only=True)
class GaussianConfig:
    """How raw channels become Gaussians; the defaults are those of every public TRELLIS checkpoint."""

    count: int = 32
    """Gaussians per voxel."""
    reach: float = 1.5
    """Edge of the cube that a voxel's means stay in, in voxels."""
    perturb: bool = True
    """Whether means start spread over the voxel instead of at its centre."""
    scale_bias: float = 4e-3
    """Scale (unit-cube length) of a raw value of 0."""
    opacity_bias: float = 0.1
    """Opacity of a raw value of 0."""
    filter_scale: float = 9e-4
    """Added to every scale in quadrature: the size of a pixel of the training pictures."""
    screen_filter: float = 0.1
    """Variance, in pixels, that a rasteriser should add on the screen."""
    offset_rate: float = 1.0
    """Factor on raw offsets."""
    color_rate: float = 1.0
    """Factor on raw colours."""
    scale_rate: float = 1.0
    """Factor on raw scales."""
    quat_rate: float = 0.1
    """Factor on raw quaternions."""
    opacity_rate: float = 1.0
    """Factor on raw opacities."""

    def __post_init__(self) -> None:
        if self.count < 1 or self.reach <= 1 or self.scale_bias <= 0 or not 0 < self.opacity_bias < 1:
            raise ValueError(
                f"{self.count} Gaussians, reach {self.reach}, scale {self.scale_bias}, opacity "
                f"{self.opacity_bias}: expected 1 or more, above 1, above 0, and between 0 and 1"
            )


@dataclass(frozen=True, kw_only=True)
class GaussianDecoderConfig:
    """Trunk and parametrisation; the defaults are those of `slat_dec_gs_swin8_B_64l8gs32_fp16`."""

    trunk: SlatVaeConfig = field(default_factory=SlatVaeConfig)
    """Sizes of the transformer."""
    gaussians: GaussianConfig = field(default_factory=GaussianConfig)
    """What its output means."""


class GaussianDecoder(SlatTrunk):
    """Latents to raw channels of Gaussians, and those to Gaussians."""

    offset_perturbation: Tensor

    def __init__(self, cfg: GaussianDecoderConfig) -> None:
        super().__init__(cfg.trunk, cfg.trunk.latent_channels, sum(CHANNELS) * cfg.gaussians.count)
        self.gaussians = cfg.gaussians
        self.register_buffer("offset_perturbation", spread_offsets(cfg.gaussians.count, cfg.gaussians.reach))

    def forward(
        self, coords: Int[Tensor, "N 4"], latents: Float[Tensor, "N D"], plans: WindowPlans | None = None
    ) -> Splats:
        """Gaussians of all voxels, voxel after voxel, in float32; colours are sRGB, not limited above.

        Args:
            coords: sample, x, y, z of each voxel, in any order.
            latents: latent of each voxel.
            plans: of the same voxels, if there already.
        """
        return self.read(coords, self.transform(coords, latents, plans))

    def color_channels(self) -> Int[Tensor, "K 3"]:
        """Which raw channels are the colours of a voxel's Gaussians."""
        first = CHANNELS[0] * self.gaussians.count
        return first + torch.arange(CHANNELS[1] * self.gaussians.count).unflatten(0, (-1, CHANNELS[1]))

    def read(self, coords: Int[Tensor, "N 4"], raw: Float[Tensor, "N K"]) -> Splats:
        """Raw channels to Gaussians, in float32."""
        cfg, edge = self.gaussians, self.cfg.resolution
        parts = raw.float().split([width * cfg.count for width in CHANNELS], dim=1)
        offset, color, scale, quat, opacity = (
            part.unflatten(1, (cfg.count, width)) for part, width in zip(parts, CHANNELS, strict=True)
        )
        offset = offset * cfg.offset_rate + (self.offset_perturbation.float() if cfg.perturb else 0.0)
        centers = (coords[:, None, 1:].float() + 0.5) / edge - 0.5
        means = centers + torch.tanh(offset) * (0.5 * cfg.reach / edge)
        bias = cfg.scale_bias + np.log(-np.expm1(-cfg.scale_bias))
        scales = functional.softplus(scale * cfg.scale_rate + float(bias))
        identity = quat.new_tensor([1.0, 0.0, 0.0, 0.0])
        logit = float(np.log(cfg.opacity_bias / (1.0 - cfg.opacity_bias)))
        return Splats(
            means=means.flatten(0, 1),
            quats=functional.normalize(quat * cfg.quat_rate + identity, dim=-1).flatten(0, 1),
            scales=torch.sqrt(scales**2 + cfg.filter_scale**2).flatten(0, 1),
            opacities=torch.sigmoid(opacity * cfg.opacity_rate + logit).flatten(),
            colors=(HARMONIC * color * cfg.color_rate + 0.5).clamp(min=0.0).flatten(0, 1),
        )


def select_voxels(decoded: Splats, chosen: Bool[Tensor, "N"]) -> Splats:
    """The Gaussians of some of the voxels, for example of one sample: ``coords[:, 0] == sample``."""
    kept = chosen.repeat_interleave(len(decoded.means) // len(chosen))
    return Splats(**{name: value[kept] for name, value in vars(decoded).items()})


def spread_offsets(count: int, reach: float) -> Float[Tensor, "K 3"]:
    """Raw offsets that put ``count`` means on Hammersley's points of a voxel."""
    points = np.stack(
        [np.arange(count) / count, *(_invert_digits(np.arange(count), base) for base in (2, 3))], axis=1
    )
    return torch.from_numpy(np.arctanh((2.0 * points - 1.0) / reach)).float()


def to_gaussians(decoded: Splats, part_ids: Int[np.ndarray, "N"]) -> Gaussians:
    """Gaussians of one sample as plain values; colours are limited to [0, 1] and made linear.

    Args:
        decoded: Gaussians of the sample's voxels, voxel after voxel.
        part_ids: part of each voxel; its Gaussians belong to the same part.

    Raises:
        ValueError: If the Gaussians cannot be shared out evenly among the voxels, or a value is not finite.
    """
    total, voxels = len(decoded.means), len(part_ids)
    if not voxels or total % voxels:
        raise ValueError(f"{total} Gaussians for {voxels} voxels, expected the same number for each")
    values = {name: value.detach().float().cpu().numpy() for name, value in vars(decoded).items()}
    values["colors"] = linear_from_srgb(values["colors"].clip(0.0, 1.0))
    return Gaussians(**values, part_ids=np.repeat(part_ids, total // voxels))


def _invert_digits(numbers: Int[np.ndarray, "K"], base: int) -> Float[np.ndarray, "K"]:
    """Radical inverse: the digits of a number, mirrored at the point."""
    out, weight, rest = np.zeros(len(numbers)), 1.0 / base, numbers.copy()
    while rest.any():
        out, rest, weight = out + weight * (rest % base), rest // base, weight / base
    return out
