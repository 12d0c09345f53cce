"""The trunk against the network that its weights were trained as: convolutions with batch norms."""

import torch
from torch import Tensor
from torch.nn import functional

from artigen.reader.trunk import EPSILON, STRIDES, Trunk, fold_weights, list_blocks


def draw_weights(variant: str) -> dict[str, Tensor]:
    """Random weights as `efficientnet_lite_pytorch` names them."""
    generator = torch.Generator().manual_seed(3)
    out: dict[str, Tensor] = {}

    def add(conv: str, norm: str, inputs: int, outputs: int, kernel: int, groups: int = 1) -> None:
        fan = inputs // groups * kernel * kernel
        shape = (outputs, inputs // groups, kernel, kernel)
        out[f"{conv}.weight"] = torch.randn(shape, generator=generator) * (2.0 / fan) ** 0.5
        out[f"{norm}.weight"] = 0.5 + torch.rand(outputs, generator=generator)
        out[f"{norm}.bias"] = torch.randn(outputs, generator=generator) * 0.1
        out[f"{norm}.running_mean"] = torch.randn(outputs, generator=generator) * 0.1
        out[f"{norm}.running_var"] = 0.5 + torch.rand(outputs, generator=generator)

    add("_conv_stem", "_bn0", 3, 32, 3)
    for index, block in enumerate(list_blocks(variant)):
        own, inner = f"_blocks.{index}.", block.inputs * block.expansion
        if block.expansion != 1:
            add(f"{own}_expand_conv", f"{own}_bn0", block.inputs, inner, 1)
        add(f"{own}_depthwise_conv", f"{own}_bn1", inner, inner, block.kernel, inner)
        add(f"{own}_project_conv", f"{own}_bn2", inner, block.outputs, 1)
    add("_conv_head", "_bn1", list_blocks(variant)[-1].outputs, 1280, 1)
    return out


def run_reference(weights: dict[str, Tensor], variant: str, x: Tensor) -> tuple[Tensor, Tensor]:
    """Features at stride 32 and what the classifier reads, with batch norms and TensorFlow's padding."""

    def convolve(x: Tensor, conv: str, norm: str, stride: int, groups: int = 1) -> Tensor:
        weight = weights[f"{conv}.weight"]
        kernel = weight.shape[-1]
        pads = []
        for edge in (x.shape[3], x.shape[2]):
            total = max((-(-edge // stride) - 1) * stride + kernel - edge, 0)
            pads += [total // 2, total - total // 2]
        y = functional.conv2d(functional.pad(x, pads), weight, None, stride, 0, 1, groups)
        own = {name: weights[f"{norm}.{name}"] for name in ("running_mean", "running_var", "weight", "bias")}
        return functional.batch_norm(y, **own, training=False, eps=EPSILON)

    x = functional.relu6(convolve((x.float() - 127.0) / 128.0, "_conv_stem", "_bn0", 2))
    for index, block in enumerate(list_blocks(variant)):
        own, y = f"_blocks.{index}.", x
        if block.expansion != 1:
            y = functional.relu6(convolve(y, f"{own}_expand_conv", f"{own}_bn0", 1))
        inner = y.shape[1]
        y = functional.relu6(convolve(y, f"{own}_depthwise_conv", f"{own}_bn1", block.stride, inner))
        y = convolve(y, f"{own}_project_conv", f"{own}_bn2", 1)
        x = x + y if block.stride == 1 and block.inputs == block.outputs else y
    return x, functional.relu6(convolve(x, "_conv_head", "_bn1", 1)).mean((2, 3))


def test_folded_weights_compute_what_batch_norms_do():
    weights = draw_weights("lite0")
    trunk = Trunk("lite0", pooled=True)
    trunk.load_state_dict(fold_weights(weights))
    pixels = torch.randint(0, 256, (2, 3, 96, 64), generator=torch.Generator().manual_seed(1))
    deepest, pooled = run_reference(weights, "lite0", pixels)
    with torch.no_grad():
        found = trunk(pixels)
        torch.testing.assert_close(found[-1], deepest, rtol=1e-3, atol=1e-3)
        torch.testing.assert_close(trunk.pool(found[-1]), pooled, rtol=1e-3, atol=1e-3)


def test_features_have_the_stated_strides_and_channels():
    for variant in ("lite0", "lite1", "lite2"):
        trunk = Trunk(variant)
        with torch.no_grad():
            found = trunk(torch.zeros(1, 3, 64, 96, dtype=torch.uint8))
        sizes = [(1, channels, 64 // s, 96 // s) for channels, s in zip(trunk.channels, STRIDES, strict=True)]
        assert [tuple(one.shape) for one in found] == sizes
