"""The report on a package: one `CheckResult` per check, written as ``validation.json``."""

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from artigen.io import write_whole

Verdict = Literal["pass", "fail", "not_applicable"]
Level = Literal["L0", "L1", "L2", "L3", "L4", "L5"]


@dataclass(frozen=True, kw_only=True)
class CheckResult:
    """Result of one check. ``value`` and ``threshold`` share ``unit``; ``where`` names the worst link, joint
    or file; ``links`` are all links that fail it; ``message`` is one sentence, also if the check does not
    apply."""

    id: str
    level: Level
    title: str
    verdict: Verdict
    value: float | None = None
    threshold: float | None = None
    unit: str = ""
    where: str = ""
    message: str = ""
    seconds: float = 0.0
    links: tuple[str, ...] = ()


def round_measured(value: float | None) -> float | None:
    """Rounds to six significant digits; infinity and NaN, which JSON lacks, become a very large number."""
    if value is None:
        return None
    return float(f"{value:.6g}") if math.isfinite(value) else 1e300


@dataclass(frozen=True, kw_only=True, repr=False)
class Report:
    """All checks of one package, ordered by id, with the versions that produced them."""

    package: str
    checks: tuple[CheckResult, ...]
    versions: tuple[tuple[str, str], ...] = ()
    stopped: bool = False
    """Whether time or memory ran out before all checks were done; those that were not have failed."""

    def __repr__(self) -> str:
        return describe_report(self)

    @property
    def passed(self) -> bool:
        """True when no check failed."""
        return all(check.verdict != "fail" for check in self.checks)

    @property
    def failures(self) -> tuple[CheckResult, ...]:
        """The failed checks."""
        return tuple(check for check in self.checks if check.verdict == "fail")


def describe_report(report: Report) -> str:
    """Summary line of a package, then failed checks and missing engines, a line for each message."""
    skipped = [check for check in report.checks if check.message.startswith("skipped: ")]
    counts = dict.fromkeys(("pass", "fail", "not_applicable"), 0)
    for check in report.checks:
        counts[check.verdict] += 1
    head = (
        f"{'PASS' if report.passed else 'FAIL'} {report.package}: {counts['pass']} passed, "
        f"{counts['fail']} failed, {counts['not_applicable']} not applicable"
    )
    told: dict[str, list[CheckResult]] = {}
    for check in (*report.failures, *skipped):
        told.setdefault(check.message, []).append(check)
    named = {
        message: f"{same[0].id} {same[0].title}" if len(same) == 1 else ", ".join(check.id for check in same)
        for message, same in told.items()
    }
    return "\n".join([head, *(f"  {checks}: {message}" for message, checks in named.items())])


def report_to_json(report: Report) -> str:
    """The report as indented JSON; equal reports give equal text."""
    value = asdict(report) | {"passed": report.passed, "versions": dict(report.versions)}
    if not report.stopped:
        del value["stopped"]
    return json.dumps(value, indent=1) + "\n"


def report_from_json(text: str) -> Report:
    """Parses the output of `report_to_json`; raises `ValueError` for anything else."""
    value = json.loads(text)
    return Report(
        package=value["package"],
        checks=tuple(
            CheckResult(**check | {"links": tuple(check.get("links", ()))}) for check in value["checks"]
        ),
        versions=tuple(value["versions"].items()),
        stopped=value.get("stopped", False),
    )


def write_report(report: Report, path: Path) -> None:
    """Writes the report atomically."""
    write_whole(path, report_to_json(report))
