"""Ids and titles of the L3 and L4 checks, and results of checks that were not run."""

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


def not_run(check: str, reason: str) -> CheckResult:
    """A failed result for a check that could not be run, with the reason."""
    title, level = (TITLES[check], "L3") if check in TITLES else (TASK_TITLES[check], "L4")
    return CheckResult(id=check, level=level, title=title, verdict="fail", message=f"not run: {reason}")
