"""`artigen convert`: converts URDFs, MJCFs, USD, SDFs, meshes and data sets to packages."""

import sys
from pathlib import Path

import tyro

from artigen.api.batch import read_shard
from artigen.api.convert import TIMEOUT, ConvertSettings, convert_packages
from artigen.api.suggest import suggest_files
from artigen.cli.arguments import Out, RunnerChoice, Shard, Workers
from artigen.cli.summary import print_summary
from artigen.runtime.runner import choose_runner

SETTINGS = ConvertSettings()


def convert(
    sources: tyro.conf.Positional[tuple[Path, ...]],
    out: Out,
    cfg: tyro.conf.OmitArgPrefixes[ConvertSettings] = SETTINGS,
    workers: Workers = None,
    timeout: float = TIMEOUT,
    runner: RunnerChoice = "local",
    shard: Shard = None,
    *,
    suggest_joints: bool = False,
) -> int:
    """Convert URDFs, MJCFs, USD, SDFs, meshes, PartNet-Mobility and ACD objects into validated packages.

    Running the same command again resumes an interrupted run and retries failed objects.

    Args:
        sources: URDF, xacro, MJCF, USD, SDF or mesh files, object folders, or folders that contain either.
        out: Output folder for the packages and the journal run.jsonl.
        cfg: How objects are converted.
        timeout: Time limit in seconds for one stage of one object.
        suggest_joints: Only write a joints file beside each mesh file, to be confirmed; nothing is converted.
    """
    if suggest_joints:
        for said in suggest_files(sources, cfg):
            sys.stdout.write(f"{said}\n")
        return 0
    part, chosen = read_shard(shard), choose_runner(runner, workers)
    results = convert_packages(sources, out, cfg, runner=chosen, timeout=timeout, part=part)
    return print_summary(results, out)
