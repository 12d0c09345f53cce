"""Compares numbers of sampler steps: quality and seconds at 50, 25, 12, 6 and 4.

    python benchmarks/few_steps.py --model RUN/model --out out/few_steps

draws the same held-out conditions (category, counts, size) with the same noise and within the same boxes at
every number of steps, with guidance inside its interval and both velocities in one pass, and scores the
objects as `artigen eval` does. Writes ``few_steps.json`` and ``few_steps.md``; a second call goes on.
"""

import json
import statistics
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import torch
import tyro
from grammar_source import grammar_source
from roughness import measure_roughness

from artigen.errors import ArtigenError
from artigen.latent.draw import GenerateConfig, StructureModel, load_structure_model
from artigen.metrics.draws import DrawJob, draw_all, draw_latent
from artigen.metrics.instantiation import PosedSet, pose_set
from artigen.metrics.report import ROWS, format_score, format_table
from artigen.metrics.score import ScoreConfig, Scores, score_objects, score_set
from artigen.metrics.subjects import Subject, describe_subject, draw_subjects
from artigen.models.description import hash_model
from artigen.models.rectified_flow import SamplerConfig, is_guided, plan_times
from artigen.runtime.journal import claim_folder
from artigen.types import Asset

SHOWN = ("valid", "counts", "size", "strict_rest", "strict_articulated", "mmd", "coverage", "one_nna")


@dataclass(frozen=True, kw_only=True)
class Options:
    """Command-line options."""

    model: Path
    """Folder of the trained model."""
    out: Path = Path("out/few_steps")
    """Folder for draws and results."""
    steps: tuple[int, ...] = (50, 25, 12, 6, 4)
    """Numbers of steps."""
    strength: float = 0.0
    """Guidance; the paper's model, which takes no outline, takes 3."""
    objects: int = 70
    """Held-out objects, categories in turn."""
    seed: int = 0
    """Of the noise."""


def count_passes(cfg: SamplerConfig) -> int:
    """Velocities that the network computes for one object; a guided step takes two."""
    return sum(2 if is_guided(float(time), cfg) else 1 for time in plan_times(cfg)[:-1])


def run_steps(
    model: StructureModel, subjects: list[Subject], reference: PosedSet, steps: int, options: Options
) -> Scores:
    """Draws and scores at one number of steps."""
    sampler = SamplerConfig(steps=steps, strength=options.strength)
    wanted = [describe_subject(subject, ("category", "counts", "size")) for subject in subjects]
    jobs = [
        DrawJob(key=f"object_{number:04d}", asked=one, seed=options.seed * 100_000 + number)
        for number, one in enumerate(wanted)
    ]
    folder = options.out / f"steps_{steps}"
    make = draw_latent(model, grammar_source(), GenerateConfig(sampler=sampler))
    draws = draw_all(jobs, folder, make)
    found, truths = [draw.asset for draw in draws], [subject.asset for subject in subjects]
    cfg = ScoreConfig()
    return {
        "passes": float(count_passes(sampler)),
        "seconds": statistics.median(draw.seconds for draw in draws),
        "bends": statistics.fmean(_measure_bends(asset) for asset in found if asset is not None),
        **score_objects(wanted, found, truths, cfg),
        **score_set(found, reference, cfg.poses),
    }


def _measure_bends(asset: Asset) -> float:
    assert asset.voxels is not None
    return measure_roughness(asset.voxels.occupied())


def main(options: Options) -> int:
    """Runs all numbers of steps and writes the table."""
    if min(options.steps, default=0) < 1 or options.objects < 2:
        raise ArtigenError(
            f"steps {options.steps}, {options.objects} objects: expected steps, and two objects"
        )
    device = "cuda" if torch.cuda.is_available() else "cpu"
    model = load_structure_model(options.model, device)
    settings = {
        "model": hash_model(options.model),
        "strength": options.strength,
        "seed": options.seed,
        "device": device,
    }
    claim_folder(options.out / "settings.json", settings)
    preset = model.preset
    subjects = draw_subjects(
        preset.conditions.categories, 0, options.objects, resolution=preset.resolution, image_size=0
    )
    reference = pose_set([subject.asset for subject in subjects], ScoreConfig().poses)
    results = {}
    for steps in options.steps:
        started = time.monotonic()
        results[steps] = run_steps(model, subjects, reference, steps, options)
        print(f"{steps} steps after {time.monotonic() - started:.0f} s", file=sys.stderr)
    forms = {key: (name, form) for key, name, form in ROWS}
    rows = [
        (
            str(steps),
            f"{scores['passes']:.0f}",
            f"{scores['seconds']:.2f}",
            f"{scores['bends']:.3f}",
            *(format_score(scores.get(key), forms[key][1]) for key in SHOWN),
        )
        for steps, scores in results.items()
    ]
    head = ("steps", "velocities", "seconds per object", "bends per face", *(forms[key][0] for key in SHOWN))
    (options.out / "few_steps.json").write_text(json.dumps({**settings, "steps": results}, indent=1) + "\n")
    (options.out / "few_steps.md").write_text("\n".join(format_table(head, rows)) + "\n")
    print((options.out / "few_steps.md").read_text())
    return 0


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Options)))
