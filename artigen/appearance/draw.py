"""Samples Gaussians for an articulated structure: latents on its voxels, then decoding."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Int
from torch import Tensor

from artigen.appearance.attributes import describe_voxels, read_kinds
from artigen.appearance.gaussian_decoder import GaussianDecoder, to_gaussians
from artigen.appearance.paint import PaintedSurface, gather_paint
from artigen.appearance.presets import APPEARANCE_PRESETS, AppearancePreset
from artigen.appearance.slat_flow import SlatFlow, sample_slats
from artigen.appearance.vae import APPEARANCE_FLOW, APPEARANCE_VAE
from artigen.errors import SourceError
from artigen.models.conditions import StructureCondition, gather_conditions
from artigen.models.description import DESCRIPTION, read_description
from artigen.models.rectified_flow import SamplerConfig
from artigen.models.store import load_model
from artigen.models.tensors import load_strictly, read_tensors
from artigen.splats.render.splats import Splats
from artigen.types import Asset
from artigen.voxels.fields import tabulate_parts
from artigen.voxels.frames import SIDES, find_facings
from artigen.voxels.layout import Canvas, lay_out
from artigen.voxels.regions import connected_groups, find_edges
from artigen.voxels.surface import describe_places, measure_places
from artigen.voxels.voxelize import voxelize_again

DECODER = "decoder."
"""Prefix of the decoder's tensors in a stored VAE; generation does not need the encoder."""
ALIKE = 1.5 / 255
"""Largest difference of paint between neighbours that are painted alike; paint comes in steps of 1/255."""


@dataclass(frozen=True, kw_only=True, eq=False)
class AppearanceModel:
    """Trained networks, ready to sample."""

    preset: AppearancePreset
    decoder: GaussianDecoder
    flow: SlatFlow


def has_appearance(folder: Path) -> bool:
    """Whether a model folder holds the networks of an appearance model; it may hold others as well.

    Raises:
        SourceError: If the folder describes no model.
    """
    return {APPEARANCE_VAE, APPEARANCE_FLOW} <= set(read_description(folder))


def load_appearance_model(folder: Path, device: torch.device | str = "cpu") -> AppearanceModel:
    """Loads the decoder and the flow of a model folder that `artigen train appearance` wrote.

    Raises:
        SourceError: If the folder holds no complete model, or one of an unknown preset.
    """
    description = read_description(folder)
    if not has_appearance(folder):
        raise SourceError(
            f"{folder / DESCRIPTION}: describes {', '.join(sorted(description)) or 'nothing'}, expected "
            f"{APPEARANCE_VAE} and {APPEARANCE_FLOW}; train them with artigen train appearance"
        )
    names = [description[network].get("preset") for network in (APPEARANCE_VAE, APPEARANCE_FLOW)]
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
def draw_splats(
    model: AppearanceModel,
    canvas: Canvas,
    asked: StructureCondition,
    seed: int,
    *,
    paint: Float[np.ndarray, "N 7"] | None = None,
    sampler: SamplerConfig | None = None,
) -> Splats:
    """Samples the Gaussians of given voxels, in the order of the voxels.

    Args:
        paint: Colours of both sides of each voxel, and its transmission (`artigen.appearance.paint`); all
            models but ``paper`` take it.
        sampler: Steps and guidance; those of the model's preset when None.

    Raises:
        ValueError: If the model takes paint and surface positions, and one is missing.
    """
    device = next(model.flow.parameters()).device
    generator = torch.Generator().manual_seed(seed)
    known, nothing = (
        gather_conditions([condition], model.preset.conditions).to(device)
        for condition in (asked, StructureCondition())
    )
    attributes = None
    edge = model.preset.decoder.trunk.resolution
    coords, part_ids, facings, table = canvas.coords, canvas.part_ids, canvas.facings, canvas.table
    if model.flow.attribute_channels:
        if canvas.places is None or paint is None:
            lacks = "places" if canvas.places is None else "paint"
            raise ValueError(
                f"{len(coords)} voxels without {lacks}; this model needs positions and paint of surface"
            )
        kinds = read_kinds(coords, part_ids, facings, table, edge)
        attributes = torch.from_numpy(describe_voxels(kinds, describe_places(canvas.places), paint)).to(
            device
        )
    places = torch.from_numpy(np.pad(coords.astype(np.int32), ((0, 0), (1, 0)))).to(device)
    noise = torch.randn((len(coords), model.flow.channels), generator=generator).to(device)
    sampler = sampler or model.preset.sampler
    latents = sample_slats(model.flow, places, known, nothing, noise, sampler, attributes=attributes)
    if attributes is not None and paint is not None:
        edges = find_edges(coords, part_ids, facings, edge)
        latents = even_sides(latents, model.flow.expect(attributes), paint, edges)
    faced = torch.from_numpy(facings).to(device) if model.preset.decoder.trunk.sided else None
    return model.decoder(places, latents, facings=faced)


