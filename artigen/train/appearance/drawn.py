"""Voxels of procedural objects as sampled by a structure model, for training in addition to true ones.

A latent flow trained on true voxels alone leaves gaps and smears on sampled ones.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Int
from scipy.spatial import KDTree

from artigen.appearance.paint import lay_painted
from artigen.examples.shards import ShardConfig, ShardJob, draw_shard, load_shard, save_shard, split_rows
from artigen.latent.draw import GenerateConfig, StructureModel, draw_cells, load_structure_model
from artigen.models.conditions import StructureCondition, gather_conditions
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.draw import draw_shape
from artigen.types import Asset, SurfaceSamples, VoxelGrid
from artigen.voxels.fields import tabulate_parts
from artigen.voxels.frames import find_facings, gather_voxels
from artigen.voxels.layout import lay_out
from artigen.voxels.voxelize import voxelize_again

SHIFTED, STRAY, HOLES = 0.3, 0.03, 6
"""Share of displaced parts; share of displaced cells, and of missing ones; number of holes."""
NEAR = 2.5
"""Largest distance (cells) of a sampled voxel to the true one of its part and facing that it looks like."""
STORED = {"coords": np.uint8, "part_ids": np.uint8, "facings": np.uint8, "rows": np.int32, "like": np.int32}
"""Fields of `DrawnVoxels` and their types in a file."""
PER_ROW = ("rows", "like")
"""Fields that do not have one entry per voxel."""

Resurface = Callable[[Asset], SurfaceSamples]
"""Samples of the surface made from an asset's voxels (`sim_export.geometry.surface.sample_surface`)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnVoxels:
    """Sampled voxels of an object, and the true voxels that they look like."""

    coords: Int[np.ndarray, "N 3"]
    part_ids: Int[np.ndarray, "N"]
    facings: Int[np.ndarray, "N"]
    rows: Int[np.ndarray, "K"]
    """Rows of the voxels that look like a true one."""
    like: Int[np.ndarray, "K"]
    """Row of that true voxel."""


@dataclass(frozen=True, kw_only=True)
class DrawnShardConfig(ShardConfig):
    """Configuration of the examples of a folder."""

    structure: Path | None = None
    """Folder of the model that samples the voxels; without one, true voxels are roughened."""
    resurface: Resurface | None = None
    """Makes the surface of sampled voxels, as for a package; without it, voxels are used as sampled."""


def roughen(voxels: VoxelGrid, facings: Int[np.ndarray, "N"], rng: np.random.Generator) -> DrawnVoxels:
    """True voxels with errors like those of a model: parts a cell off, stray cells, holes."""
    cells, part_ids = voxels.coords.astype(np.int64), voxels.part_ids.astype(np.int64)
    parts = np.unique(part_ids)
    off = np.zeros((parts.max() + 1, 3), dtype=np.int64)
    off[parts] = rng.integers(-1, 2, (len(parts), 3)) * (rng.random((len(parts), 1)) < SHIFTED)
    stray = rng.integers(-1, 2, cells.shape) * (rng.random((len(cells), 1)) < STRAY)
    places = (cells + off[part_ids] + stray).clip(0, voxels.resolution - 1)
    middles = cells[rng.integers(len(cells), size=HOLES)]
    holes = (np.abs(cells[:, None] - middles).max(axis=2) <= rng.integers(0, 3, HOLES)).any(axis=1)
    kept = np.flatnonzero(~holes & (rng.random(len(cells)) >= STRAY))
    order = rng.permutation(kept)
    first = np.sort(np.unique(places[order], axis=0, return_index=True)[1])
    left = np.sort(order[first])
    return DrawnVoxels(
        coords=places[left],
        part_ids=part_ids[left],
        facings=facings[left],
        rows=np.arange(len(left)),
        like=left,
    )


