"""Measures the ManiSkill tasks over many packages: resets, steps, success and speed.

Writes one JSON line per episode, so that an interrupted run goes on where it stopped, and prints the
tables as Markdown.
"""

import gc
import json
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import gymnasium as gym
import numpy as np
import torch
import tyro

import envs  # noqa: F401  registers the tasks
from envs.maniskill.objects import REPORT_FILE, TaskError, TaskPart, find_packages, read_object
from envs.maniskill.solver.solve import solve_open_part, solve_put_inside
from envs.maniskill.verbs import VERBS, Verb
from envs.registration import VERB_TASKS
from sim_export.report import report_from_json

OPEN, PUT, STOCK = "ArtiGen-OpenPart-v1", "ArtiGen-PutInside-v1", "ArtiGen-OpenCabinetDrawer-v1"
TASK_OF = {"open": OPEN} | {verb: name for name, verb in VERB_TASKS.items()}
TASKS = {"open": OPEN, "put": PUT, "stock-drawer": STOCK, "stock-door": "ArtiGen-OpenCabinetDoor-v1"}
CPU: dict[str, Any] = {"sim_backend": "physx_cpu", "render_backend": "none", "obs_mode": "state"}

TURNS: tuple[tuple[str, dict[str, Any]], ...] = ((OPEN, {"part": "drawer"}), (STOCK, {}))


@dataclass(frozen=True, kw_only=True)
class Config:
    """Command-line options."""

    packages: Path
    """Folder of packages; those without a passed validation are left out, and counted."""

    out: Path
    """File of JSON lines, one per episode."""

    what: Literal["steps", "open", "put", "verbs", "speed", "table"] = "table"
    """``steps``: resets and random actions. ``open``, ``put``: the scripted solvers. ``verbs``: the solver on
    every part, with the verb that it is for. ``speed``: steps per second beside ManiSkill's own task.
    ``table``: only prints."""

    robot: Literal["panda", "fetch"] = "panda"
    """Who does it; ManiSkill's own tasks have Fetch only."""

    task: Literal["open", "put", "stock-drawer", "stock-door"] = "open"
    """Which task ``steps`` is about."""

    count: int = 100
    """Packages, taken evenly over the categories."""

    seeds: int = 5
    """Episodes per package."""

    alike: int = 2
    """``verbs``: parts of one label and verb that are tried on each object; a panel may have twelve keys."""

    graspable: bool = False
    """``verbs``: only parts that have a handle or are knobs, and of these the first one for each verb."""

    steps: int = 200
    """Random actions per episode, or of the speed run."""


def passed(folder: Path) -> bool:
    """Whether the package has a passed validation."""
    report = folder / REPORT_FILE
    return report.is_file() and report_from_json(report.read_text()).passed


def evenly(folders: list[Path], count: int) -> list[Path]:
    """The first folders, category by category in turn."""
    groups: dict[str, list[Path]] = {}
    for folder in folders:
        groups.setdefault(category_of(folder), []).append(folder)
    turns = max(len(group) for group in groups.values())
    mixed = [group[k] for k in range(turns) for group in groups.values() if k < len(group)]
    return mixed[:count]


def category_of(folder: Path) -> str:
    """The category in a package's ``meta.json``."""
    return json.loads((folder / "meta.json").read_text())["model_cat"]


def random_steps(cfg: Config, folder: Path) -> Iterator[dict]:
    """Resets and random actions: finite observations and rewards?"""
    env = gym.make(TASKS[cfg.task], packages=str(folder), robot_uids=cfg.robot, **CPU)
    env.action_space.seed(0)
    for seed in range(cfg.seeds):
        begin = time.perf_counter()
        observation, _ = env.reset(seed=seed)
        middle = time.perf_counter()
        finite = bool(torch.isfinite(torch.as_tensor(observation)).all())
        for _ in range(cfg.steps):
            observation, reward, *_ = env.step(env.action_space.sample())
            finite &= bool(torch.isfinite(torch.as_tensor(observation)).all())
            finite &= bool(np.isfinite(float(reward)))
        yield {
            "seed": seed,
            "task": cfg.task,
            "good": finite,
            "reset": middle - begin,
            "step": (time.perf_counter() - middle) / cfg.steps,
        }
    env.close()


def solve(cfg: Config, folder: Path) -> Iterator[dict]:
    """The scripted solver."""
    name, solver = (OPEN, solve_open_part) if cfg.what == "open" else (PUT, solve_put_inside)
    handles: dict[str, Any] = {"handles": "required"} if cfg.what == "open" else {}
    env = gym.make(
        name, packages=str(folder), robot_uids=cfg.robot, control_mode="pd_joint_pos", **handles, **CPU
    )
    for seed in range(cfg.seeds):
        outcome = solver(env, seed)
        task: Any = env.unwrapped
        part = task.drawn[0][1]
        yield {
            "seed": seed,
            "kind": part.kind,
            "joint": part.joint.name,
            "good": outcome.success,
            "steps": outcome.steps,
            "opened": outcome.open_fraction,
            "reason": outcome.reason,
        }
    env.close()


def parts_to_try(cfg: Config, folder: Path) -> list[tuple[Verb, TaskPart]]:
    """Parts with what is done to them: drawers and doors are opened, the others go by their motion."""
    found: list[tuple[Verb, TaskPart]] = []
    for verb in VERBS:
        parts = list(read_object(folder, "any", "optional", verb).parts)
        if verb != "open":
            parts = [part for part in parts if part.kind not in ("drawer", "door")]
        if cfg.graspable:
            parts = [part for part in parts if part.handle is not None or part.kind == "knob"][:1]
        for kind in sorted({part.kind for part in parts}):
            found.extend((verb, part) for part in [p for p in parts if p.kind == kind][: cfg.alike])
    return found


