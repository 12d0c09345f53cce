"""The joints of a mesh file: a JSON file beside it that says which nodes move, and how.

::

    {"format": "artigen-joints-1", "up": "y", "front": "z", "metres": 1.0,
     "joints": [{"part": "door", "label": "door", "nodes": ["Door_01", "Handle"], "type": "revolute",
                 "origin": [0.3, 0, 0.2], "axis": [0, 1, 0], "lower": 0, "upper": 1.57}]}

Origins, axes and travels are in the coordinates of the mesh file, turns in radians; all is closed at 0 as the
mesh file shows it. Nodes that no joint names belong to the body.
"""

import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, get_args

import numpy as np

from artigen.datasets.mechanism import Direction
from artigen.errors import SourceError, explain, name_options
from artigen.types import PartLabel

FORMAT = "artigen-joints-1"
SUFFIX = ".joints.json"
BODY = "body"
TYPES = ("fixed", "revolute", "continuous", "prismatic")
Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class NodeJoint:
    """What moves some nodes of a mesh file."""

    part: str
    """Name of the part."""
    nodes: tuple[str, ...]
    """Names of its nodes, with all below them."""
    label: PartLabel
    type: str
    origin: Vector = (0.0, 0.0, 0.0)
    axis: Vector = (0.0, 0.0, 1.0)
    lower: float = 0.0
    upper: float = 0.0
    parent: str = BODY
    """Part that carries it."""
    mimic: str | None = None
    """Part whose joint it follows, ``multiplier`` times."""
    multiplier: float = 1.0


@dataclass(frozen=True, kw_only=True)
class JointsFile:
    """The joints of one mesh file, and its frame and unit."""

    joints: tuple[NodeJoint, ...]
    up: Direction = "y"
    front: Direction = "z"
    metres: float = 1.0
    """Metres per length of the mesh file."""


def joints_path(mesh: Path) -> Path:
    """Where the joints of a mesh file are: ``chest.joints.json`` beside ``chest.glb``."""
    return mesh.with_name(mesh.stem + SUFFIX)


def write_joints(path: Path, said: JointsFile) -> None:
    """Writes a file that `read_joints` reads as the same value."""
    defaults = {one.name: one.default for one in fields(NodeJoint)}
    joints = [
        {
            key: value
            for key, value in asdict(joint).items()
            if value != defaults[key] or key in ("lower", "axis")
        }
        for joint in said.joints
    ]
    head = {"format": FORMAT, "up": said.up, "front": said.front, "metres": said.metres}
    rows = ",\n".join("  " + json.dumps(joint) for joint in joints)
    text = json.dumps(head)[:-1] + f',\n "joints": [\n{rows}\n]}}\n'
    path.write_text(text, encoding="utf-8")


def read_joints(path: Path) -> JointsFile:
    """Reads and checks a joints file.

    Raises:
        SourceError: If it is not valid; names the part, the key, its value and what is allowed.
    """
    try:
        value = json.loads(path.read_text(encoding="utf-8"), parse_constant=float)
    except (OSError, ValueError) as err:
        raise SourceError(f"{path}: cannot be read as JSON: {explain(err)}") from err
    if not isinstance(value, dict) or value.get("format") != FORMAT:
        raise SourceError(f"{path}: is no joints file, expected an object with the key 'format' {FORMAT!r}")
    rows = value.get("joints")
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise SourceError(f"{path}: 'joints' is {rows!r:.60}, expected a list of objects")
    said = JointsFile(
        joints=tuple(_read_joint(row, path) for row in rows),
        up=_one_of(value, "up", "y", get_args(Direction), str(path)),
        front=_one_of(value, "front", "z", get_args(Direction), str(path)),
        metres=_number(value, "metres", 1.0, str(path)),
    )
    if said.metres <= 0.0:
        raise SourceError(f"{path}: 'metres' is {said.metres:g}, expected the metres per length, above 0")
    _check_names(said, path)
    return said


