"""DINOv2 with registers as a feature extractor: the public network, name by name, in plain torch.

Weights come from a local folder (`dinov2_vitl14_reg4_pretrain.pth` as published, or the same tensors as
safetensors). Pictures are prepared as in TRELLIS: black background, 518 pixels, ImageNet's mean and standard
deviation. The output is the patch tokens before the last norm, on which TRELLIS' encoder was trained.
"""

from dataclasses import dataclass
from pathlib import Path

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from artigen.models.tensors import load_strictly, read_published

MEAN, STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)
"""Mean and standard deviation of ImageNet's RGB values."""
FILES = ("dinov2_vitl14_reg4_pretrain.pth", "dinov2_vitl14_reg4_pretrain.safetensors")
BATCH = 8
"""Pictures at once."""


@dataclass(frozen=True, kw_only=True)
class DinoConfig:
    """Sizes; the defaults are those of ViT-L/14 with four registers."""

    width: int = 1024
    """Width of a token."""
    blocks: int = 24
    """Transformer blocks."""
    heads: int = 16
    """Attention heads."""
    patch: int = 14
    """Edge of a patch in pixels."""
    edge: int = 37
    """Patches along an edge of a picture."""
    registers: int = 4
    """Tokens that belong to no patch, besides the class token."""
    mlp_ratio: int = 4
    """Hidden width of a feed-forward layer over the model's."""
    final_norm: bool = False
    """Whether tokens go through the last norm; TRELLIS takes them before it."""


class DinoV2(nn.Module):
    """Vision transformer with registers; module names are those of the public state dict."""

    def __init__(self, cfg: DinoConfig) -> None:
        super().__init__()
        self.cfg = cfg
        width = cfg.width
        self.cls_token = nn.Parameter(torch.zeros(1, 1, width))
        self.register_tokens = nn.Parameter(torch.zeros(1, cfg.registers, width))
        self.mask_token = nn.Parameter(torch.zeros(1, width))
        self.pos_embed = nn.Parameter(torch.zeros(1, 1 + cfg.edge**2, width))
        self.patch_embed = _PatchEmbed(width, cfg.patch)
        self.blocks = nn.ModuleList(_Block(cfg) for _ in range(cfg.blocks))
        self.norm = nn.LayerNorm(width, eps=1e-6)

    @property
    def name(self) -> str:
        """Name of the features."""
        return f"dinov2-{self.cfg.width}"

    @property
    def channels(self) -> int:
        """Number of channels of a feature map."""
        return self.cfg.width

    def forward(self, pictures: Float[Tensor, "V 4 H W"]) -> Float[Tensor, "V C h w"]:
        """Patch tokens as maps."""
        edge = self.cfg.edge
        tokens = torch.cat([self.tokens(part[:, :3]) for part in pictures.split(BATCH)])
        return tokens[:, 1 + self.cfg.registers :].transpose(1, 2).unflatten(2, (edge, edge))

    def tokens(self, rgb: Float[Tensor, "V 3 H W"]) -> Float[Tensor, "V L C"]:
        """Class token, registers, patches; ``rgb`` in [0, 1] on black, of any size."""
        size = self.cfg.edge * self.cfg.patch
        if rgb.shape[2:] != (size, size):
            rgb = functional.interpolate(rgb, (size, size), mode="bicubic", antialias=True).clamp(0.0, 1.0)
        mean, std = (rgb.new_tensor(values)[:, None, None] for values in (MEAN, STD))
        patches = self.patch_embed.proj((rgb - mean) / std).flatten(2).transpose(1, 2)
        x = torch.cat([self.cls_token.expand(len(rgb), -1, -1), patches], dim=1) + self.pos_embed
        x = torch.cat([x[:, :1], self.register_tokens.expand(len(rgb), -1, -1), x[:, 1:]], dim=1)
        for block in self.blocks:
            x = block(x)
        return self.norm(x) if self.cfg.final_norm else x


class _PatchEmbed(nn.Module):
    def __init__(self, width: int, patch: int) -> None:
        super().__init__()
        self.proj = nn.Conv2d(3, width, patch, stride=patch)


class _LayerScale(nn.Module):
    def __init__(self, width: int) -> None:
        super().__init__()
        self.gamma = nn.Parameter(torch.ones(width))


class _Attention(nn.Module):
    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.qkv = nn.Linear(width, 3 * width)
        self.proj = nn.Linear(width, width)

    def forward(self, x: Float[Tensor, "V L C"]) -> Float[Tensor, "V L C"]:
        q, k, v = self.qkv(x).unflatten(2, (3, self.heads, -1)).permute(2, 0, 3, 1, 4).unbind(0)
        return self.proj(functional.scaled_dot_product_attention(q, k, v).transpose(1, 2).flatten(2))


class _Mlp(nn.Module):
    def __init__(self, width: int, hidden: int) -> None:
        super().__init__()
        self.fc1 = nn.Linear(width, hidden)
        self.fc2 = nn.Linear(hidden, width)

    def forward(self, x: Float[Tensor, "V L C"]) -> Float[Tensor, "V L C"]:
        return self.fc2(functional.gelu(self.fc1(x)))


class _Block(nn.Module):
    def __init__(self, cfg: DinoConfig) -> None:
        super().__init__()
        self.norm1 = nn.LayerNorm(cfg.width, eps=1e-6)
        self.attn = _Attention(cfg.width, cfg.heads)
        self.ls1 = _LayerScale(cfg.width)
        self.norm2 = nn.LayerNorm(cfg.width, eps=1e-6)
        self.mlp = _Mlp(cfg.width, cfg.mlp_ratio * cfg.width)
        self.ls2 = _LayerScale(cfg.width)

    def forward(self, x: Float[Tensor, "V L C"]) -> Float[Tensor, "V L C"]:
        x = x + self.ls1.gamma * self.attn(self.norm1(x))
        return x + self.ls2.gamma * self.mlp(self.norm2(x))


def load_dinov2(folder: Path, cfg: DinoConfig | None = None) -> DinoV2:
    """Reads the published weights from a folder, strictly.

    Raises:
        SourceError: If neither file is there, one is damaged, or tensors differ in name or shape.
    """
    path, tensors = read_published(folder, FILES)
    network = DinoV2(cfg or DinoConfig())
    load_strictly(network, tensors, str(path))
    return network.requires_grad_(requires_grad=False).eval()
