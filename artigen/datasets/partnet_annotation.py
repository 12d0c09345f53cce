"""Parses and checks PartNet-Mobility's JSON files, without geometry.

``mobility_v2.json`` is the original annotation, which defines parts and joints;
``result.json`` lists the mesh files of each annotated piece.
"""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from artigen.errors import SourceError, explain

ROOT_JOINTS = ("static", "heavy", "free")
MOVING_JOINTS = ("hinge", "slider")
MAX_ANGLE = 720.0
"""Largest plausible hinge limit in degrees."""
MAX_LENGTH = 100.0
"""Largest plausible coordinate or travel in PartNet's units (objects are about 2 long)."""

Kind = TypeVar("Kind", int, str, list, dict)


@dataclass(frozen=True, kw_only=True)
class SourcePiece:
    """A named piece of geometry of a node: ``handle`` with id 12."""

    id: int
    name: str


@dataclass(frozen=True, kw_only=True)
class SourceNode:
    """One node of mobility_v2.json: degrees and PartNet lengths in PartNet's frame (y up)."""

    id: int
    parent: int
    joint: str
    name: str
    pieces: tuple[SourcePiece, ...]
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    direction: tuple[float, float, float] = (0.0, 0.0, 0.0)
    a: float = 0.0
    b: float = 0.0
    unlimited: bool = False
    rotates: bool = False
    rotation_unlimited: bool = False
    rotation_limit: float = 0.0


def read_json(path: Path) -> object:
    """Parses a JSON file; NaN and Infinity are refused."""
    try:
        return json.loads(path.read_text(encoding="utf-8"), parse_constant=_refuse_constant)
    except FileNotFoundError as err:
        raise SourceError(f"{path}: file is missing") from err
    except (OSError, UnicodeDecodeError) as err:
        raise SourceError(f"{path}: cannot be read: {explain(err)}") from err
    except (ValueError, RecursionError) as err:
        raise SourceError(f"{path}: not valid JSON: {err}") from err


def _refuse_constant(word: str) -> float:
    raise ValueError(f"holds {word}, which is not a number")


def read_nodes(path: Path) -> tuple[SourceNode, ...]:
    """Reads mobility_v2.json: all nodes, checked one by one and as a forest.

    Raises:
        SourceError: If a node is invalid; names the node, the field, its value and what is allowed.
    """
    value = read_json(path)
    if not isinstance(value, list) or not value:
        raise SourceError(f"{path}: holds {type(value).__name__}, expected a list of at least one node")
    nodes = tuple(_parse_node(path, index, item) for index, item in enumerate(value))
    check_forest(nodes, path, "node")
    return nodes


def check_forest(nodes: Sequence[SourceNode], path: Path, noun: str) -> None:
    """Checks that ids are unique and that all parents exist and form no cycle.

    Raises:
        SourceError: If they do not; ``noun`` is what the file calls a node.
    """
    ids = [node.id for node in nodes]
    if len(set(ids)) != len(ids):
        twice = sorted({number for number in ids if ids.count(number) > 1})
        raise SourceError(f"{path}: {noun} ids occur twice: {twice}")
    parents = {node.id: node.parent for node in nodes}
    for node in nodes:
        seen, at = {node.id}, node.parent
        while at != -1:
            if at not in parents:
                raise SourceError(
                    f"{path}: {noun} {node.id}: parent {at} is not a {noun}, expected one of {sorted(ids)}"
                )
            if at in seen:
                raise SourceError(f"{path}: {noun} {node.id}: its parents {sorted(seen)} form a cycle")
            seen.add(at)
            at = parents[at]


