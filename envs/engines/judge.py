"""Compares an engine's answer with the package: checks V501 to V506."""

from collections.abc import Callable

import numpy as np

from sim_export.report import CheckResult, Verdict, round_measured

from .plan import HOLD, LIMIT_ANGLE, SLIP, EnginePlan, JointTask

TITLES = {
    "V501": "loads",
    "V502": "masses",
    "V503": "stays finite",
    "V504": "rests",
    "V505": "full range",
    "V506": "friction",
}
NUMBER_TOLERANCE = 1e-4
"""Relative; engines compute in single precision."""
REST_DRIFT = 0.01
"""Of its range, by which a joint may move at rest; at least `REST_LENGTH` (m) or `LIMIT_ANGLE` (rad)."""
REST_LENGTH = 2e-4
"""Gravity moves a sliding joint by as much in one time step, before its limit pushes back."""
HELD = 0.2
"""Of the motion expected above its friction, that a joint may make below it."""
SLIPPED = 0.5
"""Of that motion, that it must make above its friction."""


def judge(engine: str, plan: EnginePlan, answer: dict) -> tuple[CheckResult, ...]:
    """All checks of one engine, in order."""
    checks: tuple[Callable[[str, EnginePlan, dict], CheckResult], ...] = (
        check_loads,
        check_masses,
        check_finite,
        check_rest,
        check_range,
        check_friction,
    )
    return tuple(check(engine, plan, answer) for check in checks)


