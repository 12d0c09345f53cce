"""The export's settings, one nested config per stage."""

from dataclasses import dataclass, field, replace

from sim_export.appearance.texture import TextureConfig
from sim_export.collision.attachment import AttachmentConfig
from sim_export.collision.clearance import ClearanceConfig
from sim_export.collision.decompose import DecomposeConfig
from sim_export.collision.facets import FacetConfig
from sim_export.collision.feet import FeetConfig
from sim_export.collision.filling import FillingConfig
from sim_export.collision.levelling import LevellingConfig
from sim_export.collision.recovery import RecoveryConfig
from sim_export.collision.requirements import RequirementConfig
from sim_export.collision.retention import RetentionConfig
from sim_export.collision.surface_hulls import SurfaceConfig
from sim_export.collision.trimming import TrimmingConfig
from sim_export.geometry.meshing import MeshingConfig
from sim_export.geometry.wheels import WheelConfig
from sim_export.physics.annotations import HandleConfig

MOST_OF_LINK = 96
"""Hulls of a link that is made from a source's surface, at most."""


@dataclass(frozen=True, kw_only=True)
class ExportConfig:
    """How an asset becomes a package."""

    meshing: MeshingConfig = field(default_factory=MeshingConfig)
    """Voxels to closed part meshes."""
    wheels: WheelConfig = field(default_factory=WheelConfig)
    """Wheels to cylinders."""
    texture: TextureConfig = field(default_factory=TextureConfig)
    """Source colours to textures."""
    decompose: DecomposeConfig = field(default_factory=DecomposeConfig)
    """Part meshes to convex collision hulls."""
    surface: SurfaceConfig = field(default_factory=SurfaceConfig)
    """Surfaces of a source to convex collision hulls."""
    requirements: RequirementConfig = field(default_factory=RequirementConfig)
    """Which joint needs which other open."""
    retention: RetentionConfig = field(default_factory=RetentionConfig)
    """Drawers that must not fall out."""
    clearance: ClearanceConfig = field(default_factory=ClearanceConfig)
    """Room for moving parts."""
    recovery: RecoveryConfig = field(default_factory=RecoveryConfig)
    """Surface that no hull stands for."""
    facets: FacetConfig = field(default_factory=FacetConfig)
    """Facets that engines would merge."""
    feet: FeetConfig = field(default_factory=FeetConfig)
    """What the object stands on."""
    attachment: AttachmentConfig = field(default_factory=AttachmentConfig)
    """Gaps between a link and the one that carries it."""
    levelling: LevellingConfig = field(default_factory=LevellingConfig)
    """Feet for what would topple."""
    filling: FillingConfig = field(default_factory=FillingConfig)
    """What meshes take in where hulls fill gaps thinner than voxels."""
    trimming: TrimmingConfig = field(default_factory=TrimmingConfig)
    """Surface for which no hull stands."""
    handles: HandleConfig = field(default_factory=HandleConfig)
    """How handles are measured."""


def for_surfaces(cfg: ExportConfig) -> ExportConfig:
    """The same settings for hulls made from a source's own surface: sheets, and more hulls of a link."""
    addition = replace(cfg.attachment.addition, max_hulls=MOST_OF_LINK)
    return replace(
        cfg,
        clearance=replace(
            cfg.clearance, max_hulls=MOST_OF_LINK, relief=replace(cfg.clearance.relief, sheets=True)
        ),
        feet=replace(cfg.feet, addition=addition),
        attachment=replace(cfg.attachment, addition=addition),
    )
