"""Runs the trials of a plan in any engine that implements the `Engine` protocol.

Runs in any environment that has the engine, so it imports only numpy and the standard library. A runner is
started as ``python run_NAME.py PLAN.json`` and prints one JSON object; output of the engine itself goes to
the standard error.
"""

import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Protocol, TypedDict

import numpy as np

STALL_SECONDS = 0.5
"""Duration (seconds) below `STALL_SPEED` of its speed after which a joint is no longer pushed."""
STALL_SPEED = 1e-3
PRESS_SECONDS = 0.25
"""Duration (seconds) for which a joint is pressed against the end of its range."""
BISECTIONS = 10
"""Bisection steps, starting from twice the friction, for the effort at which a joint starts to move."""


class LinkFacts(TypedDict):
    """A link as reported by the engine; ``None`` for values that it does not report."""

    mass: float | None
    shapes: int | None


class JointFacts(TypedDict):
    """A joint as reported by the engine; ``None`` for values that it does not report, or without limits."""

    lower: float | None
    upper: float | None
    friction: float | None
    damping: float | None


def joint_facts(
    limits: tuple[float, float] | None, friction: float | None, damping: float | None
) -> JointFacts:
    """The facts of a joint; ``limits`` are lower and upper, None without."""
    lower, upper = limits or (None, None)
    return {"lower": lower, "upper": upper, "friction": friction, "damping": damping}


class Engine(Protocol):
    """A package in an engine, with its root fixed to the world."""

    version: str

    lost: dict[str, str]
    """Content of the file that the engine is known to ignore (``root``, ``mimic``), and why."""

    def links(self) -> dict[str, LinkFacts]: ...

    def joints(self) -> dict[str, JointFacts]: ...

    def reset(self, qpos: dict[str, float], gravity: float) -> None:
        """Poses all joints, at rest; joints that are not named are at 0."""
        ...

    def step(self, efforts: dict[str, float]) -> None:
        """One time step with efforts (N or N m) on joints."""
        ...

    def positions(self) -> dict[str, float]: ...


def run(make: Callable[[dict], Engine]) -> None:
    """Reads the plan named on the command line, runs it, and prints the result."""
    plan = json.loads(Path(sys.argv[1]).read_text())
    answer = os.dup(1)
    os.dup2(2, 1)
    try:
        result = play(make(plan), plan)
    except ModuleNotFoundError as error:
        result = {"missing": error.name or str(error)}
    except Exception as error:  # boundary of the process
        result = {"error": f"{type(error).__name__}: {' '.join(str(error).split())}"}
    os.write(answer, json.dumps(result).encode())


def play(engine: Engine, plan: dict) -> dict:
    """All trials of a plan."""
    result = {
        "version": engine.version,
        "lost": engine.lost,
        "links": engine.links(),
        "joints": engine.joints(),
        "rest": rest(engine, plan),
    }
    there = set(engine.positions())
    tried = [joint for joint in plan["joints"] if joint["mimic"] is None and joint["name"] in there]
    result["range"] = {joint["name"]: through_range(engine, plan, joint) for joint in tried}
    rubbing = [joint for joint in tried if joint["trial"] is not None]
    result["friction"] = {joint["name"]: friction(engine, plan, joint) for joint in rubbing}
    if plan.get("bisect"):
        result["holds"] = {joint["name"]: bisect(engine, plan, joint) for joint in rubbing}
    return result


def followed(joint: dict, q: float) -> float:
    """Coordinate of a follower where that of its leader is ``q``."""
    return joint["multiplier"] * q + joint["offset"]


def closed(plan: dict) -> dict[str, float]:
    """Rest coordinates: 0, or the nearest value within a joint's limits; followers follow."""
    qpos = {joint["name"]: min(max(0.0, joint["lower"]), joint["upper"]) for joint in plan["joints"]}
    followers = [joint for joint in plan["joints"] if joint["mimic"] is not None]
    return qpos | {joint["name"]: followed(joint, qpos.get(joint["mimic"], 0.0)) for joint in followers}


