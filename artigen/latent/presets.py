"""Sizes of the structure models by preset.

``tiny`` is for tests, ``small`` for training on two CPU cores, ``compact`` for half an hour on a GPU, and
``paper`` has the sizes of TRELLIS, from whose public weights the paper starts (sections 4.1 and 4.3).
"""

from dataclasses import dataclass
from typing import Literal

from artigen.latent.conv_vae import ConvVaeConfig
from artigen.latent.latent_dit import LatentDitConfig
from artigen.latent.outline import HINT_CHANNELS
from artigen.latent.patch_vae import PatchVaeConfig
from artigen.latent.structure_dit import StructureDitConfig
from artigen.models.conditions import ConditionConfig
from artigen.models.public_encoders import ClipConfig, DinoConfig

PresetName = Literal["tiny", "small", "compact", "paper"]


@dataclass(frozen=True, kw_only=True)
class StructurePreset:
    """Networks of the structure model."""

    vae: PatchVaeConfig | ConvVaeConfig
    """Encoder and decoder of fields."""
    flow: LatentDitConfig | StructureDitConfig
    """Flow on their latents."""
    conditions: ConditionConfig
    """Conditions of the flow."""
    resolution: int = 64
    """Edge of the fields."""

    @property
    def takes_outlines(self) -> bool:
        """Whether latents are sampled and decoded under an outline of the parts; the paper uses none."""
        return isinstance(self.flow, LatentDitConfig) and self.flow.hint > 0


PRESETS: dict[PresetName, StructurePreset] = {
    "tiny": StructurePreset(
        vae=PatchVaeConfig(
            resolution=32, width=32, encoder_blocks=1, decoder_blocks=2, global_width=64, global_blocks=1
        ),
        flow=LatentDitConfig(
            edge=8, width=64, blocks=2, heads=2, cell_width=32, cell_blocks=2, hint=HINT_CHANNELS
        ),
        conditions=ConditionConfig(width=64, image_size=32, image_patch=8, image_width=32, image_blocks=1),
        resolution=32,
    ),
    "small": StructurePreset(
        vae=PatchVaeConfig(width=64, encoder_blocks=1, decoder_blocks=3, global_width=128, global_blocks=2),
        flow=LatentDitConfig(hint=HINT_CHANNELS),
        conditions=ConditionConfig(),
    ),
    "compact": StructurePreset(
        vae=PatchVaeConfig(),
        flow=LatentDitConfig(cell_width=64, cell_blocks=4, hint=HINT_CHANNELS),
        conditions=ConditionConfig(),
    ),
    "paper": StructurePreset(
        vae=ConvVaeConfig(),
        flow=StructureDitConfig(),
        conditions=ConditionConfig(width=1024, image_size=518, dino=DinoConfig(), clip=ClipConfig()),
    ),
}
