"""Ids and titles of the L3 to L5 checks, and their results."""

from collections.abc import Mapping

from sim_export.report import CheckResult, Verdict, round_measured

TITLES = {
    "V301": "loads in SAPIEN with every hull and every mass",
    "V302": "rests under gravity with a fixed base",
    "V303": "stands on the ground with a free base",
    "V304": "opens and closes by hand",
    "V305": "stays closed when tilted",
    "V306": "no energy from nowhere",
    "V307": "two runs are identical",
    "V308": "compiles in MuJoCo without forces at rest",
    "V309": "behaves at every time step",
}
TASK_TITLES = {
    "V401": "a scripted robot opens it",
    "V402": "works in ManiSkill's own cabinet task",
    "V404": "a cube stays inside",
}
ENGINE_TITLES = {
    "V501": "loads",
    "V502": "masses",
    "V503": "stays finite",
    "V504": "rests",
    "V505": "full range",
    "V506": "friction",
}


def make_result(
    check: str,
    verdict: Verdict,
    message: str,
    *,
    engine: str = "",
    value: float | None = None,
    threshold: float | None = None,
    unit: str = "",
    where: str = "",
) -> CheckResult:
    """The result of a check; that of one in another engine includes the engine in its id and title."""
    title = (TITLES | TASK_TITLES | ENGINE_TITLES)[check]
    return CheckResult(
        id=f"{check}-{engine}" if engine else check,
        level=f"L{check[1]}",  # type: ignore[arg-type]
        title=f"{title} in {engine}" if engine else title,
        verdict=verdict,
        value=round_measured(value),
        threshold=round_measured(threshold),
        unit=unit,
        where=where,
        message=message,
    )


def not_run(titles: Mapping[str, str], reason: str) -> tuple[CheckResult, ...]:
    """Failed results for checks that could not be run, for one reason."""
    return tuple(
        CheckResult(
            id=check,
            level=f"L{check[1]}",  # type: ignore[arg-type]
            title=title,
            verdict="fail",
            message=f"not run: {reason}",
        )
        for check, title in titles.items()
    )
