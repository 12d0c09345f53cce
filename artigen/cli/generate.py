"""`artigen generate`: category, words or a photo to validated packages; failures are redrawn."""

import sys
from functools import partial
from pathlib import Path

import tyro

from artigen.api.batch import read_shard
from artigen.api.generate import GenerateSettings, generate_packages, list_jobs, understand_job
from artigen.api.objects import list_seeds
from artigen.cli.arguments import MaybeCount, Out, RunnerChoice, Shard, Workers
from artigen.cli.summary import print_summary
from artigen.runtime.runner import choose_runner
from artigen.runtime.workers import InProcess, Worker
from artigen.weights import SHIPPED

SETTINGS = GenerateSettings()


def generate(
    out: Out,
    model: Path = SHIPPED,
    category: tyro.conf.Positional[str | None] = None,
    seed: int = 0,
    count: MaybeCount = None,
    name: str | None = None,
    cfg: tyro.conf.OmitArgPrefixes[GenerateSettings] = SETTINGS,
    workers: Workers = None,
    runner: RunnerChoice = "local",
    shard: Shard = None,
) -> int:
    """Generate objects from a category, a sentence or a photo with a trained model.

    Running the same command again resumes an interrupted run and retries failed objects.

    Args:
        out: Output folder for the packages and the journal run.jsonl.
        model: Folder of a trained model (model.json and weights); default: the shipped one.
        category: Category to generate, such as StorageFurniture; optional with --text or --image.
        seed: Seed of the first object.
        count: Number of objects, with consecutive seeds; default: as many as the sentence names ("two
            ovens").
        name: Name of the package, followed by the seed if there are several; default: category, words and
            seed.
        cfg: The condition and the sampling settings.
    """
    part, chosen = read_shard(shard), choose_runner(runner, workers)
    list_asked = partial(list_jobs, out, cfg=cfg, category=category, model=model, name=name)
    understood = understand_job(list_asked(seeds=[seed])[0])
    jobs = list_asked(seeds=list_seeds(seed, understood.objects if count is None else count))
    if understood.said:
        sys.stdout.write("\n".join((understood.said, *understood.notes)) + "\n")
    worker = InProcess() if workers == 0 else Worker()
    results = generate_packages(jobs, out, runner=chosen, worker=worker, part=part)
    return print_summary(results, out)
