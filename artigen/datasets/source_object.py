"""A source object: the asset, its exact triangles, and its mesh files.

Readers of every layout find nodes, joints and meshes; `assemble` turns these into a `SourceObject`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from artigen.datasets.mechanism import Direction
from artigen.datasets.partnet_annotation import MOVING_JOINTS, SourceNode
from artigen.datasets.partnet_joints import RestPose
from artigen.datasets.partnet_meshes import PieceMesh
from artigen.datasets.partnet_parts import build_parts, place_nodes
from artigen.datasets.partnet_surface import FaceTable, join_tables, make_face_table, sample_surface
from artigen.types import Asset, Part, PartLabel, SurfaceSamples, freeze_field

PIECE_GAP = 0.04
"""Handles of one name that are farther apart become separate parts (unit-cube lengths)."""


@dataclass(frozen=True, kw_only=True)
class ReaderConfig:
    """Settings of the readers."""

    samples: int = 600_000
    """Number of points sampled on the surface of the object; too few leave holes in 64^3 voxels."""
    seed: int = 0
    """Seed of the surface samples."""
    size: float | None = None
    """Longest edge of the closed object in metres; None keeps the lengths of a URDF and uses the category
    table for layouts without metres."""
    category: str | None = None
    """Category of the object; None takes it from its files or name."""
    up: Direction | None = None
    """Up axis of the file; None is z, y in object.json and what a joints file says of its meshes."""
    front: Direction | None = None
    """Axis that the front faces; None is -x, z in object.json and what a joints file says of its meshes."""
    body: str | None = None
    """Body of a scene file that is the object; None where the file holds one object."""
    arguments: tuple[str, ...] = ()
    """Arguments of a xacro, ``name:=value`` each."""

    def __post_init__(self) -> None:
        if self.samples < 1:
            raise ValueError(f"samples is {self.samples}, expected at least 1")
        if self.size is not None and not self.size > 0:
            raise ValueError(f"size is {self.size} metres, expected > 0")


@dataclass(frozen=True, kw_only=True, eq=False)
class SourceVisual:
    """A mesh file of the source and its placement: ``p_unit = T_unit_file * (scale * p_file)``."""

    part: int
    name: str
    path: Path
    T_unit_file: Float[np.ndarray, "4 4"]
    scale: float


@dataclass(frozen=True, kw_only=True, eq=False)
class TriangleMesh:
    """The source's triangles in the unit cube at rest, with the part of each."""

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    part_ids: Int[np.ndarray, "F"]

    def __post_init__(self) -> None:
        count = len(freeze_field(self, "faces", np.int64, (None, 3), "triangle faces"))
        freeze_field(self, "vertices", np.float64, (None, 3), "triangle vertices")
        freeze_field(self, "part_ids", np.int64, (count,), "triangle part ids")


@dataclass(frozen=True, kw_only=True)
class SourceMotion:
    """The joint of the source that moves a part, and its coordinate there (rad, or lengths of the file, from
    where the file has it) with the part closed and open."""

    part: str
    joint: str
    closed: float
    open: float


