"""Image features for voxels: feature extractors behind one interface.

`PyramidFeatures` needs no weights and no training; `artigen.models.public_encoders` has the paper's DINOv2.
"""

from typing import Protocol, runtime_checkable

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

BASE = 16
"""Channels of a pyramid without random ones: colour and slope on three levels, and coverage."""
RADII = (1, 3)
"""Radii (pixels) of the windows of the coarser levels."""
LUMA = (0.299, 0.587, 0.114)


@runtime_checkable
class FeatureExtractor(Protocol):
    """Pictures to maps of features; the same pictures give the same maps."""

    @property
    def name(self) -> str:
        """Identifies the features in results and in descriptions of models."""
        ...

    @property
    def channels(self) -> int:
        """Number of channels of a feature map."""
        ...

    def __call__(self, pictures: Float[Tensor, "V 4 H W"]) -> Float[Tensor, "V C h w"]:
        """Maps over whole pictures, at any resolution.

        Args:
            pictures: RGB and coverage in [0, 1], premultiplied on black.
        """
        ...


class PyramidFeatures(nn.Module):
    """Colour, slope and means over three scales, then fixed random combinations of them.

    The first three channels are the unchanged colour of the pixel. Means are taken over the object alone, so
    the background does not mix in.
    """

    kernels: Tensor

    def __init__(self, channels: int = BASE) -> None:
        super().__init__()
        if channels < BASE:
            raise ValueError(f"a pyramid of {channels} channels, expected at least {BASE}")
        self._channels = channels
        generator = torch.Generator().manual_seed(0)
        kernels = torch.randn(channels - BASE, BASE, 3, 3, generator=generator) / (9 * BASE) ** 0.5
        self.register_buffer("kernels", kernels, persistent=False)

    @property
    def name(self) -> str:
        """Name of the features."""
        return f"pyramid-{self._channels}"

    @property
    def channels(self) -> int:
        """Number of channels of a feature map."""
        return self._channels

    def forward(self, pictures: Float[Tensor, "V 4 H W"]) -> Float[Tensor, "V C H W"]:
        """Maps at the resolution of the pictures."""
        color, alpha = pictures[:, :3], pictures[:, 3:]
        near, far = (_mean_color(color, alpha, radius) for radius in RADII)
        exact = torch.where(alpha > 0.5, color / alpha.clamp(min=0.5), near)
        levels = [torch.cat([level, _slopes(level)], dim=1) for level in (exact, near, far)]
        base = torch.cat([*levels, _mean_square(alpha, RADII[1])], dim=1)
        if not len(self.kernels):
            return base
        mixed = functional.conv2d(functional.pad(base - 0.5, (1, 1, 1, 1), mode="replicate"), self.kernels)
        return torch.cat([base, torch.tanh(4.0 * mixed)], dim=1)


def _mean_color(color: Tensor, alpha: Tensor, radius: int) -> Float[Tensor, "V 3 H W"]:
    """Mean over a square of pixels, weighted by coverage; zero where nothing is near."""
    total = _mean_square(torch.cat([color, alpha], dim=1), radius)
    return total[:, :3] / total[:, 3:].clamp(min=1e-3)


def _mean_square(values: Float[Tensor, "V C H W"], radius: int) -> Float[Tensor, "V C H W"]:
    """Mean over squares of pixels, zero beyond the edge; separable, because that is faster."""
    columns = functional.avg_pool2d(values, (2 * radius + 1, 1), 1, (radius, 0))
    return functional.avg_pool2d(columns, (1, 2 * radius + 1), 1, (0, radius))


def _slopes(level: Tensor) -> Float[Tensor, "V 2 H W"]:
    """Differences of brightness across and along, over two pixels."""
    gray = (level * level.new_tensor(LUMA)[:, None, None]).sum(dim=1, keepdim=True)
    wide = functional.pad(gray, (1, 1, 1, 1), mode="replicate")
    across = wide[:, :, 1:-1, 2:] - wide[:, :, 1:-1, :-2]
    along = wide[:, :, 2:, 1:-1] - wide[:, :, :-2, 1:-1]
    return torch.cat([across, along], dim=1)
