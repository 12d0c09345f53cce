"""How many goals of scenes the scripted solver reaches, part by part.

Each goal is taken apart into motions of parts: open, close, and put a thing into a part that is open. A Panda
plays each on the object of the goal alone (`ArtiGen-OpenPart-v1`, `ArtiGen-PutInside-v1`), up to three times
with other seeds; a goal counts if all motions of one of its ways succeed, such as by either door of a
cabinet. To go somewhere, Fetch drives through the scene (`ArtiGen-Room-v1`). Picking up things in a scene is
not played: goals that only move things are counted apart.

    python benchmarks/goal_solvability.py out/scenes/scenes/* --count 200 --out out/goals

``motions.jsonl`` keeps what was played, so that the command goes on where it was stopped.
"""

import argparse
import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import gymnasium as gym
import numpy as np

import envs  # noqa: F401 (registers the tasks)
from artigen.errors import ArtigenError
from envs.goals.file import read_goals
from envs.goals.goal import Goal, ItemGoal
from envs.maniskill.checks import CPU
from envs.maniskill.solver.go import solve_go
from envs.maniskill.solver.solve import solve_open_part, solve_put_inside
from envs.rooms.file import read_room
from envs.rooms.footprints import cached_package
from envs.rooms.room import Room

SEEDS = 3
"""Number of tries of a motion."""


@dataclass(frozen=True)
class Motion:
    """What is done to a joint of a package, or a way through a scene to what words of a goal name."""

    verb: Literal["open", "close", "put", "go"]
    folder: Path
    target: str

    def __str__(self) -> str:
        return f"{self.verb} {self.folder} {self.target}"


def list_ways(goal: Goal, room: Room, scene: Path) -> list[list[Motion]]:
    """The ways to reach a goal, each the motions that it takes in order."""
    if goal.family == "go":
        return [[Motion("go", scene, goal.words)]]
    verb = "open" if goal.family in ("open", "pull") else "close"
    moved = [Motion(verb, room.placement(each.object).package, each.joint) for each in goal.joints]
    if not goal.items:
        return [moved]
    return [[*front, *moved] for front in _fronts(goal.items[0], room)]


def _fronts(item: ItemGoal, room: Room) -> list[list[Motion]]:
    """For the drawer of a goal, or else for each door: opening it, and putting a thing behind it."""
    folder = room.placement(item.object).package
    package = cached_package(folder)
    labels = {link.name: link.label for link in package.links}
    regions = {region.link for region in item.regions}
    moving = [joint for joint in package.joints if labels.get(joint.child) in ("door", "drawer")]
    fronts = [joint.name for joint in moving if joint.child in regions]
    fronts = fronts or [joint.name for joint in moving if labels[joint.child] == "door"]
    verbs: tuple[Literal["open", "put"], ...] = ("open", "put") if item.inside else ("open",)
    return [[Motion(verb, folder, name) for verb in verbs] for name in fronts]


def play(motion: Motion) -> str:
    """Plays a motion until it succeeds; "" then, else the last reason."""
    settings: dict[str, Any] = {
        "packages": str(motion.folder),
        "joint": motion.target,
        "control_mode": "pd_joint_pos",
        **CPU,
    }
    reason = ""
    for seed in range(SEEDS):
        try:
            if motion.verb == "go":
                env = gym.make(
                    "ArtiGen-Room-v1", scenes=motion.folder, goal=motion.target, robot_uids="fetch",
                    reward_mode="sparse", sim_backend="physx_cpu", render_backend="none",
                    control_mode="pd_joint_pos",
                )  # fmt: skip
                outcome = solve_go(env, seed)
            elif motion.verb == "put":
                env = gym.make("ArtiGen-PutInside-v1", **settings)
                outcome = solve_put_inside(env, seed)
            else:
                env = gym.make("ArtiGen-OpenPart-v1", goal=motion.verb, **settings)
                outcome = solve_open_part(env, seed)
            env.close()
        except ArtigenError as error:
            return str(error)
        if outcome.success:
            return ""
        reason = outcome.reason
    return reason


class Journal:
    """Motions that were played, with their reasons, in a file."""

    def __init__(self, path: Path) -> None:
        self.path = path
        lines = path.read_text().splitlines() if path.is_file() else []
        self.known: dict[str, str] = dict(json.loads(line) for line in lines)

    def play(self, motion: Motion) -> str:
        """The reason why a motion fails, "" if it succeeds; played once."""
        key = str(motion)
        if key not in self.known:
            self.known[key] = play(motion)
            with self.path.open("a") as file:
                file.write(json.dumps([key, self.known[key]]) + "\n")
        return self.known[key]


def try_goal(goal: Goal, room: Room, scene: Path, journal: Journal) -> str:
    """Why no way to a goal succeeds; "" if one does."""
    reasons = []
    for way in list_ways(goal, room, scene):
        failed = next((motion for motion in way if journal.play(motion)), None)
        if failed is None:
            return ""
        reasons.append(f"{failed.verb} {failed.folder.name} {failed.target}: {journal.play(failed)}")
    return "; or ".join(reasons) or "nothing opens"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="+", type=Path)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--out", type=Path, default=Path("out/goals"))
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    journal = Journal(args.out / "motions.jsonl")
    pairs = [(path, read_room(path), goal) for path in args.scenes for goal in read_goals(path)]
    order = np.random.default_rng(0).permutation(len(pairs))[: args.count]
    tried: Counter[str] = Counter()
    solved: Counter[str] = Counter()
    still = 0
    for path, room, goal in (pairs[index] for index in order):
        if goal.family in ("put_on", "pick"):
            still += 1
            continue
        reason = try_goal(goal, room, path, journal)
        tried[goal.family] += 1
        solved[goal.family] += not reason
        print(f"{goal.words}: {reason or 'solved'}", flush=True)
    for family in tried:
        print(f"{family}: {solved[family]} of {tried[family]}")
    print(f"all: {solved.total()} of {tried.total()}; {still} goals move things only")


if __name__ == "__main__":
    main()
