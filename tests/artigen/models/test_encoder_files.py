"""DINOv2 and CLIP from folders: tokens as TRELLIS takes them, and files that are refused."""

import json
import logging
import socket
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import torch
from encoder_files import CLIP, DINO, VOCABULARY, write_clip, write_dinov2
from safetensors.torch import load_file, save_file
from torch import Tensor, nn
from torch.nn import functional
from transformers import Dinov2WithRegistersModel

from artigen.errors import SourceError
from artigen.models.public_encoders import ClipText, find_encoders, load_clip, load_dinov2

SIZE = DINO.edge * DINO.patch
START, END = 534, 535
RECORDED = {
    "A cabinet with three doors": [320, 529, 522, 520, 516],
    "  two   DOORS, and one drawer!": [83, 86, 334, 516, 267, 64, 77, 323, 533, 67, 81, 64, 86, 68, 337, 256],
    "it's 80cm wide & 1.2 m tall": [
        72, 339, 6, 338, 279, 271, 66, 332, 521, 67, 324, 261, 272, 269, 273, 332, 83, 64, 75, 331,
    ],
    "naïve café — schräg": [
        77, 64, 127, 107, 85, 324, 524, 69, 127, 358, 158, 222, 498, 82, 66, 71, 81, 127, 97, 326,
    ],
    "": [],
    "x" * 60: [87] * 22,
}  # fmt: skip
"""Ids that transformers 4.46 gives for these files, without start, end and padding."""


def inputs_of(network: nn.Module, act: Callable[[], object]) -> list[Tensor]:
    """What a network is given while something is done."""
    given: list[Tensor] = []
    hook = network.register_forward_pre_hook(lambda _, values: given.append(values[0]))
    act()
    hook.remove()
    return given


def read_ids(clip: ClipText, sentences: list[str]) -> Tensor:
    (ids,) = inputs_of(clip.network, lambda: clip(sentences))
    return ids


def test_sentences_become_the_recorded_ids(tmp_path: Path):
    write_clip(tmp_path)
    clip = load_clip(tmp_path, CLIP)
    ids = read_ids(clip, list(RECORDED))
    for row, expected in zip(ids.tolist(), RECORDED.values(), strict=True):
        assert row == [START, *expected, *[END] * (CLIP.length - 1 - len(expected))]
    clip.tokenizer.save_pretrained(tmp_path)  # the hub has further files of the same tokenizer
    assert torch.equal(read_ids(load_clip(tmp_path, CLIP), list(RECORDED)), ids)


@torch.no_grad()
def test_sentences_are_read_after_the_last_norm_with_their_padding(tmp_path: Path):
    text, said = write_clip(tmp_path), ["a cabinet with one door", "three doors"]
    clip = load_clip(tmp_path, CLIP)
    ids, tokens = read_ids(clip, said), clip(said)
    masked = text(ids, attention_mask=(ids != END).long()).last_hidden_state
    assert (masked[:, -1] - tokens[:, -1]).abs().max() > 0.01
    norm = text.get_submodule("final_layer_norm")
    text.final_layer_norm = nn.Identity()
    torch.testing.assert_close(tokens, norm(text(ids).last_hidden_state))


@torch.no_grad()
def test_pictures_are_read_before_the_last_norm(tmp_path: Path):
    network, rgb = write_dinov2(tmp_path), torch.rand(2, 3, SIZE, SIZE)
    mean, std = torch.tensor([0.485, 0.456, 0.406]), torch.tensor([0.229, 0.224, 0.225])
    usual = network((rgb - mean[:, None, None]) / std[:, None, None]).last_hidden_state
    tokens = load_dinov2(tmp_path, DINO).tokens(rgb)
    torch.testing.assert_close(network.layernorm(tokens), usual)
    assert (tokens - usual).abs().max() > 0.1


@torch.no_grad()
def test_the_class_token_comes_first_then_registers_then_patches_by_rows(tmp_path: Path):
    parts = write_dinov2(tmp_path, blocks=0).embeddings
    extractor, pictures = load_dinov2(tmp_path, DINO), torch.rand(2, 4, SIZE, SIZE)
    (shown,) = inputs_of(extractor.network, lambda: extractor.tokens(pictures[:, :3]))
    places = parts.position_embeddings
    patches = parts.patch_embeddings.projection(shown) + places[0, 1:].T.unflatten(1, (DINO.edge, DINO.edge))
    first = (parts.cls_token + places[:, :1]).expand(2, -1, -1)
    tokens = torch.cat(
        [first, parts.register_tokens.expand(2, -1, -1), patches.flatten(2).transpose(1, 2)], 1
    )
    torch.testing.assert_close(extractor.tokens(pictures[:, :3]), tokens)
    torch.testing.assert_close(extractor(pictures), patches)


