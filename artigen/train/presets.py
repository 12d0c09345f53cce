"""Training settings of the presets of `artigen.latent.presets`."""

from dataclasses import dataclass, field

from artigen.latent.presets import PresetName
from artigen.train.loop import Rates
from artigen.train.structure_losses import PAPER_LOSS, StructureLossConfig


@dataclass(frozen=True, kw_only=True)
class StageConfig(Rates):
    """Training of one network: its rates, batch, and share of the budget."""

    batch: int
    """Objects per step and process."""
    share: float
    """Share of the whole budget."""


@dataclass(frozen=True, kw_only=True)
class TrainingPreset:
    """Training of the networks of a structure model."""

    vae: StageConfig
    """Training of the VAE."""
    flow: StageConfig
    """Training of the flow."""
    decoder: StageConfig | None = None
    """Training of the decoder on the flow's estimates; the paper has none."""
    losses: StructureLossConfig = field(default_factory=StructureLossConfig)
    """Weights of the VAE's loss terms."""
    time_mean: float = 2.0
    """Mean of the logits of the flow's training times. A sample is decided near pure noise, the more so the
    more redundant its cells are, so the mean lies above the 1 of TRELLIS."""


TRAINING: dict[PresetName, TrainingPreset] = {
    "tiny": TrainingPreset(
        vae=StageConfig(batch=4, learning_rate=2e-3, warmup=5, decay=1.0, ema=0.9, share=0.35),
        flow=StageConfig(batch=8, learning_rate=1e-3, warmup=5, decay=0.5, ema=0.9, share=0.55),
        decoder=StageConfig(batch=4, learning_rate=1e-3, warmup=5, decay=1.0, ema=0.9, share=0.1),
    ),
    "small": TrainingPreset(
        vae=StageConfig(batch=4, learning_rate=1.5e-3, warmup=100, decay=1.0, ema=0.995, share=0.2),
        flow=StageConfig(batch=4, learning_rate=6e-4, warmup=100, decay=0.3, ema=0.998, share=0.65),
        decoder=StageConfig(batch=4, learning_rate=7e-4, warmup=30, decay=1.0, ema=0.995, share=0.15),
        losses=StructureLossConfig(kl=5e-3),
    ),
    "compact": TrainingPreset(
        vae=StageConfig(batch=64, learning_rate=1e-3, warmup=200, decay=1.0, ema=0.999, share=0.3),
        flow=StageConfig(batch=256, learning_rate=4e-4, warmup=300, decay=0.3, ema=0.999, share=0.6),
        decoder=StageConfig(batch=64, learning_rate=5e-4, warmup=50, decay=1.0, ema=0.998, share=0.1),
    ),
    "paper": TrainingPreset(
        vae=StageConfig(batch=4, learning_rate=1e-4, warmup=0, decay=0.0, ema=0.9999, share=0.5),
        flow=StageConfig(batch=4, learning_rate=1e-4, warmup=0, decay=0.0, ema=0.9999, share=0.5),
        losses=PAPER_LOSS,
        time_mean=1.0,
    ),
}
