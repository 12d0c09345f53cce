"""Attention and transformer blocks, with the parameter names of TRELLIS."""

import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn
from torch.nn import functional

NORM_EPS = 1e-6


class RmsNorm(nn.Module):
    """Unit root mean square per head, times a learned gain, in float32."""

    def __init__(self, heads: int, width: int) -> None:
        super().__init__()
        self.scale = width**0.5
        self.gamma = nn.Parameter(torch.ones(heads, width))

    def forward(self, x: Float[Tensor, "B L H D"]) -> Float[Tensor, "B L H D"]:
        return (functional.normalize(x.float(), dim=-1) * self.gamma * self.scale).to(x.dtype)


class SelfAttention(nn.Module):
    """Every token attends to every token of its sample."""

    def __init__(self, channels: int, heads: int, *, rms_norm: bool) -> None:
        super().__init__()
        self.heads, self.rms_norm = heads, rms_norm
        self.to_qkv = nn.Linear(channels, 3 * channels)
        self.to_out = nn.Linear(channels, channels)
        if rms_norm:
            self.q_rms_norm = RmsNorm(heads, channels // heads)
            self.k_rms_norm = RmsNorm(heads, channels // heads)

    def forward(
        self, x: Float[Tensor, "B L C"], mask: Bool[Tensor, "B 1 1 L"] | None = None
    ) -> Float[Tensor, "B L C"]:
        """Mixes the tokens of a sample; ``mask`` is False at tokens that are padding."""
        q, k, v = self.to_qkv(x).unflatten(-1, (3, self.heads, -1)).unbind(2)
        if self.rms_norm:
            q, k = self.q_rms_norm(q), self.k_rms_norm(k)
        return self.to_out(attend(q, k, v, mask))


class CrossAttention(nn.Module):
    """Tokens attend to the tokens of a condition."""

    def __init__(self, channels: int, context: int, heads: int, *, rms_norm: bool) -> None:
        super().__init__()
        self.heads, self.rms_norm = heads, rms_norm
        self.to_q = nn.Linear(channels, channels)
        self.to_kv = nn.Linear(context, 2 * channels)
        self.to_out = nn.Linear(channels, channels)
        if rms_norm:
            self.q_rms_norm = RmsNorm(heads, channels // heads)
            self.k_rms_norm = RmsNorm(heads, channels // heads)

    def forward(self, x: Float[Tensor, "B L C"], context: Float[Tensor, "B M K"]) -> Float[Tensor, "B L C"]:
        q = self.to_q(x).unflatten(-1, (self.heads, -1))
        k, v = self.to_kv(context).unflatten(-1, (2, self.heads, -1)).unbind(2)
        if self.rms_norm:
            q, k = self.q_rms_norm(q), self.k_rms_norm(k)
        return self.to_out(attend(q, k, v))


class FeedForward(nn.Module):
    """Two linear layers around the tanh form of GELU."""

    def __init__(self, channels: int, ratio: float) -> None:
        super().__init__()
        hidden = int(channels * ratio)
        self.mlp = nn.Sequential(
            nn.Linear(channels, hidden), nn.GELU(approximate="tanh"), nn.Linear(hidden, channels)
        )

    def forward(self, x: Float[Tensor, "*B C"]) -> Float[Tensor, "*B C"]:
        return self.mlp(x)


def attend(
    q: Float[Tensor, "B L H D"],
    k: Float[Tensor, "B M H D"],
    v: Float[Tensor, "B M H D"],
    mask: Bool[Tensor, "B 1 1 M"] | None = None,
) -> Float[Tensor, "B L C"]:
    """Softmax attention to the keys where ``mask`` is True, heads side by side in the result."""
    q, k, v = (tensor.transpose(1, 2).to(v.dtype) for tensor in (q, k, v))
    out = functional.scaled_dot_product_attention(q, k, v, attn_mask=mask)
    return out.transpose(1, 2).flatten(2)


def plain_norm(x: Float[Tensor, "*B C"], eps: float = NORM_EPS) -> Float[Tensor, "*B C"]:
    """Layer norm without gain or bias, in float32."""
    return functional.layer_norm(x.float(), x.shape[-1:], eps=eps).to(x.dtype)


def learned_norm(x: Float[Tensor, "*B C"], norm: nn.LayerNorm) -> Float[Tensor, "*B C"]:
    """Layer norm with gain and bias, in float32."""
    normed = functional.layer_norm(x.float(), x.shape[-1:], norm.weight.float(), norm.bias.float(), norm.eps)
    return normed.to(x.dtype)


def modulate(
    x: Float[Tensor, "B L C"], shift: Float[Tensor, "B C"], scale: Float[Tensor, "B C"]
) -> Float[Tensor, "B L C"]:
    """Scales and shifts every token of a sample alike."""
    return x * (1 + scale.unsqueeze(1)) + shift.unsqueeze(1)
