"""CLIP's text encoder: the public network, name by name, in plain torch, and its byte-pair tokenizer.

Everything comes from a local folder as published for ViT-L/14: ``model.safetensors`` (or
``pytorch_model.bin``), ``vocab.json`` and ``merges.txt``. The output is the tokens after the last norm,
before any projection, as in TRELLIS' text models.
"""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import torch
from jaxtyping import Float, Int
from torch import Tensor, nn
from torch.nn import functional

from artigen.errors import SourceError
from artigen.models.tensors import load_strictly, read_published

FILES = ("model.safetensors", "pytorch_model.bin")
VOCABULARY, MERGES = "vocab.json", "merges.txt"
OTHERS = ("vision_model.", "visual_projection.", "text_projection.", "logit_scale")
"""Prefixes of tensors in the published file that a text encoder does not need."""
START, END, WORD_END = "<|startoftext|>", "<|endoftext|>", "</w>"
WORDS = re.compile(r"'s|'t|'re|'ve|'m|'ll|'d|[^\W\d_]+|\d|(?:[^\s\w]|_)+")


@dataclass(frozen=True, kw_only=True)
class ClipConfig:
    """Sizes; the defaults are those of ViT-L/14."""

    vocabulary: int = 49408
    """Size of the vocabulary."""
    length: int = 77
    """Tokens of a sentence, start, end and padding included."""
    width: int = 768
    """Width of a token."""
    blocks: int = 12
    """Transformer blocks."""
    heads: int = 12
    """Attention heads."""
    mlp_ratio: int = 4
    """Hidden width of a feed-forward layer over the model's."""


class ClipText(nn.Module):
    """Causal transformer over the tokens of a sentence; module names are those of the public state dict."""

    def __init__(self, cfg: ClipConfig) -> None:
        super().__init__()
        self.cfg = cfg
        self.text_model = _TextModel(cfg)

    def forward(self, ids: Int[Tensor, "B N"]) -> Float[Tensor, "B N C"]:
        """Tokens after the last norm."""
        return self.text_model(ids)


class _TextModel(nn.Module):
    def __init__(self, cfg: ClipConfig) -> None:
        super().__init__()
        self.embeddings = _Embeddings(cfg)
        self.encoder = _Encoder(cfg)
        self.final_layer_norm = nn.LayerNorm(cfg.width)

    def forward(self, ids: Int[Tensor, "B N"]) -> Float[Tensor, "B N C"]:
        x = self.embeddings.token_embedding(ids) + self.embeddings.position_embedding.weight[: ids.shape[1]]
        for layer in self.encoder.layers:
            x = layer(x)
        return self.final_layer_norm(x)


class _Embeddings(nn.Module):
    def __init__(self, cfg: ClipConfig) -> None:
        super().__init__()
        self.token_embedding = nn.Embedding(cfg.vocabulary, cfg.width)
        self.position_embedding = nn.Embedding(cfg.length, cfg.width)


class _Encoder(nn.Module):
    def __init__(self, cfg: ClipConfig) -> None:
        super().__init__()
        self.layers = nn.ModuleList(_Layer(cfg) for _ in range(cfg.blocks))


class _Layer(nn.Module):
    def __init__(self, cfg: ClipConfig) -> None:
        super().__init__()
        self.layer_norm1 = nn.LayerNorm(cfg.width)
        self.self_attn = _Attention(cfg)
        self.layer_norm2 = nn.LayerNorm(cfg.width)
        self.mlp = _Mlp(cfg)

    def forward(self, x: Float[Tensor, "B N C"]) -> Float[Tensor, "B N C"]:
        x = x + self.self_attn(self.layer_norm1(x))
        return x + self.mlp(self.layer_norm2(x))


class _Attention(nn.Module):
    def __init__(self, cfg: ClipConfig) -> None:
        super().__init__()
        self.heads = cfg.heads
        self.q_proj, self.k_proj, self.v_proj, self.out_proj = (
            nn.Linear(cfg.width, cfg.width) for _ in range(4)
        )

    def forward(self, x: Float[Tensor, "B N C"]) -> Float[Tensor, "B N C"]:
        q, k, v = (
            layer(x).unflatten(2, (self.heads, -1)).transpose(1, 2)
            for layer in (self.q_proj, self.k_proj, self.v_proj)
        )
        seen = functional.scaled_dot_product_attention(q, k, v, is_causal=True)
        return self.out_proj(seen.transpose(1, 2).flatten(2))


