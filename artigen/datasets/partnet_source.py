"""The text files of a PartNet-Mobility folder, parsed and checked: JSON annotation and URDF.

Nothing here touches geometry. ``mobility_v2.json`` is the original annotation and the truth about
parts and joints; ``result.json`` says which mesh files make up an annotated piece; the URDF is one
export of both, which repositories that carry these objects have sometimes edited.
"""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from artigen.errors import SourceError
from artigen.transforms import matrix_from_rpy

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

ROOT_JOINTS = ("static", "heavy", "free")
MOVING_JOINTS = ("hinge", "slider")
URDF_JOINTS = ("fixed", "revolute", "continuous", "prismatic", "floating", "planar")
MAX_ANGLE = 720.0
"""Largest believable hinge limit in degrees."""
MAX_LENGTH = 100.0
"""Largest believable coordinate or travel, in PartNet's units (objects are about 2 long)."""


@dataclass(frozen=True, kw_only=True)
class SourcePiece:
    """A named piece of geometry of a node: ``handle`` with id 12."""

    id: int
    name: str


@dataclass(frozen=True, kw_only=True)
class SourceNode:
    """One node of mobility_v2.json; degrees and PartNet lengths, PartNet frame (y up)."""

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


@dataclass(frozen=True, kw_only=True)
class UrdfVisual:
    """A mesh reference of the URDF: link, visual name, file as written, and whether it is shifted."""

    link: str
    name: str
    file: str


@dataclass(frozen=True, kw_only=True)
class UrdfJoint:
    """What a URDF joint says."""

    name: str
    type: str
    parent: str
    child: str
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True, eq=False)
class UrdfFile:
    """The parts of a URDF that matter here. ``R_world_root`` is the turn of the root geometry."""

    links: tuple[str, ...]
    joints: tuple[UrdfJoint, ...]
    visuals: tuple[UrdfVisual, ...]
    primitives: tuple[str, ...]
    T_base_link: dict[str, np.ndarray]
    T_link_visual: tuple[np.ndarray, ...]


def read_json(path: Path) -> object:
    """Parses a JSON file; NaN and Infinity are refused."""
    try:
        return json.loads(path.read_text(encoding="utf-8"), parse_constant=_refuse_constant)
    except FileNotFoundError as err:
        raise SourceError(f"{path}: file is missing") from err
    except (OSError, UnicodeDecodeError) as err:
        raise SourceError(f"{path}: cannot be read: {err}") from err
    except (ValueError, RecursionError) as err:
        raise SourceError(f"{path}: not valid JSON: {err}") from err


def _refuse_constant(word: str) -> float:
    raise ValueError(f"holds {word}, which is not a number")


def read_nodes(path: Path) -> tuple[SourceNode, ...]:
    """Reads mobility_v2.json: all nodes, checked one by one and as a forest.

    Raises:
        SourceError: names the node, the field, what it holds and what is allowed.
    """
    value = read_json(path)
    if not isinstance(value, list) or not value:
        raise SourceError(f"{path}: holds {type(value).__name__}, expected a list of at least one node")
    nodes = tuple(_parse_node(path, index, item) for index, item in enumerate(value))
    ids = [node.id for node in nodes]
    if len(set(ids)) != len(ids):
        twice = sorted({number for number in ids if ids.count(number) > 1})
        raise SourceError(f"{path}: node ids occur twice: {twice}")
    parents = {node.id: node.parent for node in nodes}
    for node in nodes:
        seen, at = {node.id}, node.parent
        while at != -1:
            if at not in parents:
                raise SourceError(
                    f"{path}: node {node.id}: parent {at} is not a node, expected one of {sorted(ids)}"
                )
            if at in seen:
                raise SourceError(f"{path}: node {node.id}: its parents {sorted(seen)} form a cycle")
            seen.add(at)
            at = parents[at]
    return nodes


