"""Checks V301 to V309: load, rest, stability, opening, closing and holding in a physics engine.

These functions run in the current process, which SAPIEN may abort; `envs.validate` calls them in a supervised
child. Each function documents its measurement, limit and scope.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from artigen.types import Joint
from sim_export.errors import PackageError
from sim_export.package import SimPackage
from sim_export.physics.standing import must_stand
from sim_export.report import CheckResult

from .limits import limit_tolerance
from .sim.mujoco import compile_model
from .titles import TITLES, make_result, not_run
from .trials import TrialResults, run_trials

TIMESTEP = 1.0 / 100.0
"""Time step (seconds) of checks V302 to V307: ManiSkill's default."""
OTHER_TIMESTEPS = (1.0 / 60.0, 1.0 / 240.0)
"""Time steps (seconds) at which V309 repeats V302 to V306."""
MASS_TOLERANCE = 1e-4
REST_SPEED = 1e-3
STAND_TILT = 2.0
STAND_DRIFT = 0.005
STAND_PENETRATION = 0.005
SIZE_RATIO = 10.0
REPEAT = 1e-6
MUJOCO_FORCE = 1e-3


def check_dynamics(folder: Path, package: SimPackage) -> tuple[CheckResult, ...]:
    """All L3 checks of a package, in order of their ids; ``seconds`` is the duration of each."""
    clock = time.perf_counter()
    try:
        main = run_trials(folder, package, TIMESTEP)
    except PackageError as error:
        titles = {name: title for name, title in TITLES.items() if name not in ("V301", "V308")}
        rest = not_run(titles, "the package does not load")
        loads = _result("V301", fails=True, message=str(error))
        return tuple(sorted([loads, *rest, check_mujoco(folder)], key=lambda result: result.id))
    spent = time.perf_counter() - clock
    single = list(_single_checks(package, main))
    single[1] = replace(single[1], seconds=spent)
    return (
        *single,
        _timed(lambda: check_repeat(folder, package, main)),
        _timed(lambda: check_mujoco(folder)),
        _timed(lambda: check_timesteps(folder, package)),
    )


def _single_checks(package: SimPackage, run: TrialResults) -> tuple[CheckResult, ...]:
    """V301 to V306 from the trials at one time step."""
    return (
        check_loads(run),
        check_rest(run),
        check_stand(package, run),
        check_opens(run),
        check_stays_closed(run),
        check_energy(run),
    )


def check_loads(run: TrialResults) -> CheckResult:
    """V301: no collision shape is lost, and every link has the mass given in the URDF.

    Each ``<collision>`` must yield at least one shape (exactly one if it contains one hull; older packages
    store several in one file). A link without ``<inertial>`` has no mass to compare: SAPIEN then assumes 1000
    kg/m^3, which is reported here and judged by V007. Masses must agree within 1e-4.
    """
    for load in run.loads:
        if load.lost or load.shapes < load.hulls:
            files = ", ".join(load.lost) or "primitive shapes"
            return _result(
                "V301", fails=True, value=load.hulls - len(load.lost), threshold=load.hulls, unit="shapes",
                where=load.name, message=f"{load.name} lost {files}: write closed, solid OBJ hulls",
            )  # fmt: skip
    worst, where = 0.0, ""
    for load in run.loads:
        if load.mass is not None:
            error = abs(load.engine_mass - load.mass) / max(load.mass, 1e-12)
            if error > worst or not where:
                worst, where = error, load.name
    unweighed = [load.name for load in run.loads if load.mass is None and load.shapes]
    message = f"{sum(load.shapes for load in run.loads)} shapes in {len(run.loads)} links"
    if unweighed:
        message += f"; SAPIEN assumes the mass of {', '.join(unweighed)} (no inertial, 1000 kg/m^3)"
    if worst > MASS_TOLERANCE:
        message = f"{where}: SAPIEN's mass differs from the URDF's: its inertia is zero or not positive"
    return _result(
        "V301", fails=worst > MASS_TOLERANCE, value=worst, threshold=MASS_TOLERANCE, unit="relative mass",
        where=where, message=message,
    )  # fmt: skip


def check_rest(run: TrialResults) -> CheckResult:
    """V302: with a fixed base and under gravity for 5 s, no joint moves by more than 1 % of its range (of a
    full turn without limits), or 0.1 mm or 0.5 degrees if that is more, or still moves faster than 1e-3 m/s
    or rad/s at the end."""
    joints = run.joints
    if not joints:
        return make_result("V302", "not_applicable", "nothing moves")
    still = np.array([limit_tolerance(joint) for joint in joints])
    worst = int(np.argmax(run.rest_drift / still))
    fast = int(np.argmax(np.where(np.isfinite(run.rest_speed), run.rest_speed, np.inf)))
    fails = not run.rest_drift[worst] <= still[worst]
    if not fails and not run.rest_speed[fast] < REST_SPEED:
        return _result(
            "V302", fails=True, value=float(run.rest_speed[fast]), threshold=REST_SPEED, unit="m/s or rad/s",
            where=joints[fast].name, message=f"{joints[fast].name} is still moving after 5 s",
        )  # fmt: skip
    return _result(
        "V302", fails=fails, value=float(run.rest_drift[worst]), threshold=float(still[worst]),
        unit=_unit(joints[worst]), where=joints[worst].name, message=f"{joints[worst].name} moved most",
    )  # fmt: skip