class _Mlp(nn.Module):
    def __init__(self, cfg: ClipConfig) -> None:
        super().__init__()
        self.fc1 = nn.Linear(cfg.width, cfg.mlp_ratio * cfg.width)
        self.fc2 = nn.Linear(cfg.mlp_ratio * cfg.width, cfg.width)

    def forward(self, x: Float[Tensor, "B N C"]) -> Float[Tensor, "B N C"]:
        hidden = self.fc1(x)
        return self.fc2(hidden * torch.sigmoid(1.702 * hidden))


class ClipTokenizer:
    """Sentences to token ids: words in lower case, byte by byte, joined by the published merges."""

    def __init__(self, vocabulary: Mapping[str, int], merges: Sequence[tuple[str, str]], length: int) -> None:
        self.vocabulary, self.length = vocabulary, length
        self.ranks = {pair: rank for rank, pair in enumerate(merges)}
        self.letters = _byte_letters()

    def __call__(self, sentences: Sequence[str]) -> Int[Tensor, "B N"]:
        """Ids of start, words and end, padded with further ends; long sentences are truncated."""
        return torch.tensor([self.encode(sentence) for sentence in sentences])

    def encode(self, sentence: str) -> list[int]:
        """Ids of one sentence."""
        pieces = [
            piece
            for word in WORDS.findall(" ".join(sentence.lower().split()))
            for piece in self.split("".join(self.letters[byte] for byte in word.encode()))
        ]
        end = self.vocabulary[END]
        ids = [self.vocabulary[START], *(self.vocabulary[piece] for piece in pieces)][: self.length - 1]
        return [*ids, *[end] * (self.length - len(ids))]

    def split(self, word: str) -> list[str]:
        """Splits a word into the pieces of the published merges, applied in order of rank."""
        pieces = [*word[:-1], word[-1] + WORD_END]
        while len(pieces) > 1:
            best = min(pairwise(pieces), key=lambda pair: self.ranks.get(pair, len(self.ranks)))
            if best not in self.ranks:
                break
            joined, at = [], 0
            while at < len(pieces):
                both = tuple(pieces[at : at + 2]) == best
                joined.append("".join(best) if both else pieces[at])
                at += 2 if both else 1
            pieces = joined
        return pieces


def load_clip(folder: Path, cfg: ClipConfig | None = None) -> tuple[ClipTokenizer, ClipText]:
    """Reads tokenizer and text encoder from a folder, strictly.

    Raises:
        SourceError: If a file is missing or damaged, or tensors of the text encoder differ in name or shape.
    """
    cfg = cfg or ClipConfig()
    path, tensors = read_published(folder, FILES)
    kept = {
        name: value
        for name, value in tensors.items()
        if not name.startswith(OTHERS) and not name.endswith("position_ids")
    }
    network = ClipText(cfg)
    load_strictly(network, kept, str(path))
    return load_tokenizer(folder, cfg.length), network.requires_grad_(requires_grad=False).eval()


def load_tokenizer(folder: Path, length: int) -> ClipTokenizer:
    """Reads the vocabulary and the merges.

    Raises:
        SourceError: If a file is missing or has another form.
    """
    try:
        vocabulary = json.loads((folder / VOCABULARY).read_text())
        lines = (folder / MERGES).read_text().splitlines()
    except (OSError, ValueError) as error:
        raise SourceError(f"{folder}: {VOCABULARY} and {MERGES} cannot be read ({error})") from error
    merges = [tuple(line.split()) for line in lines if line and not line.startswith("#version")]
    if not isinstance(vocabulary, dict) or not {START, END} <= vocabulary.keys():
        raise SourceError(f"{folder / VOCABULARY}: expected ids of tokens, including {START} and {END}")
    if any(len(pair) != 2 for pair in merges):
        raise SourceError(f"{folder / MERGES}: expected two pieces on every line")
    return ClipTokenizer(vocabulary, [(first, second) for first, second in merges], length)


@lru_cache
def _byte_letters() -> dict[int, str]:
    """A printable letter for every byte: its own where it has one, other letters for the rest."""
    own = [*range(ord("!"), ord("~") + 1), *range(0xA1, 0xAD), *range(0xAE, 0x100)]
    rest = [byte for byte in range(256) if byte not in own]
    return {byte: chr(byte) for byte in own} | {byte: chr(256 + number) for number, byte in enumerate(rest)}
