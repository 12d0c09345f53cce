"""Compares an engine's measurements with the package: checks V501 to V506."""

from collections.abc import Callable, Iterator

import numpy as np

from sim_export.report import CheckResult, Verdict

from ..titles import make_result
from .plan import HOLD, SLIP, EnginePlan, JointTask

NUMBER_TOLERANCE = 1e-4
"""Relative tolerance; engines compute in single precision."""
REST_LENGTH = 2e-4
"""Motion (m) of a sliding joint under gravity in one time step, before its limit pushes back."""
HELD = 0.2
"""Largest motion below the friction, as a share of the motion expected above it."""
SLIPPED = 0.5
"""Smallest motion above the friction, as a share of the expected motion."""


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
    """V501: every link, joint, limit and collision shape of the package exists in the engine, and so do
    friction and damping if it reports them; numbers agree within 1e-4."""
    problems = [*_link_problems(plan, answer), *_joint_problems(plan, answer)]
    lost = "".join(f"; {why}" for why in answer["lost"].values())
    where, message = "", f"{len(plan.links)} links and {len(plan.joints)} joints in {answer['version']}{lost}"
    if problems:
        where, message = problems[0]
        message += f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    return make_result(
        "V501", "fail" if problems else "pass", message,
        value=len(problems), threshold=0.0, unit="problems", where=where, engine=engine,
    )  # fmt: skip


def _link_problems(plan: EnginePlan, answer: dict) -> Iterator[tuple[str, str]]:
    for link in plan.links:
        found = answer["links"].get(link.name)
        if found is None:
            yield link.name, f"the engine has no link {link.name}"
        elif found["shapes"] is not None and found["shapes"] != link.shapes:
            yield link.name, f"{link.name} has {found['shapes']} collision shapes, the package {link.shapes}"


def _joint_problems(plan: EnginePlan, answer: dict) -> Iterator[tuple[str, str]]:
    for joint in plan.joints:
        found = answer["joints"].get(joint.name)
        if found is None:
            yield joint.name, f"the engine has no joint {joint.name} that moves"
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
                yield joint.name, f"{joint.name}: {key} is {said}, the package says {value:.6g}"
        given = (found["lower"], found["upper"])
        locked = all(
            value is not None and _close(value, end) for value, end in zip(given, thread, strict=False)
        )
        if not limited and given != (None, None) and not (thread and locked):
            yield joint.name, f"{joint.name} has no limits, but the engine gives it some"


def _thread_ends(plan: EnginePlan, joint: JointTask) -> tuple[float, ...]:
    """Coordinates at which the follower of an endless joint (a screw) stops it, lower and upper; empty
    without one."""
    for other in plan.joints:
        if other.mimic == joint.name and other.multiplier:
            return tuple(
                sorted((end - other.offset) / other.multiplier for end in (other.lower, other.upper))
            )
    return ()


def _close(value: float, wanted: float) -> bool:
    return abs(value - wanted) <= NUMBER_TOLERANCE * max(abs(wanted), 1e-2)


def check_masses(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V502: every link has the mass given in the URDF, within 1e-4; a root without mass is skipped."""
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
        return make_result("V502", "not_applicable", "no link has a mass on both sides", engine=engine)
    return make_result(
        "V502", _verdict(worst <= NUMBER_TOLERANCE),
        f"{count} masses compared, {where or 'none'} differs most",
        value=worst, threshold=NUMBER_TOLERANCE, unit="relative mass", where=where, engine=engine,
    )  # fmt: skip


def check_finite(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V503: all coordinates stay finite over all steps under gravity."""
    steps = answer["rest"]["steps"]
    return make_result(
        "V503", _verdict(steps >= plan.steps), f"finite for {steps} of {plan.steps} steps",
        value=steps, threshold=plan.steps, unit="steps", engine=engine,
    )  # fmt: skip


def check_rest(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V504: under gravity no joint moves by more than 1 % of its range (0.2 mm or 0.5 degrees if that is
    more)."""
    drift = answer["rest"]["drift"]
    shares = {
        joint.name: drift[joint.name] / _stillness(joint) for joint in plan.joints if joint.name in drift
    }
    if not shares:
        return make_result("V504", "not_applicable", "nothing moves", engine=engine)
    where = _worst(shares)
    return make_result(
        "V504", _verdict(shares[where] <= 1.0), f"{where} moved most",
        value=shares[where], threshold=1.0, unit="of the allowed", where=where, engine=engine,
    )  # fmt: skip


def _stillness(joint: JointTask) -> float:
    """Largest allowed motion (m or rad) of a joint at rest."""
    return max(joint.tolerance, REST_LENGTH) if joint.type == "prismatic" else joint.tolerance


def check_range(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V505: pushed open and closed again without gravity, every joint reaches both ends within 1 % of its
    range (0.1 mm, 0.5 degrees if that is more) and stays there under the push; followers follow within the
    same tolerance."""
    tolerances = {joint.name: joint.tolerance for joint in plan.joints}
    gaps: dict[str, float] = {}
    for name, found in answer["range"].items():
        gaps[name] = max(found["open_gap"], found["close_gap"], key=_badness)
        if "mimic" not in answer["lost"]:
            gaps |= found["follow"]
    if not gaps:
        return make_result("V505", "not_applicable", "nothing moves", engine=engine)
    where = _worst({name: gap / tolerances[name] for name, gap in gaps.items()})
    message = f"{where} stays farthest from an end of its range"
    if "mimic" in answer["lost"]:
        message += "; followers were not tested"
    joint = next(joint for joint in plan.joints if joint.name == where)
    return make_result(
        "V505", _verdict(gaps[where] <= joint.tolerance), message,
        value=gaps[where], threshold=joint.tolerance, where=where,
        unit="m to the end" if joint.type == "prismatic" else "rad to the end", engine=engine,
    )  # fmt: skip


def check_friction(engine: str, plan: EnginePlan, answer: dict) -> CheckResult:
    """V506: in the middle of its range without gravity, 0.9 times its friction moves a joint by less than a
    fifth of the motion expected from 1.1 times with exact friction and damping, and 1.1 times moves it by at
    least half of that."""
    trials = answer["friction"]
    if not trials:
        return make_result("V506", "not_applicable", "no joint has friction", engine=engine)
    held = _worst({name: found["held"] for name, found in trials.items()})
    slipped = _worst({name: -found["slipped"] for name, found in trials.items()})
    share = trials[held]["held"]
    if not share <= HELD:
        return make_result(
            "V506", "fail", f"{held} gives way to {HOLD} times its friction",
            value=share, threshold=HELD, unit="of the expected motion", where=held, engine=engine,
        )  # fmt: skip
    share = trials[slipped]["slipped"]
    passed = share >= SLIPPED
    message = f"{len(trials)} joints hold below their friction and move above it, {slipped} least"
    if not passed:
        message = f"{slipped} does not give way to {SLIP} times its friction"
    return make_result(
        "V506", _verdict(passed), message,
        value=share, threshold=SLIPPED, unit="of the expected motion", where=slipped, engine=engine,
    )  # fmt: skip


def _verdict(passed: bool) -> Verdict:  # noqa: FBT001
    return "pass" if passed else "fail"


def _badness(value: float) -> float:
    """Sort key: larger is worse, and NaN is the worst."""
    return value if np.isfinite(value) else float("inf")


def _worst(values: dict[str, float]) -> str:
    return max(values, key=lambda name: _badness(values[name]))
