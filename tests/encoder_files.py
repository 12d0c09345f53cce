"""Folders of DINOv2 and CLIP as the Hugging Face hub publishes them, small and with random weights."""

import json
from itertools import chain
from pathlib import Path
from typing import TypeVar

import torch
from torch import nn
from transformers import CLIPConfig, CLIPModel, Dinov2WithRegistersConfig, Dinov2WithRegistersModel

from artigen.models.public_encoders import ClipConfig, DinoConfig

DINO = DinoConfig(width=48, patch=4, edge=4)
CLIP = ClipConfig(width=32, length=24)
VOCABULARY = 536
Network = TypeVar("Network", bound=nn.Module)
MERGES = [
    "d o",
    "do o",
    "doo r</w>",
    "doo r",
    "door s</w>",
    "t h",
    "th r",
    "thr e",
    "thre e</w>",
    "w i",
    "wi th</w>",
    "t h</w>",
    "c a",
    "ca b",
    "i n",
    "in e",
    "ine t</w>",
    "cab inet</w>",
    "1 2</w>",
    "a n</w>",
    "o n",
    "on e</w>",
]


def write_dinov2(folder: Path, blocks: int = 1) -> Dinov2WithRegistersModel:
    """Writes a network and returns it."""
    config = Dinov2WithRegistersConfig(
        hidden_size=DINO.width,
        num_hidden_layers=blocks,
        num_attention_heads=2,
        image_size=DINO.edge * DINO.patch,
        patch_size=DINO.patch,
        num_register_tokens=DINO.registers,
    )
    network = randomize(Dinov2WithRegistersModel(config))
    network.save_pretrained(folder)
    return network


def write_clip(folder: Path) -> nn.Module:
    """Writes a tokenizer and a whole model, pictures included; returns the text encoder."""
    text = {
        "vocab_size": VOCABULARY,
        "hidden_size": CLIP.width,
        "intermediate_size": 4 * CLIP.width,
        "num_hidden_layers": 2,
        "num_attention_heads": 4,
        "max_position_embeddings": CLIP.length,
    }
    pictures = {
        "hidden_size": 16,
        "intermediate_size": 16,
        "num_hidden_layers": 1,
        "num_attention_heads": 2,
        "image_size": 8,
        "patch_size": 4,
    }
    whole = randomize(CLIPModel(CLIPConfig(text_config=text, vision_config=pictures)))
    whole.save_pretrained(folder)
    own = [*range(33, 127), *range(161, 173), *range(174, 256)]
    letters = [*map(chr, own), *(chr(256 + number) for number in range(256 - len(own)))]
    pieces = [*letters, *(letter + "</w>" for letter in letters), *(m.replace(" ", "") for m in MERGES)]
    known = {
        piece: number for number, piece in enumerate(chain(pieces, ("<|startoftext|>", "<|endoftext|>")))
    }
    (folder / "vocab.json").write_text(json.dumps(known))
    (folder / "merges.txt").write_text("\n".join(("#version: 0.2", *MERGES)) + "\n")
    return whole.text_model


def randomize(network: Network) -> Network:
    """Weights of a size at which every part of a network matters."""
    generator = torch.Generator().manual_seed(0)
    for weight in network.parameters():
        nn.init.normal_(weight, std=0.2, generator=generator)
    return network.eval()