def _check_names(said: JointsFile, path: Path) -> None:
    parts = [joint.part for joint in said.joints]
    twice = [name for name, count in Counter([BODY, *parts]).items() if count > 1]
    if twice:
        raise SourceError(
            f"{path}: part {twice[0]!r} occurs twice, expected a name of its own; {BODY!r} is taken"
        )
    nodes = Counter(node for joint in said.joints for node in joint.nodes)
    shared = [node for node, count in nodes.items() if count > 1]
    if shared:
        raise SourceError(f"{path}: node {shared[0]!r} belongs to two parts, expected one")
    parents = {joint.part: joint.parent for joint in said.joints}
    for joint in said.joints:
        for key, name in (("parent", joint.parent), ("mimic", joint.mimic or BODY)):
            if name != BODY and name not in parts:
                allowed = ", ".join((BODY, *parts))
                raise SourceError(f"{path}: part {joint.part!r}: {key} {name!r} is none of {allowed}")
        at, seen = joint.part, {joint.part}
        while parents.get(at, BODY) != BODY:
            at = parents[at]
            if at in seen:
                raise SourceError(f"{path}: part {joint.part!r} carries itself")
            seen.add(at)


def _read_joint(row: Mapping[str, Any], path: Path) -> NodeJoint:
    owner = f"{path}: part {row.get('part')!r}"
    known = [one.name for one in fields(NodeJoint)]
    unknown = [key for key in row if key not in known]
    if unknown:
        raise SourceError(f"{owner}: key {unknown[0]!r} is none of {', '.join(known)}")
    nodes = row.get("nodes")
    if not isinstance(nodes, list) or not nodes or not all(isinstance(node, str) for node in nodes):
        raise SourceError(f"{owner}: 'nodes' is {nodes!r:.60}, expected a list of names")
    if not isinstance(row.get("part"), str) or not row["part"]:
        raise SourceError(f"{owner}: 'part' is no name")
    for key in ("parent", "mimic"):
        if key in row and not isinstance(row[key], str):
            raise SourceError(f"{owner}: {key!r} is {row[key]!r:.60}, expected the name of a part")
    kind = _one_of(row, "type", None, TYPES, owner)
    joint = NodeJoint(
        part=row["part"],
        nodes=tuple(nodes),
        label=_one_of(row, "label", None, get_args(PartLabel), owner),
        type=kind,
        origin=_vector(row, "origin", NodeJoint.origin, owner),
        axis=_vector(row, "axis", NodeJoint.axis, owner),
        lower=_number(row, "lower", 0.0, owner),
        upper=_number(row, "upper", 0.0, owner),
        parent=row.get("parent", BODY),
        mimic=row.get("mimic"),
        multiplier=_number(row, "multiplier", 1.0, owner),
    )
    if kind != "fixed" and not np.linalg.norm(joint.axis) > 1e-6:
        raise SourceError(f"{owner}: 'axis' is {list(joint.axis)}, expected a direction")
    if kind in ("revolute", "prismatic") and not joint.lower < joint.upper:
        raise SourceError(f"{owner}: limits [{joint.lower:g}, {joint.upper:g}], expected lower below upper")
    return joint


def _one_of(row: Mapping[str, Any], key: str, default: str | None, allowed: tuple, owner: str) -> Any:
    value = row.get(key, default)
    if value not in allowed:
        raise SourceError(f"{owner}: {key!r} is {value!r:.60}, expected {name_options(str(value), allowed)}")
    return value


def _number(row: Mapping[str, Any], key: str, default: float, owner: str) -> float:
    value = row.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
        raise SourceError(f"{owner}: {key!r} is {value!r:.60}, expected a finite number")
    return float(value)


def _vector(row: Mapping[str, Any], key: str, default: Vector, owner: str) -> Vector:
    values = row.get(key, default)
    if not isinstance(values, list | tuple) or len(values) != 3:
        raise SourceError(f"{owner}: {key!r} is {values!r:.60}, expected three numbers")
    x, y, z = (_number({key: value}, key, 0.0, owner) for value in values)
    return x, y, z
