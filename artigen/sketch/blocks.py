"""Blocks of the sketch network: causal attention over rows, attention within and to a picture."""

from dataclasses import dataclass
from math import log

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional


@dataclass(frozen=True, kw_only=True, eq=False)
class PictureMemory:
    """Picture memory: keys and values for each block that attends to pictures."""

    keys: tuple[Float[Tensor, "B H N E"], ...]
    values: tuple[Float[Tensor, "B H N E"], ...]

    def __getitem__(self, pictures: slice) -> "PictureMemory":
        """The memory of some of the pictures."""
        return PictureMemory(
            keys=tuple(one[pictures] for one in self.keys), values=tuple(one[pictures] for one in self.values)
        )


class Feed(nn.Module):
    """A residual feed-forward layer."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.norm = nn.RMSNorm(width)
        self.up = nn.Linear(width, 2 * width, bias=False)
        self.down = nn.Linear(2 * width, width, bias=False)

    def forward(self, x: Float[Tensor, "... D"]) -> Float[Tensor, "... D"]:
        return x + self.down(functional.gelu(self.up(self.norm(x))))


class SelfAttention(nn.Module):
    """Layers that blocks share: self-attention, then a feed-forward layer."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.norm = nn.RMSNorm(width)
        self.qkv = nn.Linear(width, 3 * width, bias=False)
        self.out = nn.Linear(width, width, bias=False)
        self.feed = Feed(width)

    def split(self, x: Float[Tensor, "B T D"]) -> tuple[Tensor, Tensor, Tensor]:
        """Queries, keys and values by head, each [B, H, T, E]."""
        q, k, v = self.qkv(self.norm(x)).unflatten(-1, (3, self.heads, -1)).permute(2, 0, 3, 1, 4)
        return q, k, v

    def finish(self, x: Float[Tensor, "B T D"], mixed: Float[Tensor, "B H T E"]) -> Float[Tensor, "B T D"]:
        """Adds the attended values, then the feed-forward layer."""
        return self.feed(x + self.out(mixed.transpose(1, 2).flatten(2)))

    def shrink(self, layers: int) -> None:
        """Initialises what the block adds to its input for a stack of so many blocks."""
        for last in (self.out, self.feed.down):
            nn.init.normal_(last.weight, std=0.5 / (self.out.in_features * 2 * layers) ** 0.5)


class Block(SelfAttention):
    """Causal attention with rotary positions, then a feed-forward layer."""

    def __init__(self, width: int, heads: int, *, looks: bool = False) -> None:
        super().__init__(width, heads)
        self.look = CrossAttention(width, heads) if looks else None

    def forward(self, x: Float[Tensor, "B T D"], turn: tuple[Tensor, Tensor]) -> Float[Tensor, "B T D"]:
        q, k, v = self.split(x)
        q, k = _turn(q, turn), _turn(k, turn)
        scores = q @ k.transpose(-1, -2) * q.shape[-1] ** -0.5
        ahead = torch.ones(scores.shape[-2:], dtype=torch.bool, device=x.device)
        scores = scores.masked_fill(ahead.triu(1), float("-inf"))
        return self.finish(x, scores.float().softmax(dim=-1).to(v.dtype) @ v)


class TokenBlock(SelfAttention):
    """Attention among all tokens of a picture, then a feed-forward layer."""

    def forward(self, x: Float[Tensor, "B N D"]) -> Float[Tensor, "B N D"]:
        q, k, v = self.split(x)
        return self.finish(x, functional.scaled_dot_product_attention(q, k, v))


class CrossAttention(nn.Module):
    """Cross-attention to picture tokens."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.norm = nn.RMSNorm(width)
        self.query = nn.Linear(width, width, bias=False)
        self.memory = nn.Linear(width, 2 * width, bias=False)
        self.out = nn.Linear(width, width, bias=False)

    def project(self, tokens: Float[Tensor, "B N D"]) -> tuple[Tensor, Tensor]:
        """Keys and values of a picture's tokens."""
        keys, values = self.memory(tokens).unflatten(-1, (2, self.heads, -1)).permute(2, 0, 3, 1, 4)
        return keys, values

    def forward(
        self, x: Float[Tensor, "B T D"], keys: Float[Tensor, "B H N E"], values: Float[Tensor, "B H N E"]
    ) -> Float[Tensor, "B T D"]:
        query = self.query(self.norm(x)).unflatten(-1, (self.heads, -1)).transpose(1, 2)
        mixed = functional.scaled_dot_product_attention(query, keys.to(query.dtype), values.to(query.dtype))
        return x + self.out(mixed.transpose(1, 2).flatten(2))


def find_turns(x: Float[Tensor, "B T D"], width: int) -> tuple[Float[Tensor, "T H"], Float[Tensor, "T H"]]:
    """Cosines and sines for rotary position embedding, for heads of a given width."""
    half = width // 2
    speed = torch.exp(torch.arange(half, device=x.device) * (-log(10000.0) / half))
    angle = torch.arange(x.shape[1], device=x.device)[:, None] * speed
    return angle.cos(), angle.sin()


def _turn(x: Float[Tensor, "B H T E"], turn: tuple[Tensor, Tensor]) -> Float[Tensor, "B H T E"]:
    cos, sin = (one.to(x.dtype) for one in turn)
    a, b = x.chunk(2, dim=-1)
    return torch.cat([a * cos - b * sin, a * sin + b * cos], dim=-1)