def rest(engine: Engine, plan: dict) -> dict:
    """Under gravity without actions: number of finite steps, and largest motion of each joint."""
    engine.reset(closed(plan), 9.81)
    start = engine.positions()
    worst = dict.fromkeys(start, 0.0)
    for step in range(plan["steps"]):
        engine.step({})
        now = engine.positions()
        if not all(np.isfinite(value) for value in now.values()):
            return {"steps": step, "drift": dict.fromkeys(start, float("inf"))}
        worst = {name: max(worst[name], abs(now[name] - start[name])) for name in now}
    return {"steps": plan["steps"], "drift": worst}


def pose(plan: dict, joint: dict, value: float) -> dict[str, float]:
    """One joint at a value, with its required joints open."""
    qpos = closed(plan) | joint["open"] | {joint["name"]: value}
    for other in plan["joints"]:
        if other["mimic"] is not None:
            qpos[other["name"]] = followed(other, qpos[other["mimic"]])
    return qpos


def through_range(engine: Engine, plan: dict, joint: dict) -> dict:
    """Pushes a joint open and closed without gravity; remaining distance to each end, and errors of its
    followers."""
    engine.reset(pose(plan, joint, joint["lower"]), 0.0)
    open_gap = push(engine, plan, joint, 1.0)
    now = engine.positions()
    follow = {
        other["name"]: abs(now[other["name"]] - followed(other, now[joint["name"]]))
        for other in plan["joints"]
        if other["mimic"] == joint["name"] and other["name"] in now
    }
    return {"open_gap": open_gap, "close_gap": push(engine, plan, joint, -1.0), "follow": follow}


def push(engine: Engine, plan: dict, joint: dict, direction: float) -> float:
    """Distance to the end of the range after a push in that direction; a joint without limits is released
    there."""
    name, dt = joint["name"], plan["timestep"]
    target = joint["upper"] if direction > 0.0 else joint["lower"]
    before = engine.positions()[name]
    speed, still, pressed = 0.0, 0, 0
    for _ in range(round(plan["drive_seconds"] / dt)):
        pushing = direction * speed < joint["speed"]
        engine.step({name: direction * joint["effort"]} if pushing else {})
        now = engine.positions()[name]
        if not np.isfinite(now):
            return float("inf")
        speed, before = (now - before) / dt, now
        gap = direction * (target - now)
        if gap <= joint["tolerance"]:
            if joint["type"] == "continuous":
                return max(gap, 0.0)
            pressed += 1
            if pressed * dt >= PRESS_SECONDS:
                break
        still = 0 if abs(speed) > STALL_SPEED * joint["speed"] else still + 1
        if not pressed and still * dt > STALL_SECONDS:
            break
    return abs(target - before)


def friction(engine: Engine, plan: dict, joint: dict) -> dict[str, float]:
    """Motion of a joint under slightly less and slightly more than its friction, as shares of the motion
    expected under the latter."""
    trial = joint["trial"]
    return {
        key: slide(engine, plan, joint, trial[key], trial["seconds"]) / trial["expected"]
        for key in ("held", "slipped")
    }


def slide(engine: Engine, plan: dict, joint: dict, effort: float, seconds: float) -> float:
    """Motion under a constant effort from the start of the friction trial, without gravity."""
    name = joint["name"]
    engine.reset(pose(plan, joint, joint["trial"]["start"]), 0.0)
    start = engine.positions()[name]
    for _ in range(max(1, round(seconds / plan["timestep"]))):
        engine.step({name: effort})
    return engine.positions()[name] - start


def bisect(engine: Engine, plan: dict, joint: dict) -> float:
    """Smallest effort that moves a joint by a tenth of the motion expected above its friction, relative to
    that friction."""
    low, high = 0.0, 2.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        moved = slide(engine, plan, joint, middle * joint["friction"], joint["trial"]["seconds"])
        # Far above its friction a knob turns more than once, and engines may wrap its angle.
        if abs(moved) > 0.1 * joint["trial"]["expected"]:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)
