"""Reads `object.json`, the layout of SINGAPO, CAGE and the ACD set.

``diffuse_tree`` lists the parts: id, name, parent (-1 for the base), a joint with type, range (degrees or
lengths) and axis, a box, and mesh files in their places, textured ones (``objs``) and plain ones (``plys``).
``meta`` names the category. y is up, the front faces z, lengths are normalised.
"""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from artigen.datasets.categories import guess_category
from artigen.datasets.mechanism_object import OTHER, turn_upright
from artigen.datasets.mesh_files import load_shape
from artigen.datasets.part_labels import SHELF_NAMES, SPLIT_LABELS, guess_label
from artigen.datasets.partnet_annotation import (
    MAX_ANGLE,
    MAX_LENGTH,
    SourceNode,
    SourcePiece,
    check_forest,
    read_field,
    read_json,
    read_number,
    read_vector,
)
from artigen.datasets.partnet_joints import RestPose, describe_joint, joint_kind
from artigen.datasets.partnet_meshes import PieceMesh
from artigen.datasets.partnet_mobility import choose_size
from artigen.datasets.partnet_parts import order_nodes
from artigen.datasets.source_object import ReaderConfig, SourceObject, SourceTree, assemble, collect_corners
from artigen.errors import SourceError
from artigen.files.inside import inside
from artigen.files.urdf import UrdfShape
from artigen.transforms import shift
from artigen.types import PART_LABELS, PartLabel

logger = logging.getLogger(__name__)

JOINTS = ("fixed", "revolute", "prismatic", "continuous", "screw")
OWN_LABELS: dict[str, PartLabel] = dict(zip(PART_LABELS, PART_LABELS, strict=True))
MESH_KEYS = ("objs", "plys")
"""Keys of mesh files: textured ones, or plain ones if there are none."""


def read_acd(path: Path, scratch: Path, cfg: ReaderConfig | None = None, *, name: str = "") -> SourceObject:
    """Reads one object.json and the meshes that it names.

    Args:
        scratch: Folder for converted meshes.
        name: Name of the object; default: that of its folder.

    Raises:
        SourceError: If the object is invalid; names the file, the part, the field, its value and what is
            allowed.
    """
    cfg = cfg or ReaderConfig()
    value = read_json(path)
    if not isinstance(value, dict):
        raise SourceError(f"{path}: holds {type(value).__name__}, expected an object with 'diffuse_tree'")
    items = read_field(value, "diffuse_tree", list, str(path))
    every = tuple(_parse_node(item, path) for item in items)
    check_forest(every, path, "part")
    bases = [node.id for node in every if node.parent == -1]
    if len(bases) != 1:
        raise SourceError(f"{path}: bases {bases}, expected one")
    parents = {node.id: node.parent for node in every}
    still = {node.id for node in every if node.parent != -1 and joint_kind(node) == "fixed"}

    def owner(number: int) -> int:
        while number in still:
            number = parents[number]
        return number

    notes: list[str] = []
    moving = [replace(node, parent=owner(node.parent)) for node in every if node.id not in still]
    nodes = tuple(order_nodes(tuple(moving)))
    pieces = [
        piece
        for node, item in zip(every, items, strict=True)
        for piece in _read_pieces(node, owner(node.id), item, path, scratch, notes)
    ]
    turn = turn_upright(cfg.up or "y", cfg.front or "z")
    corners = collect_corners(pieces)
    labels = _label(nodes, corners, turn, notes)
    poses = {
        node.id: RestPose(rest=0.0, far=0.0)
        if joint_kind(node) == "continuous"
        else RestPose(rest=node.a, far=node.b)
        for node in nodes
    }
    notes += [note for note in map(describe_joint, nodes) if note]
    category = cfg.category or _read_category(value, path, notes)
    found = assemble(
        SourceTree(nodes=nodes, pieces=tuple(pieces), labels=labels, poses=poses, T_zup_file=turn),
        cfg,
        name=name or path.resolve().parent.name,
        category=category,
        choose_size=lambda extents: choose_size(category, extents, cfg),
        notes=tuple(notes),
    )
    logger.info("%s: %d parts", found.asset.name, len(found.asset.parts))
    return found


def _read_category(value: dict, path: Path, notes: list[str]) -> str:
    meta = value.get("meta")
    said = meta.get("obj_cat") if isinstance(meta, dict) else None
    category, note = guess_category([said] if isinstance(said, str) else [path.resolve().parent.name])
    if category != said:
        notes.append(note)
    return category


