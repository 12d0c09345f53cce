"""EfficientNet-Lite (Tan and Le, 2019; the variant for mobile devices): a convolutional trunk pretrained on
ImageNet.

Every batch norm is folded into the convolution before it: its statistics stay those of ImageNet, while the
weights may be tuned. Pictures of any size that is a multiple of 32 pixels are read; features are taken at
four strides.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

STAGES = (
    (1, 3, 1, 1, 16),
    (2, 3, 2, 6, 24),
    (2, 5, 2, 6, 40),
    (3, 3, 2, 6, 80),
    (3, 5, 1, 6, 112),
    (4, 5, 2, 6, 192),
    (1, 3, 1, 6, 320),
)
"""Blocks, kernel, stride, expansion and channels of each stage before scaling."""
SCALES = {"lite0": (1.0, 1.0), "lite1": (1.0, 1.1), "lite2": (1.1, 1.2)}
"""Factors on channels and on blocks of each variant."""
STEM, POOLED = 32, 1280
STRIDES = (4, 8, 16, 32)
"""Strides (pixels) of the features that are returned."""
MEAN, SPREAD = 127.0, 128.0
"""Pixel values from 0 to 255 are shifted and scaled by these, as the pretrained weights expect."""
EPSILON = 1e-3
"""Added to variances by the batch norms of the pretrained weights."""


@dataclass(frozen=True, kw_only=True)
class BlockShape:
    """One inverted residual block."""

    kernel: int
    stride: int
    expansion: int
    inputs: int
    outputs: int


def list_blocks(variant: str) -> list[BlockShape]:
    """The blocks of a variant, ``lite0`` to ``lite2``."""
    wide, deep = SCALES[variant]
    blocks, inputs = [], STEM
    for number, (count, kernel, stride, expansion, channels) in enumerate(STAGES):
        outputs = _round_channels(channels * wide)
        repeats = count if number in (0, len(STAGES) - 1) else -int(-count * deep // 1)
        for k in range(repeats):
            blocks.append(
                BlockShape(
                    kernel=kernel,
                    stride=stride if k == 0 else 1,
                    expansion=expansion,
                    inputs=inputs,
                    outputs=outputs,
                )
            )
            inputs = outputs
    return blocks


def _round_channels(channels: float) -> int:
    """The nearest multiple of 8, at most a tenth below."""
    near = max(8, int(channels + 4) // 8 * 8)
    return near + 8 if near < 0.9 * channels else near


class FoldedConv(nn.Module):
    """A convolution without batch norm whose output has the input's size over the stride, rounded up."""

    def __init__(self, inputs: int, outputs: int, kernel: int, stride: int = 1, groups: int = 1) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.zeros(outputs, inputs // groups, kernel, kernel))
        self.bias = nn.Parameter(torch.zeros(outputs))
        self.kernel, self.stride, self.groups = kernel, stride, groups

    def forward(self, x: Float[Tensor, "B C H W"]) -> Float[Tensor, "B D h w"]:
        if self.kernel == 1:
            return functional.conv2d(x, self.weight, self.bias)
        # TensorFlow's padding "same": where the total is odd, the larger half lies below and to the right.
        high, wide = (
            max((-(-n // self.stride) - 1) * self.stride + self.kernel - n, 0) for n in x.shape[-2:]
        )
        if high % 2 == 0 and wide % 2 == 0:
            pad = (high // 2, wide // 2)
        else:
            x = functional.pad(x, (wide // 2, wide - wide // 2, high // 2, high - high // 2))
            pad = (0, 0)
        if self.groups == 1:
            return functional.conv2d(x, self.weight, self.bias, self.stride, pad)
        # With the bias apart, nothing computes the slow gradient of a depthwise weight that is not tuned.
        y = functional.conv2d(x, self.weight, None, self.stride, pad, 1, self.groups)
        return y + self.bias[:, None, None].to(y.dtype)


class Block(nn.Module):
    """An inverted residual block: expand, filter each channel, project, and add the input where sizes
    agree."""

    def __init__(self, shape: BlockShape) -> None:
        super().__init__()
        inner = shape.inputs * shape.expansion
        self.expand = None if shape.expansion == 1 else FoldedConv(shape.inputs, inner, 1)
        self.depth = FoldedConv(inner, inner, shape.kernel, shape.stride, groups=inner)
        self.project = FoldedConv(inner, shape.outputs, 1)
        self.adds = shape.stride == 1 and shape.inputs == shape.outputs

    def forward(self, x: Float[Tensor, "B C H W"]) -> Float[Tensor, "B D h w"]:
        y = x if self.expand is None else functional.relu6(self.expand(x))
        y = self.project(functional.relu6(self.depth(y)))
        return x + y if self.adds else y


class Trunk(nn.Module):
    """EfficientNet-Lite without its classifier."""

    def __init__(self, variant: str, pooled: bool = False) -> None:  # noqa: FBT001, FBT002
        """``pooled`` adds the last convolution, whose means the ImageNet classifier reads."""
        super().__init__()
        shapes = list_blocks(variant)
        self.stem = FoldedConv(3, STEM, 3, 2)
        self.blocks = nn.ModuleList(Block(shape) for shape in shapes)
        self.head = FoldedConv(shapes[-1].outputs, POOLED, 1) if pooled else None
        strides, stride = [], 2
        for shape in shapes:
            stride *= shape.stride
            strides.append(stride)
        self.taps = [max(i for i, s in enumerate(strides) if s == wanted) for wanted in STRIDES]
        """Indices of the blocks whose outputs are returned, by `STRIDES`."""
        self.channels = [shapes[tap].outputs for tap in self.taps]

    def enter(self, pixels: Tensor) -> Float[Tensor, "B C H W"]:
        """The stem's features of RGB pixels from 0 to 255, [B, 3, H, W]."""
        x = ((pixels.float() - MEAN) / SPREAD).contiguous(memory_format=torch.channels_last)
        return functional.relu6(self.stem(x))

    def forward(self, pixels: Tensor) -> list[Float[Tensor, "B C H W"]]:
        """Features at `STRIDES` of RGB pixels from 0 to 255, [B, 3, H, W]; H and W are multiples of 32."""
        x, out = self.enter(pixels), []
        for index, block in enumerate(self.blocks):
            x = block(x)
            if index in self.taps:
                out.append(x)
        return out

    def pool(self, deepest: Float[Tensor, "B C H W"]) -> Float[Tensor, "B 1280"]:
        """What the ImageNet classifier reads, from the features at stride 32."""
        assert self.head is not None, "a trunk made with pooled=False"
        return functional.relu6(self.head(deepest)).mean((2, 3))


def fold_weights(weights: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Weights of a `Trunk` with ``pooled``, from those of ``efficientnet_lite_pytorch`` with its batch
    norms."""
    out: dict[str, Tensor] = {}

    def fold(target: str, conv: str, norm: str) -> None:
        gain = weights[f"{norm}.weight"] / (weights[f"{norm}.running_var"] + EPSILON).sqrt()
        out[f"{target}.weight"] = weights[f"{conv}.weight"] * gain[:, None, None, None]
        out[f"{target}.bias"] = weights[f"{norm}.bias"] - weights[f"{norm}.running_mean"] * gain

    fold("stem", "_conv_stem", "_bn0")
    fold("head", "_conv_head", "_bn1")
    for index in sorted({int(name.split(".")[1]) for name in weights if name.startswith("_blocks.")}):
        old, new = f"_blocks.{index}", f"blocks.{index}"
        if f"{old}._expand_conv.weight" in weights:
            fold(f"{new}.expand", f"{old}._expand_conv", f"{old}._bn0")
        fold(f"{new}.depth", f"{old}._depthwise_conv", f"{old}._bn1")
        fold(f"{new}.project", f"{old}._project_conv", f"{old}._bn2")
    return out
