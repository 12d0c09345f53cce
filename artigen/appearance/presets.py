"""Sizes of the appearance models by preset, with the names of the structure presets.

``small`` decodes 4 Gaussians per voxel instead of 32, ``compact`` 8. Their voxels have two sides, whose
features bypass the transformers through a linear layer. ``paper`` has the sizes of TRELLIS, from whose public
weights the paper starts (section 4.2).
"""

from dataclasses import dataclass, field, replace

from artigen.appearance.curation import CurationConfig
from artigen.appearance.gaussian_decoder import GaussianConfig, GaussianDecoderConfig
from artigen.appearance.slat_dit import SlatDitConfig
from artigen.appearance.slat_patch_dit import SlatPatchDitConfig
from artigen.appearance.slat_vae import SlatVaeConfig
from artigen.appearance.vae import SIDE_LATENTS
from artigen.appearance.views import ViewConfig
from artigen.latent.presets import PresetName
from artigen.models.conditions import ConditionConfig
from artigen.models.rectified_flow import SamplerConfig

SIDED = SlatVaeConfig(in_channels=66, latent_channels=SIDE_LATENTS, sided=True)
"""Voxels with two sides, as in all presets but ``paper``; the decoder does not use `in_channels`."""
COARSE = replace(SIDED, resolution=32, in_channels=29, model_channels=32, num_blocks=2, num_heads=2)
"""Sizes of ``tiny``."""


@dataclass(frozen=True, kw_only=True)
class AppearancePreset:
    """Networks of the appearance model."""

    encoder: SlatVaeConfig
    """Encoder of voxel features; `in_channels` must match the feature extractor."""
    decoder: GaussianDecoderConfig
    """Decoder of latents to Gaussians."""
    flow: SlatPatchDitConfig | SlatDitConfig
    """Flow on the latents."""
    conditions: ConditionConfig
    """Conditions of the flow."""
    curation: CurationConfig
    """Joint states, views and features that the encoder reads, in training and after."""
    sampler: SamplerConfig = field(default_factory=SamplerConfig)
    """Sampler of the latents. One step gives their mean given paint and places, which after little training
    is cleaner than a sample."""


APPEARANCE_PRESETS: dict[PresetName, AppearancePreset] = {
    "tiny": AppearancePreset(
        encoder=COARSE,
        decoder=GaussianDecoderConfig(
            trunk=COARSE, gaussians=GaussianConfig(count=4, scale_bias=1e-2, opacity_bias=0.9)
        ),
        flow=SlatPatchDitConfig(channels=SIDE_LATENTS, resolution=32, stem=16, width=64, blocks=2, heads=2),
        conditions=ConditionConfig(width=64, image_size=32, image_patch=8, image_width=32, image_blocks=1),
        curation=CurationConfig(states=3, views=ViewConfig(count=8, size=48), kept=4),
    ),
    "small": AppearancePreset(
        encoder=replace(SIDED, model_channels=64, num_blocks=1, num_heads=2, mlp_ratio=2.0),
        decoder=GaussianDecoderConfig(
            trunk=replace(SIDED, model_channels=96, num_blocks=3, num_heads=3, mlp_ratio=2.0),
            gaussians=GaussianConfig(count=4, scale_bias=5e-3, opacity_bias=0.9),
        ),
        flow=SlatPatchDitConfig(channels=SIDE_LATENTS, patch=8, stem=16, width=128, blocks=4, heads=2),
        conditions=ConditionConfig(width=192, image_width=96, image_blocks=2),
        curation=CurationConfig(states=4, views=ViewConfig(count=6, sharpness=2), kept=3),
        sampler=SamplerConfig(steps=1, strength=0.0),
    ),
    "compact": AppearancePreset(
        encoder=replace(SIDED, model_channels=128, num_blocks=2, num_heads=4),
        decoder=GaussianDecoderConfig(
            trunk=replace(SIDED, model_channels=128, num_blocks=5, num_heads=4),
            gaussians=GaussianConfig(count=8, scale_bias=3.5e-3, opacity_bias=0.9),
        ),
        flow=SlatPatchDitConfig(channels=SIDE_LATENTS, width=192, heads=3),
        conditions=ConditionConfig(width=192, image_width=128, image_blocks=2),
        curation=CurationConfig(views=ViewConfig(count=12, sharpness=2), kept=4),
        sampler=SamplerConfig(strength=0.0),
    ),
    "paper": AppearancePreset(
        encoder=SlatVaeConfig(),
        decoder=GaussianDecoderConfig(),
        flow=SlatDitConfig(),
        conditions=ConditionConfig(width=1024, image_size=0),
        curation=CurationConfig(
            staggered=False, views=ViewConfig(size=512, sharpness=2), kept=48, weighting="plain"
        ),
    ),
}