def _parse_node(path: Path, index: int, item: object) -> SourceNode:
    where = f"{path}: node {index}"
    if not isinstance(item, dict):
        raise SourceError(f"{where}: holds {type(item).__name__}, expected an object")
    where = f"{path}: node {item.get('id', index)}"
    number, parent = read_field(item, "id", int, where), read_field(item, "parent", int, where)
    joint, name = read_field(item, "joint", str, where), read_field(item, "name", str, where)
    allowed = (*ROOT_JOINTS, *MOVING_JOINTS, "junk")
    if joint not in allowed:
        raise SourceError(f"{where}: joint {joint!r} is not one of {', '.join(allowed)}")
    if joint in MOVING_JOINTS and parent == -1:
        raise SourceError(f"{where}: a {joint} has no parent (-1), expected a node id")
    pieces = tuple(_parse_pieces(read_field(item, "parts", list, where), where))
    if joint not in MOVING_JOINTS:
        return SourceNode(id=number, parent=parent, joint=joint, name=name, pieces=pieces)
    data = read_field(item, "jointData", dict, where)
    axis, limit = read_field(data, "axis", dict, where), read_field(data, "limit", dict, where)
    bound = MAX_ANGLE if joint == "hinge" else MAX_LENGTH
    unit = "degrees" if joint == "hinge" else "PartNet lengths"
    a, b = (read_number(limit, key, where, bound, unit) for key in ("a", "b"))
    direction = read_vector(axis, "direction", where)
    if np.linalg.norm(direction) < 1e-6:
        raise SourceError(f"{where}: axis direction {list(direction)} has no length")
    return SourceNode(
        id=number,
        parent=parent,
        joint=joint,
        name=name,
        pieces=pieces,
        origin=_origin(axis, joint, where),
        direction=direction,
        a=a,
        b=b,
        unlimited=bool(limit.get("noLimit", False)),
        rotates=bool(limit.get("rotates", False)),
        rotation_unlimited=bool(limit.get("noRotationLimit", False)),
        rotation_limit=read_number(limit, "rotationLimit", where, MAX_ANGLE, "degrees", default=0.0),
    )


def _origin(axis: dict, joint: str, where: str) -> tuple[float, float, float]:
    # A slider needs no origin, and some annotations hold nulls there.
    if joint == "slider" and axis.get("origin") in (None, [None, None, None]):
        return (0.0, 0.0, 0.0)
    return read_vector(axis, "origin", where)


def read_field(item: dict, key: str, kind: type[Kind], where: str) -> Kind:
    """The value of a key, checked for its type; raises `SourceError` naming ``where``."""
    value = item.get(key)
    if not isinstance(value, kind) or isinstance(value, bool):
        raise SourceError(f"{where}: {key!r} holds {value!r}, expected {kind.__name__}")
    return value


def read_number(
    item: dict, key: str, where: str, bound: float, unit: str, default: float | None = None
) -> float:
    """A finite number of at most ``bound``; raises `SourceError` for anything else."""
    value = item.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise SourceError(f"{where}: {key!r} holds {value!r}, expected a number")
    if abs(value) > bound:
        raise SourceError(
            f"{where}: {key!r} is {value:g} {unit}, allowed are -{bound:g}..{bound:g}; wrong unit?"
        )
    return float(value)


def read_vector(item: dict, key: str, where: str) -> tuple[float, float, float]:
    """Three finite lengths; raises `SourceError` for anything else."""
    value = read_field(item, key, list, where)
    if len(value) != 3:
        raise SourceError(f"{where}: {key!r} holds {value!r}, expected three numbers")
    x, y, z = (read_number({key: entry}, key, where, MAX_LENGTH, "PartNet lengths") for entry in value)
    return x, y, z


def _parse_pieces(value: list, where: str) -> list[SourcePiece]:
    pieces = []
    for item in value:
        if not isinstance(item, dict):
            raise SourceError(f"{where}: 'parts' holds {item!r}, expected objects")
        children = item.get("children") or []
        if children:
            pieces += _parse_pieces(children, where)
        pieces.append(
            SourcePiece(id=read_field(item, "id", int, where), name=read_field(item, "name", str, where))
        )
    return pieces


def read_piece_files(path: Path) -> dict[int, tuple[str, ...]]:
    """Reads result.json: the mesh names (no folder, no suffix) of every annotated id."""
    found: dict[int, tuple[str, ...]] = {}

    def visit(item: object) -> list[str]:
        if not isinstance(item, dict):
            raise SourceError(f"{path}: holds {item!r}, expected objects with 'id' and 'objs'")
        objs = [name for name in item.get("objs") or [] if isinstance(name, str)]
        for child in item.get("children") or []:
            objs += visit(child)
        found[read_field(item, "id", int, str(path))] = tuple(dict.fromkeys(objs))
        return objs

    value = read_json(path)
    if not isinstance(value, list):
        raise SourceError(f"{path}: holds {type(value).__name__}, expected a list")
    try:
        for item in value:
            visit(item)
    except RecursionError as err:
        raise SourceError(f"{path}: nested too deeply") from err
    return found
