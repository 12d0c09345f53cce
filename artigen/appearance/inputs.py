"""`FeatureInputs`: how the input features of an encoder are computed from an object."""

from dataclasses import dataclass, replace
from pathlib import Path

from artigen.appearance.curation import CurationConfig
from artigen.appearance.extractors import ExtractorConfig, ExtractorName
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.appearance.slat_vae import SlatVaeConfig
from artigen.appearance.vae import SIDE_CHANNELS
from artigen.appearance.visibility import Weighting
from artigen.latent.presets import PresetName
from artigen.models.public_encoders import DinoConfig


@dataclass(frozen=True, kw_only=True)
class FeatureInputs:
    """A preset, and the choices that a run may make besides."""

    preset: PresetName = "compact"
    """Sizes of the networks."""
    articulated: bool = True
    """Whether objects are seen in all joint states; if not, in as many pictures of the closed state (the
    ablation of the paper's Table 2)."""
    weighting: Weighting = "seen"
    """Which views count for a voxel: those that show it, or all."""
    features: ExtractorName = "pyramid"
    """Image features."""
    dinov2: Path | None = None
    """Folder with the weights of DINOv2, if that is the extractor."""

    @property
    def curation(self) -> CurationConfig:
        """States and views; without articulation, as many views of the closed state."""
        preset = APPEARANCE_PRESETS[self.preset]
        found = replace(preset.curation, weighting=self.weighting, sided=preset.encoder.sided)
        return found if self.articulated else close_curation(found)

    @property
    def extractor(self) -> ExtractorConfig:
        """The extractor; a pyramid has the channels that the preset's encoder reads."""
        encoder = APPEARANCE_PRESETS[self.preset].encoder
        channels = encoder.in_channels - (SIDE_CHANNELS if encoder.sided else 0)
        return ExtractorConfig(name=self.features, channels=channels, folder=self.dinov2)

    @property
    def encoder(self) -> SlatVaeConfig:
        """The preset's encoder, with the input channels that its features need."""
        encoder = APPEARANCE_PRESETS[self.preset].encoder
        if self.features == "pyramid":
            return encoder
        return replace(encoder, in_channels=DinoConfig().width + (SIDE_CHANNELS if encoder.sided else 0))


def close_curation(curation: CurationConfig) -> CurationConfig:
    """As many views, and as many of them kept, of the closed state alone; hidden sides get no paint."""
    views = replace(curation.views, count=curation.states * curation.views.count)
    return replace(curation, states=1, views=views, kept=curation.states * curation.kept, painted=False)
