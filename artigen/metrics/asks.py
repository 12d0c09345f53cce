"""Conditions of an evaluation of the structure model, and collection of its draws."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from artigen.metrics.draws import DrawAsset, DrawJob, draw_all
from artigen.metrics.instantiation import PosedSet
from artigen.metrics.neighbours import draw_neighbours, find_neighbours, pose_library, write_sheet
from artigen.metrics.packages import PackageReport, Prove, prove_draws
from artigen.metrics.retrieval import retrieve
from artigen.metrics.score import ScoreConfig, Scores, score_novelty, score_objects, score_set
from artigen.metrics.subjects import Field, Subject, describe_subject
from artigen.models.rectified_flow import SamplerConfig
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
    """Scope of an evaluation."""

    held_out: int = 70
    """Held-out procedural objects, categories in turn."""
    training: int = 350
    """Training objects that the baselines look in, categories in turn from the first training seed."""
    sampler: SamplerConfig = field(default_factory=SamplerConfig)
    """Steps and guidance of the structure's latents."""
    image_size: int = 256
    """Pixels of the edge of pictures."""
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


@dataclass(frozen=True, kw_only=True, eq=False)
class HeldOut:
    """Objects that were not trained on, posed for the comparison of sets."""

    subjects: list[Subject]
    posed: PosedSet


@dataclass(frozen=True, kw_only=True, eq=False)
class Bench:
    """Model and settings shared by all questions of an evaluation."""

    draw_asset: DrawAsset
    """Draws an object for a condition."""
    reconstruct: Callable[[Subject], Asset | None] | None
    """Finds an object again from its own latent, where the model has such."""
    library: list[Subject]
    out: Path
    cfg: EvaluateConfig
    tell: Progress


def measure_ask(bench: Bench, ask: str, fields: Sequence[Field], held: HeldOut) -> list[Row]:
    """The model, and what else answers the same conditions, against the objects that they describe."""
    library, cfg, tell = bench.library, bench.cfg, bench.tell
    subjects = held.subjects
    jobs = _list_jobs(bench, ask, fields, subjects)
    asked = [job.asked for job in jobs]
    # A picture shows how many parts there are, so they are to be met as if they were asked for.
    met: tuple[Field, ...] = (*fields, "counts") if "image" in fields else tuple(fields)
    wanted = [describe_subject(subject, met) for subject in subjects]
    truths = [subject.asset for subject in subjects]
    done = iter(range(1, len(jobs) + 1))
    draws = draw_all(
        jobs,
        bench.out / "draws",
        bench.draw_asset,
        on_done=lambda: tell(f"draws by {ask}", next(done), len(jobs)),
    )
    answers: dict[str, list[Asset | None]] = {"model": [draw.asset for draw in draws]}
    if "counts" in fields or "image" in fields:
        answers["retrieval"] = [retrieve(one, library).asset for one in asked]
    if "counts" in fields and bench.reconstruct is not None:
        answers["reconstruction"] = [bench.reconstruct(subject) for subject in subjects]
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
    draws = draw_all(jobs, bench.out / "draws", bench.draw_asset)
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
        _list_jobs(bench, ask, ASKS[ask], held.subjects[: bench.cfg.packages]),
        bench.out,
        bench.draw_asset,
        prove,
        redraws=bench.cfg.redraws,
        on_done=lambda done, total: bench.tell("packages", done, total),
    )


def _list_jobs(bench: Bench, ask: str, fields: Sequence[Field], subjects: Sequence[Subject]) -> list[DrawJob]:
    """One first draw for each subject; equal at every start."""
    stem = ask.replace(": ", "_").replace(" ", "_")
    jobs = []
    for number, subject in enumerate(subjects):
        asked = describe_subject(subject, fields)
        jobs.append(DrawJob(key=f"{stem}_{number:04d}", asked=asked, seed=_seed(bench.cfg, number)))
    return jobs


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
