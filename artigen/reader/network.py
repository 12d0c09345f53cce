"""The reader's network: maps of centres on a pretrained trunk, with boxes and attributes at every cell.

As in CenterNet (Zhou et al., 2019), each kind of thing has a map whose peaks are the middles of its boxes.
What is known of a thing is read at its peak.
"""

from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from artigen.reader.labels import HINGES, KINDS, MATERIALS, STANDS, THINGS
from artigen.reader.trunk import Block, Trunk

STRIDE = 4
"""Pixels of a cell's edge."""
ATTRIBUTES = {
    "box": 4 * len(THINGS), "corners": 8, "door": 1, "hinge": len(HINGES), "open": 1, "pane": 1,
    "material": len(MATERIALS), "kind": len(KINDS), "stand": len(STANDS), "view": 3, "size": 3,
}  # fmt: skip
"""Channels of what is read at peaks: boxes of each thing (logarithms of the distances to left, top, right and
bottom in pixels); corners, door, hinge, open, pane and material of fronts; kind, stand, view and size of
objects."""
PRIOR = -4.5
"""Initial logit of peaks."""
REACH = (3.3, 1.8, 1.8, 2.8, 2.0, 4.4)
"""Initial logarithm of the distance from the middle to each side (pixels), by thing."""
GROUPS = 8
WIDE, INNER = 7, 2
"""Cells of a wide filter's edge, and channels within a block of them over those of the decoder."""


@dataclass(frozen=True, kw_only=True)
class ReaderConfig:
    """Sizes of the network."""

    variant: str = "lite2"
    """Variant of the trunk."""
    width: int = 96
    """Channels of the decoder."""
    context: int = 3
    """Blocks with wide filters at stride 32: the ends of a large front are far from its middle."""
    tuned_from: int = 8
    """Stride after which blocks of the trunk are tuned."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Maps:
    """What the network says about a batch of pictures, per cell of `STRIDE` pixels."""

    heat: Float[Tensor, "B T h w"]
    """Logits of peaks, by `THINGS`."""
    attributes: dict[str, Float[Tensor, "B C h w"]]
    """By `ATTRIBUTES`."""


class _Fuse(nn.Module):
    """A convolution with a norm."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.conv = nn.Conv2d(width, width, 3, padding=1)
        self.norm = nn.GroupNorm(GROUPS, width)

    def forward(self, x: Float[Tensor, "B C H W"]) -> Float[Tensor, "B C H W"]:
        return functional.relu(self.norm(self.conv(x)))


class _Wide(nn.Module):
    """A residual block with a wide filter of each channel (ConvNeXt, Liu et al., 2022); at first the
    identity."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.depth = nn.Conv2d(width, width, WIDE, padding=WIDE // 2, groups=width)
        self.norm = nn.GroupNorm(GROUPS, width)
        self.widen, self.narrow = nn.Conv2d(width, INNER * width, 1), nn.Conv2d(INNER * width, width, 1)
        nn.init.zeros_(self.narrow.weight)
        self.narrow.bias = nn.Parameter(torch.zeros(width))

    def forward(self, x: Float[Tensor, "B C H W"]) -> Float[Tensor, "B C H W"]:
        return x + self.narrow(functional.gelu(self.widen(self.norm(self.depth(x)))))


class ReaderNetwork(nn.Module):
    """Trunk, a decoder from its deepest features to those at stride 4, and maps."""

    def __init__(self, cfg: ReaderConfig) -> None:
        super().__init__()
        self.cfg = cfg
        self.trunk = Trunk(cfg.variant)
        self.first_tuned = 0 if cfg.tuned_from == 0 else self.trunk.taps[(4, 8, 16).index(cfg.tuned_from)] + 1
        self.trunk.stem.requires_grad_(requires_grad=False)
        for index, block in enumerate(self.trunk.blocks):
            assert isinstance(block, Block)
            if index < self.first_tuned:
                block.requires_grad_(requires_grad=False)
            # General filters, whose gradients would cost most of a step.
            block.depth.weight.requires_grad = False
        self.sides = nn.ModuleList(nn.Conv2d(channels, cfg.width, 1) for channels in self.trunk.channels)
        self.context = nn.Sequential(*(_Wide(cfg.width) for _ in range(cfg.context)))
        self.fuse = nn.ModuleList(_Fuse(cfg.width) for _ in self.trunk.channels)
        self.last = _Fuse(cfg.width)
        self.heat = nn.Conv2d(cfg.width, len(THINGS), 1)
        self.attributes = nn.Conv2d(cfg.width, sum(ATTRIBUTES.values()), 1)
        reach = torch.zeros(sum(ATTRIBUTES.values()))
        reach[: ATTRIBUTES["box"]] = torch.tensor(REACH).repeat_interleave(4)
        self.heat.bias = nn.Parameter(torch.full((len(THINGS),), PRIOR))
        self.attributes.bias = nn.Parameter(reach)

    def forward(self, pixels: Tensor) -> Maps:
        """Reads RGB pixels from 0 to 255, [B, 3, H, W]; H and W are multiples of 32."""
        taps = []
        with torch.no_grad():
            x = self.trunk.enter(pixels)
            for index in range(self.first_tuned):
                x = self.trunk.blocks[index](x)
                if index in self.trunk.taps:
                    taps.append(x)
        for index in range(self.first_tuned, len(self.trunk.blocks)):
            x = self.trunk.blocks[index](x)
            if index in self.trunk.taps:
                taps.append(x)
        y = self.fuse[3](self.context(self.sides[3](taps[3])))
        for level in (2, 1, 0):
            y = functional.interpolate(y, scale_factor=2.0, mode="nearest")
            y = self.fuse[level](self.sides[level](taps[level]) + y)
        y = self.last(y)
        said = self.attributes(y).float().split(list(ATTRIBUTES.values()), dim=1)
        return Maps(heat=self.heat(y).float(), attributes=dict(zip(ATTRIBUTES, said, strict=True)))
