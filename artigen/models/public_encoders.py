"""DINOv2 and CLIP as readers of conditions: public networks that are not trained, from a local folder.

They are no part of a model's weights. A network that can be asked by pictures or sentences is told where to
find them (`attach_encoders`); without, it answers every other condition.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn
from torch.nn import functional

from artigen.errors import SourceError
from artigen.models import clip, dinov2
from artigen.models.clip import ClipConfig, ClipText, ClipTokenizer, load_clip
from artigen.models.dinov2 import DinoConfig, DinoV2, load_dinov2

CLIP_FOLDER = "clip-vit-large-patch14"
"""Where CLIP's files lie in the folder of encoders, beside the file of DINOv2."""


class PublicPictures(nn.Module):
    """Pictures as DINOv2's tokens, normalised without weights; zeros where there is none, as in TRELLIS."""

    def __init__(self, cfg: DinoConfig) -> None:
        super().__init__()
        self.cfg = cfg
        self.found: list[DinoV2] = []
        """Not a module of this one: its weights are not the model's."""

    def forward(self, image: Float[Tensor, "B 4 H W"], given: Bool[Tensor, "B"]) -> Float[Tensor, "B N C"]:
        """Class token, registers, patches; pictures are premultiplied on black."""
        tokens = image.new_zeros(len(image), 1 + self.cfg.registers + self.cfg.edge**2, self.cfg.width)
        if not given.any():
            return tokens
        if not self.found:
            raise SourceError(
                f"pictures are read by DINOv2, whose weights were not given: put one of "
                f"{', '.join(dinov2.FILES)} into a folder and name it (--encoders)"
            )
        reader = self.found[0].to(image.device)
        with torch.no_grad():
            seen = reader.tokens(image[given, :3])
        tokens[given] = functional.layer_norm(seen.float(), seen.shape[-1:]).to(tokens.dtype)
        return tokens


class PublicSentences(nn.Module):
    """Sentences as CLIP's tokens, brought to the width of the others; a missing one is a learned token."""

    def __init__(self, cfg: ClipConfig, width: int) -> None:
        super().__init__()
        self.cfg = cfg
        self.out_layer = nn.Linear(cfg.width, width)
        self.missing = nn.Parameter(torch.zeros(width))
        self.found: list[tuple[ClipTokenizer, ClipText]] = []
        """Not a module of this one: its weights are not the model's."""

    def forward(self, sentences: Sequence[str | None]) -> Float[Tensor, "B N C"]:
        """A row of tokens for every sentence."""
        device = self.missing.device
        rows = [row for row, sentence in enumerate(sentences) if sentence is not None]
        every = self.missing.expand(len(sentences), self.cfg.length, -1)
        if not rows:
            return every
        if not self.found:
            raise SourceError(
                f"sentences are read by CLIP, whose files were not given: put {clip.FILES[0]}, "
                f"{clip.VOCABULARY} and {clip.MERGES} into a folder {CLIP_FOLDER}, and name the folder "
                "that holds it (--encoders)"
            )
        tokenizer, network = self.found[0]
        ids = tokenizer([sentence for sentence in sentences if sentence is not None]).to(device)
        with torch.no_grad():
            read = network.to(device)(ids).float()
        told = self.out_layer(read)
        return every.to(told.dtype).index_copy(0, torch.tensor(rows, device=device), told)


def find_encoders(folder: Path) -> tuple[Literal["image", "text"], ...]:
    """Finds the encoders in a folder.

    Raises:
        SourceError: If it has none.
    """
    found: list[Literal["image", "text"]] = []
    if any((folder / name).is_file() for name in dinov2.FILES):
        found.append("image")
    if (folder / CLIP_FOLDER).is_dir():
        found.append("text")
    if not found:
        raise SourceError(
            f"{folder}: holds neither DINOv2 ({' or '.join(dinov2.FILES)}) nor CLIP (a folder {CLIP_FOLDER})"
        )
    return tuple(found)


def attach_encoders(network: nn.Module, folder: Path) -> None:
    """Gives all parts of a network that read pictures or sentences with public networks what a folder has.

    Raises:
        SourceError: If the folder has none, or one is not whole.
    """
    found = find_encoders(folder)
    for part in network.modules():
        if isinstance(part, PublicPictures) and "image" in found:
            part.found = [load_dinov2(folder, part.cfg)]
        if isinstance(part, PublicSentences) and "text" in found:
            part.found = [load_clip(folder / CLIP_FOLDER, part.cfg)]
