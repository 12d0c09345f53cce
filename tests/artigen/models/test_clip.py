"""CLIP's text encoder and tokenizer: public names, recorded ids, what a causal transformer computes."""

from pathlib import Path

import pytest
import torch
from clip_files import SMALL, write_clip
from torch import nn
from torch.nn import functional

from artigen.errors import SourceError
from artigen.models.clip import ClipConfig, ClipText, load_clip, load_tokenizer

RECORDED = {
    "A cabinet with three doors": [320, 529, 522, 520, 516],
    "  two   DOORS, and one drawer!": [83, 86, 334, 516, 267, 64, 77, 323, 533, 67, 81, 64, 86, 68, 337, 256],
    "it's 80cm wide & 1.2 m tall": [
        72, 339, 6, 338, 279, 271, 66, 332, 521, 67, 324, 261, 272, 269, 273, 332, 83, 64, 75, 331,
    ],
    "naïve café — schräg": [
        77, 64, 127, 107, 85, 324, 524, 69, 127, 358, 158, 222, 498, 82, 66, 71, 81, 127, 97, 326,
    ],
    "thethree door-knob_handle": [517, 68, 520, 514, 268, 74, 77, 78, 321, 318, 71, 64, 77, 67, 75, 324],
    "": [],
    "x" * 60: [87] * 22,
}  # fmt: skip
"""Ids that transformers 4.46 gives for these files, without start, end and padding."""
START, END = 534, 535


def test_sentences_become_the_recorded_ids(tmp_path: Path):
    write_clip(tmp_path)
    tokenizer = load_tokenizer(tmp_path, SMALL.length)
    ids = tokenizer(list(RECORDED))
    assert ids.shape == (len(RECORDED), SMALL.length)
    for row, expected in zip(ids.tolist(), RECORDED.values(), strict=True):
        assert row == [START, *expected, *[END] * (SMALL.length - 1 - len(expected))]


def test_the_full_size_has_the_public_tensors():
    with torch.device("meta"):
        tensors = ClipText(ClipConfig()).state_dict()
    assert len(tensors) == 196
    assert sum(value.numel() for value in tensors.values()) == 123_060_480
    shapes = {name: tuple(value.shape) for name, value in tensors.items()}
    assert shapes["text_model.embeddings.token_embedding.weight"] == (49408, 768)
    assert shapes["text_model.embeddings.position_embedding.weight"] == (77, 768)
    assert shapes["text_model.encoder.layers.11.self_attn.out_proj.bias"] == (768,)
    assert shapes["text_model.encoder.layers.0.mlp.fc1.weight"] == (3072, 768)
    assert shapes["text_model.final_layer_norm.weight"] == (768,)


@torch.no_grad()
def test_it_computes_what_a_causal_transformer_does(tmp_path: Path):
    w = write_clip(tmp_path)
    tokenizer, network = load_clip(tmp_path, SMALL)
    ids = tokenizer(["a cabinet with one door", "three doors"])
    size = (SMALL.width,)
    x = w["text_model.embeddings.token_embedding.weight"][ids]
    x = x + w["text_model.embeddings.position_embedding.weight"]
    later = torch.ones(SMALL.length, SMALL.length, dtype=torch.bool).triu(1)
    for block in range(SMALL.blocks):
        before = f"text_model.encoder.layers.{block}."
        p = {name.removeprefix(before): value for name, value in w.items() if name.startswith(before)}
        attention = nn.MultiheadAttention(SMALL.width, SMALL.heads, batch_first=True)
        for kind in ("weight", "bias"):
            joined = torch.cat([p[f"self_attn.{name}_proj.{kind}"] for name in "qkv"])
            getattr(attention, f"in_proj_{kind}").copy_(joined)
            getattr(attention.out_proj, kind).copy_(p[f"self_attn.out_proj.{kind}"])
        h = functional.layer_norm(x, size, p["layer_norm1.weight"], p["layer_norm1.bias"])
        x = x + attention(h, h, h, need_weights=False, attn_mask=later)[0]
        h = functional.layer_norm(x, size, p["layer_norm2.weight"], p["layer_norm2.bias"])
        h = h @ p["mlp.fc1.weight"].T + p["mlp.fc1.bias"]
        x = x + (h * torch.sigmoid(1.702 * h)) @ p["mlp.fc2.weight"].T + p["mlp.fc2.bias"]
    norm = "text_model.final_layer_norm"
    expected = functional.layer_norm(x, size, w[f"{norm}.weight"], w[f"{norm}.bias"])
    torch.testing.assert_close(network(ids), expected, atol=1e-4, rtol=1e-4)


def test_what_comes_later_changes_nothing_before_it(tmp_path: Path):
    write_clip(tmp_path)
    tokenizer, network = load_clip(tmp_path, SMALL)
    said = network(tokenizer(["a cabinet with one door", "a cabinet with three doors"]))
    torch.testing.assert_close(said[0, :4], said[1, :4])
    assert (said[0, 4] - said[1, 4]).abs().max() > 0.1


def test_files_that_are_missing_or_cut_short_are_named(tmp_path: Path):
    with pytest.raises(SourceError, match=r"holds neither model\.safetensors nor"):
        load_clip(tmp_path, SMALL)
    write_clip(tmp_path)
    whole = (tmp_path / "model.safetensors").read_bytes()
    (tmp_path / "model.safetensors").write_bytes(whole[:-100])
    with pytest.raises(SourceError, match="no whole safetensors file"):
        load_clip(tmp_path, SMALL)
    (tmp_path / "model.safetensors").write_bytes(whole)
    (tmp_path / "merges.txt").write_text("a b c\n")
    with pytest.raises(SourceError, match="two pieces on every line"):
        load_clip(tmp_path, SMALL)
    (tmp_path / "vocab.json").write_text("{}")
    with pytest.raises(SourceError, match="startoftext"):
        load_clip(tmp_path, SMALL)
    (tmp_path / "vocab.json").unlink()
    with pytest.raises(SourceError, match=r"vocab\.json and merges\.txt cannot be read"):
        load_clip(tmp_path, SMALL)
