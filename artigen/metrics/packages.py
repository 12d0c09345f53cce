"""Pass rates of packages of drawn objects, at the first draw and after redraws.

The caller passes in a function that makes and checks packages, because this layer may not import
`sim_export`. Draws go in rounds, as in `artigen generate`: failed objects are drawn again with other noise.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from artigen.metrics.draws import DrawAsset, DrawJob, draw_all
from artigen.runtime.journal import append_line, read_lines

JOURNAL = "packages.jsonl"
NO_OBJECT = "no object"


@dataclass(frozen=True, kw_only=True)
class Proof:
    """Result of one draw; ``causes`` holds ids of failed checks, or the reason why there was no package."""

    key: str
    passed: bool
    causes: tuple[str, ...] = ()


Prove = Callable[[Sequence[Path]], Iterable[Proof]]
"""Asset folders to proofs, in any order; the key of a proof is the name of the folder."""


@dataclass(frozen=True, kw_only=True)
class PackageScores:
    """Pass rates of the objects of one category, or of all."""

    objects: int
    valid: float
    """Share of objects that are a tree of parts at the first draw."""
    first: float
    """Share of objects whose package passes at the first draw."""
    within: float
    """Share of objects whose package passes at the first draw or a redraw."""
    draws: float
    """Draws per object."""


@dataclass(frozen=True, kw_only=True)
class PackageReport:
    """Pass rates by category (``all`` for everything), and numbers of failed draws by cause."""

    redraws: int
    scores: Mapping[str, PackageScores]
    first_causes: Mapping[str, int]
    """Causes among the first draws."""
    causes: Mapping[str, int]
    """Causes among all draws; one draw may have several."""


def prove_draws(
    jobs: Sequence[DrawJob], out: Path, draw_asset: DrawAsset, prove: Prove, *, redraws: int
) -> PackageReport:
    """Draws objects, makes and checks their packages as far as ``out`` lacks them, and counts.

    Args:
        jobs: First draws, each with its category.
        out: Folder with ``draws/`` and the journal ``packages.jsonl``.
        redraws: Most redraws of an object that fails.
    """
    history: dict[str, list[Proof]] = {job.key: [] for job in jobs}
    waiting = list(jobs)
    for number in range(redraws + 1):
        if not waiting:
            break
        drawn = waiting if number == 0 else [_draw_again(job, number) for job in waiting]
        found = _prove_round(drawn, out, draw_asset, prove)
        for job, proof in zip(waiting, found, strict=True):
            history[job.key].append(proof)
        waiting = [job for job, proof in zip(waiting, found, strict=True) if not proof.passed]
    return count_proofs([(job.asked.category or "any", history[job.key]) for job in jobs], redraws)


def count_proofs(objects: Sequence[tuple[str, Sequence[Proof]]], redraws: int) -> PackageReport:
    """Shares and causes of objects, each with its category and the proofs of its draws in order."""
    scores = {}
    for name in [*sorted({category for category, _ in objects}), "all"]:
        proofs = [draws for category, draws in objects if name in (category, "all")]
        scores[name] = PackageScores(
            objects=len(proofs),
            valid=float(np.mean([not _has_no_object(draws[0]) for draws in proofs])),
            first=float(np.mean([draws[0].passed for draws in proofs])),
            within=float(np.mean([draws[-1].passed for draws in proofs])),
            draws=float(np.mean([len(draws) for draws in proofs])),
        )
    return PackageReport(
        redraws=redraws,
        scores=scores,
        first_causes=_count([draws[0] for _, draws in objects]),
        causes=_count([proof for _, draws in objects for proof in draws]),
    )


def name_cause(kind: str, sentence: str) -> str:
    """A cause from a sentence, with numbers masked so that similar sentences are counted together."""
    return f"{kind}: {re.sub(r'[0-9]+([.][0-9]+)?', '#', sentence)}"


def _draw_again(job: DrawJob, number: int) -> DrawJob:
    seed = int(np.random.SeedSequence([job.seed, number]).generate_state(1)[0])
    return DrawJob(key=f"{job.key}_again_{number}", asked=job.asked, seed=seed)


def _prove_round(jobs: Sequence[DrawJob], out: Path, draw_asset: DrawAsset, prove: Prove) -> list[Proof]:
    """Proofs in the order of ``jobs``; those in the journal are reused."""
    journal = out / JOURNAL
    known = {line["key"]: Proof(**{**line, "causes": tuple(line["causes"])}) for line in read_lines(journal)}
    missing = [job for job in jobs if job.key not in known]
    draws = draw_all(missing, out / "draws", draw_asset)
    for job, draw in zip(missing, draws, strict=True):
        if draw.error is not None:
            known[job.key] = Proof(key=job.key, passed=False, causes=(name_cause(NO_OBJECT, draw.error),))
    assets = [out / "draws" / job.key for job in missing if job.key not in known]
    for proof in tqdm(prove(assets) if assets else (), "packages", len(assets), disable=None):
        known[proof.key] = proof
        append_line(journal, asdict(proof))
    return [known[job.key] for job in jobs]


def _has_no_object(proof: Proof) -> bool:
    return any(cause.startswith(NO_OBJECT) for cause in proof.causes)


def _count(proofs: Sequence[Proof]) -> dict[str, int]:
    """Causes, the most frequent first."""
    counted = Counter(cause for proof in proofs for cause in sorted(set(proof.causes)))
    return dict(sorted(counted.items(), key=lambda item: (-item[1], item[0])))
