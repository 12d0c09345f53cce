"""Complete evaluations of the sketch and of the structure model."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

import torch

from artigen.errors import ArtigenError
from artigen.examples.real import list_split
from artigen.examples.shards import HELD_OUT
from artigen.kind import paper_kinds
from artigen.latent.draw import GenerateConfig, load_structure_model
from artigen.metrics.asks import (
    ASKS,
    REAL_ASKS,
    Bench,
    EvaluateConfig,
    HeldOut,
    Row,
    measure_ask,
    measure_packages,
)
from artigen.metrics.draws import ShapeSource, draw_exact, draw_latent, reconstruct, sketch_source
from artigen.metrics.instantiation import pose_set
from artigen.metrics.packages import PackageReport, Prove
from artigen.metrics.reading import score_reading
from artigen.metrics.score import Scores
from artigen.metrics.structure import score_reconstruction, score_spread
from artigen.metrics.subjects import Subject, draw_subjects, read_subjects
from artigen.models.description import hash_model, read_description
from artigen.runtime.journal import claim_folder
from artigen.sketch.model import load_sketch_network

RESOLUTION = 64
"""Edge of the voxel grid on which exact objects are compared."""


@dataclass(frozen=True, kw_only=True)
class Evaluation:
    """All results; fields that do not apply to a model are empty or None."""

    model: str
    """Hash of the weights."""
    device: str
    config: dict[str, object]
    rows: tuple[Row, ...]
    left_out: dict[str, str]
    """Reasons why real objects could not be read, by id."""
    reconstruction: dict[str, Scores] = field(default_factory=dict)
    """Table 3 of the paper and further scores, by set of objects."""
    spread: dict[str, dict[str, tuple[float, ...]]] = field(default_factory=dict)
    """Table 4 of the paper, by set of objects."""
    reading: dict[str, Scores] = field(default_factory=dict)
    """Accuracy of reading pictures, by set of objects."""
    packages: PackageReport | None = None
    """Pass rates of draws as packages."""


def evaluate_sketch(folder: Path, out: Path, cfg: EvaluateConfig) -> Evaluation:
    """Evaluates the sketch network of a model folder.

    Scores the reading of pictures, and objects drawn by category, counts, size and pictures. Draws are
    stored in ``out``; existing ones are reused.

    Args:
        cfg: Scope; packages are not made here, because those of sketches are made by `artigen generate`.

    Raises:
        SourceError: If the folder holds no sketch network, ``out`` belongs to another one, or real objects
            cannot be read.
        ArtigenError: If there are too few objects.
    """
    _check_evaluation(cfg)
    network = load_sketch_network(folder)
    pictured = network.cfg.picture is not None
    claim_folder(out / "settings.json", {"model": hash_model(folder), "seed": cfg.seed, "what": "sketch"})
    sets, left_out = _gather_sets(cfg, RESOLUTION)
    bench = Bench(
        draw_asset=draw_exact(sketch_source(network), RESOLUTION),
        reconstruct=None,
        library=_draw_set(HELD_OUT, cfg.training, RESOLUTION, cfg),
        out=out,
        cfg=cfg,
    )
    held = _pose_sets(sets, cfg)
    rows = _measure_asks(bench, held, pictured=pictured)
    return Evaluation(
        model=hash_model(folder),
        device="cpu",
        config={**asdict(cfg), "partnet": cfg.partnet is not None},
        reading={name: score_reading(network, chosen) for name, chosen in sets.items()} if pictured else {},
        rows=rows,
        left_out=left_out,
    )


def evaluate_structure(
    folder: Path,
    out: Path,
    cfg: EvaluateConfig,
    *,
    prove: Prove | None = None,
    draw_shape_for: ShapeSource | None = None,
) -> Evaluation:
    """Evaluates the structure model of a folder; stores draws in ``out``, and reuses them.

    Args:
        prove: Makes and checks packages of draws; None skips packages.
        draw_shape_for: Draws objects whose outlines the model takes; the folder's sketch network when None.

    Raises:
        SourceError: If the folder holds no complete model, ``out`` belongs to another one, or real objects
            cannot be read.
        ArtigenError: If there are too few objects.
    """
    _check_evaluation(cfg)
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    model = load_structure_model(folder, device)
    source = draw_shape_for or sketch_source(load_sketch_network(folder))
    sampler, resolution = cfg.sampler, model.preset.resolution
    claim_folder(
        out / "settings.json",
        {
            "model": hash_model(folder),
            "steps": sampler.steps,
            "strength": sampler.strength,
            "rescale": sampler.rescale,
            "interval": f"{sampler.interval[0]} to {sampler.interval[1]}",
            "seed": cfg.seed,
            "shapes": "sketch" if draw_shape_for is None else getattr(draw_shape_for, "__name__", "others"),
        },
    )
    sets, left_out = _gather_sets(cfg, resolution)
    library = _draw_set(HELD_OUT, cfg.training, resolution, cfg)
    if cfg.partnet is not None and read_description(folder)["vae"].get("real_objects"):
        library += read_subjects(
            cfg.partnet, "train", resolution, image_size=cfg.image_size, workers=cfg.workers
        )[0]  # the model was trained on these as well
    examples = {name: [subject.example for subject in subjects] for name, subjects in sets.items()}
    generation = GenerateConfig(sampler=sampler)
    bench = Bench(
        draw_asset=draw_latent(model, source, generation),
        reconstruct=lambda subject: reconstruct(model, subject),
        library=library,
        out=out,
        cfg=cfg,
    )
    held = _pose_sets(sets, cfg)
    rows = _measure_asks(bench, held, pictured=model.preset.conditions.image_size > 0)
    packages = None
    if prove is not None and cfg.packages:
        packages = measure_packages(bench, held["procedural"], prove)
    return Evaluation(
        model=hash_model(folder),
        device=str(device),
        config={**asdict(cfg), "partnet": cfg.partnet is not None},
        reconstruction={name: score_reconstruction(model.vae, chosen) for name, chosen in examples.items()},
        spread={name: score_spread(model.vae, chosen) for name, chosen in examples.items()},
        rows=rows,
        left_out=left_out,
        packages=packages,
    )


def _check_evaluation(cfg: EvaluateConfig) -> None:
    for name, count in (("held-out", cfg.held_out), ("training", cfg.training)):
        if count < len(paper_kinds()):
            raise ArtigenError(
                f"{count} {name} objects: expected at least {len(paper_kinds())}, one of each category"
            )
    if min(cfg.packages, cfg.redraws) < 0:
        raise ArtigenError(
            f"{cfg.packages} objects as packages with {cfg.redraws} redraws: expected 0 or more of each"
        )
    if cfg.partnet is not None:
        list_split(cfg.partnet, "val")


def _gather_sets(cfg: EvaluateConfig, resolution: int) -> tuple[dict[str, list[Subject]], dict[str, str]]:
    """Held-out objects, procedural and real, and reasons why real ones are left out, by id."""
    sets = {"procedural": _draw_set(0, cfg.held_out, resolution, cfg)}
    left_out: dict[str, str] = {}
    if cfg.partnet is not None:
        sets["real"], left_out = read_subjects(
            cfg.partnet, "val", resolution, image_size=cfg.image_size, workers=cfg.workers
        )
    return sets, left_out


def _pose_sets(sets: Mapping[str, list[Subject]], cfg: EvaluateConfig) -> dict[str, HeldOut]:
    return {
        name: HeldOut(subjects=subjects, posed=pose_set([one.asset for one in subjects], cfg.score.poses))
        for name, subjects in sets.items()
    }


def _measure_asks(bench: Bench, held: Mapping[str, HeldOut], *, pictured: bool) -> tuple[Row, ...]:
    rows: list[Row] = []
    for name, asks in (("procedural", ASKS), ("real", REAL_ASKS)):
        for ask, fields in asks.items():
            if name in held and ("image" not in fields or pictured):
                rows += measure_ask(bench, ask, fields, held[name])
    return tuple(rows)


def _draw_set(first_seed: int, count: int, resolution: int, cfg: EvaluateConfig) -> list[Subject]:
    return draw_subjects(paper_kinds(), first_seed, count, resolution=resolution, image_size=cfg.image_size)
