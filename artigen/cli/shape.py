"""`artigen shape`: samples procedural objects and exports them as validated packages."""

import sys
from pathlib import Path

import tyro

from artigen.api.batch import read_shard
from artigen.api.objects import list_seeds
from artigen.api.sample import ShapeSettings, choose_like, sample_packages
from artigen.cli.arguments import Count, Out, RunnerChoice, Shard, Workers
from artigen.cli.summary import print_summary
from artigen.runtime.runner import choose_runner

SETTINGS = ShapeSettings()


def shape(
    category: tyro.conf.Positional[str],
    out: Out,
    seed: int = 0,
    count: Count = 1,
    name: str | None = None,
    cfg: tyro.conf.OmitArgPrefixes[ShapeSettings] = SETTINGS,
    sheet: Path | None = None,
    workers: Workers = None,
    runner: RunnerChoice = "local",
    shard: Shard = None,
) -> int:
    """Sample objects from the procedural grammar and export them as validated packages.

    Running the same command again resumes an interrupted run and retries failed objects.

    Args:
        category: Category to sample, such as StorageFurniture.
        out: Output folder for the packages and the journal run.jsonl.
        seed: Seed of the first object.
        count: Number of objects, with consecutive seeds.
        name: Name of the package, followed by the seed if there are several; default: category and seed.
        cfg: Properties of the objects and how they are exported.
        sheet: Write a PNG contact sheet: all objects closed in the top row, open in the bottom row.
    """
    part, chosen = read_shard(shard), choose_runner(runner, workers)
    seeds, settings = list_seeds(seed, count), choose_like(category, cfg)
    if cfg.topology:
        sys.stdout.write(f"{' '.join(cfg.topology)}: the template is {category} {settings.like}\n")
    results = sample_packages(
        category, out, seeds, settings, runner=chosen, name=name, sheet=sheet, part=part
    )
    return print_summary(results, out)
