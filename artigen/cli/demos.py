"""`artigen demos`: records demonstrations of a task as a data set."""

import sys
from pathlib import Path

import tyro

from artigen.api.demos import DemoFormat, DemoSettings, make_demos, replay_demos
from artigen.cli.arguments import Count, Out, RunnerChoice, Workers
from artigen.errors import ArtigenError
from artigen.runtime.runner import choose_runner

SETTINGS = DemoSettings()


def demos(
    task: tyro.conf.Positional[str],
    packages: tyro.conf.Positional[Path],
    out: Out,
    count: Count = 100,
    seed: int = 0,
    format: DemoFormat = "lerobot",
    cfg: tyro.conf.OmitArgPrefixes[DemoSettings] = SETTINGS,
    replay: int = 0,
    workers: Workers = None,
    runner: RunnerChoice = "local",
) -> int:
    """Record successful episodes of the scripted solvers as a data set of LeRobot or ManiSkill.

    Running the same command again resumes an interrupted run; another --format or a larger -n plays only
    what is missing. LeRobot's format requires: pip install "artigen[lerobot]".

    Args:
        task: Id of a task, such as ArtiGen-OpenPart-v1.
        packages: Folder of packages; every object has its turn.
        out: Output folder for the recordings and the data set.
        count: Number of successful episodes.
        seed: Seed of the first episode that is tried.
        format: LeRobot v3.0, or ManiSkill's HDF5 and JSON.
        replay: Play this many of the LeRobot episodes again, from their actions alone, and fail if one of
            them fails.
    """
    if replay and format != "lerobot":
        raise ArtigenError(
            f"replay {replay} of format {format}: expected lerobot; use python -m "
            "mani_skill.trajectory.replay_trajectory --traj-path for the other"
        )
    line = make_demos(
        task, packages, count, out, runner=choose_runner(runner, workers), seed=seed, cfg=cfg, format=format
    )
    sys.stdout.write(line + "\n")
    if not replay:
        return 0
    played = replay_demos(out / format, packages, replay)
    good = sum(each.success for each in played)
    lost = "".join(f"; {each.object} with seed {each.seed} fails" for each in played if not each.success)
    sys.stdout.write(f"{good} of {len(played)} episodes succeed when replayed{lost}\n")
    return 0 if good == len(played) else 1