def _parse_node(path: Path, index: int, item: object) -> SourceNode:
    where = f"{path}: node {index}"
    if not isinstance(item, dict):
        raise SourceError(f"{where}: holds {type(item).__name__}, expected an object")
    where = f"{path}: node {item.get('id', index)}"
    number, parent = (_field(item, key, int, where) for key in ("id", "parent"))
    joint, name = (_field(item, key, str, where) for key in ("joint", "name"))
    allowed = (*ROOT_JOINTS, *MOVING_JOINTS, "junk")
    if joint not in allowed:
        raise SourceError(f"{where}: joint {joint!r} is not one of {', '.join(allowed)}")
    if joint in MOVING_JOINTS and parent == -1:
        raise SourceError(f"{where}: a {joint} has no parent (-1), expected a node id")
    pieces = tuple(_parse_pieces(_field(item, "parts", list, where), where))
    if joint not in MOVING_JOINTS:
        return SourceNode(id=number, parent=parent, joint=joint, name=name, pieces=pieces)
    data = _field(item, "jointData", dict, where)
    axis, limit = _field(data, "axis", dict, where), _field(data, "limit", dict, where)
    bound = MAX_ANGLE if joint == "hinge" else MAX_LENGTH
    unit = "degrees" if joint == "hinge" else "PartNet lengths"
    a, b = (_number(limit, key, where, bound, unit) for key in ("a", "b"))
    direction = _vector(axis, "direction", where)
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
        rotation_limit=_number(limit, "rotationLimit", where, MAX_ANGLE, "degrees", default=0.0),
    )


def _origin(axis: dict, joint: str, where: str) -> tuple[float, float, float]:
    # A slider needs no origin, and some annotations hold nulls there.
    if joint == "slider" and axis.get("origin") in (None, [None, None, None]):
        return (0.0, 0.0, 0.0)
    return _vector(axis, "origin", where)


def _field(item: dict, key: str, kind: type, where: str):
    value = item.get(key)
    if not isinstance(value, kind) or isinstance(value, bool):
        raise SourceError(f"{where}: {key!r} holds {value!r}, expected {kind.__name__}")
    return value


def _number(item: dict, key: str, where: str, bound: float, unit: str, default: float | None = None) -> float:
    value = item.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise SourceError(f"{where}: {key!r} holds {value!r}, expected a number")
    if abs(value) > bound:
        raise SourceError(
            f"{where}: {key!r} is {value:g} {unit}, allowed are -{bound:g}..{bound:g}; wrong unit?"
        )
    return float(value)


def _vector(item: dict, key: str, where: str) -> tuple[float, float, float]:
    value = _field(item, key, list, where)
    if len(value) != 3:
        raise SourceError(f"{where}: {key!r} holds {value!r}, expected three numbers")
    x, y, z = (_number({key: entry}, key, where, MAX_LENGTH, "PartNet lengths") for entry in value)
    return x, y, z


def _parse_pieces(value: list, where: str) -> list[SourcePiece]:
    pieces = []
    for item in value:
        if not isinstance(item, dict):
            raise SourceError(f"{where}: 'parts' holds {item!r}, expected objects")
        children = item.get("children") or []
        if children:
            pieces += _parse_pieces(children, where)
        pieces.append(SourcePiece(id=_field(item, "id", int, where), name=_field(item, "name", str, where)))
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
        found[_field(item, "id", int, str(path))] = tuple(dict.fromkeys(objs))
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


def read_urdf(path: Path) -> UrdfFile:
    """Reads links, joints and visual meshes; refuses entities, cycles and more than one root.

    Raises:
        SourceError: names the element and its value.
    """
    from xml.etree.ElementTree import ParseError

    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        robot = fromstring(path.read_bytes(), forbid_dtd=True)
    except FileNotFoundError as err:
        raise SourceError(f"{path}: file is missing") from err
    except (ParseError, OSError) as err:
        raise SourceError(f"{path}: not valid XML: {err}") from err
    except DefusedXmlException as err:
        raise SourceError(f"{path}: declares a DTD or entities, which are refused: {err}") from err
    links = tuple(_attribute(link, "name", path) for link in robot.iter("link"))
    if len(set(links)) != len(links):
        twice = sorted({name for name in links if links.count(name) > 1})
        raise SourceError(f"{path}: link names occur twice: {', '.join(twice)}")
    joints = tuple(_parse_joint(joint, links, path) for joint in robot.iter("joint"))
    visuals, primitives, T_link_visual = [], [], []
    for link in robot.iter("link"):
        for visual in link.findall("visual"):
            mesh = visual.find("geometry/mesh")
            name = visual.get("name") or ""
            if mesh is None:
                primitives.append(name or link.get("name", ""))
                continue
            visuals.append(
                UrdfVisual(link=link.get("name", ""), name=name, file=_attribute(mesh, "filename", path))
            )
            T_link_visual.append(_parse_origin(visual, path, f"visual {name!r}"))
            if mesh.get("scale") not in (None, "1 1 1", "1.0 1.0 1.0"):
                raise SourceError(
                    f"{path}: visual {name!r}: mesh scale {mesh.get('scale')!r}, expected 1 1 1"
                )
    origins = {
        _attribute(joint.find("child"), "link", path): _parse_origin(
            joint, path, f"joint {joint.get('name')!r}"
        )
        for joint in robot.iter("joint")
    }
    return UrdfFile(
        links=links,
        joints=joints,
        visuals=tuple(visuals),
        primitives=tuple(primitives),
        T_base_link=_chain(links, joints, origins, path),
        T_link_visual=tuple(T_link_visual),
    )


