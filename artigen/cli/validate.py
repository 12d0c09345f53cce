"""`artigen validate`: the proof, on any folder with a ``mobility.urdf``."""

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from tqdm import tqdm

from artigen.cli.arguments import Packages, Workers
from artigen.workers import Worker, run_supervised

if TYPE_CHECKING:
    from sim_export.report import Report


def validate_folder(worker: Worker, folder: Path, *, keep: bool) -> "Report":
    """The report on one folder; ``keep`` leaves it there as ``validation.json``."""
    from envs.config import ValidateConfig
    from envs.validate import validate as run

    return run(folder, ValidateConfig(output="package" if keep else "none"), worker)


def describe(report: "Report") -> str:
    """A line for the package, and one for every check that failed."""
    counts = {verdict: 0 for verdict in ("pass", "fail", "not_applicable")}
    for check in report.checks:
        counts[check.verdict] += 1
    head = (
        f"{'PASS' if report.passed else 'FAIL'} {report.package}: {counts['pass']} passed, "
        f"{counts['fail']} failed, {counts['not_applicable']} not applicable"
    )
    return "\n".join([head, *(f"  {check.id} {check.title}: {check.message}" for check in report.failures)])


def validate(
    packages: Packages, json_file: Path | None = None, read_only: bool = False, workers: Workers = 1
) -> int:
    """Runs the checks L0 to L3 and says which failed, where, by how much; exits 1 if any did.

    Args:
        packages: Folders with a mobility.urdf.
        json_file: Also write all reports to this file.
        read_only: Leave no validation.json in the folders.
        workers: Processes side by side.
    """
    from sim_export.report import report_to_json

    missing = [str(folder) for folder in packages if not folder.is_dir()]
    if missing:
        sys.stderr.write(f"artigen: no such folder: {', '.join(missing)}\n")
        return 2
    reports = []
    with tqdm(total=len(packages), unit="package", disable=len(packages) == 1) as bar:
        for report in run_supervised(partial(validate_folder, keep=not read_only), packages, workers=workers):
            reports.append(report)
            bar.update()
            bar.write(describe(report), file=sys.stdout)
    if json_file is not None:
        ordered = sorted(reports, key=lambda report: report.package)
        json_file.write_text("[" + ",\n".join(report_to_json(report).rstrip() for report in ordered) + "]\n")
    return 0 if all(report.passed for report in reports) else 1
