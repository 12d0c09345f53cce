"""Gaussians of an exact shape: the VAE decoder applied to its known surfaces and colours.

Nothing is sampled: position, direction and colours of the surface are those of the shape. They are measured
on a grid finer than that of the voxels, for edges sharper than a voxel, and are encoded and decoded in tiles
of the edge that the networks were trained on. Every Gaussian moves with the part of its cell.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Bool, Float, Int

from artigen.appearance.curation import CurationConfig, curate
from artigen.appearance.extractors import make_extractor
from artigen.appearance.features import FeatureExtractor
from artigen.appearance.gaussian_decoder import to_gaussians
from artigen.appearance.inputs import FeatureInputs
from artigen.appearance.paint import lay_painted
from artigen.appearance.presets import APPEARANCE_PRESETS
from artigen.appearance.sides import CLEAR
from artigen.appearance.vae import APPEARANCE_VAE, SIDE_CHANNELS, AppearanceVae
from artigen.errors import SourceError
from artigen.latent.presets import PresetName
from artigen.models.description import read_description
from artigen.models.store import load_model
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.rasterize import rasterize_shape
from artigen.shapes.shape import Shape
from artigen.splats.render.splats import Splats
from artigen.types import Asset, SurfaceSamples, VoxelGrid
from artigen.voxels.frames import SIDES, facing_frames
from artigen.voxels.surface import find_voxels
from artigen.voxels.voxelize import assign_cells

VOXELS = 64
"""Edge of the grid of the articulated voxels."""
SIDED: Mapping[str, PresetName] = {
    name: name for name, one in APPEARANCE_PRESETS.items() if one.encoder.sided
}
"""Presets whose voxels have two sides."""
STRAIGHT = 0.97
"""Cosine from which surface counts as facing one way only; round legs need both sides to be closed."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ShapeAppearanceModel:
    """The trained VAE, and how its input features are computed from a shape."""

    vae: AppearanceVae
    extractor: FeatureExtractor
    curation: CurationConfig


def load_shape_appearance(folder: Path) -> ShapeAppearanceModel:
    """Loads encoder and decoder of a model folder; no other network is needed.

    Raises:
        SourceError: If the folder holds no VAE, one of an unknown preset or without sides, or one that reads
            the features of another network.
    """
    entry = read_description(folder).get(APPEARANCE_VAE)
    if entry is None:
        raise SourceError(f"{folder}: holds no {APPEARANCE_VAE}; train one with artigen train appearance")
    preset = SIDED.get(str(entry.get("preset")))
    if preset is None or entry.get("features") != "pyramid":
        raise SourceError(
            f"{folder}: {APPEARANCE_VAE} is of preset {entry.get('preset')!r} and reads features "
            f"{entry.get('features')!r}, expected one of {', '.join(SIDED)} and 'pyramid'"
        )
    inputs = FeatureInputs(
        preset=preset,
        articulated=bool(entry["articulated"]),
        weighting="plain" if entry["weighting"] == "plain" else "seen",
    )
    vae = AppearanceVae(inputs.encoder, APPEARANCE_PRESETS[preset].decoder)
    load_model(vae, folder, APPEARANCE_VAE)
    return ShapeAppearanceModel(
        vae=vae,
        extractor=make_extractor(inputs.extractor),
        curation=replace(inputs.curation, kept=0),
    )


def voxelize_shape(shape: Shape, resolution: int = VOXELS) -> Asset:
    """The asset of a shape with exact voxels and all of its parts, including those too small to own a voxel.

    `artigen.voxels.fields.encode` turns it into 35 channels; `artigen.voxels.voxelize.drop_unresolved`
    merges parts without a voxel into their parents.
    """
    found = rasterize_shape(shape, resolution)
    voxels = assign_cells(found.cells, found.part_ids, found.areas, resolution)
    asset = replace(shape_to_asset(shape, resolution=None), voxels=voxels)
    lost = np.setdiff1d(np.arange(len(asset.parts)), voxels.part_ids)
    notes = tuple(f"{asset.parts[index].name} is smaller than a voxel and owns none" for index in lost)
    return replace(asset, notes=notes)


def decode_gaussians(model: ShapeAppearanceModel, shape: Shape, *, zoom: int = 2) -> Asset:
    """The asset of a shape with exact voxels (64^3) and decoded Gaussians; deterministic.

    Args:
        model: The trained VAE.
        shape: The object.
        zoom: Cells along the edge of a voxel; 1 is faster, with half as many Gaussians.
    """
    fine = shape_to_asset(shape, zoom * model.vae.encoder.cfg.resolution)
    laid, facings, paint = lay_painted(shape, fine)
    surface, voxels = laid.surface, laid.voxels
    assert surface is not None
    assert voxels is not None
    features, _ = curate(shape, laid, facings, model.extractor, model.curation, paint)
    splats = decode_tiles(model.vae, voxels, facings, features.values.astype(np.float32))
    clear = features.values[:, -SIDE_CHANNELS]
    shown = find_shown(surface, voxels, facings) | (clear > CLEAR)[:, None]
    splats, part_ids = leave_out(splats, voxels.part_ids, shown)
    whole = voxelize_shape(shape)
    row = {part.name: index for index, part in enumerate(whole.parts)}
    owners = np.array([row[part.name] for part in laid.parts])
    return replace(whole, gaussians=to_gaussians(splats, owners[part_ids]))


