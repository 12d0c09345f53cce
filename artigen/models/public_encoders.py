"""DINOv2 and CLIP of `transformers`, frozen, from local folders as the Hugging Face hub publishes them.

They are not part of a model's weights. `attach_encoders` gives them to a network that takes pictures or
sentences; without them, the network still takes every other condition. Tokens are those that TRELLIS takes:
DINOv2's before its last norm, CLIP's after it, padded and without an attention mask.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Literal

import torch
from jaxtyping import Bool, Float
from torch import Tensor, nn
from torch.nn import functional

from artigen.errors import SourceError, explain
from artigen.models.tensors import require_fit

if TYPE_CHECKING:
    from transformers import CLIPTextModel, CLIPTokenizer, Dinov2WithRegistersModel

DINO_FOLDER, CLIP_FOLDER = "dinov2-with-registers-large", "clip-vit-large-patch14"
"""Names of the models on the hub, and of their folders within the folder of encoders."""
NETWORK_FILES, TOKENIZER_FILES = ("config.json", "model.safetensors"), ("vocab.json", "merges.txt")
OTHERS = ("vision_model.", "visual_projection.", "text_projection.", "logit_scale")
"""Prefixes of the tensors in CLIP's file that its text encoder does not need."""
MEAN, STD = (0.485, 0.456, 0.406), (0.229, 0.224, 0.225)
"""Mean and standard deviation of ImageNet's RGB values."""
BATCH = 8
"""Pictures at once."""


@dataclass(frozen=True, kw_only=True)
class DinoConfig:
    """Sizes of DINOv2's tokens; the defaults are those of ViT-L/14 with four registers."""

    width: int = 1024
    """Width of a token."""
    patch: int = 14
    """Edge of a patch in pixels."""
    edge: int = 37
    """Patches along an edge of a picture."""
    registers: int = 4
    """Tokens that belong to no patch, besides the class token."""

    @property
    def length(self) -> int:
        """Tokens of a picture: class token, registers, patches."""
        return 1 + self.registers + self.edge**2


@dataclass(frozen=True, kw_only=True)
class ClipConfig:
    """Sizes of CLIP's tokens of a sentence; the defaults are those of ViT-L/14."""

    width: int = 768
    """Width of a token."""
    length: int = 77
    """Tokens of a sentence, start, end and padding included."""


class DinoV2(nn.Module):
    """DINOv2 as a feature extractor."""

    def __init__(self, network: "Dinov2WithRegistersModel", cfg: DinoConfig) -> None:
        super().__init__()
        self.cfg, self.network = cfg, network

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
        return self.network((rgb - mean) / std).last_hidden_state


class ClipText(nn.Module):
    """CLIP's tokenizer and text encoder."""

    def __init__(self, tokenizer: "CLIPTokenizer", network: "CLIPTextModel", cfg: ClipConfig) -> None:
        super().__init__()
        self.cfg, self.tokenizer, self.network = cfg, tokenizer, network

    def forward(self, sentences: Sequence[str]) -> Float[Tensor, "B N C"]:
        """A row of tokens for every sentence; long sentences are truncated."""
        ids = self.tokenizer(
            list(sentences),
            padding="max_length",
            max_length=self.cfg.length,
            truncation=True,
            return_tensors="pt",
        ).input_ids
        return self.network(ids.to(self.network.device)).last_hidden_state


class PublicPictures(nn.Module):
    """Pictures as DINOv2's tokens, normalised without weights; zeros for missing ones, as in TRELLIS."""

    def __init__(self, cfg: DinoConfig) -> None:
        super().__init__()
        self.cfg = cfg
        self.found: list[DinoV2] = []
        """A list, so that its weights are not registered as those of the model."""

    def forward(self, image: Float[Tensor, "B 4 H W"], given: Bool[Tensor, "B"]) -> Float[Tensor, "B N C"]:
        """Class token, registers, patches; pictures are premultiplied on black."""
        tokens = image.new_zeros(len(image), self.cfg.length, self.cfg.width)
        if not given.any():
            return tokens
        if not self.found:
            raise SourceError(f"pictures need DINOv2, which was not given: {_advise(DINO_FOLDER)}")
        reader = self.found[0].to(image.device)
        with torch.no_grad():
            seen = reader.tokens(image[given, :3])
        tokens[given] = functional.layer_norm(seen.float(), seen.shape[-1:]).to(tokens.dtype)
        return tokens


class PublicSentences(nn.Module):
    """Sentences as CLIP's tokens, projected to the width of the others; a missing one is a learned token."""

    def __init__(self, cfg: ClipConfig, width: int) -> None:
        super().__init__()
        self.cfg = cfg
        self.out_layer = nn.Linear(cfg.width, width)
        self.missing = nn.Parameter(torch.zeros(width))
        self.found: list[ClipText] = []
        """A list, so that its weights are not registered as those of the model."""

    def forward(self, sentences: Sequence[str | None]) -> Float[Tensor, "B N C"]:
        """A row of tokens for every sentence."""
        device = self.missing.device
        rows = [row for row, sentence in enumerate(sentences) if sentence is not None]
        every = self.missing.expand(len(sentences), self.cfg.length, -1)
        if not rows:
            return every
        if not self.found:
            raise SourceError(f"sentences need CLIP, which was not given: {_advise(CLIP_FOLDER)}")
        reader = self.found[0].to(device)
        with torch.no_grad():
            read = reader([sentence for sentence in sentences if sentence is not None]).float()
        tokens = self.out_layer(read)
        return every.to(tokens.dtype).index_copy(0, torch.tensor(rows, device=device), tokens)


