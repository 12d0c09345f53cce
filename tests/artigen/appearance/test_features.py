"""Feature extractors: the pyramid's laws, and DINOv2's keys, shapes and arithmetic on a tiny checkpoint."""

from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import save_file
from torch import nn
from torch.nn import functional

from artigen.appearance.extractors import ExtractorConfig, make_extractor
from artigen.appearance.features import BASE, FeatureExtractor, PyramidFeatures
from artigen.errors import SourceError
from artigen.models.dinov2 import MEAN, STD, DinoConfig, DinoV2, load_dinov2

SMALL = DinoConfig(width=24, blocks=2, heads=2, patch=4, edge=3, registers=2)


def disc(color: tuple[float, float, float], size: int = 32) -> torch.Tensor:
    """A premultiplied picture of a disc."""
    steps = torch.arange(size) - (size - 1) / 2
    alpha = ((steps[:, None] ** 2 + steps**2) < (0.4 * size) ** 2).float()
    return torch.cat([torch.tensor(color)[:, None, None] * alpha, alpha[None]])[None]


def test_the_background_does_not_mix_into_colours():
    color = (0.8, 0.3, 0.1)
    picture = disc(color)
    maps = PyramidFeatures(20)(picture)
    inside = picture[0, 3] > 0
    for level in (slice(0, 3), slice(5, 8), slice(10, 13)):
        found = maps[0, level][:, inside]
        torch.testing.assert_close(found, torch.tensor(color)[:, None].expand_as(found), atol=1e-5, rtol=0)
    assert maps.shape == (1, 20, 32, 32)


def test_the_pyramid_is_the_same_every_time_and_sees_differences():
    one, two = (PyramidFeatures(24)(disc((0.8, 0.3, 0.1))) for _ in range(2))
    assert torch.equal(one, two)
    other = PyramidFeatures(24)(disc((0.1, 0.3, 0.8)))
    assert ((one - other).abs().amax(dim=(0, 2, 3)) > 1e-3)[BASE:].all()
    turned = PyramidFeatures(24)(disc((0.8, 0.3, 0.1)).flip(3))
    torch.testing.assert_close(turned[:, :3].flip(3), one[:, :3])
    torch.testing.assert_close(turned[:, 3].flip(2), -one[:, 3])
    with pytest.raises(ValueError, match="at least 16"):
        PyramidFeatures(8)


def test_extractors_answer_to_one_interface():
    for extractor in (make_extractor(ExtractorConfig(channels=18)), DinoV2(SMALL)):
        assert isinstance(extractor, FeatureExtractor)
        maps = extractor(disc((0.5, 0.5, 0.5)))
        assert maps.shape[1] == extractor.channels
        assert extractor.name.endswith(str(extractor.channels))
    with pytest.raises(SourceError, match="folder"):
        make_extractor(ExtractorConfig(name="dinov2"))


def public_names(cfg: DinoConfig) -> dict[str, tuple[int, ...]]:
    """Names and shapes of `dinov2_vitl14_reg4_pretrain.pth`, for any size."""
    w, hidden = cfg.width, cfg.mlp_ratio * cfg.width
    names: dict[str, tuple[int, ...]] = {
        "cls_token": (1, 1, w),
        "pos_embed": (1, 1 + cfg.edge**2, w),
        "register_tokens": (1, cfg.registers, w),
        "mask_token": (1, w),
        "patch_embed.proj.weight": (w, 3, cfg.patch, cfg.patch),
        "patch_embed.proj.bias": (w,),
        "norm.weight": (w,),
        "norm.bias": (w,),
    }
    for block in range(cfg.blocks):
        for name, shape in {
            "norm1.weight": (w,),
            "norm1.bias": (w,),
            "attn.qkv.weight": (3 * w, w),
            "attn.qkv.bias": (3 * w,),
            "attn.proj.weight": (w, w),
            "attn.proj.bias": (w,),
            "ls1.gamma": (w,),
            "norm2.weight": (w,),
            "norm2.bias": (w,),
            "mlp.fc1.weight": (hidden, w),
            "mlp.fc1.bias": (hidden,),
            "mlp.fc2.weight": (w, hidden),
            "mlp.fc2.bias": (w,),
            "ls2.gamma": (w,),
        }.items():
            names[f"blocks.{block}.{name}"] = shape
    return names


