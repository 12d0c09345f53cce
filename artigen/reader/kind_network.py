"""Names the kind of an object by the trunk as it was pretrained, which has seen a million photographs."""

import torch
from jaxtyping import Float
from torch import Tensor, nn

from artigen.reader.labels import KINDS
from artigen.reader.trunk import POOLED, Trunk

DROPPED = 0.3
"""Share of the features that are left out at random in training."""


class KindNetwork(nn.Module):
    """A frozen trunk, and one linear layer on what its ImageNet classifier reads.

    Its last output is that a picture shows no object of a known kind.
    """

    def __init__(self, variant: str) -> None:
        super().__init__()
        self.trunk = Trunk(variant, pooled=True).requires_grad_(requires_grad=False)
        self.kinds = nn.Linear(POOLED, len(KINDS) + 1)
        nn.init.zeros_(self.kinds.weight)
        nn.init.zeros_(self.kinds.bias)

    @torch.no_grad()
    def extract(self, pixels: Tensor) -> Float[Tensor, "B 1280"]:
        """Features of RGB pixels from 0 to 255, [B, 3, H, W]; H and W are multiples of 32."""
        return self.trunk.pool(self.trunk(pixels)[-1]).float()

    def forward(self, pixels: Tensor) -> Float[Tensor, "B L"]:
        """Logits of `KINDS`, and of nothing."""
        return self.kinds(self.extract(pixels))


def pack_bytes(weights: dict[str, Tensor]) -> dict[str, Tensor]:
    """Matrices and filters as 8-bit integers, with one step per output; the rest as it is."""
    out = {}
    for name, value in weights.items():
        if value.dim() < 2:
            out[name] = value
            continue
        flat = value.flatten(1)
        step = (flat.abs().amax(dim=1) / 127.0).clamp(min=1e-12)
        out[name] = (flat / step[:, None]).round().to(torch.int8).reshape(value.shape)
        out[f"{name}.step"] = step
    return out


def unpack_bytes(packed: dict[str, Tensor]) -> dict[str, Tensor]:
    """Weights of `pack_bytes`, off by at most half a step."""
    out = {}
    for name, value in packed.items():
        if value.dtype == torch.int8:
            step = packed[f"{name}.step"].float()
            out[name] = value.float() * step.reshape(-1, *[1] * (value.dim() - 1))
        elif not name.endswith(".step"):
            out[name] = value.float()
    return out
