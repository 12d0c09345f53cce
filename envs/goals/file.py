"""goals.json: the goals of a room, beside its scene.json."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from artigen.errors import ArtigenError, explain
from artigen.io import write_whole

from .goal import BaseGoal, Goal, ItemGoal, JointGoal, LiftGoal, Region

GOALS_FILE = "goals.json"
FORMAT, VERSION = "artigen-goals", 2


class GoalFileError(ArtigenError):
    """A goals.json cannot be read; the message names the file and the problem."""


def write_goals(goals: tuple[Goal, ...], folder: Path) -> Path:
    """Writes goals.json into a folder and returns its path."""
    value = {"format": FORMAT, "version": VERSION, "goals": [asdict(goal) for goal in goals]}
    return write_whole(folder / GOALS_FILE, json.dumps(value, indent=1) + "\n")


def read_goals(path: Path) -> tuple[Goal, ...]:
    """Reads the goals of a file, or of the folder that contains it.

    Raises:
        GoalFileError: If the file is missing or has another structure.
    """
    path = path / GOALS_FILE if path.is_dir() else path
    try:
        value = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise GoalFileError(f"{path}: cannot be read ({explain(error)})") from error
    try:
        if (value["format"], value["version"]) != (FORMAT, VERSION):
            raise GoalFileError(f"{path}: not goals of format {FORMAT} version {VERSION}")
        return tuple(_goal(entry) for entry in value["goals"])
    except (KeyError, TypeError, AttributeError) as error:
        raise GoalFileError(f"{path}: does not have the expected structure ({error!r})") from error


def _goal(entry: dict[str, Any]) -> Goal:
    return Goal(
        words=entry["words"],
        family=entry["family"],
        joints=tuple(JointGoal(**each) for each in entry["joints"]),
        items=tuple(_item(each) for each in entry["items"]),
        lifts=tuple(LiftGoal(**each) for each in entry["lifts"]),
        bases=tuple(
            BaseGoal(places=tuple((float(x), float(y)) for x, y in each["places"]), reach=each["reach"])
            for each in entry["bases"]
        ),
        start=tuple((name, joint, float(q)) for name, joint, q in entry["start"]),
    )


def _item(entry: dict[str, Any]) -> ItemGoal:
    regions = tuple(
        Region(link=each["link"], low=tuple(each["low"]), high=tuple(each["high"]))
        for each in entry["regions"]
    )
    return ItemGoal(**{**entry, "regions": regions})