def generate_appearance(
    model: AppearanceModel,
    asset: Asset,
    asked: StructureCondition,
    seed: int,
    *,
    surface: PaintedSurface | None = None,
    sampler: SamplerConfig | None = None,
) -> Asset:
    """Samples Gaussians for the surface of an asset; the same arguments give the same ones on one machine.

    With painted samples of the surface, Gaussians take its colours and lie on the voxels that it passes
    through, as in training; otherwise they lie on the asset's own voxels. Every Gaussian belongs to the part
    of its voxel.

    Args:
        asset: Asset with voxels at the model's resolution.
        surface: Painted samples of the surface that the voxels represent; for a generated structure those of
            its meshes (`sim_export.geometry.surface`, `artigen.appearance.paint.repaint`). ``paper`` needs
            none.
        sampler: Steps and guidance; those of the model's preset when None.

    Raises:
        ValueError: If the asset has no voxels, has them in another resolution, or samples are missing.
    """
    edge, voxels = model.preset.decoder.trunk.resolution, asset.voxels
    if voxels is None or not len(voxels.coords) or voxels.resolution != edge:
        found = "none" if voxels is None else f"{len(voxels.coords)} of {voxels.resolution}^3"
        raise ValueError(f"asset {asset.name!r}: voxels are {found}, this model needs some of {edge}^3")
    places = paint = None
    if surface is not None:
        samples = surface.samples
        voxels, facings = lay_out(samples, voxelize_again(samples, voxels))
        places = measure_places(samples, voxels, facings)
        paint = (gather_paint(surface, voxels, facings).packed() / 255.0).astype(np.float32)
    elif model.flow.attribute_channels:
        raise ValueError(
            f"asset {asset.name!r} has no painted samples of its surface, which determine the positions and "
            "the colours of its Gaussians; sample its meshes (sim_export.geometry.surface) and paint the "
            "samples (artigen.appearance.paint.repaint)"
        )
    else:
        facings = find_facings(voxels.coords, voxels.part_ids, edge)
    canvas = Canvas(
        coords=voxels.coords,
        part_ids=voxels.part_ids,
        facings=facings,
        table=tabulate_parts(asset),
        places=places,
    )
    splats = draw_splats(model, canvas, asked, seed, paint=paint, sampler=sampler)
    return replace(asset, gaussians=to_gaussians(splats, voxels.part_ids))


def even_sides(
    drawn: Float[Tensor, "N C"],
    expected: Float[Tensor, "N C"],
    paint: Float[np.ndarray, "N 7"],
    edges: Int[np.ndarray, "2 E"],
) -> Float[Tensor, "N C"]:
    """Latents whose deviation in colour from the linear prior is averaged over each region of one paint.

    Args:
        drawn: Sampled latents, which begin with the colours of both sides (`artigen.appearance.vae`).
        edges: Pairs of neighbours on one face (`artigen.voxels.regions.find_edges`).
    """
    out = drawn.clone()
    for side in range(SIDES):
        own = slice(3 * side, 3 * side + 3)
        painted = np.concatenate([paint[:, own], paint[:, -1:]], axis=1)
        alike = np.abs(painted[edges[0]] - painted[edges[1]]).max(axis=1) <= ALIKE
        regions = torch.from_numpy(connected_groups(len(paint), edges[:, alike])).to(drawn.device)
        residual = drawn[:, own] - expected[:, own]
        count = torch.bincount(regions).to(residual.dtype)
        total = torch.zeros(len(count), residual.shape[1], dtype=residual.dtype, device=residual.device)
        mean = total.index_add_(0, regions, residual) / count[:, None]
        out[:, own] = expected[:, own] + mean[regions]
    return out
