"""Reads any PartNet-Mobility folder into an `Asset`: parts, joints, coloured surface, real size.

``mobility_v2.json`` is the truth about parts and joints, mesh files are drawn where they lie, and
everything that was decided on the way (a rest pose moved, a mesh missing, a URDF that disagrees) is
a sentence in ``asset.notes``. See docs/partnet_mobility.md.
"""

import logging
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from artigen.datasets.partnet_joints import RestPose, build_joint, closed_pose, joint_kind, motion
from artigen.datasets.partnet_labels import SHELF_NAMES, SPLIT_LABELS, choose_label
from artigen.datasets.partnet_meshes import MESH_FOLDER, PieceMesh, read_pieces
from artigen.datasets.partnet_source import (
    MOVING_JOINTS,
    SourceNode,
    UrdfFile,
    read_json,
    read_nodes,
    read_piece_files,
    read_urdf,
)
from artigen.datasets.partnet_surface import FaceTable, make_face_table, sample_surface, split_pieces
from artigen.datasets.sizes import estimate_size
from artigen.errors import SourceError
from artigen.transforms import T_ZUP_FROM_PARTNET
from artigen.types import FIXED, Asset, Joint, Part, PartLabel, SurfaceSamples, frozen_array

logger = logging.getLogger(__name__)

POINTS_PER_NODE = 2000


@dataclass(frozen=True, kw_only=True)
class ReaderConfig:
    """How an object is read."""

    samples: int = 600_000
    """Points drawn from the surface of the whole object; fewer is faster, too few leave holes in 64^3 voxels."""
    seed: int = 0
    """Seed of the surface samples."""
    size: float | None = None
    """Longest edge of the closed object in metres; None takes it from the category table."""
    piece_gap: float = 0.04
    """Handles of one name that are farther apart become parts of their own (unit-cube lengths)."""

    def __post_init__(self) -> None:
        if self.samples < 1:
            raise ValueError(f"samples is {self.samples}, expected at least 1")
        if self.size is not None and not self.size > 0:
            raise ValueError(f"size is {self.size} metres, expected > 0")
        if not self.piece_gap > 0:
            raise ValueError(f"piece_gap is {self.piece_gap}, expected > 0")


@dataclass(frozen=True, kw_only=True, eq=False)
class SourceVisual:
    """A mesh file of the source and where it lies: ``p_unit = T_unit_file * (scale * p_file)``."""

    part: int
    name: str
    path: Path
    T_unit_file: Float[np.ndarray, "4 4"]
    scale: float


