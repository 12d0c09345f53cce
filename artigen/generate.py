"""Condition and seed to an `Asset`: sample outline and latent, decode, mend, segment; nothing else."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from artigen.datasets.sizes import estimate_size
from artigen.errors import SegmentationError, SourceError
from artigen.fields import VoxelFields
from artigen.mending.faults import AssetFaultsConfig, find_asset_faults
from artigen.mending.mend import MendConfig, mend_cells
from artigen.mending.roughness import measure_roughness
from artigen.models.conditions import ConditionBatch, StructureCondition, gather_conditions
from artigen.models.outline.batch import OutlineBatch
from artigen.models.outline.draw import OutlineConfig, draw_outline
from artigen.models.outline.flow import OutlineFlow, complete_conditions
from artigen.models.picture_reader import PictureReader, locate_parts, read_condition
from artigen.models.presets import PRESETS, StructurePreset
from artigen.models.steady import SteadyConfig
from artigen.models.store import load_model, read_description
from artigen.models.structure_flow import StructureFlow, sample_latents
from artigen.models.structure_vae import StructureVae, decode_cells
from artigen.sampling import SamplerConfig
from artigen.segment import SegmentConfig, segment
from artigen.types import Asset

ROUGH: Mapping[str, float] = {"StorageFurniture": 0.2, "Table": 0.25, "WashingMachine": 0.27}
"""Bends per face that true objects with thin legs or round fronts have, too: smoother draws are no better."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StructureModel:
    """Trained networks, ready to sample."""

    preset: StructurePreset
    vae: StructureVae
    flow: StructureFlow
    outline: OutlineFlow | None
    """Draws where the parts lie, where the preset has such a network."""
    reader: PictureReader | None
    """Reads pictures, where the preset has such a network."""


@dataclass(frozen=True, kw_only=True)
class GenerateConfig:
    """How a structure is drawn from its condition."""

    sampler: SamplerConfig = field(default_factory=lambda: SamplerConfig(steps=6, strength=0.0))
    """Steps and guidance of the latent; where an outline is drawn, the condition is in it."""
    outline: OutlineConfig = field(default_factory=OutlineConfig)
    """How the outline is drawn."""
    steady: SteadyConfig | None = field(default_factory=SteadyConfig)
    """How much cells listen to those in line with them, where outlines are drawn; None: not at all."""
    mend: MendConfig = field(default_factory=MendConfig)
    """How drawn cells are made whole."""
    segment: SegmentConfig = field(default_factory=SegmentConfig)
    """How parts are found."""
    faults: AssetFaultsConfig = field(default_factory=AssetFaultsConfig)
    """What cannot be, so that all is drawn again."""
    smooth: float = 0.15
    """Bends per face of a surface that no smoother one is sought for (`artigen.mending.roughness`), at least;
    in categories whose true objects have more, as many as those (`ROUGH`)."""
    draws: int = 6
    """Draws at most; that with the fewest faults stays, and of those the smoothest."""

    def __post_init__(self) -> None:
        if self.draws < 1:
            raise ValueError(f"{self.draws} draws, expected at least one")


def build_structure_model(preset: StructurePreset) -> StructureModel:
    """The networks of a preset, untrained."""
    outline = None if preset.outline is None else OutlineFlow(preset.outline, preset.conditions)
    reader = None if preset.reader is None else PictureReader(preset.reader, preset.conditions)
    return StructureModel(
        preset=preset,
        vae=StructureVae(preset.vae).eval(),
        flow=StructureFlow(preset.flow, preset.conditions).eval(),
        outline=None if outline is None else outline.eval(),
        reader=None if reader is None else reader.eval(),
    )


def load_structure_model(folder: Path, device: torch.device | str = "cpu") -> StructureModel:
    """Loads a model folder that `artigen.train.everything` wrote.

    Raises:
        SourceError: If the folder holds no whole model, or one of a preset we do not know.
    """
    said = read_description(folder)
    name = said.get("flow", {}).get("preset")
    preset = next((known for key, known in PRESETS.items() if key == name), None)
    if preset is None:
        raise SourceError(f"{folder}: preset {name!r}, expected one of {', '.join(PRESETS)}")
    model = build_structure_model(preset)
    networks = {"vae": model.vae, "outline": model.outline, "reader": model.reader, "flow": model.flow}
    for key, network in networks.items():
        if network is not None:
            load_model(network, folder, key)
            network.to(device)
    return model