def try_verbs(cfg: Config, folder: Path) -> Iterator[dict]:
    """The scripted solver on every part that moves."""
    for verb, part in parts_to_try(cfg, folder):
        env = gym.make(
            TASK_OF[verb], packages=str(folder), joint=part.joint.name, robot_uids=cfg.robot,
            control_mode="pd_joint_pos", **CPU,
        )  # fmt: skip
        begin = time.perf_counter()
        outcome = solve_open_part(env, 0)
        env.close()
        yield {
            "verb": verb,
            "kind": part.kind,
            "joint": part.joint.name,
            "handle": part.handle is not None,
            "latches": len(part.latches),
            "good": outcome.success,
            "steps": outcome.steps,
            "opened": outcome.open_fraction,
            "reason": outcome.reason,
            "seconds": time.perf_counter() - begin,
        }


def run(cfg: Config) -> None:
    """Every package that is not in the file yet."""
    done = {(row["what"], row["package"], row["robot"], row.get("task")) for row in read(cfg.out)}
    folders = [folder for folder in find_packages(cfg.packages) if passed(folder)]
    with cfg.out.open("a") as file:
        for folder in evenly(folders, cfg.count):
            task = cfg.task if cfg.what == "steps" else None
            if (cfg.what, folder.name, cfg.robot, task) in done:
                continue
            head = {"what": cfg.what, "package": folder.name, "robot": cfg.robot}
            head["category"] = category_of(folder)
            try:
                play = {"steps": random_steps, "verbs": try_verbs}.get(cfg.what, solve)
                rows = list(play(cfg, folder))
            except TaskError as error:
                rows = [{"task": task, "left_out": str(error)}]
            for row in rows:
                file.write(json.dumps(head | row) + "\n")
            file.flush()


def speed(cfg: Config) -> None:
    """Alternating runs of one process: our task and ManiSkill's, same object, same robot."""
    folder = next(
        folder
        for folder in find_packages(cfg.packages)
        if passed(folder) and category_of(folder) == "StorageFurniture"
    )
    with cfg.out.open("a") as file:
        for turn in range(3):
            for name, extra in TURNS:
                env = gym.make(name, packages=str(folder), robot_uids="fetch", **extra, **CPU)
                env.reset(seed=0)
                actions = [env.action_space.sample() for _ in range(cfg.steps)]
                begin = time.perf_counter()
                for action in actions:
                    env.step(action)
                rate = cfg.steps / (time.perf_counter() - begin)
                row = {"what": "speed", "package": folder.name, "robot": "fetch", "task": name}
                file.write(json.dumps(row | {"turn": turn, "rate": rate}) + "\n")
                env.close()


def read(path: Path) -> list[dict]:
    """All rows measured so far."""
    return [json.loads(line) for line in path.read_text().splitlines()] if path.is_file() else []


def table(rows: list[dict]) -> str:
    """Markdown: one table per measurement."""
    lines: list[str] = []
    for what, robot, task in sorted({(r["what"], r["robot"], r.get("task") or "") for r in rows}):
        mine = [r for r in rows if (r["what"], r["robot"], r.get("task") or "") == (what, robot, task)]
        if what == "verbs":
            lines += [verb_table(mine), ""]
            continue
        if what == "speed":
            rates = ", ".join(f"{r['rate']:.0f}" for r in mine)
            lines += [f"speed, {task}, {robot}: {rates} steps/s", ""]
            continue
        lines += [
            f"{what} {task} {robot}",
            "",
            "| category | packages | episodes | good |",
            "|---|---|---|---|",
        ]
        played = [r for r in mine if "good" in r]
        for category in [*sorted({r["category"] for r in played}), "all"]:
            some = [r for r in played if category in ("all", r["category"])]
            good = sum(r["good"] for r in some)
            lines.append(
                f"| {category} | {len({r['package'] for r in some})} | {len(some)} "
                f"| {good} ({100 * good / len(some):.0f} %) |"
            )
        lines += ["", f"{len(mine) - len(played)} packages left out: no part that the task can use", ""]
        if what == "steps":
            reset, step = (np.median([r[key] for r in played]) for key in ("reset", "step"))
            lines += [f"median reset {reset:.2f} s, {1.0 / step:.0f} steps/s", ""]
    return "\n".join(lines)


def verb_table(rows: list[dict]) -> str:
    """Objects, and parts that were moved, by category and verb."""
    lines = [f"| category | objects | {' | '.join(VERBS)} | all |", "|---" * (len(VERBS) + 3) + "|"]
    for category in [*sorted({row["category"] for row in rows}), "all"]:
        some = [row for row in rows if category in ("all", row["category"]) and "good" in row]
        cells = [
            f"{sum(row['good'] for row in mine)} of {len(mine)}" if mine else ""
            for mine in [[row for row in some if row["verb"] == verb] for verb in VERBS]
        ]
        share = 100 * sum(row["good"] for row in some) / max(1, len(some))
        objects = len({row["package"] for row in some})
        lines.append(f"| {category} | {objects} | {' | '.join(cells)} | {share:.0f} % |")
    return "\n".join(lines)


def main(cfg: Config) -> None:
    """Measures what is asked for and prints all that has been measured."""
    gc.freeze()  # ManiSkill collects garbage at every reset; what has been imported need not be looked at
    if cfg.what == "speed":
        speed(cfg)
    elif cfg.what != "table":
        run(cfg)
    print(table(read(cfg.out)))


if __name__ == "__main__":
    main(tyro.cli(Config))
