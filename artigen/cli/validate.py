"""`artigen validate`: checks any folder with a ``mobility.urdf``."""

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from tqdm import tqdm

from artigen.cli.arguments import Packages, RunnerChoice, Shard, Workers
from artigen.cli.batch import name_part, read_shard, take_part
from artigen.errors import ArtigenError
from artigen.runtime.runner import choose_runner, run_jobs
from artigen.runtime.workers import Worker

if TYPE_CHECKING:
    from envs.config import EngineChoice
    from sim_export.report import Report


def validate_folder(
    worker: Worker,
    folder: Path,
    *,
    output: Literal["package", "none"],
    tasks: Literal["none", "run"] = "none",
    engines: "tuple[EngineChoice, ...]" = (),
) -> "Report":
    """Validates one folder in the worker."""
    from envs.config import ValidateConfig
    from envs.validate import validate as run

    return run(folder, ValidateConfig(output=output, tasks=tasks, engines=engines), worker)


def choose_engines(names: str, pythons: tuple[str, ...]) -> "tuple[EngineChoice, ...]":
    """Parses comma-separated engine names, and interpreters given as ``NAME=PATH``.

    Raises:
        ArtigenError: If an engine is unknown, or an interpreter does not exist or belongs to no requested
            engine.
    """
    from envs.config import EngineChoice
    from envs.engines.witness import WITNESSES

    asked = [name.strip() for name in names.split(",") if name.strip()]
    unknown = [name for name in asked if name not in WITNESSES]
    if unknown:
        raise ArtigenError(f"unknown engine {', '.join(unknown)}: expected {', '.join(WITNESSES)}")
    paths: dict[str, str] = {}
    for entry in pythons:
        name, _, path = entry.partition("=")
        if name not in asked:
            raise ArtigenError(f"--engine-python {entry}: expected NAME=PATH with NAME in --engines")
        if not Path(path).is_file():
            raise ArtigenError(f"--engine-python {entry}: no such file")
        paths[name] = path
    return tuple(EngineChoice(name=name, python=paths.get(name)) for name in asked)


def describe(report: "Report") -> str:
    """Summary line of a package, then one line per failed check and per missing engine."""
    skipped = [check for check in report.checks if check.message.startswith("skipped: ")]
    counts = dict.fromkeys(("pass", "fail", "not_applicable"), 0)
    for check in report.checks:
        counts[check.verdict] += 1
    head = (
        f"{'PASS' if report.passed else 'FAIL'} {report.package}: {counts['pass']} passed, "
        f"{counts['fail']} failed, {counts['not_applicable']} not applicable"
    )
    told = (*report.failures, *skipped)
    return "\n".join([head, *(f"  {check.id} {check.title}: {check.message}" for check in told)])


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
    from sim_export.files.folders import list_packages
    from sim_export.report import report_to_json

    missing = [str(folder) for folder in packages if not folder.is_dir()]
    if missing:
        sys.stderr.write(f"artigen: no such folder: {', '.join(missing)}\n")
        return 2
    asked = choose_engines(engines, engine_python)
    part = read_shard(shard)
    packages = tuple(one for folder in packages for one in list_packages(folder) or [folder])
    packages = tuple(take_part(packages, part))
    reports = []
    with tqdm(total=len(packages), unit="package", disable=len(packages) == 1) as bar:
        check = partial(validate_folder, output=report, tasks="run" if task else "none", engines=asked)
        for verdict in run_jobs(check, packages, choose_runner(runner, workers)):
            reports.append(verdict)
            bar.update()
            bar.write(describe(verdict), file=sys.stdout)
    if json_file is not None:
        ordered = sorted(reports, key=lambda verdict: verdict.package)
        name_part(json_file, part).write_text(
            "[" + ",\n".join(report_to_json(verdict).rstrip() for verdict in ordered) + "]\n"
        )
    return 0 if all(verdict.passed for verdict in reports) else 1
