"""Settings of the export, one nested config per stage."""

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


@dataclass(frozen=True, kw_only=True)
class ExportConfig:
    """Settings of all stages from an asset to a package."""

    meshing: MeshingConfig = field(default_factory=MeshingConfig)
    """Closed part meshes from voxels."""
    wheels: WheelConfig = field(default_factory=WheelConfig)
    """Cylinders for wheels."""
    texture: TextureConfig = field(default_factory=TextureConfig)
    """Textures from source colours."""
    decompose: DecomposeConfig = field(default_factory=DecomposeConfig)
    """Convex collision hulls from part meshes."""
    surface: SurfaceConfig = field(default_factory=SurfaceConfig)
    """Convex collision hulls from source surfaces."""
    requirements: RequirementConfig = field(default_factory=RequirementConfig)
    """Joints that require another joint to be open."""
    retention: RetentionConfig = field(default_factory=RetentionConfig)
    """Travel of drawers that must stay in their carrier."""
    clearance: ClearanceConfig = field(default_factory=ClearanceConfig)
    """Clearance of moving parts."""
    recovery: RecoveryConfig = field(default_factory=RecoveryConfig)
    """Surface without collision."""
    facets: FacetConfig = field(default_factory=FacetConfig)
    """Facets that engines would merge."""
    feet: FeetConfig = field(default_factory=FeetConfig)
    """Support on the floor."""
    attachment: AttachmentConfig = field(default_factory=AttachmentConfig)
    """Gaps between a link and its carrier."""
    levelling: LevellingConfig = field(default_factory=LevellingConfig)
    """Feet for objects that would tip over."""
    filling: FillingConfig = field(default_factory=FillingConfig)
    """Visual volume where hulls fill gaps thinner than a voxel."""
    trimming: TrimmingConfig = field(default_factory=TrimmingConfig)
    """Visual surface without collision."""


def for_surfaces(cfg: ExportConfig) -> ExportConfig:
    """Settings for hulls made from a source's own surface, which may be sheets."""
    relief = replace(cfg.clearance.relief, sheets=True)
    return replace(cfg, clearance=replace(cfg.clearance, relief=relief))
