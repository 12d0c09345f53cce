"""Samples one latent for an exact outline, decodes it and cleans it up: outline and seed to `Asset`."""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from artigen.conditioning.delivery import asset_size, part_counts
from artigen.errors import SegmentationError, SourceError
from artigen.latent.outline import gather_outlines
from artigen.latent.presets import PRESETS, StructurePreset
from artigen.latent.structure_flow import StructureFlow, sample_latents
from artigen.latent.structure_vae import StructureVae, decode_cells
from artigen.models.conditions import ConditionBatch, StructureCondition, gather_conditions
from artigen.models.description import read_description
from artigen.models.rectified_flow import SamplerConfig
from artigen.models.store import load_model
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.shape import Shape
from artigen.types import PART_LABELS, Asset
from artigen.voxels.cleanup.clean import mend_cells
from artigen.voxels.cleanup.rows import Owners, read_owners
from artigen.voxels.fields import VoxelFields, tabulate_parts
from artigen.voxels.frames import gather_voxels
from artigen.voxels.segmentation.segment import SegmentConfig, segment


@dataclass(frozen=True, kw_only=True, eq=False)
class StructureModel:
    """Trained networks, ready to sample."""

    preset: StructurePreset
    vae: StructureVae
    flow: StructureFlow


@dataclass(frozen=True, kw_only=True)
class GenerateConfig:
    """How a structure is sampled."""

    sampler: SamplerConfig = field(default_factory=lambda: SamplerConfig(steps=6, strength=0.0))
    """Steps and guidance of the latent; no guidance by default, because an outline holds more than the
    condition."""
    segment: SegmentConfig | None = None
    """How the votes of decoded cells are clustered into parts and joints, as in the paper (section 3.3).

    None: every cell belongs to the part of the outline that it chooses, and cells are cleaned up. Models that
    take no outline always cluster."""


def build_structure_model(preset: StructurePreset) -> StructureModel:
    """The networks of a preset, untrained."""
    return StructureModel(
        preset=preset,
        vae=StructureVae(preset.vae).eval(),
        flow=StructureFlow(preset.flow, preset.conditions).eval(),
    )


def load_structure_model(folder: Path, device: torch.device | str = "cpu") -> StructureModel:
    """Loads a model folder that `artigen.train.everything` wrote.

    Raises:
        SourceError: If the folder holds no complete model, or one of an unknown preset.
    """
    description = read_description(folder)
    name = description.get("flow", {}).get("preset")
    preset = next((known for key, known in PRESETS.items() if key == name), None)
    if preset is None:
        raise SourceError(f"{folder}: preset {name!r}, expected one of {', '.join(PRESETS)}")
    model = build_structure_model(preset)
    for key, network in (("vae", model.vae), ("flow", model.flow)):
        load_model(network, folder, key)
        network.to(device)
    return model


def generate_structure(
    model: StructureModel,
    asked: StructureCondition,
    seed: int,
    cfg: GenerateConfig | None = None,
    *,
    boxes: Asset | Shape,
) -> Asset:
    """Samples one articulated object within the boxes of an exact one, in a single attempt.

    The same arguments give the same object on one machine. Category, counts, size and scale are those of
    ``boxes``; so are parts, joints and tree, unless they are found by voting.

    Args:
        asked: Condition; its picture and sentence are used where the model reads them.
        boxes: Object whose parts, boxes and joints the model takes; its surface is not used.

    Raises:
        SegmentationError: If a part is left without a cell, or voting finds no articulated object.
        ValueError: If the model does not know the category.
    """
    cfg = cfg or GenerateConfig()
    outlined = shape_to_asset(boxes, model.preset.resolution) if isinstance(boxes, Shape) else boxes
    outlined = replace(outlined, name=f"{outlined.category}_{seed}", surface=None, gaussians=None)
    counts = part_counts(outlined).tolist()
    depth, width, height = asset_size(outlined).tolist()
    asked = replace(
        asked,
        category=outlined.category,
        counts=tuple(zip(PART_LABELS, counts, strict=True)),
        size=(depth, width, height),
    )
    device, edge = next(model.flow.parameters()).device, model.flow.edge
    generator = torch.Generator().manual_seed(seed)
    noise = torch.randn((1, model.flow.channels, edge, edge, edge), generator=generator).to(device)
    known = gather_conditions([asked], model.preset.conditions).to(device)
    rows = tabulate_parts(outlined) if model.flow.takes_outlines else None
    if rows is None or cfg.segment is not None:
        fields, _ = _decode(model, known, noise, rows, cfg)
        found = segment(
            fields, cfg.segment, name=outlined.name, scale=outlined.scale, category=outlined.category
        )
        return replace(found, notes=(*outlined.notes, *found.notes))
    owners, notes = draw_cells(model, known, noise, rows, cfg)
    return _place_parts(outlined, owners, notes)


def draw_cells(
    model: StructureModel,
    known: ConditionBatch,
    noise: Float[Tensor, "1 C X Y Z"],
    rows: Float[np.ndarray, "P C"],
    cfg: GenerateConfig,
) -> tuple[Owners, tuple[str, ...]]:
    """Samples the cells of one object within its outline and cleans them up, with notes of what changed."""
    fields, logits = _decode(model, known, noise, rows, cfg)
    return mend_cells(read_owners(fields, rows), logits, rows)


def _decode(
    model: StructureModel,
    known: ConditionBatch,
    noise: Float[Tensor, "1 C X Y Z"],
    rows: Float[np.ndarray, "P C"] | None,
    cfg: GenerateConfig,
) -> tuple[VoxelFields, Float[np.ndarray, "X Y Z"]]:
    """Samples and decodes one latent: the fields of its occupied cells, and the logits of all cells."""
    device, outlines = noise.device, None
    nothing = gather_conditions([StructureCondition()], model.preset.conditions).to(device)
    if rows is not None:
        outlines = gather_outlines([rows]).to(device)
    latent = sample_latents(model.flow, known, nothing, noise, cfg.sampler, outlines)
    decoded, logits = decode_cells(model.vae, latent, outlines, steady=rows is not None)
    return decoded[0], logits[0].cpu().numpy()


def _place_parts(outlined: Asset, owners: Owners, notes: tuple[str, ...]) -> Asset:
    """The object with its voxels replaced.

    Raises:
        SegmentationError: If a part owns no cell.
    """
    lost = [part.name for number, part in enumerate(outlined.parts) if not (owners == number).any()]
    if lost:
        raise SegmentationError(f"no voxel was drawn for {', '.join(lost)} of {len(outlined.parts)} parts")
    return replace(outlined, voxels=gather_voxels(owners), notes=(*outlined.notes, *notes))