@torch.no_grad()
def test_pictures_of_any_size_and_number_are_read(tmp_path: Path):
    write_dinov2(tmp_path)
    extractor = load_dinov2(tmp_path, DINO)
    large = torch.zeros(1, 3, 50, 50)
    large[..., 20:] = 1.0
    small = functional.interpolate(large, (SIZE, SIZE), mode="bicubic", antialias=True)
    assert small.max() > 1.01  # bicubic filters overshoot
    torch.testing.assert_close(extractor.tokens(large), extractor.tokens(small.clamp(0.0, 1.0)))
    nine = torch.rand(9, 4, SIZE, SIZE)
    assert [len(some) for some in inputs_of(extractor.network, lambda: extractor(nine))] == [8, 1]
    torch.testing.assert_close(extractor(nine)[8:], extractor(nine[8:]))


def test_weights_are_frozen_and_in_full_precision(tmp_path: Path):
    write_dinov2(tmp_path / "dinov2").half().save_pretrained(tmp_path / "dinov2")
    write_clip(tmp_path / "clip")
    stored = load_file(tmp_path / "dinov2" / "model.safetensors")
    assert stored["encoder.layer.0.attention.attention.query.weight"].dtype == torch.float16  # the hub's name
    for network in (load_dinov2(tmp_path / "dinov2", DINO), load_clip(tmp_path / "clip", CLIP)):
        assert not network.training
        assert {(weight.dtype, weight.requires_grad) for weight in network.parameters()} == {
            (torch.float32, False)
        }


def test_reading_opens_no_connection(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def refuse(*_: object) -> None:
        raise AssertionError("a connection was opened")

    monkeypatch.setattr(socket.socket, "connect", refuse)
    write_clip(tmp_path / "clip")
    load_clip(tmp_path / "clip", CLIP)
    write_dinov2(tmp_path / "dinov2")
    load_dinov2(tmp_path / "dinov2", DINO)


def test_warnings_of_the_library_are_turned_off_while_it_reads(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
):
    write_clip(tmp_path / "clip")
    write_dinov2(tmp_path / "dinov2")
    path = tmp_path / "dinov2" / "model.safetensors"
    save_file({name: value for name, value in load_file(path).items() if "register" not in name}, path)
    logger = logging.getLogger("transformers")
    logger.addHandler(caplog.handler)
    try:
        load_clip(tmp_path / "clip", CLIP)
        with pytest.raises(SourceError, match="1 missing"):
            load_dinov2(tmp_path / "dinov2", DINO)
        assert caplog.text == ""
        Dinov2WithRegistersModel.from_pretrained(tmp_path / "dinov2")
        assert "register_tokens" in caplog.text
    finally:
        logger.removeHandler(caplog.handler)


def test_it_is_said_that_the_library_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    write_clip(tmp_path / "clip-vit-large-patch14")
    monkeypatch.setitem(sys.modules, "transformers", None)
    for act in (find_encoders, load_clip, load_dinov2):
        with pytest.raises(SourceError, match=r'not installed: pip install "artigen\[encoders\]"'):
            act(tmp_path)


def test_networks_that_are_not_complete_are_refused(tmp_path: Path):
    write_dinov2(tmp_path)
    path, key = tmp_path / "model.safetensors", "embeddings.register_tokens"
    weights, whole = load_file(path), path.read_bytes()
    for wrong, said in (
        ({name: value for name, value in weights.items() if name != key}, rf"1 missing \({key}\)"),
        (weights | {"more": torch.ones(1)}, r"1 unexpected \(more\)"),
        (weights | {key: torch.ones(1, 3, 48)}, rf"{key} is \[1, 3, 48\], expected \[1, 4, 48\]"),
        (weights | {key: torch.full((1, 4, 48), torch.inf)}, rf"1 not finite \({key}\)"),
    ):
        save_file(wrong, path)
        with pytest.raises(SourceError, match=f"does not fit Dinov2WithRegistersModel: .*{said}"):
            load_dinov2(tmp_path, DINO)
    path.write_bytes(whole[:-100])
    with pytest.raises(SourceError, match="cannot be read"):
        load_dinov2(tmp_path, DINO)
    path.write_bytes(whole)
    with pytest.raises(SourceError, match=r"width=48, .* expected .*width=1024"):
        load_dinov2(tmp_path)
    (tmp_path / "config.json").write_text("{")
    with pytest.raises(SourceError, match="cannot be read"):
        load_dinov2(tmp_path, DINO)
    path.unlink()
    with pytest.raises(SourceError, match=r"lacks model\.safetensors; download dinov2-with-registers-large"):
        load_dinov2(tmp_path, DINO)


def test_tokenizers_that_are_not_complete_are_refused(tmp_path: Path):
    write_clip(tmp_path)
    with pytest.raises(SourceError, match=r"length=24.* expected .*length=77"):
        load_clip(tmp_path)
    path = tmp_path / "vocab.json"
    whole = path.read_text()
    path.write_text(json.dumps(json.loads(whole) | {"more": VOCABULARY}))
    with pytest.raises(SourceError, match="has 537 tokens, expected 536"):
        load_clip(tmp_path, CLIP)
    path.write_text(whole[:-100])
    with pytest.raises(SourceError, match=r"vocab\.json and merges\.txt cannot be read"):
        load_clip(tmp_path, CLIP)
    path.unlink()
    with pytest.raises(SourceError, match=r"lacks vocab\.json; download clip-vit-large-patch14"):
        load_clip(tmp_path, CLIP)