@dataclass(frozen=True, kw_only=True, eq=False)
class SourceObject:
    """An object as read: the asset, its exact triangles, and the source's mesh files."""

    asset: Asset
    visuals: tuple[SourceVisual, ...]
    triangles: TriangleMesh
    tables: tuple[FaceTable, ...]
    """The same triangles by file, with texture coordinates and materials."""
    follows: tuple[tuple[str, str], ...] = ()
    """Parts that follow another part, with that part; both close and open together."""
    motions: tuple[SourceMotion, ...] = ()
    """How the source moves its parts, where it names its joints."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SourceTree:
    """Result of a reader: nodes with their meshes, labels and rest poses; lengths as in the files."""

    nodes: tuple[SourceNode, ...]
    pieces: tuple[PieceMesh, ...]
    labels: Mapping[int, PartLabel]
    poses: Mapping[int, RestPose]
    T_zup_file: Float[np.ndarray, "4 4"]
    follows: tuple[tuple[int, int], ...] = ()
    """Nodes that follow another node."""
    joint_names: Mapping[int, str] = field(default_factory=dict)
    """Names of the joints of nodes."""


def assemble(
    tree: SourceTree,
    cfg: ReaderConfig,
    *,
    name: str,
    category: str,
    choose_size: Callable[[Float[np.ndarray, "3"]], tuple[float, tuple[str, ...]]],
    notes: tuple[str, ...],
) -> SourceObject:
    """Places the object at rest in the unit cube, makes parts of the nodes, and samples the surface.

    Args:
        choose_size: Longest edge in metres and notes for an object with given extents in file lengths.

    Raises:
        SourceError: If the surface has no area, or an image cannot be decoded.
    """
    nodes, pieces, poses = tree.nodes, tree.pieces, tree.poses
    placement = place_nodes(nodes, poses, pieces, tree.T_zup_file)
    tables = tuple(
        make_face_table(piece.mesh, placement.T_unit[piece.node], placement.scale) for piece in pieces
    )
    parts, owners = build_parts(nodes, tree.labels, poses, pieces, tables, placement, PIECE_GAP)
    size, size_notes = choose_size(placement.extents)
    surface = sample_surface(tables, owners, cfg.samples, np.random.default_rng(cfg.seed))
    main: dict[int, int] = {}  # split parts come after the part that they are split from
    for piece, owner in zip(pieces, owners, strict=True):
        main[piece.node] = min(main.get(piece.node, len(parts)), int(owner.min()))
    asset = Asset(
        name=name,
        category=category,
        scale=size,
        parts=parts,
        surface=surface,
        notes=(*notes, *size_notes, *_find_unsampled(parts, surface)),
    )
    visuals = tuple(
        SourceVisual(
            part=int(owner[0]),
            name=piece.visual_name,
            path=piece.path,
            T_unit_file=placement.T_unit[piece.node] @ _scale_offset(piece.T_tree_file, placement.scale),
            scale=placement.scale * piece.scale,
        )
        for piece, owner in zip(pieces, owners, strict=True)
    )
    vertices, faces = join_tables(tables)
    motions = tuple(
        SourceMotion(
            part=parts[main[node.id]].name,
            joint=tree.joint_names[node.id],
            closed=poses[node.id].rest * unit,
            open=poses[node.id].far * unit,
        )
        for node in nodes
        if node.id in tree.joint_names and node.id in main and node.joint in MOVING_JOINTS
        for unit in [np.pi / 180.0 if node.joint == "hinge" else 1.0]
    )
    return SourceObject(
        asset=asset,
        visuals=visuals,
        triangles=TriangleMesh(vertices=vertices, faces=faces, part_ids=np.concatenate(owners)),
        tables=tables,
        follows=tuple((parts[main[one]].name, parts[main[other]].name) for one, other in tree.follows),
        motions=motions,
    )


def collect_corners(pieces: Sequence[PieceMesh]) -> dict[int, Float[np.ndarray, "N 3"]]:
    """Corners of all triangles of every node that has any."""
    return {
        node: np.concatenate([p.mesh.vertices[p.mesh.faces].reshape(-1, 3) for p in pieces if p.node == node])
        for node in dict.fromkeys(piece.node for piece in pieces)
    }


def _scale_offset(T: np.ndarray, scale: float) -> np.ndarray:
    scaled = np.array(T)
    scaled[:3, 3] *= scale
    return scaled


def _find_unsampled(parts: tuple[Part, ...], surface: SurfaceSamples) -> list[str]:
    seen = np.bincount(surface.part_ids, minlength=len(parts))
    missed = [part.name for part, count in zip(parts, seen, strict=True) if count == 0]
    return [f"too small for a single surface sample: {', '.join(missed)}"] if missed else []
