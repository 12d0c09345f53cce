"""Checks L4: a package in ManiSkill tasks (V401 opening, V402 the stock task, V404 a cube inside).

The robot is a Panda with a simple scripted solver. V401 therefore requires one part that it can open and
lists the others: a handle out of its reach is no fault of the object.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

import gymnasium as gym
import torch
from mani_skill.utils.structs import Pose

from artigen.errors import ArtigenError
from sim_export.report import CheckResult

from ..titles import make_result
from .containers import room_when_open
from .objects import TaskObject, TaskPart, read_object
from .solver.solve import solve_open_part

CPU: dict[str, Any] = {
    "sim_backend": "physx_cpu", "render_backend": "none", "obs_mode": "state", "validation": "any",
}  # fmt: skip
OPENED = 0.9
CUBE = 0.04
DROP = 0.03
DROP_STEPS = 30
SEED = 0
STOCK_TYPES = (
    ("ArtiGen-OpenCabinetDrawer-v1", ("prismatic",)),
    ("ArtiGen-OpenCabinetDoor-v1", ("revolute",)),
)


def check_tasks(folder: Path) -> tuple[CheckResult, ...]:
    """V401, V402 and V404 of one package."""
    entry = read_object(folder, "any", "optional")
    checks: tuple[tuple[str, Callable[[Path, TaskObject], CheckResult]], ...] = (
        ("V401", _check_opening),
        ("V402", _check_stock),
        ("V404", _check_inside),
    )
    return tuple(_timed(check, function, folder, entry) for check, function in checks)


def _timed(
    check: str, function: Callable[[Path, TaskObject], CheckResult], folder: Path, entry: TaskObject
) -> CheckResult:
    begin = perf_counter()
    try:
        result = function(folder, entry)
    except ArtigenError as error:
        result = make_result(check, "fail", f"cannot be judged: {error}")
    return replace(result, seconds=perf_counter() - begin)


def _check_opening(folder: Path, entry: TaskObject) -> CheckResult:
    held = [part for part in entry.parts if part.handle is not None]
    if not held:
        return make_result("V401", "not_applicable", "no drawer or door has a handle")
    failed: list[tuple[str, str]] = []
    for part in held:
        env = gym.make(
            "ArtiGen-OpenPart-v1", packages=str(folder), joint=part.joint.name, handles="required",
            control_mode="pd_joint_pos", **CPU,
        )  # fmt: skip
        outcome = solve_open_part(env, SEED)
        env.close()
        if not outcome.success:
            failed.append((part.joint.name, outcome.reason))
    opened = len(held) - len(failed)
    others = "".join(f"; {name}: {reason}" for name, reason in failed)
    return make_result(
        "V401", "pass" if opened else "fail",
        f"a Panda opens {opened} of {len(held)} drawers and doors by their handles{others}",
        value=float(opened), threshold=1.0, unit="parts", where=failed[0][0] if failed else "",
    )  # fmt: skip


def _check_stock(folder: Path, entry: TaskObject) -> CheckResult:
    held = [part for part in entry.parts if part.handle is not None]
    kinds = [name for name, types in STOCK_TYPES if any(part.joint.type in types for part in held)]
    if not kinds:
        return make_result("V402", "not_applicable", "no drawer or door has a handle")
    problems = [(name, problem) for name in kinds if (problem := _stock_problem(folder, name))]
    where, message = "", f"{' and '.join(kinds)}: resets, steps, succeeds when open"
    if problems:
        where, message = problems[0]
    return make_result(
        "V402", "fail" if problems else "pass", message,
        value=float(len(problems)), threshold=0.0, unit="tasks", where=where,
    )  # fmt: skip


def _stock_problem(folder: Path, name: str) -> str:
    """Problem of ManiSkill's own task with the package, or ""."""
    env = gym.make(name, packages=str(folder), robot_uids="fetch", **CPU)
    task: Any = env.unwrapped
    env.action_space.seed(SEED)
    observation, info = env.reset(seed=SEED)
    if bool(info["success"].any()):
        return "the closed cabinet counts as open"
    for _ in range(5):
        observation, reward, *_ = env.step(env.action_space.sample())
        if not bool(torch.isfinite(observation).all() & torch.isfinite(torch.as_tensor(reward)).all()):
            return "an observation or a reward is not finite"
    qpos = task.cabinet.get_qlimits()[..., 1]
    task.cabinet.set_qpos(qpos)
    task.cabinet.set_qvel(torch.zeros_like(qpos))
    opened = bool(task.evaluate()["success"].all())
    env.close()
    return "" if opened else "the open cabinet does not count as open"


def _check_inside(folder: Path, entry: TaskObject) -> CheckResult:
    roomy = [part for part in entry.parts if room_when_open(entry, part, OPENED, CUBE) is not None]
    if not roomy:
        return make_result("V404", "not_applicable", "no drawer or compartment has room")
    lost = [part.joint.name for part in roomy if not _stays(folder, part)]
    kept = len(roomy) - len(lost)
    return make_result(
        "V404", "fail" if lost else "pass",
        f"a cube of {100 * CUBE:.0f} cm comes to rest inside {kept} of {len(roomy)} parts",
        value=float(len(lost)), threshold=0.0, unit="parts", where=lost[0] if lost else "",
    )  # fmt: skip


def _stays(folder: Path, part: TaskPart) -> bool:
    """Whether a cube released above the aim lies still inside after a second and a half."""
    env = gym.make(
        "ArtiGen-PutInside-v1", packages=str(folder), joint=part.joint.name, initial_open=OPENED, **CPU
    )
    env.reset(seed=SEED)
    task: Any = env.unwrapped
    above = task.aims[0] + torch.tensor([0.0, 0.0, CUBE / 2.0 + DROP])
    task.cube.set_pose(Pose.create_from_pq(above[None]))
    info: dict[str, Any] = {}
    for _ in range(DROP_STEPS):
        _, _, _, _, info = env.step(None)  # type: ignore[arg-type]
    env.close()
    return bool(info["inside"][0] & info["cube_still"][0])
