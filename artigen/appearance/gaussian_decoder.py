"""Voxel latents to 3D Gaussians: TRELLIS' decoder with its parametrisation and order.

Voxel ``i`` owns the Gaussians ``n i`` to ``n i + n - 1``, so a Gaussian moves with the joint of its voxel
(section 4.2 of the paper). The output layer gives, for the ``n`` Gaussians of a voxel, three offsets each,
then three colour harmonics each, three scales each, four quaternion entries each, one opacity each.

Where voxels have two sides, these are in the frame of the outer side, which faces +x in it. The first half of
a voxel's Gaussians are flat and lie on the outer side, the others on the inner one.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor
from torch.nn import functional

from artigen.appearance.slat_vae import SlatTrunk, SlatVaeConfig, WindowPlans
from artigen.splats.colors import HARMONIC, linear_from_srgb
from artigen.splats.render.motion import multiply_quats
from artigen.splats.render.splats import Splats
from artigen.transforms import quat_from_matrix
from artigen.types import Gaussians
from artigen.voxels.frames import facing_frames

CHANNELS = {"offset": 3, "color": 3, "scale": 3, "quat": 4, "opacity": 1}
"""Raw channels of one Gaussian, in the order of the output layer."""
FLATNESS = 5.0
"""Initial ratio of width to thickness of the Gaussians of a side."""
Channel = Literal["offset", "color", "scale", "quat", "opacity"]


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
    """Unit-cube length added to every scale in quadrature: the size of a pixel of the training pictures."""
    screen_filter: float = 0.1
    """Variance (square pixels) that a rasteriser should add on the screen."""
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
                f"{self.opacity_bias}: expected at least 1, above 1, above 0, and between 0 and 1"
            )


@dataclass(frozen=True, kw_only=True)
class GaussianDecoderConfig:
    """Trunk and parametrisation; the defaults are those of `slat_dec_gs_swin8_B_64l8gs32_fp16`."""

    trunk: SlatVaeConfig = field(default_factory=SlatVaeConfig)
    """Sizes of the transformer."""
    gaussians: GaussianConfig = field(default_factory=GaussianConfig)
    """Interpretation of its output."""


class GaussianDecoder(SlatTrunk):
    """Latents to raw channels of Gaussians, and those to Gaussians."""

    offset_perturbation: Tensor
    frames: Tensor
    turns: Tensor

    def __init__(self, cfg: GaussianDecoderConfig) -> None:
        super().__init__(cfg.trunk, cfg.trunk.latent_channels, sum(CHANNELS.values()) * cfg.gaussians.count)
        self.gaussians = cfg.gaussians
        spread = spread_sides if cfg.trunk.sided else spread_offsets
        self.register_buffer("offset_perturbation", spread(cfg.gaussians.count, cfg.gaussians.reach))
        if cfg.trunk.sided:
            frames = facing_frames()
            self.register_buffer("frames", torch.tensor(frames).float(), persistent=False)
            self.register_buffer("turns", torch.tensor(quat_from_matrix(frames)).float(), persistent=False)
            wide, flat = (_raw_scale(cfg.gaussians.scale_bias / by) for by in (1.0, FLATNESS))
            with torch.no_grad():
                self.out_layer.bias[self.channels("scale")[:, 0]] = flat - wide

    def forward(
        self,
        coords: Int[Tensor, "N 4"],
        latents: Float[Tensor, "N D"],
        plans: WindowPlans | None = None,
        facings: Int[Tensor, "N"] | None = None,
    ) -> Splats:
        """Gaussians of all voxels, voxel after voxel, in float32; colours are sRGB, not limited above.

        Args:
            coords: Sample, x, y, z of each voxel, in any order.
            plans: Window plans of these voxels; computed when None.
            facings: Directions of the outer sides, where voxels have two sides.
        """
        return self.read(coords, self.transform(coords, latents, plans, facings), facings)

    def channels(self, name: Channel) -> Int[Tensor, "K W"]:
        """Indices of the raw channels of a quantity, one row per Gaussian."""
        names = list(CHANNELS)
        first = self.gaussians.count * sum(CHANNELS[before] for before in names[: names.index(name)])
        return first + torch.arange(self.gaussians.count * CHANNELS[name]).unflatten(0, (-1, CHANNELS[name]))

    def read(
        self, coords: Int[Tensor, "N 4"], raw: Float[Tensor, "N K"], facings: Int[Tensor, "N"] | None = None
    ) -> Splats:
        """Raw channels to Gaussians, in float32."""
        cfg, edge = self.gaussians, self.cfg.resolution
        parts = raw.float().split([width * cfg.count for width in CHANNELS.values()], dim=1)
        offset, color, scale, quat, opacity = (
            part.unflatten(1, (cfg.count, width))
            for part, width in zip(parts, CHANNELS.values(), strict=True)
        )
        offset = offset * cfg.offset_rate + (self.offset_perturbation.float() if cfg.perturb else 0.0)
        centers = (coords[:, None, 1:].float() + 0.5) / edge - 0.5
        away = torch.tanh(offset) * (0.5 * cfg.reach / edge)
        scales = functional.softplus(scale * cfg.scale_rate + _raw_scale(cfg.scale_bias))
        quats = functional.normalize(quat * cfg.quat_rate + quat.new_tensor([1.0, 0.0, 0.0, 0.0]), dim=-1)
        if facings is not None:
            away = torch.einsum("nij,nkj->nki", self.frames[facings], away)
            quats = multiply_quats(self.turns[facings][:, None].expand_as(quats), quats)
        logit = float(np.log(cfg.opacity_bias / (1.0 - cfg.opacity_bias)))
        return Splats(
            means=(centers + away).flatten(0, 1),
            quats=quats.flatten(0, 1),
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


def spread_sides(count: int, reach: float) -> Float[Tensor, "K 3"]:
    """Raw offsets that spread half of the means for either side of a voxel, all in its middle plane.

    Raises:
        ValueError: If the number of Gaussians is odd.
    """
    if count % 2:
        raise ValueError(f"{count} Gaussians for the two sides of a voxel, expected an even number")
    order = np.arange(count // 2)
    across = np.stack([(order + 0.5) / len(order), _invert_digits(order, 2) + 0.5 / len(order)], axis=1)
    points = np.concatenate([across, across * [1.0, -1.0] + [0.0, 1.0]]) - 0.5
    return torch.from_numpy(np.pad(np.arctanh(2.0 * points / reach), ((0, 0), (1, 0)))).float()


def to_gaussians(decoded: Splats, part_ids: Int[np.ndarray, "N"]) -> Gaussians:
    """Gaussians of one sample as plain values; colours are limited to [0, 1] and made linear.

    Args:
        decoded: Gaussians of the sample's voxels, voxel after voxel.

    Raises:
        ValueError: If the Gaussians do not divide evenly among the voxels, or a value is not finite.
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


def _raw_scale(scale: float) -> float:
    """The raw value that softplus maps to a scale."""
    return float(scale + np.log(-np.expm1(-scale)))
