"""`artigen validate`: checks any folder with a ``mobility.urdf``."""

import sys
from pathlib import Path
from typing import Literal

from tqdm import tqdm

from artigen.api.batch import name_part, read_shard, take_part
from artigen.api.check import validate_packages
from artigen.cli.arguments import Packages, RunnerChoice, Shard, Workers
from artigen.io import write_whole
from artigen.runtime.runner import choose_runner


def validate(
    packages: Packages,
    json_file: Path | None = None,
    report: Literal["package", "none"] = "package",
    workers: Workers = None,
    *,
    task: bool = False,
    engines: str = "",
    engine_python: tuple[str, ...] = (),
    runner: RunnerChoice = "local",
    shard: Shard = None,
) -> int:
    """Run checks L0 to L3 on packages and report failures; exits with 1 if a check fails.

    Args:
        packages: Folders with a mobility.urdf, or folders that contain such folders at any depth.
        json_file: Also write all reports to this file; with --shard K/N, the part is added to its name.
        report: Write validation.json into each package, or nothing.
        task: Also run checks L4: a robot uses the object in ManiSkill tasks.
        engines: Also run checks L5 in these engines, comma-separated: mujoco, mujoco-urdf, sapien, pybullet,
            newton, newton-urdf. Engines that are not installed are skipped.
        engine_python: Python interpreters of environments that have an engine: newton=/path/to/python.
    """
    from envs.config import ValidateConfig
    from envs.engines.choose import choose_engines
    from sim_export.files.folders import find_packages
    from sim_export.report import describe_report, report_to_json

    asked = choose_engines(engines, engine_python)
    cfg = ValidateConfig(output=report, tasks="run" if task else "none", engines=asked)
    part = read_shard(shard)
    folders = take_part(find_packages(packages), part)
    reports = []
    with tqdm(total=len(folders), unit="package", disable=len(folders) == 1) as bar:
        for verdict in validate_packages(folders, cfg, choose_runner(runner, workers)):
            reports.append(verdict)
            bar.update()
            bar.write(describe_report(verdict), file=sys.stdout)
    if json_file is not None:
        ordered = sorted(reports, key=lambda verdict: verdict.package)
        listed = ",\n".join(report_to_json(verdict).rstrip() for verdict in ordered)
        write_whole(name_part(json_file, part), f"[{listed}]\n")
    return 0 if all(verdict.passed for verdict in reports) else 1
