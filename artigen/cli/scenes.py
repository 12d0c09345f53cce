"""`artigen scenes`: furnishes many rooms and flats from one library of packages."""

import sys
from pathlib import Path

import tyro

from artigen.api.batch import read_shard
from artigen.api.scene import Pictures, SceneFormat, SceneSettings
from artigen.api.scenes import make_scenes
from artigen.cli.arguments import Count, Out, RunnerChoice, Shard, Workers
from artigen.runtime.runner import choose_runner
from artigen.types import SceneKind

SETTINGS = SceneSettings()


def scenes(
    kinds: tyro.conf.Positional[tuple[SceneKind, ...]],
    out: Out,
    seed: int = 0,
    count: Count = 1,
    packages: Path | None = None,
    suites: int = 4,
    cfg: tyro.conf.OmitArgPrefixes[SceneSettings] = SETTINGS,
    formats: tuple[SceneFormat, ...] = ("mjcf",),
    pictures: Pictures = "plan",
    per_shard: int = 0,
    workers: Workers = None,
    runner: RunnerChoice = "local",
    shard: Shard = None,
) -> int:
    """Furnish many rooms and flats from one library of packages, with a page of statistics.

    Running the same command again resumes an interrupted run and retries failed scenes.

    Args:
        kinds: Kinds of rooms, or flat, in turn.
        out: Output folder for the library, a folder per scene, README.md and shards.
        seed: Seed of the first scene.
        count: Number of scenes, with consecutive seeds.
        packages: Folder with packages, at any depth, that passed `artigen validate`; without it, a library is
            sampled and validated once.
        suites: Number of looks in the sampled library; every scene has one of them.
        cfg: Properties of the scenes.
        formats: Files besides scene.json and goals.json.
        pictures: Pictures of every scene: all, the plan only, or none.
        per_shard: Pack this many scenes into each tar file; 0 for no tar files.
        shard: Furnish only the K-th of N equal parts, such as 3/64; a run without it packs all parts.
    """
    said = make_scenes(
        kinds, count, out, runner=choose_runner(runner, workers), seed=seed, packages=packages, suites=suites,
        cfg=cfg, formats=formats, pictures=pictures, per_shard=per_shard, part=read_shard(shard),
    )  # fmt: skip
    sys.stdout.write(said + "\n")
    return 0
