"""Reads any PartNet-Mobility folder into an `Asset`: parts, joints, coloured surface, real size.

``mobility_v2.json`` is the truth about parts and joints, mesh files are drawn where they lie, and
everything that was decided on the way (a rest pose moved, a mesh missing, a URDF that disagrees) is
a sentence in ``asset.notes``. See docs/reference/partnet_mobility.md.
"""

import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from artigen.datasets.partnet_annotation import SourceNode, read_json, read_nodes, read_piece_files
from artigen.datasets.partnet_joints import RestPose, closed_pose, describe_joint, joint_kind
from artigen.datasets.partnet_labels import label_nodes
from artigen.datasets.partnet_meshes import MESH_FOLDER, PieceMesh, read_pieces
from artigen.datasets.partnet_parts import build_parts, place_nodes
from artigen.datasets.partnet_surface import FaceTable, make_face_table, sample_surface
from artigen.datasets.partnet_urdf import UrdfFile, compare_urdf, read_urdf
from artigen.datasets.sizes import estimate_size
from artigen.errors import SourceError
from artigen.transforms import T_ZUP_FROM_PARTNET
from artigen.types import Asset, Part, PartLabel, SurfaceSamples, frozen_array

logger = logging.getLogger(__name__)

POINTS_PER_NODE = 2000
"""Corners looked at when the closed pose is sought; more change nothing but the time."""


@dataclass(frozen=True, kw_only=True)
class ReaderConfig:
    """How an object is read."""

    samples: int = 600_000
    """Points drawn from the surface of the whole object; too few leave holes in 64^3 voxels."""
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
        vertices = frozen_array(self.vertices, np.float64, (None, 3), "triangle vertices")
        part_ids = frozen_array(self.part_ids, np.int64, (len(faces),), "triangle part ids")
        object.__setattr__(self, "faces", faces)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "part_ids", part_ids)


@dataclass(frozen=True, kw_only=True, eq=False)
class PartNetObject:
    """An object as read: the asset, its exact triangles, and the source's own mesh files."""

    asset: Asset
    visuals: tuple[SourceVisual, ...]
    triangles: TriangleMesh
    tables: tuple[FaceTable, ...]
    """The same triangles file by file, with texture coordinates and materials."""


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
    all_nodes = read_nodes(folder / "mobility_v2.json")
    nodes, notes = _keep_live(all_nodes, folder)
    urdf = read_urdf(folder / "mobility.urdf")
    listing = folder / "result.json"
    files = read_piece_files(listing) if listing.exists() else {}
    pieces, mesh_notes = read_pieces(folder, all_nodes, frozenset(node.id for node in nodes), urdf, files)
    nodes, empty_notes = _keep_drawn(nodes, pieces, folder)
    labels, label_notes = label_nodes(nodes)
    poses = _find_rest_poses(nodes, labels, pieces)
    turn, turn_notes = _find_turn(nodes, urdf)
    placement = place_nodes(nodes, poses, pieces, turn)
    tables = tuple(
        make_face_table(piece.mesh, placement.T_unit[piece.node], placement.scale) for piece in pieces
    )
    parts, owners = build_parts(nodes, labels, poses, pieces, tables, placement, cfg.piece_gap)
    size, size_notes = _choose_size(category, placement.extents, cfg)
    surface = sample_surface(tables, owners, cfg.samples, np.random.default_rng(cfg.seed))
    joint_notes = [note for node in nodes for note in (poses[node.id].note, describe_joint(node)) if note]
    asset = Asset(
        name=folder.resolve().name,
        category=category,
        scale=size,
        parts=parts,
        surface=surface,
        notes=(
            *(*notes, *mesh_notes, *empty_notes, *compare_urdf(nodes, urdf)),
            *(*label_notes, *joint_notes, *turn_notes, *size_notes, *_find_unsampled(parts, surface)),
        ),
    )
    visuals = tuple(
        SourceVisual(
            part=int(owner[0]),
            name=piece.visual_name,
            path=piece.path,
            T_unit_file=placement.T_unit[piece.node],
            scale=placement.scale,
        )
        for piece, owner in zip(pieces, owners, strict=True)
    )
    logger.info("%s: %d parts, %d mesh files", asset.name, len(parts), len(visuals))
    return PartNetObject(asset=asset, visuals=visuals, triangles=_join(tables, owners), tables=tables)


def _read_category(path: Path) -> str:
    value = read_json(path)
    category = value.get("model_cat") if isinstance(value, dict) else None
    if not isinstance(category, str) or not category:
        raise SourceError(f"{path}: 'model_cat' holds {category!r}, expected the name of a category")
    return category


def _keep_live(nodes: tuple[SourceNode, ...], folder: Path) -> tuple[tuple[SourceNode, ...], list[str]]:
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


def _keep_drawn(
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


def _find_rest_poses(
    nodes: tuple[SourceNode, ...], labels: dict[int, PartLabel], pieces: tuple[PieceMesh, ...]
) -> dict[int, RestPose]:
    """Closed pose of every node; zero where there is nothing to choose."""
    corners: dict[int, np.ndarray] = {}
    for node in nodes:
        own = [piece.mesh for piece in pieces if piece.node == node.id]
        corners[node.id] = np.concatenate([mesh.vertices[mesh.faces].reshape(-1, 3) for mesh in own])
    base = next(node.id for node in nodes if node.parent == -1)
    body = np.stack([corners[base].min(axis=0), corners[base].max(axis=0)])
    poses = {}
    for node in nodes:
        poses[node.id] = RestPose(rest=0.0, far=0.0)
        if joint_kind(node) in ("revolute", "prismatic", "screw"):
            stride = max(1, len(corners[node.id]) // POINTS_PER_NODE)
            poses[node.id] = closed_pose(node, labels[node.id], corners[node.id][::stride], body)
    return poses


def _find_turn(nodes: tuple[SourceNode, ...], urdf: UrdfFile) -> tuple[np.ndarray, list[str]]:
    """How mesh files are turned to z up: as the URDF places the base, which is nearly always the same."""
    base = next(node for node in nodes if node.parent == -1)
    placed = urdf.T_base_link.get(f"link_{base.id}")
    if placed is None or np.allclose(placed[:3, :3], T_ZUP_FROM_PARTNET[:3, :3], atol=1e-4):
        return T_ZUP_FROM_PARTNET, []
    turn = np.eye(4)
    turn[:3, :3] = placed[:3, :3]
    return turn, ["the URDF turns the base otherwise than PartNet-Mobility does; its own turn was taken"]


def _choose_size(category: str, extents: np.ndarray, cfg: ReaderConfig) -> tuple[float, list[str]]:
    if cfg.size is not None:
        return cfg.size, []
    size, known = estimate_size(category, extents)
    if known:
        return size, []
    return size, [f"category {category!r} has no known size, longest edge set to {size:g} m"]


def _find_unsampled(parts: tuple[Part, ...], surface: SurfaceSamples) -> list[str]:
    seen = np.bincount(surface.part_ids, minlength=len(parts))
    missed = [part.name for part, count in zip(parts, seen, strict=True) if count == 0]
    return [f"too small for a single surface sample: {', '.join(missed)}"] if missed else []


def _join(tables: tuple[FaceTable, ...], owners: tuple[np.ndarray, ...]) -> TriangleMesh:
    offsets = np.cumsum([0, *(len(table.vertices) for table in tables)])[:-1]
    return TriangleMesh(
        vertices=np.concatenate([table.vertices for table in tables]),
        faces=np.concatenate([table.faces + offset for table, offset in zip(tables, offsets, strict=True)]),
        part_ids=np.concatenate(owners),
    )