def check_stand(package: SimPackage, run: TrialResults) -> CheckResult:
    """V303: on the ground with a free base for 3 s, tilt < 2 degrees, drift < 5 mm, penetration < 5 mm.

    Not applicable to categories that need not stand (`sim_export.physics.standing`: faucets, switches, doors,
    windows, and hand-held objects) if the centre of mass is outside of the support polygon or the object
    tilts, as one does that only seems to touch the floor on both sides; otherwise they are checked too. For
    other categories, the failure reports the overhang.
    """
    stand = run.stand
    falls = stand.overhang > 0.0 or not stand.tilt < STAND_TILT
    if falls and not must_stand(package.category):
        return make_result(
            "V303", "not_applicable", f"a {package.category} is mounted or held, and does not balance"
        )
    measured = (
        ("tilts", stand.tilt, STAND_TILT, "degrees"),
        ("drifts", stand.drift, STAND_DRIFT, "m"),
        ("sinks", stand.penetration, STAND_PENETRATION, "m"),
    )
    verb, value, threshold, unit = max(
        measured, key=lambda row: row[1] / row[2] if np.isfinite(row[1]) else np.inf
    )
    message = f"the object {verb} by {value:.3g} {unit}"
    if stand.overhang > 0.0:
        message += f"; its centre of mass lies {stand.overhang:.3g} m outside what touches the floor"
    return _result(
        "V303", fails=not value / threshold < 1.0, value=value, threshold=threshold, unit=unit,
        message=message,
    )  # fmt: skip


def check_opens(run: TrialResults) -> CheckResult:
    """V304: a constant pull opens every joint to 90 % of its range and on to its limit within 5 s, and a
    constant push closes it again, with the joints it requires open and all others at rest.

    The hand applies 30 N to drawers, 20 N m to doors (at most 30 N at the handle), 10 N to buttons and 1 N m
    to knobs, and additionally carries the weight that it lifts (`envs.hand`). Limits count as reached within
    1 % of the range, or 0.1 mm or 0.5 degrees if that is more. A joint without limits must turn once around
    and back.
    """
    joints = run.joints
    if not joints:
        return make_result("V304", "not_applicable", "nothing moves")
    gaps = [max(pull.open_gap, pull.close_gap) for pull in run.pulls]
    near = [limit_tolerance(joint) for joint in joints]
    ratios = np.array([gap / max(limit, 1e-12) for gap, limit in zip(gaps, near, strict=True)])
    at = int(np.argmax(ratios))
    joint, pull, plan = joints[at], run.pulls[at], run.plan.joints[at]
    unit = "N" if joint.type == "prismatic" else "N m"
    message = f"{joint.name} opens to {100 * pull.opened:.1f} % with {plan.opening:.3g} {unit}"
    if pull.open_gap <= near[at] < pull.close_gap:
        message += f" but does not close again with {plan.closing:.3g} {unit}"
    if ratios[at] > 1.0:
        message += "; look for collisions, a missing requires_open, or friction above the hand's force"
    return _result(
        "V304", fails=not ratios[at] <= 1.0, value=gaps[at], threshold=near[at],
        unit=f"{_unit(joint)} to the limit", where=joint.name, message=message,
    )  # fmt: skip


def check_stays_closed(run: TrialResults) -> CheckResult:
    """V305: tilted by 5 degrees in its opening direction, no joint opens by more than 1 % of its range, or
    0.1 mm or 0.5 degrees if that is more, in 2 s. Joints without limits (wheels, knobs) have no closed state
    and are skipped."""
    joints = run.joints
    limited = [index for index, joint in enumerate(joints) if joint.type != "continuous"]
    if not limited:
        return make_result("V305", "not_applicable", "no joint has limits")
    still = [limit_tolerance(joint) for joint in joints]
    worst = max(limited, key=lambda index: run.lean_drift[index] / still[index])
    fails = not run.lean_drift[worst] <= still[worst]
    message = f"{joints[worst].name} moved most"
    if fails:
        message = f"{joints[worst].name} opens by itself: its friction holds less than 8.7 % of its weight"
    return _result(
        "V305", fails=fails, value=float(run.lean_drift[worst]), threshold=still[worst],
        unit=_unit(joints[worst]), where=joints[worst].name, message=message,
    )  # fmt: skip


