"""Settings of evaluations that the command line offers; importing them loads no network."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, kw_only=True)
class EvaluateSettings:
    """Number of objects and sampler settings."""

    held_out: int = 70
    """Number of held-out procedural objects, spread over the categories."""
    training: int = 350
    """Number of training objects that the retrieval baselines search."""
    partnet: Path | None = None
    """Folder with partnet_mobility/ and splits.json, whose validation split is measured too."""
    steps: int = 6
    """Sampler steps of structure; appearance uses those of the preset."""
    strength: float = 0.0
    """Guidance strength, 0 for none."""
    seed: int = 0
    """Seed of the noise."""
    packages: int = 14
    """Number of structure draws, by counts and size, to export and check (L0 to L3); 0 skips this."""
    redraws: int = 3
    """Maximum number of new draws for such an object that fails a check."""


@dataclass(frozen=True, kw_only=True)
class AppearanceViews:
    """Settings of appearance only."""

    states: int = 5
    """Number of joint states, from closed to fully open."""
    views: int = 8
    """Number of pictures per state."""
    dinov2: Path | None = None
    """Folder with the weights of DINOv2, for models and set distances that use it."""
