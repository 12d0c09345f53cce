"""Expressions for everything in a room or a flat, each of which refers to one thing: references.json."""

import json
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path

from artigen.io import write_whole
from envs.rooms.footprints import cached_package
from envs.rooms.room import Room
from sim_export.physics.phrases import name_parts

from .names import name_items, name_objects

REFERENCES_FILE = "references.json"
FORMAT, VERSION = "artigen-references", 1


@dataclass(frozen=True, kw_only=True)
class Reference:
    """A phrase for an object, for the part of it that a ``link`` is, or for a loose thing.

    ``id`` is that of the placement or of the thing in scene.json; ``link`` is "" unless a part is meant.
    """

    phrase: str
    id: str
    link: str = ""


def refer(room: Room) -> tuple[Reference, ...]:
    """A phrase with its article for every object, every part that moves by itself, and every loose thing that
    differs from all others by its name, colour or place; no phrase occurs twice."""
    objects = name_objects(room)
    found = [Reference(phrase=f"the {phrase}", id=name) for name, phrase in objects.items()]
    for placement in room.placements:
        owner = objects[placement.id]
        found += [
            Reference(phrase=f"the {part.phrases[0]} of the {owner}", id=placement.id, link=part.link)
            for part in name_parts(cached_package(placement.package))
        ]
    found += [Reference(phrase=phrase, id=name) for name, phrase in name_items(room, objects).items()]
    counts = Counter(reference.phrase for reference in found)
    return tuple(reference for reference in found if counts[reference.phrase] == 1)


def write_references(references: tuple[Reference, ...], folder: Path) -> Path:
    """Writes references.json into a folder and returns its path."""
    value = {"format": FORMAT, "version": VERSION, "references": [asdict(each) for each in references]}
    return write_whole(folder / REFERENCES_FILE, json.dumps(value, indent=1) + "\n")
