"""Requests of an evaluation, and the scores of the answers of a model and of its baselines."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from tqdm import tqdm

from artigen.metrics.draws import DrawAsset, DrawJob, draw_all
from artigen.metrics.instantiation import PosedSet
from artigen.metrics.packages import PackageReport, Prove, prove_draws
from artigen.metrics.score import ScoreConfig, Scores, score_novelty, score_objects, score_set
from artigen.metrics.settings import EvaluateSettings
from artigen.metrics.subjects import Field, Subject, describe_subject
from artigen.models.conditions import StructureCondition
from artigen.models.rectified_flow import SamplerConfig
from artigen.types import PART_LABELS, Asset

ASKS: dict[str, tuple[Field, ...]] = {
    "category": ("category",),
    "counts and size": ("category", "counts", "size"),
    "picture": ("image",),
}
"""Kinds of request by name, with the fields of their conditions."""
REAL_ASKS: dict[str, tuple[Field, ...]] = {
    "real: counts and size": ASKS["counts and size"],
    "real: picture": ASKS["picture"],
}
"""The same for real objects."""


@dataclass(frozen=True, kw_only=True)
class EvaluateConfig(EvaluateSettings):
    """Scope of an evaluation."""

    image_size: int = 256
    """Edge of pictures in pixels."""
    score: ScoreConfig = field(default_factory=ScoreConfig)
    """Sampling density of the scores."""
    workers: int = 2
    """Processes that read real objects."""

    @property
    def sampler(self) -> SamplerConfig:
        """Steps and guidance of the structure's latents."""
        return SamplerConfig(steps=self.steps, strength=self.strength)


@dataclass(frozen=True, kw_only=True)
class Row:
    """Scores of one method for one kind of request."""

    ask: str
    method: str
    objects: int
    scores: Scores


@dataclass(frozen=True, kw_only=True, eq=False)
class HeldOut:
    """Held-out objects, posed for the comparison of sets."""

    subjects: list[Subject]
    posed: PosedSet


@dataclass(frozen=True, kw_only=True, eq=False)
class Bench:
    """Model and settings shared by all requests of an evaluation."""

    draw_asset: DrawAsset
    """Draws an object for a condition."""
    reconstruct: Callable[[Subject], Asset | None] | None
    """Reconstructs an object from its own latent, if the model has latents."""
    library: list[Subject]
    out: Path
    cfg: EvaluateConfig


def measure_ask(bench: Bench, ask: str, fields: Sequence[Field], held: HeldOut) -> list[Row]:
    """Scores the model and its baselines on the same conditions, against the objects that these describe."""
    library, cfg, subjects = bench.library, bench.cfg, held.subjects
    jobs = _list_jobs(bench, ask, fields, subjects)
    asked = [job.asked for job in jobs]
    # A picture shows the number of parts, so counts are scored as if they had been requested.
    met: tuple[Field, ...] = (*fields, "counts") if "image" in fields else tuple(fields)
    wanted = [describe_subject(subject, met) for subject in subjects]
    truths = [subject.asset for subject in subjects]
    draws = draw_all(jobs, bench.out / "draws", bench.draw_asset, name=f"draws by {ask}")
    answers: dict[str, list[Asset | None]] = {"model": [draw.asset for draw in draws]}
    if "counts" in fields or "image" in fields:
        answers["retrieval"] = [retrieve(one, library).asset for one in asked]
    if "counts" in fields and bench.reconstruct is not None:
        answers["reconstruction"] = [bench.reconstruct(subject) for subject in subjects]
    if tuple(fields) == ASKS["category"]:
        answers["training set"] = _pick(library, subjects, cfg.seed)
        answers["held-out set"] = list(truths)
    rows = []
    for method, found in tqdm(answers.items(), f"scores by {ask}", disable=None):
        if method == "held-out set":  # reference for the novelty of the other methods
            novelty = score_novelty(found, library, cfg.score.poses)
            rows.append(Row(ask=ask, method=method, objects=len(found), scores=novelty))
            continue
        scores = score_objects(wanted, found, truths, cfg.score)
        if method != "reconstruction":  # each depends on its own object, so they are no sample of a set
            scores |= score_set(found, held.posed, cfg.score.poses)
        if method == "model":
            scores |= score_novelty(found, library, cfg.score.poses)
            scores["seconds"] = float(np.mean([draw.seconds for draw in draws]))
        rows.append(Row(ask=ask, method=method, objects=len(found), scores=scores))
    return rows


def measure_packages(bench: Bench, held: HeldOut, prove: Prove) -> PackageReport:
    """Makes and checks packages of first draws by counts and size, and of redraws where these fail."""
    ask = "counts and size"
    return prove_draws(
        _list_jobs(bench, ask, ASKS[ask], held.subjects[: bench.cfg.packages]),
        bench.out,
        bench.draw_asset,
        prove,
        redraws=bench.cfg.redraws,
    )


def _list_jobs(bench: Bench, ask: str, fields: Sequence[Field], subjects: Sequence[Subject]) -> list[DrawJob]:
    """One first draw for each subject; the same at every start."""
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


def condition_distance(asked: StructureCondition, subject: Subject) -> float:
    """Distance of an object from a condition; open fields do not count.

    It is the sum of one per part too many or too few, the absolute logarithm of the ratio of each extent, and
    a thousand times the mean squared difference of the pictures. It is infinite for another category.
    """
    example = subject.example
    if asked.category is not None and asked.category != example.category:
        return np.inf
    total = 0.0
    for label, count in asked.counts:
        total += abs(int(example.counts[PART_LABELS.index(label)]) - count)
    if asked.size is not None:
        total += float(np.abs(np.log(example.size / np.asarray(asked.size))).sum())
    if asked.image is not None:
        if example.image is None:
            return np.inf
        seen = example.image.transpose(2, 0, 1) / 255.0
        total += 1000.0 * float(((seen - asked.image) ** 2).mean())
    return total


def retrieve(asked: StructureCondition, library: Sequence[Subject]) -> Subject:
    """The object of a library nearest to a condition; the first of equally near ones.

    Raises:
        ValueError: If no object of the library is of the requested category.
    """
    distances = [condition_distance(asked, subject) for subject in library]
    if not distances or not np.isfinite(min(distances)):
        raise ValueError(f"none of {len(library)} objects can answer: category {asked.category!r}")
    return library[int(np.argmin(distances))]
