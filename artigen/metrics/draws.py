"""Objects drawn to be measured: one draw for each condition, kept on disk as it is made."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import torch

from artigen.errors import ArtigenError, SegmentationError
from artigen.generate import GenerateConfig, StructureModel, generate_structure
from artigen.io import read_asset, write_asset
from artigen.journal import append_line, read_lines
from artigen.metrics.shapes import ShapeSource
from artigen.metrics.subjects import Subject
from artigen.models.conditions import StructureCondition
from artigen.models.structure_vae import decode_fields
from artigen.segment import segment
from artigen.train.batches import outline_batch, patch_batch
from artigen.types import Asset

JOURNAL = "draws.jsonl"


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawJob:
    """One draw to make; its noise follows from the seed alone."""

    key: str
    asked: StructureCondition
    seed: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Draw:
    """What became of a first draw: an object, or why it is none."""

    asset: Asset | None
    error: str | None
    seconds: float


def draw_all(
    model: StructureModel,
    jobs: Sequence[DrawJob],
    folder: Path,
    cfg: GenerateConfig,
    draw_shape_for: ShapeSource,
    *,
    on_done: Callable[[], None] | None = None,
) -> list[Draw]:
    """Makes the draws that ``folder`` does not hold yet, and returns all, in the order of ``jobs``.

    Args:
        model: Trained networks.
        jobs: What to draw; a key stands for the same condition, seed and model at every start.
        folder: For the journal and one asset folder per object.
        cfg: Sampler, clean-up, segmentation.
        draw_shape_for: Draws the object whose boxes the model is told.
        on_done: Called after each.
    """
    folder.mkdir(parents=True, exist_ok=True)
    known = {line["key"]: line for line in read_lines(folder / JOURNAL)}
    out = []
    for job in jobs:
        kept = folder / job.key
        line = known.get(job.key)
        if line is not None and line["error"] is not None:
            draw = Draw(asset=None, error=str(line["error"]), seconds=float(str(line["seconds"])))
        elif line is not None and kept.is_dir():
            draw = Draw(asset=read_asset(kept), error=None, seconds=float(str(line["seconds"])))
        else:
            draw = _draw(model, job, cfg, draw_shape_for)
            if draw.asset is not None:
                write_asset(draw.asset, kept)
            said = {"key": job.key, "seed": job.seed, "seconds": draw.seconds, "error": draw.error}
            append_line(folder / JOURNAL, said)
        out.append(draw)
        if on_done is not None:
            on_done()
    return out


def reconstruct(model: StructureModel, subject: Subject, cfg: GenerateConfig) -> Asset | None:
    """The object found again from its own latent by voting; None where that is no object.

    What no condition can improve on: the limit of decoder and segmentation.
    """
    device = next(model.vae.parameters()).device
    with torch.no_grad():
        mean, _ = model.vae.encode(patch_batch([subject.example]).to(device))
    (fields,) = decode_fields(model.vae, mean, outline_batch([subject.example]).to(device))
    asset = subject.asset
    try:
        return segment(fields, cfg.segment, name=asset.name, scale=asset.scale, category=asset.category)
    except SegmentationError:
        return None


def _draw(model: StructureModel, job: DrawJob, cfg: GenerateConfig, draw_shape_for: ShapeSource) -> Draw:
    started = time.perf_counter()
    try:
        shape = draw_shape_for(job.asked, job.seed)
        asset = generate_structure(model, job.asked, job.seed, cfg, boxes=shape)
    except ArtigenError as error:  # no shape, or a part without cells
        return Draw(asset=None, error=str(error), seconds=time.perf_counter() - started)
    return Draw(asset=asset, error=None, seconds=time.perf_counter() - started)