def generate_structure(
    model: StructureModel, asked: StructureCondition, seed: int, cfg: GenerateConfig | None = None
) -> Asset:
    """Draws one articulated object; the same arguments give the same object on one machine.

    What has a fault that shows in its voxels, or is rough, is drawn again, at most ``cfg.draws`` times, and
    noted: a draw takes seconds, a package half a minute to make and check.

    Args:
        model: trained networks.
        asked: the condition, completed (`artigen.ask.read_request`) where it should be.
        seed: of the noise.
        cfg: sampler, cleaning, segmentation.

    Raises:
        SegmentationError: If no draw describes an articulated object.
    """
    cfg = cfg or GenerateConfig()
    generator = torch.Generator().manual_seed(seed)
    read: tuple[str, ...] = ()
    if model.reader is not None:
        asked, read = read_condition(model.reader, asked)
    shown = None
    if model.reader is not None and asked.image is not None:
        shown = locate_parts(model.reader, asked.image)
    drawn: list[tuple[int, float, Asset]] = []
    notes: list[str] = []
    while len(notes) < cfg.draws and not any(
        faults == 0 and rough <= max(cfg.smooth, ROUGH.get(asset.category, 0.0))
        for faults, rough, asset in drawn
    ):
        try:
            asset, left = _draw(model, asked, shown, seed, generator, cfg)
        except SegmentationError as error:
            notes.append(f"draw {len(notes) + 1}: {error}")
            if len(notes) == cfg.draws and not drawn:
                raise
            continue
        faults = (*left, *find_asset_faults(asset, cfg.faults))
        assert asset.voxels is not None
        rough = measure_roughness(asset.voxels.occupied())
        drawn.append((len(faults), rough, asset))
        notes.append("; ".join((f"draw {len(notes) + 1}: {rough:.2f} bends per face", *faults)))
    _, _, asset = min(drawn, key=lambda one: one[:2])
    return replace(asset, notes=(*read, *notes, *asset.notes))


def _draw(
    model: StructureModel,
    asked: StructureCondition,
    shown: Float[np.ndarray, "L h w"] | None,
    seed: int,
    generator: torch.Generator,
    cfg: GenerateConfig,
) -> tuple[Asset, tuple[str, ...]]:
    """One draw of outline and cells, and the faults that are left in the outline.

    ``shown`` says where a picture shows the parts (`artigen.models.picture_reader.locate_parts`).
    """
    device = next(model.flow.parameters()).device
    edge = model.flow.edge
    noise = torch.randn((1, model.flow.channels, edge, edge, edge), generator=generator).to(device)
    known = gather_conditions([asked], model.preset.conditions).to(device)
    nothing = gather_conditions([StructureCondition()], model.preset.conditions).to(device)
    rows, said, left = None, (), ()
    if model.outline is not None:
        known = complete_conditions(model.outline, known, generator)
        extents = None if asked.size is None else np.array(asked.size)
        drawn = draw_outline(
            model.outline, known, nothing, generator, cfg.outline, extents=extents, density=shown
        )
        rows, said, left = drawn.rows, drawn.notes, tuple(fault.what for fault in drawn.faults)
    fields, mended = draw_cells(model, known, noise, rows, cfg)
    asset = segment(
        fields,
        cfg.segment,
        name=f"{asked.category or 'object'}_{seed}",
        scale=1.0 if asked.size is None else max(asked.size),
        category=asked.category,
    )
    notes = (*said, *mended, *asset.notes)
    if asked.size is None:
        longest, _ = estimate_size(asset.category, np.ptp(fields.coords, axis=0) + 1.0)
        asset = replace(asset, scale=longest)
        notes = (*notes, f"no size was asked for: {longest:.2f} m along the longest edge is usual")
    return replace(asset, notes=notes), left


def draw_cells(
    model: StructureModel,
    known: ConditionBatch,
    noise: Float[Tensor, "1 C X Y Z"],
    rows: Float[np.ndarray, "P C"] | None,
    cfg: GenerateConfig,
) -> tuple[VoxelFields, tuple[str, ...]]:
    """Draws the cells of one object and mends them; with notes of what was mended.

    Args:
        model: trained networks.
        known: the condition.
        noise: start of the latent, standard normal.
        rows: the outline, where the model draws within one.
        cfg: sampler and mending.
    """
    device, outlines = noise.device, None
    nothing = gather_conditions([StructureCondition()], model.preset.conditions).to(device)
    if rows is not None:
        given = torch.ones(1, len(rows), dtype=torch.bool, device=device)
        outlines = OutlineBatch(rows=torch.from_numpy(rows)[None].to(device), given=given)
    latent = sample_latents(model.flow, known, nothing, noise, cfg.sampler, outlines)
    decoded, logits = decode_cells(model.vae, latent, outlines, cfg.steady)
    return mend_cells(decoded[0], logits[0].cpu().numpy(), rows, cfg.mend)