@torch.no_grad()
def decode_tiles(
    vae: AppearanceVae, voxels: VoxelGrid, facings: Int[np.ndarray, "N"], features: Float[np.ndarray, "N C"]
) -> Splats:
    """Encodes and decodes cells of a grid of any edge, in tiles of the edge that the networks take.

    Returns:
        Gaussians in the order of the cells.
    """
    cells = voxels.coords.astype(np.int64)
    corners, tiles = np.unique(cells // vae.encoder.cfg.resolution, axis=0, return_inverse=True)
    rows = [np.flatnonzero(tiles.ravel() == tile) for tile in range(len(corners))]
    # One tile at a time: the activations of all tiles do not fit into the cache of a processor.
    decoded = [
        _decode_tile(vae, voxels, corner, own, facings, features)
        for corner, own in zip(corners, rows, strict=True)
    ]
    back = np.argsort(np.concatenate(rows))[:, None] * vae.count + np.arange(vae.count)
    order = torch.from_numpy(back.ravel()).to(decoded[0].means.device)
    return Splats(
        **{name: torch.cat([vars(one)[name] for one in decoded])[order] for name in vars(decoded[0])}
    )


def _decode_tile(
    vae: AppearanceVae,
    voxels: VoxelGrid,
    corner: Int[np.ndarray, "3"],
    rows: Int[np.ndarray, "K"],
    facings: Int[np.ndarray, "N"],
    features: Float[np.ndarray, "N C"],
) -> Splats:
    """Gaussians, in the frame of the whole grid, of cells of the tile at ``corner`` (in tiles)."""
    edge, device = vae.encoder.cfg.resolution, next(vae.parameters()).device
    places = np.pad(voxels.coords[rows].astype(np.int64) % edge, ((0, 0), (1, 0)))  # all of sample 0
    own = torch.from_numpy(features[rows]).to(device)
    noise = torch.zeros(len(rows), vae.encoder.cfg.latent_channels, device=device)
    faced = torch.from_numpy(facings[rows].astype(np.int64)).to(device)
    values = vars(vae(torch.from_numpy(places).to(device), own, noise, faced).splats)
    share = edge / voxels.resolution
    means = (values["means"] + 0.5 + torch.from_numpy(corner).to(device).float()) * share - 0.5
    return Splats(**{**values, "means": means, "scales": values["scales"] * share})


def find_shown(
    surface: SurfaceSamples, voxels: VoxelGrid, facings: Int[np.ndarray, "N"]
) -> Bool[np.ndarray, "N 2"]:
    """Mask of the sides of cells (outer, inner) that show surface.

    Left out are the far side of a cell whose surface faces one way only, and both sides of a cell that
    surface only grazes, where its filled share is unknown.

    Args:
        surface: Samples, `artigen.voxels.surface.SAMPLES` along a cell's edge.
        voxels: Cells of the same object.
        facings: Directions of their outer sides.
    """
    rows, own = find_voxels(surface, voxels)
    outward = facing_frames()[facings][rows][:, :, 0]
    ahead = np.einsum("ki,ki->k", outward, surface.normals[own].astype(np.float64))
    count = len(facings)
    every = np.bincount(rows, minlength=count)
    faced = [np.bincount(rows[sign * ahead > STRAIGHT], minlength=count) for sign in (1.0, -1.0)]
    alone = [(number > 0) & (number == every) for number in faced]
    grazed = (every == 0) & np.isin(voxels.part_ids, voxels.part_ids[every > 0])
    return np.stack([~alone[1] & ~grazed, ~alone[0] & ~grazed], axis=1)


def leave_out(
    splats: Splats, part_ids: Int[np.ndarray, "N"], shown: Bool[np.ndarray, "N 2"]
) -> tuple[Splats, Int[np.ndarray, "K"]]:
    """Gaussians without those of sides that show nothing, and the part of each.

    Where one side of a cell stays alone, its Gaussians get the opacity of two in a row, so that the cell
    hides as much as before.

    Args:
        splats: Gaussians of all cells, cell after cell, outer side first.
        part_ids: Part of each cell.
        shown: Mask of the sides that stay, the outer one first.
    """
    half = len(splats.means) // (SIDES * len(part_ids))
    kept = np.repeat(shown.ravel(), half)
    alone = torch.from_numpy(np.repeat(~shown.all(axis=1), SIDES * half)[kept]).to(splats.means.device)
    rows = torch.from_numpy(np.flatnonzero(kept)).to(splats.means.device)
    values = {name: value[rows] for name, value in vars(splats).items()}
    solid = values["opacities"]
    values["opacities"] = torch.where(alone, 1.0 - (1.0 - solid) ** 2, solid)
    return Splats(**values), np.repeat(part_ids, SIDES * half)[kept]
