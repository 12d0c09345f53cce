"""scene.json: a room on disk, with paths to its packages relative to the file's own folder."""

import json
import os
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from artigen.errors import ArtigenError, explain
from artigen.io import write_whole

from .room import Fixture, Item, Opening, Placement, Room, Zone

FORMAT = "artigen-scene"
VERSION = 1
SCENE_FILE = "scene.json"


class SceneFileError(ArtigenError):
    """A scene.json cannot be read or written; the message names the file and the problem."""


def room_json(room: Room, folder: Path) -> str:
    """The text of scene.json for a room whose file is in ``folder``; equal rooms give equal text."""
    value = asdict(room)
    for placement in value["placements"]:
        path = os.path.relpath(placement["package"].resolve(), folder.resolve())
        placement["package"] = Path(path).as_posix()
        placement["joints"] = dict(placement["joints"])
        placement["provenance"] = dict(placement["provenance"])
    value["provenance"] = dict(value["provenance"])
    for key in ("contents", "openings", "zones"):
        if not value[key]:
            del value[key]
    head = {"format": FORMAT, "version": VERSION, "frame": "corner of the floor, z up, metres, wxyz"}
    return json.dumps(head | value, indent=1) + "\n"


def write_room(room: Room, folder: Path) -> Path:
    """Writes scene.json into a folder atomically, creating the folder if needed; returns the path.

    Raises:
        SceneFileError: If the folder cannot be written.
    """
    path = folder / SCENE_FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_whole(path, room_json(room, folder))
    except OSError as err:
        raise SceneFileError(f"{path}: cannot be written ({err.strerror or err})") from err
    return path


def read_room(path: Path | str) -> Room:
    """Reads a room from scene.json, or from the folder that contains it.

    Raises:
        SceneFileError: If the file is missing, has another version or structure, or names a missing package.
    """
    path = Path(path)
    path = path / SCENE_FILE if path.is_dir() else path
    try:
        value = json.loads(path.read_text())
    except (OSError, ValueError) as err:
        raise SceneFileError(f"{path}: cannot be read ({explain(err)})") from err
    if not isinstance(value, dict) or value.get("format") != FORMAT or value.get("version") != VERSION:
        raise SceneFileError(f"{path}: not a scene of format {FORMAT} version {VERSION}")
    try:
        for key in ("format", "version", "frame"):
            value.pop(key)
        placements = tuple(_placement(entry, path.parent) for entry in value.pop("placements"))
        fixtures = tuple(
            Fixture(**{**entry, **{key: tuple(entry[key]) for key in ("low", "high", "color")}})
            for entry in value.pop("fixtures")
        )
        room = Room(
            placements=placements,
            fixtures=fixtures,
            entrance=Opening(**value.pop("entrance")),
            openings=tuple(Opening(**entry) for entry in value.pop("openings", ())),
            size=tuple(value.pop("size")),
            contents=tuple(_item(entry) for entry in value.pop("contents", ())),
            zones=tuple(
                Zone(**{**entry, "low": tuple(entry["low"]), "high": tuple(entry["high"])})
                for entry in value.pop("zones", ())
            ),
            provenance=_provenance(value.pop("provenance"), "the room"),
            **value,
        )
    except (KeyError, TypeError, AttributeError, ValueError) as err:
        raise SceneFileError(f"{path}: does not have the expected structure ({err!r})") from err
    missing = [
        placement for placement in room.placements if not (placement.package / "mobility.urdf").is_file()
    ]
    known = {placement.id for placement in room.placements}
    lost = [item for item in room.contents if item.holder is not None and item.holder not in known]
    if lost:
        raise SceneFileError(f"{path}: {lost[0].id} lies in {lost[0].holder!r}, which is not in the room")
    if missing:
        raise SceneFileError(
            f"{path}: {len(missing)} of {len(room.placements)} packages are missing, "
            f"{missing[0].package} of {missing[0].id} is the first"
        )
    return room


def _item(entry: dict[str, Any]) -> Item:
    lists: dict[str, Any] = {key: tuple(entry[key]) for key in ("position", "quat", "size")}
    return Item(**{**entry, **lists, "colors": tuple(tuple(color) for color in entry["colors"])})


def _placement(entry: dict, folder: Path) -> Placement:
    x, y, z = (float(value) for value in entry["position"])
    depth, width, height = (float(value) for value in entry["size"])
    w, qx, qy, qz = (float(value) for value in entry["quat"])
    unknown = sorted(set(entry) - {field.name for field in fields(Placement)})
    if unknown:
        raise KeyError(f"{entry['id']} has unknown {', '.join(unknown)}")
    return Placement(
        id=entry["id"],
        role=entry["role"],
        category=entry["category"],
        package=(folder / entry["package"]).resolve(),
        position=(x, y, z),
        quat=(w, qx, qy, qz),
        size=(depth, width, height),
        joints=tuple((name, float(q)) for name, q in entry["joints"].items()),
        standing=tuple((float(px), float(py)) for px, py in entry["standing"]),
        support=entry["support"],
        provenance=_provenance(entry["provenance"], entry["id"]),
    )


def _provenance(value: object, owner: str) -> tuple[tuple[str, str], ...]:
    """The origin of a room or a placement; raises an error that names the key that holds no text."""
    if not isinstance(value, dict):
        raise TypeError(f"'provenance' of {owner} is {value!r}, expected an object of texts")
    wrong = next((key for key, one in value.items() if not isinstance(one, str)), None)
    if wrong is not None:
        raise ValueError(f"'provenance' of {owner}: {wrong!r} is {value[wrong]!r}, expected a text")
    return tuple(value.items())
