"""The report on a package: one `CheckResult` per check, written as ``validation.json``."""

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

Verdict = Literal["pass", "fail", "not_applicable"]
Level = Literal["L0", "L1", "L2", "L3", "L4", "L5"]


@dataclass(frozen=True, kw_only=True)
class CheckResult:
    """Result of one check. ``value`` and ``threshold`` share ``unit``; ``where`` names the worst
    link, joint or file; ``message`` is one sentence, also for a check that does not apply."""

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


def round_measured(value: float | None) -> float | None:
    """Six significant digits; infinity and NaN, which JSON cannot say, become a very large number."""
    if value is None:
        return None
    return float(f"{value:.6g}") if math.isfinite(value) else 1e300


@dataclass(frozen=True, kw_only=True)
class Report:
    """All checks of one package, in order of their ids, with the versions that produced them."""

    package: str
    checks: tuple[CheckResult, ...]
    versions: tuple[tuple[str, str], ...] = ()
    seed: int = 0

    @property
    def passed(self) -> bool:
        """True when no check failed."""
        return all(check.verdict != "fail" for check in self.checks)

    @property
    def failures(self) -> tuple[CheckResult, ...]:
        """The failed checks."""
        return tuple(check for check in self.checks if check.verdict == "fail")


def report_to_json(report: Report) -> str:
    """The report as indented JSON; equal reports give equal text."""
    value = asdict(report) | {"passed": report.passed, "versions": dict(report.versions)}
    return json.dumps(value, indent=1) + "\n"


def report_from_json(text: str) -> Report:
    """Reads what `report_to_json` wrote; raises `ValueError` on anything else."""
    value = json.loads(text)
    value.pop("passed")
    checks = tuple(CheckResult(**check) for check in value.pop("checks"))
    return Report(checks=checks, versions=tuple(value.pop("versions").items()), **value)


def write_report(report: Report, path: Path) -> None:
    """Writes the report next to its final name and moves it there in one step."""
    scratch = path.with_name(path.name + ".partial")
    scratch.write_text(report_to_json(report))
    scratch.replace(path)