def check_loads(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V501: every link, joint, limit and collision shape of the package is in the engine, and friction
    and damping where it says what it has; numbers agree within 1e-4."""
    problems = [*_link_problems(plan, answer), *_joint_problems(plan, answer)]
    lost = "".join(f"; {why}" for why in answer["lost"].values())
    where, message = "", f"{len(plan.links)} links and {len(plan.joints)} joints in {answer['version']}{lost}"
    if problems:
        where, message = problems[0]
        message += f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    return make_check(
        "V501", engine, "fail" if problems else "pass", message,
        value=len(problems), threshold=0.0, unit="problems", where=where,
    )  # fmt: skip


def _link_problems(plan: EnginePlan, answer: dict) -> list[tuple[str, str]]:
    problems = []
    for link in plan.links:
        found = answer["links"].get(link.name)
        if found is None:
            problems.append((link.name, f"the engine has no link {link.name}"))
        elif found["shapes"] is not None and found["shapes"] != link.shapes:
            sentence = f"{link.name} has {found['shapes']} collision shapes, the package {link.shapes}"
            problems.append((link.name, sentence))
    return problems


def _joint_problems(plan: EnginePlan, answer: dict) -> list[tuple[str, str]]:
    problems = []
    for joint in plan.joints:
        found = answer["joints"].get(joint.name)
        if found is None:
            problems.append((joint.name, f"the engine has no joint {joint.name} that moves"))
            continue
        limited = joint.type != "continuous"
        thread = _thread_ends(plan, joint)
        wanted = {"friction": joint.friction, "damping": joint.damping} | (
            {"lower": joint.lower, "upper": joint.upper} if limited else {}
        )
        for key, value in wanted.items():
            if found[key] is None and key in ("friction", "damping"):
                continue
            if found[key] is None or not _close(found[key], value):
                said = "none" if found[key] is None else f"{found[key]:.6g}"
                problems.append((joint.name, f"{joint.name}: {key} is {said}, the package says {value:.6g}"))
        given = (found["lower"], found["upper"])
        locked = all(
            value is not None and _close(value, end) for value, end in zip(given, thread, strict=False)
        )
        if not limited and given != (None, None) and not (thread and locked):
            problems.append((joint.name, f"{joint.name} turns for ever, but not in the engine"))
    return problems


def _thread_ends(plan: EnginePlan, joint: JointTask) -> tuple[float, ...]:
    """Where the follower of an endless joint (a screw) stops it, lower and upper; empty without one."""
    for other in plan.joints:
        if other.mimic == joint.name and other.multiplier:
            return (other.lower / other.multiplier, other.upper / other.multiplier)
    return ()


def _close(value: float, wanted: float) -> bool:
    return abs(value - wanted) <= NUMBER_TOLERANCE * max(abs(wanted), 1e-2)


def check_masses(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V502: every link has the mass that the URDF says, within 1e-4; a root without one is left out."""
    worst, where, count = 0.0, "", 0
    for link in plan.links:
        found = answer["links"].get(link.name, {}).get("mass")
        if found is None or link.mass is None:
            continue
        count += 1
        error = abs(found - link.mass) / max(link.mass, 1e-12)
        if not error <= worst:
            worst, where = error, link.name
    if not count:
        return make_check("V502", engine, "not_applicable", "no link has a mass on both sides")
    return make_check(
        "V502", engine, _verdict(worst <= NUMBER_TOLERANCE),
        f"{count} masses compared, {where or 'none'} differs most",
        value=worst, threshold=NUMBER_TOLERANCE, unit="relative mass", where=where,
    )  # fmt: skip


def check_finite(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V503: all steps under gravity leave every coordinate finite."""
    steps = answer["rest"]["steps"]
    return make_check(
        "V503", engine, _verdict(steps >= plan.steps), f"finite for {steps} of {plan.steps} steps",
        value=steps, threshold=plan.steps, unit="steps",
    )  # fmt: skip


def check_rest(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V504: meanwhile no joint gets away from where it was by more than 1 % of its range (0.2 mm or 0.5
    degrees where that is more)."""
    drift = answer["rest"]["drift"]
    shares = {
        joint.name: drift[joint.name] / _stillness(joint) for joint in plan.joints if joint.name in drift
    }
    if not shares:
        return make_check("V504", engine, "not_applicable", "nothing moves")
    where = _worst(shares)
    return make_check(
        "V504", engine, _verdict(shares[where] <= 1.0), f"{where} moved most",
        value=shares[where], threshold=1.0, unit="of the allowed", where=where,
    )  # fmt: skip


def _stillness(joint: JointTask) -> float:
    """How far (m or rad) a joint may move at rest."""
    return max(REST_DRIFT * _span(joint), REST_LENGTH if joint.type == "prismatic" else LIMIT_ANGLE)


def check_range(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V505: pushed open and closed again, weight off, every joint arrives at both ends within 1 % of its
    range (0.1 mm, 0.5 degrees where that is more) and stays there under the push; what follows a joint
    follows it as closely."""
    tolerances = {joint.name: joint.tolerance for joint in plan.joints}
    gaps: dict[str, float] = {}
    for name, found in answer["range"].items():
        gaps[name] = max(found["open_gap"], found["close_gap"], key=_badness)
        if "mimic" not in answer["lost"]:
            gaps |= found["follow"]
    if not gaps:
        return make_check("V505", engine, "not_applicable", "nothing moves")
    where = _worst({name: gap / tolerances[name] for name, gap in gaps.items()})
    message = f"{where} stays farthest from an end of its range"
    if "mimic" in answer["lost"]:
        message += "; what follows a joint was not judged"
    joint = next(joint for joint in plan.joints if joint.name == where)
    return make_check(
        "V505", engine, _verdict(gaps[where] <= joint.tolerance), message,
        value=gaps[where], threshold=joint.tolerance, where=where,
        unit="m to the end" if joint.type == "prismatic" else "rad to the end",
    )  # fmt: skip


def check_friction(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V506: in the middle of its range, weight off, 0.9 times its friction moves a joint by less than a
    fifth of what 1.1 times must move it against exact friction and damping, and 1.1 times by at least
    half of that."""
    trials = answer["friction"]
    if not trials:
        return make_check("V506", engine, "not_applicable", "no joint has friction")
    held = _worst({name: found["held"] for name, found in trials.items()})
    slipped = _worst({name: -found["slipped"] for name, found in trials.items()})
    share = trials[held]["held"]
    if not share <= HELD:
        return make_check(
            "V506", engine, "fail", f"{held} gives way to {HOLD} times its friction",
            value=share, threshold=HELD, unit="of the expected motion", where=held,
        )  # fmt: skip
    share = trials[slipped]["slipped"]
    passed = share >= SLIPPED
    message = f"{len(trials)} joints hold below their friction and move above it, {slipped} least"
    if not passed:
        message = f"{slipped} does not give way to {SLIP} times its friction"
    return make_check(
        "V506", engine, _verdict(passed), message,
        value=share, threshold=SLIPPED, unit="of the expected motion", where=slipped,
    )  # fmt: skip


def make_check(
    check: str, engine: str, verdict: Verdict, message: str, *, value: float | None = None,
    threshold: float | None = None, unit: str = "", where: str = "",
) -> CheckResult:  # fmt: skip
    """A result whose id names the engine too."""
    return CheckResult(
        id=f"{check}-{engine}",
        level="L5",
        title=f"{TITLES[check]} in {engine}",
        verdict=verdict,
        value=round_measured(value),
        threshold=round_measured(threshold),
        unit=unit,
        where=where,
        message=message,
    )


def _verdict(passed: bool) -> Verdict:  # noqa: FBT001
    return "pass" if passed else "fail"


def _span(joint: JointTask) -> float:
    return max(joint.upper - joint.lower, 1e-9)


def _badness(value: float) -> float:
    """Larger is worse, and NaN the worst."""
    return value if np.isfinite(value) else float("inf")


def _worst(values: dict[str, float]) -> str:
    return max(values, key=lambda name: _badness(values[name]))
