"""Objects drawn for evaluation: one draw per condition, stored as it is made."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import torch
from tqdm import tqdm

from artigen.conditioning.image import resize_picture
from artigen.errors import ArtigenError, SegmentationError
from artigen.examples.batches import outline_batch, patch_batch
from artigen.io import read_asset, write_asset
from artigen.latent.draw import GenerateConfig, StructureModel, generate_structure
from artigen.latent.structure_vae import decode_cells
from artigen.metrics.subjects import Subject
from artigen.models.conditions import StructureCondition
from artigen.runtime.journal import append_line, read_lines
from artigen.shapes.asset import shape_to_asset
from artigen.shapes.shape import Shape
from artigen.sketch.model import draw_object, draw_pictured
from artigen.sketch.network import SketchNetwork
from artigen.sketch.request import SketchRequest
from artigen.types import Asset
from artigen.voxels.segmentation.segment import segment

ShapeSource = Callable[[StructureCondition, int], Shape]
"""Draws an object for a condition and a seed."""
DrawAsset = Callable[[StructureCondition, int], Asset]
"""Draws an object with voxels for a condition and a seed."""

JOURNAL = "draws.jsonl"


def sketch_source(network: SketchNetwork) -> ShapeSource:
    """Objects of the sketch network, by fields or by picture; open fields are sampled."""

    def draw_sketch(asked: StructureCondition, seed: int) -> Shape:
        depth, width, height = asked.size or (None, None, None)
        request = SketchRequest(
            category=asked.category, counts=asked.counts, depth=depth, width=width, height=height
        )
        if asked.image is None:
            return draw_object(network, request, seed).shape
        return draw_pictured(network, request, seed, asked.image).shape

    return draw_sketch


def draw_exact(source: ShapeSource, resolution: int) -> DrawAsset:
    """Draws the exact voxels of shapes."""
    return lambda asked, seed: shape_to_asset(source(asked, seed), resolution)


def draw_latent(model: StructureModel, source: ShapeSource, cfg: GenerateConfig) -> DrawAsset:
    """Draws voxels by the paper's latents, within the boxes of shapes."""

    def draw(asked: StructureCondition, seed: int) -> Asset:
        shape = source(asked, seed)
        edge = model.preset.conditions.image_size
        image = None if asked.image is None or not edge else resize_picture(asked.image, edge)
        return generate_structure(model, replace(asked, image=image), seed, cfg, boxes=shape)

    return draw


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawJob:
    """One draw to make; its noise follows from the seed alone."""

    key: str
    asked: StructureCondition
    seed: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Draw:
    """Result of a draw: an object, or the reason of failure."""

    asset: Asset | None
    error: str | None
    seconds: float


def draw_all(
    jobs: Sequence[DrawJob], folder: Path, draw_asset: DrawAsset, *, name: str = "draws"
) -> list[Draw]:
    """Makes the draws that ``folder`` does not hold yet, and returns all, in the order of ``jobs``.

    Args:
        jobs: Draws; a key stands for the same condition, seed and model at every start.
        folder: Folder for the journal and one asset folder per object.
    """
    folder.mkdir(parents=True, exist_ok=True)
    known = {line["key"]: line for line in read_lines(folder / JOURNAL)}
    out = []
    for job in tqdm(jobs, name, disable=None):
        kept = folder / job.key
        line = known.get(job.key)
        if line is not None and line["error"] is not None:
            draw = Draw(asset=None, error=str(line["error"]), seconds=float(str(line["seconds"])))
        elif line is not None and kept.is_dir():
            draw = Draw(asset=read_asset(kept), error=None, seconds=float(str(line["seconds"])))
        else:
            draw = _draw(job, draw_asset)
            if draw.asset is not None:
                write_asset(draw.asset, kept)
            line = {"key": job.key, "seed": job.seed, "seconds": draw.seconds, "error": draw.error}
            append_line(folder / JOURNAL, line)
        out.append(draw)
    return out


def reconstruct(model: StructureModel, subject: Subject) -> Asset | None:
    """The object reconstructed from its own latent by voting; None if that gives no object.

    It is the upper bound that decoder and segmentation set, whatever the condition.
    """
    device = next(model.vae.parameters()).device
    with torch.no_grad():
        mean, _ = model.vae.encode(patch_batch([subject.example]).to(device))
    (fields,), _ = decode_cells(model.vae, mean, outline_batch([subject.example]).to(device))
    asset = subject.asset
    try:
        return segment(fields, name=asset.name, scale=asset.scale, category=asset.category)
    except SegmentationError:
        return None


def _draw(job: DrawJob, draw_asset: DrawAsset) -> Draw:
    started, asset, reason = time.perf_counter(), None, None
    try:
        asset = draw_asset(job.asked, job.seed)
    except ArtigenError as error:  # no shape, or a part without cells
        reason = str(error)
    return Draw(asset=asset, error=reason, seconds=time.perf_counter() - started)
