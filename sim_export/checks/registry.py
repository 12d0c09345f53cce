"""Registry and runner of checks: each returns a verdict, and none can abort the suite."""

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from artigen.errors import ArtigenError
from sim_export.checks.config import CheckConfig
from sim_export.checks.subject import Subject
from sim_export.report import CheckResult, Level, Verdict

logger = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class Finding:
    """Measurement and verdict of a check; ``links`` are those that fail it."""

    passed: bool
    value: float | None
    threshold: float
    unit: str
    where: str
    message: str
    links: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class CheckSpec:
    """One check. ``applies`` returns the reason why the check does not apply, or "" if it does."""

    id: str
    level: Level
    title: str
    applies: Callable[[Subject], str]
    function: Callable[[Subject, CheckConfig], Finding]


def always(subject: Subject) -> str:
    """For checks that apply to every folder."""
    return ""


def at_most(
    value: float, limit: float, unit: str, *, where: str, message: str, links: Iterable[str] = ()
) -> Finding:
    """A finding that passes up to a limit; ``links`` are those beyond it."""
    return Finding(
        passed=value <= limit,
        value=value,
        threshold=limit,
        unit=unit,
        where=where,
        message=message,
        links=() if value <= limit else tuple(sorted(set(links))),
    )


def at_least(
    value: float, limit: float, unit: str, *, where: str, message: str, links: Iterable[str] = ()
) -> Finding:
    """A finding that passes from a limit on; ``links`` are those below it."""
    return replace(
        at_most(-value, -limit, unit, where=where, message=message, links=links), value=value, threshold=limit
    )


def count_problems(problems: Sequence[tuple[str, str]], fine: str, links: Iterable[str] = ()) -> Finding:
    """A finding that counts (location, sentence) pairs, which ``links`` have; none are allowed."""
    if not problems:
        return Finding(passed=True, value=0.0, threshold=0.0, unit="problems", where="", message=fine)
    where, sentence = problems[0]
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    return Finding(
        passed=False,
        value=float(len(problems)),
        threshold=0.0,
        unit="problems",
        where=where,
        message=sentence + more,
        links=tuple(sorted(set(links))),
    )


def run_check(spec: CheckSpec, subject: Subject, cfg: CheckConfig) -> CheckResult:
    """Runs one check; an error during the measurement fails the check."""
    begin = perf_counter()
    verdict: Verdict = "fail"
    finding: Finding | None = None
    message = ""
    try:
        message = spec.applies(subject)
        if message:
            verdict = "not_applicable"
        else:
            finding = spec.function(subject, cfg)
            verdict, message = ("pass" if finding.passed else "fail"), finding.message
    except ArtigenError as err:
        message = f"cannot be judged: {err}"
    except Exception as err:  # a broken folder fails its own check but never aborts the run
        logger.exception("%s: check %s crashed", subject.folder, spec.id)
        message = f"the check crashed: {type(err).__name__}: {err}"
    return CheckResult(
        id=spec.id,
        level=spec.level,
        title=spec.title,
        verdict=verdict,
        value=None if finding is None or finding.value is None else float(finding.value),
        threshold=None if finding is None else float(finding.threshold),
        unit="" if finding is None else finding.unit,
        where="" if finding is None else finding.where,
        message=message,
        seconds=perf_counter() - begin,
        links=() if finding is None else finding.links,
    )


def run_specs(specs: Sequence[CheckSpec], subject: Subject, cfg: CheckConfig) -> tuple[CheckResult, ...]:
    """Runs checks on a folder, in the given order."""
    return tuple(run_check(spec, subject, cfg) for spec in specs)