def _attribute(element: "Element | None", key: str, path: Path) -> str:
    value = None if element is None else element.get(key)
    if not value:
        tag = "element" if element is None else f"<{element.tag}>"
        raise SourceError(f"{path}: a {tag} lacks its {key!r}")
    return value


def _floats(element: "Element", key: str, default: str, path: Path, where: str) -> list[float]:
    text = element.get(key, default)
    try:
        values = [float(word) for word in text.split()]
    except ValueError as err:
        raise SourceError(f"{path}: {where}: {key} {text!r} is not made of numbers") from err
    if len(values) != len(default.split()) or not np.isfinite(values).all():
        raise SourceError(f"{path}: {where}: {key} {text!r}, expected {len(default.split())} finite numbers")
    return values


def _parse_origin(owner: "Element", path: Path, where: str) -> np.ndarray:
    T = np.eye(4)
    origin = owner.find("origin")
    if origin is not None:
        T[:3, :3] = matrix_from_rpy(np.array(_floats(origin, "rpy", "0 0 0", path, where)))
        T[:3, 3] = _floats(origin, "xyz", "0 0 0", path, where)
    return T


def _parse_joint(joint: "Element", links: tuple[str, ...], path: Path) -> UrdfJoint:
    name = _attribute(joint, "name", path)
    kind = _attribute(joint, "type", path)
    if kind not in URDF_JOINTS:
        raise SourceError(f"{path}: joint {name!r}: type {kind!r} is not one of {', '.join(URDF_JOINTS)}")
    ends = [_attribute(joint.find(tag), "link", path) for tag in ("parent", "child")]
    for end in ends:
        if end not in links:
            raise SourceError(f"{path}: joint {name!r}: link {end!r} does not exist")
    limit = joint.find("limit")
    where = f"joint {name!r}"
    lower, upper = (
        (0.0, 0.0)
        if limit is None
        else (_floats(limit, key, "0", path, where)[0] for key in ("lower", "upper"))
    )
    return UrdfJoint(name=name, type=kind, parent=ends[0], child=ends[1], lower=lower, upper=upper)


def _chain(
    links: tuple[str, ...], joints: tuple[UrdfJoint, ...], origins: dict[str, np.ndarray], path: Path
) -> dict[str, np.ndarray]:
    """Placement of every link at zero joint values, which also proves that the links form one tree."""
    above = {joint.child: joint.parent for joint in joints}
    if len(above) != len(joints):
        children = [joint.child for joint in joints]
        twice = sorted({child for child in children if children.count(child) > 1})
        raise SourceError(f"{path}: links with two parents: {', '.join(twice)}")
    roots = [link for link in links if link not in above]
    if len(roots) != 1:
        raise SourceError(f"{path}: {len(roots)} root links ({', '.join(roots) or 'none'}), expected one")
    placed = {roots[0]: np.eye(4)}
    for link in links:
        trail: list[str] = []
        at = link
        while at not in placed:
            if at in trail:
                raise SourceError(f"{path}: links {', '.join(trail)} form a cycle")
            trail.append(at)
            at = above[at]
        for step in reversed(trail):
            placed[step] = placed[above[step]] @ origins[step]
    return placed
