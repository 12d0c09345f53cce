"""Ids and titles of the L3 and L4 checks, and results of checks that were not run."""

from collections.abc import Mapping

from sim_export.report import CheckResult

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


def not_run(titles: Mapping[str, str], reason: str, first: str | None = None) -> tuple[CheckResult, ...]:
    """Failed results for checks that could not be run.

    Args:
        titles: Ids and titles of the checks.
        reason: The reason.
        first: The check that the reason applies to; the others are not run because it failed. All when None.
    """
    return tuple(
        CheckResult(
            id=check,
            level=f"L{check[1]}",  # type: ignore[arg-type]
            title=title,
            verdict="fail",
            message=f"not run: {reason if first in (None, check) else f'{first} failed'}",
        )
        for check, title in titles.items()
    )
