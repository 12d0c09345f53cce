"""How many goals of scenes the scripted solver reaches, part by part.

Each goal is taken apart into motions of parts: open, close, and put a thing into a part that is open. A Panda
plays each on the object of the goal alone (`ArtiGen-OpenPart-v1`, `ArtiGen-PutInside-v1`); a goal counts if
all its motions succeed. Scenes are checked for a place before every part; driving there and picking up things
in a scene is not played. Goals that need nothing but that are counted apart.

    python benchmarks/goal_solvability.py out/scenes/scenes/* --count 40
"""

import argparse
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from time import process_time
from typing import Any, Literal

import gymnasium as gym

import envs  # noqa: F401 (registers the tasks)
from artigen.errors import ArtigenError
from envs.goals.file import read_goals
from envs.goals.goal import Goal
from envs.maniskill.checks import CPU
from envs.maniskill.solver.solve import solve_open_part, solve_put_inside
from envs.rooms.file import read_room
from envs.rooms.footprints import cached_package
from envs.rooms.room import Room


@dataclass(frozen=True)
class Motion:
    """What is done to a joint of a package."""

    verb: Literal["open", "close", "put"]
    package: Path
    joint: str


def list_motions(goal: Goal, room: Room) -> list[Motion]:
    """The motions of parts that a goal takes, in order; none where only things are moved."""
    shut = [(room.placement(each.object), each.joint) for each in goal.joints]
    if goal.family in ("open", "pull"):
        return [Motion("open", placement.package, joint) for placement, joint in shut]
    closing = [Motion("close", placement.package, joint) for placement, joint in shut]
    fronts: list[Motion] = []
    for each in goal.items[:1]:
        placement = room.placement(each.object)
        package = cached_package(placement.package)
        labels = {link.name: link.label for link in package.links}
        links = {region.link for region in each.regions}
        moving = [joint for joint in package.joints if labels.get(joint.child) in ("door", "drawer")]
        joint = next((joint for joint in moving if joint.child in links), None)
        joint = joint or next((joint for joint in moving if labels[joint.child] == "door"), None)
        if joint is not None and goal.family != "put_on":
            fronts.append(Motion("open", placement.package, joint.name))
            if each.inside:
                fronts.append(Motion("put", placement.package, joint.name))
    return fronts + closing


def play(motion: Motion) -> str:
    """Plays a motion once; "" on success, else the reason."""
    settings: dict[str, Any] = {"packages": str(motion.package), "joint": motion.joint, **CPU}
    try:
        if motion.verb == "put":
            env = gym.make("ArtiGen-PutInside-v1", control_mode="pd_joint_pos", **settings)
            outcome = solve_put_inside(env, 0)
        else:
            env = gym.make("ArtiGen-OpenPart-v1", goal=motion.verb, control_mode="pd_joint_pos", **settings)
            outcome = solve_open_part(env, 0)
        env.close()
    except ArtigenError as error:
        return str(error)
    return outcome.reason if not outcome.success else ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="+", type=Path)
    parser.add_argument("--count", type=int, default=40)
    args = parser.parse_args()
    pairs = [(read_room(path), goal) for path in args.scenes for goal in read_goals(path)]
    step = max(1, len(pairs) // args.count)
    known: dict[Motion, str] = {}
    tried: Counter[str] = Counter()
    solved: Counter[str] = Counter()
    still = 0
    for room, goal in pairs[::step][: args.count]:
        motions = list_motions(goal, room)
        if not motions:
            still += 1
            continue
        begin = process_time()
        for motion in motions:
            if motion not in known:
                known[motion] = play(motion)
        reasons = [f"{motion.verb} {motion.joint}: {known[motion]}" for motion in motions if known[motion]]
        tried[goal.family] += 1
        solved[goal.family] += not reasons
        said = "; ".join(reasons) or "solved"
        sys.stdout.write(f"{goal.words}: {said} ({process_time() - begin:.0f} s)\n")
        sys.stdout.flush()
    for family in tried:
        sys.stdout.write(f"{family}: {solved[family]} of {tried[family]}\n")
    sys.stdout.write(f"all: {solved.total()} of {tried.total()}; {still} goals move things only\n")


if __name__ == "__main__":
    main()