def test_dinov2_has_the_public_names_and_shapes_at_full_size():
    with torch.device("meta"):
        network = DinoV2(DinoConfig())
    found = {name: tuple(value.shape) for name, value in network.state_dict().items()}
    assert found == public_names(DinoConfig())
    assert sum(int(np.prod(shape)) for shape in found.values()) == 304_372_736


@pytest.fixture
def checkpoint() -> dict[str, torch.Tensor]:
    generator = torch.Generator().manual_seed(0)
    return {
        name: 0.3 * torch.randn(shape, generator=generator) for name, shape in public_names(SMALL).items()
    }


@pytest.mark.parametrize("ending", ["pth", "safetensors"])
def test_weights_are_read_from_a_folder_whole_or_refused(
    tmp_path: Path, checkpoint: dict[str, torch.Tensor], ending: str
):
    path = tmp_path / f"dinov2_vitl14_reg4_pretrain.{ending}"
    write = torch.save if ending == "pth" else save_file
    with pytest.raises(SourceError, match="holds neither"):
        load_dinov2(tmp_path, SMALL)
    write(checkpoint, path)
    network = load_dinov2(tmp_path, SMALL)
    assert torch.equal(network.state_dict()["cls_token"], checkpoint["cls_token"])
    assert not any(parameter.requires_grad for parameter in network.parameters())
    write({name: value for name, value in checkpoint.items() if "register" not in name}, path)
    with pytest.raises(SourceError, match=r"1 missing \(register_tokens\)"):
        load_dinov2(tmp_path, SMALL)
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(SourceError, match="complete"):
        load_dinov2(tmp_path, SMALL)


@torch.no_grad()
def test_dinov2_computes_what_a_vision_transformer_does(tmp_path: Path, checkpoint: dict[str, torch.Tensor]):
    torch.save(checkpoint, tmp_path / "dinov2_vitl14_reg4_pretrain.pth")
    network = load_dinov2(tmp_path, SMALL)
    picture = torch.rand(2, 4, 12, 12, generator=torch.Generator().manual_seed(1))
    maps = network(picture)
    assert maps.shape == (2, 24, 3, 3)
    x = (picture[:, :3] - torch.tensor(MEAN)[:, None, None]) / torch.tensor(STD)[:, None, None]
    w = checkpoint
    patches = functional.unfold(x, 4, stride=4).transpose(1, 2) @ w["patch_embed.proj.weight"].flatten(1).T
    patches = patches + w["patch_embed.proj.bias"] + w["pos_embed"][:, 1:]
    first = (w["cls_token"] + w["pos_embed"][:, :1]).expand(2, -1, -1)
    x = torch.cat([first, w["register_tokens"].expand(2, -1, -1), patches], dim=1)
    for block in range(2):
        p = {name.removeprefix(f"blocks.{block}."): v for name, v in w.items() if f"blocks.{block}." in name}
        attention = nn.MultiheadAttention(24, 2, batch_first=True)
        attention.in_proj_weight.copy_(p["attn.qkv.weight"])
        attention.in_proj_bias.copy_(p["attn.qkv.bias"])
        attention.out_proj.weight.copy_(p["attn.proj.weight"])
        attention.out_proj.bias.copy_(p["attn.proj.bias"])
        h = functional.layer_norm(x, (24,), p["norm1.weight"], p["norm1.bias"], eps=1e-6)
        x = x + p["ls1.gamma"] * attention(h, h, h, need_weights=False)[0]
        h = functional.layer_norm(x, (24,), p["norm2.weight"], p["norm2.bias"], eps=1e-6)
        h = functional.gelu(h @ p["mlp.fc1.weight"].T + p["mlp.fc1.bias"])
        x = x + p["ls2.gamma"] * (h @ p["mlp.fc2.weight"].T + p["mlp.fc2.bias"])
    expected = x[:, 3:].transpose(1, 2).reshape(2, 24, 3, 3)
    torch.testing.assert_close(maps, expected, atol=1e-4, rtol=1e-4)
    larger = network(functional.interpolate(picture, scale_factor=4, mode="nearest"))
    assert larger.shape == maps.shape
