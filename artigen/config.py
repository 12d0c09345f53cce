"""The sizes that the generative models come in.

``tiny`` is for tests, ``compact`` is trained and shipped, ``paper`` has the sizes of TRELLIS, from whose
public weights the paper starts (sections 4.1 and 4.3).
"""

from dataclasses import dataclass, field
from typing import Literal

from artigen.models.conditions import ConditionConfig
from artigen.models.conv_vae import ConvVaeConfig
from artigen.models.latent_dit import LatentDitConfig
from artigen.models.patch_vae import PatchVaeConfig
from artigen.models.structure_dit import StructureDitConfig
from artigen.train.structure_losses import PAPER_LOSS, StructureLossConfig

PresetName = Literal["tiny", "compact", "paper"]


@dataclass(frozen=True, kw_only=True)
class StageConfig:
    """How one network is trained: batch, rates, and the share of a budget that it gets."""

    batch: int
    """Objects per step and process."""
    learning_rate: float
    """Peak learning rate."""
    warmup: int
    """Steps over which it rises."""
    decay: float
    """Share of the run, at its end, over which it falls."""
    ema: float
    """Decay of the averaged weights."""
    share: float
    """Share of the whole budget."""


@dataclass(frozen=True, kw_only=True)
class StructurePreset:
    """Networks of the structure model and how they are trained."""

    vae: PatchVaeConfig | ConvVaeConfig
    """Encoder and decoder of fields."""
    flow: LatentDitConfig | StructureDitConfig
    """Flow on their latents."""
    conditions: ConditionConfig
    """What can be asked for."""
    vae_stage: StageConfig
    """Training of the VAE."""
    flow_stage: StageConfig
    """Training of the flow."""
    losses: StructureLossConfig = field(default_factory=StructureLossConfig)
    """Weights of the VAE's loss terms."""
    resolution: int = 64
    """Edge of the fields."""


PRESETS: dict[PresetName, StructurePreset] = {
    "tiny": StructurePreset(
        vae=PatchVaeConfig(
            resolution=32, width=32, encoder_blocks=1, decoder_blocks=2, global_width=64, global_blocks=1
        ),
        flow=LatentDitConfig(edge=8, width=64, blocks=2, heads=2),
        conditions=ConditionConfig(width=64, image_size=32, image_patch=8, image_blocks=1),
        vae_stage=StageConfig(batch=4, learning_rate=2e-3, warmup=5, decay=1.0, ema=0.9, share=0.5),
        flow_stage=StageConfig(batch=8, learning_rate=1e-3, warmup=5, decay=0.5, ema=0.9, share=0.5),
        resolution=32,
    ),
    "compact": StructurePreset(
        vae=PatchVaeConfig(),
        flow=LatentDitConfig(),
        conditions=ConditionConfig(),
        vae_stage=StageConfig(batch=64, learning_rate=1e-3, warmup=200, decay=1.0, ema=0.999, share=0.4),
        flow_stage=StageConfig(batch=256, learning_rate=4e-4, warmup=300, decay=0.3, ema=0.999, share=0.6),
    ),
    "paper": StructurePreset(
        vae=ConvVaeConfig(),
        flow=StructureDitConfig(),
        conditions=ConditionConfig(width=1024, image_size=0),
        vae_stage=StageConfig(batch=4, learning_rate=1e-4, warmup=0, decay=0.0, ema=0.9999, share=0.5),
        flow_stage=StageConfig(batch=4, learning_rate=1e-4, warmup=0, decay=0.0, ema=0.9999, share=0.5),
        losses=PAPER_LOSS,
    ),
}
