"""The whole measurement of a structure model: reconstruction, draws, baselines, packages, time and memory."""

from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import torch

from artigen.claim import claim_folder
from artigen.errors import ArtigenError
from artigen.generate import GenerateConfig, StructureModel, load_structure_model
from artigen.metrics.asks import (
    ASKS,
    REAL_ASKS,
    Bench,
    EvaluateConfig,
    HeldOut,
    Progress,
    Row,
    measure_ask,
    measure_packages,
    picture_neighbours,
)
from artigen.metrics.footprint import Footprint, FootprintJob, measure_footprint
from artigen.metrics.instantiation import pose_set
from artigen.metrics.packages import PackageReport, Prove
from artigen.metrics.reading import score_reader
from artigen.metrics.score import Scores
from artigen.metrics.shapes import ShapeSource, grammar_source
from artigen.metrics.structure import score_reconstruction, score_spread
from artigen.metrics.subjects import Subject, describe_subject, draw_subjects, read_subjects
from artigen.models.store import hash_model, read_description
from artigen.train.real import list_split
from artigen.train.shards import HELD_OUT


@dataclass(frozen=True, kw_only=True)
class Evaluation:
    """Everything that was measured."""

    model: str
    """Hash of the weights."""
    device: str
    config: dict[str, object]
    reconstruction: dict[str, Scores]
    """Table 3 and more, by set of objects."""
    spread: dict[str, dict[str, tuple[float, ...]]]
    """Table 4, by set of objects."""
    reading: dict[str, Scores]
    """How well pictures are read, by set of objects; empty where the model has no such network."""
    rows: tuple[Row, ...]
    footprint: Footprint
    left_out: dict[str, str]
    """Real objects that could not be read, and why."""
    packages: PackageReport | None
    """What became of draws as packages; None where none were made."""


def evaluate_structure(
    folder: Path,
    out: Path,
    cfg: EvaluateConfig,
    *,
    prove: Prove | None = None,
    draw_shape_for: ShapeSource | None = None,
    on_progress: Progress | None = None,
) -> Evaluation:
    """Measures a model folder; draws and ``nearest.png`` are kept in ``out``, draws are gone on with.

    Args:
        folder: Of the model.
        out: Of the evaluation.
        cfg: What is measured.
        prove: Makes and checks packages of draws; None leaves that out.
        draw_shape_for: Draws the objects whose boxes the model is told; None takes them from the grammar.
        on_progress: Called as work is done.

    Raises:
        SourceError: If the folder holds no whole model, ``out`` belongs to another one, or real objects
            cannot be read.
        ArtigenError: If there are too few objects to say anything.
    """
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    model = load_structure_model(folder, device)
    categories = model.preset.conditions.categories
    for name, count in (("held-out", cfg.held_out), ("training", cfg.training)):
        if count < len(categories):
            raise ArtigenError(
                f"{count} {name} objects: expected at least {len(categories)}, one of each category"
            )
    if min(cfg.packages, cfg.redraws, cfg.pictured) < 0:
        raise ArtigenError(
            f"{cfg.packages} objects as packages with {cfg.redraws} redraws, {cfg.pictured} pictured: "
            "expected nothing below 0"
        )
    if cfg.partnet is not None:
        list_split(cfg.partnet, "val")
    sampler = cfg.sampler
    claim_folder(
        out / "settings.json",
        {
            "model": hash_model(folder),
            "steps": sampler.steps,
            "strength": sampler.strength,
            "rescale": sampler.rescale,
            "interval": f"{sampler.interval[0]} to {sampler.interval[1]}",
            "seed": cfg.seed,
            "shapes": "grammar" if draw_shape_for is None else getattr(draw_shape_for, "__name__", "others"),
        },
    )
    tell = on_progress or (lambda stage, done, total: None)
    library = _draw_set(model, "training objects", HELD_OUT, cfg.training, tell)
    sets = {"procedural": _draw_set(model, "held-out objects", 0, cfg.held_out, tell)}
    left_out: dict[str, str] = {}
    if cfg.partnet is not None:
        resolution, size = model.preset.resolution, model.preset.conditions.image_size
        read = partial(read_subjects, cfg.partnet, image_size=size, workers=cfg.workers)
        tell("real objects", 0, 1)
        sets["real"], left_out = read("val", resolution)
        if read_description(folder)["vae"].get("real_objects"):  # they are training objects, too
            library += read("train", resolution)[0]
    examples = {name: [subject.example for subject in subjects] for name, subjects in sets.items()}
    held = {
        name: HeldOut(subjects=subjects, posed=pose_set([one.asset for one in subjects], cfg.score.poses))
        for name, subjects in sets.items()
    }
    source = draw_shape_for or grammar_source(model.reader)
    bench = Bench(model=model, draw_shape_for=source, library=library, out=out, cfg=cfg, tell=tell)
    rows = []
    for name, asks in (("procedural", ASKS), ("real", REAL_ASKS)):
        for ask, fields in asks.items():
            if name in held and ("image" not in fields or model.preset.conditions.image_size):
                rows += measure_ask(bench, ask, fields, held[name])
    picture_neighbours(bench, held["procedural"])
    packages = None
    if prove is not None and cfg.packages:
        packages = measure_packages(bench, held["procedural"], prove)
    first = sets["procedural"][0]
    typical = describe_subject(first, ASKS["counts and size"])
    generation = GenerateConfig(sampler=sampler)
    tell("time and memory", 0, 1)
    return Evaluation(
        model=hash_model(folder),
        device=str(device),
        config={**asdict(cfg), "partnet": cfg.partnet is not None},
        reconstruction={name: score_reconstruction(model.vae, chosen) for name, chosen in examples.items()},
        spread={name: score_spread(model.vae, chosen) for name, chosen in examples.items()},
        reading={}
        if model.reader is None
        else {name: score_reader(model.reader, chosen) for name, chosen in examples.items()},
        rows=tuple(rows),
        footprint=measure_footprint(
            FootprintJob(model=folder, asked=typical, boxes=first.asset, cfg=generation)
        ),
        left_out=left_out,
        packages=packages,
    )


def _draw_set(
    model: StructureModel, stage: str, first_seed: int, count: int, tell: Progress
) -> list[Subject]:
    done = iter(range(1, count + 1))
    return draw_subjects(
        model.preset.conditions.categories,
        first_seed,
        count,
        resolution=model.preset.resolution,
        image_size=model.preset.conditions.image_size,
        on_done=lambda: tell(stage, next(done), count),
    )