def check_energy(run: TrialResults) -> CheckResult:
    """V306: while opened and closed no joint moves faster than 1.5 times the speed that the work of hand and
    gravity allows, and the object's bounding box never grows beyond 10 times its size."""
    joints = run.joints
    if not joints:
        return make_result("V306", "not_applicable", "nothing moves")
    if not run.size_ratio <= SIZE_RATIO:
        return _result(
            "V306", fails=True, value=run.size_ratio, threshold=SIZE_RATIO, unit="times the box at rest",
            message="the object flies apart",
        )  # fmt: skip
    pairs = zip(run.pulls, run.plan.joints, strict=True)
    ratios = np.array([pull.peak_speed / max(plan.speed_limit, 1e-9) for pull, plan in pairs])
    at = int(np.argmax(ratios))
    return _result(
        "V306", fails=not ratios[at] <= 1.0, value=run.pulls[at].peak_speed,
        threshold=run.plan.joints[at].speed_limit, unit=f"{_unit(joints[at])}/s",
        where=joints[at].name, message=f"{joints[at].name} comes nearest to its bound",
    )  # fmt: skip


def check_repeat(folder: Path, package: SimPackage, first: TrialResults) -> CheckResult:
    """V307: all trials repeated in new scenes; every recorded coordinate agrees within 1e-6."""
    second = run_trials(folder, package, TIMESTEP)
    if first.trace.shape != second.trace.shape:
        return _result(
            "V307", fails=True, value=float(abs(len(first.trace) - len(second.trace))), threshold=0.0,
            unit="recorded values", message="the two runs took different numbers of steps",
        )  # fmt: skip
    both_nan = np.isnan(first.trace) & np.isnan(second.trace)
    difference = np.where(both_nan, 0.0, np.abs(first.trace - second.trace))
    worst = float(difference.max(initial=0.0))
    return _result(
        "V307", fails=not worst <= REPEAT, value=worst, threshold=REPEAT, unit="m or rad",
        message=f"{len(first.trace)} recorded values compared",
    )  # fmt: skip


def check_mujoco(folder: Path) -> CheckResult:
    """V308: MuJoCo compiles the URDF and the MJCF, and without gravity no constraint is active at rest (sum
    of absolute generalised constraint forces < 1e-3)."""
    results = compile_package(folder)
    for result in results:
        if result.error is not None:
            return _result("V308", fails=True, where=result.file, message=f"MuJoCo: {result.error}")
    worst = max(results, key=lambda result: result.force)
    said = [warning for result in results for warning in result.warnings]
    message = f"constraints push with {worst.force:.3g} at rest, allowed is {MUJOCO_FORCE:g}" + (
        f"; {len(said)} warnings: {said[0]}" if said else ""
    )
    return _result(
        "V308", fails=not worst.force < MUJOCO_FORCE, value=worst.force, threshold=MUJOCO_FORCE,
        unit="N and N m", where=worst.file, message=message,
    )  # fmt: skip


def check_timesteps(folder: Path, package: SimPackage) -> CheckResult:
    """V309: checks V302 to V306 pass at 1/60 s and 1/240 s too (they use 1/100 s)."""
    failures = []
    for timestep in OTHER_TIMESTEPS:
        run = run_trials(folder, package, timestep)
        failures += [
            f"{result.id} at 1/{round(1.0 / timestep)} s ({result.message})"
            for result in _single_checks(package, run)
            if result.verdict == "fail"
        ]
    return _result(
        "V309", fails=bool(failures), value=float(len(failures)), threshold=0.0, unit="failed checks",
        message="; ".join(failures) or f"passes at {len(OTHER_TIMESTEPS)} other time steps",
    )  # fmt: skip


def _unit(joint: Joint) -> str:
    return "m" if joint.type == "prismatic" else "rad"


def _result(check: str, *, fails: bool, message: str, **values: Any) -> CheckResult:
    return make_result(check, "fail" if fails else "pass", message, **values)


def _timed(check: Callable[[], CheckResult]) -> CheckResult:
    clock = time.perf_counter()
    result = check()
    return replace(result, seconds=time.perf_counter() - clock)


# mujoco is a compiled module with empty stubs.
# pyright: reportAttributeAccessIssue=false


@dataclass(frozen=True, kw_only=True)
class MujocoResult:
    """``force`` is the sum of absolute constraint forces at rest without gravity (N and N m together);
    ``error`` is the compiler's message if there is no model, ``warnings`` are its warnings."""

    file: str
    force: float
    error: str | None = None
    warnings: tuple[str, ...] = ()


def compile_package(folder: Path) -> tuple[MujocoResult, ...]:
    """Compiles ``mobility.urdf`` and, if it exists, ``mobility.mjcf.xml``."""
    results = [_compile(folder / "mobility.urdf")]
    if (folder / "mobility.mjcf.xml").is_file():
        results.append(_compile(folder / "mobility.mjcf.xml"))
    return tuple(results)


def _compile(path: Path) -> MujocoResult:
    import mujoco

    warnings: list[str] = []
    try:
        model = compile_model(path, warnings)
    except (ValueError, PackageError) as error:
        text = " ".join(str(error).split())
        return MujocoResult(file=path.name, force=np.inf, error=text, warnings=tuple(warnings))
    # Gravity and springs are off; the remaining forces come from overlaps and violated limits.
    model.opt.gravity[:] = 0.0
    model.jnt_stiffness[:] = 0.0
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    force = float(np.abs(data.qfrc_constraint).sum())
    return MujocoResult(file=path.name, force=force, warnings=tuple(warnings))
