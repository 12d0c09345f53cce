"""Files as CLIP's are published, small and made up: a vocabulary, merges, and weights of any size."""

import json
from itertools import chain
from pathlib import Path

import torch
from safetensors.torch import save_file

from artigen.models.clip import ClipConfig, ClipText

SMALL = ClipConfig(vocabulary=536, length=24, width=32, blocks=2, heads=4)
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


def write_clip(folder: Path) -> dict[str, torch.Tensor]:
    """Writes a tokenizer and the text half of a checkpoint that holds more; returns the text half."""
    folder.mkdir(parents=True, exist_ok=True)
    own = [*range(33, 127), *range(161, 173), *range(174, 256)]
    letters = [*map(chr, own), *(chr(256 + number) for number in range(256 - len(own)))]
    pieces = [*letters, *(letter + "</w>" for letter in letters), *(m.replace(" ", "") for m in MERGES)]
    known = {
        piece: number for number, piece in enumerate(chain(pieces, ("<|startoftext|>", "<|endoftext|>")))
    }
    (folder / "vocab.json").write_text(json.dumps(known))
    (folder / "merges.txt").write_text("\n".join(("#version: 0.2", *MERGES)) + "\n")
    generator = torch.Generator().manual_seed(0)
    tensors = {
        name: 0.2 * torch.randn(value.shape, generator=generator)
        for name, value in ClipText(SMALL).state_dict().items()
    }
    others = {
        "vision_model.post_layernorm.weight": torch.ones(4),
        "logit_scale": torch.ones(()),
        "text_model.embeddings.position_ids": torch.arange(SMALL.length)[None],
    }
    save_file(tensors | others, folder / "model.safetensors")
    return tensors
