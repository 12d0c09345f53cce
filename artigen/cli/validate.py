"""`artigen validate`: the proof, on any folder with a ``mobility.urdf``."""

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from tqdm import tqdm

from artigen.cli.arguments import Packages, Workers
from artigen.workers import Worker, run_supervised

if TYPE_CHECKING:
    from sim_export.report import Report


def validate_folder(
    worker: Worker,
    folder: Path,
    *,
    output: Literal["package", "none"],
    tasks: Literal["none", "run"] = "none",
) -> "Report":
    """The report on one folder, run in the worker."""
    from envs.config import ValidateConfig
    from envs.validate import validate as run

    return run(folder, ValidateConfig(output=output, tasks=tasks), worker)


def describe(report: "Report") -> str:
    """A line for the package, and one for every check that failed."""
    counts = dict.fromkeys(("pass", "fail", "not_applicable"), 0)
    for check in report.checks:
        counts[check.verdict] += 1
    head = (
        f"{'PASS' if report.passed else 'FAIL'} {report.package}: {counts['pass']} passed, "
        f"{counts['fail']} failed, {counts['not_applicable']} not applicable"
    )
    return "\n".join([head, *(f"  {check.id} {check.title}: {check.message}" for check in report.failures)])


def validate(
    packages: Packages,
    json_file: Path | None = None,
    report: Literal["package", "none"] = "package",
    workers: Workers = 1,
    *,
    task: bool = False,
) -> int:
    """Runs the checks L0 to L3 and says which failed, where, by how much; exits 1 if any did.

    Args:
        packages: Folders with a mobility.urdf.
        json_file: Also write all reports to this file.
        report: Leave validation.json in each folder, or nothing.
        workers: Processes side by side.
        task: Also run the checks L4: the object at work in ManiSkill tasks.
    """
    from sim_export.report import report_to_json

    missing = [str(folder) for folder in packages if not folder.is_dir()]
    if missing:
        sys.stderr.write(f"artigen: no such folder: {', '.join(missing)}\n")
        return 2
    reports = []
    with tqdm(total=len(packages), unit="package", disable=len(packages) == 1) as bar:
        check = partial(validate_folder, output=report, tasks="run" if task else "none")
        for verdict in run_supervised(check, packages, workers=workers):
            reports.append(verdict)
            bar.update()
            bar.write(describe(verdict), file=sys.stdout)
    if json_file is not None:
        ordered = sorted(reports, key=lambda verdict: verdict.package)
        json_file.write_text(
            "[" + ",\n".join(report_to_json(verdict).rstrip() for verdict in ordered) + "]\n"
        )
    return 0 if all(verdict.passed for verdict in reports) else 1
