"""The whole measurement of a structure model: reconstruction, draws, baselines, packages, time and memory."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
import torch

from artigen.claim import claim_folder
from artigen.errors import ArtigenError
from artigen.generate import GenerateConfig, StructureModel, load_structure_model
from artigen.metrics.draws import DrawJob, draw_all, reconstruct
from artigen.metrics.footprint import Footprint, FootprintJob, measure_footprint
from artigen.metrics.instantiation import PosedSet, pose_set
from artigen.metrics.neighbours import draw_neighbours, find_neighbours, pose_library, write_sheet
from artigen.metrics.packages import PackageReport, Prove, prove_draws
from artigen.metrics.retrieval import retrieve
from artigen.metrics.score import ScoreConfig, Scores, score_novelty, score_objects, score_set
from artigen.metrics.structure import score_reconstruction, score_spread
from artigen.metrics.subjects import Field, Subject, describe_subject, draw_subjects, read_subjects
from artigen.models.store import hash_model, read_description
from artigen.sampling import SamplerConfig
from artigen.train.real import list_split
from artigen.train.shards import HELD_OUT
from artigen.types import Asset

ASKS: dict[str, tuple[Field, ...]] = {
    "category": ("category",),
    "counts and size": ("category", "counts", "size"),
    "picture": ("image",),
}
"""What models are asked for, and the fields of the condition."""
REAL_ASKS: dict[str, tuple[Field, ...]] = {
    "real: counts and size": ASKS["counts and size"],
    "real: picture": ASKS["picture"],
}
"""The same of real objects."""
NEIGHBOURS = 3
"""Training objects beside a drawn one in ``nearest.png``."""
Progress = Callable[[str, int, int], None]
"""Called with the stage, what is done of it, and all of it."""


@dataclass(frozen=True, kw_only=True)
class EvaluateConfig:
    """What is measured."""

    held_out: int = 70
    """Held-out procedural objects, categories in turn."""
    training: int = 350
    """Training objects that the baselines look in, categories in turn from the first training seed."""
    sampler: SamplerConfig = field(default_factory=SamplerConfig)
    """Steps and guidance."""
    score: ScoreConfig = field(default_factory=ScoreConfig)
    """How finely objects are sampled."""
    seed: int = 0
    """Of the noise."""
    partnet: Path | None = None
    """Folder with real objects: the validation split is measured too."""
    packages: int = 14
    """Held-out objects, the first ones, whose draws by counts and size are made packages and checked; at most
    all of them."""
    redraws: int = 3
    """How often such an object is drawn again where its package fails."""
    pictured: int = 14
    """Draws by category, the first ones, that are pictured beside their nearest training objects."""
    workers: int = 2
    """Processes that read real objects."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One way to answer one kind of question."""

    ask: str
    method: str
    objects: int
    scores: Scores


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
    rows: tuple[Row, ...]
    footprint: Footprint
    left_out: dict[str, str]
    """Real objects that could not be read, and why."""
    packages: PackageReport | None
    """What became of draws as packages; None where none were made."""


@dataclass(frozen=True, kw_only=True, eq=False)
class HeldOut:
    """Objects that were not trained on, posed for the comparison of sets."""

    subjects: list[Subject]
    posed: PosedSet


@dataclass(frozen=True, kw_only=True, eq=False)
class Bench:
    """What every question is asked with."""

    model: StructureModel
    library: list[Subject]
    out: Path
    cfg: EvaluateConfig
    tell: Progress