def _parse_node(item: object, path: Path) -> SourceNode:
    if not isinstance(item, dict):
        raise SourceError(f"{path}: 'diffuse_tree' holds {item!r}, expected objects")
    where = f"{path}: part {item.get('id')!r}"
    number, parent = read_field(item, "id", int, where), read_field(item, "parent", int, where)
    name, joint = read_field(item, "name", str, where), read_field(item, "joint", dict, where)
    kind = read_field(joint, "type", str, where)
    if kind not in JOINTS:
        raise SourceError(f"{where}: joint type {kind!r} is not one of {', '.join(JOINTS)}")
    if kind == "fixed" or parent == -1:
        root = "heavy" if parent == -1 else "static"
        return SourceNode(id=number, parent=parent, joint=root, name=name, pieces=())
    axis = read_field(joint, "axis", dict, where)
    direction = read_vector(axis, "direction", where)
    if np.linalg.norm(direction) < 1e-6:
        raise SourceError(f"{where}: axis direction {list(direction)} has no length")
    turns = kind in ("revolute", "continuous")
    ends = read_field(joint, "range", list, where)
    if len(ends) != 2:
        raise SourceError(f"{where}: 'range' holds {ends!r}, expected two numbers")
    bound, unit = (MAX_ANGLE, "degrees") if turns else (MAX_LENGTH, "lengths")
    a, b = (read_number({"range": end}, "range", where, bound, unit) for end in ends)
    return SourceNode(
        id=number,
        parent=parent,
        joint="hinge" if turns else "slider",
        name=name,
        pieces=(),
        origin=read_vector(axis, "origin", where) if turns else (0.0, 0.0, 0.0),
        direction=direction,
        a=a,
        b=b,
        unlimited=kind == "continuous",
        rotates=kind == "screw",
        rotation_unlimited=kind == "screw",
    )


def _read_pieces(
    node: SourceNode, owner: int, item: dict, path: Path, scratch: Path, notes: list[str]
) -> list[PieceMesh]:
    """The geometry of one part: its textured meshes, else its plain meshes, else its box."""
    where = f"{path}: part {node.id} ({node.name})"
    word = node.name if owner != node.id and node.name in (*SPLIT_LABELS, *SHELF_NAMES) else OTHER
    piece = SourcePiece(id=node.id, name=word)
    for key in MESH_KEYS:
        found, lost = [], []
        for name in item.get(key) or []:
            if not isinstance(name, str):
                raise SourceError(f"{where}: {key!r} holds {name!r}, expected the name of a file")
            file = _find_file(name, path, where)
            shape = UrdfShape(link=node.name, name=name, kind="mesh", T_link_shape=np.eye(4), file=name)
            placed = load_shape(shape, file, path.parent, scratch) if file.is_file() else None
            if placed is None:
                lost.append(name)
            else:
                found.append(
                    PieceMesh(node=owner, piece=piece, path=placed.path, mesh=placed.mesh, scale=placed.scale)
                )
        if lost:
            notes.append(f"part {node.id} ({node.name}): {key} are missing or empty: {', '.join(lost)}")
        if found:
            return found
    box = item.get("aabb")
    if not isinstance(box, dict):
        raise SourceError(f"{where}: has neither meshes nor 'aabb', expected some of {', '.join(MESH_KEYS)}")
    T = shift(np.array(read_vector(box, "center", where)))
    size = read_vector(box, "size", where)
    if min(size) <= 0.0:
        raise SourceError(f"{where}: 'size' of 'aabb' holds {list(size)}, expected lengths above 0")
    placed = load_shape(
        UrdfShape(link=node.name, name="aabb", kind="box", T_link_shape=T, sizes=size), None, path, scratch
    )
    assert placed is not None
    notes.append(f"part {node.id} ({node.name}) has no mesh; its box stands for it")
    mesh = replace(placed.mesh, vertices=placed.mesh.vertices + T[:3, 3])
    return [PieceMesh(node=owner, piece=piece, path=placed.path, mesh=mesh, T_tree_file=T)]


def _find_file(name: str, path: Path, where: str) -> Path:
    """Path of a mesh: as named, or in the usual folders of bare names."""
    bare = [f"objs/{name}.obj", f"textured_objs/{name}.obj", f"plys/{name}.ply"]
    places = [inside(path.parent, path.parent, place, where) for place in (name, *bare)]
    return next((place for place in places if place.is_file()), places[0])


def _label(
    nodes: Sequence[SourceNode], corners: Mapping[int, np.ndarray], turn: np.ndarray, notes: list[str]
) -> dict[int, PartLabel]:
    """Labels of the parts: their names, which nearly always are labels, else the tables."""
    labels: dict[int, PartLabel] = {}
    for node in nodes:
        own = OWN_LABELS.get(node.name, "base")
        if node.parent == -1 or own != "base":
            labels[node.id] = "base" if node.parent == -1 else own
            continue
        labels[node.id], why = guess_label(node, (node.name,), corners, labels, turn)
        notes.append(f"part {node.id} ({node.name}) is a {labels[node.id]}: {why}")
    return labels