def redraw(
    model: StructureModel,
    asset: Asset,
    facings: Int[np.ndarray, "N"],
    rng: np.random.Generator,
    resurface: Resurface | None = None,
) -> DrawnVoxels:
    """Voxels that a structure model samples within the outline of an object.

    With ``resurface``, and if no part lacks voxels, the result is the voxels that the surface passes through,
    as in generation (`artigen.appearance.draw.generate_appearance`).

    Raises:
        ValueError: If the model takes no outlines, or the asset has no voxels at its resolution.
    """
    voxels, wanted = asset.voxels, model.preset.resolution
    if not model.preset.takes_outlines or voxels is None or voxels.resolution != wanted:
        found = "no voxels" if voxels is None else f"voxels of {voxels.resolution}^3"
        how = "within outlines" if model.preset.takes_outlines else "without outlines"
        raise ValueError(
            f"asset {asset.name!r} has {found}, the model draws those of {wanted}^3 {how}: expected the same "
            "resolution, and a model that draws within outlines"
        )
    rows, edge = tabulate_parts(asset), model.flow.edge
    asked = gather_conditions([StructureCondition(category=asset.category)], model.preset.conditions)
    shape = (1, model.flow.channels, edge, edge, edge)
    noise = torch.from_numpy(rng.standard_normal(shape, dtype=np.float32))
    device = next(model.flow.parameters()).device
    with torch.no_grad():
        owners, _ = draw_cells(model, asked.to(device), noise.to(device), rows, GenerateConfig())
    drawn = gather_voxels(owners)
    if resurface is not None and len(np.unique(drawn.part_ids)) == len(asset.parts):
        surface = resurface(replace(asset, voxels=drawn))
        drawn, faced = lay_out(surface, voxelize_again(surface, drawn))
    else:
        faced = find_facings(drawn.coords, drawn.part_ids, wanted)
    near, like = _find_like(
        np.column_stack([voxels.coords, voxels.part_ids, facings]),
        np.column_stack([drawn.coords, drawn.part_ids, faced]),
    )
    return DrawnVoxels(
        coords=drawn.coords,
        part_ids=drawn.part_ids.astype(np.int64),
        facings=faced,
        rows=near,
        like=like,
    )


def make_drawn_shard(job: ShardJob[DrawnShardConfig]) -> Path:
    """Samples the voxels of the objects of one shard and writes them; runs in a worker process."""
    cfg = job.cfg
    model = None if cfg.structure is None else load_structure_model(cfg.structure)

    def draw(category: str, seed: int) -> DrawnVoxels:
        shape, rng = draw_shape(category, seed), np.random.default_rng(seed)
        asset, facings, _ = lay_painted(shape, shape_to_asset(shape, cfg.resolution))
        if model is not None:
            return redraw(model, asset, facings, rng, cfg.resurface)
        assert asset.voxels is not None
        return roughen(asset.voxels, facings, rng)

    return draw_shard(job, draw, write_drawn_shard)


def write_drawn_shard(path: Path, drawn: Sequence[DrawnVoxels]) -> None:
    """Writes the voxels of some objects to one npz file, whole or not at all."""
    arrays = {
        "voxel_counts": np.array([len(one.coords) for one in drawn]),
        "row_counts": np.array([len(one.rows) for one in drawn]),
    }
    for name, kind in STORED.items():
        arrays[name] = np.concatenate([getattr(one, name) for one in drawn]).astype(kind)
    save_shard(path, arrays, packed=True)


def read_drawn_shard(path: Path) -> Iterator[DrawnVoxels]:
    """The voxels of the objects of a shard.

    Raises:
        SourceError: If the file is missing or damaged.
    """
    arrays = load_shard(path, ("voxel_counts", "row_counts", *STORED))
    counts = {name: arrays["row_counts" if name in PER_ROW else "voxel_counts"] for name in STORED}
    columns = [split_rows(arrays[name].astype(np.int64), counts[name]) for name in STORED]
    for rows in zip(*columns, strict=True):
        yield DrawnVoxels(**dict(zip(STORED, rows, strict=True)))


def _find_like(
    true: Int[np.ndarray, "N 5"], drawn: Int[np.ndarray, "M 5"]
) -> tuple[Int[np.ndarray, "K"], Int[np.ndarray, "K"]]:
    """Rows of sampled voxels (cell, part, facing) near true ones of their part and facing; rows of these."""
    apart = np.array([1.0, 1.0, 1.0, 100.0, 100.0])
    distance, nearest = KDTree(true * apart).query(drawn * apart, distance_upper_bound=NEAR)
    near = np.flatnonzero(np.isfinite(distance))
    return near, np.asarray(nearest)[near]
