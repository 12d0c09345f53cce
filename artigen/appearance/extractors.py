"""Feature extractors by name, as recorded in the description of a model."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from artigen.appearance.features import BASE, FeatureExtractor, PyramidFeatures
from artigen.errors import SourceError
from artigen.models.public_encoders import load_dinov2

ExtractorName = Literal["pyramid", "dinov2"]


@dataclass(frozen=True, kw_only=True)
class ExtractorConfig:
    """Choice of a feature extractor."""

    name: ExtractorName = "pyramid"
    """`pyramid` needs no weights; `dinov2` needs a folder with the public ones."""
    channels: int = BASE
    """Channels of a pyramid."""
    folder: Path | None = None
    """Weights of DINOv2."""


def make_extractor(cfg: ExtractorConfig) -> FeatureExtractor:
    """The extractor of a configuration, on the CPU.

    Raises:
        SourceError: If weights are needed and there is no folder, or its weights do not fit.
    """
    if cfg.name == "pyramid":
        return PyramidFeatures(cfg.channels)
    if cfg.folder is None:
        raise SourceError("features of DINOv2 need the folder of its weights; give one, or use the pyramid")
    return load_dinov2(cfg.folder)