def evaluate_structure(
    folder: Path,
    out: Path,
    cfg: EvaluateConfig,
    *,
    prove: Prove | None = None,
    on_progress: Progress | None = None,
) -> Evaluation:
    """Measures a model folder; draws and ``nearest.png`` are kept in ``out``, draws are gone on with.

    Args:
        folder: Of the model.
        out: Of the evaluation.
        cfg: What is measured.
        prove: Makes and checks packages of draws; None leaves that out.
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
    bench = Bench(model=model, library=library, out=out, cfg=cfg, tell=tell)
    rows = []
    for name, asks in (("procedural", ASKS), ("real", REAL_ASKS)):
        for ask, fields in asks.items():
            if name in held and ("image" not in fields or model.preset.conditions.image_size):
                rows += measure_ask(bench, ask, fields, held[name])
    picture_neighbours(bench, held["procedural"])
    packages = None
    if prove is not None and cfg.packages:
        packages = measure_packages(bench, held["procedural"], prove)
    typical = describe_subject(sets["procedural"][0], ASKS["counts and size"])
    generation = GenerateConfig(sampler=sampler)
    tell("time and memory", 0, 1)
    return Evaluation(
        model=hash_model(folder),
        device=str(device),
        config={**asdict(cfg), "partnet": cfg.partnet is not None},
        reconstruction={name: score_reconstruction(model.vae, chosen) for name, chosen in examples.items()},
        spread={name: score_spread(model.vae, chosen) for name, chosen in examples.items()},
        rows=tuple(rows),
        footprint=measure_footprint(FootprintJob(model=folder, asked=typical, cfg=generation)),
        left_out=left_out,
        packages=packages,
    )


def measure_ask(bench: Bench, ask: str, fields: Sequence[Field], held: HeldOut) -> list[Row]:
    """The model, and what else answers the same conditions, against the objects that they describe."""
    model, library, cfg, tell = bench.model, bench.library, bench.cfg, bench.tell
    subjects = held.subjects
    generation = GenerateConfig(sampler=cfg.sampler)
    jobs = _list_jobs(bench, ask, fields, subjects)
    asked = [job.asked for job in jobs]
    # A picture shows how many parts there are, so they are to be met as if they were asked for.
    met: tuple[Field, ...] = (*fields, "counts") if "image" in fields else tuple(fields)
    wanted = [describe_subject(subject, met) for subject in subjects]
    truths = [subject.asset for subject in subjects]
    done = iter(range(1, len(jobs) + 1))
    draws = draw_all(
        model,
        jobs,
        bench.out / "draws",
        generation,
        on_done=lambda: tell(f"draws by {ask}", next(done), len(jobs)),
    )
    answers: dict[str, list[Asset | None]] = {"model": [draw.asset for draw in draws]}
    if "counts" in fields or "image" in fields:
        answers["retrieval"] = [retrieve(one, library).asset for one in asked]
    if "counts" in fields:
        answers["reconstruction"] = [reconstruct(model, subject, generation) for subject in subjects]
    if tuple(fields) == ASKS["category"]:
        answers["training set"] = _pick(library, subjects, cfg.seed)
        answers["held-out set"] = list(truths)
    rows = []
    for step, (method, found) in enumerate(answers.items()):
        tell(f"scores by {ask}", step, len(answers))
        if method == "held-out set":  # what the novelty of the others is to be compared with
            novelty = score_novelty(found, library, cfg.score.poses)
            rows.append(Row(ask=ask, method=method, objects=len(found), scores=novelty))
            continue
        scores = score_objects(wanted, found, truths, cfg.score)
        if method != "reconstruction":  # not a set of its own
            scores |= score_set(found, held.posed, cfg.score.poses)
        if method == "model":
            scores |= score_novelty(found, library, cfg.score.poses)
            scores["seconds"] = float(np.mean([draw.seconds for draw in draws]))
        rows.append(Row(ask=ask, method=method, objects=len(found), scores=scores))
    return rows


def picture_neighbours(bench: Bench, held: HeldOut) -> None:
    """Writes ``nearest.png``: draws by category beside the nearest training objects."""
    chosen = held.subjects[: bench.cfg.pictured]
    jobs = _list_jobs(bench, "category", ASKS["category"], chosen)
    generation = GenerateConfig(sampler=bench.cfg.sampler)
    draws = draw_all(bench.model, jobs, bench.out / "draws", generation)
    found = [draw.asset for draw in draws if draw.asset is not None]
    if not found:
        return
    posed = pose_library(bench.library, bench.cfg.score.poses)
    rows = []
    for number, asset in enumerate(found):
        bench.tell("nearest training objects", number, len(found))
        rows.append((asset, find_neighbours(asset, posed, bench.cfg.score.poses, NEIGHBOURS)))
    write_sheet(draw_neighbours(rows), bench.out / "nearest.png")


def measure_packages(bench: Bench, held: HeldOut, prove: Prove) -> PackageReport:
    """Makes packages of first draws by counts and size, and of further ones where they fail."""
    ask = "counts and size"
    return prove_draws(
        bench.model,
        _list_jobs(bench, ask, ASKS[ask], held.subjects[: bench.cfg.packages]),
        bench.out,
        GenerateConfig(sampler=bench.cfg.sampler),
        prove,
        redraws=bench.cfg.redraws,
        on_done=lambda done, total: bench.tell("packages", done, total),
    )


def _list_jobs(bench: Bench, ask: str, fields: Sequence[Field], subjects: Sequence[Subject]) -> list[DrawJob]:
    """One first draw for each subject; equal at every start."""
    stem = ask.replace(": ", "_").replace(" ", "_")
    return [
        DrawJob(
            key=f"{stem}_{number:04d}",
            asked=describe_subject(subject, fields),
            seed=_seed(bench.cfg, number),
        )
        for number, subject in enumerate(subjects)
    ]


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


def _pick(library: Sequence[Subject], subjects: Sequence[Subject], seed: int) -> list[Asset | None]:
    """A random object of the same category for each subject, none twice while there are enough."""
    rng = np.random.default_rng(seed)
    waiting: dict[str, list[Asset]] = {}
    out: list[Asset | None] = []
    for subject in subjects:
        category = subject.asset.category
        if not waiting.get(category):
            alike = [one.asset for one in library if one.asset.category == category]
            waiting[category] = [alike[index] for index in rng.permutation(len(alike)).tolist()]
        out.append(waiting[category].pop())
    return out


def _seed(cfg: EvaluateConfig, number: int) -> int:
    return int(np.random.SeedSequence([cfg.seed, number]).generate_state(1)[0])
