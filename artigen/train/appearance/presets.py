"""Training settings and data of the presets of `artigen.appearance.presets`."""

from dataclasses import dataclass, field, replace

from artigen.latent.presets import PresetName
from artigen.train.appearance.vae import AppearanceLossConfig
from artigen.train.presets import StageConfig

TWO_SIDED = AppearanceLossConfig(volume=0.0)
"""Losses for voxels with two sides, which know the width of surface: a volume term would only shrink unseen
Gaussians."""


@dataclass(frozen=True, kw_only=True)
class AppearanceTraining:
    """Training of the networks of an appearance model."""

    vae: StageConfig
    """Training of the VAE."""
    flow: StageConfig
    """Training of the flow."""
    pictures: int
    """Pictures of an object per step of the VAE."""
    noisiness: float = 1.0
    """Mean of the logits of the flow's training times. Higher values are nearer to pure noise, which is all
    that a preset with one sampling step sees."""
    losses: AppearanceLossConfig = field(default_factory=AppearanceLossConfig)
    """Weights of the VAE's loss terms."""


APPEARANCE_TRAINING: dict[PresetName, AppearanceTraining] = {
    "tiny": AppearanceTraining(
        vae=StageConfig(batch=2, learning_rate=2e-3, warmup=5, decay=1.0, ema=0.9, share=0.75),
        flow=StageConfig(batch=4, learning_rate=1e-3, warmup=5, decay=0.5, ema=0.9, share=0.25),
        pictures=2,
        losses=TWO_SIDED,
    ),
    "small": AppearanceTraining(
        vae=StageConfig(batch=1, learning_rate=2e-3, warmup=50, decay=1.0, ema=0.99, share=0.6),
        flow=StageConfig(batch=1, learning_rate=8e-4, warmup=100, decay=0.5, ema=0.995, share=0.4),
        pictures=2,
        noisiness=4.0,
        losses=replace(TWO_SIDED, exposed=3.0),
    ),
    "compact": AppearanceTraining(
        vae=StageConfig(batch=4, learning_rate=1e-3, warmup=200, decay=1.0, ema=0.999, share=0.7),
        flow=StageConfig(batch=16, learning_rate=4e-4, warmup=300, decay=0.3, ema=0.999, share=0.3),
        pictures=3,
        losses=replace(TWO_SIDED, exposed=3.0),
    ),
    "paper": AppearanceTraining(
        vae=StageConfig(batch=4, learning_rate=1e-4, warmup=0, decay=0.0, ema=0.9999, share=0.5),
        flow=StageConfig(batch=4, learning_rate=1e-4, warmup=0, decay=0.0, ema=0.9999, share=0.5),
        pictures=1,
    ),
}
