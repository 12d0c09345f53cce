"""Builds parts from annotated nodes and meshes: places them at rest, splits off handles and shelves."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from artigen.datasets.part_labels import SHELF_NAMES, SPLIT_LABELS
from artigen.datasets.partnet_annotation import MOVING_JOINTS, SourceNode
from artigen.datasets.partnet_joints import RestPose, build_joint, motion
from artigen.datasets.partnet_meshes import PieceMesh
from artigen.datasets.partnet_surface import FaceTable, split_pieces
from artigen.types import FIXED, Joint, Part, PartLabel


@dataclass(frozen=True, kw_only=True, eq=False)
class Placement:
    """Placement of each node's mesh files at rest: ``p_unit = T_unit[node] * (scale * p_file)``.

    ``extents`` are depth, width and height in PartNet lengths.
    """

    T_unit: dict[int, np.ndarray]
    scale: float
    extents: Float[np.ndarray, "3"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Draft:
    name: str
    label: PartLabel
    parent: int
    joint: Joint


def place_nodes(
    nodes: tuple[SourceNode, ...],
    poses: Mapping[int, RestPose],
    pieces: tuple[PieceMesh, ...],
    T_zup_file: Float[np.ndarray, "4 4"],
) -> Placement:
    """Moves every node to its rest pose, rotates z up, and fits the object into the unit cube."""
    moved = {node.id: T_zup_file for node in nodes if node.parent == -1}
    for node in order_nodes(nodes):
        if node.id not in moved:
            own = motion(node, np.array(poses[node.id].rest)) if node.joint in MOVING_JOINTS else np.eye(4)
            moved[node.id] = moved[node.parent] @ own
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for piece in pieces:
        used = piece.mesh.vertices[np.unique(piece.mesh.faces)]
        points = used @ moved[piece.node][:3, :3].T + moved[piece.node][:3, 3]
        low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    scale = 1.0 / float((high - low).max())
    T_unit = {number: T.copy() for number, T in moved.items()}
    for T in T_unit.values():
        T[:3, 3] = scale * (T[:3, 3] - (low + high) / 2)
    return Placement(T_unit=T_unit, scale=scale, extents=high - low)


def order_nodes(nodes: tuple[SourceNode, ...]) -> list[SourceNode]:
    """The base, then all others by id, parents before children."""
    order = [node for node in nodes if node.parent == -1]
    waiting = sorted((node for node in nodes if node.parent != -1), key=lambda node: node.id)
    while waiting:
        done = {node.id for node in order}
        node = next(node for node in waiting if node.parent in done)
        order.append(node)
        waiting.remove(node)
    return order


def build_parts(
    nodes: tuple[SourceNode, ...],
    labels: Mapping[int, PartLabel],
    poses: Mapping[int, RestPose],
    pieces: tuple[PieceMesh, ...],
    tables: tuple[FaceTable, ...],
    placement: Placement,
    gap: float,
) -> tuple[tuple[Part, ...], tuple[Int[np.ndarray, "F"], ...]]:
    """The parts of the object, and for every mesh the part of each face.

    Handles and knobs inside another part, and shelves inside the body, become parts with a fixed joint: one
    per annotated piece and per component that is farther than ``gap`` from the others. A part never loses all
    of its geometry this way.
    """
    drafts: list[_Draft] = []
    owners = tuple(np.full(len(table.faces), -1) for table in tables)
    main: dict[int, int] = {}
    for node in order_nodes(nodes):
        label = labels[node.id]
        index = main[node.id] = len(drafts)
        name = "base" if node.parent == -1 else _count_up(drafts, label)
        joint, parent = FIXED, -1
        if node.parent != -1:
            parent = main[node.parent]
            joint = build_joint(node, poses[node.id], placement.T_unit[node.parent], placement.scale)
        drafts.append(_Draft(name=name, label=label, parent=parent, joint=joint))
        mine = [number for number, piece in enumerate(pieces) if piece.node == node.id]
        for number in mine:
            owners[number][:] = index
        for split, piece_id in _choose_splits(node, label, [pieces[number] for number in mine]):
            chosen = [number for number in mine if pieces[number].piece.id == piece_id]
            groups = split_pieces([tables[number] for number in chosen], gap)
            for group in range(1 + max(int(members.max()) for members in groups)):
                for number, members in zip(chosen, groups, strict=True):
                    owners[number][members == group] = len(drafts)
                stem = split if split == "shelf" else f"{name}_{split}"
                drafts.append(_Draft(name=_count_up(drafts, stem), label=split, parent=index, joint=FIXED))
    return _add_boxes(drafts, tables, owners), owners


def _count_up(drafts: list[_Draft], stem: str) -> str:
    taken = sum(draft.name.rpartition("_")[0] == stem for draft in drafts)
    return f"{stem}_{taken}"


def _choose_splits(
    node: SourceNode, label: PartLabel, pieces: list[PieceMesh]
) -> list[tuple[PartLabel, int]]:
    """Label and id of the annotated pieces that become separate parts."""
    chosen: list[tuple[PartLabel, int]] = []
    left = {piece.piece.id for piece in pieces}
    for number, name in sorted({(piece.piece.id, piece.piece.name) for piece in pieces}):
        is_shelf = node.parent == -1 and name in SHELF_NAMES
        split: PartLabel | None = "shelf" if is_shelf else SPLIT_LABELS.get(name)
        if split is not None and label not in SPLIT_LABELS.values() and left != {number}:
            left.remove(number)
            chosen.append((split, number))
    return chosen


def _add_boxes(
    drafts: list[_Draft], tables: tuple[FaceTable, ...], owners: tuple[np.ndarray, ...]
) -> tuple[Part, ...]:
    corners = np.concatenate([table.corners for table in tables])
    part_ids = np.concatenate(owners)
    parts = []
    for index, draft in enumerate(drafts):
        own = corners[part_ids == index].reshape(-1, 3)
        low, high = own.min(axis=0), own.max(axis=0)
        parts.append(
            Part(
                name=draft.name,
                label=draft.label,
                parent=draft.parent,
                joint=draft.joint,
                box=np.stack([(low + high) / 2, high - low]),
            )
        )
    return tuple(parts)