def find_encoders(folder: Path) -> tuple[Literal["image", "text"], ...]:
    """Finds the encoders in a folder.

    Raises:
        SourceError: If it has none, or `transformers` is not installed.
    """
    found: list[Literal["image", "text"]] = []
    if (folder / DINO_FOLDER).is_dir():
        found.append("image")
    if (folder / CLIP_FOLDER).is_dir():
        found.append("text")
    if not found:
        raise SourceError(f"{folder}: holds neither DINOv2 (a folder {DINO_FOLDER}) nor CLIP ({CLIP_FOLDER})")
    _import_transformers()
    return tuple(found)


def attach_encoders(network: nn.Module, folder: Path) -> None:
    """Attaches the public encoders of a folder to all modules of a network that need them.

    Raises:
        SourceError: If the folder has none, or one is incomplete.
    """
    found = find_encoders(folder)
    for part in network.modules():
        if isinstance(part, PublicPictures) and "image" in found:
            part.found = [load_dinov2(folder / DINO_FOLDER, part.cfg)]
        if isinstance(part, PublicSentences) and "text" in found:
            part.found = [load_clip(folder / CLIP_FOLDER, part.cfg)]


def load_dinov2(folder: Path, cfg: DinoConfig | None = None) -> DinoV2:
    """Reads DINOv2 with registers from its folder, strictly.

    Raises:
        SourceError: If `transformers` or a file is missing, or a file is damaged or of another model.
    """
    cfg = cfg or DinoConfig()
    network = _load_network(_import_transformers().Dinov2WithRegistersModel, folder, DINO_FOLDER)
    said = network.config
    sizes = DinoConfig(
        width=said.hidden_size,
        patch=said.patch_size,
        edge=said.image_size // said.patch_size,
        registers=said.num_register_tokens,
    )
    _require_same(folder, sizes, cfg)
    network.layernorm = nn.Identity()
    return DinoV2(network, cfg).eval()


def load_clip(folder: Path, cfg: ClipConfig | None = None) -> ClipText:
    """Reads CLIP's tokenizer and text encoder from the folder of the whole model, strictly.

    Raises:
        SourceError: If `transformers` or a file is missing, or a file is damaged or of another model.
    """
    cfg = cfg or ClipConfig()
    library = _import_transformers()
    network = _load_network(library.CLIPTextModel, folder, CLIP_FOLDER)
    said = network.config
    _require_same(folder, ClipConfig(width=said.hidden_size, length=said.max_position_embeddings), cfg)
    _require_files(folder, TOKENIZER_FILES, CLIP_FOLDER)
    try:
        tokenizer = library.CLIPTokenizer.from_pretrained(folder, local_files_only=True)
    except Exception as error:  # the tokenizers library raises plain Exception
        raise SourceError(
            f"{folder}: {' and '.join(TOKENIZER_FILES)} cannot be read ({error}); download them again"
        ) from error
    if len(tokenizer) != said.vocab_size:
        raise SourceError(
            f"{folder}: {TOKENIZER_FILES[0]} has {len(tokenizer)} tokens, expected {said.vocab_size}, as "
            f"{NETWORK_FILES[0]} says; download both from one model"
        )
    return ClipText(tokenizer, network, cfg).eval()


def _load_network(kind: Any, folder: Path, published: str) -> Any:
    """A frozen network of a class of `transformers`, which by itself makes up tensors that are missing."""
    _require_files(folder, NETWORK_FILES, published)
    from safetensors import SafetensorError

    try:
        with _silence():
            network, report = kind.from_pretrained(
                folder,
                local_files_only=True,
                use_safetensors=True,
                ignore_mismatched_sizes=True,
                output_loading_info=True,
            )
    except (OSError, SafetensorError) as error:
        raise SourceError(
            f"{folder}: {' and '.join(NETWORK_FILES)} cannot be read ({explain(error)}); download them again"
        ) from error
    faults = {
        "missing": sorted(report["missing_keys"]),
        "unexpected": sorted(key for key in report["unexpected_keys"] if not key.startswith(OTHERS)),
        "of another shape": sorted(
            f"{key} is {list(found)}, expected {list(expected)}"
            for key, found, expected in report["mismatched_keys"]
        ),
        "not finite": [key for key, value in network.state_dict().items() if not value.isfinite().all()],
    }
    require_fit(faults, f"{folder / NETWORK_FILES[1]}: does not fit {kind.__name__}")
    return network.float().requires_grad_(requires_grad=False)


@contextmanager
def _silence() -> Iterator[None]:
    """Turns off progress bars, and warnings about tensors that are not of the part that is read."""
    from transformers.utils import logging

    level, bars = logging.get_verbosity(), logging.is_progress_bar_enabled()
    logging.set_verbosity_error()
    logging.disable_progress_bar()
    try:
        yield
    finally:
        logging.set_verbosity(level)
        if bars:
            logging.enable_progress_bar()


def _import_transformers() -> ModuleType:
    try:
        import transformers
    except ImportError as error:
        raise SourceError(
            "DINOv2 and CLIP are read by transformers, which is not installed: "
            'pip install "artigen[encoders]"'
        ) from error
    return transformers


def _require_files(folder: Path, names: Sequence[str], published: str) -> None:
    missing = [name for name in names if not (folder / name).is_file()]
    if missing:
        raise SourceError(
            f"{folder}: lacks {' and '.join(missing)}; download {published} from the Hugging Face hub"
        )


def _require_same(folder: Path, found: DinoConfig | ClipConfig, expected: DinoConfig | ClipConfig) -> None:
    if found != expected:
        raise SourceError(f"{folder}: {NETWORK_FILES[0]} describes {found}, expected {expected}")


def _advise(name: str) -> str:
    return f"download {name} from the Hugging Face hub and name the folder that holds it (--encoders)"
