"""An articulated structure to one with Gaussians: sample latents on its voxels, decode, settle seams."""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float

from artigen.errors import SourceError
from artigen.fields import DEFAULT_LAYOUT, part_attributes
from artigen.models.appearance_presets import APPEARANCE_PRESETS, AppearancePreset
from artigen.models.appearance_vae import APPEARANCE_FLOW, APPEARANCE_VAE
from artigen.models.conditions import StructureCondition, gather_conditions
from artigen.models.gaussian_decoder import GaussianDecoder, to_gaussians
from artigen.models.slat_flow import SlatFlow, sample_slats
from artigen.models.store import DESCRIPTION, load_model, read_description
from artigen.models.trellis import load_strictly, read_tensors
from artigen.sampling import SamplerConfig
from artigen.splats.seams import SeamConfig, settle_seams
from artigen.types import Asset

DECODER = "decoder."
"""What the decoder's tensors are called by in a stored VAE; the encoder is not needed to generate."""


@dataclass(frozen=True, kw_only=True, eq=False)
class AppearanceModel:
    """Trained networks, ready to sample."""

    preset: AppearancePreset
    decoder: GaussianDecoder
    flow: SlatFlow


@dataclass(frozen=True, kw_only=True)
class AppearanceConfig:
    """How an appearance is drawn for a structure."""

    sampler: SamplerConfig = field(default_factory=SamplerConfig)
    """Steps and guidance."""
    seams: SeamConfig = field(default_factory=SeamConfig)
    """What counts as a Gaussian that strays over a neighbouring part."""


def has_appearance(folder: Path) -> bool:
    """Whether a model folder holds what appearance needs, besides or without a structure model.

    Raises:
        SourceError: If the folder describes no model.
    """
    return {APPEARANCE_VAE, APPEARANCE_FLOW} <= set(read_description(folder))


def load_appearance_model(folder: Path, device: torch.device | str = "cpu") -> AppearanceModel:
    """Loads the decoder and the flow of a model folder that `artigen train appearance` wrote.

    Raises:
        SourceError: If the folder holds no whole model, or one of a preset we do not know.
    """
    said = read_description(folder)
    if not has_appearance(folder):
        raise SourceError(
            f"{folder / DESCRIPTION}: describes {', '.join(sorted(said)) or 'nothing'}, expected "
            f"{APPEARANCE_VAE} and {APPEARANCE_FLOW}; train them with artigen train appearance"
        )
    names = [said[network].get("preset") for network in (APPEARANCE_VAE, APPEARANCE_FLOW)]
    preset = next((known for key, known in APPEARANCE_PRESETS.items() if [key, key] == names), None)
    if preset is None:
        raise SourceError(
            f"{folder}: presets {names[0]!r} (VAE) and {names[1]!r} (flow), expected one of "
            f"{', '.join(APPEARANCE_PRESETS)} for both"
        )
    decoder, flow = GaussianDecoder(preset.decoder), SlatFlow(preset.flow, preset.conditions)
    tensors = {
        key.removeprefix(DECODER): value.float() if value.is_floating_point() else value
        for path in sorted(folder.glob(f"{APPEARANCE_VAE}-*.safetensors"))
        for key, value in read_tensors(path).items()
        if key.startswith(DECODER)
    }
    load_strictly(decoder, tensors, f"{folder / APPEARANCE_VAE} ({DECODER}*)")
    load_model(flow, folder, APPEARANCE_FLOW)
    return AppearanceModel(preset=preset, decoder=decoder.to(device).eval(), flow=flow.to(device))


@torch.no_grad()
def generate_appearance(
    model: AppearanceModel,
    asset: Asset,
    asked: StructureCondition,
    seed: int,
    cfg: AppearanceConfig | None = None,
) -> Asset:
    """Draws Gaussians for the voxels of an asset; the same arguments give the same ones on one machine.

    Every Gaussian belongs to the part of its voxel, but for those that stray (`artigen.splats.seams`).

    Args:
        model: trained networks.
        asset: with voxels in the model's resolution.
        asked: the condition that the structure was drawn from.
        seed: of the noise.
        cfg: sampler and seams.

    Raises:
        ValueError: If the asset has no voxels, or has them in another resolution.
    """
    cfg = cfg or AppearanceConfig()
    edge = model.preset.decoder.trunk.resolution
    if asset.voxels is None or not len(asset.voxels.coords) or asset.voxels.resolution != edge:
        found = (
            "none" if asset.voxels is None else f"{len(asset.voxels.coords)} of {asset.voxels.resolution}^3"
        )
        raise ValueError(f"asset {asset.name!r}: voxels are {found}, this model draws on those of {edge}^3")
    device = next(model.flow.parameters()).device
    generator = torch.Generator().manual_seed(seed)
    count = len(asset.voxels.coords)
    coords = torch.zeros((count, 4), dtype=torch.int32)
    coords[:, 1:] = torch.from_numpy(asset.voxels.coords.astype(np.int32))
    attributes = torch.from_numpy(label_voxels(asset)).to(device) if model.flow.attribute_channels else None
    latents = sample_slats(
        model.flow,
        coords.to(device),
        gather_conditions([asked], model.preset.conditions).to(device),
        gather_conditions([StructureCondition()], model.preset.conditions).to(device),
        torch.randn((count, model.flow.channels), generator=generator).to(device),
        cfg.sampler,
        attributes=attributes,
    )
    decoded = model.decoder(coords.to(device), latents)
    painted = replace(asset, gaussians=to_gaussians(decoded, asset.voxels.part_ids))
    return settle_seams(painted, cfg.seams)


def label_voxels(asset: Asset) -> Float[np.ndarray, "N L"]:
    """One-hot part label of every voxel, as the flow is told in training (float32)."""
    assert asset.voxels is not None
    table = np.stack([part_attributes(part, asset.category)[DEFAULT_LAYOUT.label] for part in asset.parts])
    return table[asset.voxels.part_ids].astype(np.float32)