@dataclass(frozen=True, kw_only=True, eq=False)
class TriangleMesh:
    """The source's own triangles in the unit cube at rest, with the part of each."""

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    part_ids: Int[np.ndarray, "F"]

    def __post_init__(self) -> None:
        faces = frozen_array(self.faces, np.int64, (None, 3), "triangle faces")
        object.__setattr__(self, "faces", faces)
        object.__setattr__(
            self, "vertices", frozen_array(self.vertices, np.float64, (None, 3), "triangle vertices")
        )
        object.__setattr__(
            self, "part_ids", frozen_array(self.part_ids, np.int64, (len(faces),), "triangle part ids")
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class PartNetObject:
    """An object as read: the asset, and the source's meshes for stages that keep them."""

    asset: Asset
    visuals: tuple[SourceVisual, ...]
    triangles: TriangleMesh


@dataclass(frozen=True, kw_only=True, eq=False)
class _Draft:
    """A part before it has a box: where it comes from and what it is."""

    name: str
    label: PartLabel
    parent: int
    joint: Joint


def read_object(folder: Path, cfg: ReaderConfig | None = None) -> PartNetObject:
    """Reads one PartNet-Mobility folder.

    Args:
        folder: holds mobility_v2.json, mobility.urdf, meta.json, textured_objs/ and, usually, result.json.
        cfg: sample count, seed and size; the defaults are for 64^3 voxels.

    Raises:
        SourceError: the folder cannot be read; one sentence names file, element and value.
    """
    cfg = cfg or ReaderConfig()
    category = _read_category(folder / "meta.json")
    nodes, notes = _live_nodes(read_nodes(folder / "mobility_v2.json"), folder)
    urdf = read_urdf(folder / "mobility.urdf")
    listing = folder / "result.json"
    files = read_piece_files(listing) if listing.exists() else {}
    pieces, mesh_notes = read_pieces(folder, nodes, urdf, files)
    nodes, empty_notes = _drop_empty(nodes, pieces, folder)
    notes += [*mesh_notes, *empty_notes, *_compare_urdf(nodes, urdf)]
    labels, label_notes = _label_nodes(nodes)
    poses = _rest_poses(nodes, labels, pieces)
    notes += label_notes + [pose.note for pose in poses.values() if pose.note]
    notes += [note for node in nodes if (note := _describe_simplified(node))]

    placed, turn_notes = _place_nodes(nodes, poses, urdf)
    notes += turn_notes
    T_unit, scale, extents = _unit_placement(placed, pieces)
    tables = [make_face_table(piece.mesh, T_unit[piece.node], scale) for piece in pieces]
    drafts, owners, split_notes = _draft_parts(nodes, labels, pieces, tables, cfg)
    notes += split_notes
    drafts = _add_joints(drafts, nodes, poses, T_unit, scale)
    size, known = (cfg.size, True) if cfg.size is not None else estimate_size(category, extents)
    if not known:
        notes.append(f"category {category!r} has no known size, longest edge set to {size:g} m")

    triangles = _join(tables, owners)
    asset = Asset(
        name=folder.resolve().name,
        category=category,
        scale=size,
        parts=_with_boxes(drafts, triangles),
        surface=_sample(tables, owners, cfg),
        notes=tuple(notes),
    )
    visuals = tuple(
        SourceVisual(
            part=int(owner[0]),
            name=piece.visual_name,
            path=piece.path,
            T_unit_file=T_unit[piece.node],
            scale=scale,
        )
        for piece, owner in zip(pieces, owners, strict=True)
    )
    logger.info("%s: %d parts, %d triangles", asset.name, len(asset.parts), len(triangles.faces))
    return PartNetObject(asset=asset, visuals=visuals, triangles=triangles)


def triangle_mesh(source: PartNetObject) -> TriangleMesh:
    """The exact source triangles at rest in the unit cube, for point-to-surface distances."""
    return source.triangles


def _read_category(path: Path) -> str:
    value = read_json(path)
    category = value.get("model_cat") if isinstance(value, dict) else None
    if not isinstance(category, str) or not category:
        raise SourceError(f"{path}: 'model_cat' holds {category!r}, expected the name of a category")
    return category


def _live_nodes(nodes: tuple[SourceNode, ...], folder: Path) -> tuple[tuple[SourceNode, ...], list[str]]:
    """Drops junk and all that hangs on it; checks that one root is left."""
    dead = {node.id for node in nodes if node.joint == "junk"}
    while grown := {node.id for node in nodes if node.parent in dead} - dead:
        dead |= grown
    notes = [f"node {node.id} ({node.name}) is junk and was left out" for node in nodes if node.id in dead]
    live = tuple(node for node in nodes if node.id not in dead)
    roots = [f"{node.id} ({node.name})" for node in live if node.parent == -1]
    if len(roots) != 1:
        raise SourceError(
            f"{folder / 'mobility_v2.json'}: {len(roots)} root nodes that are not junk"
            f" ({', '.join(roots) or 'none'}), expected one"
        )
    return live, notes


def _drop_empty(
    nodes: tuple[SourceNode, ...], pieces: tuple[PieceMesh, ...], folder: Path
) -> tuple[tuple[SourceNode, ...], list[str]]:
    """Leaves out movable parts whose geometry the source has lost altogether; the base may not be one."""
    drawn = {piece.node for piece in pieces}
    notes = []
    for node in nodes:
        if node.id in drawn:
            continue
        where = f"{folder}: node {node.id} ({node.name})"
        if node.parent == -1:
            raise SourceError(
                f"{where} is the base and has no geometry: none of its mesh files is in {MESH_FOLDER}"
            )
        children = [child.id for child in nodes if child.parent == node.id]
        if children:
            raise SourceError(f"{where} has no geometry, but carries nodes {children}")
        notes.append(f"node {node.id} ({node.name}) was left out: none of its mesh files exists")
    return tuple(node for node in nodes if node.id in drawn), notes


def _compare_urdf(nodes: tuple[SourceNode, ...], urdf: UrdfFile) -> list[str]:
    """Where the URDF says something else than mobility_v2.json, which is what is used."""
    joints = {joint.child: joint for joint in urdf.joints}
    expected = {
        "fixed": ("fixed",),
        "revolute": ("revolute",),
        "prismatic": ("prismatic",),
        "continuous": ("continuous",),
        "screw": ("continuous", "prismatic", "revolute"),
    }
    changed, notes = [], []
    for node in nodes:
        joint = joints.get(f"link_{node.id}")
        kind = joint_kind(node)
        if node.parent == -1:
            continue
        if joint is None:
            changed.append(f"link_{node.id} is missing")
        elif joint.type not in expected[kind]:
            changed.append(f"link_{node.id} is {joint.type} instead of {kind}")
        elif kind in ("revolute", "prismatic"):
            span = abs(node.b - node.a) if kind == "prismatic" else np.radians(abs(node.b - node.a))
            if abs((joint.upper - joint.lower) - span) > 0.01 * span:
                changed.append(f"link_{node.id} spans {joint.upper - joint.lower:.4g} instead of {span:.4g}")
    known = {f"link_{node.id}" for node in nodes} | {urdf.links[0], "base"}
    helpers = {f"link_{node.id}_helper" for node in nodes if node.rotates}
    extra = [link for link in urdf.links if link not in known | helpers]
    if changed:
        notes.append(f"the URDF differs from mobility_v2.json, which was taken: {', '.join(changed)}")
    if extra:
        notes.append(f"the URDF has links that mobility_v2.json does not know: {', '.join(extra)}")
    return notes


def _label_nodes(nodes: tuple[SourceNode, ...]) -> tuple[dict[int, PartLabel], list[str]]:
    labels: dict[int, PartLabel] = {}
    notes = []
    for node in nodes:
        if node.parent == -1:
            labels[node.id] = "base"
            continue
        names = (node.name, *(piece.name for piece in node.pieces))
        joint = node.joint if node.joint in MOVING_JOINTS else "fixed"
        labels[node.id], known = choose_label(joint, names, free=node.unlimited)
        if not known:
            notes.append(
                f"node {node.id} ({node.name}): none of {', '.join(dict.fromkeys(names))} is in the label table, "
                f"labelled {labels[node.id]} for its {joint}"
            )
    return labels, notes


def _rest_poses(
    nodes: tuple[SourceNode, ...], labels: dict[int, PartLabel], pieces: tuple[PieceMesh, ...]
) -> dict[int, RestPose]:
    """Closed pose of every node; zero where there is nothing to choose."""
    corners = {
        node.id: np.concatenate(
            [p.mesh.vertices[p.mesh.faces].reshape(-1, 3) for p in pieces if p.node == node.id]
        )
        for node in nodes
    }
    base = next(node.id for node in nodes if node.parent == -1)
    body = np.stack([corners[base].min(axis=0), corners[base].max(axis=0)])
    poses = {}
    for node in nodes:
        poses[node.id] = RestPose(rest=0.0, far=0.0)
        if joint_kind(node) in ("revolute", "prismatic", "screw"):
            stride = max(1, len(corners[node.id]) // POINTS_PER_NODE)
            poses[node.id] = closed_pose(node, labels[node.id], corners[node.id][::stride], body)
    return poses


def _describe_simplified(node: SourceNode) -> str:
    kind = joint_kind(node)
    where = f"node {node.id} ({node.name})"
    if kind == "continuous" and node.joint == "slider":
        return f"{where} turns freely and slides by {abs(node.b - node.a):g}; the slide was left out"
    if kind == "fixed" and node.joint in MOVING_JOINTS:
        return f"{where}: limits [{node.a:g}, {node.b:g}] leave no motion, made fixed"
    if kind == "screw":
        return f"{where}: slides and turns by {node.rotation_limit:g} degrees, read as one screw"
    length = float(np.linalg.norm(node.direction))
    if kind != "fixed" and abs(length - 1.0) > 0.02:
        return f"{where}: axis direction had length {length:.3g}, normalised"
    return ""


def _place_nodes(
    nodes: tuple[SourceNode, ...], poses: dict[int, RestPose], urdf: UrdfFile
) -> tuple[dict[int, np.ndarray], list[str]]:
    """Motion of each node's geometry from the modelled to the rest pose, turned to z up."""
    notes = []
    base = next(node for node in nodes if node.parent == -1)
    turn = T_ZUP_FROM_PARTNET
    if f"link_{base.id}" in urdf.T_base_link:
        turn = np.eye(4)
        turn[:3, :3] = urdf.T_base_link[f"link_{base.id}"][:3, :3]
        if not np.allclose(turn, T_ZUP_FROM_PARTNET, atol=1e-4):
            notes.append(
                "the URDF turns the base otherwise than PartNet-Mobility does; its own turn was taken"
            )
    moved: dict[int, np.ndarray] = {base.id: turn}
    waiting = [node for node in nodes if node.id != base.id]
    while waiting:
        for node in [node for node in waiting if node.parent in moved]:
            own = np.eye(4)
            if node.joint in MOVING_JOINTS:
                own = motion(node, np.array(poses[node.id].rest))
            moved[node.id] = moved[node.parent] @ own
        waiting = [node for node in waiting if node.id not in moved]
    return moved, notes


def _unit_placement(
    placed: dict[int, np.ndarray], pieces: tuple[PieceMesh, ...]
) -> tuple[dict[int, np.ndarray], float, np.ndarray]:
    """Rigid placements into the unit cube (applied after the scale), the scale, and the extents."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for piece in pieces:
        used = piece.mesh.vertices[np.unique(piece.mesh.faces)]
        points = used @ placed[piece.node][:3, :3].T + placed[piece.node][:3, 3]
        low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
    extents = high - low
    scale = 1.0 / float(extents.max())
    T_unit = {}
    for node, T in placed.items():
        T_unit[node] = T.copy()
        T_unit[node][:3, 3] = scale * (T[:3, 3] - (low + high) / 2)
    return T_unit, scale, extents


def _draft_parts(
    nodes: tuple[SourceNode, ...],
    labels: dict[int, PartLabel],
    pieces: tuple[PieceMesh, ...],
    tables: list[FaceTable],
    cfg: ReaderConfig,
) -> tuple[list[tuple[_Draft, int]], list[np.ndarray], list[str]]:
    """Parts (with the node whose joint they carry, -1 for fixed ones) and the part of every face."""
    drafts: list[tuple[_Draft, int]] = []
    owners = [np.full(len(table.corners), -1) for table in tables]
    main: dict[int, int] = {}
    notes: list[str] = []
    taken: dict[str, int] = {}
    for node in _ordered(nodes):
        label = labels[node.id]
        name = "base" if node.parent == -1 else f"{label}_{taken.get(label, 0)}"
        taken[label] = taken.get(label, 0) + 1
        main[node.id] = len(drafts)
        parent = -1 if node.parent == -1 else main[node.parent]
        drafts.append((_Draft(name=name, label=label, parent=parent, joint=FIXED), node.id))
        mine = [index for index, piece in enumerate(pieces) if piece.node == node.id]
        groups = _groups_to_split(node, label, [pieces[index] for index in mine])
        for index in mine:
            owners[index][:] = main[node.id]
        for split_label, members in groups:
            chosen = [index for index in mine if pieces[index].piece.id in members]
            ids = split_pieces([tables[index] for index in chosen], cfg.piece_gap)
            for number in range(1 + max(int(part.max()) for part in ids)):
                stem = split_label if split_label == "shelf" else f"{name}_{split_label}"
                count = taken.get(stem, 0)
                taken[stem] = count + 1
                for index, part in zip(chosen, ids, strict=True):
                    owners[index][part == number] = len(drafts)
                drafts.append(
                    (_Draft(name=f"{stem}_{count}", label=split_label, parent=main[node.id], joint=FIXED), -1)
                )
    return drafts, owners, notes


def _ordered(nodes: tuple[SourceNode, ...]) -> list[SourceNode]:
    """The base, then all others in order of their ids, parents before children."""
    order = [node for node in nodes if node.parent == -1]
    waiting = sorted((node for node in nodes if node.parent != -1), key=lambda node: node.id)
    while waiting:
        done = {node.id for node in order}
        node = next(node for node in waiting if node.parent in done)
        order.append(node)
        waiting.remove(node)
    return order


def _groups_to_split(
    node: SourceNode, label: PartLabel, pieces: list[PieceMesh]
) -> list[tuple[PartLabel, set[int]]]:
    """Ids of pieces that become parts of their own, never so many that nothing is left."""
    groups: list[tuple[PartLabel, set[int]]] = []
    left = {piece.piece.id for piece in pieces}
    for number, name in sorted({(piece.piece.id, piece.piece.name) for piece in pieces}):
        is_shelf = node.parent == -1 and name in SHELF_NAMES
        split: PartLabel | None = "shelf" if is_shelf else SPLIT_LABELS.get(name)
        if split is None or label in ("handle", "knob") or left == {number}:
            continue
        left.remove(number)
        groups.append((split, {number}))
    return groups


def _add_joints(
    drafts: list[tuple[_Draft, int]],
    nodes: tuple[SourceNode, ...],
    poses: dict[int, RestPose],
    T_unit: dict[int, np.ndarray],
    scale: float,
) -> list[tuple[_Draft, int]]:
    by_id = {node.id: node for node in nodes}
    out = []
    for draft, number in drafts:
        node = by_id.get(number)
        if node is None or node.parent == -1:
            out.append((draft, number))
            continue
        joint = build_joint(node, poses[number], T_unit[node.parent], scale)
        out.append((replace(draft, joint=joint), number))
    return out


def _join(tables: list[FaceTable], owners: list[np.ndarray]) -> TriangleMesh:
    offsets = np.cumsum([0, *(len(table.vertices) for table in tables)])
    return TriangleMesh(
        vertices=np.concatenate([table.vertices for table in tables]),
        faces=np.concatenate(
            [table.faces + offset for table, offset in zip(tables, offsets[:-1], strict=True)]
        ),
        part_ids=np.concatenate(owners),
    )


def _with_boxes(drafts: list[tuple[_Draft, int]], triangles: TriangleMesh) -> tuple[Part, ...]:
    low, high = np.full((len(drafts), 3), np.inf), np.full((len(drafts), 3), -np.inf)
    for corner in range(3):
        points = triangles.vertices[triangles.faces[:, corner]]
        np.minimum.at(low, triangles.part_ids, points)
        np.maximum.at(high, triangles.part_ids, points)
    return tuple(
        Part(
            name=draft.name,
            label=draft.label,
            parent=draft.parent,
            joint=draft.joint,
            box=np.stack([(low[index] + high[index]) / 2, high[index] - low[index]]),
        )
        for index, (draft, _) in enumerate(drafts)
    )


def _sample(tables: list[FaceTable], owners: list[np.ndarray], cfg: ReaderConfig) -> SurfaceSamples:
    return sample_surface(tables, owners, cfg.samples, np.random.default_rng(cfg.seed))
